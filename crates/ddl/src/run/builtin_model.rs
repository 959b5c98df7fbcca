//! The models that come with the program.

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

// The names of the benchmark's models are the scenes that they were trained without.
#[cfg(feature = "folds")]
ddl_core::named!(
    BuiltinModel, "built-in model",
    World => "world", Eth => "eth", Hotel => "hotel", Univ => "univ", Zara1 => "zara1", Zara2 => "zara2"
);
#[cfg(not(feature = "folds"))]
ddl_core::named!(BuiltinModel, "built-in model", World => "world");

impl BuiltinModel {
    /// Those of the benchmark.
    #[cfg(feature = "folds")]
    pub const OF_FOLDS: [Self; 5] = [Self::Eth, Self::Hotel, Self::Univ, Self::Zara1, Self::Zara2];

    pub(crate) fn bytes(self) -> &'static [u8] {
        PACKED[self as usize]
    }
}

/// The packed models, in the order of the variants. A static, so that the program holds each model once.
static PACKED: [&[u8]; BuiltinModel::ALL.len()] = [
    include_bytes!("../../models/world.safetensors"),
    #[cfg(feature = "folds")]
    include_bytes!("../../models/eth.safetensors"),
    #[cfg(feature = "folds")]
    include_bytes!("../../models/hotel.safetensors"),
    #[cfg(feature = "folds")]
    include_bytes!("../../models/univ.safetensors"),
    #[cfg(feature = "folds")]
    include_bytes!("../../models/zara1.safetensors"),
    #[cfg(feature = "folds")]
    include_bytes!("../../models/zara2.safetensors"),
];
