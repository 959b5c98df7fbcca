//! Laws of joint futures.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_core::{
    FRAME_LIMIT, Forecast, HORIZON, Pace, PedestrianId, PedestrianNames, Position, RegionTable, Spread, Window,
    between, distance,
};
use ddl_scene::{Area, Futures, JointMixture, JointScene, Plan, PlanPoint, groups};
use proptest::{collection::vec, prelude::*};

/// Directions of the hypotheses relative to the way on (radians), and their weights.
const TURNS: [f64; 5] = [0.0, 0.3, -0.3, 0.7, -0.7];
const WEIGHTS: [f64; 5] = [0.4, 0.2, 0.2, 0.1, 0.1];
const K: usize = TURNS.len();

/// Where a pedestrian is, its heading (radians) and its speed (m/s).
type Person = (Position, f64, f64);

/// The turns and weights of the hypotheses of a pedestrian, in an order that depends on its place, so that hypothesis k
/// of one has nothing to do with that of another.
fn hypotheses((at, ..): Person) -> [(f64, f64); K] {
    let mut both: [(f64, f64); K] = std::array::from_fn(|k| (TURNS[k], WEIGHTS[k]));
    both.rotate_left((13.01 * at[0] + 7.0 * at[1] + 1000.0) as usize % K);
    both
}

/// The hypothesis of a pedestrian that goes straight on.
fn straight(person: Person) -> usize {
    hypotheses(person).iter().position(|(turn, _)| *turn == 0.0).unwrap()
}

/// People who walked straight on, and a hypothesis for each turn; ids in the order of `ids`.
fn scene(people: &[Person], ids: &[i64]) -> (Window, Forecast) {
    let along = |[x, y]: Position, heading: f64, length: f64| [x + length * heading.cos(), y + length * heading.sin()];
    let past =
        |&(at, heading, speed): &Person| (0..8).map(|t| along(at, heading, 0.4 * speed * f64::from(t - 7))).collect();
    let ids = ids.iter().map(|&id| PedestrianId(id)).collect();
    let window = Window::new("yard", 0, 1, ids, people.iter().map(past).collect()).unwrap();
    let path = |(at, heading, speed): Person, turn: f64| {
        (1..=12).map(move |t| along(at, heading + turn, 0.4 * speed * f64::from(t)))
    };
    let paths = people.iter().flat_map(|&one| hypotheses(one).into_iter().flat_map(move |(turn, _)| path(one, turn)));
    let goals = people.iter().flat_map(|&one| hypotheses(one).map(|(turn, _)| path(one, turn).next_back().unwrap()));
    let forecast = Forecast::new(
        people.len(),
        K,
        paths.collect(),
        people.iter().flat_map(|&one| hypotheses(one).map(|(_, weight)| weight)).collect(),
        Some(goals.collect()),
    );
    (window, forecast.unwrap())
}

fn mixture(people: &[Person]) -> (Forecast, JointMixture) {
    let ids: Vec<i64> = (0..people.len() as i64).collect();
    let (window, forecast) = scene(people, &ids);
    let mixture = JointScene::of(&window, &forecast, None, None).mixture();
    (forecast, mixture)
}

/// The path of pedestrian `i` in future `k`.
fn path(forecast: &Forecast, mixture: &JointMixture, i: usize, k: usize) -> Vec<Position> {
    (0..HORIZON).map(|t| mixture.mean(i * K + k, |i, h| forecast.hypothesis(i, h)[t])).collect()
}

/// Probability of each hypothesis of pedestrian `i` over all futures.
fn marginal(mixture: &JointMixture, i: usize) -> Vec<f64> {
    let of_future = |k: usize, h: usize| mixture.weights[k] * f64::from(mixture.shares[(i * K + k) * K + h]);
    (0..K).map(|h| (0..K).map(|k| of_future(k, h)).sum()).collect()
}

/// The least distance of two paths at their steps and at four places between any two of them.
fn least(a: &[Position], b: &[Position]) -> f64 {
    let places = |path: &[Position]| -> Vec<Position> {
        let pairs = path.windows(2);
        pairs.flat_map(|pair| (0..=5).map(|part| between(pair[0], pair[1], f64::from(part) / 5.0))).collect()
    };
    places(a).into_iter().zip(places(b)).map(|(p, q)| distance(p, q)).fold(f64::INFINITY, f64::min)
}

