//! Motions within bounds: limited speed, nearer to the goal at every step, never past it, and on it with the last step.

use crate::draw::{METRICS, SceneDraw, any_scene, deviation_sine, formed};
use ddl_dynamics::{
    Attractor, CholeskyMetric, LyapunovCertificate, MotionBounds, NaturalGradientFlow, Real, StableEuler, StepTime,
    arriving_schedule, rollout,
};
use nalgebra::Vector2;
use proptest::{prelude::*, test_runner::TestCaseResult};

/// Top speed relative to the required speed, share of the metric, seconds per step, own velocity in top speeds, and
/// whether metrics are in m/s.
type BoundsDraw = (f64, f64, f64, [f64; 2], bool);

fn any_bounds() -> impl Strategy<Value = BoundsDraw> {
    let spare = prop_oneof![1 => Just(1.0), 3 => 1.0..4.0_f64];
    let share = prop_oneof![1 => Just(0.0), 2 => Just(1.0), 2 => 0.0..=1.0_f64];
    let velocity = prop_oneof![1 => Just([0.0; 2]), 4 => prop::array::uniform2(-1.0..1.0_f64)];
    (spare, share, 0.01..2.0_f64, velocity, any::<bool>())
}

fn arrives_within_bounds<T: Real>(scene: &SceneDraw, draw: BoundsDraw) -> TestCaseResult {
    let (spare, share, seconds, velocity, absolute) = draw;
    let (start, attractor, dt) = (scene.start::<T, 2>(), scene.attractor(), T::rounded(seconds));
    let arriving = attractor.distance(&start) / (dt * T::rounded(METRICS as f64));
    let top_speed = (arriving * T::rounded(spare)).max(T::rounded(1e-3));
    let velocity = Vector2::from(velocity).map(T::rounded) * top_speed;
    let Some(bounds) = MotionBounds::new(top_speed, velocity, T::rounded(share)) else { return Ok(()) };
    let bounds = if absolute { bounds.absolute() } else { bounds };
    let schedule = arriving_schedule(scene.metrics(), attractor, bounds, dt).unwrap();
    let flow = NaturalGradientFlow::new(attractor, schedule);
    let path = rollout(&flow, &StableEuler, start, dt, METRICS).unwrap();
    let certificate = LyapunovCertificate::of_rollout(&flow, &path, dt).unwrap();
    let certificate = certificate.within(&path, &attractor, &bounds).unwrap();
    let sizes = path.iter().chain([attractor.goal()]).map(|p| p.amax().as_f64());
    let off = 64.0 * T::EPSILON.as_f64() * sizes.fold(0.0, f64::max);
    let top = bounds.top_speed().as_f64();
    let (mut before, mut sideways): (Option<(f64, [f64; 2])>, f64) = (None, 0.0);
    for (k, step) in path.windows(2).enumerate() {
        let [from, to] = [step[0], step[1]].map(|p| p.map(Real::as_f64));
        let goal = attractor.goal().map(Real::as_f64);
        let speed = (to - from).norm() / seconds;
        prop_assert!(speed <= top * (1.0 + 1e-6) + off / seconds, "step {k}: {speed} m/s over {top}");
        let (d, after) = ((goal - from).norm(), (goal - to).norm());
        // The angle of Kantorovich, and never past the goal.
        let range = bounds.eigenvalues(T::rounded(d), METRICS - k, dt);
        let sine = deviation_sine(range).as_f64();
        let [slow, fast] = [range.smallest, range.largest].map(Real::as_f64);
        let near = |x: f64| 1e-5 * x + off / seconds;
        prop_assert!(after <= (d - (slow - near(slow)) * seconds).max(0.0) + off, "step {k}: {d} to {after}");
        if let Some((was, [slowest, fastest])) = before {
            let most = f64::max(fast - slowest, fastest - slow);
            let change = f64::abs(speed - was);
            prop_assert!(change <= most + near(fast + fastest), "step {k}: {change} over {most}");
        }
        before = Some((speed, [slow, fast]));
        sideways += 0.5 * seconds * (fast - slow + near(fast)) + off;
        let start = path[0].map(Real::as_f64);
        if let Some(ahead) = (goal - start).try_normalize(1e3 * off) {
            let deviation = ahead.perp(&(to - start)).abs();
            prop_assert!(deviation <= sideways, "step {k}: {deviation} over {sideways}");
        }
        if d > 1e3 * off && speed * seconds > 1e3 * off {
            let (ahead, moved) = ((goal - from).normalize(), (to - from).normalize());
            prop_assert!(ahead.perp(&moved).abs() <= sine + 1e-2 && ahead.dot(&moved) > 0.0);
            prop_assert!((to - from).dot(&ahead) <= d * (1.0 + 1e-5) + off);
        }
    }
    let left = attractor.distance(&path[METRICS]).as_f64();
    prop_assert!(left <= off + 1e-5 * top * seconds, "{left} m left");
    prop_assert_eq!(certificate.verify(), Ok(()));
    Ok(())
}

