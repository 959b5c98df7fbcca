//! Names of enum values on the command line, in files and in reports.

use thiserror::Error;

/// A word outside a fixed set, with the words allowed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{found:?} is not a known {kind}; choose one of {expected}")]
pub struct UnknownName {
    /// What the word should name, such as `data convention`.
    pub kind: &'static str,
    /// The word found.
    pub found: String,
    /// The words allowed.
    pub expected: &'static str,
}

/// Implements `ALL`, `name`, `Display` and `FromStr`, with the error [`UnknownName`], for an enum without fields.
///
/// ```
/// #[derive(Clone, Copy)]
/// enum Side {
///     Left,
///     Right,
/// }
/// ddl_core::named!(Side, "side of the road", Left => "left", Right => "right");
///
/// assert_eq!(Side::ALL.map(Side::name), ["left", "right"]);
/// let error = "middle".parse::<Side>().err().unwrap();
/// assert_eq!(error.to_string(), "\"middle\" is not a known side of the road; choose one of left, right");
/// ```
#[macro_export]
macro_rules! named {
    ($type:ident, $kind:literal, $first:ident => $first_name:literal $(, $value:ident => $name:literal)* $(,)?) => {
        impl $type {
            /// All of them, in the order of tables and messages.
            pub const ALL: [Self; [$first_name $(, $name)*].len()] = [Self::$first $(, Self::$value)*];

            /// The name on the command line, in files and in reports.
            pub const fn name(self) -> &'static str {
                match self {
                    Self::$first => $first_name,
                    $(Self::$value => $name,)*
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::UnknownName;

            fn from_str(word: &str) -> Result<Self, Self::Err> {
                Self::ALL.into_iter().find(|one| one.name() == word).ok_or_else(|| $crate::UnknownName {
                    kind: $kind,
                    found: word.to_owned(),
                    expected: concat!($first_name $(, ", ", $name)*),
                })
            }
        }
    };
}
