use super::*;
use ddl_core::{HORIZON, Position};

/// One pedestrian whose hypotheses are at these positions (m) at 1.6, 3.2 and 4.8 s, and elsewhere at the other steps.
fn person(present: Position, hypotheses: &[[Position; 3]]) -> Hypotheses {
    let path = |places: &[Position; 3]| -> [Position; HORIZON] {
        std::array::from_fn(|t| {
            let [x, y] = if t % 4 == 3 { places[t / 4] } else { [7.0, -9.0] };
            [present[0] + x, present[1] + y]
        })
    };
    let paths: Vec<_> = hypotheses.iter().map(path).collect();
    Hypotheses::new(present, vec![1.0 / hypotheses.len() as f32; hypotheses.len()], |k| &paths[k])
}

/// The samples of each cluster, in ascending order.
fn parts(people: &[Hypotheses], chosen: &[Vec<u8>], count: usize) -> Vec<Vec<usize>> {
    let labels = clusters(people, chosen, count);
    let of = |label: usize| (0..labels.len()).filter(|&s| labels[s] == label).collect();
    let mut parts: Vec<Vec<usize>> = (0..count).map(of).filter(|part: &Vec<usize>| !part.is_empty()).collect();
    parts.sort();
    parts
}

/// Two hypotheses that differ at one of the three times alone, on one axis.
#[test]
fn each_step_and_each_axis_counts() {
    for (step, axis) in (0..3).flat_map(|step| (0..2).map(move |axis| (step, axis))) {
        let same = [[1.0, 0.5], [2.0, 1.0], [3.0, 1.5]];
        let mut other = same;
        other[step][axis] += 1.0;
        let people = [person([4.0, 2.0], &[same]), person([-3.0, 5.0], &[same, other])];
        let chosen = [vec![0; 6], vec![1, 0, 0, 1, 1, 0]];
        assert_eq!(parts(&people, &chosen, 2), [[0, 3, 4], [1, 2, 5]], "{step} {axis}");
        // No more clusters than there are different samples.
        assert_eq!(parts(&people, &chosen, 5), [[0, 3, 4], [1, 2, 5]]);
    }
}

/// Scenes on a line, along which both pedestrians move: 0, 1, 2, 10, 11 and 15 m. Whatever the first centres are, two
/// clusters end as the lower three and the upper three; with the places of one pedestrian exchanged they would not.
#[test]
fn clusters_have_their_means_as_centres() {
    let far = |x: f64, y: f64| [[x, 0.0], [0.0, 0.0], [0.0, y]];
    let people = [
        person([50.0, -20.0], &[far(0.0, 0.0), far(1.0, 0.0), far(2.0, 3.0), far(6.0, 8.0)]),
        person([0.0, 0.0], &[far(0.0, 0.0), far(0.0, 5.0), far(9.0, 0.0)]),
    ];
    let chosen = [vec![0, 1, 0, 3, 3, 2], vec![0, 0, 1, 0, 1, 2]];
    // Squared distances: of 0 to 1 and 2: 1, 25; of 3 to 4: 25, of both to 5: 16 + 25 + 81 and more.
    assert_eq!(parts(&people, &chosen, 3), [vec![0, 1, 2], vec![3, 4], vec![5]]);
    let centres = means(&people, &chosen, &[1, 1, 1, 0, 0, 0], &vec![vec![[[9.0; 3]; 2]; 2]; 3]);
    // Those of the last three scenes, of the first three, and one without any.
    let sums = [14, 0, 0, 0, 0, 19, 9, 0, 0, 0, 0, 5, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5].map(|sum| sum as f32);
    let expected = sums.map(|sum| sum / 3.0).into_iter().chain([9.0; 12]);
    for (found, expected) in centres.as_slice().concat().as_flattened().as_flattened().iter().zip(expected) {
        assert!((found - expected).abs() < 1e-5, "{centres:?}");
    }
    // The third sample is at (0, 0), and at 5 m along y at the end: 1/9 and 100/9 from the second centre.
    let found = distances(&people, &chosen, &centres)[3 * 2 + 1];
    assert!((found - 101.0 / 9.0).abs() < 1e-4, "{found}");
}
