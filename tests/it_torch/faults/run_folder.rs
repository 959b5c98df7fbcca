//! The folder of a training: on a full disk, read-only, in use by another process; and training without a network.

use ddl_tests::folder_contents::{assert_same, half_written};
use ddl_tests::mount::Mount;
use ddl_tests::place::Place;
use ddl_tests::trained_model::{TRAIN, finish, result, undisturbed};
use ddl_tests::{nightly, offline, processes};
use std::io::{BufRead as _, BufReader};

/// A run takes about 8 MiB.
const MOST_KIBIBYTES: u64 = 10 << 10;

#[test]
fn training_resumes_when_there_is_room() {
    let place = Place::empty();
    let Some(disk) = Mount::small(place.path(), 4) else {
        return;
    };
    let parts = nightly::rounds(4, 50);
    let mut failed = 0;
    for size in (0..parts).map(|part| 8 + part * MOST_KIBIBYTES / parts) {
        disk.resize(size);
        let finished = place.run(TRAIN);
        if finished.code == Some(0) {
            break;
        }
        let message = finished.fails();
        assert!(message.contains("run/") && message.contains("make room"), "{message}");
        assert_eq!(half_written(place.path()), Vec::<String>::new(), "{size} KiB");
        failed += 1;
    }
    eprintln!("disk full while training: stopped {failed} times, at up to {parts} sizes");
    assert!(failed > 2, "{failed}");
    disk.resize(MOST_KIBIBYTES);
    assert_same(&undisturbed().0, &finish(&place));
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
}

#[test]
fn training_needs_no_network() {
    let Some(way) = offline::way() else { return };
    let place = Place::empty();
    let _ = offline::run(way, &place, TRAIN).succeeds();
    assert_same(&undisturbed().0, &result(&place.at("run")));
}
