//! A test function for every reader of untrusted input. Rules: no panic for any bytes; data that was read is written
//! and read back unchanged; a stream in pieces gives the same result as at once; an error changes nothing. The fuzz
//! targets of `tests/fuzz` call these functions, and so do plain tests with seeds and edits of them.

mod edits;
mod external;
mod live_tracks;
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
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::TestRunner;
use std::path::Path;

/// The test function of a reader, with the name of its fuzz target and of its seeds.
pub type Reader = (&'static str, fn(&[u8]));

/// The readers that need no libtorch.
pub const READERS: [Reader; 21] = [
    ("table", tracks::table),
    ("star_csv", tracks::star_csv),
    ("social_gan", tracks::social_gan),
    ("trajnet", tracks::trajnet),
    ("obsmat", tracks::obsmat),
    ("own_tracks", own_tracks::read),
    ("stream", stream::read),
    ("live_tracks", live_tracks::read),
    ("homography", values::homography),
    ("foreign_json_lines", external::json_lines),
    ("foreign_table", external::table),
    ("foreign_trajnet", external::trajnet),
    ("report", values::report),
    ("moments", values::moments),
    ("goal_library", values::goal_library),
    ("scene_memory", scene_memory::read),
    ("packed_model", model_files::packed_model),
    ("run_config", model_files::run_config),
    ("metrics", model_files::metrics),
    ("weights", model_files::weights),
    ("experts", model_files::experts),
];

/// The readers that need libtorch.
#[cfg(feature = "torch")]
pub const TORCH_READERS: [Reader; 1] = [("training_state", training_state::read)];

/// Edited inputs of each reader in a plain test, unless `PROPTEST_CASES` is set.
const CASES: u32 = 1000;
/// Truncations that are read of each seed.
const TRUNCATIONS: usize = 32;

/// Passes the bytes to the reader of this name.
pub fn read(name: &str, bytes: &[u8]) {
    #[cfg(not(feature = "torch"))]
    const TORCH_READERS: [Reader; 0] = [];
    let mut readers = READERS.iter().chain(&TORCH_READERS);
    let reader = readers.find(|reader| reader.0 == name);
    reader.unwrap_or_else(|| panic!("no reader {name}")).1(bytes);
}

/// Passes every seed of a reader to it, with truncations and random edits. A reader that edits a valid file itself has
/// no seeds.
pub fn check((name, read): Reader) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut seeds: Vec<Vec<u8>> = entries
        .map(|entry| std::fs::read(entry.expect("the folder can be listed").path()).expect("a seed can be read"))
        .collect();
    seeds.push(Vec::new());
    for seed in &seeds {
        read(seed);
        let stride = seed.len().div_ceil(TRUNCATIONS).max(1);
        for length in (0..seed.len()).step_by(stride) {
            read(&seed[..length]);
        }
    }
    let config = ProptestConfig {
        cases: std::env::var("PROPTEST_CASES").map_or(CASES, |cases| cases.parse().expect("a number")),
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let edited = (select(seeds), prop::collection::vec(any::<u8>(), 1..24));
    let failed = TestRunner::new(config).run(&edited, |(seed, choices)| {
        if seed.is_empty() {
            read(&choices);
        } else {
            read(&edits::edited(&mut Unstructured::new(&choices), &seed));
        }
        Ok(())
    });
    failed.unwrap_or_else(|error| panic!("{name}: {error}"));
}
