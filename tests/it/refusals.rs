//! Commands that are refused: the exit code, one clear line, and no file written.

use ddl::data::Convention;
use ddl::{GoalRecipe, Variant};
use ddl_tests::place::Place;
use ddl_tests::{crowd, drawn_model, folder_contents, own_tracks};

/// Small files of the folder, as they are in it.
const FILES: [(&str, &str); 21] = [
    ("capitals/A.CSV", "frame,id,x,y\n"),
    ("bag/metadata.yaml", "rosbag2_bagfile_information:\n"),
    ("star/zara01.csv", ""),
    ("H.txt", "1 0 0\n0 1 0\n0 0 1\n"),
    ("results/report.json", "{}"),
    ("results/moments.json", "{}"),
    ("runs/a/report.json", "{}"),
    ("singular.txt", "1 0 0\n1 0 0\n0 0 1\n"),
    ("horizon.txt", "0 0 1\n0 1 0\n1 0 0\n"),
    ("robot.csv", "t,x,y\n0,7,0.3\n4.8,7,0.3\n"),
    ("plans.csv", "plan,t,x,y\na,0,9,1\nb,0,3,-1\n"),
    ("no_y.csv", "t,x\n0,1\n"),
    ("more.csv", "t,x,y,z\n0,1,1,1\n"),
    ("header.csv", "t,x,y\n"),
    ("one_time.csv", "t,id,x,y\n0.4,1,0,0\n"),
    ("text.csv", "t,x,y\n0,1,left\n"),
    ("nan.csv", "t,x,y\n0,NaN,1\n"),
    ("order.csv", "t,x,y\n1,1,1\n0,1,1\n"),
    ("frames.csv", "t,x,y\n100,1,1\n200,1,1\n"),
    ("torn.csv", "plan,t,x,y\na,0,1,1\nb,0,1,1\na,1,1,1\n"),
    ("old/config.json", r#"{"format": 1, "star": {}}"#),
];

/// A folder with models, recordings and tracks, sound ones and others.
fn place() -> Place {
    let place = Place::with_model();
    for (run, lost) in
        [("unfinished", "model.safetensors"), ("without_goals", "proposal.safetensors"), ("old", "config.json")]
    {
        folder_contents::write(drawn_model::contents(Variant::Full), &place.at(run));
        place.remove(&format!("{run}/{lost}"));
    }
    let mut config = drawn_model::config(Variant::Full);
    config.goals = GoalRecipe::retrieved(1);
    drawn_model::write(config, &crowd::windows(20, 10), &place.at("retrieved"));
    let _ = place.ok("pack --model run --out packed");
    std::fs::create_dir(place.at("empty")).unwrap();
    place.write_recordings();
    for (name, steps) in [("one.csv", 1), ("seven.csv", 7), ("short.csv", 12)] {
        place.write_tracks(name, &own_tracks::three_pedestrians(steps));
    }
    for (name, content) in FILES {
        place.write(name, content);
    }
    for name in Convention::Star.file_names() {
        place.write(&format!("wrong/{name}"), "10\t1\t1.0\t2.0\n10\t2\t3.0\t4.0\n");
    }
    place.write("long.txt", "1 ".repeat(1 << 24));
    place.write("folder/tracks.csv", place.read("tracks.csv"));
    std::fs::hard_link(place.at("tracks.csv"), place.at("hard.csv")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("tracks.csv", place.at("link.csv")).unwrap();
    #[cfg(not(unix))]
    std::fs::hard_link(place.at("tracks.csv"), place.at("link.csv")).unwrap();
    place
}

#[test]
fn commands_are_refused_with_the_reason() {
    let place = place();
    let table = include_str!("refusals.txt").replace("FORMAT", &ddl::FORMAT.to_string());
    let (_, cases) = table.split_once("== exit code 1").unwrap();
    let (failures, misuses) = cases.split_once("== exit code 2").unwrap();
    let case = |line| {
        let mut parts = str::split(line, " => ");
        Some((parts.next()?, parts.collect::<Vec<_>>())).filter(|(_, words)| !words.is_empty())
    };
    for (command, words) in failures.lines().filter_map(case) {
        place.fails(command, &words);
    }
    let before = folder_contents::read(place.path());
    for (command, words) in misuses.lines().filter_map(case) {
        let finished = place.run(command);
        assert_eq!(finished.code, Some(2), "{finished:#?}");
        assert!(words.iter().all(|part| finished.stderr.contains(part)), "{finished:#?}");
    }
    place.assert_unchanged_since(&before);
}
