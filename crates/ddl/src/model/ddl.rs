//! The trained model: its forecasts with and without certificates.

use crate::device::Device;
use crate::error::DdlError;
use crate::forecast::certified::{self, CertifiedForecast, Walked};
use crate::forecast::joint::GivenPlan;
use crate::forecast::name::NAME;
use crate::forecast::shaped::{self, GuidedGoals};
use crate::goals::model::GoalModel;
use crate::goals::sets;
use crate::run::config::RunConfig;
use crate::run::directory::RunDirectory;
use crate::run::model_source::ModelSource;
use ddl_core::{Forecast, ForecastError, Forecaster, HORIZON, Position, Window};
use ddl_goal::GoalSet;
use ddl_network::weights::Weights;
use ddl_network::{ForecastWindows, StepRule};

/// A trained model, ready to forecast.
///
/// As a [`Forecaster`] it is the model of the protocol `fair`: one hypothesis for each of the K = 20 goals, with the
/// weight of the goal. Each hypothesis follows a flow whose distance to the goal falls at every step. The protocol
/// `single` calls [`forecast_central`](Self::forecast_central). The model reads the 8 observed frames and the memory of
/// the window, if it has one.
///
/// # Numerics
/// The network computes in `f32` and shapes the metric P of each step. The variants with dynamics integrate in `f64`,
/// by steps whose guarantee holds for the computed numbers. [`forecast_certified`](Self::forecast_certified) returns
/// the evidence.
///
/// # Examples
/// ```
/// use ddl::data::{PedestrianId, Window};
/// use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecaster as _};
///
/// // Or `Ddl::load`, of a run of your own.
/// let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
/// let walk = (0..8).map(|t| [0.5 * f64::from(t), 0.0]).collect(); // metres, 0.4 s apart
/// let window = Window::new("yard", 0, 1, vec![PedestrianId(1)], vec![walk])?;
/// let forecast = model.forecast(&window)?;
/// let one = forecast.hypothesis(0, forecast.representative(0)); // 12 positions, metres
/// assert!(one[11][0] > 3.5, "the pedestrian continues");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Ddl {
    pub(super) goals: GoalModel,
    pub(super) device: Device,
    pub(super) network: Box<dyn ForecastWindows>,
    pub(super) parameters: usize,
}

impl Ddl {
    /// The configuration of the model.
    pub fn config(&self) -> &RunConfig {
        self.goals.config()
    }

    /// The source that the model was loaded from.
    pub fn source(&self) -> &ModelSource {
        self.goals.source()
    }

    /// The directory of its run; `None` for a packed or built-in model.
    pub(crate) fn run(&self) -> Option<&RunDirectory> {
        self.source().run()
    }

    /// The device that it computes on.
    pub(crate) fn device(&self) -> Device {
        self.device
    }

    /// Number of learned parameters of the forecasting network.
    pub fn parameter_count(&self) -> usize {
        self.parameters
    }

    /// The model of its goals.
    pub fn goal_model(&self) -> &GoalModel {
        &self.goals
    }

    pub(crate) fn weights(&self) -> Result<(Weights, Option<Weights>), DdlError> {
        let proposal = self.goals.proposal_network();
        let proposal = proposal.map(ddl_network::ProposeEndpoints::copy_weights);
        let proposal = proposal.transpose()?;
        Ok((self.network.copy_weights()?, proposal))
    }

    /// Forecasts the windows, with evidence for every hypothesis that it approaches its goal.
    ///
    /// # Errors
    /// As [`forecast_all`](Forecaster::forecast_all). Inside [`ForecastError::Model`]:
    /// [`CertificateError::NoFlow`](crate::CertificateError::NoFlow) for the variants without dynamics, `star` and
    /// `no-dynamics`; [`CertificateError::Walk`](crate::CertificateError::Walk) if the output of the network does not
    /// define a flow.
    pub fn forecast_certified(&self, windows: &[Window]) -> Result<Vec<CertifiedForecast>, ForecastError> {
        certified::ensure_flow(self.config().star.variant)?;
        let goals = self.goals.goals(windows)?;
        let goals = self.guided(windows, goals);
        shaped::walked(&*self.network, windows, goals, StepRule::Bounded)?.map(Walked::certified).collect()
    }

    /// The joint futures of each window: hypothesis k of all pedestrians is future k, with one weight for the scene, so
    /// that people who walk together stay together and seldom walk through each other. With a plan the others respond
    /// to it, and whoever follows it does so in every future. With one pedestrian it is the forecast of
    /// [`forecast_all`](Forecaster::forecast_all). For the variant without goals noise vector k is future k, and a plan
    /// changes nothing.
    ///
    /// # Errors
    /// As [`forecast_all`](Forecaster::forecast_all).
    pub fn forecast_scenes(
        &self,
        windows: &[Window],
        given: Option<&GivenPlan>,
    ) -> Result<Vec<Forecast>, ForecastError> {
        let config = self.config();
        if !config.star.variant.uses_goal() {
            return shaped::without_goals(&*self.network, config.training.seed, windows);
        }
        let joint = self.joint(windows, given)?;
        joint.map(|walked| walked?.forecast_given(given)).collect()
    }

