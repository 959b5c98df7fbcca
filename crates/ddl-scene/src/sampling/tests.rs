use super::*;
use crate::fixture::walk;
use crate::fixture::{FixturePedestrian, energy, hypotheses, pedestrians, scene};
use crate::pairs::pairs_of;
use ddl_core::distance;

/// Three walk side by side, a fourth 3.7 m behind the third; one comes towards them, one is far away.
const PEOPLE: &str = "
0    0   0.9 0.3   0.5  0.9  0.3   0.3  0.6 0.7   0.2   1.2 -0.1
0.3  0.8 0.9 0.3   0.25 1.0  0.2   0.45 0.8 0.5   0.3   0.3 -0.2
-0.5 0.6 0.9 0.3   0.1  0.7 -0.3   0.3  1.1 0.3   0.6   0.8  0.1
-4.2 0.6 0.9 0.3   0.35 0.2  0.4   0.25 1.2 0.3   0.4   0.8 -0.6
4    1.7  -1 0.1   0.6 -1.0  0.1   0.15 -0.2 0.4  0.25 -0.9 -0.3
60   -20 0.9 0.3   0.7  0.9  0.3   0.2  0   0     0.1  -1    1
";
const N: usize = 6;

/// The energy by its definition: straight paths, looked at every 0.2 s; the strengths and conflicts are those of the
/// fixture. The first two have two partners each, the third has three.
fn pair_energy(pedestrians: &[FixturePedestrian], [(i, h), (j, g)]: [(usize, usize); 2]) -> f64 {
    let (a, b) = (&pedestrians[i], &pedestrians[j]);
    let at = |(start, _, all): &FixturePedestrian, h: usize, time: f64| {
        [0, 1].map(|axis| start[axis] + time * all[h].1[axis])
    };
    let gap = |time: f64| distance(at(a, h, time), at(b, g, time));
    let least = (1..=24).map(|t| gap(0.2 * f64::from(t))).fold(f64::INFINITY, f64::min);
    let strength = match (i.min(j), i.max(j)) {
        (0, 1) => 0.9 / 2.0_f64.sqrt(),
        (0 | 1, 2) => 0.9 / 3.0_f64.sqrt(),
        (2, 3) => 0.3 / 3.0_f64.sqrt(),
        _ => 0.0,
    };
    let knots = if strength > 0.0 { [3.1, 1.5, 0.7, 0.3, 0.5, 0.0] } else { [1.6, 0.8, 0.4, 0.2, 0.1, 0.0] };
    let place = (least / 0.2).min(4.999_999_9);
    let conflict = knots[place as usize] + place.fract() * (knots[place as usize + 1] - knots[place as usize]);
    let moved = |(_, _, all): &FixturePedestrian, h: usize| all[h].1.map(|speed| 4.8 * speed);
    let apart = distance(moved(a, h), moved(b, g)) / 0.5;
    conflict + strength * (1.0 + apart * apart / 3.0).ln()
}

