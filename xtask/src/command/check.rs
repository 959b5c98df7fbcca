//! `cargo xtask check`: what is quick to check while working.

use anyhow::Result;

use super::ci;
use crate::tidy;
use crate::workspace::Workspace;

pub(super) fn run(workspace: &Workspace) -> Result<()> {
    ci::format(workspace)?;
    tidy::run(workspace)?;
    // With the code for libtorch, which this feature compiles where libtorch is not there.
    ci::lints(workspace, "ddl-cli/torch,ddl-cli/doc-only")
}
