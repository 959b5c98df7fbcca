//! Logs of robots. The messages with tracks, copied into a new log, give the same recording.

use super::tracks::bounded;
use super::valid_file::{names_file, with_file};
use ddl_mcap::{ForecastLog, read_log};
use std::path::Path;

/// Reads an MCAP file.
pub(super) fn read(bytes: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let read = |path: &Path| read_log(path, None, |class| class != "car");
    let tracks = match with_file(&folder.path().join("fuzzed.mcap"), bytes, read) {
        Ok(tracks) => tracks,
        Err(error) => return names_file(&error, "fuzzed.mcap"),
    };
    bounded(&tracks.recording);
    let mut copy = Vec::new();
    let log = ForecastLog::new(&mut copy, Some(&tracks.topic)).expect("memory can be written");
    // Only times before 0 cannot be copied.
    if log.finish().is_ok() {
        let again = with_file(&folder.path().join("copy.mcap"), &copy, read).expect("a written log is read");
        assert_eq!(again.recording.observations(), tracks.recording.observations());
        assert_eq!(again.recording.names(), tracks.recording.names());
    }
}
