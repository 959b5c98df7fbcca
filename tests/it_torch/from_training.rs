//! `ddl train`: its progress and its files, and the evaluation of its goals before the network is trained.

use ddl::data::{Convention, Window, WindowRule};
use ddl::network::{EpochReport, NetworkFrame, Objective, StarConfig, TrainingConfig};
use ddl::{GoalEvaluation, GoalRecipe, RunConfig, RunDirectory, Variant};
use ddl_tests::place::{Place, json, json_lines};
use ddl_tests::progress::{reported, returns_at_once};
use ddl_tests::{crowd, drawn_model, folder_contents, trained_model};

#[test]
fn a_training_reports_its_steps_and_writes_a_run() {
    let place = Place::empty();
    // 200 pedestrians in batches of 64: 4 steps per epoch.
    let train = "train --convention simulated --fold plaza --recipe published --seed 5 --epochs 2 \
                 --train-pedestrians 200 --batch-pedestrians 64 --proposal-steps 10 --commit 0123abc \
                 --threads 1 --out run";
    let mut steps = reported(&place, train, &["goals", "train"]);
    steps.retain(|step| step.stage == "train");
    assert_eq!(steps.len(), 8);
    assert!(steps[7].message.contains("epoch 2"));
    returns_at_once(&place, train);
    let again = place.ok(train);
    let done = "run: trained, 2 epochs\nnext: ddl evaluate --model run";
    assert!(again.starts_with(done), "{again}");

    let run = RunDirectory::new(place.at("run"));
    for name in ["model", "optimizer", "experts", "proposal", "epochs/001", "epochs/002"] {
        let file = run.path().join(format!("{name}.safetensors"));
        assert!(file.is_file(), "{} is missing", file.display());
    }
    let config = run.config().unwrap();
    assert_eq!(config.data.convention, Convention::Simulated);
    assert_eq!((config.data.fold.as_str(), config.training.seed), ("plaza", 5));
    assert_eq!(config.commit, "0123abc");
    let epochs: Vec<EpochReport> = json_lines(&place.text("run/metrics.jsonl"));
    assert_eq!(epochs, run.metrics().unwrap());
    let numbers: Vec<_> = epochs.iter().map(|epoch| (epoch.epoch, epoch.batches)).collect();
    assert_eq!(numbers, [(1, 4), (2, 4)]);
    assert!(epochs.iter().all(|epoch| epoch.loss.is_finite() && epoch.loss > 0.0));
    let measure = "evaluate --model run --protocol fair --test-pedestrians 20 --threads 1";
    assert!(place.ok(measure).contains("minADE"));
}

#[test]
fn goals_are_measured_before_the_network_is_trained() {
    let place = Place::empty();
    let train = "train --convention simulated --fold plaza --epochs 1 --train-pedestrians 40 \
                 --batch-pedestrians 20 --proposal-steps 8 --validation 0.25 --validation-recordings crossing \
                 --threads 1 --out run";
    let _ = place.ok(&format!("{train} --only-goals"));
    assert!(!place.at("run/model.safetensors").exists());
    let measured = |on: &str| -> GoalEvaluation {
        let line = format!("goals --model run --measure {on} --json --threads 1");
        json(&place.ok(&line))
    };
    let test = measured("test");
    // The whole recording set apart, the last parts of the others, nothing of the test scene.
    let validation = measured("validation");
    let names: Vec<&str> = validation.recordings.keys().map(String::as_str).collect();
    assert_eq!(names, ["bottleneck", "corridor", "crossing", "doorway"]);
    let whole = crowd::dataset().recording("crossing").unwrap().windows(WindowRule::Complete);
    let pedestrians: usize = whole.iter().map(Window::len).sum();
    assert_eq!(validation.recordings["crossing"].pedestrians, pedestrians);
    assert!(validation.windows.contains("crossing whole"), "{}", validation.windows);
    // The same command without --only-goals continues, and the goals stay.
    let before = place.read("run/proposal.safetensors");
    let _ = place.ok(train);
    assert!(place.at("run/model.safetensors").is_file());
    assert!(place.read("run/proposal.safetensors") == before);
    let again = measured("test");
    assert_eq!((again.all, again.recordings), (test.all, test.recordings));
}

/// The configuration of a new run; its network is not trained.
fn started_with(options: &str) -> RunConfig {
    let place = Place::empty();
    let train = "train --convention simulated --fold corridor --only-goals --threads 1 --out run";
    let _ = place.ok(&format!("{train} {options}"));
    RunDirectory::new(place.at("run")).config().unwrap()
}

