//! Which part of a task's time has passed at a point of one of its stages.

/// The parts of the time at which the goals are made, and at which the training has ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TaskPace {
    goals: f64,
    training: f64,
}

impl TaskPace {
    pub(super) fn of_seconds(goals: f64, training: f64, scores: f64) -> Self {
        let whole = goals + training + scores;
        Self { goals: goals / whole, training: (goals + training) / whole }
    }

    /// For a task that takes the goals of another one.
    pub(super) fn without_goals(self) -> Self {
        Self::of_seconds(0.0, self.training - self.goals, 1.0 - self.training)
    }

    /// The part that has passed, from 0 to 1, at this part of a stage of the program.
    pub(super) fn at(self, stage: &str, part: f64) -> f64 {
        let (from, to) = match stage {
            "goals" => (0.0, self.goals),
            "train" => (self.goals, self.training),
            _ => (self.training, 1.0),
        };
        from + (to - from) * part
    }
}

#[test]
fn the_part_grows_from_0_to_1() {
    let pace = TaskPace::of_seconds(243.0, 58.0, 65.0);
    for pace in [pace, pace.without_goals()] {
        let stages = ["goals", "train", "evaluate"].into_iter();
        let parts: Vec<f64> = stages.flat_map(|stage| [0.0, 0.5, 1.0].map(|part| pace.at(stage, part))).collect();
        assert!(parts.is_sorted() && (parts[0], parts[8]) == (0.0, 1.0), "{parts:?}");
    }
    assert!((pace.without_goals().at("train", 1.0) - 58.0 / 123.0).abs() < 1e-12);
}
