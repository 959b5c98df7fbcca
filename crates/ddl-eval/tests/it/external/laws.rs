//! Properties of files of forecasts, for any content.

use ddl_core::{Forecast, OBSERVED, Position, Window};
use ddl_eval::external::{self, Coverage, ExternalFormat};
use ddl_eval::{Protocol, Scores};
use proptest::collection::vec;
use proptest::prelude::*;
use serde_json::Value;

use crate::generated;

/// Any coordinate within the bounds, as other programs print them.
fn coordinate() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        -1e3..1e3_f64,
        -ddl_core::COORDINATE_LIMIT..=ddl_core::COORDINATE_LIMIT,
        prop::num::f64::SUBNORMAL,
        Just(-0.0)
    ]
}

fn position() -> impl Strategy<Value = Position> + Clone {
    (coordinate(), coordinate()).prop_map(|(x, y)| [x, y])
}

fn forecast_windows() -> impl Strategy<Value = (Vec<Window>, Vec<Forecast>)> {
    let shapes = (vec(1..4_usize, 1..5), 1..4_usize, any::<bool>());
    shapes.prop_flat_map(|(sizes, k, with_goals)| {
        let windows: Vec<_> = sizes
            .into_iter()
            .enumerate()
            .map(|(index, n)| {
                let name = if index % 2 == 0 { "yard" } else { "a \"quoted\" ünusual name" };
                let from = (name, 6 * index as i64 - 9, 6);
                let forecast = generated::forecast(n, k, with_goals, position());
                (generated::window(from, n, position()), forecast)
            })
            .collect();
        windows.prop_map(|pairs| pairs.into_iter().unzip())
    })
}

fn written(windows: &[Window], forecasts: &[Forecast]) -> String {
    let mut bytes = Vec::new();
    external::write_forecasts(windows, forecasts, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

proptest! {
    #[test]
    fn what_is_written_is_read_back_to_the_bit_in_any_order(
        (windows, forecasts) in forecast_windows(),
        seed in any::<prop::sample::Index>(),
    ) {
        let text = written(&windows, &forecasts);
        let mut lines: Vec<&str> = text.lines().collect();
        let by = seed.index(lines.len());
        lines.rotate_left(by);
        let text = lines.join("\n");
        let matched = external::read_from(
            text.as_bytes(), "f", ExternalFormat::JsonLines, &windows, Coverage::Whole,
        ).unwrap();
        prop_assert_eq!(&matched.forecasts, &forecasts);
        prop_assert_eq!(&matched.windows, &windows);
        // Equal numbers may differ in the sign of zero; equal text does not.
        prop_assert_eq!(written(&matched.windows, &matched.forecasts), written(&windows, &forecasts));
    }

    #[test]
    fn windows_are_written_without_their_future((windows, _) in forecast_windows()) {
        let (mut whole, mut observed) = (Vec::new(), Vec::new());
        external::write_windows(&windows, &mut whole).unwrap();
        let blind: Vec<Window> = windows.iter().map(Window::without_future).collect();
        external::write_windows(&blind, &mut observed).unwrap();
        prop_assert_eq!(&whole, &observed);
        let text = String::from_utf8(whole).unwrap();
        let mut lines = text.lines();
        for window in &windows {
            for (i, pedestrian) in window.pedestrians().iter().enumerate() {
                let line: Value = serde_json::from_str(lines.next().unwrap()).unwrap();
                prop_assert_eq!(line["recording"].as_str(), Some(window.recording()));
                prop_assert_eq!(line["observed_until"].as_i64(), Some(window.frames()[OBSERVED - 1]));
                prop_assert_eq!(line["pedestrian"].as_i64(), Some(pedestrian.0));
                let read: Vec<Position> = serde_json::from_value(line["observed"].clone()).unwrap();
                prop_assert_eq!(&read[..], window.observed(i));
                prop_assert_eq!(line.as_object().unwrap().len(), 4);
            }
        }
        prop_assert_eq!(lines.next(), None);
    }

    #[test]
    fn what_looks_at_others_is_the_same_for_a_part((windows, forecasts) in forecast_windows()) {
        let whole = Scores::evaluate(&windows, &forecasts).unwrap();
        let (mut truly, mut into_truth, mut categories) = (0.0, 0.0, 0);
        for line in written(&windows, &forecasts).lines() {
            let matched = external::read_from(
                line.as_bytes(), "f", ExternalFormat::JsonLines, &windows, Coverage::Intersection,
            ).unwrap();
            let (windows, full_windows) = (&matched.windows, &matched.full_windows);
            let alone = Scores::under(Protocol::Fair, windows, full_windows, &matched.forecasts).unwrap();
            truly += alone.true_collision_rate;
            into_truth += alone.true_neighbour_collision_rate.unwrap();
            categories += alone.categories.iter().map(|c| c.pedestrians).sum::<usize>();
        }
        let n = whole.pedestrians as f64;
        prop_assert!((truly / n - whole.true_collision_rate).abs() < 1e-12);
        prop_assert!((into_truth / n - whole.true_neighbour_collision_rate.unwrap()).abs() < 1e-12);
        prop_assert_eq!(categories, whole.categories.iter().map(|c| c.pedestrians).sum::<usize>());
    }
}
