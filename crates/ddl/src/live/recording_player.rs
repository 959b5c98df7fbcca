//! A page that plays the forecasts of a recording.

use crate::error::DdlError;
use crate::forecast::answer::Answer;
use crate::model::ddl::Ddl;
use crate::note::Note;
use crate::tracks::moment::Moment;
use crate::tracks::unfamiliar::UnfamiliarMotions;
use ddl_core::{Forecaster as _, OBSERVED, Window};
use ddl_data::{Clock, PlausibilityWarning, Recording};
use ddl_eval::EvaluationError;
use ddl_report::ForecastSnapshot;
use ddl_report::page::Viewer;

/// A self-contained HTML page that plays forecasts for some windows of a recording.
#[derive(Debug)]
pub struct RecordingPlayer<'a> {
    /// The model of the forecasts.
    pub model: &'a Ddl,
    /// The recording, which holds the true paths.
    pub recording: &'a Recording,
    /// The observed windows of the recording.
    pub windows: &'a [Window],
    /// Largest number of windows to play.
    pub most: usize,
}

impl RecordingPlayer<'_> {
    /// The windows to forecast, evenly spread.
    pub fn shown(&self) -> Vec<Window> {
        let count = self.windows.len().min(self.most);
        let last = |k: usize| k * self.windows.len() / count - 1;
        (1..=count).map(|k| self.windows[last(k)].clone()).collect()
    }

    /// A warning of motions unlike the training motions; arguments as those of [`to_html`](Self::to_html).
    pub fn unfamiliar(&self, answers: &[Answer], clock: Clock) -> Option<Note> {
        let (shown, mut motions) = (self.shown(), UnfamiliarMotions::default());
        for (window, answer) in shown.iter().zip(answers) {
            motions.add(&[Moment::new(window, answer, clock)]);
        }
        motions.warning()
    }

    /// The page, from one answer for each window in [`shown`](Self::shown). `name` is the title of the recording,
    /// `warning` describes a fault of it, and `clock` is that of its frames or times.
    ///
    /// # Errors
    /// [`DdlError::Evaluation`] or [`DdlError::Report`] if a forecast does not fit its window, or if there are none.
    pub fn to_html(
        &self,
        answers: &[Answer],
        name: &str,
        warning: Option<&PlausibilityWarning>,
        clock: Clock,
    ) -> Result<String, DdlError> {
        let (model, recording, shown) = (self.model, self.recording, self.shown());
        let futures = recording.futures();
        let moments = shown.iter().zip(answers).map(|(window, answer)| {
            let seen = futures.after(window);
            let mut moment = ForecastSnapshot::under_way(model.name(), window, answer.forecast(), &seen)?;
            moment.frame = clock.number(moment.frame).nearest();
            moment.when = Some(clock.words(window.frames()[OBSERVED - 1]));
            if let Ok(futures) = answer.futures() {
                moment.joint = true;
                moment.groups = futures.groups().to_vec();
            }
            Ok(moment)
        });
        let moments: Vec<ForecastSnapshot> = moments.collect::<Result<_, EvaluationError>>()?;
        let warning = warning.map(|warning| format!("Doubtful: {warning} "));
        let paths = if answers.iter().any(Answer::is_joint) {
            "its true path as far as it was observed, and joint futures of all for the next 4.8 s"
        } else {
            "its forecast for the next 4.8 s, and its true path as far as it was observed"
        };
        let lead = format!(
            "{}{} of {} moments of {name}: the observed path of each pedestrian, {paths}.",
            warning.unwrap_or_default(),
            shown.len(),
            self.windows.len()
        );
        let mut notes = vec![format!(
            "Forecaster: {}; model {}. Goals: {}.",
            model.name(),
            model.source(),
            model.goal_model().words()
        )];
        notes.extend(certificates(answers));
        notes.extend(self.unfamiliar(answers, clock).map(|warning| warning.line() + "."));
        let viewer = Viewer { title: recording.name(), lead: &lead, notes: &notes, moments: &moments };
        Ok(viewer.to_html()?)
    }
}

fn certificates(answers: &[Answer]) -> Option<String> {
    let mut verdicts = Vec::new();
    for forecast in answers.iter().map(Answer::forecast) {
        for i in 0..forecast.pedestrians() {
            verdicts.extend((0..forecast.hypotheses()).filter_map(|k| forecast.certified(i, k)));
        }
    }
    let held = verdicts.iter().filter(|&&holds| holds).count();
    (!verdicts.is_empty()).then(|| {
        format!(
        "Certificates: {held} of {} hypotheses approach their goal at each of the 12 steps, along a flow that descends \
         everywhere. This proves that the forecasts are stable, not that they are accurate.",
            verdicts.len()
        )
    })
}
