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
    // Seconds of goals, training and scores for each task: measured with smoke on simulated crowds, and with quick and
    // paper on star recordings, where univ has ten times as many test windows as zara1.
    let zara = [243.0, 58.0, 21.0];
    for (profile, tasks) in [
        (Profile::Smoke, vec![[24.0, 4.0, 10.0]; 2]),
        (Profile::Quick, vec![[243.0, 29.0, 22.0]; 5]),
        (Profile::Paper, vec![zara, zara, [243.0, 58.0, 240.0], zara, zara]),
    ] {
        let pace = profile.pace(Recipe::Recommended);
        // Two at a time.
        let mut free = [0.0_f64; 2];
        let starts: Vec<f64> = tasks
            .iter()
            .map(|task| {
                free.sort_by(f64::total_cmp);
                let start = free[0];
                free[0] += task.iter().sum::<f64>();
                start
            })
            .collect();
        let end = free[0].max(free[1]);
        for percent in (5..95).step_by(5) {
            let now = end * f64::from(percent) / 100.0;
            let reached = |(task, start): (&[f64; 3], &f64)| {
                let mut from = *start;
                let mut reached = 0.0;
                for (stage, seconds) in ["goals", "train", "evaluate"].into_iter().zip(task) {
                    if now > from {
                        reached = pace.at(stage, ((now - from) / seconds).min(1.0));
                    }
                    from += seconds;
                }
                reached
            };
            let reached = tasks.iter().zip(&starts).map(reached).sum::<f64>() / tasks.len() as f64;
            let (left, estimate) = (end - now, now * (1.0 - reached) / reached);
            assert!(
                (0.5..2.0).contains(&(estimate / left)),
                "{profile} at {percent} %: {estimate} for {left} s"
            );
        }
    }
}
