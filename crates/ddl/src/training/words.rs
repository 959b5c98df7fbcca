//! A training in words, as results name it.

use ddl_network::TrainingConfig;

/// How it was trained, in words; `goals` are those of where its goals come from.
pub(crate) fn recipe(training: &TrainingConfig, goals: &str) -> String {
    let (pedestrians, rate) = (training.batch_pedestrians, training.learning_rate);
    let schedule = training.learning_rate_schedule;
    format!(
        "batches of more than {pedestrians} pedestrians, Adam with step size {rate} ({schedule}); goals {goals}"
    )
}

/// Which epoch is the model, in words.
pub(crate) fn selection(patience: Option<usize>) -> &'static str {
    match patience {
        None => "last epoch",
        Some(_) => "epoch of the least validation error",
    }
}

/// How much of the training set an epoch sees, in words; `None` for all of it.
pub(crate) fn subset(training: &TrainingConfig) -> Option<String> {
    training.pedestrians_per_epoch.map(|pedestrians| {
        format!("about {pedestrians} pedestrians an epoch, going round a seeded order of all")
    })
}
