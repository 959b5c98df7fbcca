//! The errors of the pedestrians of one kind of motion.

use serde::{Deserialize, Serialize};

use crate::motion_kind::MotionKind;
use crate::pedestrian_scores::PedestrianScores;
use crate::protocol::Protocol;

/// The errors of one kind of motion on the test windows of one fold: means over its pedestrians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CategoryScores {
    /// The kind.
    pub category: MotionKind,
    /// Pedestrians of this kind, at least one; a pedestrian in several windows counts once for each.
    pub pedestrians: usize,
    /// minADE over K, metres.
    pub min_ade: f64,
    /// minFDE over K, a separate minimum, metres.
    pub min_fde: f64,
    /// ADE in the future of JADE, the best one for the whole scene, metres; `None` except under `joint`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint_ade: Option<f64>,
    /// FDE in the future of JFDE, metres; `None` except under `joint`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint_fde: Option<f64>,
}

impl CategoryScores {
    /// As [`Scores::errors`](crate::Scores::errors), of the kind; `None` if they were not computed.
    pub fn errors(&self, protocol: Protocol) -> Option<[f64; 2]> {
        match protocol {
            Protocol::Joint => Some([self.joint_ade?, self.joint_fde?]),
            _ => Some([self.min_ade, self.min_fde]),
        }
    }

    pub(crate) fn of<'a>(pedestrians: impl Iterator<Item = &'a PedestrianScores>) -> Vec<Self> {
        let pedestrians: Vec<&PedestrianScores> = pedestrians.collect();
        let scores = MotionKind::ALL.into_iter().filter_map(|kind| {
            let members: Vec<_> = pedestrians.iter().copied().filter(|p| p.motion == Some(kind)).collect();
            (!members.is_empty()).then(|| Self::mean(kind, &members))
        });
        scores.collect()
    }

    fn mean(category: MotionKind, members: &[&PedestrianScores]) -> Self {
        let n = members.len() as f64;
        let mean = |metric: fn(&PedestrianScores) -> f64| members.iter().map(|w| metric(w)).sum::<f64>() / n;
        let joint = |error: usize| members.iter().map(|w| Some(w.joint?[error])).sum::<Option<f64>>();
        Self {
            category,
            pedestrians: members.len(),
            min_ade: mean(|w| w.min_ade),
            min_fde: mean(|w| w.min_fde),
            joint_ade: joint(0).map(|sum| sum / n),
            joint_fde: joint(1).map(|sum| sum / n),
        }
    }
}