#[test]
fn the_recommended_recipe_is_the_default() {
    let full = started_with("--proposal-steps 1");
    for variant in Variant::ALL {
        let config = started_with(&format!("--proposal-steps 1 --recipe recommended --variant {variant}"));
        assert_eq!(config.star, StarConfig::recommended(variant));
        assert_eq!(config.training, TrainingConfig::recommended(variant));
        assert!(variant != Variant::Full || config == full);
    }
    let star = (full.star.frame, full.star.feed_forward_width);
    assert_eq!(star, (NetworkFrame::Goal, 32));
    assert_eq!(full.training.objective, Objective::Walk);
}

#[test]
fn the_published_recipe_is_the_papers() {
    let config = started_with("--recipe published");
    let published = StarConfig::published(Variant::Full);
    assert_eq!((&config.star, &config.training), (&published, &TrainingConfig::published()));
    // The numbers of the paper, independent of the constructors.
    let star = (config.star.frame, config.star.feed_forward_width);
    assert_eq!(star, (NetworkFrame::World, 2048));
    let training = (config.training.epochs, config.training.batch_pedestrians);
    assert_eq!((config.training.objective, training), (Objective::NextStep, (200, 256)));
    assert_eq!(config.goals, GoalRecipe::retrieved(1), "the paper has no network of goals");
}

#[test]
fn a_folder_with_another_run_is_not_overwritten() {
    let place = Place::empty();
    folder_contents::write(trained_model::contents(), &place.at("run"));
    let recipe = serde_json::to_string(&drawn_model::goal_recipe(1)).unwrap();
    place.write("recipe.json", recipe);
    let pedestrians = trained_model::PEDESTRIANS;
    let batch = trained_model::BATCH;
    let train = format!(
        "train --convention simulated --epochs 1 --train-pedestrians {pedestrians} --batch-pedestrians {batch} \
         --out run"
    );
    // Plain STAR has no goal frame, which is reported first.
    let cases = "
--fold corridor --seed 77 => training.seed is 1, not 77
--fold corridor --variant no-dynamics => star.variant is full, not no-dynamics
--fold corridor --variant star => star.frame is goal, not world
--fold corridor --recipe published --learning-rate 3e-3 => star.feed_forward_width is 32, not 2048
--fold plaza => data.fold is corridor, not plaza
";
    for case in cases.trim().lines() {
        let (different, part) = case.split_once(" => ").unwrap();
        let line = format!("{train} --goal-recipe recipe.json {different}");
        place.fails(&line, &["another run", part]);
    }
    let other_goals = format!("{train} --fold corridor --proposal-steps 21");
    place.fails(&other_goals, &["another run", "its goals."]);

    // The same options as in the training, with truncated files: the training state, then the model.
    let train = format!("{train} --goal-recipe recipe.json --fold corridor");
    let whole = place.read("run/optimizer.safetensors");
    let model = place.read("run/model.safetensors");
    for name in ["optimizer.safetensors", "model.safetensors"] {
        place.remove("run/model.safetensors");
        let file = format!("run/{name}");
        place.write(&file, &whole[..whole.len() / 2]);
        place.fails(&train, &[name, "delete it"]);
        place.remove(&file);
        let _ = place.ok(&train);
        assert!(place.read("run/model.safetensors") == model, "{name}");
    }
}

/// A number out of range must not leave a folder that the corrected command would refuse.
#[test]
fn numbers_out_of_range_are_refused_before_anything_is_written() {
    let place = Place::empty();
    let eth = "train --convention simulated --fold eth --out new";
    place.fails(eth, &["eth", "corridor", "plaza"]);
    // If a number were accepted by mistake, the training must be short.
    let short = [("--epochs", "1"), ("--train-pedestrians", "1"), ("--proposal-steps", "1")];
    for (option, value, field) in [
        ("--epochs", "0", "epochs"),
        ("--batch-pedestrians", "0", "batch_pedestrians"),
        ("--train-pedestrians", "0", "pedestrians_per_epoch"),
        ("--learning-rate", "NaN", "learning_rate"),
        ("--proposal-steps", "0", "steps"),
        ("--validation", "NaN", "validation"),
        ("--validation", "1", "validation"),
    ] {
        let mut line = format!("train --convention simulated --fold corridor --out new --threads 1 {option} {value}");
        for (other, value) in short.iter().filter(|(other, _)| *other != option) {
            line = format!("{line} {other} {value}");
        }
        place.fails(&line, &[field, value]);
    }
}

#[test]
fn missing_cuda_is_reported() {
    let place = Place::with_model();
    if place.json("info --json")["cuda"] == "yes" {
        eprintln!("skipped: this machine has CUDA");
        return;
    }
    for line in [
        "train --convention simulated --fold corridor --out new",
        "evaluate --model run",
        "forecast --model run tracks.csv",
    ] {
        place.fails(&format!("{line} --device cuda"), &["cuda", "--device cpu"]);
    }
}
