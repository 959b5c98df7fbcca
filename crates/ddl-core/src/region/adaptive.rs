//! Regions that keep their coverage in a new place, and weights that follow it, by online calibration.

use std::collections::{BTreeMap, VecDeque};

use crate::forecast::Forecast;
use crate::pace::Pace;
use crate::pedestrian::PedestrianId;
use crate::position::{HORIZON, OBSERVED, Position, between};
use crate::region::powers::{self, TrackedPowers};
use crate::region::tracked::{Moment, Outcomes, TrackedQuantiles};
use crate::region::whole::{Holding, missed};
use crate::region_table::RegionTable;
use crate::window::Window;

/// Adapts the regions of the forecasts of one place so that they keep their coverage, and the weights to what their
/// outcomes were. It takes every forecast, in order of time.
///
/// The regions of a forecast `t` steps ahead are compared with the positions observed `t` steps later, those of [whole
/// paths and scenes](crate::Holding) when the forecast has ended. The result changes all later regions. Pedestrians
/// outside the window of that frame are skipped, as are tracks that began after the forecast: another person has taken
/// the id. The result does not depend on the order of the pedestrians, or on later frames.
///
/// It begins with the table of the first forecast that has one. Forecasts without regions are unchanged.
///
/// # Examples
/// ```
/// use ddl_core::{AdaptiveRegions, Forecast, HORIZON, Pace, PedestrianId, RegionTable, Spread, Window};
///
/// let scores: Vec<_> = (1..100).map(|n| [f64::from(n) / 20.0; HORIZON]).collect();
/// let regions = std::sync::Arc::new(RegionTable::of(&[&scores; 3], &[0.5, 0.9]).expect("99 scores"));
/// let mut adaptive = AdaptiveRegions::default();
/// for frame in 0..100 {
///     // A standing pedestrian with a forecast that says so.
///     let window = Window::new("yard", frame, 1, vec![PedestrianId(1)], vec![vec![[1.0, 2.0]; 8]])?;
///     let forecast = Forecast::with_equal_weights(1, 1, vec![[1.0, 2.0]; HORIZON])?
///         .with_spread(Spread { scales: vec![0.5; HORIZON], paces: vec![Pace::Standing], regions: regions.clone() })?;
///     let fixed = forecast.region_radius(0, 0, 5, 0.9);
///     let adapted = adaptive.adapt(&window, forecast).region_radius(0, 0, 5, 0.9);
///     assert_eq!(adapted < fixed, frame >= 6, "smaller as soon as its first outcome is known");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct AdaptiveRegions {
    learned: Option<TrackedQuantiles>,
    powers: TrackedPowers,
    /// The last frame and earlier frames with pending forecasts, oldest first.
    pending: VecDeque<Pending>,
}

/// A forecast whose outcomes are not yet observed.
#[derive(Debug, Clone)]
struct Pending {
    /// The last frame observed.
    frame: i64,
    /// `None` for those whose track has ended.
    pedestrians: Vec<Option<PedestrianId>>,
    forecast: Forecast,
    /// The time since the frame before, in steps, at most 1.
    share: f64,
    /// `[N][12]`, NaN where a pedestrian was not seen.
    scores: Vec<[f64; HORIZON]>,
}

impl AdaptiveRegions {
    /// The table as learned so far; `None` before the first forecast with regions.
    pub fn table(&self) -> Option<&RegionTable> {
        self.learned.as_ref().map(|learned| learned.table().as_ref())
    }

    /// Forgets the pending forecasts, as after a restart of a tracker. The [table](Self::table) and the powers of the
    /// weights are kept.
    pub fn clear(&mut self) {
        self.pending.clear();
    }

