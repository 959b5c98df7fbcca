//! The place that is watched: its tracks, its memory, its forecasts.

use crate::health::Health;
use crate::options::Options;
use crate::tell;
use anyhow::ensure;
use ddl::data::{Clock, Completeness, LiveTracks, Numbering, PedestrianNames, TimeUnit, Window};
use ddl::{
    AdaptiveRegions, BuiltinModel, Ddl, DeviceChoice, Forecast, Forecaster as _, LiveScenes, MemoryFile, ModelSource,
    PlaceMemory,
};
use ddl_ros::Observed;
use ddl_ros::msg::Header;

/// Names of pedestrians that keep their numbers.
const MOST_NAMES: usize = 100_000;

pub(crate) struct Place {
    model: Ddl,
    /// One scene, without a name.
    scenes: LiveScenes,
    regions: AdaptiveRegions,
    file: Option<MemoryFile>,
    joint: bool,
    numbering: Numbering,
    names: PedestrianNames,
    /// Microseconds of the last frame.
    last: Option<i64>,
    /// The frame to forecast next, and the names in it.
    moment: Option<(Header, PedestrianNames)>,
}

/// The forecast of a frame, and the window that it is of.
pub(crate) type WindowForecast = (Window, Forecast);

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
        let mut place = Self {
            model: Ddl::open(&source, device)?,
            scenes: LiveScenes::new(tracks).latest_only(),
            regions: AdaptiveRegions::default(),
            file: None,
            joint: options.joint,
            numbering: Numbering::remembering(MOST_NAMES),
            names: PedestrianNames::default(),
            last: None,
            moment: None,
        };
        if let Some(path) = &options.memory {
            let (file, memory) = MemoryFile::open(path)?;
            place.scenes.remember(None, &place.model, memory)?;
            place.file = Some(file);
        }
        Ok(place)
    }

    /// Adds a frame in fixed coordinates.
    pub(crate) fn observe(&mut self, observed: &Observed, health: &mut Health) -> anyhow::Result<()> {
        let time = observed.header.stamp.microseconds();
        if let Some(last) = self.last
            && time <= last
        {
            let [time, last] = [time, last].map(|time| time as f64 / 1e6);
            ensure!(
                last - time > LiveTracks::LONGEST_GAP,
                "tracks of {time} s come after those of {last} s; one tracker must publish, in order of time"
            );
            health.restarts += 1;
            health.warn(&format!(
                "time goes back from {last} s to {time} s, and all tracks begin anew; is there a second tracker?"
            ));
            self.regions.clear();
            self.scenes.clear(None);
        }
        let (seen, newer) = observed.numbered(&mut self.numbering);
        self.scenes.observe(None, time, seen)?;
        if let Some(why) = self.scenes.place(None).and_then(PlaceMemory::refused) {
            health.warn(&format!("{why}; its file stays as it is"));
        }
        self.last = Some(time);
        self.names = self.names.updated(&newer, |_| true);
        let tracks = self.scenes.tracks(None);
        if tracks.is_some_and(LiveTracks::is_moment) {
            self.moment = Some((observed.header.clone(), newer));
        }
        health.doubtful += tracks.map_or(0, |tracks| tracks.misfits().len());
        Ok(())
    }

    /// Forecasts the newest frame; earlier ones that were not forecast are skipped. `None` without a new frame; no
    /// forecast where nobody is observed well enough.
    pub(crate) fn forecast(&mut self) -> anyhow::Result<Option<(Header, Option<WindowForecast>)>> {
        let Some((header, names)) = self.moment.take() else {
            return Ok(None);
        };
        let Some(window) = self.scenes.next_batch(LiveScenes::BATCH).windows.pop() else {
            self.names = names;
            return Ok(Some((header, None)));
        };
        // The names determine the random numbers of joint futures.
        let window = window.with_names(self.names.clone());
        let forecast = if self.joint {
            let windows = std::slice::from_ref(&window);
            self.model.forecast_scenes(windows, None)?.remove(0)
        } else {
            self.regions.adapt(&window, self.model.forecast(&window)?)
        };
        let is_kept = |id| window.pedestrians().contains(&id);
        self.names = self.names.updated(&PedestrianNames::default(), is_kept);
        Ok(Some((header, Some((window, forecast)))))
    }

    /// Number of frames that were skipped.
    pub(crate) fn skipped(&self) -> u64 {
        self.scenes.dropped()
    }

    /// Writes the memory, if a minute has passed.
    pub(crate) fn save(&mut self) -> anyhow::Result<()> {
        Ok(MemoryFile::write_if_due(self.file.as_mut(), self.scenes.place(None))?)
    }

    /// Writes the memory for the last time.
    pub(crate) fn close(mut self) -> anyhow::Result<()> {
        if let (Some(file), Some(place)) = (&mut self.file, self.scenes.place(None))
            && let Some(reason) = file.end(place.clone())?
        {
            tell(&format!("warning: {reason}"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;
    use ddl_ros::SeenPedestrian;
    use ddl_ros::msg::Time;

    #[test]
    fn tracks_begin_anew_when_time_goes_back_and_names_are_kept() {
        let (mut health, options) = (Health::default(), Options::parse_from(["node", "--rate=2"]));
        let mut place = Place::open(&options).unwrap();
        // Two forecasts a second; more than 2 s back is another beginning.
        let said = [10_000, 10_400, 10_800, 10_800, 9_000, 8_000, 8_600].map(|milliseconds| {
            let mut ann = SeenPedestrian::default();
            (ann.name, ann.position.x) = ("ann".to_owned(), f64::from(milliseconds % 2_000) / 1e3);
            let (stamp, frame_id) = (Time::of_microseconds(1000 * i64::from(milliseconds)), String::new());
            match place.observe(&Observed::new(Header { stamp, frame_id }, vec![ann]), &mut health) {
                Err(_) => "refused".to_owned(),
                Ok(()) => match place.forecast().unwrap() {
                    None => "waits".to_owned(),
                    Some((_, None)) => "nobody".to_owned(),
                    Some((header, Some((window, _)))) => format!("{}@{}", window.name(0), header.stamp.microseconds()),
                },
            }
        });
        let expected = "nobody waits ann@10800000 refused refused nobody ann@8600000";
        assert_eq!((&*said.join(" "), health.restarts, health.doubtful), (expected, 1, 0));
        assert!(place.forecast().unwrap().is_none());
    }
}
