//! The picture of `docs/stability.md`: one flow, followed by plain and by stable Euler steps.
//!
//! ```text
//! cargo run -p ddl-dynamics --example circling -- docs/stability.svg
//! ```

#[path = "../drawing/mod.rs"]
mod drawing;
mod picture;

use std::{env, error::Error, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let file = env::args_os()
        .nth(1)
        .ok_or("name the SVG file to write: ... --example circling -- docs/stability.svg")?;
    fs::write(&file, picture::draw()?)
        .map_err(|error| format!("{} cannot be written: {error}", file.to_string_lossy()))?;
    Ok(())
}
