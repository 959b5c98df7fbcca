mod frames;
mod json_lines;
mod kept_memory;
mod left_out;
mod live;
mod table;

use super::{KeepClear, Machine, ModelChoice};
use crate::clock::{Clock, FrameNumber};
use crate::output::{ensure_not_input, write_output};
use crate::telling::tell;
use crate::tracks::Tracks;
use anyhow::bail;
use clap::{Args, ValueEnum};
use ddl::data::{HORIZON, OBSERVED, SceneName, Window};
use ddl::dynamics::LyapunovCertificate;
use ddl::{AdaptiveRegions, Calibration, CertifiedForecast, Ddl, Forecaster as _};
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::path::PathBuf;

/// Forecast the next 4.8 s of your own tracks
#[derive(Debug, Args)]
#[command(mut_arg("file", |file| file.required(true)))]
#[command(after_help = "Examples:\n  \
        ddl forecast tracks.csv --output forecasts.csv\n  \
        ddl forecast camera.csv --fps 25 --homography H.txt --last\n  \
        tracker | ddl forecast - --fps 10 --one --format jsonl\n  \
        tracker | ddl forecast - --fps 10 --memory hall.memory\n  \
        trackers | ddl forecast - --fps 10 --latest --format jsonl\n  \
        ddl forecast --model runs/eth tracks.csv --last --format jsonl --certificate")]
pub(crate) struct Forecast {
    #[command(flatten)]
    model: ModelChoice,
    #[command(flatten)]
    tracks: Tracks,
    /// File to write [default: standard output]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Format: csv (one row per position, to 0.1 mm) or jsonl (one JSON object per pedestrian, with all digits)
    #[arg(long, value_enum, default_value = "csv")]
    format: OutputFormat,
    /// One hypothesis per pedestrian instead of 20: to a central goal that represents the 20
    #[arg(long)]
    one: bool,
    /// With `-`: file of a scene memory, the earlier tracks of this place, which improves forecasts; created if
    /// missing, written every minute and at the end
    ///
    /// Use one file for each camera; for a stream of several scenes an existing folder, which gets a file SCENE.memory
    /// for each. The first 30 pedestrians show whether the memory is of this place; if it is not, the file is left
    /// unchanged and forecasts continue without it. `ddl data FILE` summarises the file.
    #[arg(long, value_name = "FILE")]
    memory: Option<PathBuf>,
    /// With `-`: if frames arrive faster than they are forecast, forecast only the latest of each scene, and report how
    /// many were dropped
    ///
    /// Without it every frame is forecast, and the writer of the stream has to wait. Tracks and memory use every frame
    /// in both cases. With a file as input nearly all frames would be dropped.
    #[arg(long)]
    latest: bool,
    /// Add to every hypothesis the evidence that it approaches its goal at every step
    ///
    /// A certificate holds when the distance to the goal falls at each of the 12 steps, along a flow that descends
    /// everywhere, and a pedestrian at its goal stays there. It refers to exactly the positions in JSON lines; csv
    /// rounds them to 0.1 mm. csv adds two columns, the distance to the goal at that frame (metres) and the verdict;
    /// jsonl adds the verdict and its evidence for each step. It proves that the forecast is stable, not that it is
    /// accurate. The variants star and no-dynamics have no certificates (with --one, only star).
    #[arg(long)]
    certificate: bool,
    /// Regions that contain the pedestrian with these probabilities at each step, such as 0.5,0.9: discs around the
    /// hypotheses
    ///
    /// csv adds a column of radii (metres) for each, empty where a hypothesis has no disc; jsonl adds the discs of each
    /// step. The initial regions were calibrated on other places. From frame to frame they adapt to the observations,
    /// so that they keep their share in this place too (docs/regions.md). --last uses the initial regions.
    #[arg(long, value_name = "PROBABILITIES", value_delimiter = ',', value_parser = probability)]
    #[arg(conflicts_with = "one")]
    region: Vec<f64>,
    #[command(flatten)]
    clear: KeepClear,
    #[command(flatten)]
    machine: Machine,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OutputFormat {
    Csv,
    Jsonl,
}

/// Number of lines above which a terminal gets a note.
const LOOKED_THROUGH: usize = 100;
/// Bytes above which the output counts as large.
const LARGE: usize = 50 << 20;

/// State that one chunk of forecasts passes on to the next.
#[derive(Debug, Default)]
struct Onward {
    headed: bool,
    /// Whether the warning about unfamiliar motions has been given.
    warned: bool,
    /// The adaptive regions of each scene.
    regions: BTreeMap<Option<SceneName>, AdaptiveRegions>,
}

/// Windows in order of time, and the scene of each; no scenes if the tracks name none.
type Windows<'a> = (&'a [Window], &'a [Option<SceneName>]);

struct Moment<'a> {
    scene: Option<&'a SceneName>,
    window: &'a Window,
    forecast: &'a ddl::Forecast,
    certified: Option<&'a CertifiedForecast>,
    clock: Clock,
}

