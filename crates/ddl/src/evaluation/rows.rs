//! From forecasts of a test set to rows of a report, each with the conditions of its numbers.

use crate::error::DdlError;
use crate::forecast::name;
use crate::model::ddl::Ddl;
use crate::run::words::{recipe, subset};
use crate::windows::test_set::TestSet;
use ddl_core::{Forecast, Window};
use ddl_data::{Convention, WindowRule};
use ddl_eval::{Conditions, Protocol, ResultRow, baseline};

/// Forecasts of one forecaster, one for each window of the test set.
#[derive(Debug)]
pub(crate) struct NamedForecasts {
    forecaster: String,
    /// How the epoch of the trained model was chosen; `None` for straight lines to goals, which depend only on the
    /// run's seed.
    selection: Option<String>,
    goals: String,
    forecasts: Vec<Forecast>,
}

impl NamedForecasts {
    /// Forecasts of the model of that name, unchanged or with a change; `goals` names the origin of its goals.
    pub(crate) fn model(
        name: &str,
        forecasts: Vec<Forecast>,
        change: Option<&str>,
        goals: String,
        selection: &str,
    ) -> Self {
        Self {
            forecaster: match change {
                None => name.to_owned(),
                // "DDL with plain Euler steps"
                Some(change) if name == name::NAME => format!("{name} {change}"),
                Some(change) => format!("{name}, {change}"),
            },
            selection: Some(selection.to_owned()),
            goals,
            forecasts,
        }
    }

    /// Straight lines to the goals of that name; `recipe` describes how the goals were made.
    pub(crate) fn lines_to(goal: &str, recipe: String, forecasts: Vec<Forecast>) -> Self {
        Self { forecaster: format!("straight line to {goal}"), selection: None, goals: recipe, forecasts }
    }
}

/// The conditions that all rows of a protocol share.
#[derive(Debug)]
pub(crate) struct ResultRows<'a> {
    pub(crate) model: &'a Ddl,
    pub(crate) test: &'a TestSet,
    pub(crate) protocol: Protocol,
    pub(crate) commit: &'a str,
}

impl ResultRows<'_> {
    /// The rows of the forecasts in their order, then those of the baselines, for each window rule.
    pub(crate) fn of(&self, named_forecasts: &[NamedForecasts]) -> Result<Vec<ResultRow>, DdlError> {
        let mut rows = Vec::new();
        for (rule, indices) in &self.test.rules {
            // A small part may hold no window of a rule.
            if indices.is_empty() {
                continue;
            }
            let windows: Vec<Window> = indices.iter().map(|&index| self.test.windows[index].clone()).collect();
            let plain = self.conditions(*rule);
            for one in named_forecasts {
                let of_rule: Vec<Forecast> = indices.iter().map(|&i| one.forecasts[i].clone()).collect();
                let mut conditions = plain.clone();
                if one.selection.is_some() {
                    conditions = self.of_the_model(conditions, one);
                } else {
                    conditions.seed = Some(self.model.config().training.seed);
                    conditions.recipe = Some(one.goals.clone());
                }
                conditions.forecaster.clone_from(&one.forecaster);
                rows.push(ResultRow::score(conditions, &windows, &of_rule)?);
            }
            rows.extend(baseline::measure(&plain, &windows)?);
        }
        Ok(rows)
    }

    fn conditions(&self, rule: WindowRule) -> Conditions {
        Conditions {
            device: "cpu".to_owned(),
            commit: self.commit.to_owned(),
            test_subset: self.test.subset.clone(),
            ..Conditions::new(self.test.convention, rule, self.protocol, &*self.test.fold, "")
        }
    }

    /// Further conditions that the model's forecasts depend on.
    fn besides(&self) -> String {
        let rounded = match self.model.run() {
            Some(_) => "",
            None => "; weights rounded to 16 bits",
        };
        let data = &self.model.config().data;
        let (convention, fold) = (data.convention, &data.fold);
        if convention == Convention::Own {
            // Distinguishes models trained on different own recordings.
            let (count, sha256) = (data.recordings.len(), data.sha256.get(..12));
            let sha256 = sha256.unwrap_or_default();
            return format!("{rounded}; trained on {count} own recordings ({sha256})");
        }
        if convention == self.test.convention {
            return rounded.to_owned();
        }
        format!("{rounded}; trained on `{convention}` without {fold}")
    }

    fn of_the_model(&self, plain: Conditions, one: &NamedForecasts) -> Conditions {
        let config = self.model.config();
        let training = &config.training;
        Conditions {
            variant: Some(config.star.name()),
            seed: Some(training.seed),
            epochs: Some(training.epochs),
            selection: one.selection.clone(),
            device: self.model.device().words().to_owned(),
            training_subset: subset(training),
            recipe: Some(recipe(training, &one.goals) + &self.besides()),
            ..plain
        }
    }
}
