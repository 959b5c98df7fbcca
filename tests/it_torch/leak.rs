//! The model under `fair` and `single`: whatever the future, the same forecast bit by bit.

use ddl::data::{Position, Window};
use ddl::eval::leak;
use ddl::{Ddl, Forecast, Forecaster, Protocol, Variant};
use ddl_tests::{bits, crowd, tiny_model, wild_future};

/// Every single future position of everybody, one at a time.
#[test]
fn no_future_position_changes_a_forecast() {
    let tiny = tiny_model::of(Variant::Full);
    let window = &crowd::windows(1, 3)[0];
    assert_eq!(leak::find(&tiny.model, window).unwrap(), None);
}

/// The forecasts of windows with every kind of wild future, all windows of a batch at once.
fn with_wild_futures(
    windows: &[Window],
    forecast: impl Fn(&[Window]) -> Vec<Forecast>,
) -> Vec<(&'static str, Vec<Vec<u64>>)> {
    (0..wild_future::all(&windows[0]).len())
        .map(|change| {
            let (kinds, changed): (Vec<_>, Vec<_>) = windows
                .iter()
                .map(|window| wild_future::all(window).swap_remove(change))
                .unzip();
            (kinds[0], bits::of_all(&forecast(&changed)))
        })
        .collect()
}

/// Futures replaced as a whole, the model called directly, for every variant.
#[test]
fn no_wild_future_changes_a_forecast() {
    let windows = crowd::windows(2, 4);
    let observed: Vec<Window> = windows.iter().map(Window::without_future).collect();
    for variant in Variant::ALL {
        let tiny = tiny_model::of(variant);
        let forecast = |windows: &[Window]| tiny.model.forecast_all(windows).unwrap();
        let reference = bits::of_all(&forecast(&observed));
        for (future, seen) in with_wild_futures(&windows, forecast) {
            assert_eq!(seen, reference, "{variant}, future: {future}");
        }
    }
}

/// The same through the protocols.
#[test]
fn no_wild_future_changes_a_forecast_under_a_protocol() {
    let windows = crowd::windows(2, 4);
    let tiny = tiny_model::of(Variant::Full);
    let [fair, single] = [Protocol::Fair, Protocol::Single].map(|protocol| {
        let forecast = |windows: &[Window]| protocol.forecast(&tiny.model, windows).unwrap();
        let reference = bits::of_all(&forecast(&windows));
        for (future, seen) in with_wild_futures(&windows, forecast) {
            assert_eq!(seen, reference, "{protocol}, future: {future}");
        }
        reference
    });
    assert_ne!(fair, single);
}

/// The walk to the central goal, which is all that `single` measures of the model.
struct One<'a>(&'a Ddl);

impl Forecaster for One<'_> {
    fn name(&self) -> String {
        "DDL, one forecast".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ddl::eval::ForecastError> {
        let mut forecasts = self.0.forecast_one(std::slice::from_ref(window))?;
        Ok(forecasts.remove(0))
    }
}

#[test]
fn no_future_position_changes_the_one_forecast() {
    let tiny = tiny_model::of(Variant::Full);
    let window = &crowd::windows(1, 3)[0];
    assert_eq!(leak::find(&One(&tiny.model), window).unwrap(), None);
}

#[test]
fn no_wild_future_changes_the_one_forecast() {
    let windows = crowd::windows(2, 4);
    let observed: Vec<Window> = windows.iter().map(Window::without_future).collect();
    for variant in Variant::ALL {
        let tiny = tiny_model::of(variant);
        let forecast = |windows: &[Window]| tiny.model.forecast_one(windows).unwrap();
        let reference = bits::of_all(&forecast(&observed));
        for (future, seen) in with_wild_futures(&windows, forecast) {
            assert_eq!(seen, reference, "{variant}, future: {future}");
        }
    }
}

/// The observation does change it: the test compares more than constants.
#[test]
fn the_last_observed_position_changes_a_forecast() {
    let tiny = tiny_model::of(Variant::Full);
    let window = &crowd::windows(1, 3)[0];
    let forecasts = |window: &Window| {
        [
            tiny.model.forecast(window),
            One(&tiny.model).forecast(window),
        ]
        .map(|forecast| bits::of(&forecast.unwrap()))
    };
    let reference = forecasts(window);
    let nudged = window.map_positions(|i, t, p| {
        if (i, t) == (0, 7) {
            [p[0] + 0.01, p[1]]
        } else {
            p
        }
    });
    let changed = forecasts(&nudged);
    for (changed, reference) in changed.iter().zip(&reference) {
        assert_ne!(changed, reference);
    }
}

/// The model with a glimpse of the true end, far below a millimetre.
struct PeeksAtTheEnd<'a>(&'a Ddl);

impl Forecaster for PeeksAtTheEnd<'_> {
    fn name(&self) -> String {
        "DDL that peeks".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ddl::eval::ForecastError> {
        let honest = self.0.forecast(window)?;
        let (n, k) = (honest.pedestrians(), honest.hypotheses());
        let pairs = || (0..n).flat_map(move |i| (0..k).map(move |k| (i, k)));
        let towards = |p: &Position, end: Position| {
            [
                p[0] + 1e-12 * (end[0] - p[0]),
                p[1] + 1e-12 * (end[1] - p[1]),
            ]
        };
        let positions = pairs()
            .flat_map(|(i, k)| {
                let end = window.end(i);
                let hypothesis = honest.hypothesis(i, k).iter();
                hypothesis.map(move |p| end.map_or(*p, |end| towards(p, end)))
            })
            .collect();
        let weights = pairs().map(|(i, k)| honest.weight(i, k)).collect();
        Ok(Forecast::new(n, k, positions, weights, None)?)
    }
}

#[test]
fn a_model_that_peeks_is_caught() {
    let tiny = tiny_model::of(Variant::Full);
    let window = &crowd::windows(1, 3)[0];
    let found = leak::find(&PeeksAtTheEnd(&tiny.model), window).unwrap();
    assert!(found.is_some());
}
