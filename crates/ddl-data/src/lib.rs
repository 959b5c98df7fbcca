#![doc = include_str!("../README.md")]
//!
//! ## Tracks of a camera
//!
//! Tracks at any frame rate, in pixels, or with missing rows are converted to the windows that a forecast needs:
//!
//! ```rust
//! use ddl_data::{Clock, Completeness, Format, FrameReader, Homography, LiveTracks, parse_recording};
//!
//! // Pixels of a camera at 7 frames a second, 100 a metre: a pedestrian at 1.4 m/s who is lost for a moment.
//! let mut film = String::from("frame,pedestrian,x,y\n");
//! for t in (0..13).chain(17..40) {
//!     film += &format!("{t},7,{},50\n", 20 * t);
//! }
//! let ground: Homography = "0.01 0 0\n0 0.01 0\n0 0 1".parse()?;
//! let recording = ground.to_ground(&parse_recording(film.as_bytes(), "film.csv", Format::Table)?)?;
//! let clock = Clock::with_frame_time(1.0 / 7.0)?; // a step of 0.4 s is 2.8 frames
//! let recording = recording.on_clock(clock)?;
//! let tracks = recording.live_tracks().with_completeness(Completeness::Partial);
//! let windows = recording.observe(tracks).windows;
//! let last = windows.last().ok_or("no window")?;
//! assert!((last.observed(0)[0][0] - 0.2 * (39.0 - 7.0 * 2.8)).abs() < 0.02);
//! assert_eq!(last.quality(0).age, 0.0);
//!
//! // The same tracks frame by frame, as from a live tracker: the same windows.
//! let mut tracks = LiveTracks::with_clock(clock).with_completeness(Completeness::Partial);
//! let mut frames = FrameReader::new(film.as_bytes(), "camera");
//! let mut live = Vec::new();
//! while let Some(frame) = frames.next_frame()? {
//!     let seen = frame.pedestrians.into_iter().map(|(id, pixel)| (id, pixel.map(|pixel| 0.01 * pixel)));
//!     live.extend(tracks.push(frame.number, seen)?);
//! }
//! assert_eq!(live.len(), windows.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Without the feature `files`, which is on by default, the crate has only what a forecast of live tracks needs: no
//! formats, data sets and simulated crowds.
//!
//! ## The ETH/UCY recordings
//!
//! ```rust,no_run
//! use ddl_data::{Convention, Dataset, WindowRule, locate};
//!
//! let folder = locate(Convention::Star, None)?; // $DDL_DATASETS, or datasets/eth_ucy
//! let dataset = Dataset::load(Convention::Star, &folder)?;
//! for fold in dataset.folds() {
//!     let windows = fold.test_windows(WindowRule::Published);
//!     println!("{}: {} pedestrians", fold.name(), windows.iter().map(|w| w.len()).sum::<usize>());
//! }
//! # Ok::<(), ddl_data::DataError>(())
//! ```
//!
//! Published tables mix two samplings of ETH/UCY and several ways of cutting windows; their numbers are not comparable.
//! Here each has a name, and every result states it:
//!
//! | [`Convention`] | |
//! |---|---|
//! | `star` | SR-LSTM, STAR, DDL: eth at its original 0.4 s |
//! | `social-gan` | Social-GAN and most others: eth sampled every 0.667 s, taken for 0.4 s |
//! | `simulated` | five social-force crowds, for machines without the recordings |
//!
//! | [`WindowRule`] | |
//! |---|---|
//! | `Published` | the windows of the published STAR and DDL code, with its quirks |
//! | `Complete` | every pedestrian with all 20 steps, from every annotated frame |
//! | `SocialGan` | 20 annotated frames in a row, with a minimum number of pedestrians |
//! | `Observed` | what a live stream would see at each frame, also on other clocks: for own recordings |
//!
//! [`Fold::training_split`] keeps the last part of each training recording for validation. With the fraction 0.2 the
//! windows are those of the published folders `train` and `val` of Social-GAN.

mod class;
mod clock;
mod convention;
#[cfg(feature = "files")]
mod convention_plan;
#[cfg(feature = "files")]
mod dataset;
mod error;
#[cfg(feature = "files")]
mod file_error;
#[cfg(feature = "files")]
mod fold;
#[cfg(feature = "files")]
mod format;
mod future;
mod homography;
mod live;
#[cfg(feature = "files")]
mod locate;
mod observation;
mod observe;
mod plausibility;
mod recording;
mod replay;
mod rule;
mod scene_name;
#[cfg(feature = "files")]
mod simulate;
mod summary;
mod windows;

pub use class::is_vehicle;
pub use clock::{Clock, ClockError, FrameNumber, TimeUnit};
pub use convention::Convention;
#[cfg(feature = "files")]
pub use dataset::Dataset;
pub use error::{LiveError, RecordingError};
#[cfg(feature = "files")]
pub use file_error::DataError;
#[cfg(feature = "files")]
pub use fold::{Fold, TrainingSplit};
#[cfg(feature = "files")]
pub use format::{
    ChoiceError, ColumnChoice, Fault, Field, Format, FormatError, Frame, FrameReader, Problem, TextLines, WrongValue,
    escaped, parse_columns, parse_recording, quoted, read_recording, write_recording,
};
pub use future::TruePaths;
pub use homography::{Homography, HomographyError};
pub use live::{Completeness, LiveTracks, checked_frame};
#[cfg(feature = "files")]
pub use locate::locate;
pub use observation::Observation;
pub use observe::{Misfit, MisfitTreatment, RecordingNoise};
pub use plausibility::{Fastest, PlausibilityWarning};
pub use recording::Recording;
pub use replay::ObservedRecording;
pub use rule::WindowRule;
pub use scene_name::{SceneName, SceneNameError};
pub use summary::{Gap, Summary};
