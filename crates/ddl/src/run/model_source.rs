//! The places that a model is loaded from.

use crate::error::DdlError;
use crate::run::builtin_model::BuiltinModel;
use crate::run::config::RunConfig;
use crate::run::directory::RunDirectory;
use std::fmt;
use std::path::{Path, PathBuf};

/// The place that a model is loaded from.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum ModelSource {
    /// The directory of a run.
    Run(RunDirectory),
    /// A packed model ([`Ddl::pack`](crate::Ddl::pack)).
    Packed(PathBuf),
    /// A model that comes with the program.
    Builtin(BuiltinModel),
}

impl ModelSource {
    /// The source at `path`: a packed model if it is a file, else the directory of a run.
    #[must_use]
    pub fn at(path: &Path) -> Self {
        if path.is_file() { Self::Packed(path.to_owned()) } else { Self::Run(RunDirectory::new(path)) }
    }

    /// The source of this name: a file or the directory of a run of this path or, if there is none, the built-in model
    /// of this name.
    #[must_use]
    pub fn named(name: &Path) -> Self {
        let builtin = name.to_str().and_then(|name| name.parse().ok());
        match builtin {
            Some(builtin) if !name.is_file() && !RunDirectory::new(name).has_config() => Self::Builtin(builtin),
            _ => Self::at(name),
        }
    }

    /// Checks the configuration of the networks and goals.
    pub(crate) fn check(&self, config: &RunConfig) -> Result<(), DdlError> {
        let star = config.star.check().map_err(DdlError::from);
        star.and_then(|()| config.goals.check()).map_err(|error| {
            self.wrong(format!("has an invalid configuration ({error}); restore the file as it was written"))
        })
    }

    /// The directory of the run, if the source is one.
    #[must_use]
    pub fn run(&self) -> Option<&RunDirectory> {
        match self {
            Self::Run(run) => Some(run),
            Self::Packed(_) | Self::Builtin(_) => None,
        }
    }

    pub(crate) fn wrong(&self, problem: impl Into<String>) -> DdlError {
        match self {
            Self::Run(run) => DdlError::run(run.path(), problem),
            Self::Packed(_) | Self::Builtin(_) => DdlError::Model { model: self.to_string(), problem: problem.into() },
        }
    }
}

impl fmt::Display for ModelSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Run(run) => write!(f, "{}", run.path().display()),
            Self::Packed(file) => write!(f, "{}", file.display()),
            Self::Builtin(model) => write!(f, "{model} (built in)"),
        }
    }
}
