//! Forecasts of pedestrians whose last row may be wrong: hypotheses of both explanations.

use crate::forecast::certified::Walked;
use ddl_core::{HORIZON, Position, Spread, Window, distance};
use std::borrow::Cow;

/// Largest share of the hypotheses that the less likely explanation has, whatever its weight.
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
            Some(other) => both(window, likelier, &other),
            None => likelier,
        }
    })
}

/// Each hypothesis starts where its explanation ends.
fn both<'a>(window: &'a Window, likelier: Walked<'a>, other: &Walked<'a>) -> Walked<'a> {
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
        let kept = of(&likelier, likelier.hypotheses - added.len(), 1.0 - weight);
        pairs.extend(kept.into_iter().map(|(pair, weight)| (&likelier, None, pair, weight)));
        let origin = Some((other.start(i), other.bounds(i)));
        pairs.extend(added.into_iter().map(|(pair, weight)| (other, origin, pair, weight)));
    }
    let steps = |pair: usize| pair * HORIZON..(pair + 1) * HORIZON;
    let paths = pairs.iter().filter_map(|(walked, _, pair, _)| walked.rolled_out.get(steps(*pair)));
    let factors = pairs.iter().map(|(walked, _, pair, _)| Some(&walked.factors.as_ref()?[steps(*pair)]));
    Walked {
        window,
        spread: heavier(window, &likelier, other),
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
