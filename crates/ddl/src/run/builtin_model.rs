//! The models that come with the program.

use crate::error::DdlError;
use std::fmt;
use std::str::FromStr;

/// A model that comes with the program, named after the ETH/UCY scene that it was trained without.
///
/// The five are the models of the benchmark in the `star` convention, packed: goals are proposed, without an expert
/// library. `models/reported.json` of this crate holds the scores of each on its unseen scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum BuiltinModel {
    /// Trained without the scene `eth`.
    Eth,
    /// Trained without the scene `hotel`, the smallest. This model has seen the most pedestrians and is the choice for
    /// new places.
    #[default]
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
    pub const ALL: [Self; 5] = [Self::Eth, Self::Hotel, Self::Univ, Self::Zara1, Self::Zara2];

    /// The scene that it was trained without.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
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
static BYTES: [&[u8]; 5] = [
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
