//! Fetching from a server on this machine that can be as bad as a network can.
#![expect(
    clippy::disallowed_types,
    reason = "the tests play the server that files are fetched from"
)]

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::thread;

use super::*;
use crate::data::manifest::Source;
use crate::digest::measure;

/// What the server sends for a path.
#[derive(Clone)]
struct Answer {
    status: &'static str,
    body: Vec<u8>,
    /// What it says its length is.
    announced: usize,
}

impl Answer {
    fn whole(body: &[u8]) -> Self {
        Self {
            status: "200 OK",
            body: body.to_vec(),
            announced: body.len(),
        }
    }
}

/// Serves for the rest of the test run; the address ends where the path begins.
fn serve(answers: BTreeMap<&'static str, Answer>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            answer(stream, &answers);
        }
    });
    address
}

fn answer(mut stream: TcpStream, answers: &BTreeMap<&'static str, Answer>) {
    let mut lines = BufReader::new(stream.try_clone().unwrap())
        .lines()
        .map_while(Result::ok);
    let path = lines.next().unwrap_or_default();
    let path = path
        .split(' ')
        .nth(1)
        .unwrap_or_default()
        .trim_start_matches('/')
        .to_owned();
    for _ in lines.take_while(|line| !line.is_empty()) {}
    let nothing = Answer {
        status: "404 Not Found",
        body: Vec::new(),
        announced: 0,
    };
    let found = answers.get(path.as_str()).unwrap_or(&nothing);
    // The client may hang up early, which is its right.
    let _ = write!(
        stream,
        "HTTP/1.1 {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        found.status, found.announced
    )
    .and_then(|()| stream.write_all(&found.body));
}

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

fn entry(addresses: &[&str]) -> Entry {
    Entry {
        description: String::new(),
        terms: String::new(),
        cite: Vec::new(),
        sources: addresses
            .iter()
            .enumerate()
            .map(|(index, address)| Source::Address {
                name: format!("source {index}"),
                address: format!("{address}/{{path}}"),
            })
            .collect(),
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

fn good() -> BTreeMap<&'static str, Answer> {
    BTreeMap::from([
        ("data/one.csv", Answer::whole(ONE)),
        ("data/two.csv", Answer::whole(TWO)),
    ])
}

/// A good server but for one answer.
fn bad(answer: Answer) -> String {
    let mut answers = good();
    answers.insert("data/two.csv", answer);
    serve(answers)
}

/// An address where nobody listens: its port was just given back.
fn gone() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    format!("http://{}", listener.local_addr().unwrap())
}

#[test]
fn everything_arrives_and_a_second_fetch_asks_nobody() {
    let folder = tempfile::tempdir().unwrap();
    let entry = entry(&[&serve(good())]);
    assert_eq!(
        try_fetch(&entry, folder.path()).unwrap().as_deref(),
        Some("source 0")
    );
    assert_eq!(fs::read(folder.path().join("one.csv")).unwrap(), ONE);
    assert_eq!(names(folder.path()), ["one.csv", "two.csv"]);
    assert_eq!(try_fetch(&entry, folder.path()).unwrap(), None);
}

#[test]
fn a_bad_answer_is_told_apart_and_leaves_only_right_files() {
    let mut corrupt = TWO.to_vec();
    corrupt[0] ^= 1;
    let cut = Answer {
        announced: TWO.len(),
        ..Answer::whole(&TWO[..10])
    };
    let mut long = TWO.to_vec();
    long.push(b'\n');
    let refused = Answer {
        status: "503 Service Unavailable",
        ..Answer::whole(b"later")
    };
    for (answer, complaint) in [
        (Answer::whole(&corrupt), "wrong contents: SHA-256"),
        (cut, "ended after 10 of"),
        (Answer::whole(&long), "longer than the pinned"),
        (Answer::whole(b""), "ended after 0 of"),
        (refused, "Service Unavailable"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let entry = entry(&[&bad(answer)]);
        let message = format!("{:#}", try_fetch(&entry, folder.path()).unwrap_err());
        assert!(
            message.contains("two.csv") && message.contains(complaint),
            "{message}"
        );
        assert!(!message.contains('\n'), "{message}");
        assert_eq!(names(folder.path()), ["one.csv"]);
    }
}

#[test]
fn the_next_source_gives_what_the_first_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let half = bad(Answer::whole(b"half"));
    let entry = entry(&[&gone(), &half, &serve(good())]);
    let mut said = Vec::new();
    let source = fetch(Convention::Star, &entry, folder.path(), &mut |text| {
        said.push(text.to_owned());
    });
    assert_eq!(source.unwrap(), Some("source 2"));
    assert_eq!(said.len(), 3);
    assert_eq!(names(folder.path()), ["one.csv", "two.csv"]);
}

#[test]
fn no_network_names_every_source_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let gone = gone();
    let error = try_fetch(&entry(&[&gone, &gone]), folder.path()).unwrap_err();
    let message = format!("{error:#}");
    for part in ["source 0", "source 1", "refused"] {
        assert!(message.contains(part), "{message}");
    }
    // Not even an empty folder.
    assert!(!folder.path().exists());
}

#[test]
fn a_damaged_file_is_fetched_again() {
    let folder = tempfile::tempdir().unwrap();
    let entry = entry(&[&serve(good())]);
    try_fetch(&entry, folder.path()).unwrap();
    fs::write(folder.path().join("one.csv"), &ONE[..5]).unwrap();
    let message = check(folder.path(), &entry).unwrap_err().to_string();
    assert!(
        message.contains("1 of 2 files") && message.contains("ended after 5"),
        "{message}"
    );
    try_fetch(&entry, folder.path()).unwrap();
    check(folder.path(), &entry).unwrap();
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
    let entry = entry(&[]);
    let files: Vec<&PinnedFile> = entry.files.iter().collect();
    let target = tempfile::tempdir().unwrap();
    let unpack = |member: &str, files: &[&PinnedFile]| {
        source::unpack(&python, &archive, member, files, target.path())
    };
    // The members lie under p/, the manifest's paths under data/.
    let message = format!("{:#}", unpack("{path}", &files).unwrap_err());
    assert!(message.contains("holds no data/one.csv"), "{message}");
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
