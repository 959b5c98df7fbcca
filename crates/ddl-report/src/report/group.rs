//! Groups of rows: those of one table, and those of one line of it.

use crate::document::Part;
use crate::report::spread::SeedSpread;
use ddl_data::{Convention, WindowRule};
use ddl_eval::{Conditions, Protocol, ResultRow, Scores, significance::BlockErrors};

/// Comparable rows: one table.
pub(crate) struct ResultGroup<'a> {
    pub(crate) convention: Convention,
    pub(crate) window_rule: WindowRule,
    pub(crate) protocol: Protocol,
    pub(crate) test_subset: Option<&'a str>,
    pub(crate) lines: Vec<TableLine<'a>>,
}

/// Results that differ only in fold and seed: one line of a table.
pub(crate) struct TableLine<'a> {
    pub(crate) rows: Vec<&'a ResultRow>,
}

/// Groups rows into tables, sorted by convention, the published window rule first, the headline protocol first.
pub(crate) fn groups(rows: &[ResultRow]) -> Vec<ResultGroup<'_>> {
    let mut groups: Vec<ResultGroup<'_>> = Vec::new();
    for row in rows {
        let c = &row.conditions;
        let index = groups.iter().position(|group| group.admits(c)).unwrap_or_else(|| {
            groups.push(ResultGroup {
                convention: c.convention,
                window_rule: c.window_rule,
                protocol: c.protocol,
                test_subset: c.test_subset.as_deref(),
                lines: Vec::new(),
            });
            groups.len() - 1
        });
        let group = &mut groups[index];
        match group.lines.iter_mut().find(|line| line.admits(c)) {
            Some(line) => line.rows.push(row),
            None => group.lines.push(TableLine { rows: vec![row] }),
        }
    }
    groups.sort_by_key(|group| {
        let convention = Convention::ALL.iter().position(|c| *c == group.convention);
        let (rule, protocol) = (group.window_rule, order(group.protocol));
        let other_rule = (rule != WindowRule::Published, rule.to_string());
        (convention, other_rule, protocol, group.test_subset)
    });
    groups
}

/// Order of protocols: the headline protocol first, the one that chooses with the true future last.
pub(crate) fn order(protocol: Protocol) -> usize {
    match protocol {
        Protocol::Fair => 0,
        Protocol::Single => 1,
        Protocol::Online => 2,
        Protocol::OnlineSingle => 3,
        Protocol::Joint => 4,
        Protocol::Published => 5,
    }
}

impl ResultGroup<'_> {
    fn admits(&self, c: &Conditions) -> bool {
        (self.convention, self.window_rule, self.protocol, self.test_subset)
            == (c.convention, c.window_rule, c.protocol, c.test_subset.as_deref())
    }

    /// Whether both groups score the same windows of the same data, under any protocols.
    pub(crate) fn same_windows(&self, other: &Self) -> bool {
        (self.convention, self.window_rule, self.test_subset)
            == (other.convention, other.window_rule, other.test_subset)
    }

    pub(crate) fn title(&self) -> String {
        format!("Protocol `{}`, window rule `{}`, convention `{}`", self.protocol, self.window_rule, self.convention)
    }

    /// Protocol, window rule, convention and scored part, for captions.
    pub(crate) fn conditions_in_words(&self) -> String {
        format!(
            "Data convention `{}`, window rule `{}`, protocol `{}`; scored: {}.",
            self.convention,
            self.window_rule,
            self.protocol,
            self.test_subset.unwrap_or("all test windows")
        )
    }

    /// The columns: the folds of the convention, and any other fold that a row names.
    pub(crate) fn folds(&self) -> Vec<&str> {
        let mut folds: Vec<&str> = self.convention.fold_names().collect();
        for row in self.lines.iter().flat_map(|line| &line.rows) {
            if !folds.contains(&row.conditions.fold.as_str()) {
                folds.push(&row.conditions.fold);
            }
        }
        folds
    }

    /// The name of each line; equal names of different settings are numbered.
    pub(crate) fn labels(&self) -> Vec<String> {
        let labels: Vec<String> = self.lines.iter().map(|l| l.conditions().label()).collect();
        let numbered = |(index, label): (usize, &String)| {
            let same = labels.iter().filter(|other| *other == label).count();
            let before = labels[..index].iter().filter(|other| *other == label).count();
            if same > 1 { format!("{label} #{}", before + 1) } else { label.clone() }
        };
        labels.iter().enumerate().map(numbered).collect()
    }

    pub(crate) fn labelled(&self) -> impl Iterator<Item = (&TableLine<'_>, String)> {
        self.lines.iter().zip(self.labels())
    }

    pub(crate) fn pedestrians(&self, fold: &str) -> Vec<usize> {
        self.lines.iter().flat_map(|line| line.on(fold)).map(|row| row.scores.pedestrians).collect()
    }

    /// The names of the errors in its main table, such as `minADE/minFDE`.
    pub(crate) fn errors(&self) -> String {
        self.protocol.errors().join("/")
    }

    pub(crate) fn warning(&self) -> Option<Part> {
        let words = self.protocol.warning()?;
        Some(Part::Warning(words.to_owned()))
    }
}

