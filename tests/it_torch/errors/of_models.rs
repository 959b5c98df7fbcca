//! Runs that are missing, unfinished, damaged, or another's; devices that are not there.

use super::{FORECAST, fails, folder_with_model};
use ddl::Variant;
use ddl_tests::{crowd, program, tiny_model};

#[test]
fn a_missing_model_is_named() {
    let folder = folder_with_model();
    for command_line in [
        "forecast --model nowhere tracks.csv",
        "goals --model nowhere tracks.csv",
        "evaluate --model nowhere",
        "info --model nowhere",
    ] {
        fails(
            folder.path(),
            command_line,
            &["nowhere", "ddl train", "built-in", "zara1, zara2"],
        );
    }
    let report = "report nowhere --out pages";
    fails(folder.path(), report, &["nowhere", "ddl evaluate"]);
}

#[test]
fn an_unfinished_run_is_no_model() {
    let folder = folder_with_model();
    std::fs::remove_file(folder.path().join("run/model.safetensors")).unwrap();
    fails(folder.path(), FORECAST, &["not finished", "ddl train"]);
}

/// Whichever file of the run ends too early, it is named and nothing is forecast from it.
#[test]
fn half_a_file_is_named() {
    for file in [
        "model.safetensors",
        "proposal.safetensors",
        "experts.safetensors",
        "config.json",
    ] {
        let folder = folder_with_model();
        let path = folder.path().join("run").join(file);
        let whole = std::fs::read(&path).unwrap();
        for kept in [whole.len() / 2, whole.len() - 1, 0] {
            std::fs::write(&path, &whole[..kept]).unwrap();
            fails(folder.path(), FORECAST, &[file]);
        }
    }
}

/// Weights of another variant, and weights of the same shapes and goals of another fold, copied over those of the run.
#[test]
fn files_of_another_run_are_refused() {
    let other = tiny_model::folder(Variant::NoDynamics);
    let elsewhere = tempfile::tempdir().unwrap();
    let request = tiny_model::request("plaza", Variant::Full, 40, elsewhere.path());
    tiny_model::train(&request, &crowd::dataset());
    for (from, file, difference) in [
        (
            other.path(),
            "model.safetensors",
            "star.variant is no-dynamics, not full",
        ),
        (
            elsewhere.path(),
            "model.safetensors",
            "data.fold is plaza, not corridor",
        ),
        (
            elsewhere.path(),
            "proposal.safetensors",
            "data.fold is plaza, not corridor",
        ),
        (
            elsewhere.path(),
            "experts.safetensors",
            "data.fold is plaza, not corridor",
        ),
    ] {
        let folder = folder_with_model();
        std::fs::copy(from.join(file), folder.path().join("run").join(file)).unwrap();
        fails(folder.path(), FORECAST, &[file, "another run", difference]);
    }
}

/// A run under way whose state was cut off says what to do, and can be begun anew.
#[test]
fn half_a_state_of_training_is_named() {
    let folder = folder_with_model();
    let run = folder.path().join("run");
    std::fs::remove_file(run.join("model.safetensors")).unwrap();
    let state = run.join("optimizer.safetensors");
    let whole = std::fs::read(&state).unwrap();
    std::fs::write(&state, &whole[..whole.len() / 2]).unwrap();
    let model = ddl::RunDirectory::new(&run);
    let error = tiny_model::train_again(&model).unwrap_err().to_string();
    assert!(
        error.contains("optimizer.safetensors") && error.contains("delete it"),
        "{error}"
    );
    std::fs::remove_file(&state).unwrap();
    tiny_model::train_again(&model).unwrap();
    assert!(model.is_trained());
    // A finished run is finished only as long as it can be loaded.
    std::fs::write(model.model(), &whole[..100]).unwrap();
    let error = tiny_model::train_again(&model).unwrap_err().to_string();
    assert!(
        error.contains("model.safetensors") && error.contains("delete it"),
        "{error}"
    );
    std::fs::remove_file(model.model()).unwrap();
    tiny_model::train_again(&model).unwrap();
    assert!(model.is_trained());
}

/// A run without validation cannot be measured on it, and one without results not be reported.
#[test]
fn what_a_run_does_not_hold_is_said() {
    let folder = folder_with_model();
    let validation = "evaluate --model run --validation";
    fails(folder.path(), validation, &["--validation 0.2"]);
    fails(folder.path(), "report run --out pages", &["ddl evaluate"]);
}

#[test]
fn cuda_that_is_not_there_is_an_error_and_not_the_cpu() {
    let folder = folder_with_model();
    let info = program::run(folder.path(), "info --json").succeeds();
    if info.contains("\"cuda\": \"available\"") {
        eprintln!("skipped: this machine has CUDA");
        return;
    }
    for command_line in [
        "train --convention simulated --fold corridor --out new",
        "evaluate --model run",
        FORECAST,
    ] {
        let on_cuda = format!("{command_line} --device cuda");
        fails(folder.path(), &on_cuda, &["cuda", "--device cpu"]);
    }
}

/// A choice among epochs needs several: one that was kept alone is no choice, and is not passed off as one.
#[test]
fn published_is_not_measured_on_the_last_epoch_alone() {
    let folder = tempfile::tempdir().unwrap();
    let train = "train --convention simulated --fold corridor --epochs 2 --train-walkers 20 \
                 --batch-walkers 20 --proposal-steps 3 --last-epoch-only --out run --threads 1";
    let _ = program::run(folder.path(), train).succeeds();
    let published = "evaluate --model run --protocol published --test-walkers 20";
    let advice = ["`published`", "train it anew without --last-epoch-only"];
    fails(folder.path(), published, &advice);
    // what needs no choice is measured
    let fair = "evaluate --model run --protocol fair --test-walkers 20 --threads 1";
    let _ = program::run(folder.path(), fair).succeeds();
}
