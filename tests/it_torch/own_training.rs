//! Training on own recordings, alone and with the built-in models: evaluation on the validation part, and starting
//! weights.

use ddl::data::{Convention, Format, write_recording};
use ddl::{RunConfig, RunDirectory};
use ddl_tests::place::Place;
use ddl_tests::{own_tracks, recordings};
use serde_json::Value;

/// Options for a training of a few seconds.
const SMALL: &str = "--train-pedestrians 64 --batch-pedestrians 16 --proposal-steps 5 --threads 1";
const ALONE: &str = "--from none --epochs 3";

fn with_clips(frames: i64, count: i64) -> Place {
    let place = Place::empty();
    place.write_clips(frames, count);
    place
}

fn first_row(report: &Value) -> (f64, u64) {
    let scores = &report["rows"][0]["scores"];
    let (min_ade, pedestrians) = (&scores["min_ade"], &scores["pedestrians"]);
    (min_ade.as_f64().unwrap(), pedestrians.as_u64().unwrap())
}

/// The errors on the validation part, and the numbers of the first and the best epoch. The best epoch is chosen by
/// these errors.
fn errors(run: &RunDirectory) -> (Vec<f64>, usize) {
    let epochs = run.metrics().unwrap();
    let errors: Vec<f64> = epochs.iter().map(|e| e.validation.unwrap()).collect();
    let best = (0..errors.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]));
    (errors, epochs[best.unwrap()].epoch)
}

#[test]
fn own_recordings_are_used_for_training_and_evaluation() {
    let place = Place::with_recordings();
    let train = format!("train --data mine --out run {ALONE} {SMALL}");
    let trained = place.json(&format!("{train} --json"));
    let run = RunDirectory::new(place.at("run"));
    let config: RunConfig = run.config().unwrap();
    assert_eq!(config.data.fold, "none");
    assert_eq!((config.data.validation, config.patience), (0.2, Some(10)));
    let (errors, best) = errors(&run);
    assert_eq!(errors.len(), 3);
    assert_eq!(trained["kept_epoch"], best);
    // The best epoch is the model, and the other epochs are removed.
    assert_eq!(run.kept_epochs().unwrap(), [best]);
    let epoch = format!("run/epochs/{best:03}.safetensors");
    assert_eq!(place.read("run/model.safetensors"), place.read(&epoch));

    // The evaluation reports the error by which the epoch was chosen.
    let report = place.json("evaluate --model run --data mine --validation --protocol fair --threads 1 --json");
    let conditions = &report["rows"][0]["conditions"];
    assert_eq!(conditions["convention"], "own");
    assert_eq!(conditions["selection"], "epoch of the least validation error");
    // There are so few that all of them were evaluated after each epoch.
    let (min_ade, pedestrians) = first_row(&report);
    assert!((50..=1000).contains(&pedestrians), "{pedestrians}");
    assert!((min_ade - errors[best - 1]).abs() < 1e-9, "{min_ade} {errors:?}");

    training_recordings_are_refused_as_test_data(&place);
    // Its results are stored with it, and can be reported.
    let _ = place.ok("report run --out report");
    assert!(place.at("report/report.html").is_file());
    // The best epoch is read before it becomes the model; otherwise nothing is removed.
    place.remove("run/model.safetensors");
    let whole = place.read(&epoch);
    let mut damaged = whole.clone();
    *damaged.last_mut().unwrap() ^= 1;
    place.write(&epoch, damaged);
    place.fails(&train, &["epochs", "is damaged"]);
    place.write(&epoch, &whole);
    let _ = place.ok(&train);
    assert_eq!(place.read("run/model.safetensors"), whole);
    // A gap in the record would restrict the choice to some of the epochs.
    place.remove("run/model.safetensors");
    place.remove("run/metrics.jsonl");
    place.fails(&train, &["no record of epoch 1"]);
}

/// Training recordings are refused as test data, also renamed and alone.
fn training_recordings_are_refused_as_test_data(place: &Place) {
    place.write("renamed.csv", place.read("mine/yard.csv"));
    let evaluate = |data: &str| format!("evaluate --model run --data {data} --threads 1");
    for data in ["mine", "mine/lobby.csv", "renamed.csv"] {
        place.fails(&evaluate(data), &["was trained on"]);
    }
    // A file that was only cut must not be used as test data.
    let text = place.text("mine/yard.csv");
    let (cut, _) = text.trim_end().rsplit_once('\n').unwrap();
    place.write("other/cut.csv", cut);
    place.fails(&evaluate("other"), &["was trained on cut (", "% of its paths are known"]);
}

