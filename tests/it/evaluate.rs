//! `ddl evaluate`, `ddl goals --measure`, `ddl report`: numbers from a model to the report page.

use ddl::data::{Convention, WindowRule};
use ddl::eval::{ResultRow, Scores};
use ddl::network::weights::save_weights;
use ddl::network::{ForecastWindows as _, MotionNetwork, StarConfig, TrainingConfig};
use ddl::report::{ForecastSnapshot, Report};
use ddl::{GoalEvaluation, Protocol, RunConfig, Variant};
use ddl_tests::place::{Place, json};
use ddl_tests::progress::{reported, returns_at_once};
use ddl_tests::{crowd, drawn_model};

const EVALUATE: &str = "evaluate --model run --protocol published --protocol fair --protocol single --protocol online \
                        --protocol online-single --protocol joint --test-pedestrians 60 --threads 1 --commit 0123abc";

/// A run of the published recipe, whose networks learn single steps; for these, plain Euler steps are evaluated too.
fn config() -> RunConfig {
    RunConfig {
        star: StarConfig::published(Variant::Full),
        training: TrainingConfig {
            epochs: 2,
            pedestrians_per_epoch: Some(200),
            seed: 5,
            ..TrainingConfig::published()
        },
        ..drawn_model::config(Variant::Full)
    }
}

fn check_conditions(row: &ResultRow) {
    let conditions = &row.conditions;
    assert_eq!(conditions.convention, Convention::Simulated);
    assert_eq!(conditions.window_rule, WindowRule::Complete);
    assert_eq!(conditions.fold, crowd::FOLD);
    let place = (conditions.device.as_str(), conditions.commit.as_str());
    assert_eq!(place, ("cpu", "0123abc"));
    assert!(!conditions.forecaster.is_empty());
    let words = |fact: &Option<String>| fact.clone().unwrap();
    assert!(words(&conditions.test_subset).contains("60 pedestrians"));
    if conditions.forecaster.starts_with("DDL") {
        assert_eq!(conditions.variant.as_deref(), Some("full"));
        assert_eq!((conditions.seed, conditions.epochs), (Some(5), Some(2)));
        assert!(words(&conditions.training_subset).contains("200 pedestrians"));
        let selection = words(&conditions.selection);
        let of_last = conditions.forecaster.contains("last epoch");
        let on_test = conditions.protocol == Protocol::Published && !of_last;
        assert_eq!(selection.contains("TEST"), on_test, "{selection}");
    }
}

fn check_certificates(protocol: Protocol, rows: &[&ResultRow]) {
    let named = |start: &str| rows.iter().find(|row| row.conditions.forecaster.starts_with(start));
    let stability = |row: &&ResultRow| row.scores.stability.unwrap();
    let model = stability(rows.iter().find(|row| row.conditions.forecaster == "DDL").unwrap());
    let (stable, all_stable) = ((model.certified, model.decreasing), (Some(1.0), 1.0));
    assert_eq!(stable == all_stable, protocol != Protocol::Published, "{protocol}: {model:?}");
    let plain = named("DDL with plain Euler steps").map(stability);
    assert_eq!(plain.is_some(), protocol == Protocol::Fair);
    if let Some(plain) = plain {
        assert!(plain.certified.unwrap() < 1.0, "{plain:?}");
        assert_eq!(plain.rollouts, model.rollouts);
    }
    // The single forecast is a straight line; the path shaped by the network is reported as a further row.
    let line = named("straight line to");
    assert_eq!(line.is_none(), protocol.hypotheses() == 1);
    if let Some(line) = line {
        assert_eq!(stability(line).certified, None);
        // The goals depend on the run, so another seed gives other lines.
        assert_eq!(line.conditions.seed, Some(5));
        let recipe = line.conditions.recipe.as_deref().unwrap();
        assert!(recipe.starts_with("goals "), "{recipe}");
    }
    let shaped = named("DDL on the way that its network shapes").map(stability);
    assert_eq!(shaped.is_some(), protocol == Protocol::Single);
    assert!(shaped.is_none_or(|shaped| shaped.certified == Some(1.0)));
}

