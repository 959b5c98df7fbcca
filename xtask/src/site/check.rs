//! Checks of the site: every internal link leads to an existing page and anchor, and nothing is loaded from elsewhere.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::page::{Page, Reference};

/// Schemes of addresses that are not pages.
const OTHER_SCHEMES: [&str; 3] = ["data:", "javascript:", "mailto:"];

#[derive(Debug, Default)]
pub(super) struct Checked {
    pub(super) pages: usize,
    pub(super) links: usize,
    pub(super) faults: Vec<String>,
}

pub(super) fn check(site: &Path) -> Result<Checked> {
    let mut pages = BTreeMap::new();
    let mut checked = Checked::default();
    for file in files_below(site)? {
        let shown = file.strip_prefix(site).unwrap_or(&file).display().to_string();
        let text = |file| fs::read_to_string(file).with_context(|| format!("{shown} cannot be read"));
        match file.extension().and_then(|extension| extension.to_str()) {
            Some("html") => {
                let page = Page::read(&text(&file)?);
                pages.insert(file, (shown, page));
            }
            Some("css") => {
                let foreign = foreign_style(&text(&file)?).map(|what| format!("{shown} loads {what}"));
                checked.faults.extend(foreign);
            }
            _ => {}
        }
    }
    for (file, (shown, page)) in &pages {
        for Reference { target, loaded } in &page.references {
            let what = if is_foreign(target) {
                loaded.then_some("is loaded from elsewhere")
            } else if OTHER_SCHEMES.iter().any(|scheme| target.starts_with(scheme)) {
                None
            } else {
                checked.links += 1;
                fault(file, target, &pages)
            };
            checked
                .faults
                .extend(what.map(|what| format!("{shown}: {target} {what}")));
        }
    }
    checked.pages = pages.len();
    checked.faults.dedup();
    Ok(checked)
}

/// The fault of a link from the page `file` to another place of the site, if any.
fn fault(file: &Path, target: &str, pages: &BTreeMap<PathBuf, (String, Page)>) -> Option<&'static str> {
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = resolved(file, path.split('?').next().unwrap_or_default());
    if !path.is_file() {
        // Every page of a trait names the file of its implementors, which rustdoc writes only if there are some.
        return (!path.iter().any(|part| part == "trait.impl")).then_some("does not exist");
    }
    if anchor.is_empty() {
        return None;
    }
    let Some((_, page)) = pages.get(&path) else {
        return Some("has an anchor, but its target is not a page");
    };
    // A page that redirects has the anchors of its target.
    let onward = page
        .redirect
        .as_ref()
        .and_then(|onward| pages.get(&resolved(&path, onward)));
    let known = &onward.map_or(page, |(_, page)| page).anchors;
    // A browser looks up the name first as written, then decoded. For a range of lines, rustdoc has an anchor of the
    // first line.
    let first_line = anchor.split_once('-').map_or(anchor, |(first, _)| first);
    let is_line = !first_line.is_empty() && first_line.bytes().all(|byte| byte.is_ascii_digit());
    let found = known.contains(anchor) || known.contains(&decoded(anchor)) || is_line && known.contains(first_line);
    (!found).then_some("has an anchor that does not exist")
}

fn is_foreign(target: &str) -> bool {
    ["//", "http:", "https:"].iter().any(|start| target.starts_with(start))
}

/// Addresses outside the site that a style would load.
fn foreign_style(css: &str) -> Option<&str> {
    let loads = css.split("url(").skip(1).chain(css.split("@import").skip(1));
    loads
        .map(|text| text.trim_start().trim_start_matches(['"', '\'']))
        .map(|text| text.split([')', '"', '\'']).next().unwrap_or_default())
        .find(|target| is_foreign(target))
}

fn resolved(file: &Path, address: &str) -> PathBuf {
    if address.is_empty() {
        return file.to_path_buf();
    }
    let mut path = file.parent().unwrap_or(file).to_path_buf();
    for part in decoded(address).split('/') {
        match part {
            "" | "." => {}
            ".." => {
                path.pop();
            }
            name => path.push(name),
        }
    }
    if path.is_dir() { path.join("index.html") } else { path }
}

/// Decodes `%20` and the like.
fn decoded(address: &str) -> String {
    let mut parts = address.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let byte = part.get(..2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(byte.unwrap_or(b'%'));
        bytes.extend_from_slice(
            part.get(if byte.is_some() { 2.. } else { 0.. })
                .unwrap_or_default()
                .as_bytes(),
        );
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

pub(super) fn files_below(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = || format!("{} cannot be read", folder.display());
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(failed)? {
        let path = entry.with_context(failed)?.path();
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A site of two pages, a source page and a style; the first page holds `body`.
    fn faults(body: &str, css: &str) -> Vec<String> {
        let site = tempfile::tempdir().unwrap();
        for (file, text) in [
            ("index.html", body),
            ("guide/index.html", "<h1 id=\"a b\">x</h1><h2 id=\"B%3CT%3E\">y</h2>"),
            ("api/src/x.rs.html", "<a href=#3 id=3>3</a>"),
            (
                "old.html",
                "<meta http-equiv=\"refresh\" content=\"0;URL=guide/index.html\">",
            ),
            ("style.css", css),
        ] {
            crate::whole_file::write(&site.path().join(file), text.as_bytes()).unwrap();
        }
        check(site.path()).unwrap().faults
    }

    #[test]
    fn valid_links_pass() {
        let body = "<a href=\"old.html#a b\"></a><a href='guide/index.html#a%20b'></a><a \
            href=\"guide/#B%3CT%3E\"></a><a href=\"#top\" id=\"top\"></a><a href=\"api/src/x.rs.html#3-7\"></a><a \
            href=\"https://a.example/\"></a><a href=\"guide/index.html?q=1\"></a><img \
            src=\"data:image/png;base64,AA\"><script src=\"api/trait.impl/x/trait.X.js\"></script>\
             <script>\"<a href='x'>\"</script><!-- <a href='y'> -->";
        assert_eq!(faults(body, "a { background: url(\"x.svg\"); }"), [] as [&str; 0]);
    }

    #[test]
    fn broken_links_are_reported() {
        for (body, needle) in [
            (
                "<a href=\"nowhere.html\"></a>",
                "index.html: nowhere.html does not exist",
            ),
            ("<a href=ddl_star::Star></a>", "does not exist"),
            ("<a href=\"guide/index.html#c\"></a>", "anchor that does not exist"),
            ("<a href=\"#top\"></a>", "anchor that does not exist"),
            ("<a href=\"api/src/x.rs.html#4-7\"></a>", "anchor that does not exist"),
            ("<a href=\"style.css#x\"></a>", "not a page"),
            ("<img src=\"p.png\">", "p.png does not exist"),
        ] {
            let found = faults(body, "");
            assert!(found.len() == 1 && found[0].contains(needle), "{found:?}");
        }
    }

    #[test]
    fn nothing_may_be_loaded_from_elsewhere() {
        for body in [
            "<script src=\"https://a.example/x.js\"></script>",
            "<link rel=stylesheet href=\"//a.example/x.css\">",
            "<img src=\"http://a.example/x.png\">",
        ] {
            assert!(faults(body, "")[0].contains("is loaded from elsewhere"), "{body}");
        }
        for css in [
            "@import \"https://a.example/x.css\";",
            "a { src: url('https://a.example/x.woff'); }",
        ] {
            assert!(faults("", css)[0].contains("style.css loads https"), "{css}");
        }
    }
}
