//! The regions of the built-in models over the time of recordings, as they come and as they follow what is seen:
//! `regions STAR_FOLDER [FOLDER=FPS ...] > docs/regions.md`. It also draws `docs/regions.svg`.
//!
//! The folder of the convention `star` holds the recordings of ETH/UCY; each is forecast by the model of its fold. The
//! other folders hold csv files (frame, pedestrian, x, y in metres), forecast by the default model. On these, and on the
//! two recordings that no fold tests, the constants were chosen.

#![expect(clippy::print_stdout, reason = "a program that prints a page")]

#[allow(dead_code, reason = "whole recordings alone are needed")]
mod places;

use ddl::data::{Convention, Dataset, OBSERVED, Position, Recording, TIME_STEP, Window};
use ddl::eval::AdaptiveRegions;
use ddl::eval::region::{equal_radius, holds};
use ddl::report::figure::{CoveragePanel, coverage};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecast, Forecaster as _};
use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

/// Levels of regions; reliability is measured over all of them.
const LEVELS: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Of these the ones that have columns.
const HALF: usize = 4;
const MOST: usize = 8;
/// Windows forecast at a time.
const CHUNK: usize = 64;
/// Minutes before a moment whose forecasts make its share, and between two moments.
const SLIDING: f64 = 1.0;
const APART: f64 = 1.0 / 12.0;
/// Shorter recordings (minutes) end before there is much to follow.
const SHORTEST: f64 = 0.8;
/// Forecasts of fewer pedestrians make no share of a recording.
const FEWEST: usize = 1000;

const HEAD: &str = "# Regions that follow a place