/// The shaped metric lies within the bounds and keeps its axes; a metric within the bounds is unchanged.
fn shaped_within<T: Real>(scene: &SceneDraw, distance: f64, left: usize) -> TestCaseResult {
    let (distance, dt) = (T::rounded(distance), T::rounded(0.4));
    let towards = Vector2::new(distance, T::zero());
    let time = StepTime { done: 12 - left, left, dt };
    for metric in scene.metrics::<T, 2>() {
        let bounds = MotionBounds::<T>::default().absolute();
        let range = bounds.eigenvalues(distance, left, dt);
        let shaped = bounds.shape(&metric, &towards, time);
        let (before, after) = (metric.eigenvalue_range(), shaped.eigenvalue_range());
        let near = T::rounded(1e-4);
        prop_assert!(after.smallest >= range.smallest * (T::one() - near));
        prop_assert!(after.largest <= range.largest * (T::one() + near));
        let inside = before.smallest >= range.smallest && before.largest <= range.largest;
        if inside {
            let change = (formed(&shaped) - formed(&metric)).norm();
            prop_assert!(change <= 1e-4 * before.largest.as_f64(), "{change}");
        }
        // The same eigenvectors: the matrices commute.
        let (a, b) = (formed(&shaped), formed(&metric));
        let commutator = (a * b - b * a).norm();
        prop_assert!(commutator <= 1e-4 * a.norm() * b.norm(), "{commutator}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn bounds_hold(scene in any_scene(), draw in any_bounds(), distance in 0.0..10.0_f64, left in 1..13_usize) {
        arrives_within_bounds::<f32>(&scene, draw)?;
        arrives_within_bounds::<f64>(&scene, draw)?;
        shaped_within::<f32>(&scene, distance, left)?;
        shaped_within::<f64>(&scene, distance, left)?;
    }
}

/// By hand: 4.8 m in 12 steps of 0.4 s are 1 m/s. P = diag(9, 0.04) becomes diag(2, 0.25). With share 0 and the own
/// velocity (1, 1) m/s, half of which remains, it is the metric of the velocity (1, 0.5): [1 0.5; 0.5 1.5]. For a
/// pedestrian at the arriving velocity, the neutral motion is I. Relative to it, Q = 2.25 I adds 1.25 arriving speeds,
/// which exceeds the bound 2. Q = I changes nothing, and Q = 0.5 I halves the speed.
#[test]
fn shaped_by_hand() {
    let (done, left, dt) = (0, 12, 0.4);
    let first = StepTime { done, left, dt };
    let g = MotionBounds::<f64>::momentum(first);
    assert!((g - 0.75 * (-0.2_f64).exp()).abs() < 1e-15);
    let (half, arriving) = (Vector2::new(1.0, 0.5 / g), Vector2::new(1.0, 0.0));
    let within = |velocity, share| MotionBounds::new(2.15, velocity, share).unwrap();
    for (bounds, [a, c], expected) in [
        (within(half, 1.0).absolute(), [3.0_f64, 0.2], [2.0, 0.0, 0.25]),
        (within(half, 0.0).absolute(), [3.0, 0.2], [1.0, 0.5, 1.5]),
        (within(half, 0.5).absolute(), [3.0, 0.2], [1.5, 0.25, 0.875]),
        (within(arriving, 1.0), [1.5, 1.5], [2.0, 0.0, 2.0]),
        (within(arriving, 1.0), [1.0, 1.0], [1.0, 0.0, 1.0]),
        (within(arriving, 1.0), [0.5_f64.sqrt(); 2], [0.5, 0.0, 0.5]),
    ] {
        let metric = CholeskyMetric::planar(a, 0.0, c, 1e-12).unwrap();
        let shaped = formed(&bounds.shape(&metric, &Vector2::new(4.8, 0.0), first));
        for (entry, expected) in [shaped.m11, shaped.m12, shaped.m22].iter().zip(expected) {
            assert!((entry - expected).abs() < 2e-12, "{shaped}");
        }
    }
}

/// A goal out of reach is approached at the top speed, and the certificate states the remaining distance.
#[test]
fn a_goal_out_of_reach_is_reported() {
    let attractor = Attractor::new(Vector2::new(20.0_f64, 0.0)).unwrap();
    let metrics = vec![CholeskyMetric::planar(5.0, 3.0, 1.0, 1e-8).unwrap(); 12];
    let bounds = MotionBounds::new(2.0, Vector2::zeros(), 1.0).unwrap();
    let schedule = arriving_schedule(metrics, attractor, bounds, 0.4).unwrap();
    let flow = NaturalGradientFlow::new(attractor, schedule);
    let path = rollout(&flow, &StableEuler, Vector2::zeros(), 0.4, 12).unwrap();
    assert!((path[12] - Vector2::new(9.6, 0.0)).norm() < 1e-12);
    let certificate = LyapunovCertificate::of_rollout(&flow, &path, 0.4).unwrap();
    let certificate = certificate.within(&path, &attractor, &bounds).unwrap();
    assert_eq!(certificate.verify(), Ok(()));
    let left = certificate.motion().unwrap().distance_left;
    assert!((left.largest - 10.4).abs() < 1e-9 && (left.bound - 10.4).abs() < 1e-6);
}
