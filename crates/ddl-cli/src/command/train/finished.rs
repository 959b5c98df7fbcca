//! What is said when `ddl train` has come to its end.

use super::super::{RecordingsAt, Reporting};
use super::compared;
use crate::output::{self, shell_word};
use crate::progress::ProgressMode;
use ddl::data::Fold;
use ddl::{Comparison, TrainingRequest, TrainingStage, best_epoch};
use serde_json::json;

/// Tells what has come of it, and what to do next.
pub(super) fn print(
    request: &TrainingRequest,
    compared: Option<&Comparison>,
    recordings: &RecordingsAt,
    reporting: &Reporting,
) -> anyhow::Result<()> {
    let run = request.out.path();
    let epochs = request.out.metrics()?;
    let best = best_epoch(&epochs).and_then(|best| Some((best.validation?, best.epoch)));
    let only_goals = request.until == TrainingStage::Goals && !request.out.is_trained();
    if reporting.telling.json {
        let last = epochs.last().map(|epoch| epoch.epoch);
        return output::print_json(&json!({
            "run": run,
            "trained": !only_goals,
            "epochs": epochs,
            "kept_epoch": best.map_or(last, |(_, epoch)| Some(epoch)),
            "validation_min_ade": compared.map(|on| on.run.min_ade).or(best.map(|(error, _)| error)),
            "validation": compared.map(facts),
        }));
    }
    if reporting.telling.progress == ProgressMode::Json {
        return Ok(());
    }
    let run = run.display();
    let epochs = match epochs.iter().filter(|epoch| epoch.epoch > 0).count() {
        1 => "1 epoch".to_owned(),
        count => format!("{count} epochs"),
    };
    let done = match best {
        _ if only_goals => "the goals are trained".to_owned(),
        None => format!("trained, {epochs}"),
        Some((_, 0)) => format!(
            "trained, {epochs}; no epoch was better than the weights that the forecasting network began with: these are kept, only the goals were learned"
        ),
        Some((error, epoch)) => {
            let error = match compared {
                // the whole part says it below
                Some(_) => String::new(),
                None => format!(": minADE of 20 hypotheses {error:.3} m on the validation part"),
            };
            format!("trained, {epochs}; epoch {epoch} is the model{error}")
        }
    };
    let measured = compared.is_some();
    let compared = compared.map_or_else(String::new, |compared| {
        format!("{}\n", compared::words(compared))
    });
    let next = next(request, (only_goals, measured), &recordings.as_options());
    output::print(&format!("{run}: {done}\n{compared}next: {next}\n"))
}

/// The command to go on with: what can be measured is.
fn next(request: &TrainingRequest, (only_goals, measured): (bool, bool), data: &str) -> String {
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
        (false, Some("validation")) if measured => {
            format!("ddl evaluate --model {run}{data} --validation")
        }
        (false, Some("test")) => format!("ddl evaluate --model {run}{data}"),
        (false, _) => format!("ddl forecast TRACKS --model {run}"),
    }
}

/// The comparison with the built-in model, for programs.
fn facts(compared: &Comparison) -> serde_json::Value {
    let paired = compared.difference;
    json!({
        "pedestrians": compared.pedestrians,
        "run": compared.run,
        "builtin": compared.other,
        "min_ade_difference": paired.map(|paired| {
            let interval = paired.difference;
            json!({"mean": interval.mean, "low": interval.low, "high": interval.high, "p_value": paired.p_value})
        }),
    })
}
