//! Every link inside the site leads to a page that is there, and to a place on it; nothing is loaded from elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::html::{self, Reference};

/// What the check found.
#[derive(Debug, Default)]
pub(super) struct Checked {
    pub(super) pages: usize,
    pub(super) links: usize,
    pub(super) faults: Vec<String>,
}

/// Reads every page and style below `site`.
pub(super) fn check(site: &Path) -> Result<Checked> {
    let mut files = Vec::new();
    list(site, &mut files)?;
    let mut pages = BTreeMap::new();
    let mut checked = Checked::default();
    for file in &files {
        let kind = file.extension().and_then(|extension| extension.to_str());
        if kind != Some("html") && kind != Some("css") {
            continue;
        }
        let text = fs::read_to_string(file)
            .with_context(|| format!("{} cannot be read", file.display()))?;
        if kind == Some("css") {
            let foreign =
                foreign_style(&text).map(|what| format!("{} loads {what}", shown(site, file)));
            checked.faults.extend(foreign);
        } else {
            pages.insert(file.clone(), html::read(&text));
        }
    }
    let mut anchors: BTreeMap<&Path, BTreeSet<&str>> = pages
        .iter()
        .map(|(file, page)| {
            (
                file.as_path(),
                page.anchors.iter().map(String::as_str).collect(),
            )
        })
        .collect();
    for (file, page) in &pages {
        // A page that leads on has the places of the one it leads to.
        let onward = page.redirect.as_ref().map(|target| resolved(file, target));
        if let Some(known) = onward.and_then(|onward| anchors.get(onward.as_path()).cloned()) {
            anchors.insert(file, known);
        }
    }
    for (file, page) in &pages {
        for reference in &page.references {
            match fault(file, reference, &anchors) {
                Verdict::Elsewhere => {}
                Verdict::Found => checked.links += 1,
                Verdict::Fault(what) => checked
                    .faults
                    .push(format!("{}: {what}", shown(site, file))),
            }
        }
    }
    checked.pages = pages.len();
    checked.faults.dedup();
    Ok(checked)
}

enum Verdict {
    Elsewhere,
    Found,
    Fault(String),
}

fn fault(file: &Path, reference: &Reference, anchors: &BTreeMap<&Path, BTreeSet<&str>>) -> Verdict {
    let target = &reference.target;
    if is_foreign(target) {
        return if reference.loaded {
            Verdict::Fault(format!("loads {target}"))
        } else {
            Verdict::Elsewhere
        };
    }
    if ["data:", "javascript:", "mailto:"]
        .iter()
        .any(|scheme| target.starts_with(scheme))
    {
        return Verdict::Elsewhere;
    }
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = html::decoded(path.split('?').next().unwrap_or_default());
    let path = if path.is_empty() {
        file.to_path_buf()
    } else {
        resolved(file, &path)
    };
    let path = if path.is_dir() {
        path.join("index.html")
    } else {
        path
    };
    // Every page of a trait names the file of its implementors, which rustdoc writes only where there are some.
    let of_implementors = path
        .components()
        .any(|part| part.as_os_str() == "trait.impl");
    if of_implementors && !path.is_file() {
        return Verdict::Elsewhere;
    }
    if !path.is_file() {
        return Verdict::Fault(format!("{target} does not exist"));
    }
    if anchor.is_empty() {
        return Verdict::Found;
    }
    let Some(known) = anchors.get(path.as_path()) else {
        return Verdict::Fault(format!("{target} has a place on what is no page"));
    };
    // A browser looks for the name as it is written, then for what it means; rustdoc writes both alike.
    let decoded = html::decoded(anchor);
    let names = [Some(anchor), Some(&decoded), first_line(anchor)];
    if names.into_iter().flatten().any(|name| known.contains(name)) {
        Verdict::Found
    } else {
        Verdict::Fault(format!("{target} has no such place"))
    }
}

/// The first line of a range of lines of source, which the page's script marks.
fn first_line(anchor: &str) -> Option<&str> {
    let (first, last) = anchor.split_once('-')?;
    let number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    (number(first) && number(last)).then_some(first)
}

fn is_foreign(target: &str) -> bool {
    target.starts_with("//") || target.starts_with("http:") || target.starts_with("https:")
}

/// What a style would fetch from elsewhere.
fn foreign_style(css: &str) -> Option<&str> {
    let loads = css
        .split("url(")
        .skip(1)
        .chain(css.split("@import").skip(1));
    let targets = loads.map(|text| text.trim_start().trim_start_matches(['"', '\'']));
    targets
        .map(|text| text.split([')', '"', '\'']).next().unwrap_or_default())
        .find(|target| is_foreign(target))
}

/// A relative target from the page that names it, without `..`.
fn resolved(file: &Path, target: &str) -> PathBuf {
    let mut path = file.parent().unwrap_or(file).to_path_buf();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                path.pop();
            }
            name => path.push(name),
        }
    }
    path
}

fn shown(site: &Path, file: &Path) -> String {
    file.strip_prefix(site)
        .unwrap_or(file)
        .display()
        .to_string()
}

/// Adds every file below `folder` to `files`.
pub(super) fn list(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let failed = || format!("{} cannot be read", folder.display());
    for entry in fs::read_dir(folder).with_context(failed)? {
        let path = entry.with_context(failed)?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A site of two pages, a source page and a style; the first page holds `body`.
    fn faults(body: &str, css: &str) -> Vec<String> {
        let site = tempfile::tempdir().unwrap();
        let source = "<a href=#3 id=3>3</a>";
        for (file, text) in [
            ("index.html", body),
            (
                "guide/index.html",
                "<h1 id=\"a b\">x</h1><h2 id=\"B%3CT%3E\">y</h2>",
            ),
            ("api/src/x.rs.html", source),
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
    fn links_that_lead_somewhere_pass() {
        let body = "<a href=\"old.html#a b\"></a><a href=\"guide/index.html#a%20b\"></a><a href=\"guide/#B%3CT%3E\"></a><a href=\"#top\" id=\"top\"></a>\
            <a href=\"api/src/x.rs.html#3-7\"></a><a href=\"https://a.example/\"></a><a href=\"guide/index.html?q=1\"></a>\
            <img src=\"data:image/png;base64,AA\"><script src=\"api/trait.impl/x/trait.X.js\"></script>";
        assert_eq!(
            faults(body, "a { background: url(\"x.svg\"); }"),
            [] as [&str; 0]
        );
    }

    #[test]
    fn links_that_lead_nowhere_are_named() {
        for (body, needle) in [
            (
                "<a href=\"nowhere.html\"></a>",
                "index.html: nowhere.html does not exist",
            ),
            ("<a href=\"guide/index.html#c\"></a>", "no such place"),
            ("<a href=\"#top\"></a>", "no such place"),
            ("<a href=\"api/src/x.rs.html#4-7\"></a>", "no such place"),
            ("<a href=\"style.css#x\"></a>", "no page"),
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
            assert!(faults(body, "")[0].contains("loads "), "{body}");
        }
        for css in [
            "@import \"https://a.example/x.css\";",
            "a { src: url('https://a.example/x.woff'); }",
        ] {
            assert!(
                faults("", css)[0].contains("style.css loads https"),
                "{css}"
            );
        }
    }
}
