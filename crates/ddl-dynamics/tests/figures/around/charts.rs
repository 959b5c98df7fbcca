//! What falls over the steps, read off the axes that are drawn.

use super::{
    super::svg::{PIXEL, attributes, circles, lines},
    Pixel, drawn, pillar_flow, wall_flow,
};
use ddl_dynamics::{Flow, StableEuler, rollout};
use nalgebra::Vector2;

/// Metres at a height of the chart below a heading, by two of the numbers at its axis.
fn metres_of(svg: &str, heading: &str) -> impl Fn(Pixel) -> f64 {
    let below = svg.split_once(&format!(">{heading}<")).unwrap().1;
    let height = |number: &str| -> f64 {
        let (before, _) = below.split_once(&format!(">{number}<")).unwrap();
        let text = &before[before.rfind("<text").unwrap()..];
        attributes(text, "y")[0].parse().unwrap()
    };
    let (zero, five) = (height("0 m"), height("5 m"));
    move |[_, y]| (y - zero) / (five - zero) * 5.0
}

/// How many times a number is smaller than the one before.
fn falls(numbers: &[f64]) -> usize {
    numbers.windows(2).filter(|pair| pair[1] < pair[0]).count()
}

fn assert_charted(points: &[Pixel], metres: &dyn Fn(Pixel) -> f64, lengths: &[f64]) {
    assert_eq!(points.len(), lengths.len());
    for (step, (point, length)) in points.iter().zip(lengths).enumerate() {
        let found = metres(*point);
        assert!(
            (found - length).abs() < 1e-3,
            "step {step}: {found} for {length}"
        );
    }
    let across = points.windows(2).map(|pair| pair[1][0] - pair[0][0]);
    let width = points[1][0] - points[0][0];
    assert!(
        across
            .into_iter()
            .all(|step| (step - width).abs() < 2.0 * PIXEL)
    );
}

#[test]
fn around_the_wall_v_falls_and_the_distance_does_not() {
    let (svg, flow) = (drawn(), wall_flow());
    let metres = metres_of(&svg, "What falls: V, not the distance");
    let points = circles(&svg, "wall-falling");
    let steps = points.len() - 1;
    let path = rollout(&flow, &StableEuler, Vector2::zeros(), 0.4, steps).unwrap();
    let potentials: Vec<_> = path.iter().map(|p| flow.potential(p)).collect();
    assert_charted(&points, &metres, &potentials);
    assert_eq!(falls(&potentials), steps);

    let goal = Vector2::new(0.0, 1.0);
    let distances: Vec<_> = path.iter().map(|p| (p - goal).norm()).collect();
    let [line] = &lines(&svg, "wall-distance")[..] else {
        panic!("one line of distances");
    };
    assert_charted(line, &metres, &distances);
    let rises = steps - falls(&distances);
    assert!(distances[1] > distances[0] && rises > steps / 3);
    for note in [
        format!(">V falls in {steps} of {steps} steps<"),
        format!(">distance rises in {rises} steps<"),
    ] {
        assert!(svg.contains(&note), "{note}");
    }
}

#[test]
fn among_pillars_the_distance_falls() {
    let (svg, flow) = (drawn(), pillar_flow());
    let metres = metres_of(&svg, "What falls: the distance itself");
    let points = circles(&svg, "pillars-falling");
    let steps = points.len() - 1;
    let path = rollout(&flow, &StableEuler, Vector2::new(0.0, 0.6), 0.4, steps).unwrap();
    let distances: Vec<_> = path.iter().map(|p| (p - flow.goal()).norm()).collect();
    assert_charted(&points, &metres, &distances);
    assert_eq!(falls(&distances), steps);
    let note = format!(">distance falls in {steps} of {steps} steps<");
    assert!(svg.contains(&note), "{note}");
}
