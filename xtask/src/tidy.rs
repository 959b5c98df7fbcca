//! The invariants of `docs/architecture.md`, as checks.
//!
//! Each check is a function of what it is given (a list of files, cargo's metadata), so that its
//! tests can hand it a bad workspace.

mod arrows;
mod names;
mod network;
mod packages;
mod readmes;
mod recordings;
mod text;

use anyhow::Result;

use crate::workspace::Workspace;

/// What the checks found.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Findings {
    /// Broken invariants.
    pub(crate) faults: Vec<String>,
    /// Things to keep an eye on.
    pub(crate) notes: Vec<String>,
}

impl Findings {
    fn fault(&mut self, text: impl Into<String>) {
        self.faults.push(text.into());
    }

    fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }
}

/// Every check, over everything that git tracks or would track.
pub(crate) fn check(workspace: &Workspace) -> Result<Findings> {
    let mut findings = Findings::default();
    let metadata = workspace.metadata()?;
    let files = workspace.files()?;
    arrows::check(&metadata, &mut findings);
    packages::check(&metadata, workspace.root(), &mut findings);
    names::check(&files, &mut findings);
    text::check(&files, workspace.root(), &mut findings)?;
    network::check(&metadata, &files, workspace.root(), &mut findings)?;
    readmes::check(&metadata, &files, workspace.root(), &mut findings)?;
    recordings::check(&files, workspace, &mut findings)?;
    Ok(findings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_keep_faults_and_notes_apart() {
        let mut findings = Findings::default();
        findings.fault("one");
        findings.note("two");
        assert_eq!((findings.faults.len(), findings.notes.len()), (1, 1));
    }
}
