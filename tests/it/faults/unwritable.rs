//! Outputs in folders that are read-only or do not exist.

use super::EVALUATE;
use ddl_tests::folder_contents;
use ddl_tests::mount::Mount;
use ddl_tests::place::Place;

/// The first two commands create the folder of their outputs, the others do not.
fn outputs(folder: &str) -> [String; 6] {
    [
        format!("{EVALUATE} --out {folder}/report"),
        format!("report made --out {folder}/page"),
        format!("forecast --model run tracks.csv --output {folder}/forecasts.csv"),
        format!("pack --model run --out {folder}/packed"),
        format!("windows --convention simulated --fold corridor --output {folder}/windows.jsonl"),
        format!("forecast - --frame-step 1 --model run --output {folder}/live.csv"),
    ]
}

fn with_results() -> Place {
    let place = Place::with_model();
    let _ = place.ok(&format!("{EVALUATE} --out made"));
    place
}

#[test]
fn a_read_only_directory_is_reported() {
    let place = with_results();
    let fixed = place.at("fixed");
    std::fs::rename(place.at("run"), &fixed).unwrap();
    std::os::unix::fs::symlink("fixed", place.at("run")).unwrap();
    let Some(_mounted) = Mount::read_only(&fixed) else {
        return;
    };
    let before = folder_contents::read(&fixed);
    for command in outputs("fixed") {
        place.fails(&command, &["fixed", "choose a writable place"]);
    }
    // A model in such a folder can be read, and evaluated with an output elsewhere.
    let _ = place.ok("forecast --model run tracks.csv");
    let _ = place.ok(&format!("{EVALUATE} --out again"));
    folder_contents::assert_same(&before, &folder_contents::read(&fixed));
}

#[test]
fn a_missing_folder_is_reported() {
    let place = with_results();
    for command in outputs("tracks.csv") {
        place.fails(&command, &["tracks.csv"]);
    }
    let single = &outputs("nowhere")[2..];
    for command in single {
        place.fails(command, &["nowhere"]);
    }
}
