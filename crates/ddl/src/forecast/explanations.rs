//! Forecasts of pedestrians whose last row may be wrong: hypotheses of both explanations.

use crate::forecast::certified::Walked;
use ddl_core::{HORIZON, Position, Spread, Window, distance};
use std::borrow::Cow;

/// Largest share of the hypotheses that the less likely explanation has. Its weight, which is on the safe side, may be
/// larger: fewer of the likelier one would cost more error than hypotheses of a row that is seldom wrong gain.
const OTHER_SHARE: f64 = 0.15;

/// The windows of the likelier explanations and, if they are asked for, those of the others of each window that
/// [has some](Window::has_others), in order.
pub(crate) fn apart(windows: &[Window], with_others: bool) -> Cow<'_, [Window]> {
    if !windows.iter().any(Window::has_others) {
        return Cow::Borrowed(windows);
    }
    let (mut apart, mut others) = (Vec::with_capacity(windows.len()), Vec::new());
    for window in windows {
        let [likelier, other] = window.explanations();
        apart.push(likelier);
        others.extend((with_others && window.has_others()).then_some(other));
    }
    apart.append(&mut others);
    Cow::Owned(apart)
}

/// The walks of these windows, from those of their explanations [apart](apart).
pub(crate) fn together<'a>(windows: &'a [Window], mut walked: Vec<Walked<'a>>) -> impl Iterator<Item = Walked<'a>> {
    let mut others = walked.split_off(windows.len()).into_iter();
    windows.iter().zip(walked).map(move |(window, likelier)| {
        let other = if window.has_others() { others.next() } else { None };
        match other {
            Some(other) => both(window, &likelier, &other),
            None => likelier,
        }
    })
}

/// Each hypothesis starts where its explanation ends.
fn both<'a>(window: &'a Window, likelier: &Walked<'a>, other: &Walked<'a>) -> Walked<'a> {
    let mut pairs = Vec::with_capacity(likelier.goals.len());
    for i in 0..window.len() {
        let of = |walked: &Walked<'_>, least: usize, weight: f64| {
            let own = i * walked.hypotheses..(i + 1) * walked.hypotheses;
            let kept = thinned(&walked.goals[own.clone()], &walked.weights[own.clone()], least);
            kept.into_iter().map(move |(k, share)| (own.start + k, share * weight)).collect::<Vec<_>>()
        };
        let weight = window.other(i).map_or(0.0, |other| other.weight);
        let share = weight.min(OTHER_SHARE);
        let added = of(other, (share * likelier.hypotheses as f64).round() as usize, weight);
        let kept = of(likelier, likelier.hypotheses - added.len(), 1.0 - weight);
        let first = pairs.len();
        pairs.extend(kept.into_iter().map(|(pair, weight)| (likelier, None, pair, weight)));
        let origin = Some((other.start(i), other.bounds(i)));
        pairs.extend(added.into_iter().map(|(pair, weight)| (other, origin, pair, weight)));
        // The likeliest comes first, as everywhere.
        pairs[first..].sort_by(|a, b| b.3.total_cmp(&a.3));
    }
    let steps = |pair: usize| pair * HORIZON..(pair + 1) * HORIZON;
    let paths = pairs.iter().filter_map(|(walked, _, pair, _)| walked.rolled_out.get(steps(*pair)));
    let factors = pairs.iter().map(|(walked, _, pair, _)| Some(&walked.factors.as_ref()?[steps(*pair)]));
    Walked {
        window,
        spread: heavier(window, likelier, other),
        rolled_out: paths.flatten().copied().collect(),
        factors: factors.collect::<Option<Vec<_>>>().map(|factors| factors.concat()),
        goals: pairs.iter().map(|(walked, _, pair, _)| walked.goals[*pair]).collect(),
        origins: pairs.iter().map(|(_, origin, ..)| *origin).collect(),
        weights: pairs.iter().map(|(.., weight)| *weight).collect(),
        config: likelier.config,
        rule: likelier.rule,
        hypotheses: likelier.hypotheses,
        shares: likelier.shares.clone(),
        familiarity: likelier.familiarity.clone(),
    }
}

