//! From the hypotheses of the pedestrians of a scene to K joint futures, each a mixture of hypotheses.

use crate::energy::Energy;
use crate::groups::{Company, link, linked};
use crate::hypotheses::Hypotheses;
use crate::keeping_apart::keep_apart;
use crate::pairs::{ObservedWalk, Pair, pairs_of};
use crate::parts::{ScenePart, SceneParts};
use crate::plan::Plan;
use crate::{quantisation, sampling};
use ddl_core::{FRAME_LIMIT, Forecast, HORIZON, PedestrianName, Spread, TIME_STEP, Window};

/// Samples of a scene.
const SAMPLES: usize = 320;

/// K joint futures of N pedestrians with H hypotheses: in future k pedestrian i follows a mixture of its hypotheses.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMixture {
    /// `[K]`; they sum to 1.
    pub weights: Vec<f64>,
    /// `[N][K][H]`: shares of the hypotheses; they sum to 1 for each pedestrian and future.
    pub shares: Vec<f32>,
}

impl JointMixture {
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

    /// The hypothesis with the largest share in one future, as `i * K + h`; `pair` = `i * K + k`.
    pub fn largest(&self, pair: usize) -> usize {
        let hypotheses = self.weights.len();
        let shares = &self.shares[pair * hypotheses..][..hypotheses];
        let largest = (0..hypotheses).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap_or(0);
        pair / hypotheses * hypotheses + largest
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
}

/// The number of a pedestrian, or its word: the number that stands for a word depends on who came before.
fn name(window: &Window, i: usize) -> PedestrianName {
    let id = window.pedestrians()[i];
    if id.0 < FRAME_LIMIT { id.into() } else { window.name(i) }
}

/// The pedestrians of a scene with samples of what they do, and who follows the plan after them. Their order depends on
/// what they may do, and not on their names.
#[derive(Debug)]
pub struct JointScene<'a> {
    forecast: &'a Forecast,
    people: Vec<Hypotheses>,
    pairs: Vec<Pair>,
    /// Index in the window of each pedestrian.
    order: Vec<usize>,
    /// Pedestrians who may influence each other.
    parts: Vec<Vec<usize>>,
    company: Company,
    /// The hypothesis of each pedestrian in each sample, `[N][S]`; those of one part have nothing to do with those of
    /// another.
    chosen: Vec<Vec<u8>>,
}

impl<'a> JointScene<'a> {
    /// The most hypotheses of a pedestrian.
    pub const MOST_HYPOTHESES: usize = 255;

    /// The scene of this window. Who follows the plan, if there is one, is somebody else, or the pedestrian `ego` of
    /// the window; the others react to it.
    ///
    /// # Panics
    /// When the forecast has another number of pedestrians than the window, or more than 255 hypotheses.
    pub fn of(window: &Window, forecast: &'a Forecast, plan: Option<&Plan>, ego: Option<usize>) -> Self {
        let fits = window.len() == forecast.pedestrians() && forecast.hypotheses() <= Self::MOST_HYPOTHESES;
        assert!(fits, "a forecast of this window");
        let all: Vec<Hypotheses> = (0..window.len()).map(|i| Hypotheses::of(window, forecast, i)).collect();
        let mut order: Vec<usize> = (0..window.len()).collect();
        order.sort_by(|&i, &j| all[i].compare(&all[j]).then_with(|| name(window, i).cmp(&name(window, j))));
        let mut people: Vec<Hypotheses> = order.iter().map(|&i| all[i].clone()).collect();
        let company = Company::of(window);
        let walk = |&i: &usize| ObservedWalk { track: window.observed(i), crowding: company.crowding[i] };
        let known = |i: &usize| (!window.quality(*i).is_hardly_observed()).then(|| walk(i));
        let mut walks: Vec<Option<ObservedWalk<'_>>> = order.iter().map(known).collect();
        if let Some(plan) = plan {
            let path = std::array::from_fn(|t| plan.at(TIME_STEP * (t + 1) as f64).position);
            let radius = plan.largest_radius();
            if let Some(ego) = ego.and_then(|ego| order.iter().position(|&i| i == ego)) {
                people[ego] = Hypotheses::certain(people[ego].present, &path, radius);
            } else {
                people.push(Hypotheses::certain(plan.at(0.0).position, &path, radius));
                walks.push(None);
            }
        }
        let pairs = pairs_of(Energy::learned(), &people, &walks);
        let parts = parts(&people, &pairs);
        let mut ranks = vec![0; people.len()];
        for (rank, &i) in parts.iter().flat_map(|part| part.iter().enumerate()) {
            ranks[i] = rank as u64;
        }
        let chosen = sampling::samples(&people, &pairs, &ranks, SAMPLES);
        Self { forecast, people, pairs, order, parts, company, chosen }
    }

