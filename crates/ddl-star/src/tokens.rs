//! Tokens on their way through the network: in tensors of libtorch, or in the rows of our own kernels.

use std::cell::RefCell;
use std::ops::Deref;
use std::rc::Rc;

use tch::Tensor;

use crate::kernel::Buffer;
use crate::numbers::{numbers, tensor};
use crate::pass::Pass;

/// `[B, P, width]`, with libtorch's shape conventions in either form.
#[derive(Debug)]
pub(crate) enum Tokens {
    /// For libtorch.
    Tensor(Tensor),
    /// For the kernels.
    Rows(Rc<Rows>),
}

/// Numbers `[B, P, width]`, and what has come back to them so far.
#[derive(Debug)]
pub(crate) struct Rows {
    shape: [usize; 3],
    numbers: Buffer,
    gradient: RefCell<Option<Buffer>>,
}

impl Deref for Rows {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.numbers
    }
}

impl Rows {
    pub(crate) fn new(shape: [usize; 3], numbers: Buffer) -> Self {
        assert_eq!(
            numbers.len(),
            shape.iter().product::<usize>(),
            "numbers of {shape:?}"
        );
        Self {
            shape,
            numbers,
            gradient: RefCell::new(None),
        }
    }

    /// B, P and the width.
    pub(crate) fn shape(&self) -> [usize; 3] {
        self.shape
    }

    pub(crate) fn add_gradient(&self, terms: Buffer) {
        let mut gradient = self.gradient.borrow_mut();
        match &mut *gradient {
            Some(sums) => add(sums, &terms),
            None => *gradient = Some(terms),
        }
    }

    /// Adds to the gradient of what starts at the number `first`.
    fn add_gradient_at(&self, first: usize, terms: &[f32]) {
        let mut gradient = self.gradient.borrow_mut();
        let sums = gradient.get_or_insert_with(|| Buffer::zeros(self.numbers.len()));
        add(&mut sums[first..], terms);
    }

    pub(crate) fn take_gradient(&self) -> Option<Buffer> {
        self.gradient.take()
    }
}

fn add(sums: &mut [f32], terms: &[f32]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += term;
    }
}

impl Tokens {
    /// Numbers that the network is given, which nobody asks the gradient of.
    pub(crate) fn of(given: &Tensor, pass: &Pass) -> Self {
        let shape = given.size();
        match shape[..] {
            [b, p, width] if pass.has_kernels() => {
                let shape = [b, p, width].map(|count| count as usize);
                Self::Rows(Rc::new(Rows::new(shape, numbers(given))))
            }
            _ => Self::Tensor(given.shallow_clone()),
        }
    }

    /// All numbers, row by row.
    pub(crate) fn numbers(&self) -> Buffer {
        match self {
            Self::Tensor(x) => numbers(x),
            Self::Rows(x) => Buffer::copy(x),
        }
    }

    /// B, whose entries [`entry`](Self::entry) gives.
    pub(crate) fn entries(&self) -> usize {
        match self {
            Self::Tensor(x) => x.size()[0] as usize,
            Self::Rows(x) => x.shape[0],
        }
    }

    /// One batch entry, `[1, P, width]`.
    pub(crate) fn entry(&self, entry: usize, pass: &Pass) -> Self {
        let x = match self {
            Self::Tensor(x) => return Self::Tensor(x.narrow(0, entry as i64, 1)),
            Self::Rows(x) => Rc::clone(x),
        };
        let [_, walkers, width] = x.shape;
        let first = entry * walkers * width;
        let numbers = Buffer::copy(&x[first..][..walkers * width]);
        Self::Rows(pass.made([1, walkers, width], numbers, move |gradient, _| {
            x.add_gradient_at(first, gradient);
        }))
    }

    /// All batch entries, `[1, P, width]` each.
    pub(crate) fn each_entry(&self, pass: &Pass) -> Vec<Self> {
        match self {
            // All at once: the gradients of single ones would each be filled up to the whole and added.
            Self::Tensor(x) => x.split(1, 0).into_iter().map(Self::Tensor).collect(),
            Self::Rows(_) => {
                let entries = 0..self.entries();
                entries.map(|entry| self.entry(entry, pass)).collect()
            }
        }
    }

