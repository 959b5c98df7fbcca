//! Batches: windows that are forecast together.

use crate::NetworkError;
use crate::forecast::rollout::{Noise, StepRule, WindowRollout};
use crate::seed::{Stage, stream};
use ddl_core::{HORIZON, OBSERVED, Position, Window};
use rand::RngExt as _;
use rand_distr::StandardNormal;
use rayon::prelude::*;

/// The pedestrians of a window with more than this are sorted by position: the keys and values that a query reads are
/// then close together in memory.
const CROWD: usize = 128;
/// Width of the strips by which they are sorted, metres.
const STRIP: f64 = 2.5;
/// Side of a cell of the curve, metres.
const CELL: f64 = 0.5;

/// How the pedestrians of a crowd are sorted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrowdOrder {
    /// In strips of 2.5 m. The kernels compute one pair of queries after the other: 10,000 pedestrians take a sixth
    /// less time than along a curve.
    Strips,
    /// Along a Hilbert curve. 64 successive pedestrians are then close together and see few others: a block of queries
    /// reads 432 keys instead of 1,008.
    Curve,
}

/// Several windows with their goals. The P pedestrians are in the order of the windows; those of a large window are
/// sorted by position.
///
/// Positions are relative to a point of each window, so that tracks in map coordinates keep their precision in `f32`.
#[derive(Debug)]
pub struct ForecastBatch<'a> {
    originals: &'a [Window],
    origins: Vec<Position>,
    /// For each window and each of its rows: the index of the pedestrian in the window.
    orders: Vec<Vec<usize>>,
    /// The windows, relative to their origins.
    pub windows: Vec<Window>,
    /// `[G][P]`, relative to the origin of each pedestrian's window.
    pub goals: Vec<Vec<Position>>,
    /// Share of the network's metric in the metric of a step, `[P]`, 0 to 1; `None` for 1.
    pub shares: Option<Vec<f64>>,
    /// Noise vectors `[H, noise]`; `None` for the expectation over them.
    pub noise: Option<Vec<f64>>,
    /// Number of noise vectors; 1 for the expectation.
    pub noise_vectors: usize,
    /// The integrator.
    pub rule: StepRule,
}

/// Forecast positions of a [`ForecastBatch`].
#[derive(Debug)]
pub struct BatchRollout {
    /// The number of hypotheses H.
    pub hypotheses: usize,
    /// `[12, H, P]`, relative to the origins, metres.
    pub positions: Vec<[f64; 2]>,
    /// `[12, H, P]`: (a, b, c); `None` for the variants without dynamics.
    pub factors: Option<Vec<[f64; 3]>>,
}

/// Batches of at most `at_once` pedestrians, or of one window.
pub(super) fn batches<'a>(
    windows: &'a [Window],
    goals: &[Vec<Vec<Position>>],
    (noise, noise_width): (Noise, usize),
    rule: StepRule,
    shares: Option<&[Vec<f64>]>,
    (at_once, by): (usize, CrowdOrder),
) -> Result<Vec<ForecastBatch<'a>>, NetworkError> {
    check_shares(windows, shares)?;
    let goal_count = check_goals(windows, goals, noise)?;
    let (noise, noise_vectors) = match noise {
        Noise::Expected => (None, 1),
        Noise::Draws { count, seed } => {
            let mut rng = stream(seed, Stage::Forecast, 0);
            let draws = (0..count * noise_width).map(|_| rng.sample(StandardNormal));
            (Some(draws.collect::<Vec<f64>>()), count)
        }
    };
    let mut batches = Vec::new();
    let mut first = 0;
    for originals in Window::parts(windows, at_once) {
        let last = first + originals.len();
        let origins: Vec<Position> = originals.iter().map(origin).collect();
        let orders: Vec<Vec<usize>> = originals.iter().map(|window| order(window, by)).collect();
        let of_goal = |k: usize| {
            let rows = goals[first..last].iter().zip(&origins).zip(&orders);
            rows.flat_map(|((goals, &origin), order)| order.iter().map(move |&i| relative(goals[i][k], origin)))
                .collect()
        };
        // The pedestrians' ids stay in the original order; nothing here reads them.
        let ordered = |((window, &origin), order): ((&Window, &Position), &Vec<usize>)| {
            window.map_positions(|i, t, _| relative(window.track(order[i])[t], origin))
        };
        let of_shares = |shares: &[Vec<f64>]| {
            let rows = shares[first..last].iter().zip(&orders);
            rows.flat_map(|(shares, order)| order.iter().map(|&i| shares[i])).collect()
        };
        batches.push(ForecastBatch {
            windows: originals.iter().zip(&origins).zip(&orders).map(ordered).collect(),
            goals: (0..goal_count).map(of_goal).collect(),
            shares: shares.map(of_shares),
            noise: noise.clone(),
            noise_vectors,
            rule,
            originals,
            origins,
            orders,
        });
        first = last;
    }
    Ok(batches)
}

