//! A robot's hand reaches past a pillar to a cup, in three dimensions, with a certificate of the motion.
//!
//! ```text
//! cargo run -p ddl-dynamics --example reaching
//! ```
//! A metric shapes the path of the hand. A ball in the way slows the approach to it, and the hand slides along it. The
//! program prints the distance to the cup, the clearance from the ball's surface, and whether the certificate holds. It
//! does the same for plain Euler steps, which overshoot.
#![expect(clippy::print_stdout, reason = "the example prints its result")]

use ddl_dynamics::{
    Attractor, AvoidingFlow, Ball, CholeskyMetric, DynamicsError, Euler, LyapunovCertificate, NaturalGradientFlow,
    StableEuler, rollout,
};
use nalgebra::{Matrix3, Vector3};

/// Seconds of a step of the controller.
const TIME_STEP: f64 = 0.05;
const STEPS: usize = 120;

fn main() -> Result<(), DynamicsError> {
    let cup = Attractor::new(Vector3::new(0.6, 0.1, 0.3))?; // metres
    // P = L L^T + sigma I, in m/s along each axis: L is any lower triangular matrix.
    #[rustfmt::skip]
    let factor = Matrix3::new(
        0.8, 0.0, 0.0,
        0.3, 0.7, 0.0,
        0.0, 0.1, 0.5,
    );
    let reach = NaturalGradientFlow::new(cup, CholeskyMetric::new(factor, 0.01)?);
    // Radius 0.1 m; the approach is slowed within 0.1 m of its surface.
    let pillar = Ball::new(Vector3::new(0.3, 0.1, 0.14), 0.1)?;
    let careful = AvoidingFlow::new(reach, [pillar], 0.1)?;

    let start = Vector3::zeros();
    let clearance = |path: &[Vector3<f64>]| {
        let gaps = path.iter().map(|hand| pillar.gap_and_normal(hand).0);
        gaps.fold(f64::INFINITY, f64::min)
    };
    let careless = rollout(&reach, &StableEuler, start, TIME_STEP, STEPS)?;
    let path = rollout(&careful, &StableEuler, start, TIME_STEP, STEPS)?;

    println!("   time      x      y      z   to the cup  clearance");
    for step in (0..=40).step_by(4) {
        let hand = &path[step];
        println!(
            "{:>5.1} s {:>6.3} {:>6.3} {:>6.3} {:>10.4} m {:>8.4} m",
            TIME_STEP * step as f64,
            hand.x,
            hand.y,
            hand.z,
            cup.distance(hand),
            pillar.gap_and_normal(hand).0
        );
    }
    println!(
        "at the end: {:.6} m from the cup; least clearance {:.4} m ({:.4} m if the pillar is ignored)",
        cup.distance(&path[STEPS]),
        clearance(&path),
        clearance(&careless)
    );

    let certificate = LyapunovCertificate::of_rollout(&careful, &path, TIME_STEP)?;
    match certificate.verify() {
        Ok(()) => println!("certificate: holds, nearer to the cup at every step"),
        Err(violation) => println!("certificate: BROKEN, {violation}"),
    }
    println!(
        "largest angle to the straight line: {:.0} degrees",
        certificate.largest_angle().to_degrees()
    );

    // The same flow with plain Euler steps.
    let plain = rollout(&careful, &Euler, start, TIME_STEP, STEPS)?;
    match LyapunovCertificate::of_rollout(&careful, &plain, TIME_STEP)?.verify() {
        Ok(()) => println!("plain Euler steps: hold"),
        Err(violation) => println!("plain Euler steps: {violation}"),
    }
    Ok(())
}
