//! Forecasts of whole windows, free of tensors: what the facade calls.

use crate::StarError;
use crate::batch::SceneBatch;
use crate::emission::NoiseInput;
use crate::flow::StepRule;
use crate::seed::{Stage, stream};
use crate::star::StarNetwork;
use ddl_data::{HORIZON, OBSERVED, Position, Window};
use rand::RngExt as _;
use rand_distr::StandardNormal;
use tch::Tensor;

/// Windows are rolled out together until they hold this many walkers: enough to fill the products, few enough for
/// the tokens of their hypotheses to stay near the processor.
const WALKERS_AT_ONCE: usize = 64;

/// What the output layer is told besides the walkers' tokens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// None: the expectation over the noise, of the metric P for the variants with dynamics, of the
    /// position for the others. One forecast a goal.
    Expected,
    /// That many vectors from N(0, 1), seeded: as many hypotheses on one goal.
    Draws {
        /// Number of vectors.
        count: usize,
        /// Seed of their stream.
        seed: u64,
    },
}

/// Forecast positions of one window.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WindowRollout {
    /// N, in the order of the window.
    pub pedestrians: usize,
    /// H hypotheses a pedestrian.
    pub hypotheses: usize,
    /// `[N][H][12]`, metres.
    pub positions: Vec<Position>,
    /// `[N][H][12]`: (a, b, c) of L = [[a, 0], [b, c]], in (m/s)^(1/2), with which each position was
    /// reached from the one before; `None` for the variants without dynamics.
    pub factors: Option<Vec<[f64; 3]>>,
}

impl StarNetwork {
    /// Forecasts 12 frames for every pedestrian of every window, without touching the future.
    ///
    /// # Shapes
    /// `goals[w][i]` holds the goals of pedestrian i of window w, as many for every pedestrian; one
    /// hypothesis a goal, or, with a single goal, one a noise vector. `shares[w][i]`, 0 to 1, is the share of the network's
    /// metric in what shapes the bounded steps of pedestrian i; all of it where there are none.
    ///
    /// # Errors
    /// [`StarError::Shape`] when the goals do not fit the windows, or several goals meet several
    /// noise vectors; [`StarError::Torch`] when libtorch fails.
    pub fn forecast_windows(
        &self,
        windows: &[Window],
        goals: &[Vec<Vec<Position>>],
        noise: Noise,
        rule: StepRule,
        shares: Option<&[Vec<f64>]>,
    ) -> Result<Vec<WindowRollout>, StarError> {
        check_shares(windows, shares)?;
        let goal_count = check_goals(windows, goals, noise)?;
        let _guard = tch::no_grad_guard();
        let noise = self.noise(noise);
        let mut rollouts = Vec::with_capacity(windows.len());
        let mut first = 0;
        while first < windows.len() {
            let mut last = first;
            let mut walkers = 0;
            while last < windows.len()
                && (walkers == 0 || walkers + windows[last].len() <= WALKERS_AT_ONCE)
            {
                walkers += windows[last].len();
                last += 1;
            }
            let range = first..last;
            rollouts.extend(self.forecast_batch(
                &windows[range.clone()],
                (&goals[range.clone()], goal_count),
                &noise,
                rule,
                shares.map(|shares| &shares[range]),
            )?);
            first = last;
        }
        Ok(rollouts)
    }

