//! The proposal network: what it learns, the invariances of its endpoints, and how its training is resumed.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_core::RememberedTrack;
use ddl_network::weights::Origin;
use ddl_network::{
    DeviceChoice, MemoryTraining, NetworkError, PedestrianView, ProposalConfig, ProposalExample, ProposalNetwork,
    ProposalTraining, ProposeEndpoints, ProposedEndpoints,
};
use ddl_star::{ComputeDevice, ProposalTrainer, StarError, TorchProposals};
use std::f64::consts::TAU;

/// Training steps of the memory branch.
const MEMORY_STEPS: u64 = 8;

fn device() -> ComputeDevice {
    ComputeDevice::open(DeviceChoice::Cpu).unwrap()
}

fn small() -> ProposalConfig {
    ProposalConfig { members: 2, ends: 6, width: 32, neighbour_width: 16, ..ProposalConfig::default() }
}

fn network() -> TorchProposals {
    TorchProposals::new(small(), 3, device()).unwrap()
}

/// A view of a pedestrian at `speed` (m/s) with `neighbours` ahead.
fn view(speed: f64, neighbours: usize) -> PedestrianView {
    let walk = |speed: f64, x: f64, y: f64| std::array::from_fn(|t| [x + speed * 0.4 * (t as f64 - 7.0), y]);
    PedestrianView {
        own: walk(speed, 0.0, 0.0),
        neighbours: (0..neighbours).map(|j| walk(-0.8, 2.0 + j as f64, 0.3 * j as f64)).collect(),
        remembered: Vec::new(),
    }
}

/// An earlier pedestrian: at first like [`view`] at 1 m/s, then turning by `angle` (radians).
fn earlier(angle: f64) -> RememberedTrack {
    let (sin, cos) = angle.sin_cos();
    let track = std::array::from_fn(|t| {
        let way = 0.4 * (t as f64 - 7.0);
        if t < 8 { [way, 0.1] } else { [way * cos, 0.1 + way * sin] }
    });
    RememberedTrack { track, distance: 0.01 + angle.abs() }
}

/// Pedestrians who continue straight or turn left or right by 60 degrees, a third each.
fn examples() -> Vec<ProposalExample> {
    (0..90)
        .map(|i| {
            let speed = 0.7 + 0.01 * f64::from(i);
            let (sin, cos) = (f64::from(i % 3 - 1) * TAU / 6.0).sin_cos();
            let future = std::array::from_fn(|t| {
                let way = speed * 0.4 * (t as f64 + 1.0);
                [way * cos, way * sin]
            });
            let view = view(speed, 0);
            ProposalExample { view, future }
        })
        .collect()
}

fn training(steps: u64) -> ProposalTraining {
    ProposalTraining {
        steps,
        batch: 32,
        learning_rate: 4e-3,
        memory: MemoryTraining { steps: MEMORY_STEPS, ..MemoryTraining::default() },
        ..ProposalTraining::default()
    }
}

/// Mean distance of the nearest endpoint to the true one (m).
fn oracle(network: &dyn ProposeEndpoints, examples: &[ProposalExample]) -> f64 {
    let views: Vec<_> = examples.iter().map(|example| example.view.clone()).collect();
    let proposed = network.propose(&views).unwrap();
    let nearest = |(proposed, example): (&ProposedEndpoints, &ProposalExample)| {
        let [x, y] = example.future[11];
        proposed.endpoints.iter().map(|end| (end[0] - x).hypot(end[1] - y)).fold(f64::INFINITY, f64::min)
    };
    proposed.iter().zip(examples).map(nearest).sum::<f64>() / examples.len() as f64
}

fn finished(mut trainer: ProposalTrainer) -> TorchProposals {
    while !trainer.is_finished() {
        trainer.step().unwrap();
    }
    assert_eq!(trainer.steps().done, trainer.steps().total);
    trainer.into_network().unwrap()
}

fn trained(steps: u64) -> TorchProposals {
    finished(ProposalTrainer::new(network(), &examples(), &[], training(steps)).unwrap())
}

#[test]
fn it_learns_where_pedestrians_go_on_a_fork() {
    let before = oracle(&*network().into_proposer(), &examples());
    let after = trained(250).into_proposer();
    let error = oracle(&*after, &examples());
    assert!(before > 1.0 && error < 0.45, "{before:.2} m before, {error:.2} m after");
    // A faster pedestrian ends further away: the endpoints depend on the observation.
    let reach = |speed| {
        let proposed = after.propose(&[view(speed, 0)]).unwrap();
        proposed[0].endpoints.iter().map(|end| end[0].hypot(end[1])).fold(0.0, f64::max)
    };
    assert!(reach(1.5) > reach(0.8) + 1.0);
}