A region of 90 % should hold a pedestrian nine times out of ten. The [regions](robots.md#how-far-to-trust-a-forecast) of a model were calibrated on other places. In a new one
they hold more or less than they say. So `ddl forecast` lets them follow what is seen: when a pedestrian is seen where it was forecast to be, the regions for that step ahead become
a little smaller, when it is seen elsewhere, larger. A forecast `t` steps ahead is judged `t` steps later, and only then changes later forecasts.

The rule is conformal control of quantiles ([Gibbs and Candes](https://arxiv.org/abs/2106.00170), [Angelopoulos, Candes and Tibshirani](https://arxiv.org/abs/2307.16895)). Each quantile `q` of the table of regions, one for each
of 12 levels and 12 steps, is multiplied by `exp(s)`, and each frame adds `0.06 w (missed - (1 - level))` to `s`. `missed` is the share of the pedestrians now seen that their regions for now did
not hold. `w` is the root of their number, at most 3, times the time since the frame before in steps of 0.4 s, at most 1. `s` begins at 0 and stays within ln 64, so that a radius stays within 8 times and
an 8th of what the weights and the table give. As long as `s` is not at its bound, the mean of `missed`, weighted by `w`, is within `ln 64 / (0.06 sum w)` of the share asked for, whatever people do. It is a statement about all
people and frames together, not about each person: for somebody who moves unusually a region holds less.

![Share of true positions inside the regions of 90 % over the minutes of six recordings: on four of them fixed regions hold 95 % and more, adaptive ones come to 90 % and are smaller.](regions.svg)

Above each panel: share and mean radius after the first quarter.

Made by `cargo run --release -p ddl-forecast --example regions -- STAR_FOLDER sdd=30 edinburgh=9 > docs/regions.md` (figure and tables), with the recordings of ETH/UCY in the convention `star` and those of
[other places](elsewhere.md) of at least 48 s and 1,000 forecasts of a pedestrian. Model of the fold, which was not trained on the recording; elsewhere `hotel`. Everybody seen at 8 steps in a row is forecast from every frame, as `ddl forecast --whole` does
(protocol `fair` for positions, `online` for regions: they read the recording up to the last observed frame). Counted are all steps ahead at which the pedestrian was still seen. CPU, no seed.

*later*: forecasts after the first quarter of the recording. *any minute*: least and largest share of a minute, after the first quarter. *radius*: mean radius (m) of a disc as large as the region at 4.8 s, after the first
quarter. *reliability*: over the levels 10, 20, ... 90 % and the whole recording, 100 % less the mean, and less the largest, difference between the share held and the level. DD-MDN (Hetzel et al.,
ICRA 2026) prints a mean reliability of this kind, of densities and levels of its own. Shares in per cent.
";

/// What regions held, of the forecasts of one moment.
struct Moment {
    minutes: f64,
    people: usize,
    /// Steps at which somebody forecast was seen.
    seen: usize,
    /// Of these inside the regions, and sums of radii (m): fixed and adaptive, level by level.
    held: [[usize; LEVELS.len()]; 2],
    /// Of the levels `HALF` and `MOST`.
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
    println!("{HEAD}\n## Recordings that are tested on\n");
    print_table(&tested);
    println!("\n## Recordings that the constants were chosen on\n");
    println!(
        "Tried were steps of 0.005 to 0.3; the number of people, its root, and 1 as the weight of a frame; and updates shared among the \
         forecast steps. Steps of 0.04 to 0.1 do about as well here. With more weight for crowds the regions of 50 % swing, because outcomes come late. \
         To scale the discs of a pedestrian by how its own earlier forecasts did made them no smaller on average. `zara03` and \
         `uni_examples` are recordings of training.\n"
    );
    print_table(&others);
    let picture = drawn(&tested)?;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/regions.svg");
    std::fs::write(file, picture)?;
    Ok(())
}

fn is_enough(recording: &Recording) -> bool {
    let frames = recording.frames();
    let steps = (frames[frames.len() - 1] - frames[0]) as f64 / recording.frame_step() as f64;
    let people: usize = recording.observed_windows().iter().map(Window::len).sum();
    steps * TIME_STEP / 60.0 >= SHORTEST && people >= FEWEST
}

/// The model of the fold that tests on the recording.
fn model_of(
    dataset: &Dataset,
    recording: &Recording,
) -> Result<Option<BuiltinModel>, Box<dyn Error>> {
    for fold in dataset.folds() {
        if fold
            .test_recordings()
            .iter()
            .any(|test| test.name() == recording.name())
        {
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
                let ahead = recording.onward(window);
                let frame = window.frames()[OBSERVED - 1];
                moments.push(Moment {
                    minutes: (frame - first) as f64 * step_minutes,
                    people: window.len(),
                    seen: ahead.iter().map(Vec::len).sum(),
                    held: [&fixed, &adaptive]
                        .map(|forecast| LEVELS.map(|level| held(forecast, &ahead, level))),
                    radii: [&fixed, &adaptive].map(|forecast| {
                        [HALF, MOST].map(|level| radii(window, forecast, LEVELS[level]))
                    }),
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
        let from = self
            .moments
            .partition_point(|moment| moment.minutes < quarter);
        &self.moments[from..]
    }

    /// Share of the minute before each moment: minutes and share.
    fn sliding(&self, kind: usize, level: usize) -> Vec<[f64; 2]> {
        let moments = (SLIDING / 3.0 / APART) as usize..=(self.minutes() / APART) as usize;
        let until = |minutes: f64| {
            self.moments
                .partition_point(|moment| moment.minutes <= minutes)
        };
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
        let shares = sliding
            .filter(|point| point[0] >= from)
            .map(|point| point[1]);
        let ranges = shares.map(|share| [share; 2]);
        ranges.reduce(|[low, high], [other, _]| [low.min(other), high.max(other)])
    }
}

fn held(forecast: &Forecast, ahead: &[Vec<Position>], level: f64) -> usize {
    let of_pedestrian = |(i, ahead): (usize, &Vec<Position>)| {
        let inside = |&(t, at): &(usize, &Position)| {
            forecast
                .region(i, t, level)
                .is_some_and(|region| holds(&region, *at))
        };
        ahead.iter().enumerate().filter(inside).count()
    };
    ahead.iter().enumerate().map(of_pedestrian).sum()
}

fn radii(window: &Window, forecast: &Forecast, level: f64) -> f64 {
    let radius = |i: usize| {
        let region = forecast.region(i, ddl::data::HORIZON - 1, level);
        region.map_or(0.0, |region| equal_radius(&region))
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

/// 1 less the mean, and less the largest, of the differences between the share held and the level.
fn reliability(moments: &[Moment], kind: usize) -> [f64; 2] {
    let off = LEVELS.iter().enumerate();
    let off = off.map(|(at, level)| (share(moments, kind, at) - level).abs());
    let (sum, most) = off.fold((0.0, 0.0_f64), |(sum, most), off| {
        (sum + off, most.max(off))
    });
    [1.0 - sum / LEVELS.len() as f64, 1.0 - most]
}

fn print_table(recordings: &[Watched]) {
    println!(
        "| recording (model) | minutes | forecasts | regions | 90 %: whole | later | any minute | radius | 50 %: whole | later | radius | reliability |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|"
    );
    for watched in recordings {
        for (kind, name) in ["fixed", "adaptive"].into_iter().enumerate() {
            let later = watched.later();
            let percent = |moments: &[Moment], level: usize| 100.0 * share(moments, kind, level);
            let range = watched
                .range(kind, MOST)
                .map_or("-".to_owned(), |[low, high]| {
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
            println!("{row}");
        }
    }
}

fn drawn(recordings: &[Watched]) -> Result<String, ddl::report::FigureError> {
    let panel = |watched: &Watched| {
        let later = watched.later();
        let note = |kind: usize| {
            let percent = 100.0 * share(later, kind, MOST);
            format!("{percent:.0} %, {:.1} m", radius(later, kind, 1))
        };
        CoveragePanel {
            name: watched.name.clone(),
            notes: [0, 1].map(note),
            fixed: watched.sliding(0, MOST),
            adaptive: watched.sliding(1, MOST),
        }
    };
    let panels: Vec<CoveragePanel> = recordings.iter().map(panel).collect();
    let title = "Share of true positions inside the regions of 90 %, over the minute before";
    coverage(title, LEVELS[MOST], &panels)
}
