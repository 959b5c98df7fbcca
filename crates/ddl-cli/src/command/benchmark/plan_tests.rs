//! Tests of the plan and its file.

use super::super::choice::tests::plan_of;
use super::*;

fn published(words: &str) -> BenchmarkPlan {
    plan_of(&format!("--profile paper --protocol published,fair,single --epochs 4 {words}")).unwrap()
}

fn of_eth() -> BenchmarkPlan {
    published("--folds eth --seeds 7")
}

#[test]
fn every_combination_is_there_once_and_the_first_method_comes_first() {
    let plan = published("--folds eth,univ,zara2 --variants full,star --seeds 1,2");
    assert_eq!(plan.tasks.len(), 12);
    // The tasks of the first method come first: the others use their goals.
    for of_method in plan.tasks.chunks(6) {
        let variant = of_method[0].variant;
        assert!(of_method.iter().all(|task| task.variant == variant));
    }
    let same_goals = |task: &Task| plan.with_same_goals(task).map(|other| other.id.as_str());
    assert!(plan.tasks[..6].iter().all(|task| same_goals(task).is_none()));
    assert_eq!(same_goals(&plan.tasks[6]), Some("eth-full-1"));
    let ids: Vec<&str> = plan.tasks[..4].iter().map(|task| task.id.as_str()).collect();
    assert_eq!(ids, ["eth-full-1", "eth-full-2", "univ-full-1", "univ-full-2"]);
    let twice = plan_of("--folds eth,eth").unwrap_err().to_string();
    assert_eq!(twice, "the options ask for eth-full-1 twice");
}

#[test]
fn a_task_becomes_arguments_of_the_program() {
    let out = Path::new("runs/x");
    let train = |plan: &BenchmarkPlan| plan.train_arguments(&plan.tasks[0], out, 1).join(" ");
    let mut plan = of_eth();
    plan.settings.train_pedestrians = Some(800);
    plan.settings.proposal_steps = Some(30);
    assert_eq!(
        train(&plan),
        "train --convention star --data /recordings --fold eth --variant full --seed 7 \
         --epochs 4 --train-pedestrians 800 --proposal-steps 30 --recipe published --batch-pedestrians 256 \
         --learning-rate 0.0015 --learning-rate-schedule constant --out runs/x/eth-full-7/run --device cpu --threads 1 \
         --progress json"
    );
    plan.settings.data = None;
    plan.settings.test_pedestrians = Some(9);
    assert_eq!(
        plan.evaluate_arguments(&plan.tasks[0], out, 2).join(" "),
        "evaluate --model runs/x/eth-full-7/run --protocol published --protocol fair \
         --protocol single --test-pedestrians 9 --device cpu --threads 2 --progress json"
    );
    let words = train(&published("--folds eth --variants perceptron"));
    assert!(words.contains("--fold eth --backbone perceptron --seed"), "{words}");
}

#[test]
fn a_plan_survives_its_file_and_may_gain_tasks() {
    let folder = tempfile::tempdir().unwrap();
    let one = published("--folds eth --variants all");
    one.write(folder.path()).unwrap();
    assert_eq!(BenchmarkPlan::read(folder.path()).unwrap(), one);
    let mut two = published("--folds eth,hotel");
    two.settings.data = Some(PathBuf::from("/moved"));
    two.write(folder.path()).unwrap();
    let message = BenchmarkPlan::read(&folder.path().join("none")).unwrap_err().to_string();
    assert!(message.contains("that `ddl benchmark` made"), "{message}");
}

#[test]
fn results_of_other_settings_or_of_another_version_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    let before = of_eth();
    before.write(folder.path()).unwrap();
    let refused = |plan: &BenchmarkPlan| plan.write(folder.path()).unwrap_err().to_string();
    let mut other = before.clone();
    other.settings.protocols = vec![Protocol::Fair];
    other.settings.epochs = 200;
    other.settings.test_pedestrians = Some(5);
    let message = refused(&other);
    for difference in [
        r#"protocols ["fair"] instead of ["published","fair","single"]"#,
        "epochs 200 instead of 4",
        "test_pedestrians 5 instead of null",
    ] {
        assert!(message.contains(difference), "{message}");
    }
    // A plan of layout 2 has no protocols.
    let file = folder.path().join("plan.json");
    let mut old = serde_json::to_value(&before).unwrap();
    old["format"] = 2.into();
    old["settings"].as_object_mut().unwrap().remove("protocols");
    fs::write(&file, old.to_string()).unwrap();
    let message = refused(&before);
    assert!(message.contains("its plan has layout 2, this version writes 3"), "{message}");
    assert_eq!(fs::read_to_string(&file).unwrap(), old.to_string());
    fs::write(&file, "{").unwrap();
    let message = refused(&before);
    assert!(message.contains("damaged"), "{message}");
}
