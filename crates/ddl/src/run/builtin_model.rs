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
    Eth,
    /// Trained without the scene `hotel`.
    Hotel,
    /// Trained without the scenes `univ`.
    Univ,
    /// Trained without the scene `zara1`.
    Zara1,
    /// Trained without the scene `zara2`.
    Zara2,
}

impl BuiltinModel {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::World,
        Self::Eth,
        Self::Hotel,
        Self::Univ,
        Self::Zara1,
        Self::Zara2,
    ];

    /// Those of the benchmark.
    pub const OF_FOLDS: [Self; 5] = [Self::Eth, Self::Hotel, Self::Univ, Self::Zara1, Self::Zara2];

    /// Its name: `world`, or the scene that it was trained without.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::World => "world",
            Self::Eth => "eth",
            Self::Hotel => "hotel",
            Self::Univ => "univ",
            Self::Zara1 => "zara1",
            Self::Zara2 => "zara2",
        }
    }

    pub(crate) fn bytes(self) -> &'static [u8] {
        BYTES[self as usize]
    }
}

/// The packed models, in the order of the variants. A static, so that the program holds each model once.
static BYTES: [&[u8]; 6] = [
    include_bytes!("../../models/world.safetensors"),
    include_bytes!("../../models/eth.safetensors"),
    include_bytes!("../../models/hotel.safetensors"),
    include_bytes!("../../models/univ.safetensors"),
    include_bytes!("../../models/zara1.safetensors"),
    include_bytes!("../../models/zara2.safetensors"),
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
