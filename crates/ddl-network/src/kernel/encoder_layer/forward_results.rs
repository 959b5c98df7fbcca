//! Results of the forward pass that later tokens and the backward pass need.

use crate::kernel::buffer::Buffer;
use crate::kernel::spatial_attention::Attended;
use crate::kernel::temporal_attention::KeyValue;

pub(crate) struct ForwardResults {
    pub(super) attention: AttentionResults,
    pub(super) normal1: NormalisedRows,
    pub(super) z: Buffer,
    pub(super) normal2: NormalisedRows,
}

pub(super) struct AttentionResults {
    pub(super) query: Buffer,
    pub(super) newest: CachedKeyValues,
    pub(super) attended: Attended,
}

/// Empty if there will be no backward pass.
#[derive(Default)]
pub(super) struct NormalisedRows {
    pub(super) numbers: Buffer,
    pub(super) scales: Buffer,
}

/// Keys and values of tokens, or their gradients: `[rows, width]` each.
pub(crate) type CachedKeyValues = KeyValue<Buffer>;

impl CachedKeyValues {
    pub(crate) fn zeros(count: usize) -> Self {
        Self { key: Buffer::zeros(count), value: Buffer::zeros(count) }
    }

    pub(super) fn view(&self) -> KeyValue<&[f32]> {
        let Self { key, value } = self;
        KeyValue { key, value }
    }

    pub(super) fn view_mut(&mut self) -> KeyValue<&mut [f32]> {
        let Self { key, value } = self;
        KeyValue { key, value }
    }
}
