//! Names of the scenes in a stream of several scenes.

use std::fmt;
use std::sync::Arc;

use serde::{Serialize, Serializer};
use thiserror::Error;

/// A text cannot name a scene.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum SceneNameError {
    #[error("scene is empty; name the camera that each row is from")]
    Empty,
    #[error("scene has {found} bytes, and {} are allowed; give the camera a shorter name", SceneName::LONGEST)]
    TooLong { found: usize },
    #[error("scene must not hold control characters, found {found:?}; leave them out")]
    Control { found: String },
}

/// The name of a scene, that is of a camera, in a stream of several.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SceneName(Arc<str>);

impl SceneName {
    /// Largest length of a name in bytes. A file can be named after a scene, even if every byte is escaped.
    const LONGEST: usize = 64;

    /// A name of 1 to 64 bytes without control characters; blanks around it are removed.
    ///
    /// # Errors
    /// For any other text.
    pub fn new(text: &str) -> Result<Self, SceneNameError> {
        let text = text.trim();
        match text.len() {
            0 => Err(SceneNameError::Empty),
            found if found > Self::LONGEST => Err(SceneNameError::TooLong { found }),
            _ if text.chars().any(char::is_control) => Err(SceneNameError::Control { found: text.to_owned() }),
            _ => Ok(Self(text.into())),
        }
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for SceneName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

impl Serialize for SceneName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_name_is_itself_again(text in "\\PC{0,80}") {
            if let Ok(name) = SceneName::new(&text) {
                prop_assert_eq!(name.as_str(), text.trim());
                prop_assert_eq!(SceneName::new(name.as_str()).unwrap(), name);
            }
        }
    }
}
