//! The models that come with the program.

use crate::error::DdlError;
use std::fmt;
use std::str::FromStr;

/// A model that comes with the program, packed: goals are proposed, without an expert library.
///
/// The default is for use. The other five are those of the benchmark in the `star` convention, each named after the
/// ETH/UCY scene that it was trained without; `models/reported.json` of this crate holds its scores there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum BuiltinModel {
    /// Trained on all scenes of ETH/UCY and on five other places (`docs/elsewhere.md`).
    #[default]
    World,
    /// Trained without the scene `eth`.
    #[cfg(feature = "folds")]
    Eth,
    /// Trained without the scene `hotel`.
    #[cfg(feature = "folds")]
    Hotel,
    /// Trained without the scenes `univ`.
    #[cfg(feature = "folds")]
    Univ,
    /// Trained without the scene `zara1`.
    #[cfg(feature = "folds")]
    Zara1,
    /// Trained without the scene `zara2`.
    #[cfg(feature = "folds")]
    Zara2,
}

impl BuiltinModel {
    /// All of them.
    #[cfg(feature = "folds")]
    pub const ALL: [Self; 6] = [
        Self::World,
        Self::Eth,
        Self::Hotel,
        Self::Univ,
        Self::Zara1,
        Self::Zara2,
    ];
    /// All of them: the one for use.
    #[cfg(not(feature = "folds"))]
    pub const ALL: [Self; 1] = [Self::World];

    /// Those of the benchmark.
    #[cfg(feature = "folds")]
    pub const OF_FOLDS: [Self; 5] = [Self::Eth, Self::Hotel, Self::Univ, Self::Zara1, Self::Zara2];

    /// Its name: `world`, or the scene that it was trained without.
    #[must_use]
    pub fn name(self) -> &'static str {
        PACKED[self as usize].0
    }

    pub(crate) fn bytes(self) -> &'static [u8] {
        PACKED[self as usize].1
    }
}

/// The names and the packed models, in the order of the variants. A static, so that the program holds each model once.
static PACKED: [(&str, &[u8]); BuiltinModel::ALL.len()] = [
    ("world", include_bytes!("../../models/world.safetensors")),
    #[cfg(feature = "folds")]
    ("eth", include_bytes!("../../models/eth.safetensors")),
    #[cfg(feature = "folds")]
    ("hotel", include_bytes!("../../models/hotel.safetensors")),
    #[cfg(feature = "folds")]
    ("univ", include_bytes!("../../models/univ.safetensors")),
    #[cfg(feature = "folds")]
    ("zara1", include_bytes!("../../models/zara1.safetensors")),
    #[cfg(feature = "folds")]
    ("zara2", include_bytes!("../../models/zara2.safetensors")),
];

impl fmt::Display for BuiltinModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for BuiltinModel {
    type Err = DdlError;

    fn from_str(text: &str) -> Result<Self, DdlError> {
        let named = Self::ALL.into_iter().find(|model| model.name() == text);
        named.ok_or_else(|| DdlError::Model {
            model: text.to_owned(),
            problem: format!(
                "is not a built-in model; the built-in models are {}",
                Self::ALL.map(Self::name).join(", ")
            ),
        })
    }
}
