//! Frames with arbitrary numbers, pushed as by a program.

use ddl_core::{PedestrianId, Position};
use ddl_data::{Completeness, LiveTracks};

use super::edits::{below, byte};
use arbitrary::Unstructured;

/// Every few bytes are a frame: the distance to the previous one, and positions of pedestrians; occasionally a number
/// of any bits.
pub(super) fn read(bytes: &[u8]) {
    let mut choices = Unstructured::new(bytes);
    let completeness = [Completeness::Whole, Completeness::Partial][below(&mut choices, 2)];
    let step = 1 + below(&mut choices, 12) as i64;
    let tracks = LiveTracks::with_frame_step(step).expect("such a step is allowed");
    let mut tracks = tracks.with_completeness(completeness);
    let mut frame: i64 = byte(&mut choices).into();
    let mut people_of_late: Vec<(i64, usize)> = Vec::new();
    while !choices.is_empty() {
        frame = match byte(&mut choices) {
            255 => choices.arbitrary().unwrap_or(0),
            ahead => frame.wrapping_add(i64::from(ahead % 24) - 2),
        };
        let pedestrians: Vec<(PedestrianId, Position)> = (0..below(&mut choices, 5))
            .map(|_| {
                let id = PedestrianId(below(&mut choices, 6) as i64);
                (id, [number(&mut choices), number(&mut choices)])
            })
            .collect();
        let before = tracks.clone();
        let count = pedestrians.len();
        match tracks.push(frame, pedestrians) {
            Err(error) => {
                assert!(!error.to_string().is_empty());
                assert_eq!(tracks, before, "an error changes nothing");
                frame = tracks.last_frame().unwrap_or_default();
            }
            Ok(window) => {
                assert_eq!(tracks.last_frame(), Some(frame));
                if let Some(window) = window {
                    assert!(window.frames().last() == Some(&frame) && window.len() <= tracks.len());
                }
                // 2 s.
                let oldest = frame.saturating_sub(5 * step);
                people_of_late.retain(|&(seen, _)| seen >= oldest);
                people_of_late.push((frame, count));
                let most: usize = people_of_late.iter().map(|&(_, count)| count).sum();
                assert!(tracks.len() <= most, "{} of {most}", tracks.len());
            }
        }
    }
}

/// A coordinate: usually a plausible one, occasionally any bits.
fn number(choices: &mut Unstructured<'_>) -> f64 {
    match byte(choices) {
        255 => choices.arbitrary().unwrap_or(0.0),
        small => f64::from(small) * 0.25 - 30.0,
    }
}