impl<'a> TableLine<'a> {
    fn admits(&self, c: &Conditions) -> bool {
        let mine = self.conditions();
        let same = Conditions { fold: mine.fold.clone(), seed: mine.seed, ..c.clone() };
        *mine == same
    }

    pub(crate) fn conditions(&self) -> &'a Conditions {
        &self.rows[0].conditions
    }

    pub(crate) fn on<'b>(&'b self, fold: &'b str) -> impl Iterator<Item = &'a ResultRow> + 'b {
        self.rows.iter().copied().filter(move |row| row.conditions.fold == fold)
    }

    /// The errors by block on one fold, mean over the seeds; `None` unless all seeds have the same windows.
    pub(crate) fn blocks(&self, fold: &str) -> Option<Vec<BlockErrors>> {
        let rows: Vec<&ResultRow> = self.on(fold).collect();
        let count = rows.len() as f64;
        let mut mean = rows.first()?.blocks.clone();
        for row in &rows[1..] {
            if row.blocks.len() != mean.len() {
                return None;
            }
            for (sum, block) in mean.iter_mut().zip(&row.blocks) {
                if !sum.same_windows(block) {
                    return None;
                }
                sum.min_ade += block.min_ade;
                sum.min_fde += block.min_fde;
            }
        }
        for sum in &mut mean {
            sum.min_ade /= count;
            sum.min_fde /= count;
        }
        (!mean.is_empty()).then_some(mean)
    }

    pub(crate) fn seeds(&self) -> Vec<Option<u64>> {
        let mut seeds: Vec<_> = self.rows.iter().map(|row| row.conditions.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        seeds
    }

    /// A metric on one fold, with its spread over the seeds; `None` if a seed lacks it.
    pub(crate) fn on_fold(&self, fold: &str, metric: impl Fn(&Scores) -> Option<f64>) -> Option<SeedSpread> {
        let values: Option<Vec<f64>> = self.on(fold).map(|row| metric(&row.scores)).collect();
        SeedSpread::of(&values?)
    }

    /// The unweighted mean over the folds, with its spread over the seeds; `None` unless every seed has it on every
    /// fold.
    pub(crate) fn over_folds(&self, folds: &[&str], metric: impl Fn(&Scores) -> Option<f64>) -> Option<SeedSpread> {
        let mean_of_seed = |seed: Option<u64>| {
            let on_fold = |fold: &&str| {
                let row = self.on(fold).find(|row| row.conditions.seed == seed)?;
                metric(&row.scores)
            };
            let values: Option<Vec<f64>> = folds.iter().map(on_fold).collect();
            values.map(|values| values.iter().sum::<f64>() / folds.len() as f64)
        };
        let means: Option<Vec<f64>> = self.seeds().into_iter().map(mean_of_seed).collect();
        SeedSpread::of(&means?)
    }

    /// Text with the conditions of the line: seeds, training, device, commit.
    pub(crate) fn settings(&self) -> String {
        let c: &'a Conditions = self.conditions();
        let or_unknown = |text: &'a str| if text.is_empty() { "unknown" } else { text };
        let commit = or_unknown(&c.commit);
        // Training and seed of another program are unknown.
        if let (None, Some(origin)) = (c.epochs, &c.selection) {
            return format!(
                "{origin}; its seed, its training and its use of the future are not known here; scored at commit \
                 {commit}"
            );
        }
        let seeds: Vec<String> = self.seeds().iter().flatten().map(u64::to_string).collect();
        let mut parts = vec![match seeds.len() {
            0 => "no seed (nothing random)".to_owned(),
            1 => format!("seed {}", seeds[0]),
            _ => format!("seeds {}", seeds.join(", ")),
        }];
        match c.epochs {
            None => parts.push("not trained".to_owned()),
            Some(epochs) => {
                let selection = c.selection.as_deref().map_or(String::new(), |s| format!(" ({s})"));
                parts.push(format!("{epochs} epochs{selection}"));
                let subset = c.training_subset.as_deref().unwrap_or("all training windows");
                parts.push(format!("trained on {subset}"));
                parts.extend(c.recipe.clone());
            }
        }
        parts.push(format!("device {}", or_unknown(&c.device)));
        parts.push(format!("commit {commit}"));
        parts.join("; ")
    }

    pub(crate) fn present<'f>(&self, folds: &[&'f str]) -> Vec<&'f str> {
        folds.iter().copied().filter(|fold| self.on(fold).next().is_some()).collect()
    }
}
