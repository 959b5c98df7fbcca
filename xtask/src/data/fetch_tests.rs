use std::fs;

use super::*;
use crate::data::manifest::Source;
use crate::digest::measure;

const ONE: &[u8] = b"1,2,3\n1,1,1\n0.5,0.6,0.7\n8.1,8.2,8.3\n";
const TWO: &[u8] = b"6,12,18\n2,2,2\n1.5,1.6,1.7\n9.1,9.2,9.3\n";

fn pinned(name: &str, contents: &[u8]) -> PinnedFile {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, contents).unwrap();
    let (sha256, bytes) = measure(&path).unwrap();
    PinnedFile {
        name: name.to_owned(),
        path: format!("data/{name}"),
        bytes,
        sha256,
    }
}

/// The two files, and sources in this folder. Each source holds the first file and, unless it is `None`, the given
/// bytes as the second.
fn entry(folder: &Path, seconds: &[Option<&[u8]>]) -> Entry {
    let source = |(index, second): (usize, Option<&[u8]>)| {
        let data = folder.join(format!("source {index}/data"));
        if let Some(second) = second {
            fs::create_dir_all(&data).unwrap();
            fs::write(data.join("one.csv"), ONE).unwrap();
            fs::write(data.join("two.csv"), second).unwrap();
        }
        let address = format!("file://{}/source%20{index}/{{path}}", folder.display());
        Source::Address {
            name: format!("source {index}"),
            address,
        }
    };
    Entry {
        description: String::new(),
        terms: String::new(),
        cite: Vec::new(),
        sources: seconds.iter().copied().enumerate().map(source).collect(),
        files: vec![pinned("one.csv", ONE), pinned("two.csv", TWO)],
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

fn try_fetch(entry: &Entry, folder: &Path) -> Result<Option<String>> {
    fetch(Convention::Star, entry, folder, &mut |_| {}).map(|name| name.map(str::to_owned))
}

#[test]
fn a_second_fetch_uses_no_source_and_a_damaged_file_is_fetched_again() {
    let [from, to] = [0, 1].map(|_| tempfile::tempdir().unwrap());
    let entry = entry(from.path(), &[Some(TWO)]);
    let fetched = || try_fetch(&entry, to.path()).unwrap();
    assert_eq!(fetched().as_deref(), Some("source 0"));
    assert_eq!(fs::read(to.path().join("one.csv")).unwrap(), ONE);
    assert_eq!(names(to.path()), ["one.csv", "two.csv"]);
    assert_eq!(fetched(), None);
    fs::write(to.path().join("one.csv"), &ONE[..5]).unwrap();
    let message = check(to.path(), &entry).unwrap_err().to_string();
    assert!(
        message.contains("1 of 2 files") && message.contains("ended after 5"),
        "{message}"
    );
    assert_eq!(fetched().as_deref(), Some("source 0"));
    check(to.path(), &entry).unwrap();
}

#[test]
fn a_wrong_file_is_reported_and_only_right_ones_stay() {
    let [from, to] = [0, 1].map(|_| tempfile::tempdir().unwrap());
    let entry = entry(from.path(), &[Some(&TWO[..10])]);
    let message = format!("{:#}", try_fetch(&entry, to.path()).unwrap_err());
    for part in ["two.csv", "ended after 10 of"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(!message.contains('\n'), "{message}");
    assert_eq!(names(to.path()), ["one.csv"]);
}

#[test]
fn the_next_source_is_used_for_files_that_the_first_lacks() {
    let [from, to] = [0, 1].map(|_| tempfile::tempdir().unwrap());
    let entry = entry(from.path(), &[None, Some(b"half"), Some(TWO)]);
    let mut said = Vec::new();
    let source = fetch(Convention::Star, &entry, to.path(), &mut |text| {
        said.push(text.to_owned());
    });
    assert_eq!(source.unwrap(), Some("source 2"));
    assert_eq!(said.len(), 3);
    assert_eq!(names(to.path()), ["one.csv", "two.csv"]);
}

#[test]
fn members_of_an_archive_are_checked_one_by_one() {
    let folder = tempfile::tempdir().unwrap();
    let archive = folder.path().join("package.tar.gz");
    let python = Python::find().unwrap();
    let script = "import io, sys, tarfile\n\
                  with tarfile.open(sys.argv[1], 'w:gz') as tar:\n\
                  \x20for name, text in zip(sys.argv[2::2], sys.argv[3::2]):\n\
                  \x20 info = tarfile.TarInfo(name); info.size = len(text)\n\
                  \x20 tar.addfile(info, io.BytesIO(text.encode()))\n";
    let one = std::str::from_utf8(ONE).unwrap();
    let members = [
        archive.to_str().unwrap(),
        "p/one.csv",
        one,
        "p/two.csv",
        "something else",
    ];
    crate::python::read(&mut python.script(script, members)).unwrap();
    let entry = entry(folder.path(), &[]);
    let files: Vec<&PinnedFile> = entry.files.iter().collect();
    let target = tempfile::tempdir().unwrap();
    let unpack = |member: &str, files: &[&PinnedFile]| source::unpack(&python, &archive, member, files, target.path());
    // The members are below p/, the paths of the manifest below data/.
    let message = format!("{:#}", unpack("{path}", &files).unwrap_err());
    assert!(message.contains("has no data/one.csv"), "{message}");
    let moved: Vec<PinnedFile> = entry
        .files
        .iter()
        .map(|file| PinnedFile {
            path: file.name.clone(),
            ..file.clone()
        })
        .collect();
    let moved: Vec<&PinnedFile> = moved.iter().collect();
    let message = format!("{:#}", unpack("p/{path}", &moved).unwrap_err());
    assert!(message.contains("two.csv in the archive"), "{message}");
    assert_eq!(names(target.path()), ["one.csv"]);
    unpack("p/{path}", &moved[..1]).unwrap();
}
