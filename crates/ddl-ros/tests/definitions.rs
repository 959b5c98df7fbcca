//! The bytes of a message are those that its definition describes: a writer that knows only the text makes them.

use ddl_ros::msg::{
    Detection3DArray, DiagnosticArray, Forecasts, MarkerArray, OccupancyGrid, Path, People, TfMessage, Time,
    TrackedPersons,
};
use ddl_ros::{Message, definition, read, write};
use proptest::prelude::*;
use std::collections::HashMap;

/// Writes random values of the types in a definition, and lists the names of the fields.
struct Writer<'a> {
    definitions: HashMap<&'a str, Vec<(&'a str, &'a str)>>,
    random: std::iter::Cycle<std::slice::Iter<'a, u8>>,
    body: Vec<u8>,
    names: Vec<&'a str>,
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
                return fields.into_iter().for_each(|(field, name)| {
                    // A default may follow the name.
                    self.names.extend(name.split(' ').next());
                    self.value(field);
                });
            }
        };
        let limit = if kind == "bool" { 2 } else { 256 };
        let bytes: Vec<u8> = (0..size).map(|_| self.below(limit) as u8).collect();
        self.put(&bytes);
    }
}

fn is_described<M: Message + std::fmt::Debug>(random: &[u8]) {
    // The first part has no name.
    let text = "\n".to_owned() + &definition(M::TYPE).expect("a definition");
    let rule = "=".repeat(80) + "\nMSG: ";
    let parts = text.split(&rule).map(|part| part.split_once('\n').expect("a name"));
    let definitions = parts.map(|(name, body)| {
        let lines = body.lines().map(|line| line.split_once(' ').unwrap_or_default());
        let fields = lines.filter(|(kind, name)| !kind.starts_with('#') && !kind.is_empty() && !name.contains('='));
        (name, fields.collect())
    });
    let (definitions, random) = (definitions.collect::<HashMap<_, _>>(), random.iter().cycle());
    assert_eq!(definitions.len(), 1 + text.matches(&rule).count(), "{text}");
    let mut writer = Writer { definitions, random, body: Vec::new(), names: Vec::new() };
    writer.value("");
    let bytes = [&[0, 1, 0, 0], &writer.body[..]].concat();
    let message: M = read(&bytes).expect(M::TYPE);
    assert_eq!(write(&message).expect(M::TYPE), bytes, "{}", M::TYPE);
    let shown = format!("{message:?}");
    let names = shown.split(' ').filter_map(|word| word.strip_suffix(':'));
    assert!(names.eq(writer.names.iter().copied()), "{shown}");
    let end = writer.below(256) % bytes.len();
    assert!(read::<M>(&bytes[..end]).is_err());
}

proptest! {
    #[test]
    fn every_message_has_the_bytes_and_names_of_its_definition(random in prop::collection::vec(any::<u8>(), 1..99)) {
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
fn the_package_of_ros_has_the_version_of_the_crate() {
    assert!(include_str!("../package.xml").contains(concat!("<version>", env!("CARGO_PKG_VERSION"), "<")));
}

#[test]
fn times_are_whole_microseconds_on_both_sides_of_0() {
    for (microseconds, sec, nanosec) in [(1_000_005, 1, 5_000), (-1, -1, 999_999_000), (-2_500_000, -3, 500_000_000)] {
        let time = Time { sec, nanosec };
        assert_eq!((Time::of_microseconds(microseconds), time.microseconds()), (time, microseconds));
        let nanosec = nanosec + 999;
        assert_eq!(Time { sec, nanosec }.after(0.400_000_6).microseconds(), microseconds + 400_001);
    }
}
