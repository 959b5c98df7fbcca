//! External forecasts, in both formats.

use std::sync::OnceLock;

use super::valid_file::names_file;
use ddl_core::{PedestrianId, Window};
use ddl_eval::external::{self, Coverage, ExternalFormat};

/// Two windows of one recording: pedestrian 7 alone, then pedestrians 7 and 8.
fn windows() -> &'static [Window] {
    static WINDOWS: OnceLock<[Window; 2]> = OnceLock::new();
    let walk = |from: i32, y: f64| (from..from + 20).map(|t| [0.5 * f64::from(t), y]).collect();
    WINDOWS.get_or_init(|| {
        let window = |start: i32, ids: Vec<i64>| {
            let tracks = ids.iter().map(|&id| walk(start / 10, id as f64)).collect();
            let ids = ids.into_iter().map(PedestrianId).collect();
            Window::new("yard", start.into(), 10, ids, tracks).expect("a sound window")
        };
        [window(0, vec![7]), window(10, vec![7, 8])]
    })
}

/// The first byte chooses whether a part of the pedestrians is sufficient; the others are the file. Forecasts that were
/// read, written as JSON lines, must be read back unchanged.
pub(super) fn check(bytes: &[u8], format: ExternalFormat) {
    let Some((&part, file)) = bytes.split_first() else {
        return;
    };
    let coverage = if part & 1 == 0 { Coverage::Intersection } else { Coverage::Whole };
    let read = |file: &[u8], format| external::read_from(file, "fuzzed", format, windows(), coverage);
    let matched = match read(file, format) {
        Ok(matched) => matched,
        Err(error) => return names_file(&error, "fuzzed"),
    };
    for forecast in &matched.forecasts {
        for (i, k) in (0..forecast.pedestrians()).flat_map(|i| (0..forecast.hypotheses()).map(move |k| (i, k))) {
            let path = forecast.hypothesis(i, k).as_flattened();
            assert!(path.iter().all(|c| c.abs() <= ddl_core::COORDINATE_LIMIT), "{path:?}");
        }
    }
    let mut written = Vec::new();
    external::write_forecasts(&matched.windows, &matched.forecasts, &mut written)
        .expect("the forecasts can be written");
    let again = read(&written, ExternalFormat::JsonLines).expect("written forecasts are read");
    assert_eq!(again, matched);
}
