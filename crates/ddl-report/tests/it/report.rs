//! The content of a report, and the separation of numbers that are not comparable.

mod scenes;
mod summary;
mod wording;

use ddl_data::{Convention, WindowRule};
use ddl_eval::significance::BlockErrors;
use ddl_eval::{CategoryScores, Conditions, MotionKind, Protocol, ResultRow, Scores, StabilityScores};
use ddl_report::{Report, ReportError};

fn scores(min_ade: f64) -> Scores {
    Scores {
        pedestrians: 100,
        windows: 10,
        hypotheses: 20,
        min_ade,
        min_fde: 2.0 * min_ade,
        fde_at_min_ade: 2.0 * min_ade,
        joint_ade: 2.0 * min_ade,
        joint_fde: 3.0 * min_ade,
        miss_rate: 0.25,
        collision_rate: 0.1,
        true_collision_rate: 0.0,
        goal_fde: Some(1.0 / 3.0),
        stability: Some(StabilityScores {
            rollouts: 2000,
            decreasing: 1.0,
            end_distance: 0.1,
            largest_turn: 30.0,
            reversing: 0.0,
            certified: Some(0.875),
        }),
        ..Scores::default()
    }
}

/// Ten blocks of ten pedestrians whose mean error is `min_ade`.
fn blocks(fold: &str, min_ade: f64) -> Vec<BlockErrors> {
    let block = |block: i64| BlockErrors {
        recording: fold.to_owned(),
        block,
        pedestrians: 10,
        min_ade: 10.0 * min_ade * (0.55 + 0.1 * block as f64),
        min_fde: 20.0 * min_ade,
    };
    (0..10).map(block).collect()
}

fn row(protocol: Protocol, fold: &str, seed: u64, min_ade: f64) -> ResultRow {
    let conditions = Conditions {
        variant: Some("full".to_owned()),
        seed: Some(seed),
        epochs: Some(3),
        selection: Some("last epoch".to_owned()),
        device: "cpu".to_owned(),
        commit: "0123abc".to_owned(),
        training_subset: Some("2000 windows drawn with seed 1".to_owned()),
        ..Conditions::new(Convention::Star, WindowRule::Published, protocol, fold, "DDL")
    };
    ResultRow { conditions, scores: scores(min_ade), blocks: blocks(fold, min_ade) }
}

fn turning(pedestrians: usize, min_ade: f64) -> Vec<CategoryScores> {
    vec![CategoryScores {
        category: MotionKind::TurningLeft,
        pedestrians,
        min_ade,
        min_fde: 2.0 * min_ade,
        joint_ade: Some(3.0 * min_ade),
        joint_fde: Some(4.0 * min_ade),
    }]
}

const FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];

fn five_folds(protocol: Protocol, seed: u64, min_ade: f64) -> Vec<ResultRow> {
    FOLDS.iter().map(|fold| row(protocol, fold, seed, min_ade)).collect()
}

fn markdown(rows: impl IntoIterator<Item = ResultRow>) -> String {
    Report::new("Results", rows).unwrap().to_markdown()
}

fn of_forecaster(mut rows: Vec<ResultRow>, name: &str) -> Vec<ResultRow> {
    for row in &mut rows {
        name.clone_into(&mut row.conditions.forecaster);
        row.conditions.variant = None;
        row.conditions.epochs = None;
        row.conditions.selection = None;
    }
    rows
}

fn line<'a>(page: &'a str, start: &str) -> &'a str {
    page.lines().find(|line| line.starts_with(start)).unwrap()
}

fn cells(line: &str) -> Vec<&str> {
    line.trim_matches('|').split('|').map(str::trim).collect()
}

/// The cell of the first table with that column, in the line that begins with `start`.
fn shown<'a>(page: &'a str, column: &str, start: &str) -> &'a str {
    let mut lines = page.lines();
    let place = lines.find_map(|line| cells(line).iter().position(|cell| *cell == column));
    let line = lines.find(|line| line.starts_with(start)).unwrap();
    cells(line)[place.unwrap()]
}

#[test]
fn a_table_names_everything_it_must() {
    let page = markdown(five_folds(Protocol::Fair, 1, 0.25));
    assert!(page.starts_with("Data convention: `star`"), "{page}");
    for named in [
        "## Protocol `fair`, window rule `published`, convention `star`",
        "seed 1",
        "3 epochs (last epoch)",
        "trained on 2000 windows drawn with seed 1",
        "device cpu",
        "commit 0123abc",
        "Scored: all test windows",
        "| pedestrians scored |",
        "### Table I of the DDL paper",
        "mixes data conventions",
    ] {
        assert!(page.contains(named), "no `{named}` in\n{page}");
    }
    assert_eq!(cells(line(&page, "| DDL "))[1..], ["0.250/0.500"; 6]);
    // `tests/page/expected_tables.py` computes every other column again.
    assert_eq!(shown(&page, "certified %", "| DDL "), "87.5");
    // The literature's DDL row is in a separate table, and no warning is shown without the protocol `published`.
    assert!(!page.contains("**Warning.**"));
    assert!(!page.contains("Table II") && !page.contains("Ablation"));
    assert!(!page.contains("By recording"));
    assert!(markdown([]).starts_with("Data convention: none"));
}

