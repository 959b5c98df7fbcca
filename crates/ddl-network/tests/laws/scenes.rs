//! Simulated windows, their goals, and untrained networks.

pub(crate) use ddl_core::distance;
use ddl_core::{PedestrianId, Position, Window};
use ddl_data::{Dataset, WindowRule};
use ddl_network::{
    BackboneKind, ForecastWindows as _, MotionNetwork, Noise, StarConfig, StepRule, Variant, WindowRollout,
};
use std::sync::LazyLock;

/// Windows of all simulated scenes with their futures, and a crowd of 150 pedestrians.
pub(crate) static WINDOWS: LazyLock<Vec<Window>> = LazyLock::new(|| {
    let dataset = Dataset::simulated(1);
    let recordings = dataset.recordings().iter();
    let mut windows: Vec<Window> = recordings
        .flat_map(|recording| recording.windows(WindowRule::Complete).into_iter().step_by(23))
        .take(30)
        .collect();
    let tracks = windows.iter().flat_map(|window| (0..window.len()).map(|i| window.track(i)));
    let tracks: Vec<Vec<Position>> = tracks.take(150).map(<[Position]>::to_vec).collect();
    assert_eq!(tracks.len(), 150);
    let pedestrians = (0..).take(150).map(PedestrianId).collect();
    windows.push(Window::new("crowd", 0, 10, pedestrians, tracks).unwrap());
    windows
});

/// Goals for each pedestrian, a function of the window: its true endpoint, and positions around it.
pub(crate) fn goals(window: &Window, count: usize) -> Vec<Vec<Position>> {
    let around = |[x, y]: Position, k: usize| {
        let (sin, cos) = (2.0 * k as f64).sin_cos();
        [x + 1.5 * k as f64 * cos, y + 1.5 * k as f64 * sin]
    };
    (0..window.len()).map(|i| (0..count).map(|k| around(window.end(i).unwrap(), k)).collect()).collect()
}

/// Shares from 0 to 1, a function of the window.
pub(crate) fn shares(window: &Window) -> Vec<f64> {
    (0..window.len()).map(|i| (i % 5) as f64 / 4.0).collect()
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Question {
    pub goals: usize,
    pub noise: Noise,
    pub rule: StepRule,
    pub shared: bool,
}

impl Question {
    pub(crate) fn bounded(goals: usize) -> Self {
        Self { goals, noise: Noise::Expected, rule: StepRule::Bounded, shared: false }
    }

    pub(crate) fn ask(self, network: &MotionNetwork, windows: &[&Window]) -> Vec<WindowRollout> {
        let observed: Vec<Window> = windows.iter().map(|window| window.without_future()).collect();
        let goals: Vec<_> = windows.iter().map(|window| goals(window, self.goals)).collect();
        let shares: Vec<_> = windows.iter().map(|window| shares(window)).collect();
        let shares = self.shared.then_some(&shares[..]);
        network.forecast_windows(&observed, &goals, self.noise, self.rule, shares).unwrap()
    }
}

pub(crate) fn configs() -> Vec<StarConfig> {
    let mut configs = Vec::new();
    for backbone in BackboneKind::ALL {
        for variant in Variant::ALL {
            for config in [StarConfig::published(variant), StarConfig::recommended(variant)] {
                configs.push(StarConfig { backbone, feed_forward_width: 64, ..config });
            }
        }
    }
    configs
}

pub(crate) fn recommended(backbone: BackboneKind, variant: Variant) -> StarConfig {
    StarConfig { backbone, ..StarConfig::recommended(variant) }
}

pub(crate) fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}
