//! The selection of moments of a fold.

use ddl_core::{Forecast, average_displacement};
use ddl_data::{Dataset, Window, WindowRule};
use ddl_eval::Protocol;
use ddl_eval::baseline::{ConstantVelocity, StraightLine, TrueEndpoint};
use ddl_report::{ForecastSnapshot, HighlightKind, gallery};

fn windows() -> Vec<Window> {
    let dataset = Dataset::simulated(1);
    dataset.fold("corridor").unwrap().test_windows(WindowRule::Complete)
}

fn oracle(windows: &[Window]) -> Vec<Forecast> {
    Protocol::Published
        .forecast(&StraightLine(TrueEndpoint), windows)
        .unwrap()
}

fn shown(moments: &[ForecastSnapshot]) -> Vec<HighlightKind> {
    let mut shown: Vec<HighlightKind> = moments.iter().flat_map(|m| &m.picks).map(|pick| pick.show).collect();
    shown.sort();
    shown
}

#[test]
fn each_kind_of_case_is_picked_once_and_time_is_covered() {
    let windows = windows();
    let moments = gallery::moments("corridor", "oracle", &windows, &oracle(&windows)).unwrap();
    let kinds = shown(&moments);
    assert!(kinds.contains(&HighlightKind::Convergence) && kinds.contains(&HighlightKind::KeepingDistance));
    let mut once = kinds.clone();
    once.dedup();
    assert_eq!(kinds, once);
    let plain = moments.iter().filter(|m| m.picks.is_empty()).count();
    assert!((8 - kinds.len()..=8).contains(&plain), "{plain}");
    // In order of time, from the first to the last eighth of the recording.
    let frames: Vec<i64> = moments.iter().map(|m| m.frame).collect();
    assert!(frames.is_sorted());
    let present: Vec<i64> = windows.iter().map(|w| w.frames()[7]).collect();
    let (first, last) = (present[present.len() / 8], present[7 * present.len() / 8]);
    assert!(frames[0] <= first && frames[frames.len() - 1] >= last);
    for moment in &moments {
        for pick in &moment.picks {
            assert!(pick.pedestrians.iter().all(|&i| i < moment.pedestrians.len()));
            assert!(pick.rule.contains("minADE"), "{}", pick.rule);
        }
    }
}

#[test]
fn the_case_shown_is_the_median_one() {
    let windows = windows();
    let forecasts = oracle(&windows);
    let moments = gallery::moments("corridor", "oracle", &windows, &forecasts).unwrap();
    let mut picks = moments.iter().flat_map(|m| m.picks.iter().map(move |pick| (m, pick)));
    let (moment, pick) = picks.find(|(_, p)| p.show == HighlightKind::Convergence).unwrap();
    let error = |window: &Window, i: usize, forecast: &Forecast| {
        average_displacement(forecast.hypothesis(i, 0), window.future(i))
    };
    // All lines of the oracle reach their goals, so the cases are the pedestrians that move at least two metres.
    let mut errors: Vec<f64> = Vec::new();
    let mut shown = None;
    for (window, forecast) in windows.iter().zip(&forecasts) {
        for i in 0..window.len() {
            let ([x, y], end) = (window.observed(i)[7], forecast.hypothesis(i, 0)[11]);
            if (end[0] - x).hypot(end[1] - y) < 2.0 {
                continue;
            }
            errors.push(error(window, i, forecast));
            if window.frames()[7] == moment.frame && i == pick.pedestrians[0] {
                shown = errors.last().copied();
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    assert_eq!(shown, Some(errors[(errors.len() - 1) / 2]));
    assert!(pick.rule.starts_with(&format!("of {} such pedestrians", errors.len())));
}

#[test]
fn forecasts_without_goals_converge_nowhere_and_few_windows_are_all_shown() {
    let windows = windows();
    let forecasts = Protocol::Fair
        .forecast(&ConstantVelocity::LastStep, &windows[..3])
        .unwrap();
    let moments = gallery::moments("corridor", "CV", &windows[..3], &forecasts).unwrap();
    assert_eq!(moments.len(), 3);
    assert!(!shown(&moments).contains(&HighlightKind::Convergence));
    assert_eq!(gallery::moments("corridor", "CV", &[], &[]).unwrap(), []);
    assert!(gallery::moments("corridor", "CV", &windows, &forecasts).is_err());
    assert!(gallery::moments("c", "CV", &[windows[0].without_future()], &forecasts[..1]).is_err());
}
