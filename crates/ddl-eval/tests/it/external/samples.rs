//! Folders of sample files, the layout of the evaluator of "Joint Metrics Matter".

use std::fs;
use std::path::Path;

use ddl_core::{Forecast, PedestrianId, Position, Window};
use ddl_eval::external::{Coverage, read_samples, write_samples};
use proptest::prelude::*;

use super::files::{expected, windows};
use super::mistakes::cases_of;
use crate::generated;

const ALL: Coverage = Coverage::Whole;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Positions keep their bits; weights, which the layout lacks, become equal.
    #[test]
    fn what_is_written_is_read_back_to_the_bit(
        (window, forecast) in (1..4_usize, 1..21_usize).prop_flat_map(|(n, k)| {
            let position = prop_oneof![-1e6..1e6_f64, prop::num::f64::SUBNORMAL, Just(-0.0)];
            let position = (position.clone(), position).prop_map(|(x, y)| [x, y]);
            (generated::window(("a yard", -90, 6), n, position.clone()), generated::forecast(n, k, false, position))
        }),
        later in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut windows = vec![window.clone()];
        if later {
            let tracks = (0..window.len()).map(|i| window.track(i).to_vec()).collect();
            windows.push(Window::new("a yard", 6, 6, window.pedestrians().to_vec(), tracks).unwrap());
        }
        let forecasts = vec![forecast.clone(); windows.len()];
        write_samples(&windows, &forecasts, folder.path()).unwrap();
        let matched = read_samples(folder.path(), &windows, ALL).unwrap();
        prop_assert_eq!(&matched.windows, &windows);
        let (n, k) = (forecast.pedestrians(), forecast.hypotheses());
        let pairs = (0..n).flat_map(|i| (0..k).map(move |k| (i, k)));
        let positions: Vec<Position> = pairs.flat_map(|(i, k)| forecast.hypothesis(i, k)).copied().collect();
        let equal = Forecast::with_equal_weights(n, k, positions).unwrap();
        prop_assert_eq!(&matched.forecasts, &vec![equal; windows.len()]);
    }
}

/// The method's folder with the forecasts of the two windows of `yard`.
fn written() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_samples(&windows(), &expected(), folder.path()).unwrap();
    folder
}

#[test]
fn files_are_those_of_the_literature() {
    let folder = written();
    let text = |file: &str| fs::read_to_string(folder.path().join(file)).unwrap();
    let observed = text("yard/frame_000070/obs.txt");
    assert!(observed.starts_with("0 3 0 0\n10 3 0.5 0\n") && observed.lines().count() == 16);
    let truth = text("yard/frame_000070/gt.txt");
    assert!(truth.starts_with("80 3 4 0\n") && truth.ends_with("190 5 9.5 2\n"));
    assert!(text("yard/frame_000080/sample_000.txt").starts_with("90 5 3 0\n"));
    // As AgentFormer prints them, in the folder of the `social-gan` file.
    let track = vec![[1.0, 2.0]; 20];
    let eth = [Window::new("eth", 780, 10, vec![PedestrianId(1)], vec![track]).unwrap()];
    let moment = folder.path().join("biwi_eth/frame_000850");
    fs::create_dir_all(&moment).unwrap();
    let rows = (1..=12).map(|t| format!("{}.000 1.000 1.250 -2.000\n", 850 + 10 * t));
    fs::write(moment.join("sample_000.txt"), rows.collect::<String>()).unwrap();
    assert_eq!(read_samples(folder.path(), &eth, ALL).unwrap().forecasts[0].hypothesis(0, 0), [[1.25, -2.0]; 12]);
    let again = write_samples(&windows(), &expected(), folder.path()).unwrap_err();
    assert!(again.to_string().ends_with("is not empty; give a new folder"));
}

const SAMPLE: &str = "yard/frame_000070/sample_000.txt";

/// The error of a folder, named M in it, after a change of what was written there.
fn complaint(change: impl FnOnce(&Path)) -> String {
    let folder = written();
    change(folder.path());
    let error = read_samples(folder.path(), &windows(), ALL).unwrap_err().to_string();
    error.replace(&folder.path().display().to_string(), "M")
}

#[test]
fn every_mistake_is_named_with_its_file_and_line() {
    for case in cases_of("lines of a sample") {
        let parts: Vec<&str> = case.split("=>").map(str::trim).collect();
        let error = complaint(|folder| {
            let text = fs::read_to_string(folder.join(SAMPLE)).unwrap();
            assert!(text.contains(parts[0]), "{text}");
            fs::write(folder.join(SAMPLE), text.replacen(parts[0], parts[1], 1)).unwrap();
        });
        assert!(error.starts_with(&format!("M/{SAMPLE}, {}", parts[2])), "{error}");
    }
}

type Edit = fn(&str) -> String;

#[test]
fn files_that_do_not_fit_together_are_named() {
    let same: Edit = |text: &str| text.to_owned();
    let only_3: Edit = |text: &str| text.lines().take(12).collect::<Vec<_>>().join("\n");
    let further: Edit = |text: &str| text.to_owned() + &text.replace(" 5 ", " 9 ").replace(" 3 ", " 8 ");
    let another: Edit = |text: &str| text.replace(" 5 ", " 9 ");
    // A changed copy of a sample, and the error.
    let cases: [(&str, Edit, &str); 7] = [
        ("70/sample_001.txt", only_3, "M/yard/frame_000070/sample_001.txt, line 1: pedestrian 5 is missing"),
        (
            "70/sample_001.txt",
            further,
            "M/yard/frame_000070/sample_001.txt, line 25, pedestrian: 8 is not in sample_000.txt",
        ),
        ("70/sample_001.txt", same, "M/yard/frame_000080: holds 1 samples, but M/yard/frame_000070 holds 2"),
        ("70/sample_002.txt", same, "M/yard/frame_000070: sample_001.txt is missing"),
        ("70/sample_000.txt", another, "M: 1 of 3 forecasts match no pedestrian"),
        ("90/sample_000.txt", same, "M: 2 of 5 forecasts match no pedestrian"),
        ("70/sample_000.txt", only_3, "M forecasts 2 of the 3 pedestrians"),
    ];
    for (to, edit, expected) in cases {
        let error = complaint(|folder| {
            let text = fs::read_to_string(folder.join(SAMPLE)).unwrap();
            let to = folder.join(format!("yard/frame_0000{to}"));
            fs::create_dir_all(to.parent().unwrap()).unwrap();
            fs::write(to, edit(&text)).unwrap();
        });
        assert!(error.starts_with(expected), "{error}");
    }
    let nothing = complaint(|folder| fs::remove_dir_all(folder.join("yard")).unwrap());
    let expected = "M: holds no folder SCENE/frame_NNNNNN of sample files, where SCENE is one of yard";
    assert_eq!(nothing, expected);
}
