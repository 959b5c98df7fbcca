//! Which test windows to take, where no model says it.

use super::RecordingsAt;
use anyhow::bail;
use clap::Args;
use ddl::data::{Convention, Window, WindowRule};

/// The test windows of a fold.
#[derive(Debug, Args)]
pub(crate) struct TestWindows {
    /// Data convention: star, social-gan, simulated or own [default: star]
    #[arg(long)]
    pub(crate) convention: Option<Convention>,
    /// Scene to test on: eth, hotel, univ, zara1, zara2 (simulated: corridor, crossing, plaza, bottleneck,
    /// doorway; own: the name of a file, without its extension)
    #[arg(long)]
    pub(crate) fold: Option<String>,
    /// Which stretches count as windows: published, complete, social-gan (at least 2 pedestrians) or social-gan-1
    /// [default: that of the convention's headline tables: published, social-gan, complete]
    #[arg(long)]
    window_rule: Option<WindowRule>,
}

impl TestWindows {
    /// The convention asked for, or the default one.
    pub(crate) fn convention(&self) -> Convention {
        self.convention.unwrap_or(Convention::Star)
    }

    /// The rule asked for, or the headline's.
    pub(crate) fn rule(&self) -> WindowRule {
        self.window_rule
            .unwrap_or_else(|| self.convention().headline_rule())
    }

    /// The fold's name.
    pub(crate) fn fold(&self) -> anyhow::Result<&str> {
        let known: Vec<&str> = self.convention().fold_names().collect();
        self.fold.as_deref().ok_or_else(|| {
            if known.is_empty() {
                return anyhow::anyhow!(
                    "give the --fold to test on: the name of a recording, without its extension"
                );
            }
            anyhow::anyhow!("give the --fold to test on, one of {}", known.join(", "))
        })
    }

    /// Refuses windows that no built-in model is measured on.
    pub(crate) fn ensure_of_builtin_models(&self) -> anyhow::Result<()> {
        let convention = self.convention();
        if convention == Convention::Own {
            bail!(
                "say which model to measure on your own recordings: --model hotel, or the directory of a run"
            );
        }
        if convention != Convention::Star {
            bail!(
                "the built-in models were trained on `star` data and cannot be measured on `{convention}` data; train one on it (`ddl train \
                 --convention {convention}`) and name it with --model"
            );
        }
        if self.window_rule.is_some() {
            bail!(
                "a model is measured under the rules of its convention's tables: leave --window-rule out, or measure --forecasts"
            );
        }
        Ok(())
    }

    /// The windows, read from a folder of recordings or simulated.
    pub(crate) fn windows(&self, recordings: &RecordingsAt) -> anyhow::Result<Vec<Window>> {
        let fold = self.fold()?;
        let dataset = recordings.dataset(self.convention())?;
        Ok(dataset.fold(fold)?.test_windows(self.rule()))
    }
}
