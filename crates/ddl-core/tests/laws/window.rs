//! Windows: what is refused, and what stays when pedestrians or positions change.

use ddl_core::{
    FRAME_LIMIT, OBSERVED, ObservationQuality, OtherObservation, PedestrianId, Position, RememberedTrack, Window,
    WindowError, between, bounds, distance, is_frame, is_frame_step,
};

fn ids(range: std::ops::Range<i64>) -> Vec<PedestrianId> {
    range.map(PedestrianId).collect()
}

#[test]
fn invalid_windows_are_refused() {
    let track = |length: usize| vec![[0.0, 0.0]; length];
    let mut spoiled = track(20);
    spoiled[11] = [0.0, f64::NAN];
    let new = |start, step, ids, tracks| Window::new("r", start, step, ids, tracks).unwrap_err();
    let refused = |ids, tracks, message: &str| {
        let error = new(0, 10, ids, tracks).to_string();
        assert!(error.starts_with(message), "{error}");
    };
    refused(vec![], vec![], "a window needs at least one pedestrian");
    refused(ids(0..2), vec![track(20)], "2 pedestrian ids but 1 tracks");
    refused(ids(0..1), vec![track(9)], "pedestrian 0: a track of 9 positions");
    let unequal = vec![track(20), track(8)];
    refused(ids(0..2), unequal, "pedestrian 1: a track of 8");
    refused(ids(0..1), vec![spoiled], "pedestrian 0, position 11 of the track");
    let twice = vec![PedestrianId(1), PedestrianId(1)];
    refused(twice, vec![track(8); 2], "pedestrian 1 is in the window twice");
    for (start, step) in [(0, 0), (0, -10), (i64::MAX, 10), (0, i64::MAX)] {
        let refused = new(start, step, ids(0..1), vec![track(20)]);
        assert!(matches!(refused, WindowError::Frames { .. }));
    }
}

#[test]
fn parts_hold_as_many_pedestrians_as_fit() {
    let of_size = |n: i64| Window::new("r", 0, 1, ids(0..n), vec![vec![[0.0; 2]; 8]; n as usize]).unwrap();
    let windows = [1, 2, 1, 5, 1, 3].map(of_size);
    let sizes = |most: usize| -> Vec<Vec<usize>> {
        Window::parts(&windows, most).map(|part| part.iter().map(Window::len).collect()).collect()
    };
    assert_eq!(sizes(4), [vec![1, 2, 1], vec![5], vec![1, 3]]);
    assert_eq!(sizes(3), [vec![1, 2], vec![1], vec![5], vec![1], vec![3]]);
    assert_eq!(sizes(99), [vec![1, 2, 1, 5, 1, 3]]);
    assert_eq!(Window::parts(&[], 4).count(), 0);
}

#[test]
fn changing_positions_changes_nothing_else() {
    let tracks = vec![(0..20).map(|t| [f64::from(t), 0.0]).collect(), vec![[5.0, 5.0]; 20]];
    let window = Window::new("r", 100, 6, ids(4..6), tracks).unwrap();
    let alone = window.filter_pedestrians(|i| i == 1).unwrap();
    assert_eq!(alone.pedestrians(), ids(5..6));
    assert_eq!((alone.track(0), window.filter_pedestrians(|_| false)), (window.track(1), None));
    let later = |_, step, [x, y]: Position| {
        if step >= OBSERVED { [x + 1.0, y] } else { [x, y] }
    };
    let changed = window.map_positions(later);
    assert_eq!(window.reversed().track(0)[..2], [[19.0, 0.0], [18.0, 0.0]]);
    assert_eq!(window.reversed().reversed(), window);
    assert_eq!(changed.without_future(), window.without_future());
    assert_ne!(changed.end(0), window.end(0));
    assert_eq!((window.frames()[19], window.steps(), window.has_future()), (214, 20, true));
    let observation = window.without_future();
    assert_eq!((observation.frames().len(), observation.has_future()), (8, false));
    assert!(observation.future(0).is_empty() && observation.end(0).is_none());
    assert_eq!(observation.track(0), window.observed(0));
}

#[test]
fn remembered_tracks_stay_with_their_pedestrian() {
    let tracks = (0..3).map(|i| vec![[f64::from(i), 0.0]; 20]).collect();
    let ids = (1..4).map(PedestrianId).collect();
    let remembered = |i: usize| RememberedTrack { track: [[i as f64, 1.0]; 20], distance: i as f64 };
    let window = Window::new("yard", 0, 10, ids, tracks).unwrap();
    assert!((0..3).all(|i| window.remembered(i).is_empty()));
    let remembering = window.clone().with_remembered(|i| (0..i).map(|_| remembered(i)).collect());
    assert_eq!(remembering.remembered(2), [remembered(2); 2]);
    assert_eq!(remembering.without_future().remembered(2), [remembered(2); 2]);
    let two = remembering.filter_pedestrians(|i| i != 1).unwrap();
    assert_eq!(two.remembered(0), []);
    assert_eq!(two.remembered(1), [remembered(2); 2]);
    // Reversal drops it, because it would lie in the future.
    assert_eq!(remembering.reversed(), window.reversed());
    assert_eq!(remembering.with_remembered(|_| Vec::new()), window);
}

