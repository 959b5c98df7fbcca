//! The settings that a message asks for, named as the program or the language of the user spells them.

use std::fmt::{Display, Formatter, Result};
use std::sync::{PoisonError, RwLock};

/// A setting of the reader of a message. Libraries name the field; a program, Python or a browser says once how its
/// users [write](word_settings) it, such as `--max-age`, `max_age=` or `maxAge`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "fields by their names")]
pub enum Setting {
    Area,
    Columns,
    Convention,
    Data,
    Device,
    Dt,
    Every,
    Fold,
    Fps,
    FrameStep,
    From,
    Goals,
    Homography,
    Keep,
    MaxAge,
    Model,
    OnlyGoals,
    Patience,
    Topic,
    Unit,
    Unseen,
    Validation,
    ValidationRecordings,
    Whole,
}

/// How users write a setting, by its name such as `max_age` and the value that it should have.
pub type SettingWords = fn(name: &str, value: Option<&str>) -> String;

static WORDS: RwLock<Option<SettingWords>> = RwLock::new(None);

/// Says how the users of this process write settings. The last call counts, as of the program within Python; without
/// one the field is named.
pub fn word_settings(words: SettingWords) {
    *WORDS.write().unwrap_or_else(PoisonError::into_inner) = Some(words);
}

impl Setting {
    /// The name of the field, in lower case with underscores.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Columns => "columns",
            Self::Convention => "convention",
            Self::Data => "data",
            Self::Device => "device",
            Self::Dt => "dt",
            Self::Every => "every",
            Self::Fold => "fold",
            Self::Fps => "fps",
            Self::FrameStep => "frame_step",
            Self::From => "from",
            Self::Goals => "goals",
            Self::Homography => "homography",
            Self::Keep => "keep",
            Self::MaxAge => "max_age",
            Self::Model => "model",
            Self::OnlyGoals => "only_goals",
            Self::Patience => "patience",
            Self::Topic => "topic",
            Self::Unit => "unit",
            Self::Unseen => "unseen",
            Self::Validation => "validation",
            Self::ValidationRecordings => "validation_recordings",
            Self::Whole => "whole",
        }
    }

    /// The setting with a value.
    pub fn to(self, value: impl Display) -> String {
        worded(self.name(), Some(&value.to_string()))
    }
}

impl Display for Setting {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        formatter.write_str(&worded(self.name(), None))
    }
}

fn worded(name: &str, value: Option<&str>) -> String {
    let words = *WORDS.read().unwrap_or_else(PoisonError::into_inner);
    match (words, value) {
        (Some(words), _) => words(name, value),
        (None, Some(value)) => format!("{name} {value}"),
        (None, None) => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_words_count() {
        assert_eq!((Setting::MaxAge.to_string(), Setting::Fps.to(25)), ("max_age".into(), "fps 25".into()));
        word_settings(|_, _| String::new());
        word_settings(|name, value| format!("--{}{}", name.replace('_', "-"), value.unwrap_or_default()));
        assert_eq!((Setting::MaxAge.to_string(), Setting::Fps.to(25)), ("--max-age".into(), "--fps25".into()));
    }
}
