//! The windows that a model is evaluated on: the test windows of its fold under the headline rule and a second rule, or
//! the validation part of its training recordings.

use crate::error::DdlError;
use crate::error::more_for_validation;
use crate::goals::model::GoalModel;
use crate::run::builtin_model::BuiltinModel;
use crate::run::folds::fold_by_name;
use crate::run::model_source::ModelSource;
use crate::run::training_data::digest;
use crate::run::validation_part::ValidationPart;
use ddl_core::{OBSERVED, PedestrianId, Setting, Window};
use ddl_data::{Convention, Dataset, Fold, LiveTracks, Recording, WindowRule};
use ddl_network::DeviceChoice;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Seed of the test subset, fixed so that all runs are tested on the same windows.
const SUBSET_SEED: u64 = 0;

/// The windows to evaluate on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// The scene left out of training.
    Test,
    /// The last part of the training recordings, kept out of training for validation.
    Validation,
}

ddl_core::named!(Split, "part", Test => "test", Validation => "validation");

/// Test windows with the rules they belong to. A window under both rules is forecast once.
#[derive(Debug)]
pub(crate) struct TestSet {
    pub(crate) convention: Convention,
    pub(crate) fold: String,
    pub(crate) windows: Vec<Window>,
    /// Each rule with the indices of its windows; the headline rule first.
    pub(crate) rules: Vec<(WindowRule, Vec<usize>)>,
    /// How the subset was chosen; `None` for all windows.
    pub(crate) subset: Option<String>,
}

impl TestSet {
    /// The windows that the run may be evaluated on. `whole` names the recordings of a validation part of own
    /// recordings that differs from the default.
    pub(crate) fn of_run(
        goals: &GoalModel,
        dataset: &Dataset,
        on: Split,
        whole: &[String],
        pedestrians: Option<usize>,
    ) -> Result<Self, DdlError> {
        let data = &goals.config().data;
        let wrong = |problem: String| Err(goals.source().wrong(problem));
        let is_own = dataset.convention() == Convention::Own;
        let is_of_own = data.convention == Convention::Own;
        match on {
            Split::Test if is_own => return Self::of_own(goals, dataset, pedestrians),
            Split::Validation if is_own && !(is_of_own && was_trained_on_some(goals, dataset)) => {
                return Self::own_validation(goals, dataset, whole, pedestrians);
            }
            _ => {}
        }
        if data.convention != dataset.convention() {
            return wrong(format!(
                "was trained on `{}` data and cannot be evaluated on `{}` data",
                data.convention,
                dataset.convention()
            ));
        }
        if !whole.is_empty() && whole != data.validation_recordings {
            return wrong(format!(
                "has a validation part from its training and is evaluated on that; leave out {}",
                Setting::ValidationRecordings
            ));
        }
        if on == Split::Test {
            let fold = fold_by_name(dataset, &data.fold)?;
            // Those of the model that it started from.
            ensure_unknown(goals, fold.test_recordings())?;
            return Ok(Self::new(&fold, data.convention, pedestrians));
        }
        let set = Self::kept_by(goals, dataset, pedestrians)?;
        if set.windows.is_empty() {
            return wrong(format!(
                "cannot be evaluated on its validation part: no pedestrian in it was observed at 20 consecutive \
                     time steps; train a model that keeps {}",
                more_for_validation(data.recordings.len())
            ));
        }
        Ok(set)
    }

    /// The validation part of the run, which may hold no window.
    pub(crate) fn kept_by(goals: &GoalModel, dataset: &Dataset, pedestrians: Option<usize>) -> Result<Self, DdlError> {
        let data = &goals.config().data;
        if data.validation <= 0.0 && data.validation_recordings.is_empty() {
            let (share, whole) = (Setting::Validation.to(0.2), Setting::ValidationRecordings);
            return Err(goals.source().wrong(format!("kept no validation part; train it with {share} or {whole}")));
        }
        let fold = fold_by_name(dataset, &data.fold)?.with_validation_recordings(&data.validation_recordings)?;
        let (rule, fraction) = (data.window_rule, data.validation);
        if digest(&fold.training_split(rule, fraction).training) != data.sha256 {
            return Err(goals.source().wrong(format!(
                "was trained on other recordings than these and may have seen their last part; give the {} that it was \
                 trained on",
                Setting::Data
            )));
        }
        Ok(Self::validation(&fold, data.convention, rule, fraction, pedestrians))
    }

