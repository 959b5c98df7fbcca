#![doc = include_str!("../README.md")]
//!
//! ## Tracks of a camera
//!
//! Tracks at another frame rate, in pixels, or with missing observations are converted to the windows that a forecast
//! needs:
//!
//! ```rust
//! use ddl_data::{Completion, Format, Homography, LiveTracks, FrameReader, parse_recording};
//!
//! // Pixels of a camera at 10 frames a second, 100 a metre: a pedestrian at 1.2 m/s who is lost for a moment.
//! let mut film = String::from("frame,pedestrian,x,y\n");
//! for t in (0..13).chain(17..40) {
//!     film += &format!("{t},7,{},50\n", 12 * t);
//! }
//! let ground: Homography = "0.01 0 0\n0 0.01 0\n0 0 1".parse()?;
//! let recording = ground.to_ground(&parse_recording(film.as_bytes(), "film.csv", Format::Table)?)?;
//! let steps = recording.resampled_to_steps(0.1)?.recording; // 4 frames a step
//! let windows = steps.completed_windows(Completion::DEFAULT);
//! let last = windows.last().ok_or("no window")?;
//! assert!((last.observed(0)[0][0] - 0.12 * (39.0 - 28.0)).abs() < 1e-9);
//! assert_eq!(last.completion_counts(0).filled, 1); // frame 15, on the way from 12 to 17
//!
//! // The same tracks frame by frame, as from a live tracker.
//! let mut tracks = LiveTracks::with_frame_step(4)?.with_completion(Completion::DEFAULT);
//! let mut frames = FrameReader::new(film.as_bytes(), "camera");
//! while let Some(frame) = frames.next_frame()? {
//!     if let Some(window) = tracks.push(frame.number, frame.pedestrians)? {
//!         assert_eq!(window.frames()[7], frame.number);
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
//!
//! [`Fold::training_split`] keeps the last part of each training recording for validation. With the fraction 0.2 the
//! windows are those of the published folders `train` and `val` of Social-GAN.

mod atomic_file;
mod augment;
mod completion;
mod convention;
mod dataset;
mod error;
mod fold;
mod format;
mod homography;
mod live;
mod locate;
mod neighbours;
mod observation;
mod plausibility;
mod rate;
mod recording;
mod rule;
mod scene_name;
mod simulate;
mod summary;
mod unknown_name;
mod windows;

pub use atomic_file::{remove_temporary_files, write_atomically};
pub use augment::Rotation;
pub use completion::Completion;
pub use convention::Convention;
pub use dataset::Dataset;
pub use ddl_core::{
    CompletionCounts, HORIZON, OBSERVED, PedestrianId, PedestrianName, PedestrianNames, Position, RememberedTrack,
    TIME_STEP, WINDOW, Window, WindowError,
};
pub use error::{DataError, FormatError, RecordingError};
pub use fold::{Fold, TrainingSplit};
pub use format::{Format, Frame, FrameReader, parse_recording, read_recording, write_recording};
pub use homography::{Homography, HomographyError};
pub use live::{LiveError, LiveTracks, checked_frame};
pub use locate::locate;
pub use neighbours::{Neighbours, SpatialIndex};
pub use observation::{COORDINATE_LIMIT, Observation};
pub use plausibility::{Fastest, PlausibilityWarning};
pub use rate::{RateError, ResampledRecording, whole_frame_step};
pub use recording::Recording;
pub use rule::WindowRule;
pub use scene_name::SceneName;
pub use summary::{Gap, Summary};
pub use unknown_name::UnknownName;