/// The probability of each scene, which is a number with a digit for each pedestrian, last pedestrian first.
#[test]
fn scenes_are_as_likely_as_their_energies_say() {
    let digit = |scene: usize, i: usize| scene / 3_usize.pow(i as u32) % 3;
    let pedestrians = pedestrians(PEOPLE);
    let weight = |scene: usize, i: usize| pedestrians[i].2[digit(scene, i)].0;
    let energies = |scene: usize, i: usize| -> f64 {
        let others = (0..N).filter(|&j| j != i);
        others.map(|j| pair_energy(&pedestrians, [(i, digit(scene, i)), (j, digit(scene, j))])).sum()
    };
    let scenes = 3_usize.pow(N as u32);
    let independent: Vec<f64> = (0..scenes).map(|scene| (0..N).map(|i| weight(scene, i)).product()).collect();
    let energy_of = |scene: usize| 0.5 * (0..N).map(|i| energies(scene, i)).sum::<f64>();
    let odds: Vec<f64> = (0..scenes).map(|scene| independent[scene] * (-energy_of(scene)).exp()).collect();
    let total: f64 = odds.iter().sum();
    let wanted: Vec<f64> = odds.iter().map(|odds| odds / total).collect();
    // What one sweep gives: each pedestrian in turn is distributed as it should be given the others.
    let mut swept = independent.clone();
    for i in 0..N {
        let place = 3_usize.pow(i as u32);
        for base in (0..scenes).filter(|&scene| digit(scene, i) == 0) {
            let own = [0, 1, 2].map(|h| base + h * place);
            let given = own.map(|scene| weight(scene, i) * (-energies(scene, i)).exp());
            let others: f64 = own.iter().map(|&scene| swept[scene]).sum();
            for (scene, given_others) in own.into_iter().zip(given) {
                swept[scene] = others * given_others / given.iter().sum::<f64>();
            }
        }
    }

    let people = hypotheses(&pedestrians);
    let (window, _) = scene(&pedestrians);
    let walks: Vec<_> = (0..N).map(|i| Some(walk(&window, i))).collect();
    let pairs = pairs_of(&energy(), &people, &walks);
    let count = 400_000;
    let chosen = samples(&people, &pairs, &[3, 1, 4, 1_000, 5, 9], count);
    let mut found = vec![0.0; scenes];
    let number = |s: usize| -> usize { (0..N).map(|i| 3_usize.pow(i as u32) * usize::from(chosen[i][s])).sum() };
    for scene in (0..count).map(number) {
        found[scene] += 1.0 / count as f64;
    }
    let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / 2.0;
    let [exact, near, far] = [off(&found, &swept), off(&found, &wanted), off(&independent, &wanted)];
    assert!(exact < 0.02 && near < 0.1 && far > 0.4, "{exact} {near} {far}");
    // Far away: independent of the others, by its own weights.
    for h in 0..3 {
        for state in 0..243 {
            let rest: f64 = found[state..].iter().step_by(243).sum();
            let both = found[state + 243 * h];
            assert!((both - rest * pedestrians[N - 1].2[h].0).abs() < 0.003, "{both} of {rest}");
        }
    }
}

/// People are pairs if they walk together, up to 4 m apart, or if they or a radius reach from one to the other.
#[test]
fn who_walks_together_or_may_meet_is_a_pair() {
    // The first at `speeds[0]` towards the second, who goes aside or comes at `speeds[1]`.
    let count = |apart: f64, radius: f64, speeds: [f64; 2]| {
        let [x, y] = [2.0 + 0.6 * apart, -1.0 - 0.8 * apart];
        let [vx, vy, ux, uy] = [0.6 * speeds[0], -0.8 * speeds[0], 0.04 - 0.6 * speeds[1], 0.03 + 0.8 * speeds[1]];
        let pedestrians = pedestrians(&format!("2 -1 0 0  1 {vx} {vy}\n{x} {y} 0 0  1 {ux} {uy}"));
        let (window, _) = scene(&pedestrians);
        let mut people = hypotheses(&pedestrians);
        people[1].radius = radius;
        let walks = [0, 1].map(|i| (i == 0 || radius == 0.0).then(|| walk(&window, i)));
        pairs_of(&energy(), &people, &walks).len()
    };
    assert_eq!([count(3.9, 0.0, [0.0; 2]), count(4.1, 0.0, [0.0; 2])], [1, 0]);
    assert_eq!([count(9.0, 8.1, [0.0; 2]), count(9.0, 7.9, [0.0; 2])], [1, 0]);
    // 0.24 m and 3.84 m in 4.8 s: at last 0.4 m apart, or 1.1 m.
    assert_eq!([count(4.5, 0.0, [0.05, 0.8]), count(5.2, 0.0, [0.05, 0.8])], [1, 0]);
}

#[test]
fn draws_by_hand() {
    let draws = [0.0, 0.2, 0.26, 0.7, 0.999_999].map(|share| draw(&[0.5, 0.0, 1.0, 0.5, 0.0], share));
    assert_eq!(draws, [0, 0, 2, 2, 3]);
    // Rounding may leave something after the last: it falls to the last that is possible.
    assert_eq!([draw(&[1.0, 2.0, 0.0], 1.0), draw(&[0.0, 0.0], 0.5)], [1, 0]);
}
