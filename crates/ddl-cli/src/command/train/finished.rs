//! What is said when `ddl train` has come to its end.

use super::super::{RecordingsAt, Telling};
use crate::output;
use crate::progress::ProgressMode;
use ddl::data::Fold;
use ddl::{TrainingRequest, TrainingStage, best_epoch};
use serde_json::json;

/// Tells what has come of it, and what to do next.
pub(super) fn tell(
    request: &TrainingRequest,
    recordings: &RecordingsAt,
    telling: &Telling,
) -> anyhow::Result<()> {
    let run = request.out.path();
    let epochs = request.out.metrics()?;
    let best = best_epoch(&epochs).and_then(|best| Some((best.validation?, best.epoch)));
    let only_goals = request.until == TrainingStage::Goals && !request.out.is_trained();
    if telling.json {
        let last = epochs.last().map(|epoch| epoch.epoch);
        return output::print_json(&json!({
            "run": run,
            "trained": !only_goals,
            "epochs": epochs,
            "kept_epoch": best.map_or(last, |(_, epoch)| Some(epoch)),
            "validation_min_ade": best.map(|(error, _)| error),
        }));
    }
    if telling.progress == ProgressMode::Json {
        return Ok(());
    }
    let run = run.display();
    let epochs = match epochs.len() {
        1 => "1 epoch".to_owned(),
        count => format!("{count} epochs"),
    };
    let data = recordings.as_options();
    let part = match request.fold.as_str() {
        Fold::WHOLE => "validation",
        _ => "test",
    };
    let (done, next) = if only_goals {
        (
            "the goals are trained".to_owned(),
            format!("goals --model {run} --measure {part}{data}"),
        )
    } else {
        match best {
            None => (
                format!("trained, {epochs}"),
                format!("evaluate --model {run}{data}"),
            ),
            Some((error, epoch)) => (
                format!(
                    "trained, {epochs}; epoch {epoch} is the model: minADE of 20 hypotheses {error:.3} m on the validation part"
                ),
                format!("evaluate --model {run}{data} --validation"),
            ),
        }
    };
    output::print(&format!("{run}: {done}\nnext: ddl {next}\n"))
}
