//! The expert library of a run without proposed goals.

use ddl::{DeviceChoice, GoalModel, GoalRecipe};

use super::smallest;
use super::sound::Sound;
use crate::drawn_model;

/// Edits of a valid file.
pub fn read(bytes: &[u8]) {
    thread_local! {
        static SOUND: Sound<()> = Sound::new("experts.safetensors", |path| {
            let mut config = smallest::config();
            config.goals = GoalRecipe::retrieved(1);
            let positions: Vec<f64> = (0..2 * 20 * 2).map(|i| 0.25 * f64::from(i)).collect();
            let text = serde_json::to_string(&config).expect("a configuration can be written");
            std::fs::write(path.with_file_name("config.json"), text).expect("a file can be written");
            let library = drawn_model::experts(&config, &positions);
            std::fs::write(path, library).expect("a file can be written");
        });
    }
    SOUND.with(|sound| {
        let run = sound.path.parent().expect("the file lies in a run");
        drop(sound.read(bytes, |(), _| GoalModel::load(run, DeviceChoice::Cpu)));
    });
}
