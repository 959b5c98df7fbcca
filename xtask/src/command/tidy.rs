//! `cargo xtask tidy`: house rules that no other tool checks.

use anyhow::{Result, bail};

use crate::tidy::{self, Findings};
use crate::workspace::Workspace;

pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let Findings { faults, notes } = tidy::check(workspace)?;
    for note in &notes {
        println!("note: {note}");
    }
    for fault in &faults {
        println!("fault: {fault}");
    }
    if !faults.is_empty() {
        bail!("tidy: {} faults (above)", faults.len());
    }
    println!("tidy: no faults, {} notes", notes.len());
    Ok(())
}