    /// The parts of the scene, with the pedestrians as the window counts them.
    pub fn parts(&self) -> SceneParts {
        let in_window = self.parts.iter().filter(|part| part[0] < self.order.len());
        let is_certain = |i: usize| self.people[i].count() == 1;
        let given: Vec<&Pair> = self.pairs.iter().filter(|p| is_certain(p.first) || is_certain(p.second)).collect();
        let mut parts: Vec<ScenePart> = in_window.map(|part| self.part(part, &given)).collect();
        parts.sort_unstable_by_key(|part| part.pedestrians[0]);
        SceneParts { parts, company: self.company.clone() }
    }

    fn part(&self, members: &[usize], given: &[&Pair]) -> ScenePart {
        if let &[alone] = members {
            return ScenePart::alone(self.order[alone], self.weights_alone(alone, given));
        }
        let mut members = members.to_vec();
        members.sort_unstable_by_key(|&i| self.order[i]);
        ScenePart {
            pedestrians: members.iter().map(|&i| self.order[i]).collect(),
            weights: vec![1.0 / SAMPLES as f64; SAMPLES],
            chosen: members.iter().map(|&i| self.chosen[i].clone()).collect(),
        }
    }

    /// The weights of a pedestrian whom nobody influences but those whose paths are given.
    fn weights_alone(&self, i: usize, given: &[&Pair]) -> Vec<f64> {
        let one = &self.people[i];
        if one.count() == 1 {
            return vec![1.0];
        }
        let mut weights: Vec<f64> = (0..one.count()).map(|k| self.forecast.weight(self.order[i], k)).collect();
        let mut with = given.iter().filter(|pair| pair.first == i || pair.second == i).peekable();
        if with.peek().is_none() {
            return weights;
        }
        for factors in with.map(|pair| pair.factors(pair.first == i, 0, one.count())) {
            for (weight, factor) in weights.iter_mut().zip(factors) {
                *weight *= f64::from(*factor);
            }
        }
        let total: f64 = weights.iter().sum();
        weights.into_iter().map(|weight| weight / total).collect()
    }

    /// As many futures of the whole scene as a pedestrian has hypotheses, from the samples of its parts. Those of one
    /// pedestrian are its hypotheses.
    pub fn mixture(&self) -> JointMixture {
        let hypotheses = self.forecast.hypotheses();
        if self.people.len() == 1 {
            let same = |k: usize| (0..hypotheses).map(move |h| if h == k { 1.0 } else { 0.0 });
            let weights = (0..hypotheses).map(|k| self.forecast.weight(0, k)).collect();
            return JointMixture { weights, shares: (0..hypotheses).flat_map(same).collect() };
        }
        let chosen = self.together();
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
        // In the order of the window, without who follows the plan.
        let mut in_window = vec![0.0; self.order.len() * row];
        for (&i, shares) in self.order.iter().zip(shares.chunks_exact(row)) {
            in_window[i * row..][..row].copy_from_slice(shares);
        }
        let weights = sizes.iter().map(|size| f64::from(*size) / SAMPLES as f64).collect();
        JointMixture { weights, shares: in_window }
    }

    /// Samples of the whole scene: those of each part, in an order that is independent of the others.
    fn together(&self) -> Vec<Vec<u8>> {
        let mut chosen = self.chosen.clone();
        for (index, part) in self.parts.iter().enumerate().skip(1) {
            let order = sampling::shuffled(&mut sampling::random(index as u64, 2), SAMPLES);
            for &i in part {
                chosen[i] = order.iter().map(|&s| self.chosen[i][s]).collect();
            }
        }
        chosen
    }
}

/// What pairs connect, each in ascending order. Whose path is certain connects nobody.
fn parts(people: &[Hypotheses], pairs: &[Pair]) -> Vec<Vec<usize>> {
    let mut links: Vec<usize> = (0..people.len()).collect();
    for pair in pairs.iter().filter(|pair| [pair.first, pair.second].iter().all(|&i| people[i].count() > 1)) {
        link(&mut links, pair.first, pair.second);
    }
    linked(&mut links).into_values().collect()
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
