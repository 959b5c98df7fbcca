//! One byte changed anywhere in any file: an error, or the very same result.

use super::Chance;
use ddl::{Ddl, DdlError, DeviceChoice, Forecaster as _, RunDirectory, TrainingStep, Variant};
use ddl_tests::folder_contents::{self, Contents};
use ddl_tests::{bits, crowd, figures, tiny_model};
use std::ops::ControlFlow;
use std::path::Path;

fn forecast(model: &Path) -> Result<Vec<Vec<u64>>, DdlError> {
    let model = Ddl::load(model, DeviceChoice::Cpu)?;
    Ok(bits::of_all(&model.forecast_all(&crowd::windows(1, 3))?))
}

/// Places in a file: the first sixteen bytes, and others anywhere; half of those in the first kilobytes, where headers are.
fn places(chance: &mut Chance, length: usize, count: usize) -> Vec<usize> {
    let heads = (0..16.min(length)).step_by(if count < 16 { 5 } else { 1 });
    let mut places: Vec<usize> = heads.collect();
    for index in 0..count {
        let limit = if index % 2 == 0 {
            length
        } else {
            length.min(4096)
        };
        places.push(chance.below(limit as u64) as usize);
    }
    places
}

fn change(chance: &mut Chance, bytes: &mut [u8], place: usize) {
    bytes[place] ^= 1 << chance.below(8);
}

#[test]
fn a_forecast_from_a_changed_file_is_refused_or_the_same() {
    let folder = tiny_model::folder(Variant::Full);
    let run = folder.path();
    let packed = run.join("packed");
    Ddl::load(run, DeviceChoice::Cpu)
        .unwrap()
        .pack(&packed)
        .unwrap();
    let mut chance = Chance::new("changed bytes");
    let (mut tried, mut refused) = (0, 0);
    for name in [
        "config.json",
        "model.safetensors",
        "proposal.safetensors",
        "experts.safetensors",
        "packed",
    ] {
        let file = run.join(name);
        let model = if name == "packed" { &file } else { run };
        let expected = forecast(model).unwrap();
        let whole = std::fs::read(&file).unwrap();
        for place in places(&mut chance, whole.len(), figures::rounds(12, 200)) {
            let mut bytes = whole.clone();
            change(&mut chance, &mut bytes, place);
            std::fs::write(&file, &bytes).unwrap();
            tried += 1;
            match forecast(model) {
                Err(error) => {
                    refused += 1;
                    // named: the file, or the part of config.json that does not fit the others
                    let message = error.to_string();
                    assert!(message.len() > 20, "{name}, byte {place}: {message}");
                }
                Ok(found) => assert!(found == expected, "{name}, byte {place}"),
            }
        }
        std::fs::write(&file, &whole).unwrap();
    }
    assert!(refused > tried / 2, "{refused} of {tried}");
    figures::tell(
        "one byte changed, then a forecast",
        format!(
            "{tried} changes of 5 files (configuration, weights, proposals, experts, packed model)"
        ),
        format!(
            "{refused} refused, the other {} forecast the same bits",
            tried - refused
        ),
    );
}

/// A run stopped in each of its stages, with its state.
fn stopped(at: fn(&TrainingStep) -> bool) -> Contents {
    let folder = tempfile::tempdir().unwrap();
    let run = RunDirectory::new(folder.path());
    let error = tiny_model::train_until(&run, |step| {
        if at(step) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    assert!(matches!(error, Err(DdlError::Interrupted)), "{error:?}");
    folder_contents::read(folder.path())
}

#[test]
fn training_goes_on_from_a_changed_file_to_the_same_weights_or_not_at_all() {
    let expected = tiny_model::folder(Variant::Full);
    let expected = std::fs::read(expected.path().join("model.safetensors")).unwrap();
    let goals = stopped(|step| matches!(step, TrainingStep::Goals(_)));
    let network = stopped(|step| matches!(step, TrainingStep::Network(_)));
    let cases = [
        (&goals, "proposal-state.safetensors"),
        (&goals, "config.json"),
        (&network, "optimizer.safetensors"),
        (&network, "proposal.safetensors"),
        (&network, "experts.safetensors"),
    ];
    let mut chance = Chance::new("changed bytes of a run under way");
    let (mut tried, mut refused) = (0, 0);
    for (contents, name) in cases {
        let whole = contents[Path::new(name)].clone().unwrap();
        for place in places(&mut chance, whole.len(), figures::rounds(3, 60)) {
            let folder = tempfile::tempdir().unwrap();
            folder_contents::write(contents, folder.path());
            let mut bytes = whole.clone();
            change(&mut chance, &mut bytes, place);
            std::fs::write(folder.path().join(name), &bytes).unwrap();
            tried += 1;
            if tiny_model::train_again(&RunDirectory::new(folder.path())).is_ok() {
                let found = std::fs::read(folder.path().join("model.safetensors")).unwrap();
                assert!(found == expected, "{name}, byte {place}");
            } else {
                refused += 1;
            }
        }
    }
    assert!(refused > tried / 2, "{refused} of {tried}");
    figures::tell(
        "one byte changed, then training goes on",
        format!(
            "{tried} changes of 5 files (states of both stages, configuration, proposals, experts)"
        ),
        format!(
            "{refused} refused, the other {} end in the same bytes",
            tried - refused
        ),
    );
}
