//! Wording of reports where rows could be misread.

use super::{cells, five_folds, line, markdown, of_forecaster};
use ddl_eval::{Protocol, ResultRow};
use ddl_report::Report;

#[test]
fn a_line_that_lacks_folds_is_not_ranked_against_one_that_has_them() {
    let mut rows = five_folds(Protocol::Fair, 1, 0.25);
    rows.truncate(1);
    let baseline = of_forecaster(five_folds(Protocol::Fair, 1, 0.5), "constant velocity");
    rows.extend(baseline.into_iter().take(2));
    let verdict = verdict_of(rows);
    assert!(verdict.contains("<strong>DDL</strong>"), "{verdict}");
    assert!(verdict.contains("lacks other folds"), "{verdict}");
    assert!(!verdict.contains("least"), "{verdict}");
}

#[test]
fn a_tie_and_a_variation_of_the_same_model_are_no_victory() {
    let verdict = |others: &[(&str, f64)]| {
        let mut rows = five_folds(Protocol::Fair, 1, 0.25);
        for (name, min_ade) in others {
            rows.extend(of_forecaster(five_folds(Protocol::Fair, 1, *min_ade), name));
        }
        verdict_of(rows)
    };
    for (others, said) in [
        (&[("other", 0.5)][..], Some("It has the least error of the 2 forecasters")),
        (&[("DDL as packed", 0.5)], None),
        (&[("DDL as packed", 0.5), ("other", 0.250_04)], Some("it and other have the same error")),
        (&[("DDL as packed", 0.125), ("other", 0.2)], Some("other has the least error (0.200/0.400 m)")),
    ] {
        let verdict = verdict(others);
        assert_eq!(verdict.contains("error"), said.is_some(), "{verdict}");
        assert!(verdict.contains(said.unwrap_or_default()), "{verdict}");
    }
}

fn verdict_of(rows: Vec<ResultRow>) -> String {
    let report = Report::new("Results", rows).unwrap();
    let page = ddl_report::page::Page::new(&report).to_html().unwrap();
    let (_, verdict) = page.split_once("class=\"verdict\"").unwrap();
    verdict.split_once("</p>").unwrap().0.to_owned()
}

#[test]
fn forecasts_of_another_program_are_not_called_untrained() {
    let mut rows = of_forecaster(five_folds(Protocol::Fair, 1, 0.25), "mine");
    for row in &mut rows {
        row.conditions.seed = None;
        row.conditions.selection = Some("made by another program".to_owned());
    }
    let mut named_alike = rows.clone();
    for row in &mut named_alike {
        row.conditions.forecaster = "mine (faster)".to_owned();
        row.conditions.selection = None;
        row.scores.min_ade = 0.125;
    }
    let verdict = verdict_of([rows.clone(), named_alike].concat());
    assert!(verdict.contains("mine (faster) has the least error"), "{verdict}");
    let report = Report::new("Mine", rows).unwrap();
    let markdown = report.to_markdown();
    let said = line(&markdown, "- mine: ");
    assert!(said.contains("made by another program") && said.contains("not known here"));
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
