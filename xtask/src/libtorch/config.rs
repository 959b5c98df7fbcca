//! The generated cargo configuration, which `.cargo/config.toml` includes: the folder of libtorch, and the path to its
//! libraries.

use crate::cache::write_file;
use anyhow::{Result, bail};
use std::fs;
use std::path::{Path, PathBuf};

/// Relative to the workspace root; git ignores it.
pub(super) const GENERATED: &str = ".cargo/config.generated.toml";

/// Writes the configuration unless it is up to date, so that nothing is rebuilt. Returns whether it was written.
pub(super) fn write(file: &Path, libtorch: &Path) -> Result<bool> {
    let text = render(libtorch)?;
    let is_there = fs::read_to_string(file).is_ok_and(|present| present == text);
    if !is_there {
        write_file(file, text.as_bytes())?;
    }
    Ok(!is_there)
}

pub(super) fn read(file: &Path) -> Option<PathBuf> {
    let table: toml::Table = fs::read_to_string(file).ok()?.parse().ok()?;
    table.get("env")?.get("LIBTORCH")?.as_str().map(PathBuf::from)
}

fn render(libtorch: &Path) -> Result<String> {
    let shown = libtorch.display();
    let Some(folder) = libtorch.to_str() else {
        bail!("libtorch's path {shown} is not valid Unicode: choose another folder");
    };
    if folder.contains([',', '\n']) {
        bail!(
            "libtorch's path {shown} has a comma or a line break, where the linker cuts it off: choose another folder"
        );
    }
    let quote = |text: String| toml::Value::String(text).to_string();
    let folder_text = quote(folder.to_owned());
    let rpath = quote(format!("link-arg=-Wl,-rpath,{folder}/lib"));
    Ok(format!(
        "# Written by `cargo xtask setup`; delete it before a new set-up. See docs/libtorch.md.\n\
         [env]\n\
         LIBTORCH = {folder_text}\n\
         \n\
         # Programs and tests find libtorch's libraries by this path, also when started by hand.\n\
         # (xtask needs none: without this exception it would be rebuilt after set-up.)\n\
         [target.'cfg(all(unix, not(ddl_xtask)))']\n\
         rustflags = [\"-C\", {rpath}]\n\
         \n\
         # The examples in the documentation are linked by rustdoc, which has flags of its own.\n\
         [build]\n\
         rustdocflags = [\"-C\", {rpath}]\n"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_is_written_when_it_changes_and_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(".cargo/config.generated.toml");
        assert_eq!(read(&file), None);
        // Quotes and spaces are legal in a folder's name.
        for libtorch in ["/opt/a \"quoted\" folder/libtorch", "/opt/two"].map(Path::new) {
            assert!(write(&file, libtorch).unwrap());
            assert!(!write(&file, libtorch).unwrap());
            assert_eq!(read(&file).as_deref(), Some(libtorch));
            let table: toml::Table = fs::read_to_string(&file).unwrap().parse().unwrap();
            let flags = &table["target"]["cfg(all(unix, not(ddl_xtask)))"]["rustflags"];
            let rpath = format!("link-arg=-Wl,-rpath,{}/lib", libtorch.display());
            assert_eq!(flags[1].as_str(), Some(rpath.as_str()));
            assert_eq!(&table["build"]["rustdocflags"], flags);
        }
        fs::write(&file, "[env\nLIBTORCH = ").unwrap();
        assert_eq!(read(&file), None);
        let message = render(Path::new("/opt/one,two")).unwrap_err().to_string();
        assert!(message.contains("comma"), "{message}");
    }
}