/// Checks that all rows of a table are about the same pedestrians, about as many as requested, and include the model
/// and a baseline.
fn check_table(protocol: Protocol, rows: &[&ResultRow], pedestrians: usize) {
    let mut models = rows.iter().filter(|row| row.conditions.forecaster == "DDL");
    let (Some(model), None) = (models.next(), models.next()) else {
        panic!("{protocol}: not one model");
    };
    assert_eq!(model.scores.hypotheses, protocol.hypotheses());
    let mut names = rows.iter().map(|row| &row.conditions.forecaster);
    assert!(names.any(|name| name.starts_with("constant velocity")), "{protocol}");
    for row in rows {
        let (scores, of_model) = (&row.scores, &model.scores);
        let counts = |scores: &Scores| (scores.pedestrians, scores.windows);
        assert_eq!(counts(scores), counts(of_model));
        assert!(scores.pedestrians > 0 && scores.pedestrians < pedestrians + 40);
        // Pedestrians walk below 3 m/s, so no forecast of 4.8 s can be off by more than this.
        assert!((0.01..15.0).contains(&scores.min_ade), "{scores:?}");
        assert!(scores.min_fde <= scores.fde_at_min_ade);
    }
}

/// Uses of the true future are removed one after the other. The second epoch of the run is worse than the first.
fn check_oracle(rows: &[&ResultRow]) {
    let of = |name: &str| {
        let mut rows = rows.iter();
        &rows.find(|row| row.conditions.forecaster == name).unwrap().scores
    };
    let of_last = "DDL of its last epoch";
    assert!(of("DDL").min_ade < of(of_last).min_ade);
    let without_frame = format!("{of_last} without the future frame");
    assert_ne!(of(&without_frame).goal_fde, of(of_last).goal_fde);
    let without_noise = of(&format!("{without_frame} and noise"));
    assert_eq!(without_noise.goal_fde, of(&without_frame).goal_fde);
    assert_eq!((without_noise.hypotheses, of(&without_frame).hypotheses), (1, 20));
}

fn of_protocol(rows: &[ResultRow], protocol: Protocol) -> Vec<&ResultRow> {
    rows.iter().filter(|row| row.conditions.protocol == protocol).collect()
}

#[test]
fn a_number_goes_from_the_model_to_the_page() {
    let place = Place::empty();
    drawn_model::write(config(), &crowd::windows(200, 20), &place.at("run"));
    let last = place.at("run/epochs/002.safetensors");
    std::fs::copy(place.at("run/model.safetensors"), last).unwrap();
    let run: RunConfig = json(&place.text("run/config.json"));
    let other = MotionNetwork::new(config().star, 7).unwrap().copy_weights().unwrap();
    let first = place.at("run/epochs/001.safetensors");
    save_weights(&other, &run.network_origin(), &first).unwrap();
    assert!(reported(&place, EVALUATE, &["evaluate"]).len() >= 2);
    let report = Report::load(&place.at("run/report.json")).unwrap();
    report.rows().iter().for_each(check_conditions);
    for protocol in Protocol::ALL {
        let rows = of_protocol(report.rows(), protocol);
        check_table(protocol, &rows, 60);
        check_certificates(protocol, &rows);
    }
    check_oracle(&of_protocol(report.rows(), Protocol::Published));
    returns_at_once(&place, EVALUATE);

    // Moments: the certified forecasts under `fair`.
    let moments: Vec<ForecastSnapshot> = json(&place.text("run/moments.json"));
    assert!(!moments.is_empty());
    for moment in &moments {
        assert_eq!((moment.fold.as_str(), moment.forecaster.as_str()), (crowd::FOLD, "DDL"));
        let mut hypotheses = moment.pedestrians.iter().flat_map(|one| &one.hypotheses);
        assert!(hypotheses.all(|h| (h.certified, h.decreasing) == (Some(true), Some(true))));
    }

    place.write("pages/figures/mine.svg", "a picture of the user");
    let printed_paths = place.ok("report run run --title Corridor --out pages");
    assert!(printed_paths.ends_with("report.html\n") && printed_paths.lines().count() == 1);
    let collected = Report::load(&place.at("pages/report.json")).unwrap();
    assert_eq!(collected.title(), "Corridor");
    // What is given twice is there once.
    assert_eq!(collected.rows(), report.rows());
    let of_page: Vec<ForecastSnapshot> = json(&place.text("pages/moments.json"));
    assert_eq!(of_page, moments);
    assert_eq!(place.text("pages/figures/mine.svg"), "a picture of the user");
    let markdown = place.text("pages/report.md");
    assert!(markdown.lines().next().unwrap().contains("simulated"));
    for text in [
        "Corridor",
        "`fair`",
        "`single`",
        "`published`",
        "0123abc",
        "certified %",
        "| DDL with plain Euler steps ",
        Protocol::Published.warning().unwrap(),
    ] {
        assert!(markdown.contains(text), "{text} is not on the page");
    }
}

