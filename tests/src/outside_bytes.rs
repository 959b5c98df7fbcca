//! A test function for every reader of untrusted input. Rules: no panic for any bytes; data that was read is written
//! and read back unchanged; a stream in pieces gives the same result as at once; an error changes nothing. The fuzz
//! targets of `tests/fuzz` call these functions, and so do plain tests with seeds and edits of them.

mod edits;
mod external;
mod live_tracks;
mod logs;
mod model_files;
mod own_tracks;
mod scene_memory;
mod stream;
mod tracks;
#[cfg(feature = "torch")]
mod training_state;
mod valid_file;
mod values;

use arbitrary::Unstructured;
use ddl_data::Format;
use ddl_eval::external::ExternalFormat;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{TestRng, TestRunner};
use std::panic::{catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};

/// The test function of a reader, with the name of its fuzz target.
#[derive(Debug, Clone, Copy)]
pub struct Reader(&'static str, fn(&[u8]));

/// The readers whose test function edits a valid file itself. The edits of a plain test of the others start from the
/// files of the reader's folder in `tests/fuzz/corpus`.
const EDITING: [&str; 5] = ["scene_memory", "packed_model", "weights", "experts", "training_state"];

/// The readers that need no libtorch.
pub const READERS: [Reader; 21] = [
    Reader("table", |bytes| tracks::check(bytes, Format::Table)),
    Reader("star_csv", |bytes| tracks::check(bytes, Format::StarCsv)),
    Reader("social_gan", |bytes| tracks::check(bytes, Format::SocialGan)),
    Reader("trajnet", |bytes| tracks::check(bytes, Format::TrajNet)),
    Reader("obsmat", |bytes| tracks::check(bytes, Format::Obsmat)),
    Reader("own_tracks", own_tracks::read),
    Reader("stream", stream::read),
    Reader("live_tracks", live_tracks::read),
    Reader("mcap", logs::read),
    Reader("homography", values::homography),
    Reader("foreign_json_lines", |bytes| {
        external::check(bytes, ExternalFormat::JsonLines);
    }),
    Reader("foreign_table", |bytes| external::check(bytes, ExternalFormat::Table)),
    Reader("report", values::report),
    Reader("moments", values::moments),
    Reader("goal_params", values::goal_params),
    Reader("scene_memory", scene_memory::read),
    Reader("packed_model", model_files::packed_model),
    Reader("run_config", model_files::run_config),
    Reader("metrics", model_files::metrics),
    Reader("weights", model_files::weights),
    Reader("experts", model_files::experts),
];

/// The readers that need libtorch.
#[cfg(feature = "torch")]
pub const TORCH_READERS: [Reader; 1] = [Reader("training_state", training_state::read)];

/// Edited inputs of each reader in a plain test, unless `PROPTEST_CASES` is set.
const CASES: u32 = 1000;
/// Truncations that are read of each seed.
const TRUNCATIONS: usize = 256;

/// Passes the bytes to the reader of this name.
pub fn read(name: &str, bytes: &[u8]) {
    #[cfg(not(feature = "torch"))]
    const TORCH_READERS: [Reader; 0] = [];
    let mut readers = READERS.iter().chain(&TORCH_READERS);
    let reader = readers.find(|reader| reader.0 == name);
    (reader.unwrap_or_else(|| panic!("no reader {name}")).1)(bytes);
}

/// Passes every seed of a reader to it, with truncations and random edits, the same ones in every run.
pub fn check(Reader(name, read): Reader) {
    let seeds = files(name);
    for (path, seed) in &seeds {
        let stride = seed.len().div_ceil(TRUNCATIONS).max(1);
        for length in (0..seed.len()).step_by(stride).chain([seed.len()]) {
            let outcome = catch_unwind(|| read(&seed[..length]));
            outcome.unwrap_or_else(|panic| {
                eprintln!("{name}: the first {length} bytes of {}", path.display());
                resume_unwind(panic)
            });
        }
    }
    let config = ProptestConfig {
        cases: std::env::var("PROPTEST_CASES").map_or(CASES, |cases| cases.parse().expect("a number")),
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let random = TestRng::deterministic_rng(config.rng_algorithm);
    let edited = (select(seeds), prop::collection::vec(any::<u8>(), 1..24));
    let outcome = TestRunner::new_with_rng(config, random).run(&edited, |((_, seed), choices)| {
        if seed.is_empty() {
            read(&choices);
        } else {
            read(&edits::edited(&mut Unstructured::new(&choices), &seed));
        }
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{name}: {error}"));
}

/// The seeds of a reader with their files, and no bytes.
fn files(name: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let mut seeds = vec![(PathBuf::from("no file"), Vec::new())];
    if !EDITING.contains(&name) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for entry in entries {
            let path = entry.expect("the folder can be listed").path();
            let seed = std::fs::read(&path).expect("a seed can be read");
            seeds.push((path, seed));
        }
        assert!(seeds.len() > 1, "{} holds no seed", folder.display());
    }
    // The order of a folder differs between machines.
    seeds.sort();
    seeds
}