    /// [`forecast_scenes`](Self::forecast_scenes), with evidence for every path that it approaches its goal.
    ///
    /// # Errors
    /// As [`forecast_certified`](Self::forecast_certified).
    pub fn forecast_scenes_certified(&self, windows: &[Window]) -> Result<Vec<CertifiedForecast>, ForecastError> {
        certified::ensure_flow(self.config().star.variant)?;
        self.joint(windows, None)?.map(|walked| walked?.certified()).collect()
    }

    fn joint<'a>(
        &'a self,
        windows: &'a [Window],
        given: Option<&'a GivenPlan>,
    ) -> Result<impl Iterator<Item = Result<Walked<'a>, ForecastError>>, ForecastError> {
        let goals = self.guided(windows, self.goals.goals(windows)?);
        let walked = shaped::walked(&*self.network, windows, goals, StepRule::Bounded)?;
        Ok(walked.map(move |walked| walked.joint(given)))
    }

    /// One hypothesis for each pedestrian: the neutral motion to the central goal of its goal set
    /// ([`GoalSet::central`]). The forecasting network is not used. The variant without goals makes noise samples.
    /// [`Forecast::certified`] states whether the certificate of each path holds.
    ///
    /// # Shapes
    /// One forecast for each window, with one hypothesis of 12 positions (m) for each pedestrian.
    ///
    /// # Errors
    /// As [`forecast_all`](Forecaster::forecast_all).
    pub fn forecast_central(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        let goals = sets::with_central_only(windows, &self.goals.goals(windows)?);
        self.forecast_neutral(windows, goals)
    }

    /// [`forecast_central`](Self::forecast_central) with evidence for every path that it approaches its goal.
    ///
    /// # Errors
    /// As [`forecast_central`](Self::forecast_central); for the variant without goals
    /// [`CertificateError::NoFlow`](crate::CertificateError::NoFlow).
    pub fn forecast_central_certified(&self, windows: &[Window]) -> Result<Vec<CertifiedForecast>, ForecastError> {
        let variant = self.config().star.variant;
        if !variant.uses_goal() {
            certified::ensure_flow(variant)?;
        }
        let goals = sets::with_central_only(windows, &self.goals.goals(windows)?);
        self.neutral(windows, goals).map(Walked::certified).collect()
    }

    /// One neutral path for every pedestrian, to the single goal of its set; for the variant without goals, noise
    /// samples.
    pub(crate) fn forecast_neutral(
        &self,
        windows: &[Window],
        sets: Vec<Vec<GoalSet>>,
    ) -> Result<Vec<Forecast>, ForecastError> {
        if !self.config().star.variant.uses_goal() {
            let seed = self.config().training.seed;
            return shaped::without_goals(&*self.network, seed, windows);
        }
        self.neutral(windows, sets).map(Walked::forecast).collect()
    }

    fn neutral<'a>(&'a self, windows: &'a [Window], sets: Vec<Vec<GoalSet>>) -> impl Iterator<Item = Walked<'a>> {
        let config = &self.config().star;
        windows.iter().zip(sets).map(move |(window, sets)| {
            let goals: Vec<Position> = sets.iter().flat_map(GoalSet::goals).copied().collect();
            Walked {
                config,
                rule: StepRule::Bounded,
                window,
                hypotheses: 1,
                rolled_out: Vec::new(),
                shares: vec![0.0; window.len()],
                familiarity: Some(self.goals.familiarity(window)),
                spread: None,
                factors: Some(vec![[1.0, 0.0, 1.0]; goals.len() * HORIZON]),
                weights: vec![1.0; goals.len()],
                goals,
            }
        })
    }

    /// For every pedestrian, one hypothesis for each goal, with the weight of the goal. The variant without goals makes
    /// one for each noise vector, all equally likely.
    pub(crate) fn forecast_towards(
        &self,
        windows: &[Window],
        sets: Vec<Vec<GoalSet>>,
        rule: StepRule,
    ) -> Result<Vec<Forecast>, ForecastError> {
        let seed = self.config().training.seed;
        shaped::towards(&*self.network, seed, windows, self.guided(windows, sets), rule)
    }

    fn guided(&self, windows: &[Window], sets: Vec<Vec<GoalSet>>) -> GuidedGoals {
        let familiarity = windows.iter().map(|window| self.goals.familiarity(window));
        GuidedGoals { sets, familiarity: familiarity.collect() }
    }
}

impl Forecaster for Ddl {
    fn name(&self) -> String {
        NAME.into()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let mut forecasts = self.forecast_all(std::slice::from_ref(window))?;
        Ok(forecasts.remove(0))
    }

    fn forecast_all(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        let goals = self.goals.goals(windows)?;
        self.forecast_towards(windows, goals, StepRule::Bounded)
    }
}
