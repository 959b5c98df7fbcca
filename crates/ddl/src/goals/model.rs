//! The goals of a model: retrieved, proposed by a network, or both pooled.

use crate::device::Device;
use crate::error::DdlError;
use crate::goals::experts;
use crate::goals::first_seen::{self, KnownMotions};
use crate::goals::packed::{self, Unpacked};
use crate::goals::reach;
use crate::goals::sets;
use crate::goals::unforeseen;
use crate::goals::views;
use crate::run::config::RunConfig;
use crate::run::directory::RunDirectory;
use crate::run::enough_weights;
use crate::run::goal_recipe::GoalRecipe;
use crate::run::model_source::ModelSource;
use crate::run::training_data::digest_of_recording;
use crate::trust::calibration::Calibration;
use crate::trust::familiarity::TrainingMotions;
use crate::trust::fingerprints::TrackFingerprints;
use ddl_core::{ForecastError, Pace, Position, WINDOW, Window};
use ddl_data::Recording;
use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams, GoalSet, QuerySpan};
use ddl_network::weights::load_weights;
use ddl_network::{DeviceChoice, ForecastWindows, MemoryConfig, ProposeEndpoints, ProposedEndpoints};
use rayon::prelude::*;

/// Estimates goals for the pedestrians of a window, from the 8 observed frames and the memory of the place.
#[derive(Debug)]
pub struct GoalModel {
    source: ModelSource,
    config: RunConfig,
    origin: GoalOrigin,
    /// The training motions that familiarity is measured against; `None` if too few are known.
    motions: Option<TrainingMotions>,
    /// The motions that it was trained on, as hashes.
    fingerprints: TrackFingerprints,
}

#[derive(Debug)]
enum GoalOrigin {
    Retrieved(GoalEstimator),
    Proposed(Box<dyn ProposeEndpoints>),
    /// Endpoints of the network and retrieved goals; the retrieved ones have this share of the probability.
    Pooled {
        network: Box<dyn ProposeEndpoints>,
        estimator: GoalEstimator,
        retrieved_share: f64,
    },
}

impl GoalModel {
    /// Loads the goals. The forecasting network of a run may be untrained.
    ///
    /// # Errors
    /// When there is no run, its goals are not trained, one of the files is broken, or the device is unavailable.
    pub fn open(source: &ModelSource, device: DeviceChoice) -> Result<Self, DdlError> {
        let Some(run) = source.run() else {
            let bytes = packed::bytes(source)?;
            let device = Device::open(device)?;
            let unpacked = packed::unpack(&bytes, source, device)?;
            return Ok(Self::of_packed(source, unpacked).0);
        };
        let config = run.config()?;
        if !run.has_goals(&config.goals) {
            let problem = "has no goals yet; run the same `ddl train` command again to continue";
            return Err(source.wrong(problem));
        }
        source.check(&config)?;
        Self::of_run(run.clone(), config, Device::open(device)?)
    }

    pub(crate) fn of_run(run: RunDirectory, config: RunConfig, device: Device) -> Result<Self, DdlError> {
        let network = match &config.goals.proposal {
            None => None,
            Some(recipe) => {
                enough_weights::require(&run.proposal(), recipe.network.min_weight_count())?;
                let origin = config.goals_origin();
                let read = |layout: &_| load_weights(layout, &origin, &run.proposal());
                Some(device.proposing(&recipe.network, read)?)
            }
        };
        Self::with_network(run, config, network)
    }

