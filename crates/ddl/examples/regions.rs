//! The regions of the built-in models over the time of recordings, fixed and adaptive:
//! `regions STAR_FOLDER [FOLDER=FPS ...]`. It prints the tables of `docs/regions.md`, and draws `docs/regions.svg`.
//!
//! The folder of the convention `star` holds the recordings of ETH/UCY; each is forecast by the model of its fold. The
//! other folders hold csv files (frame, pedestrian, x, y in metres), forecast by the default model. On these, and on
//! the two recordings that no fold tests, the constants were chosen.

#![expect(clippy::print_stdout, reason = "a program that prints tables")]

mod places;

use ddl::data::{Convention, Dataset, OBSERVED, Position, Recording, TIME_STEP, Window};
use ddl::eval::metric::region::equivalent_radius;
use ddl::report::figure::{TimePanel, coverage};
use ddl::{AdaptiveRegions, BuiltinModel, Ddl, DeviceChoice, Forecast, Forecaster as _};
use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

/// Levels of regions; reliability is measured over all of them.
const LEVELS: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Indices of the levels that have columns in the table.
const HALF: usize = 4;
const MOST: usize = 8;
/// Windows forecast at a time.
const CHUNK: usize = 64;
/// Length in minutes of the sliding interval over which a share is computed, and its step.
const SLIDING: f64 = 1.0;
const APART: f64 = 1.0 / 12.0;
/// Recordings shorter than this (minutes) are left out, because the regions hardly adapt in them.
const SHORTEST: f64 = 0.8;
/// Recordings with fewer forecast pedestrians are left out.
const FEWEST: usize = 1000;

/// Coverage of the regions of the forecasts from one frame.
struct Moment {
    minutes: f64,
    people: usize,
    /// Number of forecast steps at which the pedestrian was observed.
    seen: usize,
    /// Number of these observations inside the regions, fixed and adaptive, for each level.
    held: [[usize; LEVELS.len()]; 2],
    /// Sums of radii (m), fixed and adaptive, for the levels `HALF` and `MOST`.
    radii: [[f64; 2]; 2],
}

struct Watched {
    name: String,
    model: BuiltinModel,
    moments: Vec<Moment>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((star, elsewhere)) = arguments.split_first() else {
        return Err("usage: regions STAR_FOLDER [FOLDER=FPS ...]".into());
    };
    ddl::prepare(DeviceChoice::Cpu, None)?;
    let dataset = Dataset::load(Convention::Star, Path::new(star))?;
    let (mut tested, mut others) = (Vec::new(), Vec::new());
    for recording in dataset.recordings() {
        match model_of(&dataset, recording)? {
            Some(model) => tested.push(Watched::of(recording, model)?),
            None => others.push(Watched::of(recording, BuiltinModel::default())?),
        }
    }
    for place in elsewhere {
        for recording in places::recordings(place)? {
            if is_enough(&recording) {
                others.push(Watched::of(&recording, BuiltinModel::default())?);
            }
        }
    }
    println!("# Recordings that are tested on\n\n{}", table(&tested));
    println!("# Recordings that the constants were chosen on\n\n{}", table(&others));
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/regions.svg");
    Ok(std::fs::write(file, drawn(&tested)?)?)
}

fn is_enough(recording: &Recording) -> bool {
    let frames = recording.frames();
    let steps = (frames[frames.len() - 1] - frames[0]) as f64 / recording.frame_step() as f64;
    let people: usize = recording.observed_windows().iter().map(Window::len).sum();
    steps * TIME_STEP / 60.0 >= SHORTEST && people >= FEWEST
}

/// The model of the fold that tests on the recording.
fn model_of(dataset: &Dataset, recording: &Recording) -> Result<Option<BuiltinModel>, Box<dyn Error>> {
    for fold in dataset.folds() {
        let mut tested = fold.test_recordings().iter();
        if tested.any(|test| test.name() == recording.name()) {
            return Ok(Some(fold.name().parse()?));
        }
    }
    Ok(None)
}

impl Watched {
    fn of(recording: &Recording, name: BuiltinModel) -> Result<Self, Box<dyn Error>> {
        let model = Ddl::builtin(name, DeviceChoice::Cpu)?;
        let first = recording.frames()[0];
        let step_minutes = TIME_STEP / 60.0 / recording.frame_step() as f64;
        let (mut regions, mut moments) = (AdaptiveRegions::default(), Vec::new());
        for windows in recording.observed_windows().chunks(CHUNK) {
            for (window, fixed) in windows.iter().zip(model.forecast_all(windows)?) {
                let adaptive = regions.adapt(window, fixed.clone());
                let ahead = recording.futures_of(window);
                let frame = window.frames()[OBSERVED - 1];
                moments.push(Moment {
                    minutes: (frame - first) as f64 * step_minutes,
                    people: window.len(),
                    seen: ahead.iter().map(Vec::len).sum(),
                    held: [&fixed, &adaptive].map(|forecast| LEVELS.map(|level| held(forecast, &ahead, level))),
                    radii: [&fixed, &adaptive]
                        .map(|forecast| [HALF, MOST].map(|level| radii(window, forecast, LEVELS[level]))),
                });
            }
        }
        Ok(Self {
            name: recording.name().to_owned(),
            model: name,
            moments,
        })
    }

    fn minutes(&self) -> f64 {
        self.moments.last().map_or(0.0, |moment| moment.minutes)
    }

    fn people(&self) -> usize {
        self.moments.iter().map(|moment| moment.people).sum()
    }