impl Forecast {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        self.machine.prepare_for_little()?;
        let mut levels = self.region.iter().enumerate();
        if let Some((_, twice)) = levels.find(|(i, level)| self.region[..*i].contains(level)) {
            bail!("--region names {twice} twice; name each probability once");
        }
        if self.memory.is_some() && !self.tracks.are_live() {
            bail!("--memory is for live tracks from standard input: `tracker | ddl forecast - --memory FILE`");
        }
        if self.latest && !self.tracks.are_live() {
            bail!(
                "--latest is for tracks as they come; write them to standard input: `trackers | ddl forecast - \
                 --latest`"
            );
        }
        if let Some(memory) = &self.memory {
            ensure_not_input(self.output.as_deref(), memory)?;
            if self.output.as_ref() == Some(memory) {
                bail!(
                    "--output and --memory name the same file, {}; give another file for the forecasts",
                    memory.display()
                );
            }
        }
        if self.tracks.are_live() {
            return live::run(&self);
        }
        ensure_not_input(self.output.as_deref(), self.tracks.file())?;
        let model = self.model()?;
        let observed = self.tracks.observed(model.config())?;
        let text = self.text(&model, (&observed.windows, &[]), observed.clock, &mut Onward::default())?;
        write_output(self.output.as_deref(), &text)?;
        self.warn_of_flood(&text);
        observed.tell_what_is_made_up();
        Ok(())
    }

    /// Notes how to reduce large output: thousands of lines on a terminal, or a large file.
    fn warn_of_flood(&self, text: &str) {
        let on_terminal = self.output.is_none() && std::io::stdout().is_terminal();
        if on_terminal && text.lines().nth(LOOKED_THROUGH).is_some() {
            let lines = text.lines().count();
            tell(format_args!(
                "note: {lines} lines; --output FILE writes them to a file, --last and --one reduce them, `ddl view` \
                 shows them"
            ));
        } else if text.len() > LARGE {
            tell(format_args!(
                "note: {} MiB, because all pedestrians are forecast from every frame; --last and --one reduce the \
                 output",
                text.len() >> 20
            ));
        }
    }

    fn model(&self) -> anyhow::Result<Ddl> {
        let model = self.model.load(self.machine.device)?;
        Ok(self.clear.of(model)?)
    }

    /// Forecasts of the windows in order of time, as text. The first text starts with the names of the columns, if the
    /// format has any.
    fn text(
        &self,
        model: &Ddl,
        (windows, scenes): Windows<'_>,
        clock: Clock,
        onward: &mut Onward,
    ) -> anyhow::Result<String> {
        let scene = |i: usize| scenes.get(i).and_then(Option::as_ref);
        let (mut certified, mut forecasts);
        let moments: Vec<Moment<'_>> = if self.certificate {
            certified = if self.one {
                model.forecast_central_certified(windows)?
            } else {
                model.forecast_certified(windows)?
            };
            if !self.region.is_empty() {
                certified = onward.adapted_certified((windows, scenes), certified);
            }
            let pairs = windows.iter().zip(&certified);
            let each = pairs.enumerate();
            each.map(|(i, pair)| Moment::certified(pair, scene(i), clock)).collect()
        } else {
            forecasts = if self.one {
                model.forecast_central(windows)?
            } else {
                model.forecast_all(windows)?
            };
            if !self.region.is_empty() {
                forecasts = onward.adapted((windows, scenes), forecasts);
            }
            let pairs = windows.iter().zip(&forecasts);
            let each = pairs.enumerate();
            each.map(|(i, pair)| Moment::plain(pair, scene(i), clock)).collect()
        };
        warn_of_violation(&moments);
        onward.warned = onward.warned || self.warn_of_unfamiliar(&moments);
        let headed = !std::mem::replace(&mut onward.headed, true);
        match self.format {
            OutputFormat::Csv => table::csv(&moments, headed, &self.region),
            OutputFormat::Jsonl => json_lines::json_lines(&moments, &self.region),
        }
    }

    /// Warns of motions unlike the training motions, whose forecasts are less certain; returns whether there are any.
    fn warn_of_unfamiliar(&self, moments: &[Moment<'_>]) -> bool {
        let all = moments
            .iter()
            .flat_map(|moment| (0..moment.window.len()).map(move |i| (moment, i)));
        let familiarity = |&(moment, i): &(&Moment<'_>, usize)| moment.forecast.familiarity(i);
        let mut unfamiliar = all
            .clone()
            .filter(|of| familiarity(of).is_some_and(|f| f < ddl::UNFAMILIAR_THRESHOLD));
        let Some((moment, i)) = unfamiliar.next() else {
            return false;
        };
        let count = 1 + unfamiliar.count();
        let later = if self.tracks.are_live() {
            "; this warning appears once, but each forecast has its familiarity"
        } else {
            ""
        };
        tell(format_args!(
            "warning: {count} of {} motions are unlike the training motions (familiarity below {}), first that of \
             pedestrian {} observed until frame {}: their forecasts use little of the network, and their weights are \
             flatter{later}",
            all.count(),
            ddl::UNFAMILIAR_THRESHOLD,
            moment.who(i),
            moment.observed_until(),
        ));
        true
    }
}

impl Onward {
    fn regions(&mut self, scenes: &[Option<SceneName>], i: usize) -> &mut AdaptiveRegions {
        let scene = scenes.get(i).cloned().flatten();
        self.regions.entry(scene).or_default()
    }

    fn adapted(&mut self, (windows, scenes): Windows<'_>, forecasts: Vec<ddl::Forecast>) -> Vec<ddl::Forecast> {
        let pairs = windows.iter().zip(forecasts).enumerate();
        pairs
            .map(|(i, (window, forecast))| self.regions(scenes, i).adapt(window, forecast))
            .collect()
    }

    fn adapted_certified(
        &mut self,
        (windows, scenes): Windows<'_>,
        mut certified: Vec<CertifiedForecast>,
    ) -> Vec<CertifiedForecast> {
        for (i, (window, certified)) in windows.iter().zip(&mut certified).enumerate() {
            let forecast = certified.forecast.clone();
            certified.forecast = self.regions(scenes, i).adapt(window, forecast);
        }
        certified
    }

    fn forget(&mut self, scene: &SceneName) {
        self.regions.remove(&Some(scene.clone()));
    }
}

fn probability(text: &str) -> Result<f64, String> {
    let [low, high] = Calibration::fitted().regions.range();
    let level: f64 = text.trim().parse().map_err(|error| format!("{error}"))?;
    if (low..=high).contains(&level) {
        return Ok(level);
    }
    Err(format!("the probability of a region must be from {low} to {high}"))
}

impl<'a> Moment<'a> {
    fn plain((window, forecast): (&'a Window, &'a ddl::Forecast), scene: Option<&'a SceneName>, clock: Clock) -> Self {
        Self {
            scene,
            window,
            forecast,
            certified: None,
            clock,
        }
    }

    fn certified(
        (window, certified): (&'a Window, &'a CertifiedForecast),
        scene: Option<&'a SceneName>,
        clock: Clock,
    ) -> Self {
        Self {
            scene,
            window,
            forecast: &certified.forecast,
            certified: Some(certified),
            clock,
        }
    }

    fn certificate(&self, i: usize, hypothesis: usize) -> Option<&'a LyapunovCertificate<f64>> {
        Some(self.certified?.certificate(i, hypothesis))
    }

    /// The name of a pedestrian in messages.
    fn who(&self, i: usize) -> String {
        let name = self.window.name(i);
        match self.scene {
            None => name.to_string(),
            Some(scene) => format!("{name} of scene {scene}"),
        }
    }

    fn observed_until(&self) -> FrameNumber {
        self.clock.number(self.window.frames()[OBSERVED - 1])
    }

    fn frames(&self) -> Vec<FrameNumber> {
        let (last, step) = (self.window.frames()[OBSERVED - 1], self.window.frame_step());
        let frames = (1..=HORIZON as i64).map(|t| self.clock.number(last + t * step));
        frames.collect()
    }
}

/// Stable steps keep the guarantee for any output of the network. If one violates it, a user who relies on the
/// forecasts must know.
fn warn_of_violation(moments: &[Moment<'_>]) {
    let first = moments.iter().find_map(|moment| {
        let (i, hypothesis, violation) = moment.certified?.first_violation()?;
        Some((moment, i, hypothesis, violation))
    });
    if let Some((moment, i, hypothesis, violation)) = first {
        tell(format_args!(
            "warning: not every certificate holds; the first that does not is that of pedestrian {}, \
             observed until frame {}, hypothesis {hypothesis}: {violation}",
            moment.who(i),
            moment.observed_until(),
        ));
    }
}
