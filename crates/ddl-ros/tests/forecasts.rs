//! Every number of a forecast is at its place in the messages: two pedestrians, three hypotheses, no symmetry.

use ddl_core::{
    Forecast, ObservationQuality, Pace, PedestrianId, PedestrianNames, Position, RegionTable, Spread, Window,
};
use ddl_ros::msg::{Header, Time};
use ddl_ros::{Moment, occupancy_grid};
use ddl_scene::{Area, Occupancy};
use serde_json::{Value, json, to_value};

const WEIGHTS: [[f64; 3]; 2] = [[0.125, 0.5, 0.375], [0.625, 0.125, 0.25]];
const LIKELIEST: [usize; 2] = [1, 0];
/// Where pedestrian i is t steps after the moment, which is the same in all hypotheses for t = 0.
fn place(i: usize, k: usize, t: usize) -> Position {
    let [i, k, t] = [i, k, t].map(|number| number as f64);
    [1.0 + 10.0 * i + (0.5 + k) * t, -2.0 - 7.0 * i + (0.25 - k) * t * t]
}

fn window() -> Window {
    // On their way to the present place, which is the last of 8.
    let track = |i| (0..8).map(move |t| [place(i, 0, 0)[0] - 0.5 * f64::from(7 - t), place(i, 0, 0)[1]]);
    let tracks = [0, 1].map(|i| track(i).collect()).into();
    let window = Window::new("hall", 0, 1, [4, 7].map(PedestrianId).into(), tracks).unwrap();
    let qualities = [0.3, 0.1].map(|age| ObservationQuality {
        age,
        ..ObservationQuality::default()
    });
    let names = PedestrianNames::new([(PedestrianId(4), "ann".into())].into());
    window.with_names(names).with_qualities(qualities.into())
}

fn forecast(goals: Option<Vec<Position>>) -> Forecast {
    let steps = (0..2 * 3 * 12).map(|n| place(n / 36, n / 12 % 3, n % 12 + 1));
    Forecast::new(2, 3, steps.collect(), WEIGHTS.as_flattened().into(), goals).unwrap()
}

/// So many microseconds after the moment, which is before 0.
fn header(after: i64) -> Header {
    let (stamp, frame_id) = (Time::of_microseconds(-1_399_995 + after), "odom".to_owned());
    Header { stamp, frame_id }
}

fn point([x, y]: Position) -> Value {
    json!({"x": x, "y": y, "z": 0.0})
}

fn pose(position: Position) -> Value {
    json!({"position": point(position), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}})
}

#[test]
fn messages_say_who_is_where_with_which_weight() {
    let goal = |i, k| place(i, k, 13);
    let goals = (0..6).map(|n| goal(n / 3, n % 3)).collect();
    let certified = [[true, false, false], [false, true, true]];
    let scale = |i: usize, t: usize| 0.5 + i as f64 + 0.25 * t as f64;
    let spread = Spread {
        scales: (0..24).map(|n| scale(n / 12, n % 12)).collect(),
        paces: vec![Pace::Walking; 2],
        regions: RegionTable::of(&[&[[1.0; 12]; 2]; 3], &[0.5]).unwrap().into(),
    };
    let forecast_with = forecast(Some(goals)).with_spread(spread).unwrap();
    let forecast_with = forecast_with.with_certified(certified.as_flattened().into()).unwrap();
    let full = forecast_with.with_familiarity(vec![0.75, 0.25]).unwrap();
    let (window, bare) = (window(), forecast(None));
    let header = &header(0);
    let message = |forecast, joint| {
        let window = &window;
        let moment = Moment {
            window,
            forecast,
            header,
            joint,
        };
        to_value(moment.forecasts()).unwrap()
    };
    let line = |i, k, axis: usize| (1..=12).map(|t| place(i, k, t)[axis]).collect::<Vec<_>>();
    let expected = |is_full: bool| {
        let hypothesis = |i: usize, k: usize| {
            json!({
                "weight": WEIGHTS[i][k], "certified": is_full && certified[i][k],
                "goal": point(if is_full { goal(i, k) } else { [f64::NAN; 2] }),
                "x": line(i, k, 0), "y": line(i, k, 1),
            })
        };
        let pedestrian = |i: usize| {
            json!({
                "id": (["ann", "7"][i]), "position": point(place(i, 0, 0)), "age": ([0.3, 0.1][i]),
                "familiarity": is_full.then_some([0.75, 0.25][i]),
                "scales": (0..12).filter(|_| is_full).map(|t| scale(i, t)).collect::<Vec<_>>(),
                "hypotheses": ([0, 1, 2].map(|k| hypothesis(i, k))),
            })
        };
        json!({"header": header, "time_step": 0.4, "joint": is_full, "pedestrians": ([0, 1].map(pedestrian))})
    };
    assert_eq!(message(&full, true), expected(true));
    assert_eq!(message(&bare, false), expected(false));
}

#[test]
fn paths_and_pictures_show_the_likeliest_paths_and_all_ends() {
    let (window, forecast, header_now) = (window(), forecast(None), header(0));
    let moment = Moment {
        window: &window,
        forecast: &forecast,
        header: &header_now,
        joint: false,
    };
    let likeliest = |i: usize, t| place(i, [1, 0][i], t);
    let steps = |i| (0..=12).map(move |t| json!({"header": header(400_000 * t as i64), "pose": pose(likeliest(i, t))}));
    let path = |i| json!({"header": header(0), "poses": steps(i).collect::<Vec<_>>()});
    assert_eq!(to_value(moment.likeliest_paths()).unwrap(), json!([path(0), path(1)]));

    let lines = (0..24).flat_map(|n| [0, 1].map(|step| point(likeliest(n / 12, n % 12 + step))));
    let ends = (0..6).map(|n| point(place(n / 3, n % 3, 12)));
    // Each weight by the largest of its pedestrian.
    let shares = [0.25, 1.0, 0.75, 1.0, 0.2, 0.4];
    let blue = |a: f32| json!({"r": 0.11_f32, "g": 0.37_f32, "b": 0.76_f32, "a": a});
    let expected = [
        ("likeliest", 5, 0.05, lines.collect::<Vec<_>>(), Vec::new()),
        ("ends", 8, 0.12, ends.collect(), shares.map(blue).into()),
    ];
    let markers = moment.markers().markers.into_iter().map(|it| {
        let how = json!([it.header, it.action, it.pose, it.color, it.lifetime]);
        json!([how, it.ns, it.r#type, it.scale, it.points, it.colors])
    });
    let how = json!([header(0), 0, pose([0.0; 2]), blue(1.0), {"sec": 1, "nanosec": 0}]);
    let expected =
        expected.map(|(name, kind, size, points, colors)| json!([how, name, kind, point([size; 2]), points, colors]));
    assert_eq!(markers.collect::<Vec<_>>(), expected);
}

#[test]
fn a_grid_has_its_time_its_shape_and_rounded_percent() {
    let area = Area::new([-1.5, 2.0], [0.0, 3.0], 0.5).unwrap();
    let probabilities = vec![0.0, 0.004, 0.006, 0.125, 0.994, 1.0];
    let time = 0.8;
    let grid = Occupancy {
        area,
        time,
        probabilities,
    };
    let info = json!({
        "map_load_time": header(0).stamp, "resolution": 0.5, "width": 3, "height": 2, "origin": pose([-1.5, 2.0]),
    });
    let expected = json!({"header": header(800_000), "info": info, "data": [0, 0, 1, 13, 99, 100]});
    assert_eq!(to_value(occupancy_grid(&grid, &header(0))).unwrap(), expected);
}
