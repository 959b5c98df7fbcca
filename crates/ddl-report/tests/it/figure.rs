//! The content of pictures of scenes and of estimated goals.

use ddl_core::{Forecaster, WeightedGoals};
use ddl_data::{PedestrianId, Position, WINDOW, Window};
use ddl_eval::baseline::{ConstantVelocity, StraightLine, TrueEndpoint};
use ddl_report::ReportError;
use ddl_report::figure::{self, GoalCase};

/// Circles of the legend: 4 observed dots, a true end, 3 goals, and the nearest with its rim.
const LEGEND_CIRCLES: usize = 4 + 1 + 3 + 2;
/// Circles of a panel except goals that are not the nearest: 8 observed dots, a true end, the nearest goal with its
/// rim.
const PANEL_CIRCLES: usize = 8 + 1 + 2;

fn walk(from: Position, step: Position) -> Vec<Position> {
    (0..WINDOW)
        .map(|t| [from[0] + t as f64 * step[0], from[1] + t as f64 * step[1]])
        .collect()
}

/// A pedestrian that starts at `from`, with `k` goals beyond the end and some experts.
fn case(title: &str, from: Position, step: Position, k: usize, experts: usize) -> GoalCase {
    let track = walk(from, step);
    let end = track[WINDOW - 1];
    let goals = (1..=k).map(|g| [end[0] + 0.25 * g as f64, end[1]]).collect();
    let goals = WeightedGoals::new(goals, vec![1.0 / k as f64; k]).unwrap();
    let expert = |e: usize| walk(from, [step[0], step[1] + 0.01 * e as f64]);
    GoalCase::new(title, &track, goals, (0..experts).map(expert).collect()).unwrap()
}

fn count(svg: &str, shape: &str) -> usize {
    svg.matches(shape).count()
}

#[test]
fn every_role_is_drawn_and_named() {
    let cases = [
        case("<eth>, pedestrian 7", [0.0, 0.0], [0.5, 0.0], 5, 30),
        case("hotel, pedestrian 9", [2.0, 3.0], [0.0, -0.4], 20, 10),
    ];
    let svg = figure::goals("Goals & ends", &cases).unwrap();
    assert!(svg.starts_with("<?xml") && svg.trim_end().ends_with("</svg>"));
    for text in [
        ">Goals &amp; ends</text>",
        ">&lt;eth&gt;, pedestrian 7<",
        ">hotel, pedestrian 9<",
        ">observed, 3.2 s<",
        ">truth, 4.8 s, and its end<",
        ">how similar pedestrians went on<",
        ">goals of 1, 5, 20 % probability<",
        ">goal nearest the true end<",
        ">Axes: metres from the last observed position<",
    ] {
        assert_eq!(count(&svg, text), 1, "`{text}`");
    }
    assert_eq!(count(&svg, "nearest goal 0.25 m off"), 2);
    let circles = LEGEND_CIRCLES + 2 * PANEL_CIRCLES + 4 + 19;
    assert_eq!(count(&svg, "<circle"), circles);
    // Each expert is one line from the last observed position; the legend has three.
    assert_eq!(count(&svg, "class=\"expert\""), 40 + 3);
    assert_eq!(svg, figure::goals("Goals & ends", &cases).unwrap());
}

#[test]
fn a_goal_of_four_times_the_weight_has_twice_the_radius() {
    let track = walk([0.0, 0.0], [0.5, 0.0]);
    let places = vec![[9.5, 0.5], [8.0, 1.0], [9.0, -2.0]];
    let goals = WeightedGoals::new(places, vec![0.2, 0.16, 0.64]).unwrap();
    let case = GoalCase::new("a", &track, goals, Vec::new()).unwrap();
    let svg = figure::goals("", &[case]).unwrap();
    // 24 px for a certain goal: 9.6 and 19.2; the legend has rings of 2.4, 5.4 and 10.7.
    let rings = |class: &str, radius: &str| {
        let lines = svg.lines().filter(|line| line.contains(&format!("class=\"{class}\"")));
        lines.filter(|line| line.contains(&format!("r=\"{radius}\""))).count()
    };
    for radius in ["9.6", "19.2", "2.4", "5.4"] {
        assert_eq!(rings("goal weighted", radius), 1, "{radius}");
    }
    assert_eq!(rings("nearest", "10.7"), 1);
}

#[test]
fn the_place_in_the_world_does_not_matter() {
    let picture = |from| figure::goals("", &[case("a", from, [0.5, 0.25], 4, 8)]).unwrap();
    // Powers of two and their sums, so that no rounding occurs.
    assert_eq!(picture([0.0, 0.0]), picture([524_288.0, -4_194_304.0]));
}

