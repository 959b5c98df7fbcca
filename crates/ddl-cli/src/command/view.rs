use super::{KeepClear, Machine, ModelChoice};
use crate::output;
use crate::tracks::{Observed, Tracks};
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{OBSERVED, Window};
use ddl::report::Moment;
use ddl::report::page::Viewer;
use ddl::{Ddl, Forecast, Forecaster as _};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

/// Look at forecasts of your own tracks in the browser
///
/// Writes one page that needs no network: a player of moments of the recording, with everybody's hypotheses, their weights, goals and
/// certificates, and what then happened as far as it was seen.
#[derive(Debug, Args)]
#[command(mut_arg("file", |file| file.required(true)))]
#[command(
    after_help = "Examples:\n  ddl view tracks.csv\n  ddl view camera.csv --fps 25 --homography H.txt --output lobby.html --no-open"
)]
pub(crate) struct View {
    #[command(flatten)]
    model: ModelChoice,
    #[command(flatten)]
    tracks: Tracks,
    /// Moments to show, evenly spread over the recording
    #[arg(long, default_value_t = 60, value_parser = super::at_least_one)]
    moments: usize,
    /// Page to write [default: the name of the tracks with -forecasts.html, in this folder]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Only write the page; otherwise it is opened too, where standard output is a terminal
    #[arg(long)]
    no_open: bool,
    #[command(flatten)]
    clear: KeepClear,
    #[command(flatten)]
    machine: Machine,
}

impl View {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        if self.tracks.are_live() {
            bail!("a page is made of a file of tracks; `ddl forecast -` forecasts live ones");
        }
        output::ensure_not_input(self.output.as_deref(), self.tracks.file())?;
        self.machine.prepare_for_little()?;
        let model = self.clear.of(self.model.load(self.machine.device)?)?;
        let observed = self.tracks.observed(model.config())?;
        let chosen = spread(&observed.windows, self.moments);
        let page = page(&model, &chosen, &observed, self.tracks.file())?;
        let path = self.output.unwrap_or_else(|| {
            let stem = self.tracks.file().file_stem().unwrap_or_default();
            PathBuf::from(format!("{}-forecasts.html", stem.to_string_lossy()))
        });
        output::write_output(Some(&path), &page)?;
        output::print(&format!("{}\n", path.display()))?;
        if !self.no_open && std::io::stdout().is_terminal() {
            open(&path)?;
        }
        Ok(())
    }
}

fn open(path: &Path) -> anyhow::Result<()> {
    open::that_detached(path).with_context(|| {
        format!(
            "the page is written, but no browser could be started; open {} in one (--no-open does not try)",
            path.display()
        )
    })
}

fn spread(windows: &[Window], most: usize) -> Vec<Window> {
    let count = windows.len().min(most);
    (1..=count)
        .map(|k| windows[k * windows.len() / count - 1].clone())
        .collect()
}

fn page(
    model: &Ddl,
    windows: &[Window],
    observed: &Observed,
    file: &Path,
) -> anyhow::Result<String> {
    let forecasts = model.forecast_all(windows)?;
    let moment = |(window, forecast): (&Window, &Forecast)| {
        let seen = observed.recording.onward(window);
        let mut moment = Moment::under_way(model.name(), window, forecast, &seen)?;
        moment.frame = observed.clock.nearest(window.frames()[OBSERVED - 1]);
        Ok(moment)
    };
    let pairs = windows.iter().zip(&forecasts);
    let moments: Vec<Moment> = pairs.map(moment).collect::<anyhow::Result<_>>()?;
    let doubt = observed.doubt.as_ref();
    let doubt = doubt.map(|doubt| format!("Doubtful: {doubt} "));
    let lead = doubt.unwrap_or_default()
        + &format!(
            "{} of {} moments of {}: what was observed of each person, where each may go in the next 4.8 s, and what then happened as \
         far as it was seen.",
            windows.len(),
            observed.windows.len(),
            file.file_name().unwrap_or_default().display()
        );
    let mut notes = vec![format!(
        "Forecast by {} ({}); goals {}.",
        model.name(),
        model.source(),
        model.goal_model().words()
    )];
    notes.extend(certificates(&forecasts));
    notes.extend(unfamiliar(&forecasts));
    let viewer = Viewer {
        title: observed.recording.name(),
        lead: &lead,
        notes: &notes,
        moments: &moments,
    };
    Ok(viewer.to_html()?)
}

fn unfamiliar(forecasts: &[Forecast]) -> Option<String> {
    let all = forecasts
        .iter()
        .flat_map(|of| (0..of.pedestrians()).filter_map(move |i| of.familiarity(i)));
    let unlike = all
        .clone()
        .filter(|&familiarity| familiarity < ddl::UNFAMILIAR)
        .count();
    (unlike > 0).then(|| {
        format!(
            "{unlike} of {} motions are unlike those that the model was trained on (familiarity below {}): they are forecast nearly without the \
             network, and less sharply weighted.",
            all.count(),
            ddl::UNFAMILIAR
        )
    })
}

fn certificates(forecasts: &[Forecast]) -> Option<String> {
    let verdicts: Vec<bool> = forecasts
        .iter()
        .flat_map(|of| {
            let people = 0..of.pedestrians();
            people.flat_map(move |i| (0..of.hypotheses()).map(move |k| of.certified(i, k)))
        })
        .flatten()
        .collect();
    let held = verdicts.iter().filter(|&&holds| holds).count();
    (!verdicts.is_empty()).then(|| {
        format!(
            "Certificates: {held} of {} hypotheses come nearer to their goal at each of the 12 steps, along a flow that descends everywhere. \
             That says that the forecasts are stable, not that people will do as forecast.",
            verdicts.len()
        )
    })
}