    /// The goals of a run with this proposal network instead of the one in its file.
    pub(crate) fn with_network(
        run: RunDirectory,
        config: RunConfig,
        network: Option<Box<dyn ProposeEndpoints>>,
    ) -> Result<Self, DdlError> {
        let library = experts::load(&config.goals_origin(), config.data.pedestrians, &run.experts())?;
        let estimator = GoalEstimator::new(config.goals.retrieval.clone(), library)
            .map_err(|error| experts::unusable(&error, &run.experts()))?;
        let tracks = estimator.library().tracks();
        let motions = TrainingMotions::learn(tracks, config.star.time_step);
        let fingerprints = fingerprints_of(&run)?;
        let origin = match (&config.goals.proposal, network) {
            (Some(recipe), Some(network)) => {
                GoalOrigin::Pooled { network, estimator, retrieved_share: recipe.retrieved_share }
            }
            _ => GoalOrigin::Retrieved(estimator),
        };
        Ok(Self { source: ModelSource::Run(run), config, origin, motions, fingerprints })
    }

    /// The goals of a packed model, and its remaining contents.
    pub(crate) fn of_packed(source: &ModelSource, unpacked: Unpacked) -> (Self, Box<dyn ForecastWindows>) {
        let Unpacked { config, network, proposal, motions, fingerprints } = unpacked;
        let goals =
            Self { source: source.clone(), config, origin: GoalOrigin::Proposed(proposal), motions, fingerprints };
        (goals, network)
    }

    /// The configuration of the run.
    pub fn config(&self) -> &RunConfig {
        &self.config
    }

    /// The source that the model was loaded from.
    pub fn source(&self) -> &ModelSource {
        &self.source
    }

    /// The settings of the goals in training. [`words`](Self::words) names the parts that are available.
    pub(crate) fn recipe(&self) -> &GoalRecipe {
        &self.config.goals
    }

    /// Text that names the origin of the goals.
    pub fn words(&self) -> String {
        match &self.origin {
            GoalOrigin::Proposed(_) => self.recipe().description_without_library(),
            GoalOrigin::Retrieved(_) | GoalOrigin::Pooled { .. } => self.recipe().words(),
        }
    }

    /// Largest number of goals per pedestrian.
    pub fn clusters(&self) -> usize {
        self.config.goals.retrieval.clusters
    }

    /// The retrieval of similar pedestrians, which reads the observed positions only; `None` where there is no expert
    /// library.
    pub fn estimator(&self) -> Option<&GoalEstimator> {
        match &self.origin {
            GoalOrigin::Proposed(_) => None,
            GoalOrigin::Retrieved(estimator) | GoalOrigin::Pooled { estimator, .. } => Some(estimator),
        }
    }

    pub(crate) fn proposal_network(&self) -> Option<&dyn ProposeEndpoints> {
        match &self.origin {
            GoalOrigin::Retrieved(_) => None,
            GoalOrigin::Proposed(network) | GoalOrigin::Pooled { network, .. } => Some(&**network),
        }
    }

    /// Whether the goals of a proposal network are pooled with those of an expert library.
    pub(crate) fn has_library_beside_network(&self) -> bool {
        matches!(self.origin, GoalOrigin::Pooled { .. })
    }

    /// Number of learned parameters of the proposal network; 0 without one.
    pub fn parameter_count(&self) -> usize {
        self.recipe().proposal.as_ref().map_or(0, |recipe| recipe.network.parameter_count())
    }

    /// Number of earlier pedestrians that the memory branch receives for each pedestrian.
    ///
    /// # Errors
    /// When the model has no memory branch.
    pub fn recalled_per_pedestrian(&self) -> Result<usize, DdlError> {
        let memory = self.memory().ok_or_else(|| {
            self.source.wrong(
                "has no memory branch, so it cannot use a memory of the place; train a model with proposed goals, with \
             this version of the program",
            )
        })?;
        Ok(memory.remembered)
    }

    /// The memory branch of its proposal network, if present.
    pub(crate) fn memory(&self) -> Option<&MemoryConfig> {
        self.config.goals.proposal.as_ref()?.network.memory.as_ref()
    }

