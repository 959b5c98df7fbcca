//! Goals that stand for many weighted ends, wherever the ends come from.

use crate::choice::choose;
use crate::error::GoalError;
use crate::goal_set::GoalSet;
use crate::heading::HeadingFrame;
use crate::points::{Points, is_in_range};

/// Steps of Lloyd's iteration.
const STEPS: usize = 10;

impl GoalSet {
    /// `clusters` goals such that the weighted mean distance of an end to the nearest goal is small.
    ///
    /// Cells of ends are cut in two, the costliest first, and steps of Lloyd's iteration follow; nothing is random. A
    /// goal's weight is the sum of the weights of the ends nearest to it.
    ///
    /// # Shapes
    /// `ends` (m, in the walker's `frame`) and `weights` (not negative, not all 0): as many of each, at least one. Fewer
    /// distinct ends than goals: goals are repeated, with weight 0.
    ///
    /// # Errors
    /// [`GoalError::Ends`] when the lists do not fit, and when an end or weight is not finite or out of range.
    ///
    /// # Examples
    /// ```
    /// use ddl_goal::{GoalSet, HeadingFrame};
    /// let frame = HeadingFrame::new(&[[0.0, 0.0], [0.0, 1.0]])?; // heading along y
    /// let ends = [[4.0, 0.0], [4.0, 1.0], [9.0, 0.0]];
    /// let set = GoalSet::of_ends(&frame, &ends, &[0.25, 0.25, 0.5], 2)?;
    /// assert_eq!(set.weights(), [0.5, 0.5]);
    /// assert!(set.goals().contains(&[0.0, 10.0])); // 9 m ahead of [0, 1]
    /// # Ok::<(), ddl_goal::GoalError>(())
    /// ```
    pub fn of_ends(
        frame: &HeadingFrame,
        ends: &[[f64; 2]],
        weights: &[f64],
        clusters: usize,
    ) -> Result<Self, GoalError> {
        let wrong = |problem: String| Err(GoalError::Ends { problem });
        if ends.is_empty() || ends.len() != weights.len() || clusters == 0 {
            let (ends, weights) = (ends.len(), weights.len());
            return wrong(format!(
                "{ends} ends with {weights} weights for {clusters} goals: need as many weights as ends, and at least \
                 one end and one goal"
            ));
        }
        let total: f64 = weights.iter().sum();
        if !(total.is_finite() && total > 0.0 && weights.iter().all(|&weight| weight >= 0.0)) {
            return wrong(format!(
                "the weights sum to {total}: they must be finite, not negative, and not all 0"
            ));
        }
        let mut points = Points::default();
        for (index, (&end, weight)) in ends.iter().zip(weights).enumerate() {
            if !is_in_range(end) {
                return wrong(format!("end {index} is ({}, {})", end[0], end[1]));
            }
            // the share may be 0 where the weight is not
            let share = weight / total;
            if share > 0.0 {
                points.push(end, share);
            }
        }
        let choice = choose(&points, clusters, STEPS);
        let goals: Vec<_> = choice
            .goals
            .iter()
            .map(|&end| frame.to_world(end))
            .collect();
        Ok(Self::new(goals, choice.weights, Vec::new()))
    }
}
