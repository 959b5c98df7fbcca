//! Draws the picture of `docs/stability.md` into a folder: `cargo run -p ddl-dynamics --example pictures -- docs`

mod circling;
mod drawing;

use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args_os().nth(1);
    let folder = PathBuf::from(folder.ok_or("name the folder: ... --example pictures -- docs")?);
    fs::write(folder.join("stability.svg"), circling::draw()?)?;
    Ok(())
}
