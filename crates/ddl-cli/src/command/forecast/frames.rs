//! Frames of standard input, read on a thread of its own: who forecasts never waits for a line while something can be
//! forecast.

use ddl::data::{DataError, Frame, FrameReader};
use std::io::{BufRead, stdin};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

/// Frames that are read ahead. When they are there, the thread waits, and whoever writes the lines is held back.
const AHEAD: usize = 64;

pub(super) enum Incoming {
    /// And how many frames follow each other in a second, where the lines so far have said so.
    Frame(Frame, Option<f64>),
    /// A line that is left out.
    Wrong(DataError),
    /// Why no more can be read. What was read before has come.
    End(DataError),
}

pub(super) struct Frames(Receiver<Incoming>);

impl Frames {
    pub(super) fn of_standard_input() -> anyhow::Result<Self> {
        let (send, received) = sync_channel(AHEAD);
        let name = "standard input";
        let thread = thread::Builder::new().name(name.to_owned());
        // It ends with the input, when nobody listens any more, or with the process.
        thread.spawn(move || read(FrameReader::new(stdin().lock(), name), &send))?;
        Ok(Self(received))
    }

    /// What comes next; `None` at the end.
    pub(super) fn wait(&self) -> Option<Incoming> {
        self.0.recv().ok()
    }

    /// What has come already; `None` where nothing has, or at the end.
    pub(super) fn come(&self) -> Option<Incoming> {
        self.0.try_recv().ok()
    }
}

/// Sends every frame. In a stream that names scenes a wrong line is left out: it is no reason to stop what other
/// cameras are answered. Any other stream ends there, after what was read before.
fn read<R: BufRead>(mut frames: FrameReader<R>, to: &SyncSender<Incoming>) {
    loop {
        let incoming = match frames.next_frame() {
            Ok(None) => return,
            Ok(Some(frame)) => Incoming::Frame(frame, frames.rate()),
            Err(error @ DataError::Format(_)) if frames.names_scenes() => Incoming::Wrong(error),
            Err(error) => {
                while let Some(frame) = frames.unfinished() {
                    if to.send(Incoming::Frame(frame, frames.rate())).is_err() {
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