    /// The validation part of own recordings, for a model that was not trained on them.
    fn own_validation(
        goals: &GoalModel,
        dataset: &Dataset,
        whole: &[String],
        pedestrians: Option<usize>,
    ) -> Result<Self, DdlError> {
        let recordings: Vec<&Recording> = dataset.recordings().iter().collect();
        ensure_unknown(goals, &recordings)?;
        let part = if whole.is_empty() {
            ValidationPart::of_own(&dataset.whole())
        } else {
            ValidationPart { share: 0.0, recordings: whole.to_vec() }
        };
        let fold = dataset.whole().with_validation_recordings(&part.recordings)?;
        let (convention, rule) = (dataset.convention(), dataset.convention().headline_rule());
        let set = Self::validation(&fold, convention, rule, part.share, pedestrians);
        if set.windows.is_empty() {
            let [whole, share] = [Setting::ValidationRecordings, Setting::Validation];
            return Err(goals.source().wrong(format!(
                "cannot be evaluated on the validation part of these recordings: no pedestrian in it was observed at \
                 20 consecutive time steps; name whole recordings ({whole}), or leave out {share} to evaluate it on \
                 all of them"
            )));
        }
        Ok(set)
    }

    /// Own recordings: the recording that the model was trained without, if present, else all recordings.
    fn of_own(goals: &GoalModel, dataset: &Dataset, pedestrians: Option<usize>) -> Result<Self, DdlError> {
        let data = &goals.config().data;
        let recordings = dataset.recordings();
        let left_out = recordings.iter().filter(|r| data.convention == Convention::Own && r.name() == data.fold);
        let mut tested: Vec<&Recording> = left_out.collect();
        if tested.is_empty() {
            tested = recordings.iter().collect();
        }
        ensure_unknown(goals, &tested)?;
        let rule = dataset.convention().headline_rule();
        let windows: Vec<Window> = tested.iter().flat_map(|r| r.windows(rule)).collect();
        if windows.is_empty() {
            return Err(goals.source().wrong(
                "cannot be evaluated on these recordings: no pedestrian in them was observed at 20 consecutive time \
                 steps",
            ));
        }
        let set = Self {
            convention: dataset.convention(),
            fold: test_set_name(&tested),
            rules: vec![(rule, (0..windows.len()).collect())],
            windows,
            subset: None,
        };
        Ok(set.at_most(pedestrians))
    }

    /// The test windows of the fold, or a seeded part of them with about `pedestrians` pedestrians.
    pub(crate) fn new(fold: &Fold<'_>, convention: Convention, pedestrians: Option<usize>) -> Self {
        let by_rule: Vec<(WindowRule, Vec<Window>)> =
            rules(convention).into_iter().map(|rule| (rule, fold.test_windows(rule))).collect();
        let mut index_of: BTreeMap<(String, i64, Vec<PedestrianId>), usize> = BTreeMap::new();
        let mut windows: Vec<Window> = Vec::new();
        let mut rules = Vec::new();
        // The widest rule is last in `rules` and comes first here: subsets are drawn from its windows.
        for (rule, of_rule) in by_rule.into_iter().rev() {
            let mut indices = Vec::with_capacity(of_rule.len());
            for window in of_rule {
                let key = (window.recording().to_owned(), window.start_frame(), window.pedestrians().to_vec());
                let index = *index_of.entry(key).or_insert_with(|| {
                    windows.push(window);
                    windows.len() - 1
                });
                indices.push(index);
            }
            rules.push((rule, indices));
        }
        rules.reverse();
        Self { convention, fold: fold.name().to_owned(), windows, rules, subset: None }.at_most(pedestrians)
    }

    /// The validation part: the last part of the fold's training recordings.
    pub(crate) fn validation(
        fold: &Fold<'_>,
        convention: Convention,
        rule: WindowRule,
        fraction: f64,
        pedestrians: Option<usize>,
    ) -> Self {
        let windows = fold.training_split(rule, fraction).validation;
        let rules = vec![(rule, (0..windows.len()).collect())];
        let fold_name = match fold.name() {
            Fold::NO_HELD_OUT => convention.name(),
            left_out => left_out,
        };
        let part = Self { convention, fold: fold_name.to_owned(), windows, rules, subset: None }.at_most(pedestrians);
        let mut parts = Vec::new();
        if fraction > 0.0 {
            parts.push(format!("the last {fraction} of the TRAINING recordings"));
        }
        let apart = fold.validation_recordings();
        if !apart.is_empty() {
            let names: Vec<&str> = apart.iter().map(|r| r.name()).collect();
            parts.push(format!("{} whole", names.join(", ")));
        }
        let name = format!("validation: {}", parts.join(", and "));
        let subset = part.subset.map_or(name.clone(), |subset| format!("{name}; {subset}"));
        Self { subset: Some(subset), ..part }
    }

    fn at_most(self, pedestrians: Option<usize>) -> Self {
        let Some(pedestrians) = pedestrians else {
            return self;
        };
        // The text is the same for every fold, because the folds of a benchmark share a table.
        let subset = format!("where a fold has more than {pedestrians} pedestrians, a seeded part of its windows");
        let part = if self.pedestrians() > pedestrians { self.part(pedestrians) } else { self };
        Self { subset: Some(subset), ..part }
    }