#[test]
fn scores_written_before_there_were_more_metrics_still_load() {
    let text = r#"{"pedestrians":1,"windows":1,"hypotheses":20,"min_ade":0.1,"min_fde":0.2,
        "fde_at_min_ade":0.2,"joint_ade":0.1,"joint_fde":0.2,"miss_rate":0.0,"collision_rate":0.0,
        "true_collision_rate":0.0,"goal_fde":null,
        "stability":{"rollouts":2,"decreasing":1.0,"end_distance":0.5,"largest_turn":9.0,"reversing":0.0}}"#;
    let scores: Scores = serde_json::from_str(text).unwrap();
    assert_eq!((scores.kde_nll, scores.categories.len()), (None, 0));
    assert_eq!(scores.stability.unwrap().certified, None);
}

#[test]
fn several_seeds_give_mean_and_deviation() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.2);
    rows.extend(five_folds(Protocol::Fair, 2, 0.4));
    let page = markdown(rows.clone());
    // Sample deviation of 0.2 and 0.4: 0.1414; of their doubles: 0.2828.
    assert_eq!(cells(line(&page, "| DDL "))[6], "0.300±0.141/0.600±0.283");
    assert!(page.contains("seeds 1, 2"));
    // If a seed lacks a fold, the fold keeps its cell, but the mean is left out.
    rows.pop();
    let page = markdown(rows);
    assert_eq!(cells(line(&page, "| DDL "))[5..], ["0.200/0.400", "-"]);
}

#[test]
fn protocols_conventions_rules_and_subsets_never_share_a_table() {
    let base = row(Protocol::Fair, "eth", 1, 0.25);
    let with = |change: fn(&mut Conditions)| {
        let mut row = base.clone();
        change(&mut row.conditions);
        row
    };
    let page = markdown([
        base.clone(),
        with(|c| c.protocol = Protocol::Published),
        with(|c| c.convention = Convention::SocialGan),
        with(|c| c.window_rule = WindowRule::Complete),
        with(|c| c.test_subset = Some("300 pedestrians a fold".to_owned())),
    ]);
    assert_eq!(page.matches("\n## Protocol").count(), 5, "{page}");
    // Once with the published results, once in the table beside the fair ones.
    assert_eq!(page.matches("**Warning.**").count(), 2);
    assert!(page.starts_with("Data conventions: `star`"));
    assert!(page.contains("Scored: 300 pedestrians a fold."));
}

#[test]
fn settings_that_differ_make_lines_of_their_own() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.25);
    rows.extend(five_folds(Protocol::Fair, 1, 0.2));
    for row in &mut rows[5..] {
        row.conditions.epochs = Some(30);
    }
    let page = markdown(rows);
    assert!(page.contains("| DDL #1 ") && page.contains("| DDL #2 "));
    assert!(page.contains("- DDL #2: seed 1; 30 epochs"));
}

#[test]
fn simulated_crowds_are_not_taken_for_recordings() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.25);
    let names: Vec<_> = Convention::Simulated.fold_names().collect();
    for (row, name) in rows.iter_mut().zip(&names) {
        row.conditions.convention = Convention::Simulated;
        row.conditions.fold = (*name).to_owned();
    }
    let page = markdown(rows);
    assert!(page.lines().next().unwrap().contains("NOT real recordings"));
    assert_eq!(cells(line(&page, "| forecaster"))[1..6], names);
    assert_eq!(cells(line(&page, "| DDL "))[6], "0.250/0.500");
}

#[test]
fn files_are_named_checked_and_read_back() {
    let mut rows = five_folds(Protocol::Fair, u64::MAX, 0.1 + 0.2);
    rows[0].scores.stability = None;
    rows[1].conditions.window_rule = WindowRule::SocialGan { min_pedestrians: 2 };
    let report = Report::new("Quick", rows).unwrap();
    let [markdown, (name, json)] = report.files().unwrap();
    assert_eq!(markdown, ("report.md", report.to_markdown()));
    assert_eq!(name, "report.json");
    let file = std::env::temp_dir().join(format!("ddl-report-{}.json", std::process::id()));
    std::fs::write(&file, &json).unwrap();
    assert_eq!(Report::load(&file).unwrap(), report);
    std::fs::remove_file(&file).unwrap();
    let missing = Report::load(&file).unwrap_err();
    assert!(missing.to_string().contains("ddl-report-"));
    let newer = json.replacen("\"format\":1", "\"format\":2", 1);
    assert!(matches!(Report::from_json(&newer), Err(ReportError::Format { found: 2, .. })));
    assert!(matches!(Report::from_json("{}"), Err(ReportError::Json(_))));
}

