//! Keys and values of earlier tokens: what later queries need of them.

use std::cell::RefCell;
use std::rc::Rc;

use tch::Tensor;

use crate::kernel::Remembered;

/// Key and value of one token a walker.
#[derive(Debug)]
pub(crate) enum KeyValue {
    /// For libtorch: query, key and value side by side, `[B, P, 3 * width]`; the query is not used.
    Projected(Tensor),
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
        match self {
            Self::Projected(projected) => Self::Projected(projected.expand([batch, -1, -1], false)),
            // The kernels take fewer rows for repetitions.
            Self::Rows(rows) => Self::Rows(Rc::clone(rows)),
        }
    }

    /// As libtorch wants it, where it is that.
    pub(crate) fn projected(&self) -> Option<&Tensor> {
        match self {
            Self::Projected(projected) => Some(projected),
            Self::Rows(_) => None,
        }
    }

    /// As rows, where it is that.
    pub(crate) fn rows(&self) -> Option<Rc<RememberedRows>> {
        match self {
            Self::Projected(_) => None,
            Self::Rows(rows) => Some(Rc::clone(rows)),
        }
    }
}
