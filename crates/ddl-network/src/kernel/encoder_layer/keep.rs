//! Results of the forward pass that later tokens and the backward pass need.

use crate::kernel::among_pedestrians::Attended;
use crate::kernel::buffer::Buffer;
use crate::kernel::over_memory::{KeyValue, KeyValueMut};

pub(crate) struct Kept {
    pub(super) attention: KeptAttention,
    pub(super) normal1: KeptRows,
    pub(super) z: Buffer,
    pub(super) normal2: KeptRows,
}

pub(super) enum KeptAttention {
    Among {
        qkv: Buffer,
        attended: Attended,
    },
    Over {
        query: Buffer,
        own: Remembered,
        mixed: Buffer,
    },
}

impl KeptAttention {
    pub(super) fn mixed(&self) -> &[f32] {
        match self {
            Self::Among { attended, .. } => attended.mixed(),
            Self::Over { mixed, .. } => mixed,
        }
    }
}

/// Empty if there will be no backward pass.
#[derive(Default)]
pub(super) struct KeptRows {
    pub(super) numbers: Buffer,
    pub(super) scales: Buffer,
}

/// Keys and values of tokens, or their gradients: `[rows, width]` each.
#[derive(Debug)]
pub(crate) struct Remembered {
    pub(crate) key: Buffer,
    pub(crate) value: Buffer,
}

impl Remembered {
    pub(crate) fn zeros(count: usize) -> Self {
        Self {
            key: Buffer::zeros(count),
            value: Buffer::zeros(count),
        }
    }

    pub(super) fn view(&self) -> KeyValue<'_> {
        KeyValue {
            key: &self.key,
            value: &self.value,
        }
    }

    pub(super) fn view_mut(&mut self) -> KeyValueMut<'_> {
        KeyValueMut {
            key: &mut self.key,
            value: &mut self.value,
        }
    }
}
