//! Futures of whole scenes: the protocol `joint`.

use super::{cells, five_folds, markdown, shown, turning};
use ddl_data::Convention;
use ddl_eval::{FutureCollisions, JointScores, Protocol};
use ddl_report::Report;

#[test]
fn whole_futures_have_tables_of_their_own() {
    let mut rows = five_folds(Protocol::Joint, 1, 0.25);
    for row in &mut rows {
        row.scores.categories = turning(10, 0.25);
        let collisions = FutureCollisions { mean: 0.25, best: 0.125, truth: 0.0625 };
        row.scores.joint =
            Some(JointScores { ade_windows: 0.75, fde_windows: 1.5, collisions, close_collisions: collisions });
    }
    let fair = five_folds(Protocol::Fair, 1, 0.25);
    let page = markdown(fair.iter().cloned().chain(rows.clone()));
    let (of_fair, of_joint) = page.split_once("## Protocol `joint`").unwrap();
    assert!(of_fair.contains("minADE/minFDE in metres.") && !of_fair.contains("JADE"));
    let (of_joint, _) = of_joint.split_once("## How to read").unwrap();
    // The errors of the protocol, twice and three times minADE; in the category three and four times.
    assert_eq!(shown(of_joint, "eth", "| DDL"), "0.500/0.750");
    assert_eq!(shown(of_joint, "pedestrians", "| turning left"), "50");
    let turning = of_joint.lines().find(|line| line.starts_with("| turning left"));
    assert_eq!(cells(turning.unwrap())[2], "0.750/1.000");
    // In the summary neither changes the other.
    let summary = |rows| Report::new("Results", rows).unwrap().summary(Convention::Star).unwrap();
    let both = summary([fair.clone(), rows].concat());
    let alone = summary(fair);
    let scenes = both.strip_prefix(&alone).unwrap();
    assert_eq!(shown(scenes, "mean", "| DDL"), "0.500/0.750");
    assert_eq!(shown(scenes, "of the true one %", "| DDL"), "6.2");
}
