//! A rollout into a slice allocates nothing, with any integrator.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(
    unsafe_code,
    reason = "counting allocations takes a global allocator, whose trait is unsafe"
)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
    hint::black_box,
};

use ddl_dynamics::{
    Attractor, CholeskyMetric, Euler, Integrator, MetricSchedule, NaturalGradientFlow, PUBLISHED_SIGMA, Real,
    StableEuler, rollout, rollout_into,
};
use nalgebra::{SMatrix, SVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

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

/// A pedestrian with the flow to its goal, which has a metric for each of 12 steps.
struct MadeUpWalk<T, const D: usize> {
    start: SVector<T, D>,
    flow: NaturalGradientFlow<T, D, MetricSchedule<T, D>>,
}

/// Pedestrians at about 1 m/s, 2 to 6 m from their goals in any direction, with deviations to either side. About half
/// of them arrive within the 4.8 s. The draws are the same in every precision.
fn drawn<T: Real, const D: usize>(count: usize, seed: u64) -> Vec<MadeUpWalk<T, D>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| rng.random_range(low..high);
    (0..count)
        .map(|_| {
            let start: SVector<f64, D> = SVector::from_fn(|_, _| between(-10.0, 10.0));
            let heading = SVector::<f64, D>::from_fn(|_, _| between(-1.0, 1.0));
            let goal = start + heading.normalize() * between(2.0, 6.0);
            let factor = SMatrix::<f64, D, D>::from_fn(|row, column| match row.cmp(&column) {
                std::cmp::Ordering::Less => 0.0,
                std::cmp::Ordering::Equal => between(0.8, 1.1),
                std::cmp::Ordering::Greater => between(-0.4, 0.4),
            });
            let mut metric = || {
                let sway = 1.0 + between(-0.1, 0.1);
                let factor = factor.map(|entry| T::rounded(entry * sway));
                CholeskyMetric::new(factor, T::rounded(PUBLISHED_SIGMA)).expect("finite")
            };
            let schedule = MetricSchedule::new((0..STEPS).map(|_| metric()).collect()).expect("12 metrics");
            let attractor = Attractor::new(goal.map(T::rounded)).expect("finite");
            MadeUpWalk {
                start: start.map(T::rounded),
                flow: NaturalGradientFlow::new(attractor, schedule),
            }
        })
        .collect()
}

fn allocations(run: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.get();
    run();
    ALLOCATIONS.get() - before
}

fn allocates_nothing<T: Real, const D: usize>(integrator: &impl Integrator<T, D>) {
    let hypotheses: Vec<MadeUpWalk<T, D>> = drawn(300, 7);
    let dt = T::rounded(TIME_STEP);
    // 40 steps: all pedestrians reach their goals, so every branch of a step is covered.
    let mut positions = [SVector::<T, D>::zeros(); 41];
    let made = allocations(|| {
        for MadeUpWalk { flow, start, .. } in &hypotheses {
            rollout_into(flow, integrator, *start, dt, &mut positions).unwrap();
            black_box(&positions);
        }
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
    let hypotheses: Vec<MadeUpWalk<f64, 2>> = drawn(1, 7);
    let MadeUpWalk { flow, start, .. } = &hypotheses[0];
    let made = allocations(|| {
        black_box(rollout(flow, &StableEuler, *start, TIME_STEP, STEPS).unwrap());
    });
    assert_eq!(made, 1);
}
