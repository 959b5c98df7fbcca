//! The place that is watched: its tracks, its memory, its forecasts.

use crate::health::Health;
use crate::options::NodeArguments;
use crate::tell;
use anyhow::{anyhow, ensure};
use ddl::data::{Clock, Completeness, LiveTracks, Numbering, TimeUnit, Window};
use ddl::{Answer, BuiltinModel, Ddl, DeviceChoice, ModelSource, Note, Request, SceneBatch, Session, SessionMemory};
use ddl_ros::Observed;
use ddl_ros::msg::Header;

/// Names of pedestrians that keep their numbers.
const MOST_NAMES: usize = 100_000;

/// The moment of a frame, with its answer where somebody is observed well enough.
pub(crate) type FrameForecast = (Header, Option<(Window, Answer)>);

pub(crate) struct WatchedPlace {
    /// One scene, without a name.
    session: Session<Ddl>,
    numbering: Numbering,
    /// Microseconds of the last frame.
    last: Option<i64>,
    /// The frame to forecast next.
    moment: Option<Header>,
}

impl WatchedPlace {
    pub(crate) fn open(options: &NodeArguments) -> anyhow::Result<Self> {
        let device = DeviceChoice::Cpu;
        ddl::prepare(device, options.threads)?;
        let builtin = ModelSource::Builtin(BuiltinModel::default());
        let source = options.model.as_deref().map_or(builtin, ModelSource::named);
        let every = options.rate.map_or(0.0, |rate| 1.0 / rate);
        let tracks = LiveTracks::with_clock(Clock::with_stamps(TimeUnit::Seconds))
            .with_completeness(Completeness::Partial)
            .with_max_age(options.max_age)
            .with_interval(every);
        let request = if options.joint { Request::joint() } else { Request::default() };
        let mut session = Session::new(Ddl::open(&source, device)?, tracks, request.with_adaptive_regions())?;
        if let Some(path) = &options.memory {
            session = session.remembering(SessionMemory::in_file(path)?)?;
        }
        Ok(Self {
            session: session.latest_only(),
            numbering: Numbering::remembering(MOST_NAMES),
            last: None,
            moment: None,
        })
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
            self.session.clear(None);
        }
        let (seen, names) = observed.numbered(&mut self.numbering);
        let notes = self.session.observe(None, time, seen, &names)?;
        self.last = Some(time);
        if self.session.tracks(None).is_some_and(LiveTracks::is_moment) {
            self.moment = Some(observed.header.clone());
        }
        for note in notes {
            match note {
                Note::Misfits { misfits, .. } => health.doubtful += misfits.len(),
                note => health.warn(&note.to_string()),
            }
        }
        Ok(())
    }

    /// Forecasts the newest frame; earlier ones that were not forecast are skipped. `None` without a new frame; no
    /// answer if no pedestrian has enough observed rows.
    pub(crate) fn forecast(&mut self) -> anyhow::Result<Option<FrameForecast>> {
        let Some(header) = self.moment.take() else {
            return Ok(None);
        };
        let mut batch = self.session.next_batch(SceneBatch::PEDESTRIANS);
        let answer = self.session.answer(batch.windows())?.pop();
        Ok(Some((header, batch.windows.pop().zip(answer))))
    }

    /// Number of frames that were skipped.
    pub(crate) fn skipped(&self) -> u64 {
        self.session.waiting().dropped()
    }

    /// Writes the memory, if a minute has passed; it costs no forecast.
    pub(crate) fn save(&mut self, health: &mut Health) {
        self.session.write_due().iter().for_each(|note| health.fault(&anyhow!("{note}")));
    }

    /// Writes the memory for the last time.
    pub(crate) fn close(mut self) -> anyhow::Result<()> {
        for note in self.session.close() {
            match note {
                Note::MemoryFailed(error) => return Err(error.into()),
                note => tell(&note.line()),
            }
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
        let (mut health, options) = (Health::default(), NodeArguments::parse_from(["node", "--rate=2"]));
        let mut place = WatchedPlace::open(&options).unwrap();
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
        let expected = "ann@10000000 waits ann@10800000 refused refused ann@8000000 ann@8600000";
        assert_eq!((&*said.join(" "), health.restarts, health.doubtful), (expected, 1, 0));
        assert!(place.forecast().unwrap().is_none());
    }
}
