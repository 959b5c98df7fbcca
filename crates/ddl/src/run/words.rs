//! Descriptions of a training for the results.

use ddl_network::TrainingConfig;

/// How the network was trained; `goals` describes the origin of its goals.
pub(crate) fn recipe(training: &TrainingConfig, goals: &str) -> String {
    let (pedestrians, rate) = (training.batch_pedestrians, training.learning_rate);
    let schedule = training.learning_rate_schedule;
    format!("batches of more than {pedestrians} pedestrians, Adam with step size {rate} ({schedule}); goals {goals}")
}

/// How the epoch of the model was chosen.
pub(crate) fn selection(patience: Option<usize>) -> &'static str {
    match patience {
        None => "last epoch",
        Some(_) => "epoch of the least validation error",
    }
}

/// The part of the training set that an epoch sees; `None` for all of it.
pub(crate) fn subset(training: &TrainingConfig) -> Option<String> {
    training
        .pedestrians_per_epoch
        .map(|pedestrians| format!("about {pedestrians} pedestrians an epoch, going round a seeded order of all"))
}
