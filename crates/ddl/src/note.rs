//! What was assumed, dropped or doubted.

use crate::error::DdlError;
use crate::forecast::answer::Answer;
use crate::forecast::joint::GivenPlan;
use crate::trust::familiarity::UNFAMILIAR_THRESHOLD;
use ddl_core::{OBSERVED, PedestrianName, PedestrianNames, Setting, Window};
use ddl_data::{Clock, Misfit, PlausibilityWarning, SceneName};
use ddl_memory::{Refusal, Unsaved};
use ddl_scene::{Futures, Plan, PlanDoubt};
use std::collections::BTreeSet;
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
    /// A plan that may not be what its author means, with its name if it has one.
    Plan { name: String, doubt: PlanDoubt },
    /// The pedestrian who is said to follow a plan is not in the tracks.
    MissingEgo { name: PedestrianName },
    /// Pedestrians too far away for the area of grids, at least one; nobody gave the area.
    OutsideArea { count: usize, of: usize, first: PedestrianName },
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
    /// What is doubtful of plans in a scene, whose pedestrian `ego` follows them if there is one: of the doubts of each
    /// [kind](PlanDoubt::kind) that of the first plan.
    pub fn of_plans<'a, N: Display>(
        plans: impl IntoIterator<Item = (N, &'a Plan)>,
        futures: &Futures,
        ego: Option<usize>,
    ) -> Vec<Self> {
        let doubts = plans
            .into_iter()
            .flat_map(|(name, plan)| futures.doubts(plan, ego).into_iter().map(move |doubt| (name.to_string(), doubt)));
        let mut kinds = BTreeSet::new();
        let first = doubts.filter(|(_, doubt)| kinds.insert(doubt.kind()));
        first.map(|(name, doubt)| Self::Plan { name, doubt }).collect()
    }

    /// That the pedestrian who is said to follow a plan is not in the window, if so.
    pub fn of_ego(ego: Option<&PedestrianName>, window: &Window) -> Option<Self> {
        let missing = ego.filter(|name| window.named(name).is_none());
        missing.map(|name| Self::MissingEgo { name: name.clone() })
    }

    /// What is doubtful of a plan that the pedestrians of an answer respond to, if there is one.
    pub fn of_given(given: Option<&GivenPlan>, window: &Window, answer: &Answer) -> Vec<Self> {
        let (Some(GivenPlan { plan, ego }), Ok(futures)) = (given, answer.futures()) else {
            return Vec::new();
        };
        let index = ego.as_ref().and_then(|name| window.named(name));
        let plans = Self::of_plans([("", plan)], futures, index);
        Self::of_ego(ego.as_ref(), window).into_iter().chain(plans).collect()
    }

    /// A word for remarks that are told once: those of one kind have the same.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Plan { doubt, .. } => doubt.kind(),
            Self::MissingEgo { .. } => "ego",
            Self::OutsideArea { .. } => "area",
            _ => self.kind(),
        }
    }

    /// What to tell of those whom the [area](ddl_scene::Futures::area) of grids leaves out, if any.
    pub fn outside_area(left_out: &[usize], window: &Window) -> Option<Self> {
        let first = window.name(*left_out.first()?);
        Some(Self::OutsideArea { count: left_out.len(), of: window.len(), first })
    }

    /// How grave it is, as messages begin: `note`, `warning` or `error`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Implausible(_)
            | Self::Misfits { .. }
            | Self::Unfamiliar { .. }
            | Self::Plan { .. }
            | Self::OutsideArea { .. }
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
                "of {forecasts} forecasts {late} are of pedestrians tracked for less than {OBSERVED} steps \
                 ({hardly} of them just seen, so that nobody knows where they go), and {carried} of pedestrians last \
                 seen a little before (columns unseen and age); {} and {} leave them out",
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
            Self::Plan { name, doubt } if name.is_empty() => write!(to, "the plan {doubt}"),
            Self::Plan { name, doubt } => write!(to, "plan {name} {doubt}"),
            Self::MissingEgo { name } => write!(
                to,
                "pedestrian {name}, who is said to follow the plan, is not there: it is taken to be that of somebody \
                 who is not in the tracks"
            ),
            Self::OutsideArea { count, of, first } => outside_area([*count, *of], first, to),
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

fn outside_area([count, of]: [usize; 2], first: &PedestrianName, to: &mut Formatter<'_>) -> Result {
    write!(
        to,
        "the grids leave out {count} of {of} pedestrians, first {first}: they are too far from the others for one area \
         of cells; give the area ({})",
        Setting::Area
    )
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
