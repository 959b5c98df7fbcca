//! Keys and values of earlier tokens: what later queries need of them.

use std::cell::RefCell;
use std::rc::Rc;

use tch::{TchError, Tensor};

use crate::kernel;
use crate::numbers::{numbers, tensor};
use crate::pass::Pass;

/// Key and value of one token a walker.
#[derive(Debug)]
pub(crate) enum KeyValue {
    /// For libtorch: query, key and value side by side, `[B, P, 3 * width]`; the query is not used.
    Projected(Tensor),
    /// For the kernels.
    Plain(Rc<Plain>),
}

/// Keys and values as numbers, `[B, P, width]` each, and what has come back to them so far.
#[derive(Debug)]
pub(crate) struct Plain {
    key: Vec<f32>,
    value: Vec<f32>,
    /// Gradients of key and value; none until the first query has given its share.
    gradient: RefCell<Option<[Vec<f32>; 2]>>,
}

impl KeyValue {
    /// What the kernels remember of tokens whose keys and values stand side by side.
    ///
    /// # Shapes
    /// `key_value` `[B, P, 2 * width]`.
    pub(crate) fn of(key_value: &Tensor, pass: &Pass) -> Self {
        let shape = key_value.size();
        let [key, value] = columns(&numbers(key_value), shape[2] as usize / 2);
        let plain = Rc::new(Plain {
            key,
            value,
            gradient: RefCell::new(None),
        });
        let remembered = Rc::clone(&plain);
        pass.joined(key_value, move || {
            let gradient = remembered.gradient.take()?;
            Some(tensor(
                &side_by_side(&gradient, shape[2] as usize / 2),
                &shape,
            ))
        });
        Self::Plain(plain)
    }

    /// Repeats a single batch entry `batch` times, without copying.
    pub(crate) fn expand_batch(&self, batch: i64) -> Self {
        match self {
            Self::Projected(projected) => Self::Projected(projected.expand([batch, -1, -1], false)),
            // The kernels take fewer rows for repetitions.
            Self::Plain(plain) => Self::Plain(Rc::clone(plain)),
        }
    }

    /// As libtorch wants it, where it is that.
    pub(crate) fn projected(&self) -> Option<&Tensor> {
        match self {
            Self::Projected(projected) => Some(projected),
            Self::Plain(_) => None,
        }
    }

    /// As plain numbers, where it is that.
    pub(crate) fn plain(&self) -> Option<Rc<Plain>> {
        match self {
            Self::Projected(_) => None,
            Self::Plain(plain) => Some(Rc::clone(plain)),
        }
    }
}

/// Attention of the newest tokens over the remembered ones and themselves, by the kernel.
///
/// # Shapes
/// `qkv` `[B, P, 3 * width]` -> `[B, P, width]`.
pub(crate) fn over_memory(qkv: &Tensor, memory: Vec<Rc<Plain>>, heads: i64, pass: &Pass) -> Tensor {
    let shape = qkv.size();
    let width = shape[2] as usize / 3;
    let attention = kernel::OverMemory::new(heads as usize, width / heads as usize);
    let [query, key, value] = columns(&numbers(qkv), width);
    let mut mixed = vec![0.0; query.len()];
    attention.forward(&query, &views(&memory), view(&key, &value), &mut mixed);
    let output = tensor(&mixed, &[shape[0], shape[1], width as i64]);
    pass.made_of(&[qkv], output, move |gradient| -> Result<_, TchError> {
        let mut own = [0, 1, 2].map(|_| vec![0.0; query.len()]);
        let mut shares: Vec<_> = memory
            .iter()
            .map(|token| token.gradient.borrow_mut())
            .collect();
        let mut of_memory: Vec<kernel::KeyValueMut<'_>> = shares
            .iter_mut()
            .map(|share| {
                let zeros = || [0, 1].map(|_| vec![0.0; query.len()]);
                let [key, value] = share.get_or_insert_with(zeros);
                kernel::KeyValueMut { key, value }
            })
            .collect();
        let [of_query, of_key, of_value] = &mut own;
        let gradients = kernel::OverMemoryGradients {
            query: of_query,
            memory: &mut of_memory,
            own: kernel::KeyValueMut {
                key: of_key,
                value: of_value,
            },
        };
        let own_token = view(&key, &value);
        attention.backward(
            &query,
            &views(&memory),
            own_token,
            &numbers(gradient),
            gradients,
        );
        Ok(vec![tensor(&side_by_side(&own, width), &shape)])
    })
}

fn view<'a>(key: &'a [f32], value: &'a [f32]) -> kernel::KeyValue<'a> {
    kernel::KeyValue { key, value }
}

fn views(memory: &[Rc<Plain>]) -> Vec<kernel::KeyValue<'_>> {
    memory
        .iter()
        .map(|token| view(&token.key, &token.value))
        .collect()
}

/// The columns of `width` of a matrix of N times that many, each as a matrix of its own.
fn columns<const N: usize>(numbers: &[f32], width: usize) -> [Vec<f32>; N] {
    std::array::from_fn(|column| {
        let rows = numbers.chunks_exact(N * width);
        rows.flat_map(|row| &row[column * width..][..width])
            .copied()
            .collect()
    })
}

/// Undoes [`columns`].
fn side_by_side<const N: usize>(parts: &[Vec<f32>; N], width: usize) -> Vec<f32> {
    let mut numbers = Vec::with_capacity(N * parts[0].len());
    for row in 0..parts[0].len() / width {
        for part in parts {
            numbers.extend_from_slice(&part[row * width..][..width]);
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_taken_apart_and_put_together() {
        let numbers: Vec<f32> = (0..24_u8).map(f32::from).collect();
        let parts: [Vec<f32>; 3] = columns(&numbers, 2);
        assert_eq!(parts[1], [2.0, 3.0, 8.0, 9.0, 14.0, 15.0, 20.0, 21.0]);
        assert_eq!(side_by_side(&parts, 2), numbers);
    }
}