#[test]
fn a_recording_can_be_left_out_and_the_run_resumes() {
    let place = Place::with_recordings();
    let train = format!("train --data mine --convention own --fold yard --patience 1 {ALONE} {SMALL} --out");
    let message = place.ok(&format!("{train} run"));
    let next = "next: ddl evaluate --model run --data mine\n";
    assert!(message.contains(next), "{message}");
    // Stopped after the goals, then finished by the same command: the same bytes.
    for half in ["--only-goals", ""] {
        let _ = place.ok(&format!("{train} halves {half}"));
    }
    let weights = |run: &str| place.read(&format!("{run}/model.safetensors"));
    assert_eq!(weights("run"), weights("halves"));
    let printed = place.ok("evaluate --model run --data mine --protocol fair --threads 1");
    assert!(printed.contains("yard") && !printed.contains("lobby"), "{printed}");
}

#[test]
fn training_and_evaluation_report_the_same_errors() {
    let place = with_clips(2000, 2);
    let split = "--data clips --validation-recordings clip1";
    let train = format!("train {split} --out run --epochs 1 {SMALL} --progress none");
    let trained = place.json(&format!("{train} --json"));
    let validation = &trained["validation"];
    for (model, part) in [("run", "run"), ("world", "builtin")] {
        let evaluate = "--validation --protocol fair --threads 1 --json --progress none";
        let report = place.json(&format!("evaluate --model {model} {split} {evaluate}"));
        let (min_ade, pedestrians) = first_row(&report);
        assert!(pedestrians > 1000, "{pedestrians}");
        assert_eq!(validation["pedestrians"].as_u64(), Some(pedestrians));
        let said = validation[part]["min_ade"].as_f64().unwrap();
        assert!((said - min_ade).abs() < 1e-9, "{model}: {said} {min_ade}");
    }
    assert_eq!(trained["validation_min_ade"], validation["run"]["min_ade"]);
    // The same command prints them as text when it is run again.
    let words = place.ok(&train);
    for part in ["run", "builtin"] {
        let errors = ["min_ade", "min_fde"].map(|error| validation[part][error].as_f64().unwrap());
        let errors = format!("{:.3}/{:.3}", errors[0], errors[1]);
        assert!(words.contains(&errors), "{errors}: {words}");
    }
    assert!(words.contains("training "), "{words}");
    // Another validation part would contain training data.
    let other = "evaluate --model run --data clips --validation --validation-recordings clip0";
    place.fails(other, &["leave out --validation-recordings"]);
}

#[test]
fn a_training_starts_with_the_weights_of_another_model() {
    let place = with_clips(1500, 2);
    // Training steps that increase the error.
    let train = format!("train --data clips --from hotel --epochs 2 --learning-rate 0.05 {SMALL} --json --out");
    let trained = place.json(&format!("{train} run"));
    assert_eq!(trained["kept_epoch"], 0);
    let run = RunDirectory::new(place.at("run"));
    let from = run.config().unwrap().from.unwrap();
    assert_eq!((from.model.as_str(), from.sha256.len()), ("hotel (built in)", 64));
    let (errors, best) = errors(&run);
    assert_eq!((errors.len(), best), (3, 0), "{errors:?}");
    assert_eq!(run.kept_epochs().unwrap(), [0]);
    // Stopped after the goals, then finished by the same command: the same bytes.
    for half in ["--only-goals", ""] {
        let _ = place.ok(&format!("{train} halves {half}"));
    }
    let weights = |run: &str| place.read(&format!("{run}/model.safetensors"));
    assert_eq!(weights("run"), weights("halves"));
    // A training can also start from a run and from a packed model; other starting weights are another run.
    let _ = place.ok("pack --model run --out packed.safetensors");
    for model in ["run", "packed.safetensors"] {
        let train = train.replace("hotel", model);
        let _ = place.ok(&format!("{train} of-{model}"));
        place.fails(&format!("{train} run"), &["holds another run: its from.model"]);
    }
    let cases = "
--feed-forward-width 16 => star.feed_forward_width is 32, not 16 as requested
--variant no-goal-shift => star.frame is goal, not world as requested
--recipe published => star.feed_forward_width is 32, not 2048 as requested
";
    for case in cases.trim().lines() {
        let (options, words) = case.split_once(" => ").unwrap();
        let line = format!("train --data clips --from hotel {options} --out new {SMALL}");
        place.fails(&line, &["hotel (built in)", words]);
    }
    place.fails("train --data clips --from nowhere --out new", &["nowhere"]);
}