#[test]
fn bystanders_are_seen_in_the_order_of_ids() {
    let of = |range: std::ops::Range<i64>, steps: usize| {
        let tracks = range.clone().map(|id| vec![[id as f64, 1.0]; steps]).collect();
        let ages = range.clone().map(|id| ObservationQuality { age: id as f64, ..ObservationQuality::default() });
        let window = Window::new("yard", 0, 10, ids(range.clone()), tracks).unwrap().with_qualities(ages.collect());
        let remembered = |i| RememberedTrack { track: [[i as f64, 2.0]; 20], distance: 0.0 };
        window.with_remembered(|i| vec![remembered(range.start as usize + i)])
    };
    let window = of(4..6, 20).with_bystanders(Some(of(1..4, 20)));
    assert!(!window.bystanders().unwrap().has_future());
    let seen = window.without_future();
    assert_eq!((seen.len(), seen.pedestrians()), (5, &[1, 2, 3, 4, 5].map(PedestrianId)[..]));
    assert_eq!(window.indices_in_scene(), [3, 4]);
    for (i, id) in [1.0, 2.0, 3.0, 4.0, 5.0].into_iter().enumerate() {
        assert_eq!(
            (seen.observed(i)[7], seen.quality(i).age, seen.remembered(i)[0].track[0]),
            ([id, 1.0], id, [id, 2.0])
        );
    }
    assert_eq!(seen.bystanders(), None);
    assert_eq!(
        window.filter_pedestrians(|i| i == 1).unwrap().without_future().pedestrians(),
        [1, 2, 3, 5].map(PedestrianId)
    );
    assert_eq!((window.len(), window.reversed().bystanders()), (2, None));
    assert_eq!(window.clone().with_bystanders(None).without_future(), of(4..6, 8));
    let later = Window::new("yard", 10, 10, ids(1..2), vec![vec![[0.0; 2]; 8]]).unwrap();
    assert!(std::panic::catch_unwind(|| window.with_bystanders(Some(later))).is_err(), "other frames");
}

#[test]
fn what_was_measured_has_no_quality() {
    let window = Window::new("r", 0, 1, ids(0..2), vec![vec![[0.0; 2]; 8]; 2]).unwrap();
    let measured = ObservationQuality::default();
    assert_eq!((window.quality(1), measured.is_whole(), measured.deviation_after(4.8)), (measured, true, 0.0));
    assert_eq!(window.clone().with_qualities(vec![measured; 2]), window);
    let partial = ObservationQuality { unseen: 1, age: 0.1, deviation: 0.3, velocity_deviation: 0.1 };
    assert!(!partial.is_whole() && (partial.deviation_after(4.0) - 0.5).abs() < 1e-12);
    // 0.48 m of 4.8 s.
    assert!((partial.uncertainty() - (0.09_f64 + 0.2304).sqrt()).abs() < 1e-12);
    let window = window.with_qualities(vec![measured, partial]);
    assert_eq!(window.filter_pedestrians(|i| i == 1).unwrap().quality(0), partial);
}

/// Likelier at (0, 0), with a weight of 0.2 at (3, 4): 5 m apart, of which sqrt(0.2 * 0.8 / 2) is the deviation.
#[test]
fn another_explanation_goes_with_its_pedestrian_and_adds_its_deviation() {
    let window = Window::new("r", 0, 1, ids(0..3), vec![vec![[0.0; 2]; 8]; 3]).unwrap();
    let mut positions = [[0.0; 2]; OBSERVED];
    positions[OBSERVED - 1] = [3.0, 4.0];
    let estimated = ObservationQuality { age: 0.1, ..ObservationQuality::default() };
    let other = OtherObservation { positions, quality: estimated, weight: 0.2 };
    let doubtful = window.clone().with_others(vec![(1, other)]);
    let quality = doubtful.quality(1);
    let expected = 5.0 * 0.08_f64.sqrt();
    assert!((quality.deviation - expected).abs() < 1e-12 && quality.age == 0.0);
    assert!((quality.velocity_deviation - expected / 0.4).abs() < 1e-12);
    assert_eq!(
        (doubtful.quality(0), doubtful.other(0), doubtful.other(1)),
        (ObservationQuality::default(), None, Some(&other))
    );
    let alone = doubtful.filter_pedestrians(|i| i > 0).unwrap().without_future();
    assert_eq!((alone.other(0), alone.other(1), alone.quality(0)), (Some(&other), None, quality));
    let [likelier, elsewhere] = doubtful.explanations();
    assert_eq!(likelier, window);
    assert_eq!((elsewhere.observed(1), elsewhere.quality(1)), (&positions[..], estimated));
    assert!(!elsewhere.has_others() && elsewhere.observed(2) == window.observed(2));
    let moved = doubtful.map_positions(|_, _, [x, y]| [x + 1.0, y]);
    assert!(moved.other(1).is_some_and(|other| distance(other.positions[OBSERVED - 1], [4.0, 4.0]) < 1e-12));
    assert!(!doubtful.reversed().has_others());
}

#[test]
fn places_and_frames_by_hand() {
    let places = [[1.0, -4.0], [-2.0, 7.0], [3.0, 0.0]];
    assert_eq!((bounds(places), bounds([])), (Some([[-2.0, -4.0], [3.0, 7.0]]), None));
    let off = distance(between([1.0, 2.0], [3.0, -2.0], 0.25), [1.5, 1.0]);
    assert!(off < 1e-12 && (distance([1.0, 2.0], [4.0, -2.0]) - 5.0).abs() < 1e-12);
    let limits = [1 - FRAME_LIMIT, FRAME_LIMIT - 1, -FRAME_LIMIT, FRAME_LIMIT, i64::MIN];
    assert_eq!(limits.map(is_frame), [true, true, false, false, false]);
    assert_eq!([1, 1 << 31, 0, (1 << 31) + 1].map(is_frame_step), [true, true, false, false]);
}
