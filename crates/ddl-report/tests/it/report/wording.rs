//! What a report says of rows that are easily taken for more than they are.

use ddl_eval::{Protocol, ResultRow};
use ddl_report::Report;

use super::{cells, five_folds, line, row, turning};

fn of_forecaster(mut rows: Vec<ResultRow>, name: &str) -> Vec<ResultRow> {
    for row in &mut rows {
        name.clone_into(&mut row.conditions.forecaster);
        row.conditions.variant = None;
        row.conditions.epochs = None;
        row.conditions.selection = None;
    }
    rows
}

/// Constant velocity has two folds, the model one: on the other it was not beaten, it was not measured.
#[test]
fn a_line_that_lacks_folds_is_not_ranked_against_one_that_has_them() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.25);
    rows.truncate(1);
    let baseline = of_forecaster(five_folds(Protocol::Fair, 1, 0.5), "constant velocity");
    rows.extend(baseline.into_iter().take(2));
    let report = Report::new("Parts", rows).unwrap();
    let page = ddl_report::page::Page::new(&report).to_html().unwrap();
    let verdict = page
        .split("class=\"verdict\"")
        .nth(1)
        .unwrap()
        .split("</p>")
        .next()
        .unwrap();
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
    assert!(
        said.contains("read from mine.jsonl") && said.contains("not known here"),
        "{said}"
    );
    assert!(said.contains("scored at commit 0123abc"), "{said}");
    assert!(
        !said.contains("nothing random") && !said.contains("not trained"),
        "{said}"
    );
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
    let page = Report::new("Star", rows).unwrap().to_markdown();
    let together = page.split("## One forecaster").nth(1).unwrap();
    let star = cells(line(together, "| DDL (star) "));
    assert_eq!(star[1..3], ["published", "20 samples"]);
}

#[test]
fn variants_that_were_not_made_alike_are_said_not_to_be() {
    let variant = |name: &str, epochs| {
        let mut rows = five_folds(Protocol::Published, 1, 0.3);
        for row in &mut rows {
            row.conditions.variant = Some(name.to_owned());
            row.conditions.epochs = Some(epochs);
        }
        rows
    };
    let page = |epochs| {
        let rows = variant("full", 3)
            .into_iter()
            .chain(variant("star", epochs));
        Report::new("Ablation", rows).unwrap().to_markdown()
    };
    assert!(page(3).contains("The variants have the same folds"));
    assert!(page(4).contains("were NOT made alike"));
}

/// Ten blocks a fold are the fewest that intervals are given for.
#[test]
fn too_few_blocks_have_no_interval() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.25);
    rows[2].blocks.pop();
    let page = Report::new("Few", rows).unwrap().to_markdown();
    let sure = page.split("### How sure").nth(1).unwrap();
    assert_eq!(cells(line(sure, "| DDL "))[2..], ["-"; 6]);
}

/// Every column of the categories is over the same pedestrians: those of the folds that all forecasters have.
#[test]
fn categories_are_told_over_shared_folds_alone() {
    let of = |fold: &str, min_ade| {
        let mut row = row(Protocol::Fair, fold, 1, 0.25);
        row.scores.categories = turning(10, min_ade);
        row
    };
    let mut rows = vec![of("eth", 0.1)];
    rows.extend(of_forecaster(
        vec![of("eth", 0.3), of("hotel", 0.9)],
        "lines",
    ));
    let page = Report::new("Categories", rows).unwrap().to_markdown();
    assert!(page.contains("pooled over eth."), "{page}");
    assert_eq!(
        cells(line(&page, "| turning left ")),
        ["turning left", "10", "0.100/0.200", "0.300/0.600"]
    );
}
