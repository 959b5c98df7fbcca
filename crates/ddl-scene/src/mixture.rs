//! From the hypotheses of the pedestrians of a scene to K joint futures, each a mixture of hypotheses.

use crate::energy::Energy;
use crate::hypotheses::Hypotheses;
use crate::keeping_apart::keep_apart;
use crate::pairs::{Pair, pairs_of};
use crate::plan::Plan;
use crate::{quantisation, sampling};
use ddl_core::{FRAME_LIMIT, Forecast, HORIZON, PedestrianName, Position, Spread, TIME_STEP, Window};

/// Samples of a scene.
const SAMPLES: usize = 300;

/// K joint futures of N pedestrians with H hypotheses: in future k pedestrian i follows a mixture of its hypotheses.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMixture {
    /// `[K]`; they sum to 1.
    pub weights: Vec<f64>,
    /// `[N][K][H]`: shares of the hypotheses; they sum to 1 for each pedestrian and future.
    pub shares: Vec<f32>,
}

impl JointMixture {
    /// The most hypotheses of a pedestrian.
    pub const MOST_HYPOTHESES: usize = 255;

    /// As many joint futures of this window as its forecast has hypotheses. Who follows the plan, if there is one, is
    /// somebody else, or the pedestrian `ego` of the window; the others react to it.
    ///
    /// # Panics
    /// When the forecast has another number of pedestrians than the window, or more than 255 hypotheses.
    pub fn of(window: &Window, forecast: &Forecast, plan: Option<&Plan>, ego: Option<usize>) -> Self {
        let hypotheses = forecast.hypotheses();
        assert!(
            window.len() == forecast.pedestrians() && hypotheses <= Self::MOST_HYPOTHESES,
            "a forecast of this window"
        );
        let scene = MixtureScene::new(window, forecast, plan, ego);
        if scene.people.len() == 1 {
            return Self::alone(forecast);
        }
        let mut mixture = scene.mixture(hypotheses);
        scene.in_order_of_window(&mut mixture, hypotheses);
        mixture
    }

    /// The mean of the values `[i][h]` of the hypotheses of a pedestrian in one future; `pair` = `i * K + k`. Exactly
    /// the value of a hypothesis where the future is one.
    pub fn mean<const D: usize>(&self, pair: usize, value: impl Fn(usize, usize) -> [f64; D]) -> [f64; D] {
        let hypotheses = self.weights.len();
        let shares = &self.shares[pair * hypotheses..][..hypotheses];
        let (mut mean, mut total) = ([0.0; D], 0.0);
        for (h, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let value = value(pair / hypotheses, h);
            total += f64::from(share);
            for (mean, value) in mean.iter_mut().zip(value) {
                *mean += f64::from(share) * value;
            }
        }
        // The shares are in `f32`: their sum is 1 to seven digits only.
        mean.map(|sum| sum / total)
    }

    /// The scales `[N][12]` (m) of the Student's t around the paths of the futures, from those around the hypotheses:
    /// the squared distance of the hypotheses from their mixture is added to the variance. `None` without a spread.
    pub fn scales(&self, forecast: &Forecast) -> Option<Vec<f64>> {
        let hypotheses = self.weights.len();
        let mut scales = Vec::with_capacity(forecast.pedestrians() * HORIZON);
        for i in 0..forecast.pedestrians() {
            for t in 0..HORIZON {
                let mut within = 0.0;
                for (k, weight) in self.weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                    let pair = i * hypotheses + k;
                    let [x, y] = self.mean(pair, |i, h| forecast.hypothesis(i, h)[t]);
                    let [square] = self.mean(pair, |i, h| {
                        let [dx, dy] = [0, 1].map(|axis| forecast.hypothesis(i, h)[t][axis] - [x, y][axis]);
                        [dx * dx + dy * dy]
                    });
                    within += weight * square;
                }
                // On each axis the variance of the Student's t is 3 s², and half of the squared distance.
                let scale = forecast.scale(i, t)?;
                scales.push((scale * scale + within / (2.0 * Spread::DEGREES)).sqrt());
            }
        }
        Some(scales)
    }

    /// The futures of one pedestrian are its hypotheses.
    fn alone(forecast: &Forecast) -> Self {
        let count = forecast.hypotheses();
        let same = |k: usize| (0..count).map(move |h| if h == k { 1.0 } else { 0.0 });
        Self {
            weights: (0..count).map(|k| forecast.weight(0, k)).collect(),
            shares: (0..count).flat_map(same).collect(),
        }
    }
}

/// The number of a pedestrian, or its word: the number that stands for a word depends on who came before.
fn name(window: &Window, i: usize) -> PedestrianName {
    let id = window.pedestrians()[i];
    if id.0 < FRAME_LIMIT { id.into() } else { window.name(i) }
}

