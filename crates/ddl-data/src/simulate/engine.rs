//! The simulation loop: pedestrians enter, walk, stand and leave, in small time steps.

use ddl_core::{PedestrianId, Position, TIME_STEP};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::observation::Observation;
use crate::simulate::force::{self, BODY, WalkingMotion};
use crate::simulate::layout::{RouteLeg, SceneLayout};
use crate::simulate::pedestrian::{ARRIVED, DT, SUBSTEPS, SimulatedPedestrian};
use crate::simulate::population::{self, Party};
use crate::simulate::vector::{add, norm, scale, sub, unit};

/// Raw frames in one step of 0.4 s, as in most real recordings.
pub(super) const FRAME_STEP: i64 = 10;
/// Time simulated before recording starts, so that the scene is populated (s).
const WARM_UP: f64 = 20.0;
/// Largest speed, as a multiple of the desired speed.
const TOP_SPEED: f64 = 1.3;
/// Random acceleration of a pedestrian (m/s per square root of a second).
const RESTLESSNESS: f64 = 0.12;
/// An entry is free when no pedestrian is within this distance (m).
const ENTRY_CLEARANCE: f64 = 0.7;

/// Runs a scene for `steps` recorded steps of 0.4 s.
pub(super) fn run(layout: &SceneLayout, steps: i64, rng: &mut ChaCha8Rng) -> Vec<Observation> {
    let parties = population::draw(layout, WARM_UP + steps as f64 * TIME_STEP, rng);
    let mut engine = CrowdEngine { layout, parties, waiting: Vec::new(), pedestrians: Vec::new(), next: 0, last_id: 0 };
    let mut observations = Vec::new();
    let warm_up = (WARM_UP / DT).round() as i64;
    for tick in 0..warm_up + steps * SUBSTEPS {
        engine.admit(tick as f64 * DT);
        engine.step(rng);
        let recorded = tick - warm_up;
        if recorded >= 0 && recorded % SUBSTEPS == 0 {
            let frame = recorded / SUBSTEPS * FRAME_STEP;
            let seen = engine.pedestrians.iter();
            observations.extend(seen.map(|w| Observation::new(frame, w.id, w.motion.position)));
        }
    }
    observations
}

struct CrowdEngine<'a> {
    layout: &'a SceneLayout,
    parties: Vec<Party>,
    /// Indices of the parties that are due but found their entry occupied.
    waiting: Vec<usize>,
    pedestrians: Vec<SimulatedPedestrian>,
    next: usize,
    last_id: i64,
}

impl CrowdEngine<'_> {
    fn admit(&mut self, time: f64) {
        while self.parties.get(self.next).is_some_and(|party| party.time <= time) {
            self.waiting.push(self.next);
            self.next += 1;
        }
        for index in std::mem::take(&mut self.waiting) {
            let taken: Vec<_> = self.pedestrians.iter().map(|w| w.motion.position).collect();
            let members = &self.parties[index].members;
            if members.iter().all(|m| population::is_free(m.entry, &taken, ENTRY_CLEARANCE)) {
                self.enter(index);
            } else {
                self.waiting.push(index);
            }
        }
    }

    fn enter(&mut self, index: usize) {
        let party = &self.parties[index];
        for member in &party.members {
            self.last_id += 1;
            let heading = unit(sub(member.targets[0], member.entry));
            self.pedestrians.push(SimulatedPedestrian {
                id: PedestrianId(self.last_id),
                party: index,
                motion: WalkingMotion { position: member.entry, velocity: scale(heading, party.speed) },
                targets: member.targets.clone(),
                leg: 0,
                rest_left: member.rest,
                leg_start: member.entry,
            });
        }
    }

    fn step(&mut self, rng: &mut ChaCha8Rng) {
        let before: Vec<WalkingMotion> = self.pedestrians.iter().map(|w| w.motion).collect();
        for index in 0..self.pedestrians.len() {
            let speed = self.parties[self.pedestrians[index].party].speed;
            let velocity = add(before[index].velocity, scale(self.acceleration(index, &before), DT));
            let liveliness = (0.2 + norm(velocity) / speed).min(1.0) * RESTLESSNESS * DT.sqrt();
            let [x, y]: [f64; 2] = [StandardNormal.sample(rng), StandardNormal.sample(rng)];
            let velocity = add(velocity, scale([x, y], liveliness));
            let excess = norm(velocity) / (TOP_SPEED * speed);
            let velocity = scale(velocity, 1.0 / excess.max(1.0));
            self.pedestrians[index].motion.velocity = velocity;
            self.pedestrians[index].motion.position = add(before[index].position, scale(velocity, DT));
        }
        self.separate_bodies();
        for (pedestrian, before) in self.pedestrians.iter_mut().zip(&before) {
            pedestrian.motion.position = outside_obstacles(self.layout, pedestrian.motion.position);
            // The velocity is the displacement that remains after contact with bodies and walls.
            let moved = scale(sub(pedestrian.motion.position, before.position), 1.0 / DT);
            if norm(moved) < norm(pedestrian.motion.velocity) {
                pedestrian.motion.velocity = moved;
            }
        }
        let Self { layout, parties, pedestrians, .. } = self;
        pedestrians.retain_mut(|pedestrian| {
            let legs = &layout.routes[parties[pedestrian.party].route].legs;
            pedestrian.advance(legs);
            pedestrian.leg < legs.len()
        });
    }

    fn acceleration(&self, index: usize, before: &[WalkingMotion]) -> Position {
        let (pedestrian, me) = (&self.pedestrians[index], before[index]);
        let mut companions = 0;
        let mut centre = me.position;
        let mut total = [0.0, 0.0];
        for (other, &motion) in self.pedestrians.iter().zip(before) {
            if other.id == pedestrian.id {
                continue;
            }
            if other.party == pedestrian.party {
                companions += 1;
                centre = add(centre, motion.position);
                total = add(total, force::companion(me, motion));
            } else {
                total = add(total, force::stranger(me, motion, BODY));
            }
        }
        let size = companions + 1;
        centre = scale(centre, 1.0 / f64::from(size));
        let party = &self.parties[pedestrian.party];
        let legs = &self.layout.routes[party.route].legs;
        let standing = matches!(legs[pedestrian.leg], RouteLeg::Stand(_)) && pedestrian.is_within(ARRIVED);
        if size > 1 && !standing {
            total = add(total, force::cohesion(me, centre, party.members.len()));
        }
        total = add(total, force::driving(me, pedestrian.desired(legs, party.speed, centre)));
        for wall in &self.layout.walls {
            total = add(total, force::wall(me, wall));
        }
        for pillar in &self.layout.pillars {
            total = add(total, force::pillar(me, pillar));
        }
        total
    }

    fn separate_bodies(&mut self) {
        for i in 1..self.pedestrians.len() {
            let (earlier, later) = self.pedestrians.split_at_mut(i);
            let a = &mut later[0].motion.position;
            for other in earlier {
                let b = &mut other.motion.position;
                let apart = sub(*a, *b);
                let overlap = 2.0 * BODY - norm(apart);
                if overlap > 0.0 {
                    let shift = scale(unit(apart), 0.5 * overlap);
                    *a = add(*a, shift);
                    *b = sub(*b, shift);
                }
            }
        }
    }
}

/// The position, moved out of every wall and pillar. Two passes handle corners.
fn outside_obstacles(layout: &SceneLayout, position: Position) -> Position {
    (0..2).fold(position, |mut place, _| {
        for wall in &layout.walls {
            place = wall.push_out(place, BODY);
        }
        for pillar in &layout.pillars {
            place = pillar.push_out(place, BODY);
        }
        place
    })
}
