//! `cargo xtask check`: the quick checks.

use anyhow::Result;

use super::ci;
use crate::tidy;
use crate::workspace::Workspace;

pub(super) fn run(workspace: &Workspace) -> Result<()> {
    ci::format(workspace)?;
    tidy::run(workspace)?;
    // The feature `doc-only` also compiles the code for libtorch, without libtorch.
    ci::lints(workspace, "ddl-cli/torch,ddl-tests/torch,ddl-cli/doc-only")
}
