use super::*;

/// A repository with a guide of one page that brings in another one.
fn repository(page: &str) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    for (file, text) in [
        (
            "docs/guide/src/SUMMARY.md",
            "- [Start](start.md)\n- [Rules](rules.md)\n",
        ),
        ("docs/guide/src/start.md", page),
        (
            "docs/guide/src/rules.md",
            "{{#include ../../protocols.md}}\n",
        ),
        (
            "docs/protocols.md",
            "# Rules\n[a](#b) [start](guide/src/start.md) ![p](p.svg)\n",
        ),
        ("docs/p.svg", "<svg/>"),
        ("docs/other.md", "# Other\n"),
        ("crates/ddl-data/src/fold.rs", "pub struct Fold;\n"),
        ("crates/ddl-data/README.md", "# ddl-data\n"),
    ] {
        whole_file::write(&root.path().join(file), text.as_bytes()).unwrap();
    }
    root
}

fn library() -> Vec<Library> {
    vec![Library {
        package: "ddl-data".to_owned(),
        description: "data".to_owned(),
    }]
}

fn assembled(page: &str, name: &str) -> Result<(String, Vec<PathBuf>)> {
    let root = repository(page);
    let libraries = library();
    let mut copied = Vec::new();
    let text = Guide::read(root.path(), &libraries)?.assembled(name, &mut copied)?;
    Ok((text, copied))
}

#[test]
fn a_page_is_brought_in_whole_and_its_links_lead_on() {
    let (text, copied) = assembled("# Start\n", "rules.md").unwrap();
    assert_eq!(
        text,
        "# Rules\n[a](#b) [start](start.md) ![p](files/docs/p.svg)\n"
    );
    assert_eq!(copied, [PathBuf::from("docs/p.svg")]);
}

#[test]
fn links_of_a_page_lead_to_pages_and_to_the_interface() {
    let page = "[r](../../protocols.md#b) [f](../../../crates/ddl-data/src/fold.rs#L1) \
                [d](../../../crates/ddl-data/README.md) [x](https://a.example/b.md) [s](rules.md)\n";
    let (text, copied) = assembled(page, "start.md").unwrap();
    assert_eq!(
        text,
        "[r](rules.md#b) [f](../api/src/ddl_data/fold.rs.html#L1) \
         [d](../api/ddl_data/index.html) [x](https://a.example/b.md) [s](rules.md)\n"
    );
    assert!(copied.is_empty());
}

#[test]
fn code_is_brought_in_by_its_whole_path() {
    let page = "```rust\n{{#include ../../../crates/ddl-data/src/fold.rs:all}}\n```\n";
    let root = repository(page);
    let libraries = library();
    let guide = Guide::read(root.path(), &libraries).unwrap();
    let text = guide.assembled("start.md", &mut Vec::new()).unwrap();
    let whole = root.path().join("crates/ddl-data/src/fold.rs");
    assert_eq!(
        text,
        format!("```rust\n{{{{#include {}:all}}}}\n```\n", whole.display())
    );
}

#[test]
fn a_link_to_nothing_is_named() {
    for (page, needle) in [
        ("[a](nowhere.md)", "nowhere.md"),
        ("[a](../../../../../x)", "leads out"),
        ("[a](../../other.md)", "bring docs/other.md in"),
        ("{{#include ../../nowhere.md}}\n", "nowhere.md"),
        ("{{#include ../../nowhere.rs}}\n", "does not exist"),
        ("{{#include ../../protocols.md}}\n", "is brought in by"),
    ] {
        let error = format!("{:#}", assembled(page, "start.md").unwrap_err());
        assert!(error.contains(needle), "{page}: {error}");
    }
}

#[test]
fn a_page_that_nobody_would_find_is_named() {
    let root = repository("# Start\n");
    let lost = root.path().join("docs/guide/src/lost.md");
    whole_file::write(&lost, b"# Lost\n").unwrap();
    let libraries = library();
    let error = Guide::read(root.path(), &libraries)
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("does not list lost.md"), "{error}");
}
