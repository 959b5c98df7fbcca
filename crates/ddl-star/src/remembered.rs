//! Keys and values of earlier tokens: what later queries need of them.

use std::cell::RefCell;
use std::rc::Rc;

use tch::Tensor;

use crate::kernel::Remembered;

/// Key and value of one token a walker.
#[derive(Debug)]
pub(crate) enum KeyValue {
    /// For libtorch, both `[B, P, heads, width / heads]`.
    Tensors {
        /// What queries are compared with.
        key: Tensor,
        /// What is mixed.
        value: Tensor,
    },
    /// For the kernels.
    Rows(Rc<RememberedRows>),
}

/// Keys and values as numbers, `[B, P, width]` each, and what has come back to them so far.
#[derive(Debug)]
pub(crate) struct RememberedRows {
    pub(crate) rows: Remembered,
    /// None until the first query has given its share.
    pub(crate) gradient: RefCell<Option<Remembered>>,
}

impl KeyValue {
    /// Repeats a single batch entry `batch` times, without copying.
    pub(crate) fn expand_batch(&self, batch: i64) -> Self {
        let expand = |tensor: &Tensor| tensor.expand([batch, -1, -1, -1], false);
        match self {
            Self::Tensors { key, value } => Self::Tensors {
                key: expand(key),
                value: expand(value),
            },
            // The kernels take fewer rows for repetitions.
            Self::Rows(rows) => Self::Rows(Rc::clone(rows)),
        }
    }

    /// As rows, where it is that.
    pub(crate) fn rows(&self) -> Option<Rc<RememberedRows>> {
        match self {
            Self::Tensors { .. } => None,
            Self::Rows(rows) => Some(Rc::clone(rows)),
        }
    }
}
