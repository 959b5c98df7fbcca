//! What a model answers.

use ddl_core::{AdaptiveRegions, Forecast, Window};
use ddl_dynamics::{LyapunovCertificate, Violation};
use ddl_scene::{Futures, SceneError};

/// Certificates `[N][K]`, of 12 steps each.
pub(crate) type Certificates = Vec<LyapunovCertificate<f64>>;

/// The forecast of a window, as it was [asked for](crate::Request).
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    motions: AnsweredMotions,
    /// `[N][K]`; empty unless they were asked for.
    certificates: Certificates,
}

#[derive(Debug, Clone, PartialEq)]
enum AnsweredMotions {
    Alone(Forecast),
    Joint(Box<Futures>),
}

impl From<Forecast> for Answer {
    fn from(forecast: Forecast) -> Self {
        Self::of_each((forecast, Vec::new()))
    }
}

impl Answer {
    pub(crate) fn of_each((forecast, certificates): (Forecast, Certificates)) -> Self {
        Self { motions: AnsweredMotions::Alone(forecast), certificates }
    }

    pub(crate) fn of_scene(futures: Futures, certificates: Certificates) -> Self {
        Self { motions: AnsweredMotions::Joint(Box::new(futures)), certificates }
    }

    /// The same answer with adapted regions and weights; joint futures stay as they are.
    pub(crate) fn adapted(self, regions: &mut AdaptiveRegions, window: &Window) -> Self {
        let motions = match self.motions {
            AnsweredMotions::Alone(forecast) => AnsweredMotions::Alone(regions.adapt(window, forecast)),
            joint @ AnsweredMotions::Joint(_) => joint,
        };
        Self { motions, ..self }
    }

    /// The forecast; of joint futures, hypothesis k of every pedestrian is future k. If the model has a flow,
    /// [`Forecast::certified`] states which certificates hold, also where they were not asked for.
    pub fn forecast(&self) -> &Forecast {
        match &self.motions {
            AnsweredMotions::Alone(forecast) => forecast,
            AnsweredMotions::Joint(futures) => futures.forecast(),
        }
    }

    /// The forecast alone.
    pub fn into_forecast(self) -> Forecast {
        match self.motions {
            AnsweredMotions::Alone(forecast) => forecast,
            AnsweredMotions::Joint(futures) => futures.into_forecast(),
        }
    }

    /// The joint futures, which know risk and occupancy.
    ///
    /// # Errors
    /// [`SceneError::Alone`] if joint futures were not asked for.
    pub fn futures(&self) -> Result<&Futures, SceneError> {
        match &self.motions {
            AnsweredMotions::Alone(_) => Err(SceneError::Alone),
            AnsweredMotions::Joint(futures) => Ok(futures),
        }
    }

    /// Whether it has joint futures.
    pub fn is_joint(&self) -> bool {
        matches!(self.motions, AnsweredMotions::Joint(_))
    }

    /// The certificates `[N][K]`, of 12 steps each; empty unless they were asked for. One refers to exactly the
    /// positions of the forecast, starting with the last observed one; [`LyapunovCertificate::verify`] checks it.
    pub fn certificates(&self) -> &[LyapunovCertificate<f64>] {
        &self.certificates
    }

    /// The certificate of hypothesis `k` of pedestrian `i`, if they were asked for.
    ///
    /// # Panics
    /// When `i` or `k` is out of range.
    pub fn certificate(&self, i: usize, k: usize) -> Option<&LyapunovCertificate<f64>> {
        let hypotheses = self.forecast().hypotheses();
        assert!(k < hypotheses, "hypothesis {k} asked of {hypotheses}");
        (!self.certificates.is_empty()).then(|| &self.certificates[i * hypotheses + k])
    }

    /// Pedestrian, hypothesis and violation of the first certificate that does not hold; `None` when all hold.
    pub fn first_violation(&self) -> Option<(usize, usize, Violation)> {
        let hypotheses = self.forecast().hypotheses();
        self.certificates.iter().enumerate().find_map(|(pair, certificate)| {
            let violation = certificate.verify().err()?;
            Some((pair / hypotheses, pair % hypotheses, violation))
        })
    }
}
