//! The second picture of `docs/stability.md`: around the end of a wall, and among pillars.
//!
//! ```text
//! cargo run -p ddl-dynamics --example around -- docs/around.svg
//! ```

#[path = "../drawing/mod.rs"]
mod drawing;
mod picture;

use std::{env, error::Error, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let file = env::args_os()
        .nth(1)
        .ok_or("name the SVG file to write: ... --example around -- docs/around.svg")?;
    let svg = picture::draw(&picture::behind_a_wall()?, &picture::among_pillars()?);
    fs::write(&file, svg)
        .map_err(|error| format!("{} cannot be written: {error}", file.to_string_lossy()))?;
    Ok(())
}