impl ForecastBatch<'_> {
    /// The number of pedestrians P.
    pub(super) fn pedestrians(&self) -> usize {
        self.windows.iter().map(Window::len).sum()
    }

    /// The number of hypotheses H.
    pub(super) fn hypotheses(&self) -> usize {
        self.goals.len().max(self.noise_vectors)
    }

    pub(super) fn windows_of(&self, rollout: &BatchRollout) -> Vec<WindowRollout> {
        let pedestrians = self.pedestrians();
        let hypotheses = rollout.hypotheses;
        let mut first = 0;
        let windows = self.originals.iter().zip(&self.origins).zip(&self.orders);
        windows
            .map(|((window, [x, y]), order)| {
                let mut rows = vec![0; order.len()];
                for (place, &i) in order.iter().enumerate() {
                    rows[i] = first + place;
                }
                first += order.len();
                let shape = (hypotheses, pedestrians);
                let factors = rollout.factors.as_ref();
                WindowRollout {
                    pedestrians: window.len(),
                    hypotheses,
                    positions: paths(&rollout.positions, &rows, shape, |of| [of[0] + x, of[1] + y]),
                    factors: factors.map(|factors| paths(factors, &rows, shape, |of| of)),
                }
            })
            .collect()
    }
}

/// The paths of some `rows`: from `[12, H, P]` to `[rows, H, 12]`, with `changed` applied to each number.
fn paths<T: Copy + Send + Sync>(
    steps: &[T],
    rows: &[usize],
    (hypotheses, pedestrians): (usize, usize),
    changed: impl Fn(T) -> T + Sync,
) -> Vec<T> {
    let Some(&any) = steps.first() else { return Vec::new() };
    let of_row = hypotheses * HORIZON;
    let mut paths = vec![any; rows.len() * of_row];
    let rows = paths.par_chunks_mut(of_row).zip(rows).with_min_len(64);
    rows.for_each(|(paths, row)| {
        for (h, path) in paths.chunks_mut(HORIZON).enumerate() {
            for (t, number) in path.iter_mut().enumerate() {
                *number = changed(steps[(t * hypotheses + h) * pedestrians + row]);
            }
        }
    });
    paths
}

fn origin(window: &Window) -> Position {
    window.observed(0)[OBSERVED - 1]
}

/// The indices of a window's pedestrians in the order of their rows.
fn order(window: &Window, by: CrowdOrder) -> Vec<usize> {
    let mut order: Vec<usize> = (0..window.len()).collect();
    if window.len() > CROWD {
        let last = |i: usize| window.observed(i)[OBSERVED - 1];
        match by {
            CrowdOrder::Strips => {
                let strip = |i: usize| (last(i)[0] / STRIP).floor();
                order.sort_by(|&i, &j| strip(i).total_cmp(&strip(j)).then_with(|| last(i)[1].total_cmp(&last(j)[1])));
            }
            CrowdOrder::Curve => {
                // Whoever is further than 16 km from the first pedestrian counts as at the edge.
                let cell = |metres: f64| (metres / CELL + f64::from(1 << 15)) as u16;
                order.sort_by_cached_key(|&i| {
                    let [x, y] = relative(last(i), origin(window)).map(cell);
                    fast_hilbert::xy2h(x, y, 16)
                });
            }
        }
    }
    order
}

fn relative(position: Position, origin: Position) -> Position {
    [position[0] - origin[0], position[1] - origin[1]]
}

fn check_shares(windows: &[Window], shares: Option<&[Vec<f64>]>) -> Result<(), NetworkError> {
    let Some(shares) = shares else { return Ok(()) };
    let fault = |got: String| {
        let windows = windows.len();
        let expected = format!("a share from 0 to 1 for every pedestrian of {windows} windows");
        Err(NetworkError::shape("forecast", expected, got))
    };
    if shares.len() != windows.len() {
        return fault(format!("shares of {} windows", shares.len()));
    }
    let mut pairs = windows.iter().zip(shares).enumerate();
    if let Some((w, (window, shares))) = pairs.find(|(_, (window, shares))| window.len() != shares.len()) {
        let pedestrians = window.len();
        return fault(format!("{} for the {pedestrians} of window {w}", shares.len()));
    }
    let is_share = |share: &&f64| (0.0..=1.0).contains(*share);
    match shares.iter().flatten().find(|share| !is_share(share)) {
        Some(share) => fault(share.to_string()),
        None => Ok(()),
    }
}

fn check_goals(windows: &[Window], goals: &[Vec<Vec<Position>>], noise: Noise) -> Result<usize, NetworkError> {
    let fault = |expected: String, got: String| Err(NetworkError::shape("forecast", expected, got));
    if goals.len() != windows.len() {
        return fault(format!("goals of {} windows", windows.len()), goals.len().to_string());
    }
    let count = goals.iter().flatten().map(Vec::len).next().unwrap_or(1);
    for (window, goals) in windows.iter().zip(goals) {
        if goals.len() != window.len() {
            return fault(
                format!("goals of {} pedestrians in {}", window.len(), window.recording()),
                goals.len().to_string(),
            );
        }
        if let Some(other) = goals.iter().find(|goals| goals.len() != count || goals.is_empty()) {
            return fault(format!("{count} goals for every pedestrian"), other.len().to_string());
        }
    }
    match noise {
        Noise::Draws { count: draws, .. } if draws == 0 || (count > 1 && draws > 1) => fault(
            "one goal with several noise vectors, or several goals with one".into(),
            format!("{count} goals, {draws} noise vectors"),
        ),
        _ => Ok(count),
    }
}
