//! The output at the end of `ddl train`, and the comparison with the built-in model on own recordings.

use crate::command::{RecordingsAt, Reporting};
use crate::interrupt::Interrupt;
use crate::output::{self, shell_word};
use crate::progress::Progress;
use ddl::data::{Convention, Dataset, Fold};
use ddl::{BuiltinModel, Comparison, Ddl, TrainingRequest, TrainingStage, best_epoch};
use serde_json::json;

/// Smallest difference, as a share of the built-in model's error, that is reported as a difference without an interval.
const LEAST: f64 = 0.02;

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
    let run = run.display();
    let epochs = match epochs.iter().filter(|epoch| epoch.epoch > 0).count() {
        1 => "1 epoch".to_owned(),
        count => format!("{count} epochs"),
    };
    let done = match best {
        _ if only_goals => "the goals are trained".to_owned(),
        None => format!("trained, {epochs}"),
        Some((_, 0)) => format!(
            "trained, {epochs}; no epoch was better than the starting weights of the forecasting network: they are \
             kept, and only the goals were trained"
        ),
        Some((error, epoch)) => {
            let error = match compared {
                // The comparison below states it.
                Some(_) => String::new(),
                None => format!(": minADE of 20 hypotheses {error:.3} m on the validation part"),
            };
            format!("trained, {epochs}; epoch {epoch} is the model{error}")
        }
    };
    let measured = compared.is_some();
    let compared = compared.map_or_else(String::new, |compared| format!("{}\n", compared_words(compared)));
    let next = next(request, only_goals, measured, &recordings.as_options());
    let words = format!("{run}: {done}\n{compared}next: {next}\n");
    reporting.telling.print(&words)
}

fn next(request: &TrainingRequest, only_goals: bool, measured: bool, data: &str) -> String {
    let run = shell_word(request.out.path());
    let is_validated = request.validation > 0.0 || !request.validation_recordings.is_empty();
    let part = match (request.fold == Fold::NO_HELD_OUT, is_validated) {
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

fn facts(compared: &Comparison) -> serde_json::Value {
    let paired = compared.difference;
    json!({
        "pedestrians": compared.pedestrians,
        "run": compared.run,
        "builtin": compared.other,
        "builtin_was_trained_on_them": compared.other_knows_them,
        "min_ade_difference": paired.map(|paired| {
            let interval = paired.difference;
            json!({"mean": interval.mean, "low": interval.low, "high": interval.high, "p_value": paired.p_value})
        }),
    })
}

/// Evaluates both models; `None` without a validation part or a trained network.
pub(super) fn compare_with_builtin(
    request: &TrainingRequest,
    dataset: &Dataset,
    reporting: &Reporting,
    interrupt: &Interrupt,
) -> anyhow::Result<Option<Comparison>> {
    let is_validated = request.validation > 0.0 || !request.validation_recordings.is_empty();
    let is_own = dataset.convention() == Convention::Own;
    if !is_validated || !is_own || !request.out.is_trained() {
        return Ok(None);
    }
    let run = Ddl::load(request.out.path(), request.device)?;
    let builtin = Ddl::builtin(BuiltinModel::default(), request.device)?;
    let progress = Progress::new("compare", reporting.telling.progress);
    let compared = ddl::compare_on_validation(&run, &builtin, dataset, |windows| {
        progress.tell(windows.done, windows.total, "windows of the validation part");
        interrupt.flow()
    })?;
    Ok((compared.pedestrians > 0).then_some(compared))
}

fn compared_words(compared: &Comparison) -> String {
    let Comparison { run, other, .. } = compared;
    let builtin = BuiltinModel::default();
    let known = if compared.other_knows_them {
        format!(
            "\nwarning: {builtin} was trained on recordings of the validation part: its errors, and those of a model \
             that starts from it, are too small"
        )
    } else {
        String::new()
    };
    format!(
        "on the validation part ({} pedestrian-windows), minADE/minFDE of 20 in metres: this model {:.3}/{:.3}, the \
         built-in model {builtin} {:.3}/{:.3}{known}\n{}",
        compared.pedestrians,
        run.min_ade,
        run.min_fde,
        other.min_ade,
        other.min_fde,
        verdict(compared)
    )
}

fn verdict(compared: &Comparison) -> String {
    let gain = compared.other.min_ade - compared.run.min_ade;
    let builtin = BuiltinModel::default();
    let Some(paired) = compared.difference else {
        let share = gain / compared.other.min_ade.max(f64::MIN_POSITIVE);
        let so_far = if share >= LEAST {
            format!("training seems to help: {gain:.3} m less minADE")
        } else if share <= -LEAST {
            format!("training did not help: use the built-in model {builtin}, or train on more recordings")
        } else {
            format!("training made no clear difference: {gain:.3} m less minADE")
        };
        return format!(
            "{so_far} (the validation part has fewer than 10 blocks of 20 s: too few for a confidence interval)"
        );
    };
    let (low, high) = (-paired.difference.high, -paired.difference.low);
    let interval = format!("{gain:.3} m less minADE, 95 % interval {low:.3} to {high:.3}");
    if low > 0.0 {
        format!("training helped: {interval}")
    } else if high < 0.0 {
        format!(
            "training made the forecasts worse: {:.3} m more minADE, 95 % interval {:.3} to {:.3}; use the built-in \
             model {builtin}, or train on more recordings",
            -gain, -high, -low
        )
    } else {
        format!("training made no significant difference: {interval}")
    }
}
