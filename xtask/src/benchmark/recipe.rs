//! Which recipe models are trained by: it follows from how they are scored.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::plan::PUBLISHED_PROTOCOL;

/// How a network is made and trained: a recipe of `ddl train`, and what is changed of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Recipe {
    pub(crate) name: RecipeName,
    /// Instead of the recipe's; none is as the recipe says.
    pub(crate) optimiser: Option<Optimiser>,
}

/// What `--recipe` of `ddl train` takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum RecipeName {
    /// Whole walks to estimated goals, in minutes on a CPU.
    Recommended,
    /// The paper's: single steps, in hours.
    Published,
}

impl RecipeName {
    /// The paper's for the paper's protocol, which compares with the paper; the recommended one where it is left out.
    pub(crate) fn of_protocols(protocols: &[String]) -> Self {
        if protocols.iter().any(|name| name == PUBLISHED_PROTOCOL) {
            Self::Published
        } else {
            Self::Recommended
        }
    }

    /// What names of folders and pages say of it: nothing of the recommended one.
    pub(crate) const fn suffix(self) -> &'static str {
        match self {
            Self::Recommended => "",
            Self::Published => "-published",
        }
    }
}

impl fmt::Display for RecipeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Recommended => "recommended",
            Self::Published => "published",
        })
    }
}

/// How the optimiser goes about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Optimiser {
    /// Walkers a batch.
    pub(crate) batch_walkers: u32,
    /// Largest step size of Adam.
    pub(crate) learning_rate: f64,
    /// constant or cosine.
    pub(crate) schedule: Cow<'static, str>,
}

/// As the program has it.
pub(crate) const RECOMMENDED: Recipe = Recipe {
    name: RecipeName::Recommended,
    optimiser: None,
};

/// The paper's.
pub(crate) const PUBLISHED: Recipe = published(256, 1.5e-3, "constant");

/// The paper's network and single steps in small batches, and step sizes that fade out: what learns most of them in a few
/// thousand. Chosen on validation splits of training recordings (docs/method.md, "The short recipe").
pub(crate) const SHORT: Recipe = published(16, 1e-3, "cosine");

/// The paper's batches, and step sizes that fade out, so that fewer epochs do.
pub(crate) const FADING: Recipe = published(256, 1.5e-3, "cosine");

const fn published(batch_walkers: u32, learning_rate: f64, schedule: &'static str) -> Recipe {
    Recipe {
        name: RecipeName::Published,
        optimiser: Some(Optimiser {
            batch_walkers,
            learning_rate,
            schedule: Cow::Borrowed(schedule),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recipe_follows_the_protocols() {
        let of = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            RecipeName::of_protocols(&names)
        };
        assert_eq!(of(&["fair", "single"]), RecipeName::Recommended);
        assert_eq!(of(&["single"]), RecipeName::Recommended);
        assert_eq!(of(&["published", "fair", "single"]), RecipeName::Published);
        assert_eq!(of(&["published"]), RecipeName::Published);
    }

    /// `ddl train` reads the one, plans hold the other.
    #[test]
    fn a_recipe_has_one_name() {
        for recipe in [RECOMMENDED, PUBLISHED, SHORT, FADING] {
            let value = serde_json::to_value(&recipe).unwrap();
            assert_eq!(value["name"], recipe.name.to_string());
            assert_eq!(serde_json::from_value::<Recipe>(value).unwrap(), recipe);
        }
    }
}
