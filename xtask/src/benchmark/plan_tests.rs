//! What a plan holds, says to the program, and refuses.

use super::*;
use crate::benchmark::{PUBLISHED, RECOMMENDED};

pub(crate) fn settings() -> Settings {
    Settings {
        profile: "quick".to_owned(),
        convention: "star".to_owned(),
        data: Some(PathBuf::from("/recordings")),
        device: "cpu".to_owned(),
        cargo_profile: "release".to_owned(),
        epochs: 4,
        train_walkers: Some(800),
        proposal_steps: Some(30),
        test_walkers: None,
        protocols: PROTOCOLS.map(str::to_owned).to_vec(),
        recipe: PUBLISHED,
    }
}

fn plan(folds: &[&str], variants: &[&str], seeds: &[u64]) -> Result<Plan> {
    let owned = |names: &[&str]| {
        names
            .iter()
            .map(|&name| name.to_owned())
            .collect::<Vec<_>>()
    };
    Plan::new(settings(), &owned(folds), &owned(variants), seeds)
}

#[test]
fn every_combination_is_there_once_and_the_longest_comes_first() {
    let plan = plan(&["eth", "univ", "zara2"], &["full", "star"], &[1, 2]).unwrap();
    assert_eq!(plan.tasks.len(), 12);
    assert!(
        plan.tasks
            .windows(2)
            .all(|pair| pair[0].cost() >= pair[1].cost())
    );
    let ids: Vec<&str> = plan
        .tasks
        .iter()
        .map(|task| task.id.as_str())
        .take(4)
        .collect();
    assert_eq!(
        ids,
        ["univ-full-1", "univ-full-2", "univ-star-1", "univ-star-2"]
    );
}

#[test]
fn nothing_and_twice_the_same_are_refused() {
    assert!(plan(&[], &["full"], &[1]).is_err());
    let message = plan(&["eth", "eth"], &["full"], &[1])
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("eth-full-1 is asked for twice"),
        "{message}"
    );
}

#[test]
fn the_perceptron_is_the_full_method_with_another_backbone() {
    let plan = plan(&["eth"], &["perceptron"], &[7]).unwrap();
    let arguments = plan.train_arguments(&plan.tasks[0], Path::new("runs/x"), 1);
    let words = arguments.join(" ");
    assert!(words.contains("--backbone perceptron"), "{words}");
    assert!(words.contains("runs/x/eth-perceptron-7/run"), "{words}");
    assert!(!words.contains("--variant"), "{words}");
}

#[test]
fn the_arguments_are_those_the_program_knows() {
    let mut plan = plan(&["eth"], &["full"], &[7]).unwrap();
    let out = Path::new("runs/x");
    assert_eq!(
        plan.train_arguments(&plan.tasks[0], out, 1).join(" "),
        "train --convention star --data /recordings --fold eth --variant full --seed 7 \
         --epochs 4 --train-walkers 800 --proposal-steps 30 --recipe published --batch-walkers 256 \
         --learning-rate 0.0015 --learning-rate-schedule constant --out runs/x/eth-full-7/run --device cpu --threads 1 \
         --progress json"
    );
    // Of the recommended recipe nothing is changed that nobody asked to have changed.
    let recommended = Settings {
        recipe: RECOMMENDED,
        train_walkers: None,
        proposal_steps: None,
        protocols: vec!["fair".to_owned(), "single".to_owned()],
        ..settings()
    };
    let folds = ["eth".to_owned()];
    let recommended = Plan::new(recommended, &folds, &["full".to_owned()], &[7]).unwrap();
    assert_eq!(
        recommended
            .train_arguments(&recommended.tasks[0], out, 1)
            .join(" "),
        "train --convention star --data /recordings --fold eth --variant full --seed 7 --epochs 4 \
         --recipe recommended --out runs/x/eth-full-7/run --device cpu --threads 1 --progress json \
         --last-epoch-only"
    );
    plan.settings.data = None;
    assert_eq!(
        plan.evaluate_arguments(&plan.tasks[0], out, 2).join(" "),
        "evaluate --model runs/x/eth-full-7/run --protocol published --protocol fair \
         --protocol single --device cpu --threads 2 --progress json"
    );
    assert_eq!(
        plan.goals_arguments(&plan.tasks[0], out, 2).join(" "),
        "goals --json --model runs/x/eth-full-7/run --measure test --svg runs/x/eth-full-7/goals.svg \
         --output runs/x/eth-full-7/goals.json --device cpu --threads 2"
    );
}

