//! The published scheme: what it does, and what it does not keep.

use ddl_dynamics::{
    Attractor, CholeskyMetric, Euler, LyapunovCertificate, NaturalGradientFlow, Violation, rollout,
};
use nalgebra::{Vector1, Vector2};

#[test]
fn plain_euler_circles_the_goal_and_the_certificate_names_the_step() {
    // At 1 m/s in steps of 0.5 s from 1.25 m: 0.75, 0.25, then to and fro over the goal for ever.
    let attractor = Attractor::new(Vector1::new(0.0)).unwrap();
    let flow = NaturalGradientFlow::straight(attractor);
    let path = rollout(&flow, &Euler, Vector1::new(1.25), 0.5, 6).unwrap();
    assert_eq!(
        path,
        [1.25, 0.75, 0.25, -0.25, 0.25, -0.25, 0.25].map(Vector1::new)
    );
    let metric = CholeskyMetric::new([[1.0]].into(), 1e-8).unwrap();
    let certificate = LyapunovCertificate::new(&path, &[metric; 6], &attractor, 0.5).unwrap();
    let violation = Violation::NotDecreasing {
        step: 2,
        before: 0.25,
        after: 0.25,
    };
    assert_eq!(certificate.holds(), Err(violation.clone()));
    assert_eq!(
        violation.to_string(),
        "step 2 does not approach the goal: 0.25 m away before it, 0.25 m after it"
    );
}

#[test]
fn the_published_step_of_four_tenths_circles_in_the_plane() {
    // A walker at 1.4 m/s with a bent path: the distance settles around dt times the speed, not at 0.
    let attractor = Attractor::new(Vector2::new(2.0, 1.0)).unwrap();
    let metric = CholeskyMetric::planar(1.1, 0.4, 1.2, 1e-8).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let path = rollout(&flow, &Euler, Vector2::zeros(), 0.4, 2000).unwrap();
    let nearest = path[1000..]
        .iter()
        .map(|p| attractor.potential(p))
        .fold(f64::MAX, f64::min);
    assert!(nearest > 0.05, "{nearest}");
    let certificate =
        LyapunovCertificate::new(&path, &vec![metric; 2000], &attractor, 0.4).unwrap();
    // The certificate's own bound tells the same: the first negative margin is the first violation.
    let negative = certificate
        .steps()
        .iter()
        .position(|step| step.step_margin < Some(0.0));
    let Err(Violation::NotDecreasing { step, .. }) = certificate.holds() else {
        panic!("plain Euler cannot hold: {:?}", certificate.holds())
    };
    assert_eq!(Some(step), negative);
}
