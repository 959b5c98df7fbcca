use super::mass::{MassTable, mass};
use crate::fixture::{futures, with_deviation};
use crate::risk::probability;
use crate::{Area, Futures, Occupancy};
use ddl_core::{Position, distance};
use proptest::{collection::vec, prelude::*};

fn grids(futures: &Futures, area: &Area, times: &[f64]) -> Vec<Occupancy> {
    futures.occupancy(area, times, 0.25).unwrap().collect()
}

/// The integral over the disc in polar coordinates around its middle, by the midpoint rule.
fn reference(distance: f64, radius: f64, scale: f64) -> f64 {
    const N: usize = 600;
    let density = |square: f64| (1.0 + square / (3.0 * scale * scale)).powf(-2.5);
    let mut sum = 0.0;
    for r in (0..N).map(|r| radius * (r as f64 + 0.5) / N as f64) {
        for angle in (0..N).map(|a| std::f64::consts::PI * (a as f64 + 0.5) / N as f64) {
            sum += r * density(distance * distance + r * r - 2.0 * distance * r * angle.cos());
        }
    }
    sum * radius / (N * N) as f64 / (scale * scale)
}

#[test]
fn mass_of_a_disc() {
    for scale in [0.004, 0.02, 0.1, 0.5, 3.0] {
        let table = MassTable::new(0.2, scale);
        for at in [0.0, 0.07, 0.19, 0.2, 0.202, 0.25, 0.4, 1.0, 2.0] {
            let [exact, found] = [reference(at, 0.2, scale), mass(at, 0.2, scale)];
            assert!((exact - found).abs() < 5e-4, "{at} {scale}: {exact} {found}");
            let from_table = table.mass(at);
            assert!((from_table - found).abs() < 5e-4, "{at} {scale}: {found} {from_table}");
        }
        assert!((mass(0.0, 0.2, scale) - probability(0.2 / scale)).abs() < 1e-5);
    }
    // Nothing between the scale of the table and 0.
    let [tiny, none] = [1e-9, 0.0].map(|scale| MassTable::new(0.2, scale));
    for at in [0.0, 0.1999, 0.2001, 1.0] {
        assert!((tiny.mass(at) - none.mass(at)).abs() < 1e-3);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Cells are what the definition says, to 0.001 for each pedestrian and 0.0005 for its mass. Another order of
    /// pedestrians and another place change nothing.
    #[test]
    fn laws_of_occupancy(
        starts in vec([-2.0..2.0f64, -2.0..2.0f64], 3), speeds in vec(vec([-1.0..1.0f64, -1.0..1.0f64], 2), 3),
        scales in vec(0.05..0.8f64, 3), time in 0.01..4.8f64,
    ) {
        let area = Area::new([-3.0, -2.5], [2.0, 3.5], 0.25).unwrap();
        let weights = [0.7, 0.3];
        let crowd = futures(&starts, &speeds, &weights, &scales);
        let grid = grids(&crowd, &area, &[time]).remove(0);
        let places = (0..24).flat_map(|row| (0..20).map(move |column| [column, row]));
        for (place, &found) in places.zip(&grid.probabilities) {
            let centre = [0.25 * f64::from(place[0]) - 2.875, 0.25 * f64::from(place[1]) - 2.375];
            let expected: f64 = (0..2).map(|k| {
                let free = |i: usize| {
                    let at = [0, 1].map(|axis| starts[i][axis] + time * speeds[i][k][axis]);
                    1.0 - mass(distance(centre, at), 0.25, scales[i] * time / 4.8)
                };
                weights[k] * (1.0 - (0..3).map(free).product::<f64>())
            }).sum();
            prop_assert!((f64::from(found) - expected).abs() < 4.5e-3, "{found} {expected}");
            prop_assert!((0.0..=1.000_001).contains(&found));
        }
        let shifted: Vec<Position> = starts.iter().rev().map(|at| [at[0] + 10.0, at[1] - 20.0]).collect();
        let (mut speeds, mut scales) = (speeds, scales);
        speeds.reverse();
        scales.reverse();
        let there = futures(&shifted, &speeds, &weights, &scales);
        let other = grids(&there, &Area::new([7.0, -22.5], [12.0, -16.5], 0.25).unwrap(), &[time]).remove(0);
        let pairs = grid.probabilities.iter().zip(&other.probabilities);
        prop_assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-5));
    }
}