    fn later(&self) -> &[Moment] {
        let quarter = 0.25 * self.minutes();
        let from = self.moments.partition_point(|moment| moment.minutes < quarter);
        &self.moments[from..]
    }

    /// The covered share in the minute before each frame: time (minutes) and share.
    fn sliding(&self, kind: usize, level: usize) -> Vec<[f64; 2]> {
        let moments = (SLIDING / 3.0 / APART) as usize..=(self.minutes() / APART) as usize;
        let until = |minutes: f64| self.moments.partition_point(|moment| moment.minutes <= minutes);
        moments
            .filter_map(|moment| {
                let now = moment as f64 * APART;
                let minute = &self.moments[until(now - SLIDING)..until(now)];
                let seen: usize = minute.iter().map(|moment| moment.seen).sum();
                (seen > 0).then(|| [now, share(minute, kind, level)])
            })
            .collect()
    }

    /// Least and largest share of a minute after the first quarter.
    fn range(&self, kind: usize, level: usize) -> Option<[f64; 2]> {
        let from = (0.25 * self.minutes()).max(SLIDING);
        let sliding = self.sliding(kind, level).into_iter();
        let shares = sliding.filter(|point| point[0] >= from).map(|point| point[1]);
        let ranges = shares.map(|share| [share; 2]);
        ranges.reduce(|[low, high], [other, _]| [low.min(other), high.max(other)])
    }
}

fn held(forecast: &Forecast, ahead: &[Vec<Position>], level: f64) -> usize {
    let of_pedestrian = |(i, ahead): (usize, &Vec<Position>)| {
        let inside = |&(t, position): &(usize, &Position)| {
            let region = forecast.region(i, t, level).unwrap_or_default();
            region.iter().any(|disc| disc.contains(*position))
        };
        ahead.iter().enumerate().filter(inside).count()
    };
    ahead.iter().enumerate().map(of_pedestrian).sum()
}

fn radii(window: &Window, forecast: &Forecast, level: f64) -> f64 {
    let radius = |i: usize| {
        let region = forecast.region(i, ddl::data::HORIZON - 1, level);
        region.map_or(0.0, |region| equivalent_radius(&region))
    };
    (0..window.len()).map(radius).sum()
}

fn share(moments: &[Moment], kind: usize, level: usize) -> f64 {
    let seen: usize = moments.iter().map(|moment| moment.seen).sum();
    let held: usize = moments.iter().map(|moment| moment.held[kind][level]).sum();
    held as f64 / seen as f64
}

/// Mean radius (m) of regions of the level `HALF` (0) or `MOST` (1).
fn radius(moments: &[Moment], kind: usize, which: usize) -> f64 {
    let people: usize = moments.iter().map(|moment| moment.people).sum();
    let sum: f64 = moments.iter().map(|moment| moment.radii[kind][which]).sum();
    sum / people as f64
}

/// 1 minus the mean difference, and 1 minus the largest difference, between the covered share and the level.
fn reliability(moments: &[Moment], kind: usize) -> [f64; 2] {
    let off = LEVELS.iter().enumerate();
    let off = off.map(|(index, level)| (share(moments, kind, index) - level).abs());
    let (sum, most) = off.fold((0.0, 0.0_f64), |(sum, most), off| (sum + off, most.max(off)));
    [1.0 - sum / LEVELS.len() as f64, 1.0 - most]
}

fn table(recordings: &[Watched]) -> String {
    let mut table = String::from(
        "| recording (model) | minutes | forecasts | regions | 90 %: whole | later | any minute | radius | 50 %: \
         whole | later | radius | reliability |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for watched in recordings {
        for (kind, name) in ["fixed", "adaptive"].into_iter().enumerate() {
            let later = watched.later();
            let percent = |moments: &[Moment], level: usize| 100.0 * share(moments, kind, level);
            let range = watched.range(kind, MOST).map_or("-".to_owned(), |[low, high]| {
                format!("{:.0} to {:.0}", 100.0 * low, 100.0 * high)
            });
            let [mean, least] = reliability(&watched.moments, kind);
            let mut row = match kind {
                0 => format!(
                    "| {} (`{}`) | {:.1} | {} |",
                    watched.name,
                    watched.model,
                    watched.minutes(),
                    watched.people()
                ),
                _ => "| | | |".to_owned(),
            };
            let _ = write!(
                row,
                " {name} | {:.1} | {:.1} | {range} | {:.2} | {:.1} | {:.1} | {:.2} | {:.1} / {:.1} |",
                percent(&watched.moments, MOST),
                percent(later, MOST),
                radius(later, kind, 1),
                percent(&watched.moments, HALF),
                percent(later, HALF),
                radius(later, kind, 0),
                100.0 * mean,
                100.0 * least,
            );
            table += &row;
            table.push('\n');
        }
    }
    table
}

fn drawn(recordings: &[Watched]) -> Result<String, ddl::report::FigureError> {
    let panel = |watched: &Watched| {
        let later = watched.later();
        let note = |kind: usize| {
            let percent = 100.0 * share(later, kind, MOST);
            format!("{percent:.0} %, {:.1} m", radius(later, kind, 1))
        };
        TimePanel {
            name: watched.name.clone(),
            notes: [0, 1].map(note),
            curves: [0, 1].map(|kind| watched.sliding(kind, MOST)),
        }
    };
    let panels: Vec<TimePanel> = recordings.iter().map(panel).collect();
    let title = "Share of true positions inside the regions of 90 %, over the minute before";
    coverage(title, LEVELS[MOST], &panels)
}