#[test]
fn earlier_pedestrians_decide_and_the_rest_of_the_network_is_unchanged() {
    // All observed motions are the same; pedestrians turn to the side to which earlier ones have turned.
    let angle = |i: i32| f64::from(i % 2 * 2 - 1) * TAU / 6.0;
    let examples: Vec<ProposalExample> = (0..60)
        .map(|i| {
            let mut view = view(1.0, 0);
            view.remembered = vec![earlier(angle(i))];
            let track = earlier(angle(i)).track;
            let future = std::array::from_fn(|t| [track[t + 8][0], track[t + 8][1] - 0.1]);
            ProposalExample { view, future }
        })
        .collect();
    let config = ProposalConfig { ends: 1, ..small() };
    let with_memory = |steps: u64| {
        let network = TorchProposals::new(config.clone(), 3, device()).unwrap();
        let mut training = training(60);
        training.memory.steps = steps;
        let trainer = ProposalTrainer::new(network, &examples, &[], training).unwrap();
        let weights = finished(trainer).parameters().to_weights();
        ProposalNetwork::reading(config.clone(), |_| Ok(weights.unwrap())).unwrap()
    };
    let views: Vec<_> = examples.iter().map(|example| example.view.clone()).collect();
    // The first endpoints are from the observation only, the others from the memory branch.
    let error = |network: &ProposalNetwork, which: std::ops::Range<usize>| {
        let proposed = network.propose(&views).unwrap();
        let off = |(proposed, example): (&ProposedEndpoints, &ProposalExample)| {
            let [x, y] = example.future[11];
            let off = proposed.endpoints[which.clone()].iter().map(|end| (end[0] - x).hypot(end[1] - y));
            off.sum::<f64>() / which.len() as f64
        };
        let sum = proposed.iter().zip(&examples).map(off).sum::<f64>();
        sum / examples.len() as f64
    };
    let trained = with_memory(150);
    let (alone, remembering) = (error(&trained, 0..2), error(&trained, 2..4));
    assert!(alone > 2.0 && remembering < 0.7, "{alone:.2} m alone, {remembering:.2} m with memory");
    let strangers: Vec<_> = (0..3).map(|i| view(0.7 * f64::from(i), 2)).collect();
    let proposed = |network: &ProposalNetwork| network.propose(&strangers).unwrap();
    assert_eq!(proposed(&trained), proposed(&with_memory(1)));
}

#[test]
fn kernels_propose_the_endpoints_of_libtorch() {
    let mut views: Vec<PedestrianView> = (0..70_u8).map(|i| view(0.03 * f64::from(i), usize::from(i % 11))).collect();
    views[5].neighbours.push([[40.0, 3.0]; 8]);
    views[6].neighbours = vec![[[40.0, 3.0]; 8]];
    views[7].neighbours = vec![views[7].own];
    // More earlier pedestrians than are used, and fewer; some views have none.
    for (i, view) in (0_u8..).zip(&mut views) {
        view.remembered = (0..i % 15).map(|j| earlier(0.2 * f64::from(j))).collect();
    }
    for torch in [network(), trained(20)] {
        let weights = torch.parameters().to_weights().unwrap();
        let plain = ProposalNetwork::reading(small(), |_| Ok(weights)).unwrap();
        let reference = torch.into_proposer().propose(&views).unwrap();
        let ours = plain.propose(&views).unwrap();
        assert_eq!((ours.len(), reference.len()), (views.len(), views.len()));
        for (i, (ours, reference)) in ours.iter().zip(&reference).enumerate() {
            let numbers =
                |proposed: &ProposedEndpoints| [proposed.endpoints.as_flattened(), &proposed.weights].concat();
            let (ours, reference) = (numbers(ours), numbers(reference));
            let numbers = if views[i].remembered.is_empty() { 36 } else { 72 };
            assert_eq!((ours.len(), reference.len()), (numbers, numbers));
            for (ours, reference) in ours.into_iter().zip(reference) {
                assert!((ours - reference).abs() < 1e-5, "view {i}: {ours} {reference}");
            }
        }
    }
}

#[test]
fn a_resumed_training_ends_with_the_same_weights() {
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("state.safetensors");
    let begin = || ProposalTrainer::new(network(), &examples(), &[], training(12)).unwrap();
    let weights = |network: TorchProposals| network.parameters().to_weights().unwrap();
    let whole = weights(trained(12));
    // Before, at and after the end of training on the observation only.
    for done in [5, 12, 15] {
        let mut first = begin();
        for _ in 0..done {
            first.step().unwrap();
        }
        first.save(&Origin::default(), &state).unwrap();
        let mut second = begin();
        second.resume(&Origin::default(), &state).unwrap();
        assert_eq!((second.steps().done, second.steps().total), (done, 12 + MEMORY_STEPS));
        assert_eq!(weights(finished(second)), whole, "{done}");
    }

    let bytes = std::fs::read(&state).unwrap();
    std::fs::write(&state, &bytes[..bytes.len() / 2]).unwrap();
    let error = begin().resume(&Origin::default(), &state).unwrap_err();
    let refused = matches!(error, StarError::Network(NetworkError::Checkpoint { .. }));
    assert!(refused, "{error}");
}

#[test]
fn invalid_examples_are_refused() {
    let nothing = ProposalTrainer::new(network(), &[], &[], training(5));
    assert!(matches!(nothing, Err(StarError::NoTrainingWindows)));
    let mut broken = examples();
    for example in &mut broken {
        example.future[11] = [f64::NAN, 0.0];
    }
    let mut trainer = ProposalTrainer::new(network(), &broken, &[], training(5)).unwrap();
    let error = trainer.step().unwrap_err();
    assert!(matches!(error, StarError::ProposalNonFinite { step: 0, .. }), "{error}");
    assert_eq!((trainer.steps().done, trainer.steps().total), (0, 5 + MEMORY_STEPS));
    assert!(error.to_string().contains("of the examples"), "{error}");

    // The error does not name the valid examples before them.
    let only_reversed = ProposalTraining { reversed: 1.0, ..training(5) };
    let broken = &broken[..7];
    let mut trainer = ProposalTrainer::new(network(), &examples(), broken, only_reversed).unwrap();
    let error = trainer.step().unwrap_err();
    let StarError::ProposalNonFinite { example, reversed, .. } = error else { panic!("{error}") };
    assert!(reversed && example < broken.len(), "{error}");
    let said = format!("number {example} of the reversed examples");
    assert!(error.to_string().contains(&said), "{error}");
}
