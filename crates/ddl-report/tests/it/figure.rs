//! The content of pictures of scenes.

use ddl_core::{Forecaster, PedestrianId, Window};
use ddl_eval::baseline::{ConstantVelocity, StraightLine, TrueEndpoint};
use ddl_report::figure;

fn window(pedestrians: i64) -> Window {
    let track = |i: i64| (0..20).map(move |t| [0.4 * f64::from(t), i as f64 + 0.05 * f64::from(t)]);
    let ids: Vec<_> = (0..pedestrians).map(PedestrianId).collect();
    let tracks = (0..pedestrians).map(|i| track(i).collect()).collect();
    Window::new("<corridor> & \"co\"", 120, 10, ids, tracks).unwrap()
}

/// Text from the user's files.
#[test]
fn names_are_escaped() {
    let forecast = StraightLine(TrueEndpoint).forecast(&window(2)).unwrap();
    let svg = figure::scene(&window(2), &forecast).unwrap();
    assert!(svg.contains("&lt;corridor&gt; &amp; ") && !svg.contains("<corridor>"));
}

/// What has no rule is black.
#[test]
fn every_class_of_a_picture_has_a_rule_in_its_file() {
    let window = window(2);
    let forecast = StraightLine(TrueEndpoint).forecast(&window).unwrap();
    let tracks = [window.track(0).to_vec(), window.track(1).to_vec()];
    for svg in [figure::scene(&window, &forecast).unwrap(), figure::place("hall", "2 tracks", &tracks)] {
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
    assert_eq!(error.to_string(), "the window holds 1 pedestrians, the forecast 2");
}