    /// A single batch entry `batch` times.
    pub(crate) fn repeated(&self, batch: usize, pass: &Pass) -> Self {
        let x = match self {
            _ if self.entries() == batch => return self.shared(),
            Self::Tensor(x) => return Self::Tensor(x.expand([batch as i64, -1, -1], false)),
            Self::Rows(x) => Rc::clone(x),
        };
        let [_, walkers, width] = x.shape;
        let mut numbers = Buffer::any(batch * x.len());
        for entry in numbers.chunks_exact_mut(x.len()) {
            entry.copy_from_slice(&x);
        }
        Self::Rows(
            pass.made([batch, walkers, width], numbers, move |gradient, _| {
                for gradient in gradient.chunks_exact(x.len()) {
                    x.add_gradient_at(0, gradient);
                }
            }),
        )
    }

    /// max(0, x), entry by entry; what is no number stays none.
    pub(crate) fn relu(&self, pass: &Pass) -> Self {
        let x = match self {
            Self::Tensor(x) => return Self::Tensor(x.relu()),
            Self::Rows(x) => Rc::clone(x),
        };
        let mut numbers = Buffer::any(x.len());
        for (y, x) in numbers.iter_mut().zip(x.iter()) {
            *y = if *x < 0.0 { 0.0 } else { *x };
        }
        Self::Rows(pass.made(x.shape, numbers, move |gradient, _| {
            let mut of_x = Buffer::any(x.len());
            for ((of_x, x), gradient) in of_x.iter_mut().zip(x.iter()).zip(gradient) {
                *of_x = if *x <= 0.0 { 0.0 } else { *gradient };
            }
            x.add_gradient(of_x);
        }))
    }

    /// Both side by side, `[B, P, width + width of other]`.
    pub(crate) fn beside(&self, other: &Self, pass: &Pass) -> Self {
        let (a, b) = match (self, other) {
            (Self::Rows(a), Self::Rows(b)) => (Rc::clone(a), Rc::clone(b)),
            (a, b) => return Self::Tensor(Tensor::cat(&[a.tensor(), b.tensor()], -1)),
        };
        let [batch, walkers, width] = a.shape;
        let both = width + b.shape[2];
        assert_eq!(b.shape[..2], [batch, walkers], "rows side by side");
        let mut numbers = Buffer::any(batch * walkers * both);
        let rows = a.chunks_exact(width).zip(b.chunks_exact(both - width));
        for (row, (a, b)) in numbers.chunks_exact_mut(both).zip(rows) {
            row[..width].copy_from_slice(a);
            row[width..].copy_from_slice(b);
        }
        Self::Rows(
            pass.made([batch, walkers, both], numbers, move |gradient, _| {
                for (rows, columns) in [(&a, 0..width), (&b, width..both)] {
                    let mut part = Buffer::any(rows.len());
                    let parts = part.chunks_exact_mut(columns.len());
                    for (part, gradient) in parts.zip(gradient.chunks_exact(both)) {
                        part.copy_from_slice(&gradient[columns.clone()]);
                    }
                    rows.add_gradient(part);
                }
            }),
        )
    }

    /// The same tokens.
    pub(crate) fn shared(&self) -> Self {
        match self {
            Self::Tensor(x) => Self::Tensor(x.shallow_clone()),
            Self::Rows(x) => Self::Rows(Rc::clone(x)),
        }
    }

    /// As a tensor, without the way back.
    fn tensor(&self) -> Tensor {
        match self {
            Self::Tensor(x) => x.shallow_clone(),
            Self::Rows(x) => tensor(x, &x.shape.map(|count| count as i64)),
        }
    }

    /// All batch entries of all tokens, for libtorch, which goes on from there.
    pub(crate) fn joined(all: &[Self], pass: &Pass) -> Tensor {
        let joined = match all {
            [one] => one.tensor(),
            all => Tensor::cat(&all.iter().map(Self::tensor).collect::<Vec<_>>(), 0),
        };
        if !pass.is_taped() {
            return joined;
        }
        let leaf = joined.set_requires_grad(true);
        let joined = leaf.shallow_clone();
        let all: Vec<Self> = all.iter().map(Self::shared).collect();
        pass.on_the_way_back(move |_| {
            let gradient = leaf.grad();
            if !gradient.defined() {
                return;
            }
            let gradient = numbers(&gradient);
            let mut rest = &gradient[..];
            for tokens in &all {
                if let Self::Rows(rows) = tokens {
                    let part = rest.split_off(..rows.len()).unwrap_or_default();
                    rows.add_gradient(Buffer::copy(part));
                }
            }
        });
        joined
    }
}