    /// The goals `[window][pedestrian]` (metres), from the observed frames and the memory of the windows.
    ///
    /// On the CPU, the goals of a pedestrian have the same bits however the windows are grouped.
    ///
    /// # Errors
    /// When positions are so far apart that distances leave the range of `f64`, or libtorch fails.
    pub fn goals(&self, windows: &[Window]) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
        self.within_reach(windows, |windows| match &self.origin {
            GoalOrigin::Retrieved(estimator) => sets::retrieved(estimator, windows),
            GoalOrigin::Proposed(network) => self.representatives(&**network, None, windows),
            GoalOrigin::Pooled { network, estimator, retrieved_share } => {
                self.representatives(&**network, Some((estimator, *retrieved_share)), windows)
            }
        })
    }

    /// Moves goals beyond the pedestrian's reach to its limit, and gives them the weights of its pace and familiarity.
    /// Goals of pedestrians seen for the first time are not `estimated`.
    fn within_reach(
        &self,
        windows: &[Window],
        estimated: impl FnOnce(&[Window]) -> Result<Vec<Vec<GoalSet>>, ForecastError>,
    ) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
        let known = KnownMotions::of(windows);
        let sets = estimated(known.windows())?;
        let time_step = self.config.star.time_step;
        let of_window = |(window, sets): (&Window, Vec<GoalSet>)| -> Vec<GoalSet> {
            let sets = reach::within(window, sets, time_step).into_par_iter();
            let familiarity = self.familiarity(window);
            let tempered = |((i, set), familiarity)| {
                let pace = Pace::of(window.observed(i), time_step, window.quality(i).uncertainty());
                Calibration::fitted().tempered(set, pace, familiarity)
            };
            sets.enumerate().zip(familiarity).map(tempered).collect()
        };
        let sets = known.windows().iter().zip(sets).flat_map(of_window).map(Ok);
        let sets = known.with_others(sets, |window, i| first_seen::goals(&windows[window], i, self.clusters()));
        sets.into_iter().map(|sets| sets.into_iter().collect()).collect()
    }

    /// Familiarity of the observed motion of each pedestrian of a window: the share of held-out training motions that
    /// are at least as unusual, in (0, 1]. It is 1 where no training motions are known, and of pedestrians seen for the
    /// first time.
    #[must_use]
    pub fn familiarity(&self, window: &Window) -> Vec<f64> {
        TrainingMotions::of_window(self.motions(), window, self.config.star.time_step)
    }

    /// The share (0 to 1) of the paths of a recording that the model was trained on, under whatever name; `None` if it
    /// is no more than chance.
    pub fn known_share(&self, recording: &Recording) -> Option<f64> {
        let learned = &self.config.data.recordings;
        let digest = (!learned.is_empty()).then(|| digest_of_recording(recording));
        if digest.is_some_and(|digest| learned.values().any(|known| *known == digest)) {
            return Some(1.0);
        }
        self.fingerprints.known(&[recording])
    }

    pub(crate) fn fingerprints(&self) -> &TrackFingerprints {
        &self.fingerprints
    }

    pub(crate) fn motions(&self) -> Option<&TrainingMotions> {
        self.motions.as_ref()
    }

    /// The goals of the model without its expert library. A model without a proposal network keeps its retrieved goals.
    pub(crate) fn goals_without_library(&self, windows: &[Window]) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
        match self.proposal_network() {
            None => self.goals(windows),
            Some(network) => self.within_reach(windows, |windows| self.representatives(network, None, windows)),
        }
    }

    /// Clusters the endpoints of the network, with the retrieved goals if they have a share, to at most `clusters`
    /// goals.
    fn representatives(
        &self,
        network: &dyn ProposeEndpoints,
        retrieval: Option<(&GoalEstimator, f64)>,
        windows: &[Window],
    ) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
        let mut seen = Vec::new();
        for window in windows {
            let pedestrians =
                views::of_window(window, network.config().neighbours, network.config().time_step).map_err(failed)?;
            seen.extend(pedestrians);
        }
        let mut views = Vec::with_capacity(seen.len());
        let mut frames = Vec::with_capacity(seen.len());
        for seen in seen {
            frames.push((seen.frame, seen.unit));
            views.push(seen.view);
        }
        let mut proposed = network.propose(&views).map_err(failed)?;
        let unforeseen = self.recipe().proposal.as_ref().map_or(0.0, |recipe| recipe.unforeseen_share);
        for ((proposed, (_, unit)), view) in proposed.iter_mut().zip(&frames).zip(&views) {
            let in_metres = |position: Position| position.map(|coordinate| coordinate * unit);
            for end in &mut proposed.endpoints {
                *end = in_metres(*end);
            }
            if unforeseen > 0.0 {
                let time_step = network.config().time_step;
                unforeseen::add(proposed, unforeseen, &view.own.map(in_metres), time_step);
            }
        }
        if let Some((estimator, share)) = retrieval {
            let retrieved = sets::retrieved(estimator, windows)?.into_iter().flatten();
            for ((proposed, (frame, _)), set) in proposed.iter_mut().zip(&frames).zip(retrieved) {
                for weight in &mut proposed.weights {
                    *weight *= 1.0 - share;
                }
                let ends = set.goals().iter().map(|&goal| frame.to_frame(goal));
                proposed.endpoints.extend(ends);
                proposed.weights.extend(set.weights().iter().map(|weight| weight * share));
            }
        }
        let clusters = self.clusters();
        let sets: Vec<GoalSet> = (frames, proposed)
            .into_par_iter()
            .map(|((frame, _), ProposedEndpoints { endpoints, weights })| {
                GoalSet::from_endpoints(&frame, &endpoints, &weights, clusters)
            })
            .collect::<Result<_, _>>()
            .map_err(failed)?;
        let mut sets = sets.into_iter();
        Ok(windows.iter().map(|window| sets.by_ref().take(window.len()).collect()).collect())
    }

    /// The goals of pedestrians in training: the proposed goal nearest the true endpoint, or the true endpoint without
    /// a proposal network. Retrieved goals are left out, because the library holds the training pedestrians themselves
    /// (`docs/method.md`, training).
    pub(crate) fn training_goals(&self, windows: &[Window]) -> Result<Vec<Vec<Position>>, ForecastError> {
        let end = |window: &Window, i: usize| window.track(i)[WINDOW - 1];
        if self.proposal_network().is_none() {
            let ends = |window: &Window| (0..window.len()).map(|i| end(window, i)).collect();
            return Ok(windows.iter().map(ends).collect());
        }
        let sets = self.goals_without_library(windows)?;
        let nearest = |(i, set): (usize, GoalSet), window: &Window| {
            let end = end(window, i);
            set.goals().get(set.nearest(end)).copied().unwrap_or(end)
        };
        Ok(sets
            .into_iter()
            .zip(windows)
            .map(|(sets, window)| sets.into_iter().enumerate().map(|pedestrian| nearest(pedestrian, window)).collect())
            .collect())
    }

    /// The published estimator: under the protocol `published`, its query reads the first future frame.
    pub(crate) fn published_estimator(&self, query: QuerySpan) -> Result<GoalEstimator, DdlError> {
        let Some(estimator) = self.estimator() else {
            return Err(self.source.wrong(
                "has no expert library, from which the protocol `published` takes its goals; evaluate it under `fair` \
                 and `single`, or evaluate the run that it was packed from",
            ));
        };
        let library: ExpertLibrary = estimator.library().clone();
        let params =
            GoalEstimatorParams { seed: self.recipe().retrieval.seed, query, ..GoalEstimatorParams::published() };
        Ok(GoalEstimator::new(params, library)?)
    }
}

pub(crate) fn failed(error: impl std::error::Error + Send + Sync + 'static) -> ForecastError {
    ForecastError::model("goals", error)
}

fn fingerprints_of(run: &RunDirectory) -> Result<TrackFingerprints, DdlError> {
    let path = run.fingerprints();
    let bytes = std::fs::read(&path).map_err(|error| DdlError::io(&path, error))?;
    TrackFingerprints::from_bytes(&bytes)
        .ok_or_else(|| DdlError::run(&path, "is damaged; copy it again, or remove it and train again"))
}
