//! Lines of text as fields.

use std::borrow::Cow;

use crate::format::fault::Fault;
use crate::format::field::trimmed;

/// What stands between the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// Any number of blanks and tabs.
    Blanks,
}

impl Separator {
    pub(super) fn of(line: &str) -> Self {
        let count = |separator: char| line.matches(separator).count();
        let is_digit = |at: usize| line.as_bytes().get(at).is_some_and(u8::is_ascii_digit);
        let mut commas = line.match_indices(',');
        let are_decimal = commas.all(|(at, _)| at > 0 && is_digit(at - 1) && is_digit(at + 1));
        let (mut commas, semicolons) = (count(','), count(';'));
        let is_split = line.split(';').all(|field| field.matches(',').count() < 2);
        let words = || line.split_ascii_whitespace();
        if are_decimal && words().count() >= 4 && words().all(|word| word.matches(',').count() < 2) {
            commas = 0;
        }
        // No decimal mark is a semicolon.
        if semicolons > 0 && (is_split || semicolons >= commas) {
            Self::Semicolon
        } else if commas > 0 {
            Self::Comma
        } else if count('\t') > 0 {
            Self::Tab
        } else {
            Self::Blanks
        }
    }

    /// The separator of rows without a header, which have no empty fields.
    pub(super) fn of_numbers(line: &str) -> Self {
        match Self::of(line) {
            Self::Tab => Self::Blanks,
            other => other,
        }
    }

    fn letter(self) -> char {
        match self {
            Self::Comma => ',',
            Self::Semicolon => ';',
            Self::Tab => '\t',
            Self::Blanks => ' ',
        }
    }

    /// A number with a decimal point: where no comma stands between fields, it is a decimal comma.
    pub(super) fn with_point(self, number: &str) -> Cow<'_, str> {
        if self != Self::Comma && number.contains(',') { number.replacen(',', ".", 1).into() } else { number.into() }
    }

    /// The fields of a line, without blanks around them and quotes.
    pub(super) fn fields(self, text: &str) -> Result<Vec<Cow<'_, str>>, Fault> {
        let mut fields = Vec::new();
        self.split(text, &mut fields)?;
        Ok(fields)
    }

    /// As [`fields`](Self::fields), into a list that is used again for the next line.
    pub(super) fn split<'a>(self, text: &'a str, fields: &mut Vec<Cow<'a, str>>) -> Result<(), Fault> {
        fields.clear();
        if self == Self::Blanks {
            let words = text.split_ascii_whitespace();
            fields.extend(words.map(|field| Cow::from(field.trim_matches('"'))));
            return Ok(());
        }
        let plain = text.trim_end_matches(['\r', '\n']);
        let (letter, mut start) = (self.letter() as u8, 0);
        for (at, &byte) in plain.as_bytes().iter().enumerate() {
            match byte {
                b'\r' | b'"' if plain.contains('\r') => {
                    return Err("a carriage return stands within the line; end each line with a line feed".into());
                }
                // A CSV reader is costly to create for every line, and is only needed for quoted fields.
                b'"' => {
                    *fields = self.quoted_fields(text)?;
                    return Ok(());
                }
                _ if byte == letter => {
                    fields.push(trimmed(&plain[start..at]).into());
                    start = at + 1;
                }
                _ => {}
            }
        }
        fields.push(trimmed(&plain[start..]).into());
        Ok(())
    }

    fn quoted_fields(self, text: &str) -> Result<Vec<Cow<'_, str>>, Fault> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(self.letter() as u8)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut record = csv::StringRecord::new();
        reader.read_record(&mut record).map_err(|error| format!("not a well-formed table: {error}"))?;
        Ok(record.iter().map(|field| field.to_owned().into()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_fast_path_splits_lines_like_the_csv_reader(
            text in "[a0.,; \t\u{a0}\"]{0,12}[a0,;]\r?\n?",
            separator in prop_oneof![Just(Separator::Comma), Just(Separator::Semicolon)],
        ) {
            prop_assert_eq!(separator.fields(&text).unwrap(), separator.quoted_fields(&text).unwrap());
        }
    }
}
