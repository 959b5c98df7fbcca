//! The ways in which one model is measured under the honest protocols.

use crate::forecast::clearance::Clearance;
use crate::forecast::name::WITHOUT_LIBRARY;
use crate::forecast::walk::Gait;
use crate::model::ddl::Ddl;
use ddl_eval::Protocol;
use ddl_network::Objective;

/// A manner in which the model forecasts, each a row of its own.
#[derive(Debug)]
pub(crate) struct Manner {
    pub(crate) goals: GivenGoals,
    pub(crate) way: Way,
    /// What is different from the model as it is; `None` for that one.
    pub(crate) change: Option<String>,
    pub(crate) protocols: &'static [Protocol],
}

/// Which goals the model is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GivenGoals {
    /// Its own.
    Own,
    /// The one that stands for its own.
    Central,
    /// Those it would have without its expert library.
    WithoutLibrary,
    /// Those of the published estimator, without its look at the first future frame.
    Published,
}

/// The way to the goals.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Way {
    /// As the network shapes it.
    Shaped(Gait),
    /// The neutral motion, alone or keeping clear of the others.
    Neutral(Option<Clearance>),
}

impl Manner {
    /// Where its goals come from, as results say it.
    pub(crate) fn goal_words(&self, model: &Ddl) -> String {
        match self.goals {
            // Of the published goals the name of the row tells.
            GivenGoals::Own | GivenGoals::Central | GivenGoals::Published => {
                model.goal_model().words()
            }
            GivenGoals::WithoutLibrary => model.goal_model().recipe().words_without_library(),
        }
    }

    /// The model as it is; what the published steps would make of the same flow, what is left of it without its expert library, and
    /// where `published` is measured too, what that protocol's goals are worth when none of them is chosen with the truth, all told
    /// once, in the headline protocol; in `single`, what its network would make of the way to the one goal; and, where asked for, keeping
    /// clear of others.
    pub(crate) fn all(model: &Ddl, asked: &[Protocol]) -> Vec<Self> {
        let asked = |protocol| asked.contains(&protocol);
        let variant = model.config().star.variant;
        let mut manners = Vec::new();
        let mut as_it_walks = |clearance: Option<Clearance>, change: Option<String>| {
            if asked(Protocol::Fair) {
                manners.push(Self {
                    goals: GivenGoals::Own,
                    way: Way::Shaped(Gait::Stable(clearance)),
                    change: change.clone(),
                    protocols: &[Protocol::Fair],
                });
            }
            if asked(Protocol::Single) {
                manners.push(Self {
                    goals: GivenGoals::Central,
                    way: Way::Neutral(clearance),
                    change,
                    protocols: &[Protocol::Single],
                });
            }
        };
        as_it_walks(None, None);
        if let Some(clearance) = model.clearance() {
            as_it_walks(
                Some(clearance),
                Some(format!("minding others within {} m", clearance.distance())),
            );
        }
        // A network that has learned whole stable walks has never seen where plain steps would lead it: they diverge.
        let learned_on_plain_steps = model.config().training.objective == Objective::NextStep;
        if asked(Protocol::Fair) && variant.dynamics() && learned_on_plain_steps {
            manners.push(Self {
                goals: GivenGoals::Own,
                way: Way::Shaped(Gait::PlainEuler),
                change: Some("with plain Euler steps".to_owned()),
                protocols: &[Protocol::Fair],
            });
        }
        if asked(Protocol::Single) && variant.uses_goal() {
            manners.push(Self {
                goals: GivenGoals::Central,
                way: Way::Shaped(Gait::Stable(None)),
                change: Some("on the way that its network shapes".to_owned()),
                protocols: &[Protocol::Single],
            });
        }
        let has_library = model.goal_model().has_library_beside_network();
        if asked(Protocol::Fair) && has_library && variant.uses_goal() {
            manners.push(Self {
                goals: GivenGoals::WithoutLibrary,
                way: Way::Shaped(Gait::Stable(None)),
                change: Some(WITHOUT_LIBRARY.to_owned()),
                protocols: &[Protocol::Fair],
            });
        }
        if asked(Protocol::Fair) && asked(Protocol::Published) && variant.uses_goal() {
            manners.push(Self {
                goals: GivenGoals::Published,
                way: Way::Shaped(Gait::Stable(None)),
                change: Some("with the published goals, all 20 kept".to_owned()),
                protocols: &[Protocol::Fair],
            });
        }
        manners
    }
}
