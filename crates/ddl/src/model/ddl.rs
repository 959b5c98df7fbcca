//! The trained model, and its answers.

use crate::device::Device;
use crate::error::DdlError;
use crate::forecast::answer::Answer;
use crate::forecast::certified::{self, CertificateError, Walked};
use crate::forecast::explanations;
use crate::forecast::joint;
use crate::forecast::name::NAME;
use crate::forecast::request::{Motions, Request};
use crate::forecast::shaped::{self, GuidedGoals};
use crate::goals::model::GoalModel;
use crate::goals::sets;
use crate::run::config::RunConfig;
use crate::run::directory::RunDirectory;
use crate::run::model_source::ModelSource;
use ddl_core::{AdaptiveRegions, Forecast, ForecastError, Forecaster, HORIZON, Position, Window};
use ddl_goal::GoalSet;
use ddl_network::weights::Weights;
use ddl_network::{ForecastWindows, StepRule};

/// A trained model, ready to forecast.
///
/// [`forecast`](Self::forecast) is the only way to ask it, by a [`Request`]. As a [`Forecaster`] it is the model of the
/// protocol `fair`: one hypothesis for each of the K = 20 goals, with the weight of the goal. Each hypothesis follows a
/// flow whose distance to the goal falls at every step. The protocol `single` asks for [one path](Request::one). The
/// model reads the 8 observed frames and the memory of the window, if it has one.
///
/// # Numerics
/// The network computes in `f32` and shapes the metric P of each step. The variants with dynamics integrate in `f64`,
/// by steps whose guarantee holds for the computed numbers. A request [with
/// certificates](Request::with_certificates) returns the evidence.
///
/// # Examples
/// ```
/// use ddl::data::{PedestrianId, Window};
/// use ddl::{BuiltinModel, Ddl, DeviceChoice, Request};
///
/// // Or `Ddl::load`, of a run of your own.
/// let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
/// let walk = (0..8).map(|t| [0.5 * f64::from(t), 0.0]).collect(); // metres, 0.4 s apart
/// let window = Window::new("yard", 0, 1, vec![PedestrianId(1)], vec![walk])?;
/// let answers = model.forecast(&[window], &Request::default())?;
/// let forecast = answers[0].forecast();
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
        let proposal = self.goals.proposal_network().map(ddl_network::ProposeEndpoints::copy_weights).transpose()?;
        Ok((self.network.copy_weights()?, proposal))
    }

    /// What is asked of each window. Who has [another explanation](Window::other) has hypotheses of both, and one path of
    /// the likelier one. Joint futures of a window do not depend on the other windows; [adaptive
    /// regions](Request::adaptive_regions) go from one to the next, in order of time.
    ///
    /// # Errors
    /// As [`forecast_all`](Forecaster::forecast_all). Inside [`ForecastError::Model`]:
    /// [`CertificateError::NoFlow`](crate::CertificateError::NoFlow) where certificates are asked for and the variant
    /// has none: `star`, and but for one path `no-dynamics`;
    /// [`CertificateError::Walk`](crate::CertificateError::Walk) if the output of the network does not define a flow.
    pub fn forecast(&self, windows: &[Window], request: &Request) -> Result<Vec<Answer>, ForecastError> {
        let answers = self.forecast_plainly(windows, request)?;
        if !request.adaptive_regions {
            return Ok(answers);
        }
        let mut regions = AdaptiveRegions::default();
        Ok(windows.iter().zip(answers).map(|(window, answer)| answer.adapted(&mut regions, window)).collect())
    }

    /// Refuses certificates that no forecast of the model has.
    pub(crate) fn check(&self, request: &Request) -> Result<(), ForecastError> {
        let variant = self.config().star.variant;
        let has_flow = variant.dynamics() || (request.motions == Motions::One && variant.uses_goal());
        match request.certificates {
            true if !has_flow => Err(certified::no_flow(variant)),
            true if request.plan().is_some_and(|given| given.ego.is_some()) => {
                Err(certified::failed(CertificateError::GivenPlan))
            }
            _ => Ok(()),
        }
    }

    /// [`forecast`](Self::forecast), where nothing adapts.
    pub(crate) fn forecast_plainly(&self, windows: &[Window], request: &Request) -> Result<Vec<Answer>, ForecastError> {
        self.check(request)?;
        if !self.config().star.variant.uses_goal() {
            // Noise vector k is future k, and a plan changes nothing.
            let forecasts = shaped::without_goals(&*self.network, self.config().training.seed, windows)?;
            let pairs = windows.iter().zip(forecasts);
            let answers = pairs.map(|(window, forecast)| {
                if !request.is_joint() {
                    return Ok(forecast.into());
                }
                Ok(Answer::of_scene(joint::futures(window, forecast)?, Vec::new()))
            });
            return answers.collect();
        }
        let is_one = request.motions == Motions::One;
        let apart = explanations::apart(windows, !is_one);
        let goals = self.goals.goals(&apart)?;
        if is_one {
            let walked = self.neutral(&apart, sets::with_central_only(&apart, &goals));
            return walked.map(|walked| Ok(Answer::of_each(walked.certified(request.certificates)?))).collect();
        }
        let walked = shaped::walked(&*self.network, &apart, self.guided(&apart, goals), StepRule::Bounded)?;
        let answers = explanations::together(windows, walked.collect()).map(|walked| {
            if request.is_joint() {
                return walked.joint_answer(request.plan(), request.certificates);
            }
            Ok(Answer::of_each(walked.certified(request.certificates)?))
        });
        answers.collect()
    }

    /// One neutral path for every pedestrian, to the single goal of its set; for the variant without goals, noise
    /// samples.
    pub(crate) fn forecast_neutral(
        &self,
        windows: &[Window],
        sets: Vec<Vec<GoalSet>>,
    ) -> Result<Vec<Forecast>, ForecastError> {
        if !self.config().star.variant.uses_goal() {
            return shaped::without_goals(&*self.network, self.config().training.seed, windows);
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
                origins: Vec::new(),
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
        let answers = self.forecast_plainly(windows, &Request::default())?;
        Ok(answers.into_iter().map(Answer::into_forecast).collect())
    }
}