    /// Learns from the positions at the last observed frame of the window, and gives the forecast its new regions
    /// and weights. If the frame is not later than the previous one, the pending forecasts are [cleared](Self::clear)
    /// first.
    ///
    /// # Panics
    /// When the forecast has fewer pedestrians than the window.
    #[must_use]
    pub fn adapt(&mut self, window: &Window, forecast: Forecast) -> Forecast {
        let Some(table) = forecast.shared_regions() else {
            return forecast;
        };
        let learned = self.learned.get_or_insert_with(|| TrackedQuantiles::new(table));
        let (now, step) = (window.frames()[OBSERVED - 1], window.frame_step());
        if self.pending.back().is_some_and(|last| last.frame >= now) {
            self.pending.clear();
        }
        let young = young(window);
        for pending in self.pending.iter_mut().filter(|_| !young.is_empty()) {
            let frame = pending.frame;
            let is_other = |id: &mut PedestrianId| young.get(id).is_some_and(|before| frame <= *before);
            for pedestrian in &mut pending.pedestrians {
                pedestrian.take_if(is_other);
            }
        }
        let share = self.pending.back().map_or(1.0, |last| ((now - last.frame) as f64 / step as f64).min(1.0));
        let previous = self.pending.back().map(|last| last.frame);
        let places = (0..window.len()).map(|i| (window.pedestrians()[i], i)).collect();
        self.pending.iter_mut().for_each(|pending| pending.note(window, &places));
        let judged = self.pending.iter();
        let outcomes: Vec<Outcomes> = judged.filter_map(|pending| pending.outcomes(window, previous)).collect();
        learned.learn(&outcomes, share);
        let ended = self.pending.iter().take_while(|first| first.is_over(now, step));
        let gradients: Vec<_> = ended.flat_map(|ended| ended.gradients(window, previous)).collect();
        self.powers.learn(gradients, share);
        let ended = self.pending.iter().take_while(|first| first.is_over(now, step));
        learned.learn_wholes(ended.filter_map(Pending::moment));
        let forecast = self.powers.raised(forecast).with_regions(learned.table());
        while self.pending.front().is_some_and(|first| first.is_over(now, step)) {
            self.pending.pop_front();
        }
        self.pending.push_back(Pending::new(window, &forecast, share));
        forecast
    }
}

/// The pedestrians whose tracks began within the window, each with the last frame of the window before the track.
fn young(window: &Window) -> BTreeMap<PedestrianId, i64> {
    let pedestrians = window.pedestrians().iter().enumerate();
    let begun = pedestrians.filter_map(|(i, id)| {
        let before = window.quality(i).unseen.checked_sub(1)?;
        Some((*id, window.frames()[before]))
    });
    begun.collect()
}

impl Pending {
    fn new(window: &Window, forecast: &Forecast, share: f64) -> Self {
        Self {
            frame: window.frames()[OBSERVED - 1],
            pedestrians: window.pedestrians().iter().copied().map(Some).collect(),
            forecast: forecast.clone(),
            share,
            scores: vec![[f64::NAN; HORIZON]; window.len()],
        }
    }

    fn is_over(&self, now: i64, frame_step: i64) -> bool {
        now - self.frame >= HORIZON as i64 * frame_step
    }

    /// The last step of the forecast up to the last observed frame of the window, and the positions of its pedestrians
    /// there; `None` if an earlier window has shown that step.
    fn seen(&self, window: &Window, previous: Option<i64>) -> Option<(usize, Vec<(usize, Position)>)> {
        let (now, frame_step) = (window.frames()[OBSERVED - 1], window.frame_step());
        let after = now - self.frame;
        let (steps, back) = (after / frame_step, after % frame_step);
        let is_new = back == 0 || previous.is_some_and(|previous| previous < now - back);
        if !(is_new && (1..=HORIZON as i64).contains(&steps)) {
            return None;
        }
        let share = back as f64 / frame_step as f64;
        let position = |id: &PedestrianId| -> Option<Position> {
            let i = window.pedestrians().iter().position(|other| other == id)?;
            // A position that is carried on was not observed.
            if window.quality(i).age > 0.0 {
                return None;
            }
            let [.., before, last] = *window.observed(i) else {
                return None;
            };
            Some(between(last, before, share))
        };
        let seen = self.pedestrians.iter().enumerate().filter_map(|(i, id)| Some((i, position(id.as_ref()?)?)));
        Some((steps as usize - 1, seen.collect()))
    }

