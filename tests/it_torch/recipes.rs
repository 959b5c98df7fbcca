//! `ddl train --recipe`: which network is made and how it is trained, as `config.json` says it.

use ddl::network::{NetworkFrame, Objective, StarConfig, TrainingConfig};
use ddl::{RunConfig, RunDirectory, Variant};
use ddl_tests::program;

/// The configuration that a run is begun with; its network is not trained.
fn begun_with(options: &str) -> RunConfig {
    let folder = tempfile::tempdir().unwrap();
    let train = format!(
        "train --convention simulated --fold corridor --only-goals --proposal-steps 1 --threads 1 \
         --out run {options}"
    );
    let _ = program::run(folder.path(), &train).succeeds();
    RunDirectory::new(folder.path().join("run"))
        .config()
        .unwrap()
}

#[test]
fn the_recommended_recipe_is_the_default() {
    for variant in Variant::ALL {
        let config = begun_with(&format!("--variant {variant}"));
        assert_eq!(config.star, StarConfig::recommended(variant));
        assert_eq!(config.training, TrainingConfig::recommended(variant));
    }
    let full = begun_with("--recipe recommended");
    assert_eq!(full, begun_with(""));
    assert_eq!(
        (full.star.frame, full.star.feed_forward_width),
        (NetworkFrame::Goal, 128)
    );
    assert_eq!(full.training.objective, Objective::Walk);
}

#[test]
fn the_published_recipe_is_the_papers() {
    let config = begun_with("--recipe published");
    assert_eq!(config.star, StarConfig::published(Variant::Full));
    assert_eq!(config.training, TrainingConfig::published());
    // the numbers of the paper, whatever the constructors say
    assert_eq!(
        (config.star.frame, config.star.feed_forward_width),
        (NetworkFrame::World, 2048)
    );
    assert_eq!(config.training.objective, Objective::NextStep);
    assert_eq!(
        (config.training.epochs, config.training.batch_walkers),
        (200, 256)
    );
}

#[test]
fn options_change_their_part_of_a_recipe_alone() {
    let config = begun_with("--recipe published --epochs 7 --seed 3 --feed-forward-width 64");
    let star = StarConfig {
        feed_forward_width: 64,
        ..StarConfig::published(Variant::Full)
    };
    let training = TrainingConfig {
        epochs: 7,
        seed: 3,
        ..TrainingConfig::published()
    };
    assert_eq!((config.star, config.training), (star, training));
}
