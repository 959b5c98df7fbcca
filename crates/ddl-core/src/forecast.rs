//! A forecast of one window: several weighted hypotheses for every pedestrian.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::error::ForecastShapeError;
use crate::pace::Pace;
use crate::position::{HORIZON, Position};
use crate::region_table::RegionTable;
use crate::window::Window;

/// K weighted hypotheses of 12 positions for each of N pedestrians, in the order of the window.
///
/// Frames are 0.4 s apart; the first follows the last observed one. Hypothesis `k` of all pedestrians is one joint
/// future.
///
/// # Shapes
/// - positions `[N][K][12]`, in metres
/// - weights `[N][K]`; they sum to 1 for each pedestrian
/// - goals `[N][K]`, in metres
/// - certified `[N][K]`: whether the model's certificate that hypothesis `k` goes to its goal holds
/// - spread `[N][12]`, in metres, of a pedestrian around the hypothesis that it follows, and pace `[N]`
/// - familiarity `[N]`, 0 to 1: similarity of the observed motion to the training data
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    pedestrians: usize,
    hypotheses: usize,
    positions: Vec<Position>,
    weights: Vec<f64>,
    goals: Option<Vec<Position>>,
    certified: Option<Vec<bool>>,
    spread: Option<Spread>,
    familiarity: Option<Vec<f64>>,
}

/// How far pedestrians are from the hypotheses that they follow.
///
/// Around hypothesis `k`, `t` + 1 steps ahead, a pedestrian is distributed by Student's t in two dimensions with
/// [`DEGREES`](Self::DEGREES) degrees of freedom; at the distance r (m) its density per square metre is
/// `(1 + r² / (3 s²))^(-5/2) / (2 pi s²)` with the scale s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// `[N][12]`: the scales s, metres.
    pub scales: Vec<f64>,
    /// `[N]`: the paces of the observed motions.
    pub paces: Vec<Pace>,
    /// The table from which regions are made.
    pub regions: Arc<RegionTable>,
}

impl Spread {
    /// Degrees of freedom. The variance on each axis is 3 s².
    pub const DEGREES: f64 = 3.0;
}

impl Forecast {
    /// Largest difference of the sum of weights of a pedestrian from 1.
    pub const WEIGHT_TOLERANCE: f64 = 1e-6;

    /// A forecast from flat arrays; the layout is pedestrian, hypothesis, frame.
    ///
    /// # Errors
    /// An array has the wrong length, a number is not finite, a weight is negative, or the weights of a pedestrian do
    /// not sum to 1 within 1e-6.
    pub fn new(
        pedestrians: usize,
        hypotheses: usize,
        positions: Vec<Position>,
        weights: Vec<f64>,
        goals: Option<Vec<Position>>,
    ) -> Result<Self, ForecastShapeError> {
        if pedestrians == 0 || hypotheses == 0 {
            return Err(ForecastShapeError::Empty { pedestrians, hypotheses });
        }
        let pairs = pedestrians * hypotheses;
        check_length("positions", "pedestrian, hypothesis, frame", pairs * HORIZON, positions.len())?;
        check_length("weights", "pedestrian, hypothesis", pairs, weights.len())?;
        check_finite("positions", &positions, HORIZON, hypotheses)?;
        check_finite("weights", weights.as_chunks::<1>().0, 1, hypotheses)?;
        check_weights(&weights, hypotheses)?;
        if let Some(goals) = &goals {
            check_length("goals", "pedestrian, hypothesis", pairs, goals.len())?;
            check_finite("goals", goals, 1, hypotheses)?;
        }
        Ok(Self {
            pedestrians,
            hypotheses,
            positions,
            weights,
            goals,
            certified: None,
            spread: None,
            familiarity: None,
        })
    }

    /// A forecast whose hypotheses have equal weights, 1/K.
    ///
    /// # Shapes
    /// `positions`: `[N][K][12]`, metres.
    ///
    /// # Errors
    /// As [`Forecast::new`].
    pub fn with_equal_weights(
        pedestrians: usize,
        hypotheses: usize,
        positions: Vec<Position>,
    ) -> Result<Self, ForecastShapeError> {
        let weights = vec![1.0 / hypotheses.max(1) as f64; pedestrians * hypotheses];
        Self::new(pedestrians, hypotheses, positions, weights, None)
    }

    /// Adds whether the certificate of each hypothesis holds, `[N][K]`.
    ///
    /// # Errors
    /// The array has the wrong length.
    pub fn with_certified(self, certified: Vec<bool>) -> Result<Self, ForecastShapeError> {
        check_length("certified", "pedestrian, hypothesis", self.pedestrians * self.hypotheses, certified.len())?;
        Ok(Self { certified: Some(certified), ..self })
    }

