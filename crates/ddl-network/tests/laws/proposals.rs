//! Proposals: shape, probabilities and dependence on the inputs.

use super::scenes::{WINDOWS, distance, with_threads};
use ddl_core::{OBSERVED, Position, RememberedTrack, WINDOW, Window};
use ddl_network::{PedestrianView, ProposalConfig, ProposalNetwork, ProposeEndpoints as _, ProposedEndpoints};
use proptest::prelude::*;
use proptest::sample::Index;
use std::sync::LazyLock;

fn network(config: ProposalConfig) -> ProposalNetwork {
    ProposalNetwork::new(config, 3).unwrap()
}

fn small() -> ProposalConfig {
    ProposalConfig { members: 2, ends: 6, width: 32, neighbour_width: 16, ..ProposalConfig::default() }
}

fn seen(window: &Window, i: usize) -> PedestrianView {
    let here = window.observed(i)[OBSERVED - 1];
    let relative = |j: usize| -> [Position; OBSERVED] {
        std::array::from_fn(|t| {
            let [x, y] = window.observed(j)[t];
            [x - here[0], y - here[1]]
        })
    };
    let others = (0..window.len()).filter(|&j| j != i);
    PedestrianView { own: relative(i), neighbours: others.map(relative).collect(), remembered: Vec::new() }
}

/// All pedestrians of all windows but the crowd: more than one batch, and some of them alone.
static VIEWS: LazyLock<Vec<PedestrianView>> = LazyLock::new(|| {
    let windows = WINDOWS[..WINDOWS.len() - 1].iter();
    let mut views: Vec<_> = windows.flat_map(|window| (0..window.len()).map(|i| seen(window, i))).collect();
    views.extend([0.0, 1.0, 1.6].map(|speed| view(speed, 0)));
    for (i, view) in views.iter_mut().enumerate() {
        view.remembered = (0..i % 15).map(|j| earlier(0.3 * j as f64)).collect();
    }
    assert!(views.len() > 100);
    views
});

/// A view of a pedestrian at constant velocity, `speed` (m/s), with `neighbours` ahead.
fn view(speed: f64, neighbours: usize) -> PedestrianView {
    let walk = |speed: f64, x: f64, y: f64| std::array::from_fn(|t| [x + speed * 0.4 * (t as f64 - 7.0), y]);
    PedestrianView {
        own: walk(speed, 0.0, 0.0),
        neighbours: (0..neighbours).map(|j| walk(-0.8, 2.0 + j as f64, 0.3 * j as f64)).collect(),
        remembered: Vec::new(),
    }
}

/// An earlier pedestrian at 1 m/s, `aside` metres to the left.
fn earlier(aside: f64) -> RememberedTrack {
    let track: [Position; WINDOW] = std::array::from_fn(|t| [0.4 * (t as f64 - 7.0), aside]);
    RememberedTrack { track, distance: aside * aside }
}

fn bits(proposed: &ProposedEndpoints) -> Vec<u64> {
    proposed.endpoints.as_flattened().iter().chain(&proposed.weights).map(|number| number.to_bits()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn proposals_have_the_same_bits_alone_and_among_others(
        chosen in prop::collection::vec(any::<Index>(), 1..150),
        looked_at in any::<Index>(),
        published in any::<bool>(),
        threads in 1..4_usize,
    ) {
        let network = network(if published { ProposalConfig::default() } else { small() });
        let views: Vec<_> = chosen.iter().map(|index| index.get(&VIEWS).clone()).collect();
        let together = with_threads(threads, || network.propose(&views)).unwrap();
        prop_assert_eq!(together.len(), views.len());
        let i = looked_at.index(views.len());
        let alone = network.propose(&views[i..=i]).unwrap();
        prop_assert_eq!(bits(&alone[0]), bits(&together[i]));
        let ends = network.config().members * network.config().ends;
        let ends = if views[i].remembered.is_empty() { ends } else { 2 * ends };
        prop_assert_eq!(together[i].endpoints.len(), ends as usize);
        prop_assert_eq!(together[i].weights.len(), ends as usize);
        let sum: f64 = together[i].weights.iter().sum();
        prop_assert!((sum - 1.0).abs() < 1e-9);
        prop_assert!(together[i].endpoints.as_flattened().iter().all(|x| x.is_finite()));
    }
}

/// Largest distance between the endpoints of two views.
fn apart(a: &PedestrianView, b: &PedestrianView) -> f64 {
    let proposed = network(small()).propose(&[a.clone(), b.clone()]).unwrap();
    proposed[0].endpoints.iter().zip(&proposed[1].endpoints).map(|(&a, &b)| distance(a, b)).fold(0.0, f64::max)
}

#[test]
fn the_memory_branch_adds_endpoints_and_keeps_the_others() {
    let network = network(small());
    let memory = network.config().memory.clone().unwrap();
    let mut remembering = view(1.2, 2);
    let alone = network.propose(&[remembering.clone()]).unwrap().remove(0);
    remembering.remembered = (1..5).map(|j| earlier(0.2 * f64::from(j))).collect();
    let alike: f64 = [0.04, 0.16, 0.36, 0.64].map(|d: f64| (-d / 8.0).exp()).iter().sum();
    let share = alike / (alike + 0.5);
    let both = network.propose(&[remembering.clone()]).unwrap().remove(0);
    assert_eq!(both.endpoints[..12], alone.endpoints);
    for (both, alone) in both.weights.iter().zip(&alone.weights) {
        assert!((both - alone * (1.0 - share)).abs() < 1e-12);
    }
    let of_memory: f64 = both.weights[12..].iter().sum();
    assert!((of_memory - share).abs() < 1e-9);
    // Only the first `memory.remembered` earlier pedestrians count, in any order.
    remembering.remembered = (0..20).map(|j| earlier(0.1 * f64::from(j))).collect();
    let mut looked_at = remembering.clone();
    looked_at.remembered.truncate(memory.remembered);
    assert!(apart(&remembering, &looked_at) <= 0.0);
    looked_at.remembered.reverse();
    assert!(apart(&remembering, &looked_at) < 1e-4);
    // Each of them counts.
    looked_at.remembered.pop();
    assert!(apart(&remembering, &looked_at) > 0.0);
}

#[test]
fn near_neighbours_count_in_any_order_and_far_ones_do_not() {
    assert!(network(small()).propose(&[]).unwrap().is_empty());
    let pedestrian = view(1.1, 4);
    let mut shuffled = pedestrian.clone();
    shuffled.neighbours.reverse();
    assert!(apart(&pedestrian, &shuffled) < 1e-4);
    let mut with_far = pedestrian.clone();
    with_far.neighbours.push([[40.0, 3.0]; OBSERVED]);
    assert!(apart(&pedestrian, &with_far) < 1e-9);
    // Neighbours ahead count.
    assert!(apart(&pedestrian, &view(1.1, 0)) > 1e-3);
    // Neighbours beyond the limit do not count.
    let crowd = view(1.0, 30);
    let mut seen = crowd.clone();
    seen.neighbours.truncate(8);
    assert!(apart(&crowd, &seen) < 1e-9);
}
