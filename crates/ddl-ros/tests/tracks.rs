//! Which pedestrians a message holds: their names, classes and places, and who is left out.

use ddl_core::PedestrianId;
use ddl_data::Numbering;
use ddl_ros::msg::{
    Detection3D, Detection3DArray, Header, ObjectHypothesisWithPose, People, Person, Point, Time, TrackedPerson,
    TrackedPersons,
};
use ddl_ros::{Message, Observed, RosError, read, read_tracks, write};

const NOT_HERE: Point = Point { x: 9.0, y: 8.0, z: 7.0 };

fn header() -> Header {
    let (stamp, frame_id) = (Time::of_microseconds(5_400_000), "odom".to_owned());
    Header { stamp, frame_id }
}

/// The place of one of several pedestrians.
fn place(i: usize) -> Point {
    let [x, y, z] = [0.5, -1.25, 3.0].map(|axis: f64| axis + axis.signum() * i as f64);
    Point { x, y, z }
}

fn people(names: &[&str]) -> People {
    let person = |(i, name): (usize, &&str)| Person {
        name: (*name).to_owned(),
        position: place(i),
        velocity: NOT_HERE,
        ..Person::default()
    };
    let (header, people) = (header(), names.iter().enumerate().map(person).collect());
    People { header, people }
}

fn observed<M: Message>(message: &M) -> Result<Observed, RosError> {
    read_tracks(M::TYPE, &write(message).unwrap())
}

/// Name, class and place of those who are seen.
fn rows(observed: &Observed) -> Vec<(&str, &str, Point)> {
    let seen = observed.pedestrians.iter();
    seen.map(|seen| (&*seen.name, &*seen.class, seen.position)).collect()
}

#[test]
fn detections_have_their_likeliest_class_and_one_frame() {
    let (far, beyond, nan) = ([-1e7, 1e7].into(), [1.1e7, 0.0].into(), [0.0, f64::NAN].into());
    let seen = [
        ("odom", place(0)),
        ("camera", place(1)),
        ("", far),
        ("", beyond),
        ("", nan),
    ];
    let detections = seen.map(|(frame_id, position)| {
        let mut detection = Detection3D::default();
        (detection.id, detection.header.frame_id) = (format!("of {frame_id}"), frame_id.to_owned());
        (detection.bbox.center.position, detection.bbox.size) = (position, NOT_HERE);
        detection
    });
    let (header, mut detections) = (header(), Vec::from(detections));
    for (class, score) in [("dog", 0.25), ("person", 0.625), ("car", 0.125)] {
        let mut result = ObjectHypothesisWithPose::default();
        (result.hypothesis.class_id, result.hypothesis.score) = (class.to_owned(), score);
        detections[0].results.push(result);
    }
    let observed = observed(&Detection3DArray { header, detections }).unwrap();
    assert_eq!(rows(&observed), [("of odom", "person", place(0)), ("of ", "", far)]);
    let left_out = [
        ("in another frame", 1),
        ("x or y is not finite, or beyond 10,000 km", 2),
    ];
    assert_eq!(observed.left_out, left_out.into());
}

#[test]
fn people_and_persons_have_the_place_of_their_track() {
    let people = observed(&people(&["ann", "bob"])).unwrap();
    assert_eq!((&people.header, people.left_out.len()), (&header(), 0));
    assert_eq!(rows(&people), [("ann", "", place(0)), ("bob", "", place(1))]);

    let (header, mut tracks) = (header(), vec![TrackedPerson::default(); 3]);
    for (i, track) in tracks.iter_mut().enumerate() {
        (track.track_id, track.detection_id, track.is_occluded) = (12 + i as u64, 34, i != 1);
        (track.pose.pose.position, track.twist.twist.linear) = (place(i), NOT_HERE);
    }
    let mut persons = observed(&TrackedPersons { header, tracks }).unwrap();
    assert_eq!(rows(&persons), [("13", "", place(1))]);
    persons.keep("occluded", |_| false);
    assert_eq!(persons.left_out, [("occluded", 3)].into());
}

#[test]
fn names_that_are_no_number_get_one_which_they_keep() {
    // 07 is not how 7 is printed, and 2^53 is no exact number any more.
    let names = ["7", "ann", "07", "-3", "9007199254740992", "9007199254740991"];
    let (numbering, several) = (&mut Numbering::remembering(9), observed(&people(&names)).unwrap());
    let (seen, words) = several.numbered(numbering);
    let again = seen.iter().map(|(id, position)| (words.of(*id).to_string(), *position));
    let expected = (0..6).map(|i| (names[i].to_owned(), [place(i).x, place(i).y]));
    assert_eq!(again.collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    assert_eq!([0, 3, 5].map(|i| seen[i].0), [7, -3, (1 << 53) - 1].map(PedestrianId));
    let (later, _) = observed(&people(&["07", "ann"])).unwrap().numbered(numbering);
    assert_eq!([later[0].0, later[1].0], [seen[2].0, seen[1].0]);
}

#[test]
fn what_is_wrong_is_said() {
    let mut people = people(&["a", ""]);
    let error = |people: &People| observed(people).unwrap_err().to_string();
    assert!(error(&people).contains("people[1] has no name"), "{}", error(&people));
    people.people.pop();
    people.header.stamp = Time::default();
    assert!(error(&people).contains("set header.stamp"), "{}", error(&people));

    let bytes = write(&people).unwrap();
    let longer = |count| read::<People>(&[&bytes[..], &vec![0; count]].concat());
    // Messages are padded to four bytes.
    assert_eq!(longer(3).unwrap(), people);
    assert!(matches!(longer(4), Err(RosError::Rest { left: 4, .. })));
    let error = |bytes: &[u8]| read::<People>(bytes).unwrap_err().to_string();
    assert!(error(&bytes[..3]).contains("3 bytes has no head"));
    assert!(error(&[&[0, 3], &bytes[2..]].concat()).contains("the encoding 0x0003"));
    let unknown = read_tracks("nav_msgs/msg/Path", &bytes).unwrap_err().to_string();
    assert!(unknown.contains("no type of tracks; give vision_msgs"), "{unknown}");
}
