//! The content of pictures of scenes.

use ddl_core::Forecaster;
use ddl_data::{PedestrianId, Window};
use ddl_eval::baseline::{ConstantVelocity, StraightLine, TrueEndpoint};
use ddl_report::figure;

fn count(svg: &str, shape: &str) -> usize {
    svg.matches(shape).count()
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

/// What has no rule is black.
#[test]
fn every_class_of_a_picture_has_a_rule_in_its_file() {
    let window = window(2);
    let forecast = StraightLine(TrueEndpoint).forecast(&window).unwrap();
    let tracks = [window.track(0).to_vec(), window.track(1).to_vec()];
    for svg in [
        figure::scene(&window, &forecast).unwrap(),
        figure::place("hall", "2 tracks", &tracks),
    ] {
        let (style, shapes) = svg.split_once("</style>").unwrap();
        // All text has one.
        let elements = shapes.split('<').filter(|element| !element.starts_with("text"));
        let classes = elements.filter_map(|element| element.split_once("class=\"")?.1.split('"').next());
        for class in classes.flat_map(str::split_whitespace) {
            assert!(style.contains(&format!(".{class} {{")), "no rule for .{class}");
        }
    }
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
