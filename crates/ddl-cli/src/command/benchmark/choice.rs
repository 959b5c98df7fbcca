//! The options that choose folds, methods and protocols, and the plan made of them.

use crate::command::benchmark::method::Method;
use crate::command::benchmark::plan::{BenchmarkPlan, Settings, Training};
use crate::command::benchmark::profile::Profile;
use crate::command::recipe::Recipe;
use crate::command::{at_least_one, ensure_no_files, folder};
use crate::telling::tell;
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{Convention, locate};
use ddl::{DeviceChoice, Protocol};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct PlanOptions {
    /// How much work
    #[arg(long, value_enum, default_value_t = Profile::Quick)]
    profile: Profile,
    /// star, social-gan or simulated [default: the first of these whose recordings are there]
    #[arg(long)]
    convention: Option<Convention>,
    /// Folder of the recordings [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Folds to test on, as in `eth,hotel` [default: the profile's]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    folds: Vec<String>,
    /// Variants to train: full, no-goal-shift, no-dynamics, star, perceptron (the full method on a network without
    /// attention), or all
    #[arg(long, value_delimiter = ',', value_name = "NAMES", default_value = "full")]
    variants: Vec<String>,
    /// Protocols to score under: published, fair, single, online, online-single, joint; with published the models are
    /// trained by the paper's recipe, otherwise by the recommended one, which keeps only the last epoch
    #[arg(
        long = "protocol",
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "fair,single,online,online-single"
    )]
    protocols: Vec<Protocol>,
    /// Seeds of the trainings; the report gives means and standard deviations over them
    #[arg(long, value_delimiter = ',', value_name = "NUMBERS", default_value = "1")]
    seeds: Vec<u64>,
    /// auto, cpu or cuda
    #[arg(long, default_value = "cpu")]
    device: DeviceChoice,
    /// Pedestrians trained on in each epoch [default: the profile's, or else the recipe's]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    train_pedestrians: Option<usize>,
    /// Test pedestrians scored [default: the profile's]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    test_pedestrians: Option<usize>,
    /// Training epochs [default: the profile's]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    epochs: Option<usize>,
}

impl PlanOptions {
    /// The plan; prints the data convention where no option names it.
    pub(super) fn plan(&self) -> anyhow::Result<BenchmarkPlan> {
        let (convention, data) = self.recordings()?;
        self.plan_of(convention, data)
    }

    fn recordings(&self) -> anyhow::Result<(Convention, Option<PathBuf>)> {
        let data = self.data.as_deref();
        let convention = match self.convention {
            Some(Convention::Own) => bail!(
                "--convention of a benchmark is star, social-gan or simulated; for your own recordings use `ddl train` \
                 and `ddl evaluate`"
            ),
            Some(convention) => convention,
            None => {
                let mut recorded = [Convention::Star, Convention::SocialGan].into_iter();
                let there = recorded.find(|&convention| locate(convention, data).is_ok());
                match (there, data) {
                    (Some(convention), _) => convention,
                    // The error then names the missing recordings.
                    (None, Some(_)) => Convention::Star,
                    (None, None) => Convention::Simulated,
                }
            }
        };
        let folder_of_recordings = match convention {
            Convention::Simulated => {
                ensure_no_files(data)?;
                None
            }
            recorded => Some(std::path::absolute(folder(recorded, data)?)?),
        };
        if self.convention.is_none() {
            tell(format_args!("data convention: {convention}"));
        }
        Ok((convention, folder_of_recordings))
    }

    fn plan_of(&self, convention: Convention, data: Option<PathBuf>) -> anyhow::Result<BenchmarkPlan> {
        let mut protocols = self.protocols.clone();
        // Their order does not change the results.
        protocols.sort_unstable();
        protocols.dedup();
        // The protocol `published` compares with the paper, so it needs the paper's recipe.
        let name = if protocols.contains(&Protocol::Published) { Recipe::Published } else { Recipe::Recommended };
        if name == Recipe::Published && protocols.iter().any(|protocol| protocol.gives_recording_memory()) {
            bail!(
                "the protocol published needs the paper's recipe, whose models have no memory of a place: leave out \
                 published, or online and online-single"
            );
        }
        let work = self.profile.work(name);
        let fold_names: Vec<&str> = convention.fold_names().collect();
        let folds: Vec<String> = if self.folds.is_empty() {
            fold_names.iter().take(work.folds).map(|&fold| fold.to_owned()).collect()
        } else {
            for fold in &self.folds {
                one_of("fold", fold, &fold_names)?;
            }
            self.folds.clone()
        };
        let methods = if self.variants == ["all"] {
            Method::ALL.to_vec()
        } else {
            let names = Method::ALL.map(Method::name);
            let methods = self.variants.iter();
            methods.map(|name| Ok(Method::ALL[one_of("variant", name, &names)?])).collect::<anyhow::Result<_>>()?
        };
        let settings = Settings {
            profile: self.profile,
            convention,
            data,
            device: self.device,
            cargo_profile: if cfg!(debug_assertions) { "dev".to_owned() } else { "release".to_owned() },
            epochs: self.epochs.unwrap_or(work.epochs),
            train_pedestrians: self.train_pedestrians.or(work.train_pedestrians),
            proposal_steps: work.proposal_steps,
            test_pedestrians: self.test_pedestrians.or(work.test_pedestrians),
            protocols,
            recipe: Training { name, optimiser: work.optimiser },
        };
        BenchmarkPlan::new(settings, &folds, &methods, &self.seeds)
    }
}

/// The default folder of the results of a plan.
pub(super) fn usual_folder(plan: &BenchmarkPlan) -> PathBuf {
    let settings = &plan.settings;
    let suffix = match settings.recipe.name {
        Recipe::Recommended => "",
        Recipe::Published => "-published",
    };
    let name = format!("{}-{}{suffix}", settings.convention, settings.profile);
    Path::new("runs").join(name)
}

fn one_of(what: &str, name: &str, names: &[&str]) -> anyhow::Result<usize> {
    let index = names.iter().position(|known_name| *known_name == name);
    index.with_context(|| format!("unknown {what} {name:?}: choose from {}", names.join(", ")))
}

#[cfg(test)]
#[path = "choice_tests.rs"]
pub(super) mod tests;
