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
    /// Between 0 and 255.
    fn number(&mut self) -> usize {
        self.random.next().map_or(0, |byte| *byte as usize)
    }

    fn bytes(&mut self, count: usize) {
        self.body.resize(self.body.len().next_multiple_of(count), 0);
        for _ in 0..count {
            let byte = self.number() as u8;
            self.body.push(byte);
        }
    }

    fn length(&mut self, length: usize) {
        self.body.resize(self.body.len().next_multiple_of(4), 0);
        self.body.extend((length as u32).to_le_bytes());
    }

    fn value(&mut self, kind: &str) {
        if let Some((element, length)) = kind.split_once('[') {
            let fixed = length.trim_end_matches(']').parse();
            let length = fixed.clone().unwrap_or_else(|_| self.number() % 3);
            if fixed.is_err() {
                self.length(length);
            }
            return (0..length).for_each(|_| self.value(element));
        }
        match kind {
            "bool" => {
                let value = self.number() as u8 % 2;
                self.body.push(value);
            }
            "byte" | "int8" | "uint8" => self.bytes(1),
            "int32" | "uint32" | "float32" => self.bytes(4),
            "uint64" | "float64" => self.bytes(8),
            "string" => {
                let text = "x".repeat(self.number() % 6) + "\0";
                self.length(text.len());
                self.body.extend(text.bytes());
            }
            message => {
                for field in self.definitions[message].clone() {
                    self.value(field);
                }
            }
        }
    }
}

fn is_described<M: Message>(random: &[u8]) {
    // The first part has no name.
    let text = "\n".to_owned() + &definition(M::TYPE).expect("a definition");
    let rule = "=".repeat(80) + "\nMSG: ";
    let parts = text.split(&rule).map(|part| part.split_once('\n').expect("a name"));
    let definitions = parts.map(|(name, body)| {
        let lines = body
            .lines()
            .filter(|line| !line.starts_with('#') && !line.contains('=') && !line.is_empty());
        (name, lines.map(|line| line.split(' ').next().unwrap_or(line)).collect())
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
    let end = writer.number() % bytes.len();
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
    people.people[0].name = "a".to_owned();
    people.people[0].position.x = f64::NAN;
    assert!(
        error(&people).contains("pedestrian a is at (NaN, 0, 0)"),
        "{}",
        error(&people)
    );
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
    assert_eq!((observed.pedestrians[0].name.as_str(), observed.occluded), ("8", 1));
}
