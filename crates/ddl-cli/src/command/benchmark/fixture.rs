//! A plan for tests.

use crate::command::benchmark::method::Method;
use crate::command::benchmark::plan::{Plan, Settings, Training};
use crate::command::benchmark::profile::Profile;
use crate::command::recipe::Recipe;
use ddl::data::Convention;
use ddl::{DeviceChoice, Protocol};

pub(super) fn settings(name: Recipe) -> Settings {
    Settings {
        profile: Profile::Quick,
        convention: Convention::Star,
        data: Some("/recordings".into()),
        device: DeviceChoice::Cpu,
        cargo_profile: "release".to_owned(),
        epochs: 4,
        train_pedestrians: Some(800),
        proposal_steps: Some(30),
        test_pedestrians: None,
        protocols: match name {
            Recipe::Recommended => Protocol::ALL[1..].to_vec(),
            Recipe::Published => Protocol::ALL[..3].to_vec(),
        },
        recipe: Training {
            name,
            optimiser: Profile::Paper.work(name).optimiser,
        },
    }
}

pub(super) fn plan(settings: Settings, folds: &[&str], methods: &[Method], seeds: &[u64]) -> anyhow::Result<Plan> {
    let folds: Vec<String> = folds.iter().map(|&fold| fold.to_owned()).collect();
    Plan::new(settings, &folds, methods, seeds)
}
