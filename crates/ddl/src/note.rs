//! What was assumed, dropped or doubted.

use crate::error::DdlError;
use crate::trust::familiarity::UNFAMILIAR_THRESHOLD;
use ddl_core::{OBSERVED, PedestrianName, PedestrianNames, Setting};
use ddl_data::{Clock, Misfit, PlausibilityWarning, SceneName};
use ddl_memory::{Refusal, Unsaved};
use std::fmt::{Display, Formatter, Result};
use std::path::PathBuf;
use std::sync::Arc;

/// A remark on tracks, forecasts or memories, with its place and count. Its text names settings as the users of this
/// process [write](ddl_core::word_settings) them.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the texts describe the fields")]
pub enum Note {
    /// What the reader of a file assumed or left out.
    Reader(String),
    /// The frames in 0.4 s, where nobody gives the rate.
    AssumedStep { step: String },
    /// Pedestrians without common frames.
    OwnClocks,
    /// Speeds that suggest wrong units or a wrong rate, which give meaningless forecasts.
    Implausible(PlausibilityWarning),
    /// Forecasts of pedestrians who were tracked for less than 8 steps, of some of them so short that their velocity is
    /// hardly known, or who were carried on from an earlier row.
    Estimated { forecasts: usize, late: usize, hardly: usize, carried: usize },
    /// Noise on each axis, metres, that observed paths are smoothed for.
    Noise { metres: f64 },
    /// Rows that do not fit their tracks, at least one.
    Misfits { scene: Option<SceneName>, misfits: Vec<MisfitNote> },
    /// Pedestrians who are in no window.
    NeverForecast { count: usize, of: usize, first: PedestrianName },
    /// A file that goes on after its last window.
    EndsEarly { end: String, last: String },
    /// Motions unlike the training motions.
    Unfamiliar { count: usize, of: usize, first: String },
    /// The memory of a file is of another place.
    MemoryRefused { path: PathBuf, refusal: Refusal },
    /// The memory could not be written; it is tried again.
    MemoryUnwritten(Arc<DdlError>),
    /// A scene goes on without a memory, or its last memory could not be written.
    MemoryFailed(Arc<DdlError>),
    /// A file is unchanged at the end.
    MemoryUnsaved { unsaved: Unsaved, is_refusal_told: bool },
    /// A file was written at the end.
    MemoryKept { path: PathBuf, segments: usize },
}

/// A row that does not fit its track, in the words of its file or stream.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MisfitNote {
    /// The row.
    pub misfit: Misfit,
    /// The name of its pedestrian.
    pub pedestrian: PedestrianName,
    /// Its frame or time in words.
    pub when: String,
}

impl MisfitNote {
    pub(crate) fn all(misfits: &[Misfit], names: &PedestrianNames, clock: Clock) -> Vec<Self> {
        let noted = misfits.iter().map(|misfit| Self {
            misfit: *misfit,
            pedestrian: names.of(misfit.pedestrian),
            when: clock.words(misfit.tick),
        });
        noted.collect()
    }
}

impl Note {
    /// How grave it is, as messages begin: `note`, `warning` or `error`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Implausible(_)
            | Self::Misfits { .. }
            | Self::Unfamiliar { .. }
            | Self::MemoryRefused { .. }
            | Self::MemoryUnwritten(_)
            | Self::MemoryUnsaved { .. } => "warning",
            Self::MemoryFailed(_) => "error",
            _ => "note",
        }
    }

    /// The remark after its kind: `note: ...`.
    pub fn line(&self) -> String {
        format!("{}: {self}", self.kind())
    }

    /// The rows that do not fit their tracks, if it is about such.
    pub fn misfits(&self) -> &[MisfitNote] {
        match self {
            Self::Misfits { misfits, .. } => misfits,
            _ => &[],
        }
    }
}

impl Display for Note {
    fn fmt(&self, to: &mut Formatter<'_>) -> Result {
        match self {
            Self::Reader(text) => to.write_str(text),
            Self::AssumedStep { step } => {
                let [fps, dt, frames] = [Setting::Fps, Setting::Dt, Setting::FrameStep];
                write!(to, "a step of 0.4 s is taken as {step}; give {fps}, {dt} or {frames} if this is wrong")
            }
            Self::OwnClocks => to.write_str("each pedestrian has a clock of its own: moments are about 0.4 s apart"),
            Self::Implausible(warning) => implausible(warning, to),
            Self::Estimated { forecasts, late, hardly, carried } => write!(
                to,
                "of {forecasts} forecasts {late} are of pedestrians tracked for less than {OBSERVED} steps ({hardly} of \
                 them just seen, so that nobody knows where they go), and {carried} of pedestrians last seen a little \
                 before (columns unseen and age); {} and {} leave them out",
                Setting::Whole,
                Setting::MaxAge
            ),
            Self::Noise { metres } => {
                let centimetres = 100.0 * metres;
                write!(to, "the positions are noisy, {centimetres:.0} cm on each axis: observed paths are smoothed")
            }
            Self::Misfits { scene, misfits } => misfit(scene.as_ref(), misfits, to),
            Self::NeverForecast { count, of, first } => write!(
                to,
                "{count} of {of} pedestrians are never forecast, first {first}: they have no row near a moment that is \
                 forecast"
            ),
            Self::EndsEarly { end, last } => {
                write!(to, "there is no forecast for the last frame of the file ({end}); the last one is at {last}")
            }
            Self::Unfamiliar { count, of, first } => write!(
                to,
                "{count} of {of} motions are unlike the training motions (familiarity below {UNFAMILIAR_THRESHOLD}), \
                 first that of pedestrian {first}: their forecasts use little of the network, and their weights are \
                 flatter"
            ),
            Self::MemoryRefused { path, refusal } => write!(
                to,
                "{}: {refusal}; the file stays as it is, and what is seen now is not kept in it: give another file for \
                 this place",
                path.display()
            ),
            Self::MemoryUnwritten(error) => write!(to, "{error}; it is tried again"),
            Self::MemoryFailed(error) => write!(to, "{error}"),
            Self::MemoryUnsaved { unsaved, .. } => write!(to, "{unsaved}"),
            Self::MemoryKept { path, segments } => {
                write!(to, "{} remembers {segments} segments, 8 s of one pedestrian each", path.display())
            }
        }
    }
}

fn misfit(scene: Option<&SceneName>, misfits: &[MisfitNote], to: &mut Formatter<'_>) -> Result {
    let rows: Vec<Misfit> = misfits.iter().map(|noted| noted.misfit).collect();
    let scene = scene.map_or_else(String::new, |scene| format!(" of scene {scene}"));
    let first = misfits.first().map(|first| format!("pedestrian {}{scene} at {}", first.pedestrian, first.when));
    to.write_str(&Misfit::words(&rows, |_| first.clone().unwrap_or_default()).unwrap_or_default())
}

fn implausible(warning: &PlausibilityWarning, to: &mut Formatter<'_>) -> Result {
    let [unit, homography, fps] = [Setting::Unit, Setting::Homography, Setting::Fps];
    match warning {
        PlausibilityWarning::Fast { .. } => {
            write!(to, "{warning} ({unit}, {homography}, or {fps} of frame numbers)")
        }
        PlausibilityWarning::Slow { .. } | PlausibilityWarning::NoSteps => {
            write!(to, "{warning} ({fps} of frame numbers)")
        }
        _ => write!(to, "{warning}"),
    }
}