    /// The same windows, observed only for the last rows.
    pub(crate) fn observed_for(self, rows: Option<usize>) -> Self {
        let Some(rows) = rows else {
            return self;
        };
        let seen = format!("observed for {rows} of {OBSERVED} rows");
        let windows = self.windows.iter().map(|window| LiveTracks::last_rows(window, rows)).collect();
        Self { windows, subset: Some(self.subset.map_or(seen.clone(), |subset| format!("{subset}; {seen}"))), ..self }
    }

    pub(crate) fn pedestrians(&self) -> usize {
        self.windows.iter().map(Window::len).sum()
    }

    pub(crate) fn headline(&self) -> impl Iterator<Item = &Window> {
        self.headline_indices().map(|i| &self.windows[i])
    }

    pub(crate) fn headline_indices(&self) -> impl Iterator<Item = usize> {
        self.rules.iter().take(1).flat_map(|(_, indices)| indices).copied()
    }

    /// A seeded part of the windows, in their order, with at least `pedestrians` pedestrians.
    fn part(self, pedestrians: usize) -> Self {
        let mut order: Vec<usize> = (0..self.windows.len()).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(SUBSET_SEED);
        for last in (1..order.len()).rev() {
            order.swap(last, rng.random_range(0..=last));
        }
        let mut count = 0;
        let wanted = order.into_iter().take_while(|&index| {
            let wanted = count < pedestrians;
            count += self.windows[index].len();
            wanted
        });
        let mut taken: Vec<usize> = wanted.collect();
        taken.sort_unstable();
        let of_part = |indices: Vec<usize>| indices.into_iter().filter_map(|i| taken.binary_search(&i).ok()).collect();
        let rules = self.rules.into_iter();
        Self {
            windows: taken.iter().map(|&i| self.windows[i].clone()).collect(),
            rules: rules.map(|(rule, indices)| (rule, of_part(indices))).collect(),
            subset: None,
            ..self
        }
    }
}

/// Whether the model was trained or validated on one of these recordings.
fn was_trained_on_some(goals: &GoalModel, dataset: &Dataset) -> bool {
    let mut recordings = dataset.recordings().iter();
    recordings.any(|recording| goals.known_share(recording).is_some())
}

/// No recording is a test that the model was trained on.
fn ensure_unknown(goals: &GoalModel, recordings: &[&Recording]) -> Result<(), DdlError> {
    let known = recordings.iter().filter_map(|recording| {
        let share = goals.known_share(recording)?;
        let name = recording.name();
        Some(format!("{name} ({:.0} % of its paths are known)", 100.0 * share))
    });
    let mut known: Vec<String> = known.collect();
    if known.is_empty() && recordings.len() > 1 {
        // Each may be too short to be known.
        let together = goals.fingerprints().known(recordings);
        known.extend(together.map(|share| format!("these together ({:.0} % of their paths are known)", 100.0 * share)));
    }
    if known.is_empty() {
        return Ok(());
    }
    let mut others = BuiltinModel::ALL.into_iter().filter(|model| {
        let goals = GoalModel::open(&ModelSource::Builtin(*model), DeviceChoice::Cpu);
        goals.is_ok_and(|goals| recordings.iter().all(|one| goals.fingerprints().is_unknown(one)))
    });
    let other = match others.next() {
        _ if goals.config().data.convention == Convention::Own && goals.source().run().is_some() => {
            let [own, fold] = [Setting::Convention.to("own"), Setting::Fold.to("NAME")];
            let part = Setting::Validation;
            format!("on its validation part ({part}), or on a recording that it is trained without ({own} {fold})")
        }
        Some(model) => format!("or take a model that was trained without it ({})", Setting::Model.to(model)),
        None => "or train a model without it".to_owned(),
    };
    Err(goals.source().wrong(format!("was trained on {}; evaluate it on other recordings, {other}", known.join(", "))))
}

/// A short name in the results for recordings that are tested together.
#[must_use]
pub fn test_set_name(tested: &[&Recording]) -> String {
    match tested {
        [] => String::new(),
        [only] => only.name().to_owned(),
        [first, .., last] => format!("{} recordings, {} to {}", tested.len(), first.name(), last.name()),
    }
}

/// The rule of the headline tables, then the second rule.
fn rules(convention: Convention) -> Vec<WindowRule> {
    let beside = match convention {
        Convention::Star => Some(WindowRule::Complete),
        Convention::SocialGan => Some(WindowRule::SocialGan { min_pedestrians: 1 }),
        Convention::Simulated | Convention::Own => None,
    };
    [convention.headline_rule()].into_iter().chain(beside).collect()
}
