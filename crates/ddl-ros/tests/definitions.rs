//! The bytes of a message are those that its definition describes: a writer that knows only the text makes them.

use ddl_core::{Forecast, HORIZON, PedestrianId, Window};
use ddl_ros::msg::{
    Detection3DArray, DiagnosticArray, Forecasts, Header, MarkerArray, OccupancyGrid, Path, People, Person, TfMessage,
    Time, TrackedPerson, TrackedPersons,
};
use ddl_ros::{Message, Moment, RosError, definition, read, read_tracks, write};
use proptest::prelude::*;
use std::collections::HashMap;

/// Writes random values of the types in a definition.
struct Writer<'a> {
    definitions: HashMap<&'a str, Vec<&'a str>>,
    random: std::iter::Cycle<std::slice::Iter<'a, u8>>,
    body: Vec<u8>,
}

impl Writer<'_> {
    /// A number below a limit, of at most 256.
    fn below(&mut self, limit: usize) -> usize {
        self.random.next().map_or(0, |byte| *byte as usize % limit)
    }

    fn put(&mut self, bytes: &[u8]) {
        self.body.resize(self.body.len().next_multiple_of(bytes.len()), 0);
        self.body.extend(bytes);
    }

    fn value(&mut self, kind: &str) {
        if let Some((element, length)) = kind.split_once('[') {
            let fixed = length.trim_end_matches(']').parse();
            let length = fixed.clone().unwrap_or_else(|_| self.below(3));
            if fixed.is_err() {
                self.put(&(length as u32).to_le_bytes());
            }
            return (0..length).for_each(|_| self.value(element));
        }
        let size = match kind {
            "bool" | "byte" | "int8" | "uint8" => 1,
            "int32" | "uint32" | "float32" => 4,
            "uint64" | "float64" => 8,
            "string" => {
                let text = "x".repeat(self.below(6)) + "\0";
                self.put(&(text.len() as u32).to_le_bytes());
                return self.body.extend(text.bytes());
            }
            message => {
                let fields = self.definitions[message].clone();
                return fields.into_iter().for_each(|field| self.value(field));
            }
        };
        let limit = if kind == "bool" { 2 } else { 256 };
        let bytes: Vec<u8> = (0..size).map(|_| self.below(limit) as u8).collect();
        self.put(&bytes);
    }
}

fn is_described<M: Message>(random: &[u8]) {
    // The first part has no name.
    let text = "\n".to_owned() + &definition(M::TYPE).expect("a definition");
    let rule = "=".repeat(80) + "\nMSG: ";
    let parts = text.split(&rule).map(|part| part.split_once('\n').expect("a name"));
    let definitions = parts.map(|(name, body)| {
        let lines = body.lines().map(|line| line.split_once(' ').unwrap_or_default());
        let fields = lines.filter(|(kind, name)| !kind.starts_with('#') && !kind.is_empty() && !name.contains('='));
        (name, fields.map(|(kind, _)| kind).collect())
    });
    let (definitions, random) = (definitions.collect(), random.iter().cycle());
    let mut writer = Writer {
        definitions,
        random,
        body: Vec::new(),
    };
    writer.value("");
    let bytes = [&[0, 1, 0, 0], &writer.body[..]].concat();
    let message: M = read(&bytes).expect(M::TYPE);
    assert_eq!(write(&message).expect(M::TYPE), bytes, "{}", M::TYPE);
    let end = writer.below(256) % bytes.len();
    assert!(read::<M>(&bytes[..end]).is_err());
}

proptest! {
    #[test]
    fn every_message_has_the_bytes_of_its_definition(random in prop::collection::vec(any::<u8>(), 1..99)) {
        is_described::<Detection3DArray>(&random);
        is_described::<People>(&random);
        is_described::<TrackedPersons>(&random);
        is_described::<TfMessage>(&random);
        is_described::<Path>(&random);
        is_described::<OccupancyGrid>(&random);
        is_described::<MarkerArray>(&random);
        is_described::<DiagnosticArray>(&random);
        is_described::<Forecasts>(&random);
    }
}

#[test]
fn a_forecast_is_written_as_it_is() {
    let walk = (0..8).map(|t| [0.5 * f64::from(t), 0.0]).collect();
    let window = Window::new("corridor", 0, 1, vec![PedestrianId(7)], vec![walk]).unwrap();
    let ways = [1.0, -1.0].map(|side| (1..=HORIZON).map(move |t| [3.5 + t as f64, side * t as f64]));
    let goals = Some(vec![[15.5, 12.0], [15.5, -12.0]]);
    let positions = ways.into_iter().flatten().collect();
    let forecast = &Forecast::new(1, 2, positions, vec![0.25, 0.75], goals).unwrap();
    let (window, header, joint) = (&window, &header(), false);
    let moment = Moment {
        window,
        forecast,
        header,
        joint,
    };
    let pedestrian = &moment.forecasts().pedestrians[0];
    let second = &pedestrian.hypotheses[1];
    assert_eq!(
        (pedestrian.id.as_str(), pedestrian.position.x, second.weight),
        ("7", 3.5, 0.75)
    );
    assert_eq!((second.x[11], second.y[11], second.goal.y), (15.5, -12.0, -12.0));
    let [first, .., last] = &moment.likeliest_paths()[0].poses[..] else {
        panic!("a path has 13 poses");
    };
    assert_eq!(
        (first.pose.position.x, last.pose.position.y, last.pose.orientation.w),
        (3.5, -12.0, 1.0)
    );
    assert_eq!(last.header.stamp.microseconds(), 5_800_005);
    let markers = moment.markers().markers;
    let counts: Vec<_> = markers
        .iter()
        .map(|marker| (marker.points.len(), marker.colors.len()))
        .collect();
    assert_eq!(counts, [(24, 0), (2, 2)]);
}

fn header() -> Header {
    let stamp = Time::of_microseconds(1_000_005);
    Header {
        stamp,
        frame_id: "map".to_owned(),
    }
}

#[test]
fn the_package_of_ros_has_the_version_of_the_crate() {
    assert!(include_str!("../package.xml").contains(concat!("<version>", env!("CARGO_PKG_VERSION"), "<")));
}

#[test]
fn what_is_wrong_is_said() {
    let mut people = People {
        header: header(),
        people: vec![Person::default()],
    };
    let error = |people: &People| {
        read_tracks(People::TYPE, &write(people).unwrap())
            .unwrap_err()
            .to_string()
    };
    assert!(error(&people).contains("people[0] has no name"), "{}", error(&people));
    people.header = Header::default();
    assert!(error(&people).contains("set header.stamp"), "{}", error(&people));
    let longer = [write(&people).unwrap(), vec![0; 4]].concat();
    assert!(matches!(read::<People>(&longer), Err(RosError::Rest { left: 4, .. })));

    let mut tracks = TrackedPersons {
        header: header(),
        tracks: vec![TrackedPerson::default(); 2],
    };
    tracks.tracks[0].is_occluded = true;
    tracks.tracks[1].track_id = 8;
    let observed = read_tracks(TrackedPersons::TYPE, &write(&tracks).unwrap()).unwrap();
    assert_eq!(
        (observed.pedestrians[0].name.as_str(), observed.left_out.len()),
        ("8", 1)
    );
}