/// The scene of these people with a spread that grows to 0.6 m.
fn futures(people: &[Person], ids: &[i64]) -> Futures {
    let (window, forecast) = scene(people, ids);
    let spread = Spread {
        scales: (0..people.len()).flat_map(|_| (1..=HORIZON).map(|t| 0.05 * t as f64)).collect(),
        paces: vec![Pace::Walking; people.len()],
        regions: RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]).unwrap().into(),
    };
    let forecast = forecast.with_spread(spread.clone()).unwrap();
    let scene = JointScene::of(&window, &forecast, None, None);
    let mixture = scene.mixture();
    let paths = (0..people.len() * K).flat_map(|pair| path(&forecast, &mixture, pair / K, pair % K)).collect();
    let drawn = Forecast::new(people.len(), K, paths, mixture.weights.repeat(people.len()), None).unwrap();
    let (parts, drawn) = (scene.parts(), drawn.with_spread(spread).unwrap());
    Futures::of_parts(&window, parts, forecast, Vec::new(), drawn, None).unwrap()
}

/// What planners ask about the first pedestrians of a scene: the risk of plans that pass there, with that of each of
/// these pedestrians, how near they are, and a grid of the place.
fn answers(futures: &Futures, first: usize) -> (Vec<Vec<f64>>, Vec<f32>) {
    let plan = |[x, y]: Position| {
        let row = |(time, position)| PlanPoint { time, position, radius: 0.3 };
        Plan::new([(0.0, [x, y]), (4.8, [-y, x])].map(row).to_vec()).unwrap()
    };
    let plans = [[3.0, 1.0], [-2.0, 4.0], [0.5, -1.0]].map(plan);
    let risks = [futures.risks(&plans, 0.5, None).unwrap(), futures.risks_if_seen(&plans, 0.5, None).unwrap()].concat();
    let numbers = risks.iter().map(|risk| [&risk.until[..], &risk.steps, &risk.pedestrians[..first]].concat());
    let clearances = futures.clearances(&plans).unwrap();
    let near = clearances.iter().map(|near| [&[near.nearest], &near.pedestrians[..first]].concat());
    let area = Area::new([-8.0; 2], [8.0; 2], 0.5).unwrap();
    let grids = futures.occupancy(&area, &[0.0, 2.0, 4.8], 0.2).unwrap();
    (numbers.chain(near).collect(), grids.flat_map(|grid| grid.probabilities).collect())
}

