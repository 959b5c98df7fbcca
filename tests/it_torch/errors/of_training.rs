//! What `ddl train` refuses.

use super::{fails, folder_with_model};
use ddl::data::Convention;
use ddl_tests::{program, tiny_model};

/// Training does not go on from half a checkpoint, and does not silently start anew either.
#[test]
fn half_a_checkpoint_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let train = "train --convention simulated --fold corridor --epochs 1 --train-walkers 20 \
                 --batch-walkers 20 --proposal-steps 3 --out run --threads 1";
    let _ = program::run(folder.path(), train).succeeds();
    let run = folder.path().join("run");
    let checkpoint = run.join("optimizer.safetensors");
    let whole = std::fs::read(&checkpoint).unwrap();
    std::fs::write(&checkpoint, &whole[..whole.len() / 2]).unwrap();
    std::fs::remove_file(run.join("model.safetensors")).unwrap();
    fails(folder.path(), train, &["optimizer.safetensors"]);
}

#[test]
fn a_folder_that_holds_another_run_is_not_trained_over() {
    let folder = folder_with_model();
    let walkers = tiny_model::WALKERS;
    let batch = tiny_model::batch_walkers(walkers);
    let recipe = serde_json::to_string(&tiny_model::goal_recipe(1)).unwrap();
    std::fs::write(folder.path().join("recipe.json"), recipe).unwrap();
    for (different, part) in [
        ("--fold corridor --seed 77", "training.seed is 1, not 77"),
        (
            "--fold corridor --variant no-dynamics",
            "star.variant is full, not no-dynamics",
        ),
        // plain STAR has no goals to make a frame of, which is told first
        (
            "--fold corridor --variant star",
            "star.frame is goal, not world",
        ),
        (
            "--fold corridor --recipe published --learning-rate 3e-3",
            "star.feed_forward_width is 128, not 2048",
        ),
        ("--fold plaza", "data.fold is corridor, not plaza"),
    ] {
        // everything else as the tiny model was trained
        let train = format!(
            "train --convention simulated --epochs 1 --train-walkers {walkers} \
             --batch-walkers {batch} --goal-recipe recipe.json --out run {different}"
        );
        fails(folder.path(), &train, &["another run", part]);
        let other_goals = train.replace("--goal-recipe recipe.json", "--proposal-steps 21");
        let other_goals = other_goals.replace(different, "--fold corridor");
        fails(folder.path(), &other_goals, &["another run", "its goals."]);
    }
}

#[test]
fn data_of_another_convention_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    std::fs::create_dir(&data).unwrap();
    let train = "train --fold hotel --data data --out new";
    let missing = ["star", "eth.csv", "--convention simulated"];
    fails(folder.path(), train, &missing);
    // the right names, the wrong content
    for name in Convention::Star.file_names() {
        std::fs::write(data.join(name), "10\t1\t1.0\t2.0\n10\t2\t3.0\t4.0\n").unwrap();
    }
    fails(folder.path(), train, &["eth.csv", "line"]);
}

#[test]
fn an_unknown_fold_is_answered_with_those_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let train = "train --convention simulated --fold eth --out new";
    fails(folder.path(), train, &["eth", "corridor", "plaza"]);
}

/// A number out of range must not leave a folder behind that the corrected command then refuses.
#[test]
fn numbers_out_of_range_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    // should one be taken after all, it must not train for long
    let short = [
        ("--epochs", "1"),
        ("--train-walkers", "1"),
        ("--proposal-steps", "1"),
    ];
    for (option, value, field) in [
        ("--epochs", "0", "epochs"),
        ("--batch-walkers", "0", "batch_walkers"),
        ("--train-walkers", "0", "walkers_per_epoch"),
        ("--learning-rate", "NaN", "learning_rate"),
        ("--proposal-steps", "0", "steps"),
        ("--validation", "NaN", "validation"),
        ("--validation", "1", "validation"),
    ] {
        let mut train =
            "train --convention simulated --fold corridor --out new --threads 1".to_owned();
        let others = short.iter().filter(|(other, _)| *other != option);
        for (option, value) in others.chain(&[(option, value)]) {
            train = format!("{train} {option} {value}");
        }
        fails(folder.path(), &train, &[field, value]);
    }
}
