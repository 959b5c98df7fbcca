//! Draws typical pedestrians of a fold's test scene with estimated goals: `draw_goals star hotel goals.svg`
//! (convention, fold, file to write).
//!
//! The estimator is a stand-in: the training pedestrians whose observed tracks, moved and turned onto that of
//! the pedestrian, come nearest, and the ends of the nearest few as goals. `ddl-goal` has the real one.

use std::error::Error;

use ddl_data::{Convention, Dataset, OBSERVED, Position, Window, WindowRule, locate};
use ddl_eval::{
    MotionKind,
    baseline::WeightedGoals,
    metric::displacement::{average_displacement, distance},
};
use ddl_report::figure::{self, GoalCase};

/// Pedestrians that are shown as experts.
const EXPERTS: usize = 60;
/// Of these, how many give a goal.
const GOALS: usize = 20;

/// A track moved and turned so that its observed part begins where that of the pedestrian does and leads the
/// same way.
fn carried_over(expert: &[Position], pedestrian: &[Position]) -> Vec<Position> {
    let way = |track: &[Position]| {
        let (a, b) = (track[0], track[OBSERVED - 1]);
        (b[1] - a[1]).atan2(b[0] - a[0])
    };
    let (sin, cos) = (way(pedestrian) - way(expert)).sin_cos();
    let (from, to) = (expert[OBSERVED - 1], pedestrian[OBSERVED - 1]);
    let carry = |p: &Position| {
        let [x, y] = [p[0] - from[0], p[1] - from[1]];
        [to[0] + cos * x - sin * y, to[1] + sin * x + cos * y]
    };
    expert.iter().map(carry).collect()
}

/// The pedestrians of the library most like this one, most alike first.
fn experts(library: &[Vec<Position>], pedestrian: &[Position]) -> Vec<Vec<Position>> {
    let unlike =
        |track: &[Position]| average_displacement(&track[..OBSERVED], &pedestrian[..OBSERVED]);
    let mut all: Vec<(f64, Vec<Position>)> = library
        .iter()
        .map(|expert| carried_over(expert, pedestrian))
        .map(|track| (unlike(&track), track))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter()
        .take(EXPERTS)
        .map(|(_, track)| track)
        .collect()
}

/// The ends of the first experts, the more alike the likelier.
fn goals(experts: &[Vec<Position>]) -> Result<WeightedGoals, Box<dyn Error>> {
    let ends: Vec<Position> = experts.iter().take(GOALS).map(|track| track[19]).collect();
    let likeness: Vec<f64> = (0..ends.len())
        .map(|rank| 0.85_f64.powi(rank as i32))
        .collect();
    let sum: f64 = likeness.iter().sum();
    let weights = likeness.iter().map(|w| w / sum).collect();
    Ok(WeightedGoals::new(ends, weights)?)
}

fn tracks(windows: &[Window]) -> impl Iterator<Item = &[Position]> {
    windows
        .iter()
        .flat_map(|window| (0..window.len()).map(|i| window.track(i)))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [convention, fold, path] = arguments.as_slice() else {
        return Err("usage: draw_goals CONVENTION FOLD FILE.svg".into());
    };
    let dataset = match convention.parse()? {
        Convention::Simulated => Dataset::simulated(1),
        real => Dataset::load(real, &locate(real, None)?)?,
    };
    let fold = dataset.fold(fold)?;
    let training = fold.training_windows(WindowRule::Complete);
    let library: Vec<Vec<Position>> = tracks(&training).step_by(7).map(<[_]>::to_vec).collect();
    let windows = fold.test_windows(WindowRule::Published);

    let mut pedestrians = Vec::new();
    let mut kinds = Vec::new();
    for window in &windows {
        for i in 0..window.len() {
            let track = window.track(i);
            let kind = MotionKind::of(track).ok_or("a window without a future")?;
            let set = goals(&experts(&library, track))?;
            let error = |goal: &Position| distance(*goal, track[19]);
            let least = set.goals().iter().map(error).fold(f64::INFINITY, f64::min);
            pedestrians.push((window, i));
            kinds.push((kind, least));
        }
    }
    let mut cases = Vec::new();
    for pick in figure::typical_pedestrians(&kinds) {
        let ((window, i), (kind, _)) = (pedestrians[pick], kinds[pick]);
        let (frame, pedestrian) = (window.start_frame(), window.pedestrians()[i]);
        let title = format!(
            "{}, frame {frame}, pedestrian {pedestrian}: {kind}",
            window.recording()
        );
        let experts = experts(&library, window.track(i));
        let case = GoalCase::new(title, window.track(i), goals(&experts)?)?;
        cases.push(case.with_experts(experts)?);
    }
    let title = "Goals of walkers with the median error of their kind";
    std::fs::write(path, figure::goals(title, &cases)?)?;
    Ok(())
}
