//! Selection of windows to show (moments): evenly spread moments of a fold, and a typical case of each kind.

use std::collections::{BTreeMap, BTreeSet};

use ddl_core::{Forecast, distance};
use ddl_data::{HORIZON, OBSERVED, Position, Window};
use ddl_eval::category::MotionKind;
use ddl_eval::category::interaction::{avoids_collision, is_group};
use ddl_eval::metric::collision::closest_approach;
use ddl_eval::metric::displacement::DisplacementErrors;
use ddl_eval::{EvaluationError, ScoredWindow};

use crate::snapshot::{ForecastSnapshot, Highlight, HighlightKind};

/// Number of evenly spread moments of each recording.
const MOMENTS_A_RECORDING: usize = 8;
/// Smallest displacement of a converging pedestrian, and largest distance of its end from its goal, m.
const GONE: f64 = 2.0;
const ARRIVED: f64 = 0.2;
/// Smallest distance of pedestrians that keep their distance: twice the radius of a pedestrian, m.
const APART: f64 = 0.4;

/// Chooses moments to show from the forecasts of one fold (one forecast for each window), in order of recording and
/// time.
///
/// For each [`HighlightKind`] the moment of the pedestrian with the median minADE; for each recording 8 evenly spread
/// moments.
///
/// # Errors
/// A window has no future, or a forecast is not of its window's pedestrians.
pub fn moments(
    fold: &str,
    forecaster: &str,
    windows: &[Window],
    forecasts: &[Forecast],
) -> Result<Vec<ForecastSnapshot>, EvaluationError> {
    if windows.len() != forecasts.len() {
        let (windows, forecasts) = (windows.len(), forecasts.len());
        return Err(EvaluationError::Count { windows, forecasts });
    }
    let mut shown: BTreeMap<usize, Vec<Highlight>> = spread_over_time(windows)
        .into_iter()
        .map(|index| (index, Vec::new()))
        .collect();
    for (index, pick) in picks(windows, forecasts)? {
        shown.entry(index).or_default().push(pick);
    }
    shown
        .into_iter()
        .map(|(index, picks)| {
            let mut moment = ForecastSnapshot::new(fold, forecaster, &windows[index], &forecasts[index])?;
            moment.picks = picks;
            Ok(moment)
        })
        .collect()
}

struct GalleryCase {
    window: usize,
    pedestrians: Vec<usize>,
    min_ade: f64,
}

fn picks(windows: &[Window], forecasts: &[Forecast]) -> Result<Vec<(usize, Highlight)>, EvaluationError> {
    let mut cases: BTreeMap<HighlightKind, Vec<GalleryCase>> = BTreeMap::new();
    for (index, (window, forecast)) in windows.iter().zip(forecasts).enumerate() {
        let scene = ScoredWindow::new(window, forecast)?;
        let errors = DisplacementErrors::of(&scene);
        for i in 0..window.len() {
            for (show, pedestrians) in shows(&scene, i) {
                cases.entry(show).or_default().push(GalleryCase {
                    window: index,
                    pedestrians,
                    min_ade: errors.min_ade(i),
                });
            }
        }
    }
    Ok(cases.into_iter().map(|(show, cases)| median(show, cases)).collect())
}

fn median(show: HighlightKind, mut cases: Vec<GalleryCase>) -> (usize, Highlight) {
    let count = cases.len();
    cases.sort_by(|a, b| a.min_ade.total_cmp(&b.min_ade).then(a.window.cmp(&b.window)));
    let case = cases.swap_remove((count - 1) / 2);
    let rule = match count {
        1 => format!("the only such pedestrian (minADE {:.2} m)", case.min_ade),
        _ => format!(
            "of {count} such pedestrians the one of median minADE ({:.2} m)",
            case.min_ade
        ),
    };
    let pedestrians = case.pedestrians;
    let pick = Highlight {
        show,
        pedestrians,
        rule,
    };
    (case.window, pick)
}

fn shows(scene: &ScoredWindow<'_>, i: usize) -> Vec<(HighlightKind, Vec<usize>)> {
    let window = scene.window();
    let mut shows = Vec::new();
    if converges(scene, i) {
        shows.push((HighlightKind::Convergence, vec![i]));
    }
    match MotionKind::of(window.track(i)) {
        Some(MotionKind::SlowingDown) => shows.push((HighlightKind::SlowingDown, vec![i])),
        Some(MotionKind::TurningLeft | MotionKind::TurningRight) => {
            shows.push((HighlightKind::Turning, vec![i]));
        }
        _ => {}
    }
    if let Some((other, _)) = nearest(window, i, is_group, mean_distance) {
        shows.push((HighlightKind::Group, vec![i, other]));
    }
    let passed = nearest(window, i, avoids_collision, closest_approach);
    if let Some((other, apart)) = passed
        && apart >= APART
    {
        shows.push((HighlightKind::KeepingDistance, vec![i, other]));
    }
    shows
}

fn converges(scene: &ScoredWindow<'_>, i: usize) -> bool {
    let k = scene.forecast().representative(i);
    let end = scene.forecast().hypothesis(i, k)[HORIZON - 1];
    distance(scene.window().observed(i)[OBSERVED - 1], end) >= GONE
        && scene
            .forecast()
            .goal(i, k)
            .is_some_and(|goal| distance(end, goal) <= ARRIVED)
}

/// Among the pedestrians that interact with pedestrian `i` in this way, the one whose true future comes nearest, and
/// its least distance (m).
fn nearest(
    window: &Window,
    i: usize,
    interacts: fn(&[Position], &[Position]) -> bool,
    apart: fn(&[Position], &[Position]) -> f64,
) -> Option<(usize, f64)> {
    (0..window.len())
        .filter(|&j| j != i && interacts(window.track(i), window.track(j)))
        .map(|j| (j, apart(window.future(i), window.future(j))))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

fn mean_distance(a: &[Position], b: &[Position]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(p, q)| distance(*p, *q)).sum();
    sum / a.len() as f64
}

/// Indices of windows spread evenly over each recording: the middles of 8 equal parts.
fn spread_over_time(windows: &[Window]) -> BTreeSet<usize> {
    let mut of_recording: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, window) in windows.iter().enumerate() {
        of_recording.entry(window.recording()).or_default().push(index);
    }
    of_recording
        .values()
        .flat_map(|indices| {
            (0..MOMENTS_A_RECORDING).map(|part| indices[(2 * part + 1) * indices.len() / (2 * MOMENTS_A_RECORDING)])
        })
        .collect()
}
