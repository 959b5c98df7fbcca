//! `ddl forecast -`: from a tracker's lines, a forecast a frame.

use super::Forecast;
use crate::tracks::Clock;
use anyhow::{Context as _, bail};
use ddl::data::{Completion, Frame, FrameReader, Homography, LiveTracks, Window};
use std::fs::File;
use std::io::{ErrorKind, Write, stdin, stdout};

/// Forecasts from every frame as soon as it is whole, until standard input ends or nobody reads on.
pub(super) fn run(forecast: &Forecast) -> anyhow::Result<()> {
    let mut tracking = Tracking {
        completion: forecast.tracks.completion(),
        frame_step: forecast.tracks.live_frame_step()?,
        tracks: None,
        first: None,
    };
    let homography = forecast.tracks.homography()?;
    let model = forecast.model()?;
    let mut output: Box<dyn Write> = match &forecast.output {
        None => Box::new(stdout().lock()),
        Some(path) => Box::new(
            File::create(path).with_context(|| format!("cannot write {}", path.display()))?,
        ),
    };
    let mut frames = FrameReader::new(stdin().lock(), "standard input");
    let mut headed = true;
    while let Some(frame) = frames.next_frame()? {
        let frame = on_the_ground(frame, homography.as_ref())?;
        let Some(window) = tracking.push(frame)? else {
            continue;
        };
        let text = forecast.text(&model, &[window], Clock::WHOLE, headed)?;
        headed = false;
        let written = output.write_all(text.as_bytes());
        match written.and_then(|()| output.flush()) {
            // whoever reads has seen enough
            Err(error) if error.kind() == ErrorKind::BrokenPipe => return Ok(()),
            result => result.context("cannot write the forecasts")?,
        }
    }
    if headed {
        bail!(
            "standard input: nobody was seen long enough to be forecast; give --fps where frame numbers are not 0.4 s apart, or --frame-step"
        );
    }
    Ok(())
}

fn on_the_ground(mut frame: Frame, homography: Option<&Homography>) -> anyhow::Result<Frame> {
    let Some(homography) = homography else {
        return Ok(frame);
    };
    for (pedestrian, position) in &mut frame.people {
        *position = homography.apply(*position).with_context(|| {
            format!(
                "standard input: pedestrian {pedestrian}, frame {}: pixel {position:?} lies on the horizon of the homography",
                frame.number
            )
        })?;
    }
    Ok(frame)
}

/// Live tracks whose frame step may have to be learned from the first two frames.
struct Tracking {
    completion: Completion,
    frame_step: Option<i64>,
    tracks: Option<LiveTracks>,
    /// The first frame, until there is a second to learn from.
    first: Option<Frame>,
}

impl Tracking {
    /// Adds a frame; the window that ends there, if anybody can be forecast.
    fn push(&mut self, frame: Frame) -> anyhow::Result<Option<Window>> {
        if let Some(tracks) = &mut self.tracks {
            return Ok(tracks.push(frame.number, frame.people)?);
        }
        let step = match (self.frame_step, &self.first) {
            (Some(step), _) => step,
            (None, Some(first)) => {
                let step = frame.number - first.number;
                eprintln!(
                    "note: frames are taken to be {step} apart in 0.4 s, as the first two are; --fps or --frame-step says otherwise"
                );
                step
            }
            (None, None) => {
                self.first = Some(frame);
                return Ok(None);
            }
        };
        let tracks = LiveTracks::with_frame_step(step)?.completing(self.completion);
        let tracks = self.tracks.insert(tracks);
        if let Some(first) = self.first.take() {
            tracks.push(first.number, first.people)?;
        }
        Ok(tracks.push(frame.number, frame.people)?)
    }
}