fn crowd() -> impl Strategy<Value = Vec<Person>> {
    let person = ([-6.0..6.0f64, -6.0..6.0f64], 0.0..6.2f64, 0.3..1.6f64);
    vec(person, 2..9)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Not a bit of any answer changes if others come, go or move beyond reach.
    #[test]
    fn who_is_out_of_reach_does_not_matter(
        people in crowd(), others in crowd(), away in 80.0..1e6f64, first in 0..9i64,
    ) {
        let ids = |count: usize, from: i64| (0..count as i64).map(move |i| 2 * i + from);
        let own: Vec<i64> = ids(people.len(), 1).collect();
        let alone = futures(&people, &own);
        let far = others.iter().map(|&([x, y], heading, speed)| ([x + away, y - 2.0 * away], heading, speed));
        let both: Vec<Person> = people.iter().copied().chain(far).collect();
        let all: Vec<i64> = own.iter().copied().chain(ids(others.len(), 2 * first)).collect();
        let together = futures(&both, &all);
        prop_assert_eq!(answers(&alone, people.len()), answers(&together, people.len()));
        prop_assert_eq!(alone.parts(), &together.parts()[..alone.parts().len()]);
    }

    /// Who has which name changes nothing.
    #[test]
    fn names_do_not_matter(people in crowd(), turn in 1..8usize) {
        let ids: Vec<i64> = (0..people.len() as i64).collect();
        let mut renamed = ids.clone();
        renamed.rotate_left(turn % people.len());
        let of = |ids: &[i64]| answers(&futures(&people, ids), people.len());
        prop_assert_eq!(of(&ids), of(&renamed));
    }

    #[test]
    fn weights_and_shares_are_probabilities(people in crowd()) {
        let (_, mixture) = mixture(&people);
        prop_assert!((mixture.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        prop_assert!(mixture.weights.is_sorted_by(|a, b| a >= b));
        for shares in mixture.shares.chunks_exact(K) {
            prop_assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-4 && shares.iter().all(|share| *share >= 0.0));
        }
    }

    #[test]
    fn the_order_of_pedestrians_does_not_matter(people in crowd(), turn in 1..8usize) {
        let ids: Vec<i64> = (0..people.len() as i64).collect();
        let turn = turn % people.len();
        let (mut others, mut other_ids) = (people.clone(), ids.clone());
        others.rotate_left(turn);
        other_ids.rotate_left(turn);
        let [(a, b), (c, d)] = [scene(&people, &ids), scene(&others, &other_ids)];
        let [one, mut other] = [(&a, &b), (&c, &d)].map(|(window, forecast)| {
            JointScene::of(window, forecast, None, None).mixture()
        });
        other.shares.rotate_right(turn * K * K);
        prop_assert_eq!(one, other);
        // Words get their numbers by arrival.
        let of_words = |people: &[Person], words: &[i64]| {
            let (window, forecast) = scene(people, &(FRAME_LIMIT..).take(people.len()).collect::<Vec<_>>());
            let named = window.pedestrians().iter().zip(words);
            let names = named.map(|(id, word)| (*id, format!("p{word}").into())).collect();
            JointScene::of(&window.with_names(PedestrianNames::new(names)), &forecast, None, None).mixture()
        };
        let (one, mut other) = (of_words(&people, &ids), of_words(&others, &other_ids));
        other.shares.rotate_right(turn * K * K);
        prop_assert_eq!(one, other);
    }

    /// Quarter turns and whole metres are exact for positions on a grid of 1/1024 m, so no bit may change.
    #[test]
    fn turned_and_moved_scenes_have_turned_futures(people in crowd()) {
        let ids: Vec<i64> = (0..people.len() as i64).collect();
        let (window, forecast) = scene(&people, &ids);
        let weights: Vec<f64> = people.iter().flat_map(|&one| hypotheses(one).map(|(_, weight)| weight)).collect();
        let on_grid = |x: f64| (1024.0 * x).round() / 1024.0;
        let seen = |place: fn(Position) -> Position| {
            let place = |at: Position| place(at.map(on_grid));
            let window = window.map_positions(|_, _, at| place(at));
            let pairs = || (0..people.len()).flat_map(|i| (0..K).map(move |k| (i, k)));
            let paths = pairs().flat_map(|(i, k)| forecast.hypothesis(i, k)).map(|at| place(*at));
            let forecast = Forecast::new(people.len(), K, paths.collect(), weights.clone(), None);
            JointScene::of(&window, &forecast.unwrap(), None, None).mixture()
        };
        prop_assert_eq!(seen(|at| at), seen(|[x, y]| [200_000.0 - y, x - 300_000.0]));
    }

    #[test]
    fn pedestrians_far_apart_keep_their_weights(headings in vec(0.0..6.2f64, 2..5)) {
        let people: Vec<Person> = headings.iter().zip(0..).map(|(&h, i)| ([100.0 * f64::from(i), 0.0], h,
  1.2)).collect();
        let (_, mixture) = mixture(&people);
        for (i, &person) in people.iter().enumerate() {
            for (found, (_, weight)) in marginal(&mixture, i).into_iter().zip(hypotheses(person)) {
                prop_assert!((found - weight).abs() < 0.1, "{found} of {weight}");
            }
        }
    }

    #[test]
    fn people_who_walk_together_stay_together(heading in 0.0..6.2f64, speed in 0.8..1.6f64) {
        let side = [0.8 * -heading.sin(), 0.8 * heading.cos()];
        let people = [([0.0, 0.0], heading, speed), (side, heading, speed)];
        let (window, _) = scene(&people, &[1, 2]);
        prop_assert_eq!(groups(&window), vec![vec![0, 1]]);
        let (forecast, mixture) = mixture(&people);
        for (k, weight) in mixture.weights.iter().enumerate() {
            let [a, b] = [0, 1].map(|i| path(&forecast, &mixture, i, k)[HORIZON - 1]);
            prop_assert!(*weight < 0.1 || distance(a, b) < 1.5, "future {k}: {}", distance(a, b));
        }
    }

    /// Two who walk towards each other collide where both go straight on, as independent ones do in 2 of 5 cases.
    #[test]
    fn people_do_not_walk_through_each_other(apart in 3.0..9.0f64, aside in -0.2..0.2f64) {
        let people = [([0.0, 0.0], 0.0, 1.0), ([apart, aside], std::f64::consts::PI, 1.0)];
        let (forecast, mixture) = mixture(&people);
        for k in 0..K {
            let [a, b] = [0, 1].map(|i| path(&forecast, &mixture, i, k));
            prop_assert!(mixture.weights[k] == 0.0 || least(&a, &b) > 0.3, "future {k}: {}", least(&a, &b));
        }
    }

    #[test]
    fn a_plan_far_away_changes_nothing_and_one_in_the_way_is_avoided(people in crowd(), x in 2.0..4.0f64) {
        let ids: Vec<i64> = (0..people.len() as i64).collect();
        let standing = |position: Position| Plan::new(vec![PlanPoint { time: 0.0, position, radius: 0.0 }]).unwrap();
        let (window, forecast) = scene(&people, &ids);
        let far = standing([900.0, 0.0]);
        let given = |plan| JointScene::of(&window, &forecast, plan, None).mixture();
        prop_assert_eq!(given(Some(&far)), given(None));
        let person = ([0.3, 0.0], 0.0, 1.2);
        let (window, forecast) = scene(&[person], &[1]);
        let mixture = JointScene::of(&window, &forecast, Some(&standing([x, 0.0])), None).mixture();
        prop_assert!(marginal(&mixture, 0)[straight(person)] < 0.1, "{:?}", marginal(&mixture, 0));
    }
}

#[test]
fn one_pedestrian_has_its_hypotheses() {
    let person = ([1.0, 2.0], 0.4, 1.1);
    let (forecast, mixture) = mixture(&[person]);
    assert_eq!(mixture.weights, hypotheses(person).map(|(_, weight)| weight));
    for k in 0..K {
        assert_eq!(path(&forecast, &mixture, 0, k), forecast.hypothesis(0, k));
    }
    // And in a scene with others, whom it cannot meet: a part is what it may do alone.
    let others = [([40.0, 2.0], 0.0, 1.0), person, ([41.0, 3.0], 3.0, 1.2)];
    let futures = futures(&others, &[3, 1, 2]);
    let parts: Vec<&[usize]> = futures.parts().iter().map(ddl_scene::ScenePart::pedestrians).collect();
    assert_eq!(parts, [&[0, 2][..], &[1]]);
    assert_eq!(answers(&futures.of_pedestrians(&[1]), 1), answers(&self::futures(&[person], &[7]), 1));
}

/// Rows without a position often are at (0, 0): hundreds of people at one place.
#[test]
fn many_at_one_place_take_no_minutes() {
    let people: Vec<Person> = (0..400).map(|i| ([0.0; 2], f64::from(i), 1.0)).collect();
    let begun = std::time::Instant::now();
    let (_, mixture) = mixture(&people);
    assert_eq!(mixture.weights.len(), K);
    assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
}

/// By the mean distance and the mean velocities of the observation; links make chains.
#[test]
fn groups_by_hand() {
    let track = |[x, y]: Position, [dx, dy]: Position| (0..8).map(f64::from).map(move |t| [x + t * dx, y + t * dy]);
    let of = |tracks: &[(Position, Position)]| {
        let ids = (0..tracks.len() as i64).map(PedestrianId).collect();
        let tracks = tracks.iter().map(|&(at, step)| track(at, step).collect()).collect();
        groups(&Window::new("yard", 0, 1, ids, tracks).unwrap())
    };
    let on = [0.3, -0.4];
    // 2.1 m from one to the next, the fourth 2.3 m from the third.
    let row = [0.0, 2.1, 4.2, 6.5].map(|side: f64| ([0.8 * side, 0.6 * side], on));
    assert_eq!(of(&row), [[0, 1, 2]]);
    assert_eq!(
        of(&[row[3], row[2], ([40.0, 0.0], on), row[0], row[1], ([41.0, 1.0], on)]),
        [vec![1, 3, 4], vec![2, 5]]
    );
    // 0.34 and 0.36 m/s apart: 0.136 and 0.144 m in 0.4 s.
    for (faster, expected) in [(0.136, 1), (0.144, 0)] {
        assert_eq!(of(&[([0.0; 2], on), ([0.5, 0.5], [on[0] + 0.6 * faster, on[1] - 0.8 * faster])]).len(), expected);
    }
    // 2.6 m apart at first, 1.7 m at last, and the other way round: 2.15 m on average. 0.1 m more is too far.
    for (x, step) in [(2.6, -0.128), (1.704, 0.128)] {
        let [near, far] = [0.0, 0.1].map(|more| of(&[([0.0; 2], on), ([x + more, 0.0], [on[0] + step, on[1]])]));
        assert_eq!([near.len(), far.len()], [1, 0]);
    }
}
