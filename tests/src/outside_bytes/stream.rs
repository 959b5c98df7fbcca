//! Tracks from a tracker, line by line.

use std::collections::BTreeMap;
use std::io::BufReader;

use ddl_data::{Completeness, Frame, FrameReader, LiveTracks};

/// The first byte chooses the size of the pieces in which the other bytes arrive.
pub(super) fn read(bytes: &[u8]) {
    let Some((&piece, text)) = bytes.split_first() else {
        return;
    };
    let whole = answers(FrameReader::new(text, "tracker"), text.len());
    let pieces = BufReader::with_capacity(1 + usize::from(piece), text);
    assert_eq!(answers(FrameReader::new(pieces, "tracker"), text.len()), whole);
    let mut scenes = BTreeMap::new();
    for frame in whole.iter().flatten() {
        let unseen = || LiveTracks::new().with_completeness(Completeness::Partial);
        let tracks = scenes.entry(&frame.scene).or_insert_with(unseen);
        let last = tracks.last_frame();
        assert!(last < Some(frame.number), "{frame:?} after {last:?}");
        assert_eq!(frame.is_first, last.is_none());
        let pedestrians = || frame.pedestrians.iter().copied();
        assert!(pedestrians().all(|(_, place)| place.iter().all(|c| c.abs() <= ddl_core::COORDINATE_LIMIT)));
        let window = tracks.push(frame.number, pedestrians()).expect("frames from the reader can be pushed");
        assert_eq!(window, tracks.window());
        let before = tracks.clone();
        assert!(tracks.push(frame.number, pedestrians()).is_err());
        assert_eq!(*tracks, before);
    }
}

/// The words of an error, to compare.
#[derive(Debug, PartialEq)]
struct ErrorText(String);

/// Every frame and every error until the end.
fn answers<R: std::io::BufRead>(mut reader: FrameReader<R>, length: usize) -> Vec<Result<Frame, ErrorText>> {
    let mut answers = Vec::new();
    loop {
        match reader.next_frame() {
            Ok(None) => return answers,
            Ok(Some(frame)) => answers.push(Ok(frame)),
            Err(error) => answers.push(Err(ErrorText(error.to_string()))),
        }
        assert!(answers.len() <= 2 * length + 2, "the reader makes no progress");
    }
}