#[test]
fn people_who_stand_and_goals_at_one_place_are_shown() {
    let track = walk([7.0, 7.0], [0.0, 0.0]);
    let goals = WeightedGoals::new(vec![[7.0, 7.0]; 4], vec![1.0, 0.0, 0.0, 0.0]).unwrap();
    let case = GoalCase::new("stands", &track, goals, vec![track.clone(); 3]).unwrap();
    let svg = figure::goals("", &[case]).unwrap();
    assert!(svg.contains("nearest goal 0.00 m off"));
    assert_eq!(count(&svg, "<circle"), LEGEND_CIRCLES + PANEL_CIRCLES + 3);
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn experts_that_lead_far_away_are_cut_and_do_not_shrink_the_pedestrian() {
    let sane = case("a", [0.0, 0.0], [0.5, 0.0], 3, 0);
    let here = [3.5, 0.0];
    let mut stray = vec![here; WINDOW];
    stray[WINDOW - 1] = [7e5, 7e5];
    let goals = [9.75, 10.0, 10.25].map(|x| [x, 0.0]).to_vec();
    let goals = WeightedGoals::new(goals, vec![1.0 / 3.0; 3]).unwrap();
    let with = GoalCase::new("a", &walk([0.0, 0.0], [0.5, 0.0]), goals, vec![stray]).unwrap();
    let (svg, bare) = (figure::goals("", &[with]).unwrap(), figure::goals("", &[sane]).unwrap());
    let circles = |svg: &str| -> Vec<String> {
        let lines = svg.lines().filter(|line| line.starts_with("<circle"));
        let across = |line: &str| line.split(" cy=").next().map(str::to_owned);
        lines.filter_map(across).collect()
    };
    assert!(!bare.contains("similar pedestrians") && !bare.contains("class=\"expert\""));
    // The panel is unchanged: only the legend, whose shapes come first, is different.
    assert_eq!(circles(&svg)[LEGEND_CIRCLES..], circles(&bare)[LEGEND_CIRCLES..]);
    // The part of the expert's line beyond the frame is cut off.
    let (_, plot) = svg.split_once("viewBox=\"60 ").unwrap();
    let (plot, after) = plot.split_once("</svg>").unwrap();
    assert_eq!(count(plot, "class=\"expert\""), 1);
    assert_eq!(count(after, "class=\"expert\""), 0);
}

#[test]
fn one_to_nine_cases_make_a_picture() {
    let cases: Vec<_> = (0..10)
        .map(|n| case("a", [0.0, 0.0], [0.5, 0.1 * f64::from(n)], 3, 2))
        .collect();
    for found in [0, 10] {
        let error = figure::goals("", &cases[..found]).unwrap_err();
        assert!(matches!(error, ReportError::Cases { found: f, most: 9 } if f == found));
    }
    let mut last = 0;
    for n in 1..=9 {
        let svg = figure::goals("", &cases[..n]).unwrap();
        let circles = count(&svg, "<circle");
        assert_eq!(circles, LEGEND_CIRCLES + n * (PANEL_CIRCLES + 2));
        assert!(circles > last);
        last = circles;
    }
}

fn window(pedestrians: i64) -> Window {
    let track = |i: i64| (0..20).map(move |t| [0.4 * f64::from(t), i as f64 + 0.05 * f64::from(t)]);
    let ids: Vec<_> = (0..pedestrians).map(PedestrianId).collect();
    let tracks = (0..pedestrians).map(|i| track(i).collect()).collect();
    Window::new("<corridor> & \"co\"", 120, 10, ids, tracks).unwrap()
}

const STAR: &str = "class=\"star\"";

#[test]
fn every_role_of_a_scene_is_drawn_and_named() {
    let window = window(2);
    let forecast = StraightLine(TrueEndpoint).forecast(&window).unwrap();
    let svg = figure::scene(&window, &forecast).unwrap();
    assert!(svg.starts_with("<?xml") && svg.trim_end().ends_with("</svg>"));
    for text in ["observed, 3.2 s", "truth, 4.8 s", "forecast", "goal", "x (m)", "y (m)"] {
        assert!(svg.contains(text), "no `{text}`");
    }
    // Text from the user's files must be escaped.
    assert!(svg.contains("&lt;corridor&gt; &amp; ") && !svg.contains("<corridor>"));
    // 8 observed dots, a true end and a goal for each of the two, and the legend's 4, 1 and 1.
    assert_eq!(count(&svg, "<circle"), 2 * (8 + 1 + 1) + 4 + 1 + 1);
    // A star for each of the two and for the legend.
    assert_eq!(count(&svg, STAR), 2 + 1);
}

#[test]
fn everybody_has_hypotheses() {
    let window = window(3);
    let noisy = ConstantVelocity::AngularNoise { seed: 1 };
    let forecast = noisy.forecast(&window).unwrap();
    let svg = figure::scene(&window, &forecast).unwrap();
    assert_eq!(count(&svg, STAR), 3 + 1);
    assert_eq!(svg, figure::scene(&window, &forecast).unwrap());
}

#[test]
fn a_window_without_future_has_no_truth() {
    let window = window(1).without_future();
    let forecast = ConstantVelocity::LastStep.forecast(&window).unwrap();
    let svg = figure::scene(&window, &forecast).unwrap();
    assert!(!svg.contains("class=\"truth") && !svg.contains("truth, 4.8 s"));
}

#[test]
fn strangers_are_refused() {
    let forecast = ConstantVelocity::LastStep.forecast(&window(2)).unwrap();
    let error = figure::scene(&window(1), &forecast).unwrap_err();
    let expected = "the window holds 1 pedestrians, the forecast 2";
    assert_eq!(error.to_string(), expected);
}
