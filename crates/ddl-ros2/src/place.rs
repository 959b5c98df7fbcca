//! The place that is watched: its tracks, its memory, its forecasts.

use crate::options::Options;
use crate::tell;
use anyhow::ensure;
use ddl::data::{Clock, Completeness, LiveTracks, Numbering, PedestrianNames, TimeUnit};
use ddl::{AdaptiveRegions, BuiltinModel, Ddl, DeviceChoice, LiveForecast, LiveForecaster, MemoryFile, ModelSource};
use ddl_ros::Observed;

/// Names of pedestrians that keep their numbers.
const MOST_NAMES: usize = 100_000;

pub(crate) struct Place {
    live: LiveForecaster<Ddl>,
    file: Option<MemoryFile>,
    joint: bool,
    numbering: Numbering,
    names: PedestrianNames,
    /// Microseconds of the last frame.
    last: Option<i64>,
}

impl Place {
    pub(crate) fn open(options: &Options) -> anyhow::Result<Self> {
        let device = DeviceChoice::Cpu;
        ddl::prepare(device, options.threads)?;
        let builtin = ModelSource::Builtin(BuiltinModel::default());
        let source = options.model.as_deref().map_or(builtin, ModelSource::named);
        let tracks = LiveTracks::with_clock(Clock::with_stamps(TimeUnit::Seconds))
            .with_completeness(Completeness::Partial)
            .with_max_age(options.max_age)
            .with_interval(options.rate.map_or(0.0, |rate| 1.0 / rate));
        let live = LiveForecaster::with_tracks(Ddl::open(&source, device)?, tracks);
        let mut place = Self {
            live: live.with_adaptive_regions(AdaptiveRegions::default()),
            file: None,
            joint: options.joint,
            numbering: Numbering::remembering(MOST_NAMES),
            names: PedestrianNames::default(),
            last: None,
        };
        if let Some(path) = &options.memory {
            let (file, memory) = MemoryFile::open(path)?;
            place.live = place.live.remembering(memory)?;
            place.file = Some(file);
        }
        Ok(place)
    }

    /// Adds a frame in fixed coordinates. `None` without pedestrians to forecast, or too soon after the last forecast.
    pub(crate) fn forecast(&mut self, observed: &Observed) -> anyhow::Result<Option<LiveForecast>> {
        let time = observed.header.stamp.microseconds();
        if let Some(last) = self.last
            && time <= last
        {
            let [time, last] = [time, last].map(|time| time as f64 / 1e6);
            ensure!(
                last - time > LiveTracks::LONGEST_GAP,
                "tracks of {time} s come after those of {last} s; a tracker must publish in order of time"
            );
            tell(&format!(
                "note: time goes back from {last} s to {time} s; all tracks begin anew"
            ));
            self.live.clear();
        }
        let (seen, newer) = observed.numbered(&mut self.numbering);
        let mut now = if self.joint {
            self.live.push_joint(time, seen, None)?
        } else {
            self.live.push(time, seen)?
        };
        self.last = Some(time);
        let window = now.as_ref().map(|now| &now.window);
        let is_kept = |id| window.is_none_or(|window| window.pedestrians().contains(&id));
        self.names = self.names.updated(&newer, is_kept);
        if let Some(now) = &mut now {
            now.window = now.window.clone().with_names(self.names.clone());
        }
        Ok(now)
    }

    /// Whether the last frame is one to forecast; without a forecast, nobody is observed well enough.
    pub(crate) fn is_moment(&self) -> bool {
        self.live.tracks().is_moment()
    }

    /// Number of rows of the last frame that do not fit their track.
    pub(crate) fn doubtful(&self) -> usize {
        self.live.tracks().misfits().len()
    }

    /// Writes the memory, if a minute has passed.
    pub(crate) fn save(&mut self) -> anyhow::Result<()> {
        if let (Some(file), Some(place)) = (&mut self.file, self.live.place())
            && file.is_due()
        {
            file.write(place)?;
        }
        Ok(())
    }

    /// Writes the memory for the last time.
    pub(crate) fn close(mut self) -> anyhow::Result<()> {
        if let (Some(file), Some(place)) = (&mut self.file, self.live.place())
            && let Some(reason) = file.end(place.clone())?
        {
            tell(&format!("warning: {reason}"));
        }
        Ok(())
    }
}