/// Without `published` no epoch but the last is kept, and nothing is scored under it.
#[test]
fn published_is_neither_kept_nor_scored_unless_asked_for() {
    let mut plan = plan(&["eth"], &["full"], &[7]).unwrap();
    let out = Path::new("runs/x");
    let train = |plan: &Plan| plan.train_arguments(&plan.tasks[0], out, 1).join(" ");
    assert!(!train(&plan).contains("--last-epoch-only"));
    plan.settings.protocols = vec!["fair".to_owned()];
    plan.settings.recipe = RECOMMENDED;
    assert!(train(&plan).ends_with(" --last-epoch-only"));
    let evaluate = plan.evaluate_arguments(&plan.tasks[0], out, 2).join(" ");
    assert_eq!(
        evaluate,
        "evaluate --model runs/x/eth-full-7/run --data /recordings --protocol fair --device cpu \
         --threads 2 --progress json"
    );
    let goals = plan.goals_arguments(&plan.tasks[0], out, 2).join(" ");
    assert!(!format!("{}{goals}", train(&plan)).contains("published"));
    plan.settings.protocols.push("published".to_owned());
    assert!(!train(&plan).contains("--last-epoch-only"));
}

#[test]
fn a_plan_scores_under_some_protocol() {
    let none = Settings {
        protocols: Vec::new(),
        ..settings()
    };
    let message = Plan::new(none, &["eth".to_owned()], &["full".to_owned()], &[1])
        .unwrap_err()
        .to_string();
    assert_eq!(message, "there is nothing to do: no protocol");
}

#[test]
fn results_of_other_protocols_or_of_another_version_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    let before = plan(&["eth"], &["full"], &[1]).unwrap();
    before.write(folder.path()).unwrap();
    let mut other = before.clone();
    other.settings.protocols = vec!["fair".to_owned()];
    let message = other.write(folder.path()).unwrap_err().to_string();
    assert!(
        message.contains(r#"protocols ["fair"] instead of ["published","fair","single"]"#),
        "{message}"
    );
    // As the version before wrote it: it knew no protocols.
    let file = folder.path().join("plan.json");
    let mut old = serde_json::to_value(&before).unwrap();
    old["format"] = 2.into();
    old["settings"].as_object_mut().unwrap().remove("protocols");
    fs::write(&file, old.to_string()).unwrap();
    let message = before.write(folder.path()).unwrap_err().to_string();
    assert!(
        message.contains("its plan has layout 2, this one 3"),
        "{message}"
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), old.to_string());
}

#[test]
fn a_plan_survives_its_file_and_may_gain_tasks() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("runs/quick");
    let one = plan(&["eth"], &["full"], &[1]).unwrap();
    one.write(&out).unwrap();
    let text = fs::read(out.join("plan.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Plan>(&text).unwrap(), one);
    let mut two = plan(&["eth", "hotel"], &["full"], &[1]).unwrap();
    two.settings.data = Some(PathBuf::from("/moved"));
    two.write(&out).unwrap();
}

#[test]
fn other_settings_do_not_mix_with_what_is_there() {
    let folder = tempfile::tempdir().unwrap();
    plan(&["eth"], &["full"], &[1])
        .unwrap()
        .write(folder.path())
        .unwrap();
    let mut other = plan(&["eth"], &["full"], &[1]).unwrap();
    other.settings.epochs = 200;
    other.settings.test_walkers = Some(5);
    let message = other.write(folder.path()).unwrap_err().to_string();
    assert!(message.contains("epochs 200 instead of 4"), "{message}");
    assert!(
        message.contains("test_walkers 5 instead of null"),
        "{message}"
    );
    fs::write(folder.path().join("plan.json"), "{").unwrap();
    let message = other.write(folder.path()).unwrap_err().to_string();
    assert!(message.contains("damaged"), "{message}");
}
