//! Draws the pictures of `docs/stability.md` into a folder.
//!
//! ```text
//! cargo run -p ddl-dynamics --example pictures -- docs
//! ```

mod around;
mod circling;
mod drawing;

use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args_os().nth(1);
    let folder = PathBuf::from(folder.ok_or("name the folder: ... --example pictures -- docs")?);
    for (file, svg) in [
        ("stability.svg", circling::draw()?),
        ("around.svg", around::draw()?),
    ] {
        let file = folder.join(file);
        fs::write(&file, svg)
            .map_err(|error| format!("{} cannot be written: {error}", file.display()))?;
    }
    Ok(())
}
