//! Messages hold the numbers of forecasts and of trackers at their places (`reference/messages.py`).

use ddl_core::{
    Forecast, Numbering, ObservationQuality, Pace, PedestrianId, PedestrianNames, RegionTable, Spread, Window,
};
use ddl_ros::msg::{Detection3DArray, Header, People, Time, TrackedPersons};
use ddl_ros::{ForecastMessages, Message, Observed, RosError, occupancy_grid, read, read_tracks, write};
use ddl_scene::{Area, Occupancy};
use serde::de::DeserializeOwned;
use serde_json::{Value, from_value, json, to_value};

fn reference(part: &str) -> Value {
    let text = include_str!("reference/messages.json");
    serde_json::from_str::<Value>(text).expect("JSON")[part].take()
}

#[test]
fn forecasts_paths_and_pictures_have_all_numbers_at_their_places() {
    fn part<T: DeserializeOwned>(name: &str) -> T {
        from_value(reference("forecast")[name].take()).unwrap()
    }
    let ids = [4, 7].map(PedestrianId).into();
    let qualities =
        part::<Vec<f64>>("ages").into_iter().map(|age| ObservationQuality { age, ..ObservationQuality::default() });
    let window = Window::new("hall", 0, 1, ids, part("past")).unwrap().with_qualities(qualities.collect());
    let window = &window.with_names(PedestrianNames::new([(PedestrianId(4), "ann".into())].into()));
    let forecast = |goals| Forecast::new(2, 3, part("positions"), part("weights"), goals).unwrap();
    let spread = Spread {
        scales: part("scales"),
        paces: vec![Pace::Walking; 2],
        regions: RegionTable::of(&[&[[1.0; 12]; 2]; 3], &[0.5]).unwrap().into(),
    };
    let full = forecast(Some(part("goals"))).with_spread(spread).unwrap().with_certified(part("certified")).unwrap();
    let full = full.with_familiarity(part("familiarities")).unwrap();
    let (stamp, frame_id) = (Time::of_microseconds(-1_399_995), "odom".to_owned());
    let header = &Header { stamp, frame_id };
    for (joint, forecast, name) in [(true, &full, "full"), (false, &forecast(None), "bare")] {
        let moment = ForecastMessages { window, forecast, header, joint };
        assert_eq!(to_value(moment.forecasts()).unwrap(), reference(name));
        assert_eq!(to_value(moment.likeliest_paths()).unwrap(), reference("paths"));
        assert_eq!(to_value(moment.markers()).unwrap(), reference("markers"));
    }
    let grid = Occupancy {
        area: Area::new([-1.5, 2.0], [0.0, 3.0], 0.5).unwrap(),
        time: 0.8,
        probabilities: vec![0.0, 0.004, 0.006, 0.125, 0.994, 1.0],
    };
    assert_eq!(to_value(occupancy_grid(&grid, header)).unwrap(), reference("grid"));
}

fn observed<M: Message>(message: Value) -> Result<Observed, RosError> {
    read_tracks(M::TYPE, &write(&from_value::<M>(message).expect("a message")).expect("bytes"))
}

#[test]
fn pedestrians_have_name_class_and_place_and_others_are_counted() {
    let numbering = &mut Numbering::remembering(9);
    for mut case in from_value::<Vec<Value>>(reference("cases")).unwrap() {
        let read = match case["kind"].as_str() {
            Some("People") => observed::<People>,
            Some("TrackedPersons") => observed::<TrackedPersons>,
            _ => observed::<Detection3DArray>,
        };
        match read(case["message"].take()) {
            Ok(mut observed) => {
                let seen = observed.pedestrians.iter();
                let rows: Vec<_> = seen.map(|seen| json!([seen.name, seen.class, seen.position])).collect();
                let (numbered, names) = observed.numbered(numbering);
                // Words have numbers from 2^53 on.
                let number =
                    |(id, place): &(PedestrianId, _)| json!([id.0.min(1 << 53), names.of(*id).to_string(), place]);
                let numbers: Vec<_> = numbered.iter().map(number).collect();
                assert_eq!(json!([observed.header, rows, observed.left_out, numbers]), case["expected"]);
                let all = observed.left_out.values().sum::<usize>() + numbers.len();
                observed.pedestrians[0].position.y = f64::NAN;
                observed.keep_finite();
                let (left, left_out) = (observed.pedestrians.len(), observed.left_out.values().sum::<usize>());
                assert_eq!((left, left + left_out), (numbers.len() - 1, all));
            }
            Err(error) => assert!(error.to_string().contains(case["error"].as_str().unwrap()), "{error}"),
        }
    }
}

#[test]
fn bytes_that_are_no_message_are_refused() {
    let people = People::default();
    let bytes = write(&people).unwrap();
    let longer = |count| read::<People>(&[&bytes[..], &vec![0; count]].concat());
    // Messages are padded to four bytes.
    assert_eq!(longer(3).unwrap(), people);
    assert!(matches!(longer(4), Err(RosError::Rest { left: 4, .. })));
    let error = |bytes: &[u8]| read::<People>(bytes).unwrap_err().to_string();
    assert!(error(&bytes[..3]).contains("3 bytes has no head"));
    assert!(error(&[&[0, 3], &bytes[2..]].concat()).contains("the encoding 0x0003"));
    let swapped = [[0; 4], [0, 0, 0, 5], [0, 0, 0, 9], [0, 0, 0, 1], [0; 4], [0; 4]].concat();
    assert_eq!(read::<People>(&swapped).unwrap().header.stamp, Time { sec: 5, nanosec: 9 });
    let unknown = read_tracks("nav_msgs/msg/Path", &bytes).unwrap_err().to_string();
    assert!(unknown.contains("no type of tracks; give vision_msgs"), "{unknown}");
}
