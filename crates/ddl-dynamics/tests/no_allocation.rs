//! A rollout into a slice allocates nothing, with any integrator.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(
    unsafe_code,
    reason = "counting allocations takes a global allocator, whose trait is unsafe"
)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
    cmp::Ordering,
    hint::black_box,
};

use ddl_dynamics::{
    Attractor, CholeskyMetric, Euler, Integrator, MetricSchedule, NaturalGradientFlow, PUBLISHED_SIGMA, Real,
    StableEuler, rollout, rollout_into,
};
use nalgebra::{SMatrix, SVector};

const STEPS: usize = 12;
/// Seconds of a step.
const TIME_STEP: f64 = 0.4;

thread_local! {
    // Counted per thread, because the tests of this file run in parallel. A constant initial value and no destructor:
    // reading it allocates nothing.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every call is forwarded unchanged to the system's allocator, which keeps the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's layout, as the contract of this method requires.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc` or `realloc` above, so from the system, with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: as for `dealloc`, and the caller's size.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

type Flow<T, const D: usize> = NaturalGradientFlow<T, D, MetricSchedule<T, D>>;

/// To a goal 3 m away along each axis, with deviations to either side. The pedestrian arrives within 40 steps.
fn flow<T: Real, const D: usize>() -> Flow<T, D> {
    let metric = |step: usize| {
        let factor = SMatrix::from_fn(|row, column| match row.cmp(&column) {
            Ordering::Less => T::zero(),
            Ordering::Equal => T::one(),
            Ordering::Greater => T::rounded(0.4 * (step as f64).cos()),
        });
        CholeskyMetric::new(factor, T::rounded(PUBLISHED_SIGMA)).unwrap()
    };
    let schedule = MetricSchedule::new((0..STEPS).map(metric).collect()).unwrap();
    let attractor = Attractor::new(SVector::repeat(T::rounded(3.0))).unwrap();
    NaturalGradientFlow::new(attractor, schedule)
}

fn allocations(run: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.get();
    run();
    ALLOCATIONS.get() - before
}

fn allocates_nothing<T: Real, const D: usize>(integrator: &impl Integrator<T, D>) {
    let (flow, dt) = (flow::<T, D>(), T::rounded(TIME_STEP));
    let mut positions = [SVector::<T, D>::zeros(); 41];
    let made = allocations(|| {
        rollout_into(&flow, integrator, SVector::zeros(), dt, &mut positions).unwrap();
        black_box(&positions);
    });
    assert_eq!(made, 0);
}

#[test]
fn no_step_allocates() {
    allocates_nothing::<f64, 2>(&StableEuler);
    allocates_nothing::<f32, 2>(&StableEuler);
    allocates_nothing::<f64, 3>(&StableEuler);
    allocates_nothing::<f64, 2>(&Euler);
    allocates_nothing::<f32, 2>(&Euler);
    allocates_nothing::<f64, 3>(&Euler);
}

#[test]
fn a_rollout_that_owns_its_positions_allocates_once() {
    let flow = flow::<f64, 2>();
    let made = allocations(|| {
        black_box(rollout(&flow, &StableEuler, SVector::zeros(), TIME_STEP, STEPS).unwrap());
    });
    assert_eq!(made, 1);
}
