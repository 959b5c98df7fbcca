//! One changed byte anywhere in a file causes an error, or does not change the result.

use ddl::{Ddl, DdlError, DeviceChoice, Forecaster as _};
use ddl_tests::chance::Chance;
use ddl_tests::place::Place;
use ddl_tests::{bits, crowd, nightly};
use std::path::Path;

fn forecast(model: &Path) -> Result<Vec<Vec<u64>>, DdlError> {
    let model = Ddl::load(model, DeviceChoice::Cpu)?;
    Ok(bits::of_all(&model.forecast_all(&crowd::windows(1, 3))?))
}

#[test]
fn a_forecast_from_a_changed_file_is_refused_or_the_same() {
    let place = Place::with_model();
    let _ = place.ok("pack --model run --out packed");
    let mut chance = Chance::new("changed bytes");
    let (mut tried, mut refused) = (0, 0);
    for (name, model) in [
        ("run/config.json", "run"),
        ("run/model.safetensors", "run"),
        ("run/proposal.safetensors", "run"),
        ("run/experts.safetensors", "run"),
        ("packed", "packed"),
    ] {
        let expected = forecast(&place.at(model)).unwrap();
        let whole = place.read(name);
        for byte in chance.places(whole.len(), nightly::rounds(40, 200)) {
            place.write(name, chance.turned(&whole, byte));
            tried += 1;
            match forecast(&place.at(model)) {
                Err(error) => {
                    refused += 1;
                    // The message names the file, or the part of config.json that does not match the others.
                    let message = error.to_string();
                    assert!(message.len() > 20, "{name}, byte {byte}: {message}");
                }
                Ok(found) => assert!(found == expected, "{name}, byte {byte}"),
            }
        }
        place.write(name, &whole);
    }
    eprintln!("one byte changed in a model: {refused} of {tried} refused, the others with the same forecasts");
    assert!(refused > tried / 2, "{refused} of {tried}");
}
