//! Errors: exit code 1, one clear line, and no file written.

use ddl::Variant;
use ddl::data::Convention;
use ddl_tests::place::Place;
use ddl_tests::{crowd, drawn_model, own_tracks};

const FORECAST: &str = "forecast --model run tracks.csv --output out.csv";

#[test]
fn a_missing_model_is_reported() {
    let place = Place::with_model();
    for command in ["forecast tracks.csv", "goals tracks.csv", "evaluate", "info"] {
        let line = format!("{command} --model nowhere");
        place.fails(&line, &["nowhere", "ddl train", "built-in", "zara1, zara2"]);
    }
    place.fails("report nowhere --out pages", &["nowhere", "ddl evaluate"]);
    place.remove("run/model.safetensors");
    place.fails(FORECAST, &["not finished", "ddl train"]);
}

/// No output of any command may be one of its inputs, whatever the options, links included.
#[test]
fn no_input_is_overwritten() {
    let place = Place::with_model();
    place.write("H.txt", "1 0 0\n0 1 0\n0 0 1\n");
    place.write("folder/tracks.csv", place.read("tracks.csv"));
    place.write("recipe.json", "{}");
    place.write("results/report.json", "{}");
    place.write("results/moments.json", "{}");
    place.write("runs/a/report.json", "{}");
    std::fs::hard_link(place.at("tracks.csv"), place.at("hard.csv")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("tracks.csv", place.at("link.csv")).unwrap();
    let lines = [
        "forecast tracks.csv --output ./tracks.csv",
        "forecast tracks.csv --model run --output run/fingerprints.bin",
        "forecast tracks.csv --output hard.csv",
        #[cfg(unix)]
        "forecast tracks.csv --output link.csv",
        "forecast tracks.csv --homography H.txt --output H.txt",
        "forecast tracks.csv --model run/model.safetensors --output run/model.safetensors",
        "forecast - --memory tracks.csv --output tracks.csv",
        "view tracks.csv --output tracks.csv",
        "view tracks.csv --homography H.txt --output H.txt",
        "goals tracks.csv --output tracks.csv",
        "goals --measure test --data tracks.csv --output tracks.csv",
        "goals --measure test --data folder --output folder/tracks.csv",
        "data tracks.csv --svg tracks.csv",
        "windows --convention own --data tracks.csv --output tracks.csv",
        "windows --convention own --data folder --output folder/tracks.csv",
        "evaluate --data tracks.csv --forecasts results/report.json --out results",
        "evaluate --data tracks.csv --model results/moments.json --out results",
        "report runs/a --out runs/a",
        "pack --model run --out run/model.safetensors",
        "pack --model run --out run/config.json",
    ];
    let contents = || -> Vec<Vec<u8>> {
        let files = [
            "tracks.csv",
            "H.txt",
            "folder/tracks.csv",
            "results/report.json",
            "run/model.safetensors",
        ];
        files.into_iter().map(|file| place.read(file)).collect()
    };
    let before = contents();
    for line in lines {
        place.fails(line, &["give another"]);
        assert!(contents() == before, "{line}");
    }
    // Results may be replaced, and lie beside the recordings.
    place.write_recordings();
    for _ in 0..2 {
        let _ = place.ok("windows --convention own --data mine --output mine/windows.jsonl");
        let _ = place.ok("pack --model run --out run/packed.safetensors");
    }
    assert!(contents() == before);
}

#[test]
fn files_of_another_run_are_refused() {
    let [other, elsewhere] = [Place::with_variant(Variant::NoDynamics), Place::empty()];
    let mut config = drawn_model::config(Variant::Full);
    config.data.fold = "plaza".to_owned();
    drawn_model::write(config, &crowd::windows(20, 10), &elsewhere.at("run"));
    let fold = "data.fold is plaza, not corridor";
    let place = Place::with_model();
    for (from, file, difference) in [
        (&other, "model", "star.variant is no-dynamics, not full"),
        (&elsewhere, "model", fold),
        (&elsewhere, "proposal", fold),
        (&elsewhere, "experts", fold),
    ] {
        let file = format!("{file}.safetensors");
        let name = format!("run/{file}");
        let whole = place.read(&name);
        place.write(&name, from.read(&name));
        place.fails(FORECAST, &[&file, "another run", difference]);
        place.write(&name, whole);
    }
}

/// A run without validation cannot be evaluated on it, and one without results cannot be reported. The protocol
/// `published` chooses among epochs and needs several of them; a run with only the last epoch is refused.
#[test]
fn missing_parts_of_a_run_are_reported() {
    let place = Place::with_model();
    place.fails("evaluate --model run --validation", &["--validation 0.2"]);
    place.fails("report run --out pages", &["ddl evaluate"]);
    let mut config = drawn_model::config(Variant::Full);
    config.training.epochs = 2;
    config.keep_every = 2;
    drawn_model::write(config, &crowd::windows(60, 10), &place.at("last"));
    std::fs::rename(
        place.at("last/epochs/001.safetensors"),
        place.at("last/epochs/002.safetensors"),
    )
    .unwrap();
    let published = "evaluate --model last --protocol published --test-pedestrians 20";
    place.fails(published, &["`published`", "train it again without --last-epoch-only"]);
    // Protocols without this choice can be evaluated.
    let _ = place.ok("evaluate --model last --protocol fair --test-pedestrians 20 --threads 1");
}

#[cfg(not(feature = "torch"))]
#[test]
fn commands_that_need_libtorch_explain_how_to_get_it() {
    use ddl_tests::program::WITHOUT_LIBTORCH;

    let place = Place::with_model();
    let cases = "
training: train --convention simulated --fold plaza --out new
CUDA: train --convention simulated --fold plaza --out new --device cuda
CUDA: forecast --model run tracks.csv --device cuda
CUDA: evaluate --model run --device cuda
CUDA: goals tracks.csv --device cuda
";
    for case in cases.trim().lines() {
        let (what, line) = case.split_once(": ").unwrap();
        let needs = format!("{what} {WITHOUT_LIBTORCH}");
        let build = "cargo build --release -p ddl-cli --features torch";
        place.fails(line, &[&needs, "`cargo xtask setup`", build]);
    }
    // Without an explicit device, the program uses the CPU.
    let _ = place.ok("forecast --model run tracks.csv --device auto");
    let cuda = &place.json("info --json")["cuda"];
    assert!(cuda.as_str().unwrap().contains(WITHOUT_LIBTORCH), "{cuda}");
}

#[test]
fn recordings_that_cannot_be_trained_on_are_refused() {
    let place = Place::empty();
    let train = "train --fold hotel --data data --out new";
    std::fs::create_dir(place.at("data")).unwrap();
    place.fails(train, &["star", "eth.csv", "--convention simulated"]);
    // Files with the right names and the wrong content.
    for name in Convention::Star.file_names() {
        place.write(&format!("data/{name}"), "10\t1\t1.0\t2.0\n10\t2\t3.0\t4.0\n");
    }
    place.fails(train, &["eth.csv", "line"]);
}

#[test]
fn tracks_that_cannot_be_forecast_are_refused() {
    let place = Place::with_model();
    let nowhere = "view tracks.csv --output nowhere/page.html";
    place.fails(
        nowhere,
        &["--output: the folder nowhere does not exist; create it first"],
    );
    let missing = "cannot read nowhere.csv: No such file or directory (os error 2)";
    assert_eq!(place.run("forecast nowhere.csv").fails(), missing);
    place.write_tracks("tracks.csv", &own_tracks::three_pedestrians(7));
    let whole = format!("{FORECAST} --whole");
    place.fails(&whole, &["tracks.csv", "was tracked for all 8 steps", "10 frames"]);
    place.write_tracks("tracks.csv", &own_tracks::three_pedestrians(1));
    place.fails(FORECAST, &["tracks.csv", "has two rows that fit", "--fps"]);
    place.all_fail(&[
        "forecast --model run . => . is a folder",
        "forecast --model run . => ddl data .",
        "data - => ddl forecast -",
        "data - => give a file",
        "view - => a file of tracks",
        "view nowhere.csv => cannot read nowhere.csv",
    ]);
    place.all_refused(&["view => <TRACKS>"]);
}

#[test]
fn an_invalid_homography_or_rate_is_reported() {
    let place = Place::with_model();
    let options = format!("{FORECAST} --homography H.txt");
    place.fails(&options, &["H.txt", "No such file"]);
    place.write("H.txt", "1 0 0\n1 0 0\n0 0 1\n");
    place.fails(&options, &["H.txt", "singular"]);
    place.write("H.txt", "1 ".repeat(1 << 20));
    place.fails(&options, &["H.txt: more than a megabyte"]);
    place.write("H.txt", "0 0 1\n0 1 0\n1 0 0\n"); // x = 0 is the horizon
    place.fails(&options, &["tracks.csv", "pedestrian 1, frame 0", "horizon"]);
    // The rows are 10 frames apart.
    place.fails(&format!("{FORECAST} --fps 5"), &["tracks.csv", "2.00 s apart"]);
    place.all_refused(&[
        "forecast tracks.csv --fps 0 => above 0",
        "forecast tracks.csv --fps many => must be a number",
        "forecast tracks.csv --dt=-1 => above 0",
        "forecast tracks.csv --fps 25 --dt 0.04 => cannot be used with",
        "forecast tracks.csv --fps 25 --frame-step 10 => cannot be used with",
        "forecast tracks.csv --columns frame => must be like frame=frame_id,x=xCenter",
        "forecast tracks.csv --columns x=a,x=b => a second time",
        "forecast tracks.csv --keep class => must be like class=Pedestrian",
        "forecast tracks.csv --unit km => possible values: m, cm, mm, px",
        "goals --data . => --measure",
    ]);
}
