//! Frames of standard input, read on a separate thread, so that forecasts do not wait for input.

use crate::units::Units;
use anyhow::{Context as _, bail};
use ddl::data::{Clock, ColumnChoice, DataError, Frame, FrameReader, Homography, Observation, TimeUnit};
use std::io::{BufRead, stdin};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

/// Largest difference of frame numbers that is taken for a step of 0.4 s. A larger one may be a gap, or timestamps.
const LONGEST_STEP: i64 = 1000;
/// Number of frames that are read ahead. When they are full, the thread waits, and so does the writer of the stream.
const AHEAD: usize = 64;

/// What the lines so far state about time, and notes on them.
#[derive(Debug, Clone)]
pub(super) struct StatedTime {
    /// Of TrajNet++ scenes.
    pub(super) rows_a_second: Option<f64>,
    /// Of a comment.
    pub(super) frame_rate: Option<f64>,
    pub(super) time_unit: Option<TimeUnit>,
    pub(super) notes: Vec<String>,
}

impl StatedTime {
    fn by<R: BufRead>(frames: &mut FrameReader<R>) -> Self {
        Self {
            rows_a_second: frames.rate(),
            frame_rate: frames.frame_rate(),
            time_unit: frames.time_unit(),
            notes: frames.take_notes(),
        }
    }

    /// The clock if no option gives it, and the reason if it is assumed; `None` if it needs another frame.
    ///
    /// `apart`: difference of the first two frame numbers of a scene.
    pub(super) fn clock(&self, units: &Units, apart: Option<i64>) -> anyhow::Result<Option<(Clock, Option<String>)>> {
        if let Some(unit) = self.time_unit {
            return Ok(Some((Clock::with_stamps(unit), None)));
        }
        if let Some(rate) = self.frame_rate {
            let clock = Clock::with_frame_time(1.0 / rate).context("standard input: the rate of a comment")?;
            return Ok(Some((clock, Some(format!("at {rate} frames a second")))));
        }
        let Some(apart) = apart else {
            return Ok(None);
        };
        if let Some(rate) = self.rows_a_second {
            let clock = Clock::with_frame_time(1.0 / (rate * apart as f64)).with_context(|| {
                format!(
                    "standard input: the scenes give {rate} frames per second, but the first two frames are {apart} \
                     apart"
                )
            })?;
            return Ok(Some((clock, Some(format!("from the fps of the scenes, {rate}")))));
        }
        if let Some((clock, reason)) = units.remembered_live_clock()? {
            return Ok(Some((clock, Some(reason))));
        }
        if apart > LONGEST_STEP {
            bail!(
                "standard input: the first two frames are {apart} apart; give the number of frames in 0.4 s with --fps \
                 or --frame-step"
            );
        }
        let clock = Clock::with_frame_step(apart)?;
        Ok(Some((clock, Some("the difference of the first two frames".to_owned()))))
    }
}

pub(super) enum Incoming {
    Frame(Frame, StatedTime),
    /// An invalid line, which is left out.
    Wrong(DataError),
    /// The error that ends the stream. Earlier frames have been sent.
    End(DataError),
}

pub(super) struct IncomingFrames(Receiver<Incoming>);

impl IncomingFrames {
    pub(super) fn of_standard_input(columns: ColumnChoice) -> anyhow::Result<Self> {
        let (send, received) = sync_channel(AHEAD);
        let name = "standard input";
        let thread = thread::Builder::new().name(name.to_owned());
        // The thread ends with the input, when the receiver is dropped, or with the process.
        thread.spawn(move || read(FrameReader::new(stdin().lock(), name).with_columns(columns), &send))?;
        Ok(Self(received))
    }

    /// Waits for the next item; `None` at the end.
    pub(super) fn wait(&self) -> Option<Incoming> {
        self.0.recv().ok()
    }

    /// The next item that has already arrived; `None` if there is none, or at the end.
    pub(super) fn come(&self) -> Option<Incoming> {
        self.0.try_recv().ok()
    }
}

/// Sends every frame. In a stream with scene names an invalid line is left out, so that the other cameras continue. Any
/// other stream ends at an invalid line, after the frames before it.
fn read<R: BufRead>(mut frames: FrameReader<R>, to: &SyncSender<Incoming>) {
    loop {
        let incoming = match frames.next_frame() {
            Ok(None) => return,
            Ok(Some(frame)) => Incoming::Frame(frame, StatedTime::by(&mut frames)),
            Err(error @ DataError::Format(_)) if frames.names_scenes() => Incoming::Wrong(error),
            Err(error) => {
                while let Some(frame) = frames.unfinished() {
                    if to.send(Incoming::Frame(frame, StatedTime::by(&mut frames))).is_err() {
                        return;
                    }
                }
                Incoming::End(error)
            }
        };
        let is_last = matches!(incoming, Incoming::End(_));
        if to.send(incoming).is_err() || is_last {
            return;
        }
    }
}

/// The frame in metres.
pub(super) fn to_ground(mut frame: Frame, homography: Option<&Homography>) -> anyhow::Result<Frame> {
    let Some(homography) = homography else {
        return Ok(frame);
    };
    for (pedestrian, position) in &mut frame.pedestrians {
        let seen = Observation::new(frame.number, *pedestrian, *position);
        *position = homography.place(&seen, &frame.names).context("standard input")?;
    }
    Ok(frame)
}
