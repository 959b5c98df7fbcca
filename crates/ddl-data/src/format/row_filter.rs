//! Which rows of text count: people whose position is known.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use ddl_core::Setting;

use crate::format::choice::ColumnChoice;
use crate::format::column_names::{is_one_of, words};
use crate::format::field;
use crate::format::header::{Header, first_of};
use crate::format::layouts::Layout;

/// Classes that are not people on foot. A row of one of them is left out.
const VEHICLES: &str = "car cars veh vehicle truck trucks bus van trailer tram train bicycle bicyclist cyclist biker \
                        bike motorcycle motorcyclist motorbike scooter skater cart vehicles wheeler robot ego";
const PEOPLE: &str = "pedestrian pedestrians ped peds person persons people human";
/// Words beside those of people that do not change what they are.
const OF_PEOPLE: &str = "type class adult child moving standing sitting walking";
/// First words of classes that deny people, as in `NonPedestrian`.
const DENIALS: &str = "non not";
/// Reasons to leave rows out that are counted, each for itself.
const MOST_REASONS: usize = 20;
/// Classes after which a stream tells no more of them.
const MOST_TOLD: usize = 2;
pub(super) const UNTRACKED: &str = "with the pedestrian -1, detections without a track";
/// A position that is to be forecast (TrajNet).
const UNKNOWN: &str = "?";

/// The rows that count, and those left out so far.
#[derive(Debug, Clone, Default)]
pub(super) struct RowFilter {
    /// The column of classes, and the class that is read; `None` for all but vehicles.
    class: Option<(usize, Option<&'static str>)>,
    /// The column that the user names, its name, and its value in rows that count.
    keep: Option<(usize, String, String)>,
    /// The columns that mark rows, the mark of those that do not count, and their names.
    marks: Vec<(usize, bool, String)>,
    /// Classes without a known meaning that were read.
    classes: BTreeSet<String>,
    left_out: BTreeMap<String, usize>,
    /// How many reasons and classes a stream has told.
    told: [usize; 2],
}

impl RowFilter {
    /// The filter of columns with these names, which are those of a layout or a header's own.
    pub(super) fn of(header: &Header, layout: Option<&Layout>, choice: &ColumnChoice, names: &[String]) -> Self {
        let keep = header.keep.zip(choice.keep.as_ref());
        let class = match layout {
            Some(layout) => layout.class.map(|(index, class)| (index, Some(class))),
            None => header.class.map(|index| (index, None)),
        };
        // What marks rows or their class may be what is kept.
        let not_kept = |index: usize| Some(index) != header.keep;
        let marks = header.marks.iter().filter(|(index, _)| not_kept(*index));
        Self {
            class: class.filter(|&(index, _)| not_kept(index)),
            keep: keep.map(|(index, (_, value))| (index, names[index].clone(), value.clone())),
            marks: marks.map(|&(index, left_out)| (index, left_out, names[index].clone())).collect(),
            ..Self::default()
        }
    }