    /// Notes the scores at the steps up to now that are not known. These are several for a pedestrian of whom rows were
    /// doubted or missing, as those of surprising motions are, and where frames are further apart than steps.
    fn note(&mut self, window: &Window, places: &BTreeMap<PedestrianId, usize>) {
        let (after, frame_step) = (window.frames()[OBSERVED - 1] - self.frame, window.frame_step());
        let (steps, share) = ((after / frame_step) as usize, (after % frame_step) as f64 / frame_step as f64);
        for (i, id) in self.pedestrians.iter().enumerate() {
            let Some(&place) = id.as_ref().and_then(|id| places.get(id)) else {
                continue;
            };
            let quality = window.quality(place);
            let observed = &window.observed(place)[quality.unseen.min(OBSERVED - 2)..];
            for (ago, &[before, last]) in observed.array_windows().rev().enumerate().filter(|_| quality.age <= 0.0) {
                let Some(score) = steps.checked_sub(ago + 1).and_then(|step| self.scores[i].get_mut(step)) else {
                    continue;
                };
                if !score.is_nan() {
                    break;
                }
                let at = between(last, before, share);
                *score = self.forecast.region_score(i, steps - ago - 1, at).unwrap_or(f64::NAN);
            }
        }
    }

    /// The scores of the pedestrians that were seen at a step of the forecast; `None` without any.
    fn outcomes(&self, window: &Window, previous: Option<i64>) -> Option<Outcomes> {
        let (step, seen) = self.seen(window, previous)?;
        let score = |(i, _): (usize, Position)| Some((self.forecast.pace(i)?, self.scores[i][step]));
        let scores: Vec<_> = seen.into_iter().filter_map(score).collect();
        let table = self.forecast.shared_regions()?;
        (!scores.is_empty()).then_some(Outcomes { step, table, scores })
    }

    /// Once the forecast has ended: which regions of whole paths, and of the whole scene, were left. Paths count of
    /// pedestrians who were observed at all 12 steps. The scene counts every observed position of every pedestrian.
    /// `None` if there are none, or the table has no such regions.
    fn moment(&self) -> Option<Moment> {
        let table = self.forecast.regions()?;
        let [path, scene] =
            [Holding::Path, Holding::Scene].map(|holding| table.holding(holding, self.forecast.pedestrians()));
        let (path, scene) = (path?, scene?);
        let mut scene_missed = vec![false; table.0.levels.len()];
        let mut paths = Vec::new();
        for (i, scores) in self.scores.iter().enumerate().filter(|(_, scores)| scores.iter().any(|s| !s.is_nan())) {
            let pace = self.forecast.pace(i)?;
            for (any, one) in scene_missed.iter_mut().zip(missed(&scene, pace, scores)) {
                *any |= one;
            }
            if scores.iter().all(|score| !score.is_nan()) {
                paths.push((pace, missed(&path, pace, scores).collect()));
            }
        }
        let anybody = self.scores.as_flattened().iter().any(|score| !score.is_nan());
        anybody.then_some(Moment { share: self.share, paths, scene_missed })
    }