    fn forecast_batch(
        &self,
        windows: &[Window],
        (goals, goal_count): (&[Vec<Vec<Position>>], usize),
        noise: &NoiseInput,
        rule: StepRule,
        shares: Option<&[Vec<f64>]>,
    ) -> Result<Vec<WindowRollout>, StarError> {
        // The network sees differences of positions only. They are taken in f64 here, from a point of
        // each scene, so that tracks in map coordinates lose nothing in f32.
        let origins: Vec<Position> = windows.iter().map(origin).collect();
        let local: Vec<Window> = windows
            .iter()
            .zip(&origins)
            .map(|(window, &origin)| window.map_positions(|_, _, p| relative(p, origin)))
            .collect();
        let views: Vec<&Window> = local.iter().collect();
        let half_box = self.config().neighbour_box;
        let mut batch = SceneBatch::new(
            &views,
            OBSERVED,
            OBSERVED,
            half_box,
            self.device(),
            self.kind(),
        )?;
        let walkers = batch.walkers();
        if let Some(shares) = shares {
            batch.share = Tensor::from_slice(&shares.concat())
                .f_reshape([1, walkers as i64, 1])?
                .f_to_kind(self.kind())?
                .f_to_device(self.device())?;
        }
        let mut flat = Vec::with_capacity(goal_count * walkers * 2);
        for k in 0..goal_count {
            for (goals, &origin) in goals.iter().zip(&origins) {
                flat.extend(goals.iter().flat_map(|goals| relative(goals[k], origin)));
            }
        }
        let shape = [goal_count as i64, walkers as i64, 2];
        let goals = Tensor::from_slice(&flat)
            .f_reshape(shape)?
            .f_to_kind(self.kind())?
            .f_to_device(self.device())?;
        let rollout = self.roll_out(&batch, &goals, noise, HORIZON, rule);
        let hypotheses = rollout.positions.size()[1] as usize;
        let mut positions = ordered(&rollout.positions)?.into_iter();
        let mut factors = match &rollout.factors {
            None => None,
            Some(factors) => Some(ordered(factors)?.into_iter()),
        };
        Ok(windows
            .iter()
            .zip(origins)
            .map(|(window, [x, y])| {
                let count = window.len() * hypotheses * HORIZON;
                WindowRollout {
                    pedestrians: window.len(),
                    hypotheses,
                    positions: positions
                        .by_ref()
                        .take(count)
                        .map(|p: Position| [p[0] + x, p[1] + y])
                        .collect(),
                    factors: factors
                        .as_mut()
                        .map(|factors| factors.by_ref().take(count).collect()),
                }
            })
            .collect())
    }

    fn noise(&self, noise: Noise) -> NoiseInput {
        let Noise::Draws { count, seed } = noise else {
            return NoiseInput::Expected;
        };
        let width = self.config().noise_width as usize;
        let mut rng = stream(seed, Stage::Forecast, 0);
        let values: Vec<f64> = (0..count * width)
            .map(|_| rng.sample(StandardNormal))
            .collect();
        let draws = Tensor::from_slice(&values)
            .reshape([count as i64, width as i64])
            .to_kind(self.kind())
            .to_device(self.device());
        NoiseInput::Draws(draws)
    }
}

/// The numbers of a rollout, walker by walker.
///
/// # Shapes
/// `[T, H, P, N]` -> `[P][H][T]` arrays of N.
fn ordered<const N: usize>(rollout: &Tensor) -> Result<Vec<[f64; N]>, StarError> {
    let ordered = rollout
        .permute([2, 1, 0, 3])
        .to_kind(tch::Kind::Double)
        .contiguous();
    let numbers: Vec<f64> = Vec::try_from(ordered.reshape([-1]))?;
    let (groups, _) = numbers.as_chunks::<N>();
    Ok(groups.to_vec())
}

/// A point of the scene: where the first pedestrian was last observed.
fn origin(window: &Window) -> Position {
    window.observed(0)[OBSERVED - 1]
}

fn relative(position: Position, origin: Position) -> Position {
    [position[0] - origin[0], position[1] - origin[1]]
}

fn check_shares(windows: &[Window], shares: Option<&[Vec<f64>]>) -> Result<(), StarError> {
    let Some(shares) = shares else {
        return Ok(());
    };
    let fault = |got: String| {
        let windows = windows.len();
        Err(StarError::Shape {
            operation: "forecast",
            expected: format!("a share from 0 to 1 for every pedestrian of {windows} windows"),
            got,
        })
    };
    let lengths = windows.iter().map(Window::len);
    if !lengths.eq(shares.iter().map(Vec::len)) {
        return fault(format!("those of {}", shares.len()));
    }
    let is_share = |share: &&f64| (0.0..=1.0).contains(*share);
    match shares.iter().flatten().find(|share| !is_share(share)) {
        Some(share) => fault(share.to_string()),
        None => Ok(()),
    }
}

fn check_goals(
    windows: &[Window],
    goals: &[Vec<Vec<Position>>],
    noise: Noise,
) -> Result<usize, StarError> {
    let fault = |expected: String, got: String| {
        Err(StarError::Shape {
            operation: "forecast",
            expected,
            got,
        })
    };
    if goals.len() != windows.len() {
        return fault(
            format!("goals of {} windows", windows.len()),
            goals.len().to_string(),
        );
    }
    let count = goals.iter().flatten().map(Vec::len).next().unwrap_or(1);
    for (window, goals) in windows.iter().zip(goals) {
        if goals.len() != window.len() {
            return fault(
                format!(
                    "goals of {} pedestrians in {}",
                    window.len(),
                    window.recording()
                ),
                goals.len().to_string(),
            );
        }
        if let Some(other) = goals
            .iter()
            .find(|goals| goals.len() != count || goals.is_empty())
        {
            return fault(
                format!("{count} goals for every pedestrian"),
                other.len().to_string(),
            );
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