#[test]
fn futures_are_written_as_sample_files_and_read_back() {
    let place = Place::with_model();
    let evaluate = "evaluate --model run --test-pedestrians 60 --threads 1 --samples futures --protocol";
    place.fails(&format!("{evaluate} fair"), &["add --protocol joint"]);
    // Fold, pedestrians, K and JADE/JFDE.
    let first = |printed: &str| -> Vec<String> {
        let row = printed.lines().find(|line| line.starts_with(crowd::FOLD));
        row.unwrap().split_whitespace().take(4).map(str::to_owned).collect()
    };
    let of_model = first(&place.ok(&format!("{evaluate} joint")));
    let fold = format!("--convention simulated --fold {}", crowd::FOLD);
    let read = place.ok(&format!("evaluate --forecasts futures {fold} --protocol joint --intersection"));
    assert_eq!(first(&read), of_model);
}

/// With one row a constant velocity stands still; more rows are other conditions, whose numbers differ.
#[test]
fn few_rows_are_conditions_of_their_own() {
    let place = Place::with_recordings();
    let ask = |rows: &str| place.ok(&format!("evaluate --model hotel --data mine --fps 25 --observed-rows {rows}"));
    let [one, two] = ["1", "2"].map(ask);
    assert!(one.contains("observed for 1 of 8 rows") && two.contains("observed for 2 of 8 rows") && one != two);
    let errors = |baseline: &str| {
        let line = one.lines().find(|line| line.ends_with(baseline)).unwrap();
        line.split_whitespace().find(|word| word.contains('/')).unwrap()
    };
    assert_eq!(errors("constant velocity (last step)"), errors("constant velocity (mean observed)"));
}

#[test]
fn goals_are_measured() {
    let place = Place::with_model();
    let measure = "goals --model run --measure test --threads 1";
    let test: GoalEvaluation = json(&place.ok(&format!("{measure} --json")));
    assert_eq!(test.recordings.keys().collect::<Vec<_>>(), [crowd::FOLD]);
    assert_eq!((test.clusters, test.recordings[crowd::FOLD]), (20, test.all));
    assert!(test.all.pedestrians > 100);
    assert!(test.all.oracle_fde > 0.01 && test.all.oracle_fde < test.all.likeliest_fde);
    let calibration = test.calibration.unwrap();
    assert!(calibration.log_loss.is_finite() && calibration.bins.len() == 10);
    let words = place.ok(measure);
    let nearest_goal = format!("{:.3}", test.all.oracle_fde);
    assert!(words.contains("nearest goal off") && words.contains(&nearest_goal), "{words}");
}
