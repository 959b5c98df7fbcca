//! Operators for sixteen numbers at a time, so that a formula in a kernel reads like one of scalars.

#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use ddl_simd::{Floats, LANES, Simd};
use std::ops::{Add, Div, Mul, Sub};

/// Sixteen numbers. Every operation is rounded once, as that of an `f32`.
#[derive(Clone, Copy)]
pub(super) struct Numbers<S: Simd> {
    simd: S,
    lanes: Floats<S>,
}

macro_rules! operations {
    ($($operator:ident $name:ident;)* | $($method:ident)*) => {
        $(
            impl<S: Simd> $operator for Numbers<S> {
                type Output = Self;

                #[inline(always)]
                fn $name(self, other: Self) -> Self {
                    let lanes = self.simd.$name(self.lanes, other.lanes);
                    Self { lanes, ..self }
                }
            }

            impl<S: Simd> $operator<f32> for Numbers<S> {
                type Output = Self;

                #[inline(always)]
                fn $name(self, other: f32) -> Self {
                    self.$name(self.like(other))
                }
            }
        )*
        impl<S: Simd> Numbers<S> {
            $(
                /// Of a NaN and a number, the result is `other`.
                #[inline(always)]
                pub(super) fn $method(self, other: Self) -> Self {
                    let lanes = self.simd.$method(self.lanes, other.lanes);
                    Self { lanes, ..self }
                }
            )*
        }
    };
}

operations! { Add add; Sub sub; Mul mul; Div div; | max min }

impl<S: Simd> Numbers<S> {
    #[inline(always)]
    pub(super) fn load(simd: S, from: &[f32; LANES]) -> Self {
        let lanes = simd.load(from);
        Self { simd, lanes }
    }

    #[inline(always)]
    pub(super) fn store(self, into: &mut [f32; LANES]) {
        self.simd.store(self.lanes, into);
    }

    /// `value` in every lane.
    #[inline(always)]
    pub(super) fn like(self, value: f32) -> Self {
        let lanes = self.simd.splat(value);
        Self { lanes, ..self }
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        let lanes = self.simd.sqrt(self.lanes);
        Self { lanes, ..self }
    }

    /// Bit l is set where `self` >= `other` in lane l.
    #[inline(always)]
    pub(super) fn at_least(self, other: Self) -> u32 {
        self.simd.at_least(self.lanes, other.lanes)
    }

    /// `taken` where `self` >= `other`, `otherwise` elsewhere.
    #[inline(always)]
    pub(super) fn where_at_least(self, other: Self, taken: Self, otherwise: Self) -> Self {
        let lanes = self
            .simd
            .where_at_least(self.lanes, other.lanes, taken.lanes, otherwise.lanes);
        Self { lanes, ..self }
    }

    /// 0 where `self` <= 0, `taken` elsewhere.
    #[inline(always)]
    pub(super) fn zero_unless_positive(self, taken: Self) -> Self {
        let lanes = self.simd.zero_unless_positive(self.lanes, taken.lanes);
        Self { lanes, ..self }
    }
}