    /// Whether a row with these fields counts; `place` are the columns of its position. If not, it is counted.
    ///
    /// # Errors
    /// A field that marks the row, counted from 0, and what is wrong with it.
    pub(super) fn counts(&mut self, fields: &[Cow<'_, str>], place: &[usize]) -> Result<bool, (usize, String)> {
        Ok(self.reason(fields, place)?.map(|why| self.leave_out(why)).is_none())
    }

    /// Counts a row that is left out for this reason.
    pub(super) fn leave_out(&mut self, mut why: String) {
        if self.left_out.len() >= MOST_REASONS && !self.left_out.contains_key(&why) {
            "of other values".clone_into(&mut why);
        }
        *self.left_out.entry(why).or_default() += 1;
    }

    fn reason(&mut self, fields: &[Cow<'_, str>], place: &[usize]) -> Result<Option<String>, (usize, String)> {
        for (index, left_out, name) in &self.marks {
            let found = &*fields[*index];
            if found.is_empty() {
                continue;
            }
            let is_marked = is_marked(found).ok_or_else(|| {
                let [name, found] = [name, found].map(field::quoted);
                let wanted = format!("{name} must be 0, 1, yes or no, found {found:?}");
                (*index, format!("{wanted}; {} chooses rows by it", Setting::Keep.to(format!("{name}=VALUE"))))
            })?;
            if is_marked == *left_out {
                let why = if is_marked { "marked lost".to_owned() } else { format!("with {name} 0") };
                return Ok(Some(why));
            }
        }
        Ok(self.other_reason(fields, place))
    }

    fn other_reason(&mut self, fields: &[Cow<'_, str>], place: &[usize]) -> Option<String> {
        if let Some((index, name, value)) = &self.keep
            && !are_alike(&fields[*index], value)
        {
            return Some(format!("with {} {}", field::quoted(name), field::quoted(&fields[*index])));
        }
        if let Some((index, kept)) = self.class {
            let class = &*fields[index];
            if kept.map_or_else(|| is_vehicle(class), |kept| !class.eq_ignore_ascii_case(kept)) {
                return Some(format!("of class {}", field::quoted(class)));
            }
            let words = words(class);
            let is_of_people = |word: &String| is_one_of(PEOPLE, word) || is_one_of(OF_PEOPLE, word);
            let is_known = has_word_of(PEOPLE, &words) && words.iter().all(is_of_people);
            if kept.is_none() && !is_known && self.classes.len() < MOST_REASONS {
                self.classes.insert(field::quoted(class));
            }
        }
        let is_unknown = place.iter().all(|&index| fields[index] == UNKNOWN);
        is_unknown.then(|| "with ? for a position to forecast".to_owned())
    }

    /// Whether people are read, and not another class that the user names.
    pub(super) fn is_of_people(&self) -> bool {
        self.class.is_some()
    }

    /// The rows that were left out, counted by reason.
    pub(super) fn left_out(&self) -> Option<String> {
        let rows = self.left_out.iter().map(|(why, count)| format!("{count} {why}"));
        let rows: Vec<String> = rows.collect();
        (!rows.is_empty()).then(|| format!("rows left out: {}", first_of(&rows)))
    }

    /// The classes that are read although their meaning is not known.
    pub(super) fn classes_read(&self) -> Option<String> {
        let classes: Vec<String> = self.classes.iter().map(|class| format!("{class:?}")).collect();
        (!classes.is_empty()).then(|| {
            let (classes, keep) = (first_of(&classes), Setting::Keep.to("class=..."));
            format!("rows of class {classes} are read as pedestrians; {keep} chooses")
        })
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

/// Whether a class names something else than people on foot, as `car` and `vehicle.bicycle` do.
pub fn is_vehicle(class: &str) -> bool {
    let words = words(class);
    let is_other = has_word_of(VEHICLES, &words) && !has_word_of(PEOPLE, &words);
    let is_denied = words.first().is_some_and(|word| is_one_of(DENIALS, word))
        && words.last().is_some_and(|word| is_one_of(PEOPLE, word));
    is_other || is_denied || is_one_of(VEHICLES, &class.to_ascii_lowercase())
}

fn has_word_of(names: &str, words: &[String]) -> bool {
    words.iter().any(|word| is_one_of(names, word))
}

fn is_marked(mark: &str) -> Option<bool> {
    let number = mark.replacen(',', ".", 1).parse().ok();
    let number = number.filter(|mark: &f64| !mark.is_nan());
    match mark.to_ascii_lowercase().as_str() {
        "yes" | "y" | "true" | "t" => Some(true),
        "no" | "n" | "false" | "f" => Some(false),
        _ => number.map(|mark| mark != 0.0),
    }
}

/// Whether two values are the same word or the same number.
#[expect(clippy::float_cmp, reason = "1 and 1.0 are the same number")]
pub(super) fn are_alike(found: &str, asked: &str) -> bool {
    let numbers = found.parse::<f64>().ok().zip(asked.parse::<f64>().ok());
    found.eq_ignore_ascii_case(asked) || numbers.is_some_and(|(found, asked)| found == asked)
}