    /// Adds the spread around the hypotheses, with the table of regions.
    ///
    /// # Errors
    /// An array has the wrong length, or a scale is not finite and positive.
    pub fn with_spread(self, spread: Spread) -> Result<Self, ForecastShapeError> {
        let Spread { scales, paces, .. } = &spread;
        check_length("spread", "pedestrian, frame", self.pedestrians * HORIZON, scales.len())?;
        check_length("pace", "pedestrian", self.pedestrians, paces.len())?;
        check_range("spread", scales, HORIZON, f64::MAX)?;
        Ok(Self { spread: Some(spread), ..self })
    }

    /// Adds the familiarity of each pedestrian's observed motion, `[N]`, 0 to 1.
    ///
    /// # Errors
    /// The array has the wrong length, or a number is not above 0 and at most 1.
    pub fn with_familiarity(self, familiarity: Vec<f64>) -> Result<Self, ForecastShapeError> {
        check_length("familiarity", "pedestrian", self.pedestrians, familiarity.len())?;
        check_range("familiarity", &familiarity, 1, 1.0)?;
        Ok(Self { familiarity: Some(familiarity), ..self })
    }

    /// Scale of Student's t (metres) of pedestrian `i`, `t` + 1 steps ahead, around the hypothesis that it follows, if
    /// known; see [`Spread`].
    pub fn scale(&self, i: usize, t: usize) -> Option<f64> {
        Some(self.spread.as_ref()?.scales[i * HORIZON..][..HORIZON][t])
    }

    /// The pace of pedestrian `i`, for which its regions hold; `None` for forecasts without a [spread](Spread).
    pub fn pace(&self, i: usize) -> Option<Pace> {
        self.spread.as_ref().map(|spread| spread.paces[i])
    }

    /// The table of its regions; `None` for forecasts without a [spread](Spread).
    pub fn regions(&self) -> Option<&RegionTable> {
        self.spread.as_ref().map(|spread| spread.regions.as_ref())
    }

    pub(crate) fn shared_regions(&self) -> Option<Arc<RegionTable>> {
        let spread = self.spread.as_ref()?;
        Some(Arc::clone(&spread.regions))
    }

    /// The same forecast with another table of regions; unchanged without a spread.
    pub(crate) fn with_regions(mut self, regions: &Arc<RegionTable>) -> Self {
        if let Some(spread) = &mut self.spread {
            spread.regions = Arc::clone(regions);
        }
        self
    }

    /// The same forecast with the weights of each pedestrian raised to the power of its pace, then divided by their
    /// sum; unchanged without a spread.
    pub(crate) fn with_powers(mut self, power: impl Fn(Pace) -> f64) -> Self {
        let paces = self.spread.iter().flat_map(|spread| &spread.paces);
        for (weights, &pace) in self.weights.chunks_exact_mut(self.hypotheses).zip(paces) {
            let power = power(pace);
            let raised: Vec<f64> = weights.iter().map(|weight| weight.powf(power)).collect();
            let sum: f64 = raised.iter().sum();
            for (weight, raised) in weights.iter_mut().zip(raised) {
                *weight = raised / sum;
            }
        }
        self
    }

    /// The same forecast, where pedestrian `i` follows these 12 positions (m) in every hypothesis, without a
    /// certificate.
    #[must_use]
    pub fn with_path(mut self, i: usize, path: &[Position; HORIZON]) -> Self {
        for k in 0..self.hypotheses {
            let pair = self.pair(i, k);
            self.positions[pair * HORIZON..][..HORIZON].copy_from_slice(path);
            if let Some(goals) = &mut self.goals {
                goals[pair] = path[HORIZON - 1];
            }
            if let Some(certified) = &mut self.certified {
                certified[pair] = false;
            }
        }
        self
    }

    /// Similarity of the observed motion of pedestrian `i` to the training data, 0 to 1; `None` if unknown.
    pub fn familiarity(&self, i: usize) -> Option<f64> {
        self.familiarity.as_ref().map(|familiarity| familiarity[i])
    }

    /// Number of pedestrians, N.
    pub fn pedestrians(&self) -> usize {
        self.pedestrians
    }

    /// Number of hypotheses of each pedestrian, K.
    pub fn hypotheses(&self) -> usize {
        self.hypotheses
    }

    /// The 12 positions of hypothesis `k` of pedestrian `i`, metres.
    pub fn hypothesis(&self, i: usize, k: usize) -> &[Position] {
        let start = self.pair(i, k) * HORIZON;
        &self.positions[start..start + HORIZON]
    }

    /// The weight of hypothesis `k` of pedestrian `i`, in [0, 1].
    pub fn weight(&self, i: usize, k: usize) -> f64 {
        self.weights[self.pair(i, k)]
    }

    /// The goal of hypothesis `k` of pedestrian `i`, metres; `None` for forecasts without goals.
    pub fn goal(&self, i: usize, k: usize) -> Option<Position> {
        let pair = self.pair(i, k);
        self.goals.as_ref().map(|goals| goals[pair])
    }

    /// Whether every hypothesis names its goal.
    pub fn has_goals(&self) -> bool {
        self.goals.is_some()
    }

    /// Whether the certificate of hypothesis `k` of pedestrian `i` holds; `None` without certificates.
    pub fn certified(&self, i: usize, k: usize) -> Option<bool> {
        let pair = self.pair(i, k);
        self.certified.as_ref().map(|certified| certified[pair])
    }

