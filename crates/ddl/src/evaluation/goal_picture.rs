//! A picture of the goals of typical pedestrians.

use crate::error::DdlError;
use crate::evaluation::goals::GoalEvaluation;
use crate::goals::model::GoalModel;
use ddl_core::{ForecastError, WeightedGoals};
use ddl_data::Window;
use ddl_eval::MotionKind;
use ddl_goal::GoalSet;
use ddl_report::figure::{self, GoalCase};

/// Retrieved pedestrians to draw: the most similar ones.
const EXPERTS: usize = 60;

/// An SVG of typical pedestrians: the observation, the retrieved pedestrians where available, the goals, and the true
/// future.
///
/// # Errors
/// When these goals cannot be drawn.
pub fn goal_picture(model: &GoalModel, evaluation: &GoalEvaluation) -> Result<String, DdlError> {
    let pedestrians: Vec<PicturedPedestrian<'_>> = evaluation
        .measured_windows
        .iter()
        .zip(&evaluation.sets)
        .flat_map(|(window, sets)| {
            (0..)
                .zip(sets)
                .filter_map(|(i, set)| PicturedPedestrian::new(window, i, set))
        })
        .collect();
    let mut shown: Vec<&PicturedPedestrian<'_>> = Vec::new();
    for kind in MotionKind::ALL {
        // Each pedestrian only once.
        let mut candidates: Vec<&PicturedPedestrian<'_>> = pedestrians
            .iter()
            .filter(|pedestrian| pedestrian.kind == kind && !shown.iter().any(|other| other.is(pedestrian)))
            .collect();
        candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
        // Of an even number the lower of the two in the middle.
        shown.extend(candidates.get(candidates.len().saturating_sub(1) / 2));
    }
    let cases = shown
        .into_iter()
        .map(|pedestrian| pedestrian.case(model))
        .collect::<Result<Vec<_>, _>>()?;
    let title = format!(
        "Goals of pedestrians with the median error of their kind of motion: fold {}, {}",
        evaluation.fold, evaluation.windows
    );
    Ok(figure::goals(&title, &cases)?)
}

struct PicturedPedestrian<'a> {
    window: &'a Window,
    index: usize,
    set: &'a GoalSet,
    kind: MotionKind,
    error: f64,
}

impl<'a> PicturedPedestrian<'a> {
    fn new(window: &'a Window, index: usize, set: &'a GoalSet) -> Option<Self> {
        let end = window.end(index)?;
        let [x, y] = set.goals()[set.nearest(end)];
        Some(Self {
            window,
            index,
            set,
            kind: MotionKind::of(window.track(index))?,
            error: (x - end[0]).hypot(y - end[1]),
        })
    }

    fn is(&self, other: &Self) -> bool {
        self.window.recording() == other.window.recording()
            && self.window.pedestrians()[self.index] == other.window.pedestrians()[other.index]
    }

    fn case(&self, model: &GoalModel) -> Result<GoalCase, DdlError> {
        let title = format!(
            "{}, frame {}, no. {}: {}",
            self.window.recording(),
            self.window.start_frame(),
            self.window.pedestrians()[self.index],
            self.kind
        );
        let observed = self.window.observed(self.index);
        let experts = match model.estimator() {
            None => Vec::new(),
            Some(estimator) => estimator
                .estimate(observed)?
                .experts()
                .iter()
                .take(EXPERTS)
                .map(|expert| estimator.transfer_track(expert, observed))
                .collect::<Result<Vec<_>, _>>()?,
        };
        let goals =
            WeightedGoals::new(self.set.goals().to_vec(), self.set.weights().to_vec()).map_err(ForecastError::from)?;
        let track = self.window.track(self.index);
        Ok(GoalCase::new(title, track, goals, experts)?)
    }
}
