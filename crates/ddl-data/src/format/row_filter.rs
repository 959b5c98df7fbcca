//! Which rows of text count: people whose position is known.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use ddl_core::Setting;

use crate::class::{PEOPLE, has_word_of, is_one_of, is_vehicle, name_words};
use crate::format::fault::Fault;
use crate::format::field::are_alike;
use crate::format::header::first_of;
use crate::format::problem::value;
use crate::format::quoted::quoted;
use crate::format::track_columns::TrackColumns;

/// Words beside those of people that do not change what they are.
const OF_PEOPLE: &str = "type class adult child moving standing sitting walking";
/// Reasons to leave rows out that are counted, each for itself.
const MOST_REASONS: usize = 20;
/// Classes after which a stream tells no more of them.
const MOST_TOLD: usize = 2;
pub(super) const UNTRACKED: &str = "with the pedestrian -1, detections without a track";
/// A position that is to be forecast (TrajNet).
const UNKNOWN: &str = "?";

/// The rows that do not count, and the classes of those that do.
#[derive(Debug, Default)]
pub(super) struct RowFilter {
    /// Classes without a known meaning that were read.
    classes: BTreeSet<String>,
    left_out: BTreeMap<String, usize>,
    /// How many reasons and classes a stream has told.
    told: [usize; 2],
}

impl RowFilter {
    /// Whether a row with these fields counts. If not, it is counted.
    ///
    /// # Errors
    /// A field that marks the row and holds no mark.
    pub(super) fn counts(&mut self, columns: &TrackColumns, fields: &[Cow<'_, str>]) -> Result<bool, Fault> {
        let why = marked(columns, fields)?.or_else(|| self.reason(columns, fields));
        Ok(why.map(|why| self.leave_out(why)).is_none())
    }

    /// Counts a row that is left out for this reason.
    pub(super) fn leave_out(&mut self, mut why: String) {
        if self.left_out.len() >= MOST_REASONS && !self.left_out.contains_key(&why) {
            "of other values".clone_into(&mut why);
        }
        *self.left_out.entry(why).or_default() += 1;
    }

    /// Why a row without a mark does not count. A class without a known meaning is kept.
    fn reason(&mut self, columns: &TrackColumns, fields: &[Cow<'_, str>]) -> Option<String> {
        let TrackColumns { roles, names, .. } = columns;
        if let Some((index, value)) = &roles.keep
            && !are_alike(&fields[*index], value)
        {
            return Some(format!("with {} {}", quoted(&names[*index]), quoted(&fields[*index])));
        }
        if let Some((index, kept)) = roles.class {
            let class = &*fields[index];
            if kept.map_or_else(|| is_vehicle(class), |kept| !class.eq_ignore_ascii_case(kept)) {
                return Some(format!("of class {}", quoted(class)));
            }
            if kept.is_none() && self.classes.len() < MOST_REASONS && !are_people(class) {
                self.classes.insert(quoted(class));
            }
        }
        let is_unknown = roles.position.columns().iter().all(|&index| fields[index] == UNKNOWN);
        is_unknown.then(|| "with ? for a position to forecast".to_owned())
    }

    /// The rows that were left out, counted by reason.
    pub(super) fn left_out(&self) -> Option<String> {
        let rows: Vec<String> = self.left_out.iter().map(|(why, count)| format!("{count} {why}")).collect();
        (!rows.is_empty()).then(|| format!("rows left out: {}", first_of(&rows)))
    }

    /// The classes that are read although their meaning is not known.
    pub(super) fn classes_read(&self) -> Option<String> {
        let classes: Vec<String> = self.classes.iter().map(|class| format!("{class:?}")).collect();
        let (named, keep) = (first_of(&classes), Setting::Keep.to("class=..."));
        (!classes.is_empty()).then(|| format!("rows of class {named} are read as pedestrians; {keep} chooses"))
    }

    /// What a stream has not told yet of the rows that are left out and the classes that are read.
    pub(super) fn news(&mut self) -> Vec<String> {
        let [reasons, classes] = [self.left_out.len(), self.classes.len()];
        let before = std::mem::replace(&mut self.told, [reasons, classes]);
        let rows = (before[0] < reasons).then(|| {
            let reasons: Vec<String> = self.left_out.keys().cloned().collect();
            format!("rows are left out: {}", first_of(&reasons))
        });
        let classes = (before[1] < classes && before[1] < MOST_TOLD).then(|| self.classes_read()).flatten();
        rows.into_iter().chain(classes).collect()
    }
}

/// Why the marks of a row leave it out.
fn marked(columns: &TrackColumns, fields: &[Cow<'_, str>]) -> Result<Option<String>, Fault> {
    for &(index, left_out) in columns.roles.marks.iter().filter(|(index, _)| !fields[*index].is_empty()) {
        let name = &columns.names[index];
        let is_marked = is_marked(&fields[index]).ok_or_else(|| {
            let name = quoted(name);
            let keep = Setting::Keep.to(format!("{name}=VALUE"));
            let problem = value(&name, "0, 1, yes or no", &fields[index]);
            Fault::at(index, problem.and(format!("; {keep} chooses rows by it")))
        })?;
        if is_marked == left_out {
            return Ok(Some(if is_marked { "marked lost".to_owned() } else { format!("with {name} 0") }));
        }
    }
    Ok(None)
}

/// Whether a class names people on foot, and nothing else.
fn are_people(class: &str) -> bool {
    let words = name_words(class);
    has_word_of(PEOPLE, &words) && words.iter().all(|word| is_one_of(PEOPLE, word) || is_one_of(OF_PEOPLE, word))
}

fn is_marked(mark: &str) -> Option<bool> {
    let number = mark.replacen(',', ".", 1).parse().ok().filter(|mark: &f64| !mark.is_nan());
    match mark.to_ascii_lowercase().as_str() {
        "yes" | "y" | "true" | "t" => Some(true),
        "no" | "n" | "false" | "f" => Some(false),
        _ => number.map(|mark| mark != 0.0),
    }
}