/// Clips of 12 s: their last fifths have no window of 8 s, and too few windows are left for training from scratch.
#[test]
fn short_clips_are_validated_whole_and_start_with_the_built_in_model() {
    let place = with_clips(300, 6);
    let finished = place.run(&format!("train --data clips --out run --epochs 1 {SMALL}"));
    for words in ["(--validation-recordings clip1,clip4)", "weights of the built-in model world (--from none"] {
        assert!(finished.stderr.contains(words), "{finished:?}");
    }
    let _ = finished.succeeds();
    let config: RunConfig = RunDirectory::new(place.at("run")).config().unwrap();
    assert_eq!(config.data.validation_recordings, ["clip1", "clip4"]);
    assert_eq!((config.data.validation, config.patience), (0.0, Some(10)));
    // The built-in model is evaluated on the same clips without an option.
    for data in ["--model run --data clips", "--data clips"] {
        let evaluate = format!("evaluate {data} --validation --protocol fair --threads 1");
        let words = place.ok(&evaluate);
        let recordings = words.lines().filter(|line| line.starts_with("clip"));
        let names: Vec<&str> = recordings.filter_map(|line| line.split(' ').next()).collect();
        assert_eq!(names, ["clip1", "clip4"], "{words}");
        assert!(words.contains("\nvalidation: clip1, clip4 whole\n"), "{words}");
    }
}

#[test]
fn an_empty_validation_part_is_an_error() {
    let place = with_clips(900, 1);
    let train = format!("train --data clips --out run --epochs 1 --from none {SMALL}");
    let message = place.run(&train).fails();
    assert!(message.contains("--validation 0.4"), "{message}");
    assert!(!message.contains("--validation-recordings"), "{message}");
    let _ = place.ok(&format!("{train} --patience 0"));
    for command in ["evaluate --validation", "goals --measure validation"] {
        let line = format!("{command} --model run --data clips --threads 1");
        place.fails(&line, &["--validation 0.4", "20 consecutive time steps"]);
    }
    place.write_tracks("short.csv", &own_tracks::three_pedestrians(12));
    place.fails("train --data short.csv --out new", &["no training windows"]);
}

#[test]
fn a_run_remembers_rate_and_homography() {
    let place = Place::empty();
    place.write_film();
    let units = "--fps 23.98 --homography film/H.txt";
    let train = format!("train --data film --validation 0.3 {units} --epochs 1 --out run {SMALL}");
    let _ = place.ok(&train);
    let units = RunDirectory::new(place.at("run")).config().unwrap().units.unwrap();
    assert_eq!((units.fps, units.dt, units.frame_step), (Some(23.98), None, None));
    assert!(units.homography.is_some());
    place.remove("film/H.txt");
    let measure = "evaluate --model run --data film --validation --threads 1";
    let measured = place.run(&format!("{measure} --protocol single"));
    let note = "note: 3 recordings: the units are those of the run's training (--fps 23.98 and its homography); \
                give --fps";
    assert!(measured.stderr.contains(note), "{measured:?}");
    let _ = measured.succeeds();
    // At another rate these are not the recordings of the training.
    let refused = place.run(&format!("{measure} --protocol fair --fps 25"));
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.stderr.contains("trained on other recordings"), "{refused:?}");
}

/// Errors on recordings that the starting model was trained on are too small, which is told.
#[test]
fn a_starting_model_that_knows_the_recordings_is_told() {
    let Some(dataset) = recordings::dataset(Convention::Star) else {
        return;
    };
    let known = dataset.recording("zara03").unwrap();
    let place = Place::empty();
    place.write("mine/walk.csv", write_recording(known, Format::Table).unwrap());
    let said = place.run(&format!("train --data mine --out run --only-goals {SMALL}"));
    let told = "warning: the starting model was trained on walk: errors on their validation part are too small";
    assert!(said.code == Some(0) && said.stderr.contains(told), "{said:?}");
}
