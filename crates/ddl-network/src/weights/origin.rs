//! The origin of a checkpoint. It detects a file that does not belong to the configuration beside it.

use std::collections::{BTreeMap, HashMap};

/// Named settings that determine the numbers of a checkpoint: configuration, seed, data.
///
/// They are written into the header of the file. A file of another origin is refused, even if all shapes fit.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Origin(BTreeMap<String, String>);

impl<N: Into<String>, V: Into<String>> FromIterator<(N, V)> for Origin {
    fn from_iter<I: IntoIterator<Item = (N, V)>>(facts: I) -> Self {
        let facts = facts.into_iter();
        Self(facts.map(|(name, value)| (name.into(), value.into())).collect())
    }
}

impl Origin {
    /// Describes the first setting, in the order of the names, in which this origin differs from `other`. `None` if
    /// they are equal.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let name = self.0.keys().chain(other.0.keys()).filter(|&name| self.0.get(name) != other.0.get(name)).min()?;
        let in_words = |origin: &Self| origin.0.get(name).map_or_else(|| "missing".to_owned(), String::clone);
        Some(format!("{name} is {}, not {}", in_words(self), in_words(other)))
    }

    /// The header of a safetensors file: one entry with the origin and the SHA-256 of the file's numbers.
    pub fn to_header(&self, digest: &str) -> HashMap<String, String> {
        let facts = self.0.iter().map(|(name, value)| (name.as_str(), value.as_str())).chain([(DIGEST, digest)]);
        let facts = facts.map(|(name, value)| (name.to_owned(), value.into()));
        let facts = serde_json::Value::Object(facts.collect());
        HashMap::from([(HEADER.to_owned(), facts.to_string())])
    }

    /// The origin in the header of a safetensors file, empty if another program wrote the file; and the SHA-256 of its
    /// numbers, if the header has it.
    pub fn from_header(header: Option<&HashMap<String, String>>) -> (Self, Option<String>) {
        let facts = header.and_then(|header| header.get(HEADER));
        let mut origin = Self(facts.and_then(|facts| serde_json::from_str(facts).ok()).unwrap_or_default());
        let digest = origin.0.remove(DIGEST);
        (origin, digest)
    }
}

/// Name of the entry in the header.
const HEADER: &str = "origin";
/// Name of the SHA-256 of the file's numbers in this entry.
const DIGEST: &str = "numbers.sha256";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_is_read_back_from_its_header() {
        let origin = Origin::from_iter([("fold", "eth"), ("seed", "1")]);
        let header = origin.to_header("ab12");
        let digest = Some("ab12".to_owned());
        assert_eq!(Origin::from_header(Some(&header)), (origin, digest));
        let empty = (Origin::default(), None);
        assert_eq!(Origin::from_header(None), empty);
        let foreign = HashMap::from([(HEADER.to_owned(), "[1".to_owned())]);
        assert_eq!(Origin::from_header(Some(&foreign)), empty);
        // A file of a version without a digest.
        let old = HashMap::from([(HEADER.to_owned(), r#"{"fold":"eth"}"#.to_owned())]);
        let eth = Origin::from_iter([("fold", "eth")]);
        assert_eq!(Origin::from_header(Some(&old)), (eth, None));
    }
}
