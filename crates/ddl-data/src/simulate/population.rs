//! Population of a scene: arrivals, groups, desired speeds and routes, all drawn in advance.

use ddl_core::Position;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Exp, Normal};

use crate::simulate::layout::{RouteLeg, SceneLayout};
use crate::simulate::obstacle::Segment;
use crate::simulate::vector::{norm, sub};

/// Mean and standard deviation of the desired speed of a lone pedestrian (m/s): Helbing and Molnár 1995.
const DESIRED_SPEED: (f64, f64) = (1.34, 0.26);
/// Slowest and fastest speed drawn (m/s).
const SPEED_RANGE: (f64, f64) = (0.7, 2.0);
/// Mean speed of a group relative to its members walking alone.
const GROUP_PACE: f64 = 0.93;
/// Distance at which group members enter side by side (m).
pub(super) const GROUP_SPACING: f64 = 0.75;
/// Distance of arrivals from the ends of a gate (m).
const GATE_MARGIN: f64 = 0.5;
/// Shortest and longest time of standing (s).
const REST: (f64, f64) = (8.0, 28.0);

#[derive(Debug, Clone)]
pub(super) struct Party {
    /// Time at which it enters (s).
    pub(super) time: f64,
    pub(super) route: usize,
    /// Desired speed of all its members (m/s).
    pub(super) speed: f64,
    pub(super) members: Vec<PartyMember>,
}

#[derive(Debug, Clone)]
pub(super) struct PartyMember {
    pub(super) entry: Position,
    /// Points at which it passes each leg's gate, or stands (m).
    pub(super) targets: Vec<Position>,
    /// Time of standing (s).
    pub(super) rest: f64,
}

/// All parties that arrive before `end` (s), in order of time.
pub(super) fn draw(layout: &SceneLayout, end: f64, rng: &mut ChaCha8Rng) -> Vec<Party> {
    let interval = Exp::new(1.0 / layout.arrival_interval).expect("arrival intervals of the five layouts are positive");
    let mut parties = Vec::new();
    let mut time = interval.sample(rng);
    while time < end {
        parties.push(party(layout, time, rng));
        time += interval.sample(rng);
    }
    parties
}

fn party(layout: &SceneLayout, time: f64, rng: &mut ChaCha8Rng) -> Party {
    let size = match rng.random_range(0.0..1.0) {
        draw if draw < 0.6 => 1,
        draw if draw < 0.9 => 2,
        _ => 3,
    };
    let speeds =
        Normal::new(DESIRED_SPEED.0, DESIRED_SPEED.1).expect("the standard deviation of the desired speed is positive");
    let mean = (0..size).map(|_| speeds.sample(rng).clamp(SPEED_RANGE.0, SPEED_RANGE.1)).sum::<f64>() / size as f64;
    let speed = if size > 1 { GROUP_PACE * mean } else { mean };
    let route = choose_route(layout, rng);
    let chosen = &layout.routes[route];
    let rest = rng.random_range(REST.0..REST.1);
    let entries = side_by_side(chosen.origin, size, rng.random_range(0.0..1.0));
    // A pedestrian that enters on the left tends to stay on the left: it has one lateral position for all gates.
    let across: f64 = rng.random_range(0.0..1.0);
    let mut targets = vec![Vec::new(); size];
    for leg in &chosen.legs {
        let places = match *leg {
            RouteLeg::Pass(gate) => side_by_side(gate, size, across),
            RouteLeg::Stand(line) => in_a_ring(line.at(rng.random_range(0.0..1.0)), size, rng),
        };
        for (target, place) in targets.iter_mut().zip(places) {
            target.push(place);
        }
    }
    let members =
        entries.into_iter().zip(targets).map(|(entry, targets)| PartyMember { entry, targets, rest }).collect();
    Party { time, route, speed, members }
}

fn choose_route(layout: &SceneLayout, rng: &mut ChaCha8Rng) -> usize {
    let total: f64 = layout.routes.iter().map(|r| r.weight).sum();
    let mut draw = rng.random_range(0.0..total);
    for (index, route) in layout.routes.iter().enumerate() {
        draw -= route.weight;
        if draw < 0.0 {
            return index;
        }
    }
    layout.routes.len() - 1
}

/// Places across a gate for a group of this size, away from the gate's ends where it is wide enough.
fn side_by_side(gate: Segment, size: usize, across: f64) -> Vec<Position> {
    let room = (gate.width() - 2.0 * GATE_MARGIN).max(0.0);
    let spacing = GROUP_SPACING.min(room / size as f64);
    let span = spacing * (size - 1) as f64;
    let first = GATE_MARGIN + across * (room - span);
    (0..size).map(|i| gate.at((first + spacing * i as f64) / gate.width())).collect()
}

fn in_a_ring(centre: Position, size: usize, rng: &mut ChaCha8Rng) -> Vec<Position> {
    let radius = if size > 1 { 0.5 } else { 0.3 };
    let turn = rng.random_range(0.0..std::f64::consts::TAU);
    (0..size)
        .map(|i| {
            let angle = turn + std::f64::consts::TAU * i as f64 / size as f64;
            [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
        })
        .collect()
}

/// Whether all others are at least `distance` (m) away from a place.
pub(super) fn is_free(place: Position, others: &[Position], distance: f64) -> bool {
    others.iter().all(|&other| norm(sub(place, other)) >= distance)
}
