//! Speed of a forecast's rollout, and of its certificate, on one core. An element is one hypothesis: 12 steps of 0.4 s
//! with a metric each. The benchmark cycles through 512 different hypotheses, so that branches stay unpredictable.

mod hypotheses;

use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use ddl_dynamics::{Euler, Flow, Integrator, LyapunovCertificate, Real, StableEuler, rollout, rollout_into};
use hypotheses::{MadeUpWalk, STEPS, TIME_STEP, drawn};
use nalgebra::SVector;

const COUNT: usize = 512;
const SEED: u64 = 1;

fn rollouts<T: Real, const D: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    integrator: &impl Integrator<T, D>,
) {
    let hypotheses: Vec<MadeUpWalk<T, D>> = drawn(COUNT, SEED);
    let dt = T::rounded(TIME_STEP);
    let mut positions = [SVector::zeros(); STEPS + 1];
    group.bench_function(name, |b| {
        b.iter(|| {
            for hypothesis in &hypotheses {
                let MadeUpWalk { flow, start, .. } = black_box(hypothesis);
                rollout_into(flow, integrator, *start, dt, &mut positions).expect("finite");
                black_box(&positions);
            }
        });
    });
}

fn certificates<T: Real, const D: usize>(group: &mut BenchmarkGroup<'_, WallTime>, name: &str) {
    let hypotheses: Vec<MadeUpWalk<T, D>> = drawn(COUNT, SEED);
    let dt = T::rounded(TIME_STEP);
    let follow = |MadeUpWalk { flow, start, .. }: &_| rollout(flow, &StableEuler, *start, dt, STEPS);
    let paths: Vec<_> = hypotheses
        .iter()
        .map(|hypothesis| follow(hypothesis).expect("finite"))
        .collect();
    group.bench_function(name, |b| {
        b.iter(|| {
            for (hypothesis, path) in hypotheses.iter().zip(&paths) {
                let MadeUpWalk { flow, metrics, .. } = black_box(hypothesis);
                let certificate = LyapunovCertificate::new(path, metrics, flow.attractor(), dt);
                black_box(certificate.expect("finite").verify()).expect("stable");
            }
        });
    });
}

fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rollout, 12 steps");
    group.throughput(Throughput::Elements(COUNT as u64));
    rollouts::<f64, 2>(&mut group, "StableEuler, f64, plane", &StableEuler);
    rollouts::<f64, 2>(&mut group, "Euler, f64, plane", &Euler);
    rollouts::<f32, 2>(&mut group, "StableEuler, f32, plane", &StableEuler);
    rollouts::<f32, 2>(&mut group, "Euler, f32, plane", &Euler);
    rollouts::<f64, 3>(&mut group, "StableEuler, f64, space", &StableEuler);
    rollouts::<f64, 3>(&mut group, "Euler, f64, space", &Euler);
    group.finish();
    let mut group = criterion.benchmark_group("certificate, 12 steps");
    group.throughput(Throughput::Elements(COUNT as u64));
    certificates::<f64, 2>(&mut group, "f64, plane");
    certificates::<f32, 2>(&mut group, "f32, plane");
    certificates::<f64, 3>(&mut group, "f64, space");
    group.finish();
}

criterion_group!(benches, all);
criterion_main!(benches);
