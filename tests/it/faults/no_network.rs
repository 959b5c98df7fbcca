//! Every command gives the same bytes without a network, because it fetches nothing and sends nothing.

use super::EVALUATE;
use ddl_tests::offline;
use ddl_tests::place::Place;

#[test]
fn every_command_works_without_a_network() {
    let Some(way) = offline::way() else { return };
    let place = Place::with_model();
    let alone = |line: &str| offline::run(way, &place, line).succeeds();
    let commands = [
        "forecast --model run tracks.csv --threads 1",
        "forecast tracks.csv --one --threads 1",
        "windows --convention simulated --fold corridor",
        "info --model run",
        "info --json",
    ];
    for line in commands {
        assert_eq!(alone(line), place.ok(line), "{line}");
    }
    assert!(alone(&format!("{EVALUATE} --out report")).contains("minADE"));
    assert!(alone("pack --model run --out packed").contains("weights"));
}