#[test]
fn the_same_row_twice_is_one_and_a_contradiction_is_refused() {
    let one = row(Protocol::Fair, "eth", 1, 0.25);
    let report = Report::new("Twice", [one.clone(), one.clone()]).unwrap();
    assert_eq!(report.rows().len(), 1);
    let other = row(Protocol::Fair, "eth", 1, 0.5);
    let error = Report::new("Contradiction", [one, other]).unwrap_err();
    assert!(matches!(error, ReportError::Conflict { .. }));
    assert!(error.to_string().contains("`DDL` on fold `eth`"));
}

#[test]
fn differences_come_with_their_interval_and_their_p_value() {
    let better = five_folds(Protocol::Fair, 1, 0.25);
    let worse = of_forecaster(five_folds(Protocol::Fair, 1, 0.30), "straight line");
    let page = markdown(better.into_iter().chain(worse));
    let sure = page.split("### How sure").nth(1).unwrap();
    let row = cells(line(sure, "| straight line "));
    assert_eq!(row[1], "all");
    assert!(row[2].starts_with("0.300 [0.2"), "{row:?}");
    assert!(row[4].starts_with("+0.050 [+0.04"), "{row:?}");
    assert_eq!(row[5], "<0.001");
    assert_eq!(row[6], "+0.100 [+0.100, +0.100]");
    assert_eq!(cells(line(sure, "| DDL "))[4..], ["-"; 4]);
}

#[test]
fn the_ablation_stands_beside_the_papers() {
    let mut rows = Vec::new();
    for (variant, error) in [("full", 0.2), ("no-goal-shift", 0.3), ("star", 0.4)] {
        for seed in [1, 2] {
            let spread = 0.1 * (seed - 1) as f64;
            for mut row in five_folds(Protocol::Published, seed, error + spread) {
                row.conditions.variant = Some(variant.to_owned());
                rows.push(row);
            }
        }
    }
    let page = markdown(rows);
    let ablation = page.split("## Ablation").nth(1).unwrap();
    let star = cells(line(ablation, "| star "));
    let expected = ["star", "no", "no", "1, 2", "0.450±0.071/0.900±0.141"];
    assert_eq!(star[..5], expected);
    assert!(ablation.contains("Table II of the DDL paper"));
}

/// Means are taken over the pedestrians of the folds that all forecasters share: 30 and 10 turning pedestrians with
/// errors of 0.1 and 0.5 m give 0.2 m (the mean of the folds would be 0.3 m).
#[test]
fn categories_are_pooled_over_the_pedestrians_of_shared_folds() {
    let measured = |(fold, pedestrians, min_ade): (&str, usize, f64)| {
        let mut row = row(Protocol::Fair, fold, 1, 0.25);
        row.scores.categories = turning(pedestrians, min_ade);
        row
    };
    let mut rows = [("eth", 30, 0.1), ("hotel", 10, 0.5)].map(measured).to_vec();
    let others = [("eth", 30, 0.3), ("hotel", 10, 0.3), ("univ", 90, 0.9)].map(measured);
    rows.extend(of_forecaster(others.to_vec(), "lines"));
    let page = markdown(rows);
    assert!(page.contains("pooled over eth, hotel."), "{page}");
    assert_eq!(cells(line(&page, "| turning left ")), ["turning left", "40", "0.200/0.400", "0.300/0.600"]);
}

#[test]
fn own_recordings_have_a_row_each_and_one_for_all() {
    let mut measured = row(Protocol::Fair, "2 recordings, lobby to yard", 1, 0.25);
    measured.conditions.convention = Convention::Own;
    measured.blocks = blocks("lobby", 0.2);
    measured.blocks.push(BlockErrors {
        recording: "yard".to_owned(),
        block: 0,
        pedestrians: 10,
        min_ade: 7.5,
        min_fde: 15.0,
    });
    measured.scores.pedestrians = 110;
    let page = markdown([measured.clone()]);
    for row in [["lobby", "100", "0.200/0.400"], ["yard", "10", "0.750/1.500"], ["all", "110", "0.250/0.500"]] {
        assert_eq!(cells(line(&page, &format!("| {} ", row[0]))), row);
    }
    // A single recording has no table by recording.
    measured.blocks.pop();
    assert!(!markdown([measured]).contains("By recording"));
}
