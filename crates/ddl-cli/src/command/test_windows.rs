//! The options that choose the test windows of a fold.

use crate::command::RecordingsAt;
use anyhow::bail;
use clap::Args;
use ddl::data::{Convention, Recording, Window, WindowRule};

/// Why there is nothing to measure.
pub(crate) const NO_WINDOW: &str = "no pedestrian in these recordings was observed at 20 consecutive time steps; are \
                                    they cut short, or at another rate?";

#[derive(Debug, Args)]
pub(crate) struct TestWindows {
    /// Data convention: star, social-gan, simulated or own [default: star; own if --data names recordings that are not
    /// those of star and --fold names no scene of star]
    #[arg(long)]
    pub(crate) convention: Option<Convention>,
    /// Scene to test on: eth, hotel, univ, zara1, zara2 (simulated: corridor, crossing, plaza, bottleneck, doorway;
    /// own: the name of a file without its extension [default for own: all])
    #[arg(long)]
    pub(crate) fold: Option<String>,
    /// Window rule: published, complete, observed, social-gan (at least 2 pedestrians) or social-gan-1 [default: that
    /// of the convention's headline tables: published, social-gan, complete, observed]
    #[arg(long)]
    window_rule: Option<WindowRule>,
}

impl TestWindows {
    pub(crate) fn convention(&self, recordings: &RecordingsAt, of_model: Convention) -> Convention {
        let scene = |fold: &&String| Convention::Star.fold_names().any(|name| name == *fold);
        let of_fold = self.fold.as_ref().filter(scene);
        let asked = self.convention.or(of_fold.map(|_| Convention::Star));
        recordings.convention(asked, of_model)
    }

    pub(crate) fn ensure_no_rule_for_own(&self) -> anyhow::Result<()> {
        if self.window_rule.is_some() {
            bail!("own recordings are evaluated as a live stream sees them (rule observed): leave out --window-rule");
        }
        Ok(())
    }

    pub(crate) fn rule(&self, convention: Convention) -> WindowRule {
        self.window_rule.unwrap_or_else(|| convention.headline_rule())
    }

    /// The fold's name; `None` for all own recordings.
    fn fold(&self, convention: Convention) -> anyhow::Result<Option<&str>> {
        if self.fold.is_none() && convention != Convention::Own {
            let fold_names: Vec<&str> = convention.fold_names().collect();
            bail!("give the fold to test on, --fold NAME with one of {}", fold_names.join(", "));
        }
        if let (None, Convention::Star, Some(fold)) = (self.convention, convention, &self.fold) {
            ensure_scene_of_star(fold)?;
        }
        Ok(self.fold.as_deref())
    }

    pub(crate) fn ensure_of_builtin_models(&self) -> anyhow::Result<()> {
        let convention = self.convention.unwrap_or(Convention::Star);
        if convention != Convention::Star {
            bail!(
                "the built-in models were trained on `star` data and cannot be evaluated on `{convention}` data; train \
                 a model on it (`ddl train --convention {convention}`) and give it with --model"
            );
        }
        if self.window_rule.is_some() {
            bail!(
                "a model is evaluated under the window rules of its convention: leave out --window-rule, or evaluate \
                 --forecasts"
            );
        }
        Ok(())
    }

    pub(crate) fn windows(&self, recordings: &RecordingsAt) -> anyhow::Result<(String, Vec<Window>)> {
        let convention = self.convention(recordings, Convention::Star);
        let fold = self.fold(convention)?;
        let dataset = recordings.dataset(convention)?;
        let rule = self.rule(convention);
        let Some(fold) = fold else {
            let recordings: Vec<&Recording> = dataset.recordings().iter().collect();
            let windows = recordings.iter().flat_map(|recording| recording.windows(rule));
            return Ok((ddl::test_set_name(&recordings), windows.collect()));
        };
        Ok((fold.to_owned(), dataset.fold(fold)?.test_windows(rule)))
    }
}

pub(crate) fn ensure_scene_of_star(fold: &str) -> anyhow::Result<()> {
    let scenes: Vec<&str> = Convention::Star.fold_names().collect();
    if !scenes.contains(&fold) {
        bail!(
            "the star convention has no fold {fold:?}, only {}; if {fold:?} is one of your own recordings, add \
             --convention own",
            scenes.join(", ")
        );
    }
    Ok(())
}
