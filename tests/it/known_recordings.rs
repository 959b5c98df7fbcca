//! Recordings that a model was trained on are told again, in whatever file they are.

use ddl::data::{Convention, Format, Observation, Recording, write_recording};
use ddl::{BuiltinModel, DeviceChoice, GoalModel, ModelSource};
use ddl_tests::place::Place;
use ddl_tests::recordings::dataset;

/// The built-in models were trained on files of the convention `star`. Those of `social-gan` have other roundings,
/// axes, and for `eth` other times.
#[test]
fn recordings_are_known_in_the_files_of_each_convention() {
    let opened = |model| GoalModel::open(&ModelSource::Builtin(model), DeviceChoice::Cpu).unwrap();
    let world = opened(BuiltinModel::World);
    for convention in [Convention::Star, Convention::SocialGan] {
        let Some(dataset) = dataset(convention) else {
            continue;
        };
        let knows = |goals: &GoalModel, recording: &Recording| {
            let (share, name) = (goals.known_share(recording), recording.name());
            assert!(share.is_none() || share > Some(0.2), "{convention}: {name}: {share:?}");
            share.is_some()
        };
        assert!(dataset.recordings().iter().all(|recording| knows(&world, recording)));
        for model in BuiltinModel::OF_FOLDS {
            let (fold, goals) = (dataset.fold(model.name()).unwrap(), opened(model));
            let (test, training) = (fold.test_recordings(), fold.training_recordings());
            assert!(!test.iter().any(|recording| knows(&goals, recording)), "{model}");
            assert!(training.iter().all(|recording| knows(&goals, recording)), "{model}");
        }
    }
}

#[test]
fn a_renamed_training_recording_is_no_test() {
    let Some(dataset) = dataset(Convention::Star) else {
        return;
    };
    let place = Place::empty();
    let rounded =
        |row: &Observation| Observation { position: row.position.map(|x| (100.0 * x).round() / 100.0), ..*row };
    let of_eth = dataset.recording("eth").unwrap();
    let rows: Vec<Observation> = of_eth.observations().iter().map(rounded).collect();
    let of_eth = Recording::new("yard", of_eth.frame_step(), rows).unwrap();
    place.write("obsmat.txt", write_recording(&of_eth, Format::Obsmat).unwrap());
    let told = ["was trained on obsmat (", "% of its paths"];
    for line in [
        "evaluate --data obsmat.txt",
        "evaluate --data obsmat.txt --model hotel --validation",
        "evaluate --data obsmat.txt --model world",
        "data obsmat.txt",
    ] {
        let said = place.run(line);
        assert_eq!(said.code == Some(0), line.starts_with("data"), "{said:?}");
        assert!(told.iter().all(|told| said.stderr.contains(told)), "{}", said.stderr);
        let advised = line.contains("hotel") || said.stderr.contains("(--model eth)") || line.starts_with("data");
        assert!(advised, "{}", said.stderr);
    }
    let _ = place.ok("evaluate --data obsmat.txt --model eth --protocol fair --test-pedestrians 20 --threads 1");
}

/// A file for each pedestrian has too few paths to be known.
#[test]
fn a_training_recording_in_many_files_is_no_test() {
    let Some(dataset) = dataset(Convention::Star) else {
        return;
    };
    let place = Place::empty();
    let of_zara = dataset.recording("zara03").unwrap();
    for id in of_zara.pedestrians().into_iter().take(60) {
        let one = Recording::new("one", of_zara.frame_step(), of_zara.track(id)).unwrap();
        let file = format!("each/{}.csv", id.0);
        place.write(&file, write_recording(&one, Format::Table).unwrap());
    }
    let said = place.run("evaluate --data each --protocol fair --threads 1");
    assert_eq!(said.says("was trained on").code, Some(1));
}
