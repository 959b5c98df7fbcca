//! The folder of a training: on a full disk, read-only, in use by another process; and training without a network.

use ddl_tests::folder_contents::{assert_same, half_written};
use ddl_tests::mount::Mount;
use ddl_tests::place::Place;
use ddl_tests::trained_model::{TRAIN, finish, result};
use ddl_tests::{figures, offline, processes};
use std::io::{BufRead as _, BufReader};

/// A run takes about 8 MiB.
const MOST_KIBIBYTES: u64 = 10 << 10;

#[test]
fn training_resumes_when_there_is_room() {
    let (whole, place) = (Place::empty(), Place::empty());
    let expected = finish(&whole);
    let Some(disk) = Mount::small(place.path(), 4) else {
        return;
    };
    let sizes: Vec<u64> = if figures::are_asked_for() {
        (1..50).map(|part| part * MOST_KIBIBYTES / 50).collect()
    } else {
        vec![8, 1 << 10, 5 << 10, 7 << 10]
    };
    let mut failed = Vec::new();
    for size in sizes {
        disk.resize(size);
        let finished = place.run(TRAIN);
        if finished.code == Some(0) {
            break;
        }
        let message = finished.fails();
        assert!(message.contains("run/") && message.contains("make room"), "{message}");
        assert_eq!(half_written(place.path()), Vec::<String>::new(), "{size} KiB");
        failed.push(message.split(": ").next().unwrap_or_default().to_owned());
    }
    assert!(failed.len() > 2, "{failed:?}");
    let tried = failed.len();
    failed.dedup();
    disk.resize(MOST_KIBIBYTES);
    assert_same(&expected, &finish(&place));
    figures::tell(
        "disk full while training",
        format!("{tried} times in one run, with a little more room each time"),
        format!(
            "stopped at {} different files, each named in the error; then the same bytes",
            failed.len()
        ),
    );
}

#[test]
fn a_read_only_folder_is_reported() {
    let place = Place::empty();
    place.write("file", "");
    let train = "train --convention simulated --fold plaza --threads 1 --out";
    place.fails(&format!("{train} file/new"), &["file/new"]);
    std::fs::create_dir(place.at("fixed")).unwrap();
    let Some(_mounted) = Mount::read_only(&place.at("fixed")) else {
        return;
    };
    place.fails(&format!("{train} fixed/new"), &["fixed", "choose a writable place"]);
}

#[test]
fn a_second_training_in_the_same_directory_is_refused() {
    let place = Place::empty();
    let mut first = place.start(&format!("{TRAIN} --progress json"));
    let mut lines = BufReader::new(first.stdout.take().unwrap()).lines();
    lines.next().unwrap().unwrap();
    // The first training must not continue meanwhile.
    processes::signal(first.id(), "STOP");
    for _ in 0..3 {
        place.fails(TRAIN, &["run run:", "another process", "choose another"]);
    }
    // Another directory can be used.
    let _ = place.ok(&TRAIN.replace("--out run", "--out other"));
    first.kill().unwrap();
    first.wait().unwrap();
    let _ = place.ok(TRAIN);
    figures::tell(
        "two trainings in one directory",
        "the second 3 times, then after a `kill -9` of the first",
        "refused each time with the name of the directory; accepted after the kill",
    );
}

#[test]
fn training_needs_no_network() {
    let Some(way) = offline::way() else { return };
    let (place, elsewhere) = (Place::empty(), Place::empty());
    let _ = offline::run(way, &place, TRAIN).succeeds();
    assert_same(&finish(&elsewhere), &result(&place.at("run")));
    figures::tell(
        "no network while training",
        "1 training in a network namespace without interfaces",
        "the same bytes as with a network",
    );
}