    /// The paces and gradients of the pedestrians that were seen at the end of the forecast.
    fn gradients(&self, window: &Window, previous: Option<i64>) -> Vec<(Pace, f64)> {
        let ended = self.seen(window, previous).filter(|(step, _)| *step == HORIZON - 1);
        let (_, seen) = ended.unwrap_or_default();
        let gradient = |(i, end)| Some((self.forecast.pace(i)?, powers::gradient(&self.forecast, i, end)));
        seen.into_iter().filter_map(gradient).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use std::sync::Arc;

    use super::*;
    use crate::forecast::Spread;
    use crate::region::Wholes;
    use crate::region_table::LevelQuantiles;

    #[test]
    fn forecasts_without_regions_pass_the_first_has_its_table_and_few_are_pending() {
        let bare = Forecast::with_equal_weights(1, 1, vec![[1.0, 2.0]; HORIZON]).unwrap();
        let regions = RegionTable::of(&[&[[0.5; HORIZON]; 9]; 3], &[0.5]).unwrap().into();
        let (scales, paces) = (vec![0.7; HORIZON], vec![Pace::Slow]);
        let forecast = bare.clone().with_spread(Spread { scales, paces, regions }).unwrap();
        let window = |frame| Window::new("yard", frame, 2, vec![PedestrianId(1)], vec![vec![[1.0, 2.0]; 8]]).unwrap();
        let mut regions = AdaptiveRegions::default();
        assert_eq!(regions.adapt(&window(0), bare.clone()), bare);
        assert_eq!(regions.table(), None);
        assert_eq!(regions.adapt(&window(0), forecast.clone()), forecast);
        for frame in 1..60 {
            let adapted = regions.adapt(&window(frame), forecast.clone());
            assert_eq!(adapted == forecast, frame == 1, "{frame}");
            assert!(regions.pending.len() <= 2 * HORIZON, "a forecast is pending for 4.8 s");
        }
        regions.clear();
        assert!(regions.pending.is_empty() && regions.table().is_some());
    }

    /// Two stand, one of whom leaves after five steps: paths are judged of the other alone, moments of both as long as
    /// they are seen.
    #[test]
    fn who_leaves_counts_for_the_moment_and_not_as_a_path() {
        let wholes = Wholes { paths: [(); 3].map(|()| vec![2.0]), scenes: vec![[1.5, 0.5]] };
        let table = RegionTable::of(&[&[[0.5; HORIZON]; 9]; 3], &[0.5]).unwrap();
        let regions: Arc<RegionTable> = RegionTable(LevelQuantiles { wholes: Some(wholes), ..table.0 }).into();
        let at = |frame: i64| {
            let n = if frame > 5 { 1 } else { 2 };
            // In the third frame both are outside of all regions, so every path and scene that counts was left.
            let place = |frame: i64| if frame == 3 { [1.0, 7.0] } else { [1.0, 2.0] };
            let track: Vec<Position> = (frame - 7..=frame).map(place).collect();
            let ids = [1, 2].map(PedestrianId)[..n].to_vec();
            let window = Window::new("yard", frame - 7, 1, ids, vec![track; n]).unwrap();
            let spread = Spread {
                scales: vec![0.7; n * HORIZON],
                paces: [Pace::Slow, Pace::Standing][..n].to_vec(),
                regions: Arc::clone(&regions),
            };
            let bare = Forecast::with_equal_weights(n, 1, vec![[1.0, 2.0]; n * HORIZON]).unwrap();
            (window, bare.with_spread(spread).unwrap())
        };
        // Steps between frames are in the windows of later ones.
        let [wholes, seldom] = [(0..=12).collect(), vec![0, 2, 4, 5, 8, 12]].map(|frames: Vec<i64>| {
            let mut adaptive = AdaptiveRegions::default();
            for (window, forecast) in frames.into_iter().map(at) {
                let _ = adaptive.adapt(&window, forecast);
            }
            adaptive.table().unwrap().0.wholes.clone().unwrap()
        });
        assert_eq!(wholes, seldom);
        let expected = 2.0 * (0.06 * 0.5_f64).exp();
        assert!(wholes.paths.iter().all(|row| (row[0] - expected).abs() < 1e-12), "{wholes:?}");
        assert!((wholes.scenes[0][0] - 1.5 * (0.15 * 0.5_f64).exp()).abs() < 1e-12, "{wholes:?}");
    }
}
