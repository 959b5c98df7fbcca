//! Finds the pedestrians of a library that moved like a given one: the nearest in soft-DTW, with weights.
//!
//! ```text
//! cargo run --release -p ddl-softdtw --example nearest_neighbours
//! ```
//! The library has two thousand synthetic pedestrians; the query turns left a little later than any of them. The 5
//! nearest are printed with their distances d (m²/s²) and the weights exp(-(d - smallest d) / temperature), divided by
//! their sum.
#![expect(clippy::print_stdout, reason = "what it is for")]

use std::error::Error;

use ddl_softdtw::{Cost, SearchIndex, SoftDtw};

/// Velocities (m/s), 0.4 s apart, of the 3.2 s that are compared: 7 steps between 8 positions.
const STEPS: u32 = 7;
/// Distance (m²/s²) over which a weight falls by the factor e.
const TEMPERATURE: f64 = 0.005;

/// The motion of a synthetic pedestrian, and its speed (m/s).
struct Pedestrian {
    motion: &'static str,
    speed: f64,
    /// Seconds until the pedestrian begins to turn or change its speed.
    onset: f64,
}

impl Pedestrian {
    fn library() -> Vec<Self> {
        let motions = ["straight on", "turns left", "turns right", "slows down"];
        let pedestrian = |i: u32| Self {
            motion: motions[i as usize % 4],
            speed: 0.5 + 0.01 * f64::from(i / 4 % 125),
            onset: 0.4 * f64::from(i / 500),
        };
        (0..2000).map(pedestrian).collect()
    }

    /// The velocity of each step (m/s), heading along x at first.
    fn velocities(&self) -> Vec<[f64; 2]> {
        let velocity = |step: u32| {
            let since = (0.4 * f64::from(step) - self.onset).max(0.0);
            let (speed, angle) = match self.motion {
                "turns left" => (self.speed, 0.5 * since),
                "turns right" => (self.speed, -0.5 * since),
                "slows down" => (self.speed * (-0.6 * since).exp(), 0.0),
                _ => (self.speed, 0.0),
            };
            [speed * angle.cos(), speed * angle.sin()]
        };
        (0..STEPS).map(velocity).collect()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let library = Pedestrian::library();
    let candidates: Vec<_> = library.iter().map(Pedestrian::velocities).collect();
    let query = Pedestrian {
        motion: "turns left",
        speed: 1.204,
        onset: 0.5,
    };

    // gamma is the temperature of the smoothed minimum over alignments, in the unit of the cost.
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean)?;
    let index = SearchIndex::build(&dtw, &candidates)?;
    let nearest = index.nearest(&query.velocities(), 5)?;

    let smallest = nearest[0].distance;
    let likeness = |distance: f64| (-(distance - smallest) / TEMPERATURE).exp();
    let sum: f64 = nearest.iter().map(|neighbour| likeness(neighbour.distance)).sum();
    println!(
        "query: {} after {:.1} s, at {:.2} m/s; the nearest of {} pedestrians ({}):",
        query.motion,
        query.onset,
        query.speed,
        index.len(),
        index.instruction_set()
    );
    println!("pedestrian  distance  weight");
    for neighbour in &nearest {
        let pedestrian = &library[neighbour.index];
        println!(
            "{:>6}  {:>8.5}  {:>6.3}  {} after {:.1} s, at {:.2} m/s",
            neighbour.index,
            neighbour.distance,
            likeness(neighbour.distance) / sum,
            pedestrian.motion,
            pedestrian.onset,
            pedestrian.speed,
        );
    }

    // The search is exact: evaluating every pair gives the same result.
    let mut distances: Vec<(f64, usize)> = Vec::new();
    for (i, candidate) in candidates.iter().enumerate() {
        distances.push((dtw.normalised(&query.velocities(), candidate)?, i));
    }
    distances.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = nearest
        .iter()
        .zip(&distances)
        .all(|(neighbour, (_, i))| neighbour.index == *i);
    println!("an exhaustive search {}", if same { "agrees" } else { "DISAGREES" });
    Ok(())
}