    /// The hypothesis of pedestrian `i` with the largest weight; of equal weights, the first.
    pub fn most_likely(&self, i: usize) -> usize {
        (1..self.hypotheses).fold(0, |best, k| if self.weight(i, k) > self.weight(i, best) { k } else { best })
    }

    /// Only the [representative](Self::representative) hypothesis of each pedestrian, with the weight 1.
    #[must_use]
    pub fn single(&self) -> Self {
        let chosen: Vec<usize> = (0..self.pedestrians).map(|i| self.representative(i)).collect();
        let rows = || chosen.iter().enumerate();
        Self {
            pedestrians: self.pedestrians,
            hypotheses: 1,
            positions: rows().flat_map(|(i, &k)| self.hypothesis(i, k)).copied().collect(),
            weights: vec![1.0; self.pedestrians],
            goals: rows().map(|(i, &k)| self.goal(i, k)).collect(),
            certified: rows().map(|(i, &k)| self.certified(i, k)).collect(),
            // The spread is around one of many hypotheses, not around the representative one.
            spread: None,
            familiarity: self.familiarity.clone(),
        }
    }

    /// The forecasts of the given pedestrians, at least one, in the given order; an index out of range panics.
    #[must_use]
    pub fn of_pedestrians(&self, pedestrians: &[usize]) -> Self {
        fn rows<T: Copy>(values: &[T], per_pedestrian: usize, pedestrians: &[usize]) -> Vec<T> {
            let row = |&i: &usize| &values[i * per_pedestrian..(i + 1) * per_pedestrian];
            pedestrians.iter().flat_map(row).copied().collect()
        }
        let k = self.hypotheses;
        Self {
            pedestrians: pedestrians.len(),
            hypotheses: k,
            positions: rows(&self.positions, k * HORIZON, pedestrians),
            weights: rows(&self.weights, k, pedestrians),
            goals: self.goals.as_ref().map(|goals| rows(goals, k, pedestrians)),
            certified: self.certified.as_ref().map(|certified| rows(certified, k, pedestrians)),
            spread: self.spread.as_ref().map(|spread| Spread {
                scales: rows(&spread.scales, HORIZON, pedestrians),
                paces: rows(&spread.paces, 1, pedestrians),
                regions: Arc::clone(&spread.regions),
            }),
            familiarity: self.familiarity.as_ref().map(|familiarity| rows(familiarity, 1, pedestrians)),
        }
    }

    /// The forecasts of the pedestrians of the window, without its [bystanders](Window::with_bystanders).
    #[must_use]
    pub fn without_bystanders(self, window: &Window) -> Self {
        if self.pedestrians == window.len() {
            return self;
        }
        self.of_pedestrians(&window.indices_in_scene())
    }

    fn pair(&self, i: usize, k: usize) -> usize {
        assert!(
            i < self.pedestrians && k < self.hypotheses,
            "pedestrian {i}, hypothesis {k} of a forecast of {} x {}",
            self.pedestrians,
            self.hypotheses
        );
        i * self.hypotheses + k
    }
}

fn check_length(
    field: &'static str,
    layout: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), ForecastShapeError> {
    if expected == found {
        return Ok(());
    }
    Err(ForecastShapeError::Length { field, layout, expected, found })
}

/// Whether all numbers are above 0 and at most `most`.
fn check_range(
    field: &'static str,
    numbers: &[f64],
    per_pedestrian: usize,
    most: f64,
) -> Result<(), ForecastShapeError> {
    // False for NaN.
    match numbers.iter().position(|&x| !(x > 0.0 && x <= most)) {
        None => Ok(()),
        Some(index) => {
            Err(ForecastShapeError::OutOfRange { field, pedestrian: index / per_pedestrian, value: numbers[index] })
        }
    }
}

fn check_finite<const D: usize>(
    field: &'static str,
    positions: &[[f64; D]],
    per_pair: usize,
    hypotheses: usize,
) -> Result<(), ForecastShapeError> {
    match positions.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        None => Ok(()),
        Some(index) => {
            let pair = index / per_pair;
            let (pedestrian, hypothesis) = (pair / hypotheses, pair % hypotheses);
            Err(ForecastShapeError::NotFinite { field, pedestrian, hypothesis })
        }
    }
}

fn check_weights(weights: &[f64], hypotheses: usize) -> Result<(), ForecastShapeError> {
    for (pedestrian, row) in weights.chunks_exact(hypotheses).enumerate() {
        for (hypothesis, &weight) in row.iter().enumerate() {
            if weight < 0.0 {
                return Err(ForecastShapeError::NegativeWeight { pedestrian, hypothesis, weight });
            }
        }
        let sum: f64 = row.iter().sum();
        if (sum - 1.0).abs() > Forecast::WEIGHT_TOLERANCE {
            return Err(ForecastShapeError::NotNormalised { pedestrian, sum });
        }
    }
    Ok(())
}
