//! The benchmark: a plan of independent tasks, written as data, and who works it off.
//!
//! A task trains and scores one model: a fold, a variant, a seed. [`Plan`] holds the tasks and the
//! settings they share, and knows the program's arguments for each; it is written to
//! `plan.json`. An [`Executor`] runs a plan; [`Local`] does so in processes on this machine, and
//! another one could hand the same plan to a cluster.

mod child;
mod cost;
mod executor;
mod folds;
mod local;
mod lock;
mod plan;
mod profile;
mod progress;
mod recipe;
mod record;

pub(crate) use executor::{End, Executor, Stop};
pub(crate) use folds::fold_names;
pub(crate) use local::Local;
pub(crate) use lock::Lock;
pub(crate) use plan::{PROTOCOLS, PUBLISHED_PROTOCOL, Plan, Settings, Task, VARIANTS};
pub(crate) use profile::Profile;
pub(crate) use progress::{Display, human};
pub(crate) use recipe::RecipeName;
#[cfg(test)]
pub(crate) use recipe::{PUBLISHED, RECOMMENDED};
