//! Possible goals of one pedestrian.

use crate::error::ForecastShapeError;
use crate::position::Position;

/// Possible goals of a pedestrian (metres) and their probabilities.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightedGoals {
    goals: Vec<Position>,
    weights: Vec<f64>,
}

impl WeightedGoals {
    /// Goals with their weights. [`Forecast::new`](crate::Forecast::new) checks later that they sum to 1.
    ///
    /// # Errors
    /// There are no goals, or not as many weights as goals.
    pub fn new(goals: Vec<Position>, weights: Vec<f64>) -> Result<Self, ForecastShapeError> {
        if goals.is_empty() {
            return Err(ForecastShapeError::Empty { pedestrians: 1, hypotheses: 0 });
        }
        if goals.len() != weights.len() {
            return Err(ForecastShapeError::Length {
                field: "weights",
                layout: "one a goal",
                expected: goals.len(),
                found: weights.len(),
            });
        }
        Ok(Self { goals, weights })
    }

    /// One certain goal (m).
    pub fn certain(goal: Position) -> Self {
        Self { goals: vec![goal], weights: vec![1.0] }
    }

    /// The goals, metres.
    pub fn goals(&self) -> &[Position] {
        &self.goals
    }

    /// The weights, in the order of the goals.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }
}
