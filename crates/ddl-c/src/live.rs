//! The tracks of one place, frame by frame.

use crate::answer::{Held, LiveNotes, ShownAnswer, warning_of};
use crate::boundary::CallFailure;
use crate::layout::ddl_live_options;
use crate::model::{LoadedModel, Threads};
use ddl::data::{Clock, LiveTracks, PedestrianId, Position, TimeUnit};
use ddl::memory::PlaceMemory;
use ddl::{Ddl, Note, Request, Session, SessionMemory, WindowOptions};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

#[derive(Debug)]
pub(crate) struct LivePlace {
    session: Mutex<Session<Arc<Ddl>>>,
    threads: Arc<Threads>,
}

impl LivePlace {
    pub(crate) fn new(
        model: &LoadedModel,
        options: &ddl_live_options<'_>,
        memory: Option<&str>,
    ) -> Result<Self, CallFailure> {
        let session = Session::new(Arc::clone(&model.ddl), tracks(options)?, Request::default());
        let mut session = session.map_err(CallFailure::invalid)?;
        if let Some(path) = memory {
            let memory = SessionMemory::in_file(Path::new(path));
            session = memory.and_then(|memory| session.remembering(memory)).map_err(CallFailure::file)?;
        }
        Ok(Self { session: Mutex::new(session), threads: Arc::clone(&model.threads) })
    }

    /// Adds a frame and writes its forecast to `answer`, without pedestrians if none can be forecast. Between two
    /// forecasts, `answer` keeps the previous one.
    pub(crate) fn observe(
        &self,
        at: f64,
        seen: Vec<(PedestrianId, Position)>,
        request: Request,
        answer: &mut ShownAnswer,
    ) -> Result<(), CallFailure> {
        let mut session = self.held();
        let session = &mut *session;
        let request = request.with_adaptive_regions();
        let now = self.threads.run(|| {
            session.ask(request).map_err(CallFailure::invalid)?;
            session.push_at(at, seen).map_err(CallFailure::invalid)
        })?;
        let place = session.place(None);
        let refused = place.and_then(PlaceMemory::refused).map(|refusal| refusal.to_string());
        let notes = LiveNotes {
            misfits: now.notes.iter().flat_map(Note::misfits).map(|noted| noted.misfit).collect(),
            remembered: place.map_or(0, |place| place.memory().segments()),
            warning: refused.into_iter().chain(warning_of(&now.notes)).reduce(|all, one| all + "; " + &one),
        };
        if now.is_due {
            let threads = &self.threads;
            let held = now.answer.map(|(window, answer)| Held { window, answer, threads: Arc::clone(threads) });
            answer.hold(held, &notes);
        } else {
            answer.keep(&notes);
        }
        Ok(())
    }

    pub(crate) fn clear(&self) {
        self.held().clear(None);
    }

    /// Writes the memory and closes its file. The error says why the file is unchanged.
    pub(crate) fn close(&self) -> Result<(), CallFailure> {
        let unchanged = self.held().close().into_iter().find(|note| !matches!(note, Note::MemoryKept { .. }));
        unchanged.map_or(Ok(()), |note| Err(CallFailure::file(note.to_string())))
    }

    /// A panic has left the tracks as they were before the frame.
    fn held(&self) -> MutexGuard<'_, Session<Arc<Ddl>>> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn tracks(options: &ddl_live_options<'_>) -> Result<LiveTracks, CallFailure> {
    let ddl_live_options { rate, whole, every, max_age, .. } = *options;
    if !(rate >= 0.0 && rate.is_finite()) {
        return Err(CallFailure::invalid(format!("`rate` is {rate}; it must be frames per second, or 0 for times")));
    }
    let clock = match rate {
        0.0 => Clock::with_stamps(TimeUnit::Seconds),
        rate => Clock::with_frame_time(rate.recip()).map_err(CallFailure::invalid)?,
    };
    let windows = WindowOptions { whole, max_age: max_age.copied(), every: Some(every), last: false };
    windows.tracks(LiveTracks::with_clock(clock)).map_err(CallFailure::invalid)
}