/// The number, or the FNV-1a hash of the word.
fn seed(name: &PedestrianName) -> u64 {
    match name {
        PedestrianName::Number(number) => number.cast_unsigned(),
        PedestrianName::Word(word) => word
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)),
    }
}

/// The pedestrians in the order of their names, which does not depend on the order of the window, and then who follows
/// the plan.
struct MixtureScene {
    people: Vec<Hypotheses>,
    seeds: Vec<u64>,
    pairs: Vec<Pair>,
    /// Index in the window of each pedestrian.
    order: Vec<usize>,
}

impl MixtureScene {
    fn new(window: &Window, forecast: &Forecast, plan: Option<&Plan>, ego: Option<usize>) -> Self {
        let names: Vec<PedestrianName> = (0..window.len()).map(|i| name(window, i)).collect();
        let mut order: Vec<usize> = (0..window.len()).collect();
        order.sort_unstable_by(|&i, &j| names[i].cmp(&names[j]));
        let mut people: Vec<Hypotheses> = order.iter().map(|&i| Hypotheses::of(window, forecast, i)).collect();
        let mut seeds: Vec<u64> = order.iter().map(|&i| seed(&names[i])).collect();
        let track = |&i: &usize| (!window.quality(i).is_hardly_observed()).then(|| window.observed(i));
        let mut tracks: Vec<Option<&[Position]>> = order.iter().map(track).collect();
        if let Some(plan) = plan {
            let path = std::array::from_fn(|t| plan.at(TIME_STEP * (t + 1) as f64).position);
            let radius = plan.points().iter().map(|point| point.radius).fold(0.0, f64::max);
            if let Some(ego) = ego.and_then(|ego| order.iter().position(|&i| i == ego)) {
                people[ego] = Hypotheses::certain(people[ego].present, &path, radius);
            } else {
                people.push(Hypotheses::certain(plan.at(0.0).position, &path, radius));
                seeds.push(0);
                tracks.push(None);
            }
        }
        let pairs = pairs_of(Energy::learned(), &people, &tracks);
        Self { people, seeds, pairs, order }
    }

    /// The futures, with the pedestrians in the order of the scene.
    fn mixture(&self, hypotheses: usize) -> JointMixture {
        let chosen = sampling::samples(&self.people, &self.pairs, &self.seeds, SAMPLES);
        let (labels, sizes) = by_size(quantisation::clusters(&self.people, &chosen, hypotheses), hypotheses);
        let row = hypotheses * hypotheses;
        let mut shares = vec![0.0; self.people.len() * row];
        for (shares, chosen) in shares.chunks_exact_mut(row).zip(&chosen) {
            for (&label, &hypothesis) in labels.iter().zip(chosen) {
                shares[label * hypotheses + usize::from(hypothesis)] += 1.0 / sizes[label] as f32;
            }
            // There are fewer different samples than futures. The futures that are left get the weight 0, and every
            // pedestrian follows its hypothesis k in them.
            for k in (0..hypotheses).filter(|&k| sizes[k] == 0) {
                shares[k * hypotheses + k] = 1.0;
            }
        }
        for k in (0..hypotheses).filter(|&k| sizes[k] > 0) {
            let future = shares.chunks_exact_mut(row).map(|of_each| &mut of_each[k * hypotheses..][..hypotheses]);
            keep_apart(&self.people, &self.pairs, &mut future.collect::<Vec<_>>());
        }
        JointMixture { weights: sizes.iter().map(|size| f64::from(*size) / SAMPLES as f64).collect(), shares }
    }

    /// The pedestrians of the mixture in the order of the window, without who follows the plan.
    fn in_order_of_window(&self, mixture: &mut JointMixture, hypotheses: usize) {
        let row = hypotheses * hypotheses;
        let mut shares = vec![0.0; self.order.len() * row];
        for (rank, &i) in self.order.iter().enumerate() {
            shares[i * row..][..row].copy_from_slice(&mixture.shares[rank * row..][..row]);
        }
        mixture.shares = shares;
    }
}

/// The clusters of the samples with numbers in the order of their sizes, largest first, and these sizes.
fn by_size(labels: Vec<usize>, clusters: usize) -> (Vec<usize>, Vec<u32>) {
    let mut sizes = vec![0_u32; clusters];
    for &label in &labels {
        sizes[label] += 1;
    }
    let mut order: Vec<usize> = (0..clusters).collect();
    order.sort_by_key(|&label| std::cmp::Reverse(sizes[label]));
    let rank = |label: usize| order.iter().position(|&other| other == label).unwrap_or(label);
    let ranks: Vec<usize> = (0..clusters).map(rank).collect();
    let labels = labels.into_iter().map(|label| ranks[label]).collect();
    (labels, order.iter().map(|&label| sizes[label]).collect())
}

#[cfg(test)]
mod tests;