/// The spread of the explanation of each pedestrian that weighs more.
fn heavier(window: &Window, likelier: &Walked<'_>, other: &Walked<'_>) -> Option<Spread> {
    let (mut spread, other) = likelier.calibrated().zip(other.calibrated())?;
    for i in (0..window.len()).filter(|&i| window.other(i).is_some_and(|other| other.weight > 0.5)) {
        let steps = i * HORIZON..(i + 1) * HORIZON;
        spread.scales[steps.clone()].copy_from_slice(&other.scales[steps]);
        spread.paces[i] = other.paces[i];
    }
    Some(spread)
}

/// So many of these hypotheses, ascending, with their weights: again and again the one whose move to the nearest other
/// costs least gives its weight to that.
fn thinned(goals: &[Position], weights: &[f64], count: usize) -> Vec<(usize, f64)> {
    let mut kept: Vec<(usize, f64)> = weights.iter().copied().enumerate().collect();
    kept.truncate(if count == 0 { 0 } else { kept.len() });
    while kept.len() > count {
        let pairs = (0..kept.len()).flat_map(|a| (0..kept.len()).map(move |b| (a, b))).filter(|(a, b)| a != b);
        let cost = |&(a, b): &(usize, usize)| kept[a].1 * distance(goals[kept[a].0], goals[kept[b].0]).powi(2);
        let Some((least, nearest)) = pairs.min_by(|a, b| cost(a).total_cmp(&cost(b))) else { break };
        kept[nearest].1 += kept[least].1;
        kept.remove(least);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::watched_scene::tests::model;
    use crate::{Ddl, Request};
    use ddl_core::{OBSERVED, ObservationQuality, OtherObservation, PedestrianId};
    use ddl_data::{Clock, Completeness, LiveTracks};
    use ddl_scene::{Plan, PlanPoint};
    use proptest::prelude::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use std::sync::LazyLock;

    static MODEL: LazyLock<Ddl> = LazyLock::new(model);

    /// The risk of a plan towards somebody, at a row and at the next, where the row is so far off.
    fn risks(rate: f64, speed: f64, noise: f64, off: Position, seed: u64) -> [f64; 2] {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // Twelve uniform numbers have the variance 1.
        let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let mut tracks = LiveTracks::with_clock(Clock::with_frame_time(1.0 / rate).unwrap())
            .with_completeness(Completeness::Partial);
        let last = (4.0 * rate) as i64;
        for frame in 0..last {
            let place = [-speed * frame as f64 / rate + noise * normal(), noise * normal()];
            tracks.push(frame, [(PedestrianId(1), place)]).unwrap();
        }
        [(last, off), (last + 1, [0.0; 2])].map(|(frame, [dx, dy])| {
            let x = -speed * frame as f64 / rate;
            let place = [x + dx + noise * normal(), dy + noise * normal()];
            let window = tracks.push(frame, [(PedestrianId(1), place)]).unwrap().unwrap();
            let point = |time: f64, x: f64| PlanPoint { time, position: [x, 0.0], radius: 0.0 };
            let from = x - 2.0 - speed;
            let plan = Plan::new(vec![point(0.0, from), point(4.8, from + 4.0)]).unwrap();
            let answers = MODEL.forecast(&[window], &Request::joint()).unwrap();
            answers[0].futures().unwrap().risks(&[plan], 0.5, None).unwrap()[0].total
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// One wrong row takes at most a third of the risk away, and the next row gives it back.
        #[test]
        fn one_wrong_row_leaves_two_thirds_of_the_risk(
            rate in prop::sample::select(vec![2.5, 5.0, 10.0, 25.0, 30.0]),
            speed in prop::sample::select(vec![0.0, 0.5, 1.2]),
            noise in prop::sample::select(vec![0.0, 0.01]),
            (off, angle) in (0.1..2.0_f64, 0.0..6.3_f64),
            seed: u64,
        ) {
            let right = risks(rate, speed, noise, [0.0; 2], seed);
            let wrong = risks(rate, speed, noise, [off * angle.cos(), off * angle.sin()], seed);
            prop_assert!(wrong[0] > 0.63 * right[0] && wrong[1] > 0.8 * right[1], "{right:?} {wrong:?}");
        }
    }

    /// With noise of 3 and 6 cm, over all directions.
    #[test]
    fn one_wrong_row_among_noisy_rows_leaves_two_thirds_of_the_risk_on_the_mean() {
        for (rate, speed, noise) in [(2.5, 1.2, 0.03), (2.5, 0.0, 0.06), (10.0, 0.0, 0.03), (25.0, 1.2, 0.06)] {
            for off in [0.2, 0.5, 1.0] {
                let of_direction = |k: u64| {
                    let (sin, cos) = (0.785 * k as f64).sin_cos();
                    let right = risks(rate, speed, noise, [0.0; 2], k);
                    let wrong = risks(rate, speed, noise, [off * cos, off * sin], k);
                    [wrong[0] / right[0], wrong[1] / right[1]]
                };
                let shares: Vec<[f64; 2]> = (0..8).map(of_direction).collect();
                let mean = [0, 1].map(|row| shares.iter().map(|share| share[row]).sum::<f64>() / 8.0);
                assert!(mean[0] > 0.7 && mean[1] > 0.85, "{rate} {speed} {noise} {off}: {shares:?}");
            }
        }
    }

    /// Each explanation has its share of the hypotheses and its weight, and every path begins where its explanation
    /// ends; certificates hold. Who has one explanation is forecast as alone.
    #[test]
    fn both_explanations_have_hypotheses_with_certificates() {
        let track = |x: f64| (0..OBSERVED).map(|t| [x, 0.4 * t as f64]).collect::<Vec<Position>>();
        let ids = vec![PedestrianId(1), PedestrianId(2)];
        let plain = Window::new("yard", 0, 1, ids, vec![track(0.0), track(30.0)]).unwrap();
        let mut positions = std::array::from_fn(|t| track(0.0)[t]);
        positions[OBSERVED - 1][0] += 3.0;
        let other = OtherObservation { positions, quality: ObservationQuality::default(), weight: 0.75 };
        let window = plain.clone().with_others(vec![(0, other)]);
        let [likelier, elsewhere] = window.explanations();
        let ask = |window: Window, request: &Request| MODEL.forecast(&[window], request).unwrap().remove(0);
        let request = Request::default().with_certificates();
        let answer = ask(window.clone(), &request);
        assert_eq!(answer.first_violation(), None);
        let (both, alone) = (answer.forecast(), ask(plain.clone(), &request).into_forecast());
        assert_eq!(both.hypotheses(), alone.hypotheses());
        for k in 0..alone.hypotheses() {
            assert_eq!(both.hypothesis(1, k), alone.hypothesis(1, k));
        }
        let weight = |is_other: bool| -> f64 {
            let of_other = |k: &usize| (both.hypothesis(0, *k)[0][0] > 1.5) == is_other;
            (0..both.hypotheses()).filter(of_other).map(|k| both.weight(0, k)).sum()
        };
        assert!((weight(true) - 0.75).abs() < 1e-9 && (weight(false) - 0.25).abs() < 1e-9);
        // One path is that of the likelier explanation; the spread is that of the heavier.
        let one = |window: Window| ask(window, &Request::one()).into_forecast().hypothesis(0, 0).to_vec();
        assert_eq!(one(window), one(likelier));
        let heavier = ask(elsewhere, &request).into_forecast();
        assert_eq!((both.scale(0, 5), both.scale(1, 5)), (heavier.scale(0, 5), alone.scale(1, 5)));
    }

    /// By hand: the middle one of three costs least, and goes to the nearer neighbour.
    #[test]
    fn the_cheapest_hypothesis_gives_its_weight_to_the_nearest() {
        let goals = [[0.0, 0.0], [1.0, 0.0], [4.0, 0.0]];
        assert_eq!(thinned(&goals, &[0.5, 0.2, 0.3], 2), [(0, 0.7), (2, 0.3)]);
        assert_eq!(thinned(&goals, &[0.5, 0.2, 0.3], 0), []);
        assert_eq!(thinned(&goals, &[0.5, 0.2, 0.3], 3).len(), 3);
    }
}
