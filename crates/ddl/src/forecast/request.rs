//! What a model is asked for.

use crate::forecast::joint::GivenPlan;

/// What is forecast for the pedestrians of a window.
///
/// # Examples
/// ```
/// use ddl::Request;
///
/// let request = Request::joint().with_certificates();
/// assert_ne!(request, Request::default(), "twenty hypotheses of each pedestrian alone");
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Request {
    /// Whose motion, and how many paths.
    pub motions: Motions,
    /// Whether every path comes with evidence that it approaches its goal.
    pub certificates: bool,
    /// Whether regions and weights adapt to what is observed from moment to moment. Those of joint futures do not.
    pub adaptive_regions: bool,
}

/// Whose motion is forecast, and by how many paths.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Motions {
    /// Each pedestrian alone: one hypothesis for each of the goals, with its weight.
    #[default]
    Alone,
    /// Each pedestrian alone: one path, the neutral motion to a central goal. The variant without goals makes its
    /// samples.
    One,
    /// The scene: hypothesis k of all pedestrians is future k, with one weight, so that people who walk together stay
    /// together and seldom walk through each other. With one pedestrian it is its forecast alone.
    Joint,
    /// As `Joint`; the pedestrians respond to a plan, and whoever follows it does so in every future.
    Given(GivenPlan),
}

impl Request {
    /// One path for each pedestrian.
    pub fn one() -> Self {
        Self { motions: Motions::One, ..Self::default() }
    }

    /// Joint futures of the scene.
    pub fn joint() -> Self {
        Self { motions: Motions::Joint, ..Self::default() }
    }

    /// Joint futures of the scene in which the pedestrians respond to a plan.
    pub fn given(plan: GivenPlan) -> Self {
        Self { motions: Motions::Given(plan), ..Self::default() }
    }

    /// The same request, with certificates.
    #[must_use]
    pub fn with_certificates(self) -> Self {
        Self { certificates: true, ..self }
    }

    /// The same request, with regions that adapt to the place.
    #[must_use]
    pub fn with_adaptive_regions(self) -> Self {
        Self { adaptive_regions: true, ..self }
    }

    /// Whether it asks for joint futures.
    pub fn is_joint(&self) -> bool {
        matches!(self.motions, Motions::Joint | Motions::Given(_))
    }

    /// The plan that the pedestrians respond to.
    pub fn plan(&self) -> Option<&GivenPlan> {
        match &self.motions {
            Motions::Given(plan) => Some(plan),
            _ => None,
        }
    }
}
