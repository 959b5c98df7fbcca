//! Whether a training on own recordings was worth it: the run and the built-in model on what was kept for validation.

use super::super::Reporting;
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use ddl::data::{Convention, Dataset};
use ddl::{BuiltinModel, Comparison, Ddl, TrainingRequest};

/// Gain or loss, as a share of the built-in model's error, that a sentence without an interval calls one.
const LEAST: f64 = 0.02;

/// Measures both; `None` where nothing was kept, or the network is not trained. The built-in model's error is that of a model that has learned
/// from these recordings where they are of ETH/UCY.
pub(super) fn with_builtin(
    request: &TrainingRequest,
    dataset: &Dataset,
    reporting: &Reporting,
    interrupt: &Interrupt,
) -> anyhow::Result<Option<Comparison>> {
    let kept = request.validation > 0.0 || !request.validation_recordings.is_empty();
    let own = dataset.convention() == Convention::Own;
    if !kept || !own || !request.out.is_trained() {
        return Ok(None);
    }
    let run = Ddl::load(request.out.path(), request.device)?;
    let builtin = Ddl::builtin(BuiltinModel::default(), request.device)?;
    let progress = Progress::new("compare", reporting.telling.progress);
    let compared = ddl::compare_on_validation(&run, &builtin, dataset, |done, total| {
        progress.tell(done as u64, total as u64, "windows of the validation part");
        interrupt.flow()
    })?;
    Ok((compared.pedestrians > 0).then_some(compared))
}

/// What came of it, for people: both errors, and a sentence.
pub(super) fn words(compared: &Comparison) -> String {
    let Comparison {
        pedestrians,
        run,
        other,
        ..
    } = compared;
    let builtin = BuiltinModel::default();
    format!(
        "on the validation part ({pedestrians} pedestrian-windows), minADE/minFDE of 20 in metres: this model {:.3}/{:.3}, the built-in model {builtin} \
         {:.3}/{:.3}\n{}",
        run.min_ade,
        run.min_fde,
        other.min_ade,
        other.min_fde,
        verdict(compared)
    )
}

/// Whether it was worth it.
fn verdict(compared: &Comparison) -> String {
    let gain = compared.other.min_ade - compared.run.min_ade;
    let builtin = BuiltinModel::default();
    let Some(paired) = compared.difference else {
        let share = gain / compared.other.min_ade.max(f64::MIN_POSITIVE);
        let so_far = if share >= LEAST {
            format!("training seems worth it: {gain:.3} m less minADE")
        } else if share <= -LEAST {
            format!(
                "training was not worth it: use the built-in model {builtin}, or train on more recordings"
            )
        } else {
            format!("training made no clear difference: {gain:.3} m less minADE")
        };
        return format!(
            "{so_far} (fewer than 10 stretches of 20 s to validate on: too little to say how sure that is)"
        );
    };
    let (low, high) = (-paired.difference.high, -paired.difference.low);
    let interval = format!("{gain:.3} m less minADE, 95 % interval {low:.3} to {high:.3}");
    if low > 0.0 {
        format!("training was worth it: {interval}")
    } else if high < 0.0 {
        format!(
            "training was not worth it: {:.3} m more minADE, 95 % interval {:.3} to {:.3}; use the built-in model {builtin}, or train on more recordings",
            -gain, -high, -low
        )
    } else {
        format!("training made no difference that is more than chance: {interval}")
    }
}
