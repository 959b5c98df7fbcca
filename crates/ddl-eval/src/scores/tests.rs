//! Scores of whole test sets, by hand, and what is refused.

use super::*;
use crate::fixture::{forecast, walk, window};

#[test]
fn what_does_not_belong_together_is_refused() {
    let still = [0.0, 0.0];
    let windows = [window(&[still], &[still]), window(&[still], &[still])];
    let one = forecast(1, &[walk(still, still)]);
    let two = forecast(1, &[walk(still, still), walk(still, still)]);
    let pair = forecast(2, &[walk(still, still), walk(still, still)]);
    let error = |w: &[Window], f: &[Forecast]| Scores::evaluate(w, f).unwrap_err();
    assert!(matches!(error(&[], &[]), EvaluationError::NoWindows));
    let uneven = error(&windows, &[]);
    assert!(matches!(uneven, EvaluationError::Count { windows: 2, forecasts: 0 }));
    let of_window = |w: &[Window], f: &[Forecast]| match error(w, f) {
        EvaluationError::Window { problem, .. } => problem,
        other => panic!("{other}"),
    };
    let (expected, found) = (1, 2);
    assert_eq!(of_window(&windows, &[one.clone(), two]), WindowProblem::Hypotheses { expected, found });
    assert_eq!(of_window(&windows[..1], &[pair]), WindowProblem::Pedestrians { expected, found });
    let tracks = || vec![windows[0].track(0).to_vec()];
    let full = |name: &str, start| Window::new(name, start, 10, windows[0].pedestrians().to_vec(), tracks()).unwrap();
    for (full, fits) in [(full("made up", 0), true), (full("other", 0), false), (full("made up", 9), false)] {
        assert_eq!(Scores::under(Protocol::Fair, &windows[..1], &[full], std::slice::from_ref(&one)).is_ok(), fits);
    }
    let ahead = [windows[0].without_future()];
    assert_eq!(of_window(&ahead, std::slice::from_ref(&one)), WindowProblem::NoFuture);
    assert_eq!(
        error(&ahead, &[one]).to_string(),
        "window of `made up` starting at frame 0 has no true future: it can be forecast but not scored"
    );
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let steps = [[0.3, 0.1], [-0.2, 0.37], [0.41, -0.13]];
    let scene = |w: i32| {
        let window = window(&steps.map(|s| [s[0] * f64::from(w), 1.7 * s[1]]), &steps);
        let walks = (0..6).map(|h| walk(window.observed(h / 2)[7], [0.1 * h as f64, 0.3]));
        let forecast = forecast(3, &walks.collect::<Vec<_>>());
        (window, forecast)
    };
    let (windows, forecasts): (Vec<Window>, Vec<Forecast>) = (0..40).map(scene).unzip();
    let [one, two, five] = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let scores = || Scores::evaluate(&windows, &forecasts).unwrap();
        serde_json::to_string(&pool.build().unwrap().install(scores)).unwrap()
    });
    assert!(one.contains("\"amd\":") && !one.contains("\"amd\":null"));
    assert_eq!((&two, &five), (&one, &one));
}
