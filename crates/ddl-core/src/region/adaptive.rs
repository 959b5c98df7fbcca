//! Regions that keep their coverage in a new place, and weights that follow it, by online calibration.

use std::collections::{BTreeMap, VecDeque};

use crate::forecast::Forecast;
use crate::pace::Pace;
use crate::pedestrian::PedestrianId;
use crate::position::{HORIZON, OBSERVED, Position, between};
use crate::region::powers::{self, TrackedPowers};
use crate::region::tracked::{Outcomes, TrackedQuantiles};
use crate::region_table::RegionTable;
use crate::window::Window;

/// Adapts the regions of the forecasts of one place so that they keep their coverage, and the weights to what their
/// outcomes were. It takes every forecast, in order of time.
///
/// The regions of a forecast `t` steps ahead are compared with the positions observed `t` steps later. The result
/// changes all later regions. Pedestrians outside the window of that frame are skipped, as are tracks that began after
/// the forecast: another person has taken the id. The result does not depend on the order of the pedestrians, or on
/// later frames.
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
        let share = self
            .pending
            .back()
            .map_or(1.0, |last| ((now - last.frame) as f64 / step as f64).min(1.0));
        let previous = self.pending.back().map(|last| last.frame);
        let judged = self.pending.iter();
        let outcomes: Vec<Outcomes> = judged
            .filter_map(|pending| pending.outcomes(window, previous))
            .collect();
        learned.learn(&outcomes, share);
        let ended = self.pending.iter().take_while(|first| first.is_over(now, step));
        let gradients: Vec<_> = ended.flat_map(|ended| ended.gradients(window, previous)).collect();
        self.powers.learn(gradients, share);
        let forecast = self.powers.raised(forecast).with_regions(learned.table());
        while self.pending.front().is_some_and(|first| first.is_over(now, step)) {
            self.pending.pop_front();
        }
        self.pending.push_back(Pending::new(window, &forecast));
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
    fn new(window: &Window, forecast: &Forecast) -> Self {
        Self {
            frame: window.frames()[OBSERVED - 1],
            pedestrians: window.pedestrians().iter().copied().map(Some).collect(),
            forecast: forecast.clone(),
        }
    }

    fn is_over(&self, now: i64, frame_step: i64) -> bool {
        now - self.frame >= HORIZON as i64 * frame_step
    }

    /// The last step of the forecast up to the last observed frame of the window, and the positions of its pedestrians
    /// there; `None` if an earlier window has shown that step.
    fn seen<'a>(&'a self, window: &'a Window, previous: Option<i64>) -> Option<(usize, Vec<(usize, Position)>)> {
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
        let people = self.pedestrians.iter().enumerate();
        let seen = people.filter_map(|(i, id)| Some((i, position(id.as_ref()?)?)));
        Some((steps as usize - 1, seen.collect()))
    }

    /// The scores of the pedestrians that were seen at a step of the forecast; `None` without any.
    fn outcomes(&self, window: &Window, previous: Option<i64>) -> Option<Outcomes> {
        let (step, seen) = self.seen(window, previous)?;
        let score = |(i, position)| Some((self.forecast.pace(i)?, self.forecast.region_score(i, step, position)?));
        let scores: Vec<_> = seen.into_iter().filter_map(score).collect();
        let table = self.forecast.shared_regions()?;
        (!scores.is_empty()).then_some(Outcomes { step, table, scores })
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

    use proptest::{collection::vec, prelude::*};

    use super::*;
    use crate::forecast::Spread;
    use crate::quality::ObservationQuality;

    /// The positions of all pedestrians, frame by frame.
    type Tracks = Vec<Vec<Position>>;

    const PEOPLE: usize = 4;

    fn tracks() -> impl Strategy<Value = Tracks> {
        let step = vec([-0.8..0.8f64, -0.8..0.8f64], PEOPLE);
        vec(step, 40..60).prop_map(|steps| {
            let mut positions = vec![[0.0; 2]; PEOPLE];
            let moved = steps.into_iter().map(|steps| {
                for (position, step) in positions.iter_mut().zip(steps) {
                    *position = [position[0] + step[0], position[1] + step[1]];
                }
                positions.clone()
            });
            moved.collect()
        })
    }

    /// Forecasts of two hypotheses, standing still and walking on, of pedestrians in this order, up to each frame.
    fn forecasts(tracks: &Tracks, order: [usize; PEOPLE]) -> Vec<(Window, Forecast)> {
        let scores: Vec<[f64; HORIZON]> = (1..100).map(|n| [f64::from(n) / 30.0; HORIZON]).collect();
        let table = Arc::new(RegionTable::of(&[&scores; 3], &[0.3, 0.5, 0.9]).unwrap());
        let until = |last: usize| {
            // The second pedestrian is away for a while.
            let here = |i: &&usize| **i != 1 || !(20..30).contains(&last);
            let people: Vec<usize> = order.iter().filter(here).copied().collect();
            let observed = |&i: &usize| (last - 7..=last).map(|t| tracks[t][i]).collect();
            let window = Window::new(
                "yard",
                last as i64 - 7,
                1,
                people.iter().map(|&i| PedestrianId(i as i64)).collect(),
                people.iter().map(observed).collect(),
            );
            let window = window.unwrap();
            let mut walks = Vec::new();
            for i in 0..window.len() {
                let [.., before, at] = window.observed(i) else {
                    unreachable!("8 positions")
                };
                let on = |t: usize| [0, 1].map(|a| at[a] + t as f64 * (at[a] - before[a]));
                walks.extend([*at; HORIZON]);
                walks.extend((1..=HORIZON).map(on));
            }
            let weights = [0.6, 0.4].repeat(window.len());
            let forecast = Forecast::new(window.len(), 2, walks, weights, None).unwrap();
            let paces = (0..window.len()).map(|i| Pace::of(window.observed(i), 0.4, 0.0));
            let spread = Spread {
                scales: vec![0.7; HORIZON * window.len()],
                paces: paces.collect(),
                regions: Arc::clone(&table),
            };
            let forecast = forecast.with_spread(spread).unwrap();
            (window, forecast)
        };
        (7..tracks.len()).map(until).collect()
    }

    fn adapted(regions: &mut AdaptiveRegions, stream: &[(Window, Forecast)]) -> Vec<(RegionTable, TrackedPowers)> {
        let adapt = |(window, forecast): &(Window, Forecast)| {
            let adapted = regions.adapt(window, forecast.clone());
            (adapted.regions().unwrap().clone(), regions.powers.clone())
        };
        stream.iter().map(adapt).collect()
    }

    const ORDER: [usize; PEOPLE] = [0, 1, 2, 3];

    proptest! {
        #[test]
        fn the_order_of_pedestrians_does_not_matter(tracks in tracks(), order in Just(ORDER).prop_shuffle()) {
            let one = adapted(&mut AdaptiveRegions::default(), &forecasts(&tracks, ORDER));
            let other = adapted(&mut AdaptiveRegions::default(), &forecasts(&tracks, order));
            prop_assert_eq!(one, other);
        }
    }

    /// The same tracks where pedestrian 2 is another person from frame 25 on, with its old id or a new one.
    #[test]
    fn an_id_of_another_person_is_as_a_new_one() {
        let [old, new] = [2, 9].map(|id| {
            let tracks = (0..60).map(|t: i32| {
                let mut now = vec![[0.3 * f64::from(t), 1.0]; PEOPLE];
                now[2] = [if t < 25 { 0.0 } else { 50.0 }, 0.5 * f64::from(t)];
                now
            });
            let stream = forecasts(&tracks.collect(), ORDER)
                .into_iter()
                .map(|(window, forecast)| {
                    let last = window.frames()[OBSERVED - 1];
                    let mut qualities = vec![ObservationQuality::default(); window.len()];
                    let mut ids = window.pedestrians().to_vec();
                    let i = ids.iter().position(|id| id.0 == 2).unwrap();
                    let mut positions: Vec<_> = (0..window.len()).map(|i| window.observed(i).to_vec()).collect();
                    if last >= 25 {
                        qualities[i].unseen = (OBSERVED as i64 - 1 - (last - 25)).max(0) as usize;
                        positions[i].iter_mut().for_each(|position| position[0] = 50.0);
                        ids[i] = PedestrianId(id);
                    }
                    let window = Window::new("yard", last - 7, 1, ids, positions).unwrap();
                    (window.with_qualities(qualities), forecast)
                });
            adapted(&mut AdaptiveRegions::default(), &stream.collect::<Vec<_>>())
        });
        assert_eq!(old, new);
    }

    #[test]
    fn the_first_frames_have_the_table_as_it_is_and_forecasts_without_regions_pass() {
        let tracks = (0..30).map(|t| vec![[0.3 * f64::from(t), 1.0]; PEOPLE]).collect();
        let stream = forecasts(&tracks, ORDER);
        let mut regions = AdaptiveRegions::default();
        let bare = Forecast::with_equal_weights(PEOPLE, 1, vec![[0.0; 2]; PEOPLE * HORIZON]).unwrap();
        assert_eq!(regions.adapt(&stream[0].0, bare.clone()), bare);
        assert_eq!(regions.table(), None);
        let (window, forecast) = &stream[0];
        assert_eq!(&regions.adapt(window, forecast.clone()), forecast);
        // An earlier time is a restart, and so not an outcome.
        let table = regions.table().cloned();
        let _ = regions.adapt(window, forecast.clone());
        assert_eq!(regions.table().cloned(), table);
        let _ = regions.adapt(&stream[1].0, stream[1].1.clone());
        assert_ne!(regions.table().cloned(), table);
        // After 4.8 s a forecast is no longer pending.
        assert!(regions.pending.len() <= HORIZON);
    }
}
