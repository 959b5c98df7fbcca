//! What is said when `ddl train` has come to its end.

use super::super::{RecordingsAt, Reporting};
use crate::output::{self, shell_word};
use crate::progress::ProgressMode;
use ddl::data::Fold;
use ddl::{TrainingRequest, TrainingStage, best_epoch};
use serde_json::json;

/// Tells what has come of it, and what to do next.
pub(super) fn print(
    request: &TrainingRequest,
    recordings: &RecordingsAt,
    reporting: &Reporting,
) -> anyhow::Result<()> {
    let run = request.out.path();
    let epochs = request.out.metrics()?;
    let best = best_epoch(&epochs).and_then(|best| Some((best.validation?, best.epoch)));
    let only_goals = request.until == TrainingStage::Goals && !request.out.is_trained();
    if reporting.json {
        let last = epochs.last().map(|epoch| epoch.epoch);
        return output::print_json(&json!({
            "run": run,
            "trained": !only_goals,
            "epochs": epochs,
            "kept_epoch": best.map_or(last, |(_, epoch)| Some(epoch)),
            "validation_min_ade": best.map(|(error, _)| error),
        }));
    }
    if reporting.progress == ProgressMode::Json {
        return Ok(());
    }
    let run = run.display();
    let epochs = match epochs.len() {
        1 => "1 epoch".to_owned(),
        count => format!("{count} epochs"),
    };
    let done = match best {
        _ if only_goals => "the goals are trained".to_owned(),
        None => format!("trained, {epochs}"),
        Some((error, epoch)) => format!(
            "trained, {epochs}; epoch {epoch} is the model: minADE of 20 hypotheses {error:.3} m on the validation part"
        ),
    };
    let next = next(request, only_goals, &recordings.as_options());
    output::print(&format!("{run}: {done}\nnext: {next}\n"))
}

/// The command to go on with: what can be measured is.
fn next(request: &TrainingRequest, only_goals: bool, data: &str) -> String {
    let run = shell_word(request.out.path());
    let kept = request.validation > 0.0 || !request.validation_recordings.is_empty();
    let part = match (request.fold == Fold::WHOLE, kept) {
        (false, _) => Some("test"),
        (true, true) => Some("validation"),
        (true, false) => None,
    };
    match (only_goals, part) {
        (true, Some(part)) => format!("ddl goals --model {run} --measure {part}{data}"),
        (true, None) => "the same command without --only-goals".to_owned(),
        (false, Some("validation")) => format!("ddl evaluate --model {run}{data} --validation"),
        (false, Some(_)) => format!("ddl evaluate --model {run}{data}"),
        (false, None) => format!("ddl forecast TRACKS --model {run}"),
    }
}
