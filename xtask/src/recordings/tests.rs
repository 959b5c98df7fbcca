//! Tests of fetching, without a network.

use super::*;
use crate::cache::write_file;

const ONE: &[u8] = b"1,2,3\n1,1,1\n0.5,0.6,0.7\n8.1,8.2,8.3\n";
const TWO: &[u8] = b"6,12,18\n2,2,2\n1.5,1.6,1.7\n9.1,9.2,9.3\n";

/// Two files, and sources in this folder. Each source has the first file and, if given, these bytes as the second.
fn entry(folder: &Path, seconds: &[Option<&[u8]>]) -> ConventionFiles {
    let mut parts = vec!["description = ''\nterms = ''\ncite = []\n".to_owned()];
    for (index, second) in seconds.iter().enumerate() {
        let source = folder.join(format!("source {index}"));
        if let Some(second) = second {
            write_file(&source.join("one.csv"), ONE).unwrap();
            write_file(&source.join("two.csv"), second).unwrap();
        }
        let address = format!("file://{}/source%20{index}/{{path}}", folder.display());
        parts.push(format!("[[source]]\nname = 'source {index}'\nkind = 'address'\naddress = '{address}'\n"));
    }
    for (name, bytes) in [("one.csv", ONE), ("two.csv", TWO)] {
        write_file(&folder.join(name), bytes).unwrap();
        let (sum, length) = (sha256(&folder.join(name)).unwrap(), bytes.len());
        parts.push(format!("[[file]]\nname = '{name}'\npath = '{name}'\nbytes = {length}\nsha256 = '{sum}'\n"));
    }
    toml::from_str(&parts.concat()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder).unwrap().flatten();
    let mut names: Vec<String> = files.map(|file| file.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_second_fetch_uses_no_source_and_a_damaged_file_is_fetched_again() {
    let [from, to] = [0, 1].map(|_| tempfile::tempdir().unwrap());
    // The first sources lack the second file.
    let entry = entry(from.path(), &[None, Some(b"half"), Some(TWO)]);
    let fetched = || entry.fetch("star", to.path()).unwrap();
    assert_eq!(fetched(), "source 2");
    assert_eq!(fs::read(to.path().join("one.csv")).unwrap(), ONE);
    assert_eq!(names(to.path()), ["one.csv", "two.csv"]);
    assert_eq!(fetched(), "an earlier run");
    fs::write(to.path().join("one.csv"), &ONE[..5]).unwrap();
    let message = entry.check(to.path()).unwrap_err().to_string();
    let is_named = message.contains("1 of 2 files") && message.contains("(one.csv)");
    assert!(is_named, "{message}");
    assert_eq!(fetched(), "source 1");
    entry.check(to.path()).unwrap();
}

#[test]
fn a_wrong_file_is_reported_and_only_right_ones_stay() {
    let swapped: Vec<u8> = TWO.iter().rev().copied().collect();
    for (second, complaint) in [(&TWO[..10], "10 bytes instead of"), (&swapped, "wrong contents")] {
        let [from, to] = [0, 1].map(|_| tempfile::tempdir().unwrap());
        let entry = entry(from.path(), &[Some(second)]);
        let message = format!("{:#}", entry.fetch("star", to.path()).unwrap_err());
        assert!(message.contains("two.csv") && message.contains(complaint), "{message}");
        assert!(!message.contains('\n'), "{message}");
        assert_eq!(names(to.path()), ["one.csv"]);
    }
}

/// A workspace whose manifest leads nowhere.
fn offline() -> (tempfile::TempDir, Workspace) {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(Workspace::find().unwrap().path(MANIFEST)).unwrap();
    let lines = text.lines().map(|line| match line.split_once(" = ") {
        Some(("address", _)) => "address = \"file:///nowhere/{path}\"",
        Some(("package", _)) => "package = \"..//no such package\"",
        _ => line,
    });
    let text = lines.collect::<Vec<_>>().join("\n");
    write_file(&folder.path().join(MANIFEST), text.as_bytes()).unwrap();
    let workspace = Workspace::at(folder.path());
    (folder, workspace)
}

#[test]
fn what_cannot_be_had_is_an_error_and_wrong_files_are_neither_used_nor_replaced() {
    let (folder, workspace) = offline();
    let manifest = Manifest::load(&workspace).unwrap();
    let unknown = manifest.entry("own").unwrap_err().to_string();
    assert!(unknown.contains("name one of star, social-gan"));
    let message = |place: &Path| {
        let outcome = manifest.star.obtain(&workspace, "star", Some("star"), Some(place));
        format!("{:#}", outcome.unwrap_err())
    };
    let complaint = message(&folder.path().join("empty"));
    assert!(complaint.contains("cannot be fetched"), "{complaint}");
    // Also if they are in the folder beside the named one.
    let [data, beside] = ["star", "social-gan"].map(|name| folder.path().join(name));
    fs::create_dir(&beside).unwrap();
    for file in &manifest.star.files {
        write_file(&data.join(&file.name), b"1,2\n1,1\n0,0\n0,0\n").unwrap();
    }
    for place in [&data, &beside] {
        assert!(message(place).contains("8 of 8 files"), "{}", message(place));
        for asked in [None, Some("star")] {
            let error = bring_in_for(&workspace, asked, Some(place)).unwrap_err().to_string();
            assert!(error.contains("8 of 8 files"), "{asked:?}: {error}");
        }
    }
    // Nothing is fetched to a folder that may be mistyped.
    let empty = folder.path().join("empty");
    let outcome = manifest.star.obtain(&workspace, "star", None, Some(&empty));
    assert!(format!("{:#}", outcome.unwrap_err()).contains("correct --data"));
    bring_in_for(&workspace, Some(SIMULATED), Some(&empty)).unwrap();
}

#[test]
fn the_manifest_pins_the_files_of_the_folds() {
    let manifest = Manifest::load(&Workspace::find().unwrap()).unwrap();
    for convention in [ddl_data::Convention::Star, ddl_data::Convention::SocialGan] {
        let entry = manifest.entry(convention.name()).unwrap();
        let mut used: Vec<&str> = convention.file_names().collect();
        let mut pinned: Vec<&str> = entry.files.iter().map(|file| file.name.as_str()).collect();
        used.sort_unstable();
        pinned.sort_unstable();
        assert_eq!(used, pinned, "{convention}");
        assert!(entry.cite.iter().all(|key| manifest.citation.contains_key(key)));
    }
}