#[test]
fn files_of_others() {
    let area = Area::new([-1.0, 2.0], [-0.25, 2.5], 0.25).unwrap();
    let probabilities = vec![0.0, 0.5, 1.0, 0.2, 0.004, 0.996];
    let grid = Occupancy { area, time: 0.4, probabilities };
    let pgm = grid.pgm();
    assert_eq!(pgm, [b"P5\n3 2\n255\n".as_slice(), &[204, 254, 1, 254, 128, 0]].concat());
    let expected = "image: \"a \\\"b\\\".pgm\"\nresolution: 0.25\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    assert_eq!(grid.yaml("a \"b\".pgm"), expected);
    let message = grid.message("odom");
    assert_eq!(message["data"], serde_json::json!([0, 50, 100, 20, 0, 100]));
    assert_eq!(
        (&message["info"]["width"], &message["header"]),
        (&3.into(), &serde_json::json!({"stamp": 0.4, "frame_id": "odom"}))
    );
    let head = area.npy_head(7);
    assert_eq!((head.len() % 64, &head[..8], head.last()), (0, b"\x93NUMPY\x01\x00".as_slice(), Some(&b'\n')));
    assert!(String::from_utf8_lossy(&head).contains("'shape': (7, 2, 3)"));
    assert_eq!(grid.npy_values()[4..8], 0.5_f32.to_le_bytes());
}

#[test]
fn who_was_seen_a_while_ago_is_not_certain_now() {
    let futures = with_deviation(&futures(&[[0.0; 2]], &[vec![[0.0; 2]]], &[1.0], &[0.5]), 0.4);
    let area = Area::new([-0.05; 2], [0.05; 2], 0.1).unwrap();
    let found = f64::from(grids(&futures, &area, &[0.0])[0].probabilities[0]);
    assert!((found - probability(0.25 / 0.4)).abs() < 1e-3, "{found}");
}

proptest! {
    /// One who is far away costs at most their own cells: the area of the others is that without them. Of two alone the
    /// one with the narrower forecast is the bulk.
    #[test]
    fn far_people_are_left_out_of_the_default_area(
        starts in vec([-20.0..20.0f64, -20.0..20.0f64], 1..5), away in 2e3..1e6f64, place in 0_usize..5,
        times in 1_usize..90,
    ) {
        let place = place.min(starts.len());
        let speeds = |count: usize| vec![vec![[0.5; 2]]; count];
        let crowd = |starts: &[Position], scales: &[f64]| futures(starts, &speeds(starts.len()), &[1.0], scales);
        let near = crowd(&starts, &vec![0.5; starts.len()]).area(1.0, 0.1, times).unwrap();
        prop_assert!(near.1.is_empty());
        let mut all = starts.clone();
        all.insert(place, [away, -away]);
        let mut scales = vec![0.5; all.len()];
        scales[place] = 0.6;
        prop_assert_eq!(crowd(&all, &scales).area(1.0, 0.1, times).unwrap(), (near.0, vec![place]));
    }
}

/// A line of people in cells of 0.1 m: some fifty fit, and fewer in grids of many times.
#[test]
fn the_default_area_is_bounded() {
    let line: Vec<Position> = (0..500).map(|i| [4.0 * f64::from(i), 4.0 * f64::from(i)]).collect();
    let crowd = futures(&line, &vec![vec![[0.0; 2]]; line.len()], &[1.0], &vec![0.5; line.len()]);
    for (times, most) in [(1, Area::MOST_AROUND), (200, 1_000_000)] {
        let (area, left_out) = crowd.area(1.0, 0.1, times).unwrap();
        let cells = area.size().iter().product::<usize>();
        assert!(cells <= most && 10 * cells > 9 * most && area.ensure_kept(times).is_ok(), "{cells}");
        assert!(left_out.contains(&0) && left_out.contains(&499) && !left_out.contains(&249), "around the middle");
    }
    assert!(crowd.area(1.0, 2.0, 1).unwrap().1.is_empty(), "all fit in larger cells");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let futures = futures(&[[0.0; 2]], &[vec![[0.0; 2]]], &[1.0], &[0.5]);
    let cases = "
1 0 the size of a cell is 0; it must be a number of metres above 0
1 NaN the size of a cell is NaN
-1 0.1 the margin is -1; it must be
1 0.00001 an area of 2 x 2 m in cells of 0.00001 m has more than 50000000 cells: take larger
inf 0.1 the margin is inf
1e300 1e-300 an area of
";
    for case in cases.trim().lines() {
        let parts: Vec<&str> = case.splitn(3, ' ').collect();
        let [margin, cell] = [0, 1].map(|part: usize| parts[part].parse().unwrap());
        let refused = futures.area(margin, cell, 1).unwrap_err().to_string();
        assert!(refused.starts_with(parts[2]), "{refused}");
    }
    assert_eq!(futures.area(0.0, 0.5, 1).unwrap().0.size(), [1, 1]);
    let area = Area::new([0.0; 2], [1.0; 2], 0.1).unwrap();
    assert_eq!(area.size(), [10, 10]);
    assert!(Area::new([0.0; 2], [0.0, 1.0], 0.1).is_err() && Area::new([f64::NAN; 2], [1.0; 2], 0.1).is_err());
    for time in [-0.1, 4.9, f64::NAN] {
        assert!(futures.occupancy(&area, &[time], 0.2).is_err());
    }
    assert!(futures.occupancy(&area, &[4.8], 0.0).is_err());
    let times = Occupancy::every(0.4).unwrap();
    assert!(times.len() == 13 && futures.occupancy(&area, &times, 0.2).is_ok());
    assert!(Occupancy::every(0.0).is_err() && Occupancy::every(f64::NAN).is_err());
}
