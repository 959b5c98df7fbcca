//! One changed byte in a file of an unfinished training causes an error, or does not change the final weights.

use ddl::{DdlError, RunDirectory, TrainingStep};
use ddl_tests::chance::Chance;
use ddl_tests::folder_contents::{self, Contents};
use ddl_tests::{nightly, trained_model};
use std::ops::ControlFlow;
use std::path::Path;

/// A run stopped in one of its stages, with its state.
fn stopped(at: fn(&TrainingStep) -> bool) -> Contents {
    let folder = tempfile::tempdir().unwrap();
    let run = RunDirectory::new(folder.path());
    let error =
        trained_model::train_until(
            &run,
            |step| {
                if at(step) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
        );
    assert!(matches!(error, Err(DdlError::Interrupted)), "{error:?}");
    folder_contents::read(folder.path())
}

#[test]
fn training_resumes_from_a_changed_file_with_the_same_weights_or_fails() {
    let model = Path::new("model.safetensors");
    let expected = trained_model::contents()[model].as_ref().unwrap();
    let goals = stopped(|step| matches!(step, TrainingStep::Goals(_)));
    let network = stopped(|step| matches!(step, TrainingStep::Network(_)));
    let mut chance = Chance::new("changed bytes of an unfinished run");
    let (mut tried, mut refused) = (0, 0);
    for (contents, name) in [
        (&goals, "proposal-state.safetensors"),
        (&goals, "config.json"),
        (&network, "optimizer.safetensors"),
        (&network, "proposal.safetensors"),
        (&network, "experts.safetensors"),
    ] {
        let whole = contents[Path::new(name)].as_ref().unwrap();
        for byte in chance.places(whole.len(), nightly::rounds(3, 60)) {
            let folder = tempfile::tempdir().unwrap();
            folder_contents::write(contents, folder.path());
            std::fs::write(folder.path().join(name), chance.turned(whole, byte)).unwrap();
            tried += 1;
            if trained_model::train(&RunDirectory::new(folder.path())).is_ok() {
                let weights = std::fs::read(folder.path().join(model)).unwrap();
                assert!(&weights == expected, "{name}, byte {byte}");
            } else {
                refused += 1;
            }
        }
    }
    eprintln!("one byte changed in an unfinished run: {refused} of {tried} refused, the others with the same weights");
    assert!(refused > tried / 2, "{refused} of {tried}");
}
