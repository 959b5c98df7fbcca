//! The first page of the site.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Result;

use super::api::Library;
use crate::whole_file;
use crate::workspace::Workspace;

const TEMPLATE: &str = include_str!("landing.html");
/// Where the list of crates goes.
const CRATES: &str = "<!-- crates -->";
/// A page that leads to it.
const ONWARD: &str = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>Crates</title>\n\
    <meta http-equiv=\"refresh\" content=\"0;URL=../index.html\">\n<a href=\"../index.html#crates\">Crates</a>\n</html>\n";
/// What the picture of the page is.
const PICTURE: &str = "docs/forecast.svg";

/// Writes `index.html` and the picture on it.
pub(super) fn write(workspace: &Workspace, site: &Path, libraries: &[Library]) -> Result<()> {
    let mut rows = String::new();
    for library in libraries {
        let _ = writeln!(
            rows,
            "<dt><a href=\"api/{}/index.html\">{}</a></dt><dd>{}</dd>",
            library.module(),
            escaped(&library.package),
            escaped(&library.description)
        );
    }
    let page = TEMPLATE.replace(CRATES, rows.trim_end());
    whole_file::write(&site.join("index.html"), page.as_bytes())?;
    // rustdoc's own pages lead to a list of crates, which is here.
    whole_file::write(&site.join("api/index.html"), ONWARD.as_bytes())?;
    let picture = std::fs::read(workspace.path(PICTURE))?;
    whole_file::write(&site.join("forecast.svg"), &picture)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_names_every_library_crate() {
        let workspace = Workspace::find().unwrap();
        let site = tempfile::tempdir().unwrap();
        let libraries = super::super::api::libraries(&workspace).unwrap();
        write(&workspace, site.path(), &libraries).unwrap();
        let page = std::fs::read_to_string(site.path().join("index.html")).unwrap();
        assert!(!page.contains(CRATES));
        for library in &libraries {
            assert!(
                page.contains(&format!("api/{}/index.html", library.module())),
                "{library:?}"
            );
        }
        assert!(site.path().join("forecast.svg").is_file());
    }
}
