//! Keys and values of tokens, and their gradients.

/// Keys and values of one token a row, `[rows, heads, head width]` each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeyValue<'a> {
    /// What queries are compared with.
    pub(crate) key: &'a [f32],
    /// What is mixed.
    pub(crate) value: &'a [f32],
}

/// Gradients of a [`KeyValue`], of the same shapes.
#[derive(Debug)]
pub(crate) struct KeyValueMut<'a> {
    /// Of the keys.
    pub(crate) key: &'a mut [f32],
    /// Of the values.
    pub(crate) value: &'a mut [f32],
}

impl KeyValueMut<'_> {
    /// The same, for a shorter time.
    pub(super) fn reborrow(&mut self) -> KeyValueMut<'_> {
        KeyValueMut {
            key: self.key,
            value: self.value,
        }
    }
}

impl<'a> KeyValueMut<'a> {
    /// Takes `count` numbers each off the front.
    pub(super) fn split_off(&mut self, count: usize) -> KeyValueMut<'a> {
        KeyValueMut {
            key: self.key.split_off_mut(..count).unwrap_or_default(),
            value: self.value.split_off_mut(..count).unwrap_or_default(),
        }
    }
}
