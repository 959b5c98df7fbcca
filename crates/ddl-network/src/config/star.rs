//! Sizes and constants of the forecasting network.

use crate::NetworkError;
use crate::config::range::{positive, require};
use crate::config::variant::{BackboneKind, Variant};
use crate::kernel::HEAD_WIDTH;
use serde::{Deserialize, Serialize};

/// The coordinate frame of the network's input and output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NetworkFrame {
    /// The frame of the recording, as published.
    World,
    /// The pedestrian's own frame: its first axis points from the last observed position to the goal. The network then
    /// reads velocities as well as positions, and the output layer reads both in addition to the token.
    Goal,
}

/// Sizes and constants of the network. [`StarConfig::published`] gives those of the paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StarConfig {
    /// The network behind the shared rollout.
    #[serde(default, skip_serializing_if = "is_star")]
    pub backbone: BackboneKind,
    /// The variant of the ablation: use of the goal, and meaning of the output.
    pub variant: Variant,
    /// The coordinate frame of the network's input and output.
    pub frame: NetworkFrame,
    /// Width of a token.
    pub model_width: i64,
    /// Attention heads, a quarter of the width.
    pub heads: i64,
    /// Width of the hidden layer of each feed-forward block.
    pub feed_forward_width: i64,
    /// Number of layers in each of the two spatial encoders.
    pub spatial_layers: usize,
    /// Length of the Gaussian noise vector given to the output layer.
    pub noise_width: i64,
    /// Dropout of the spatial encoders (the temporal ones have none).
    pub spatial_dropout: f64,
    /// Half side of the square within which pedestrians are neighbours, in metres.
    pub neighbour_box: f64,
    /// sigma of P = L L^T + sigma I (eq. 11).
    pub sigma: f64,
    /// Seconds between two frames.
    pub time_step: f64,
}

/// The backbone STAR is not written, because configurations of earlier versions have no field `backbone`.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_star(backbone: &BackboneKind) -> bool {
    *backbone == BackboneKind::Star
}

/// This limit prevents a damaged file from requesting all memory of the machine.
const MOST_LAYER_NUMBERS: i64 = 1 << 24;

impl StarConfig {
    /// The name of the network in reports: its variant, and its backbone if that is not STAR.
    pub fn name(&self) -> String {
        match (self.variant, self.backbone) {
            (variant, BackboneKind::Star) => variant.name().to_owned(),
            (Variant::Full, backbone) => backbone.name().to_owned(),
            (variant, backbone) => format!("{variant}, {backbone}"),
        }
    }

    fn layer_numbers(&self) -> i64 {
        self.model_width * (4 * self.model_width + 2 * self.feed_forward_width)
    }

    /// Number of weights in the largest layers: a lower bound for the whole network. A file with fewer weights is
    /// refused before memory for the network is allocated.
    ///
    /// # Panics
    /// On overflow, which [`check`](Self::check) excludes.
    pub fn min_weight_count(&self) -> u64 {
        match self.backbone {
            BackboneKind::Star => 2 * self.spatial_layers as u64 * self.layer_numbers() as u64,
            BackboneKind::Perceptron => (self.feed_forward_width * self.model_width) as u64,
        }
    }

    /// The network with the sizes and constants of the paper.
    pub fn published(variant: Variant) -> Self {
        Self {
            backbone: BackboneKind::Star,
            variant,
            frame: NetworkFrame::World,
            model_width: 32,
            heads: 8,
            feed_forward_width: 2048,
            spatial_layers: 2,
            noise_width: 16,
            spatial_dropout: 0.1,
            neighbour_box: 10.0,
            sigma: ddl_dynamics::PUBLISHED_SIGMA,
            time_step: ddl_core::TIME_STEP,
        }
    }

    /// The default: the pedestrian's own frame if the variant has goals (`docs/tried.md`), and the smallest sizes that
    /// lose no accuracy (`docs/performance.md`).
    pub fn recommended(variant: Variant) -> Self {
        Self {
            frame: if variant.goal_shift() { NetworkFrame::Goal } else { NetworkFrame::World },
            feed_forward_width: 32,
            spatial_layers: 1,
            ..Self::published(variant)
        }
    }

    /// Inputs of the temporal encoders for each pedestrian and time step: the position, and in its own frame the
    /// velocity.
    pub fn temporal_inputs(&self) -> i64 {
        match self.frame {
            NetworkFrame::World => 2,
            NetworkFrame::Goal => 4,
        }
    }

    /// Inputs of the output layer for each pedestrian and time step, without the noise: the token, and in the
    /// pedestrian's own frame also position and velocity.
    pub fn output_inputs(&self) -> i64 {
        match self.frame {
            NetworkFrame::World => self.model_width,
            NetworkFrame::Goal => self.model_width + self.temporal_inputs(),
        }
    }

    /// Outputs for each pedestrian and time step: (a, b, c) of the Cholesky factor, or (x, y).
    pub(crate) fn output_width(&self) -> i64 {
        if self.variant.dynamics() { 3 } else { 2 }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub fn check(&self) -> Result<(), NetworkError> {
        // The kernels have room for 256 heads.
        for (field, value, most, rule) in [
            ("model_width", self.model_width, 65_536, "1 to 65536"),
            ("heads", self.heads, 256, "1 to 256"),
            ("feed_forward_width", self.feed_forward_width, 65_536, "1 to 65536"),
            ("spatial_layers", self.spatial_layers as i64, 64, "1 to 64"),
            ("noise_width", self.noise_width, 65_536, "1 to 65536"),
        ] {
            require((1..=most).contains(&value), field, &value, rule)?;
        }
        require(
            self.layer_numbers() <= MOST_LAYER_NUMBERS,
            "feed_forward_width",
            &self.feed_forward_width,
            "a layer may have at most 2^24 weights",
        )?;
        let fits = self.model_width == self.heads * HEAD_WIDTH as i64;
        require(fits, "heads", &self.heads, "a quarter of model_width")?;
        require(
            self.frame == NetworkFrame::World || self.variant.goal_shift(),
            "frame",
            &"goal",
            "world for the variants without goal shift",
        )?;
        let dropout = self.spatial_dropout;
        let holds = (0.0..1.0).contains(&dropout);
        require(holds, "spatial_dropout", &dropout, "in [0, 1)")?;
        positive("neighbour_box", self.neighbour_box)?;
        positive("sigma", self.sigma)?;
        positive("time_step", self.time_step)
    }
}
