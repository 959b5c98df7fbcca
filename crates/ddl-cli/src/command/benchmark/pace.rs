//! Which part of a task's time has passed at a point of one of its stages.

/// The parts of the time at which the goals are made, and at which the training has ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pace {
    goals: f64,
    training: f64,
}

impl Pace {
    pub(super) fn of_seconds(goals: f64, training: f64, scores: f64) -> Self {
        let whole = goals + training + scores;
        Self {
            goals: goals / whole,
            training: (goals + training) / whole,
        }
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
fn the_time_left_is_right_within_a_factor_of_two() {
    use super::profile::Profile;
    use crate::command::recipe::Recipe;
    // Seconds of goals, training and scores: measured with smoke on simulated crowds, and with quick and paper on star
    // recordings; the last is univ, whose test windows are ten times as many.
    for (profile, seconds) in [
        (Profile::Smoke, [24.0, 4.0, 10.0]),
        (Profile::Quick, [243.0, 29.0, 22.0]),
        (Profile::Paper, [243.0, 58.0, 21.0]),
        (Profile::Paper, [243.0, 40.0, 215.0]),
    ] {
        let pace = profile.pace(Recipe::Recommended);
        let whole: f64 = seconds.iter().sum();
        let mut before = 0.0;
        for (stage, seconds) in ["goals", "train", "evaluate"].into_iter().zip(seconds) {
            for part in [0.1, 0.3, 0.5, 0.7] {
                let (passed, reached) = (before + part * seconds, pace.at(stage, part));
                let (left, estimate) = (whole - passed, passed * (1.0 - reached) / reached);
                assert!(
                    (0.5..2.0).contains(&(estimate / left)),
                    "{profile} {stage} {part}: {estimate} for {left}"
                );
            }
            before += seconds;
        }
    }
}
