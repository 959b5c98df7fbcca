//! Wording of reports where rows could be misread.

use ddl_eval::Protocol;
use ddl_report::Report;

use super::{cells, five_folds, line, markdown, of_forecaster};

#[test]
fn a_line_that_lacks_folds_is_not_ranked_against_one_that_has_them() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.25);
    rows.truncate(1);
    let baseline = of_forecaster(five_folds(Protocol::Fair, 1, 0.5), "constant velocity");
    rows.extend(baseline.into_iter().take(2));
    let report = Report::new("Parts", rows).unwrap();
    let page = ddl_report::page::Page::new(&report).to_html().unwrap();
    let (_, verdict) = page.split_once("class=\"verdict\"").unwrap();
    let (verdict, _) = verdict.split_once("</p>").unwrap();
    assert!(verdict.contains("<strong>DDL</strong>"), "{verdict}");
    assert!(verdict.contains("lacks other folds"), "{verdict}");
    assert!(!verdict.contains("least"), "{verdict}");
}

#[test]
fn forecasts_of_another_program_are_not_called_untrained() {
    let mut rows = of_forecaster(five_folds(Protocol::Fair, 1, 0.25), "mine");
    for row in &mut rows {
        row.conditions.seed = None;
        row.conditions.selection = Some("made by another program, read from mine.jsonl".to_owned());
    }
    let report = Report::new("Mine", rows).unwrap();
    let markdown = report.to_markdown();
    let said = line(&markdown, "- mine: ");
    assert!(said.contains("read from mine.jsonl") && said.contains("not known here"));
    assert!(said.contains("scored at commit 0123abc"), "{said}");
    assert!(!said.contains("nothing random") && !said.contains("not trained"));
    let page = ddl_report::page::Page::new(&report).to_html().unwrap();
    assert!(page.contains("scored at commit 0123abc") && !page.contains("nothing random"));
}

#[test]
fn a_forecaster_without_goals_has_no_twenty_goals_to_choose_from() {
    let mut rows = five_folds(Protocol::Published, 1, 0.3);
    for row in &mut rows {
        row.conditions.variant = Some("star".to_owned());
        row.scores.goal_fde = None;
    }
    rows.extend(five_folds(Protocol::Fair, 1, 0.25));
    let page = markdown(rows);
    let together = page.split("## One forecaster").nth(1).unwrap();
    let star = cells(line(together, "| DDL (star) "));
    assert_eq!(star[1..3], ["published", "20 samples"]);
}

#[test]
fn a_report_names_variants_with_different_training() {
    let variant = |name: &str, epochs| {
        let mut rows = five_folds(Protocol::Published, 1, 0.3);
        for row in &mut rows {
            row.conditions.variant = Some(name.to_owned());
            row.conditions.epochs = Some(epochs);
        }
        rows
    };
    let page = |epochs| markdown(variant("full", 3).into_iter().chain(variant("star", epochs)));
    assert!(page(3).contains("The variants have the same folds"));
    assert!(page(4).contains("were NOT made alike"));
}

/// Intervals need at least ten blocks in each fold.
#[test]
fn too_few_blocks_have_no_interval() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.25);
    rows[2].blocks.pop();
    let page = markdown(rows);
    let sure = page.split("### How sure").nth(1).unwrap();
    assert_eq!(cells(line(sure, "| DDL "))[2..], ["-"; 6]);
}
