//! Frames of standard input, read on a separate thread, so that forecasts do not wait for input.

use ddl::data::{ColumnChoice, DataError, Frame, FrameReader, TimeUnit};
use std::io::{BufRead, stdin};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

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
