//! What a checkpoint is of, so that a file that lies beside the wrong configuration is noticed.

use std::collections::{BTreeMap, HashMap};

/// The facts that decide the numbers of a checkpoint, by name: configuration, seed, data.
///
/// They are written into the header of the file. A file of another origin is refused, also where all its
/// shapes would fit: weights of another fold, seed or variant would give forecasts that look right.
///
/// # Examples
/// ```
/// use ddl_star::Origin;
///
/// let eth = Origin::from_iter([("fold", "eth"), ("seed", "1")]);
/// let zara = Origin::from_iter([("fold", "zara1"), ("seed", "1")]);
/// assert_eq!(eth.difference(&eth), None);
/// assert_eq!(eth.difference(&zara).unwrap(), "fold is eth, not zara1");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Origin(BTreeMap<String, String>);

impl<N: Into<String>, V: Into<String>> FromIterator<(N, V)> for Origin {
    fn from_iter<I: IntoIterator<Item = (N, V)>>(facts: I) -> Self {
        let facts = facts.into_iter();
        Self(
            facts
                .map(|(name, value)| (name.into(), value.into()))
                .collect(),
        )
    }
}

impl Origin {
    /// The first fact, by name, in which this origin is not `other`, in words; `None` when they agree.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Option<String> {
        let names = self.0.keys().chain(other.0.keys());
        let name = names
            .filter(|&name| self.0.get(name) != other.0.get(name))
            .min()?;
        let in_words = |origin: &Self| {
            let value = origin.0.get(name);
            value.map_or_else(|| "nothing".to_owned(), String::clone)
        };
        Some(format!(
            "{name} is {}, not {}",
            in_words(self),
            in_words(other)
        ))
    }

    /// As the header of a safetensors file holds it: one entry, so that the same origin is always the same bytes.
    #[must_use]
    pub fn to_header(&self) -> HashMap<String, String> {
        let facts = self
            .0
            .iter()
            .map(|(name, value)| (name.clone(), value.clone().into()));
        let facts = serde_json::Value::Object(facts.collect());
        HashMap::from([(HEADER.to_owned(), facts.to_string())])
    }

    /// What the header of a safetensors file says; nothing, when it is not a header of ours.
    #[must_use]
    pub fn of_header(header: Option<&HashMap<String, String>>) -> Self {
        let facts = header.and_then(|header| header.get(HEADER));
        Self(
            facts
                .and_then(|facts| serde_json::from_str(facts).ok())
                .unwrap_or_default(),
        )
    }
}

/// Name of the header's entry.
const HEADER: &str = "origin";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_difference_is_told_from_either_side() {
        let one = Origin::from_iter([("b", "1"), ("c", "2")]);
        let other = Origin::from_iter([("a", "0"), ("b", "1"), ("c", "3")]);
        assert_eq!(one.difference(&other).unwrap(), "a is nothing, not 0");
        assert_eq!(other.difference(&one).unwrap(), "a is 0, not nothing");
        assert_eq!(one.difference(&one), None);
    }

    #[test]
    fn a_header_brings_it_back() {
        let origin = Origin::from_iter([("fold", "eth"), ("seed", "1")]);
        let header = origin.to_header();
        assert_eq!(Origin::of_header(Some(&header)), origin);
        assert_eq!(Origin::of_header(None), Origin::default());
        let foreign = HashMap::from([(HEADER.to_owned(), "[1".to_owned())]);
        assert_eq!(Origin::of_header(Some(&foreign)), Origin::default());
    }
}
