//! Tests of the options of a plan.

use super::*;
use clap::Parser;

#[derive(Debug, Parser)]
struct Line {
    #[command(flatten)]
    choice: PlanOptions,
}

fn parsed(words: &str) -> PlanOptions {
    let words = std::iter::once("benchmark").chain(words.split_whitespace());
    Line::try_parse_from(words).unwrap().choice
}

pub(in super::super) fn plan_of(words: &str) -> anyhow::Result<BenchmarkPlan> {
    parsed(words).plan_of(Convention::Star, Some("/recordings".into()))
}

/// Folder, tasks and scored pedestrians of a plan, and how it trains.
fn planned(words: &str) -> String {
    let plan = plan_of(words).unwrap();
    let out = usual_folder(&plan);
    let out = out.strip_prefix("runs").unwrap();
    let train = plan.train_arguments(&plan.tasks[0], Path::new(""), 1);
    let (_, train) = train.split_at(11); // convention, data, fold, variant and seed
    let end = train.iter().position(|word| word == "--out").unwrap();
    let scored = plan.settings.test_pedestrians.map_or("all".to_owned(), |n| n.to_string());
    format!("{} {} {scored}: {}", out.display(), plan.tasks.len(), train[..end].join(" "))
}

#[test]
fn the_recipe_and_the_folder_follow_the_protocols() {
    let published = "--protocol published,fair,single --profile";
    for (words, expected) in [
        ("--protocol single,fair --protocol fair", "star-quick 5 2500: --epochs 10 --recipe recommended"),
        (
            "--profile smoke",
            "star-smoke 2 150: --epochs 1 --train-pedestrians 600 --proposal-steps 40 --recipe recommended",
        ),
        (
            "--profile paper --protocol single --variants all --seeds 1,2",
            "star-paper 50 all: --epochs 20 --recipe recommended",
        ),
        (
            "--epochs 3 --train-pedestrians 70 --test-pedestrians 80",
            "star-quick 5 80: --epochs 3 --train-pedestrians 70 --recipe recommended",
        ),
        (
            &format!("{published} smoke"),
            "star-smoke-published 2 150: --epochs 1 --train-pedestrians 600 --recipe published --batch-pedestrians 256 \
             --learning-rate 0.0015 --learning-rate-schedule constant",
        ),
        (
            &format!("{published} quick"),
            "star-quick-published 5 2500: --epochs 10 --train-pedestrians 4000 --recipe published --batch-pedestrians \
             16 --learning-rate 0.001 --learning-rate-schedule cosine",
        ),
        (
            "--profile paper --protocol published",
            "star-paper-published 5 all: --epochs 200 --recipe published --batch-pedestrians 256 --learning-rate \
             0.0015 --learning-rate-schedule constant",
        ),
    ] {
        assert_eq!(planned(words), expected, "{words}");
    }
}

#[test]
fn unknown_names_are_refused_with_the_known_ones() {
    let error = |words: &str| plan_of(words).unwrap_err().to_string();
    assert_eq!(
        error("--variants star,ful"),
        "unknown variant \"ful\": choose from full, no-goal-shift, no-dynamics, star, perceptron"
    );
    assert_eq!(error("--folds plaza"), "unknown fold \"plaza\": choose from eth, hotel, univ, zara1, zara2");
    let error_of_own = parsed("--convention own").recordings().unwrap_err();
    assert!(error_of_own.to_string().contains("`ddl train`"), "{error_of_own}");
    // A named folder without recordings is an error, not a reason to simulate.
    let empty = parsed("--data /nowhere").recordings().unwrap_err();
    assert!(format!("{empty:#}").contains("/nowhere"), "{empty:#}");
}
