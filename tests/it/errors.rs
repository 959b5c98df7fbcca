//! Errors: exit code 1, one clear line, and no file written.

use ddl::Variant;
use ddl_tests::place::Place;
use ddl_tests::{crowd, drawn_model};

const FORECAST: &str = "forecast --model run tracks.csv --output out.csv";

/// Results may be replaced, and lie beside the recordings.
#[test]
fn outputs_are_overwritten() {
    let place = Place::with_model();
    place.write_recordings();
    for _ in 0..2 {
        let _ = place.ok("windows --convention own --data mine --output mine/windows.jsonl");
        let _ = place.ok("pack --model run --out run/packed.safetensors");
    }
    // Ordinary files in a folder of the system.
    #[cfg(target_os = "linux")]
    {
        let file = format!("/dev/shm/ddl-{}.csv", std::process::id());
        std::fs::write(&file, "old\n".repeat(100_000)).unwrap();
        let _ = place.ok(&format!("forecast tracks.csv --model run --output {file}"));
        let made = std::fs::read_to_string(&file).unwrap();
        std::fs::remove_file(file).unwrap();
        assert!(made.len() > 1000 && !made.contains("old"));
    }
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

/// The protocol `published` chooses among epochs and needs several of them; a run with one of its epochs is refused.
#[test]
fn a_run_without_its_epochs_is_refused() {
    let place = Place::empty();
    let mut config = drawn_model::config(Variant::Full);
    config.training.epochs = 2;
    drawn_model::write(config, &crowd::windows(60, 10), &place.at("last"));
    let published = "evaluate --model last --protocol published --test-pedestrians 20";
    place.fails(published, &["`published`", "train it again, with --patience 0"]);
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
training: benchmark --convention simulated
CUDA: train --convention simulated --fold plaza --out new --device cuda
CUDA: forecast --model run tracks.csv --device cuda
CUDA: evaluate --model run --device cuda
CUDA: goals --measure test --device cuda
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
