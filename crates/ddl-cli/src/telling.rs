//! Messages for users on standard error.

use ddl::Note;
use std::fmt::{Arguments, Display};
use std::io::{Error, ErrorKind, Write as _, stderr};
use std::time::Duration;

/// Writes a line to standard error. A closed standard error is ignored; `eprintln!` would panic.
pub(crate) fn tell(line: Arguments<'_>) {
    let _ = writeln!(stderr(), "{line}");
}

/// Tells a remark of the libraries.
pub(crate) fn tell_note(note: &Note) {
    tell(format_args!("{}", note.line()));
}

pub(crate) fn human(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, seconds) => format!("{seconds} s"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s"),
        (hours, minutes, _) => format!("{hours} h {minutes} min"),
    }
}

/// A count with its noun, whose plural has an s.
pub(crate) fn many(count: impl Display + PartialEq + From<u8> + Copy, one: &str) -> String {
    let ending = if count == 1.into() { "" } else { "s" };
    format!("{count} {one}{ending}")
}

/// Whether a write failed because the reader has closed the output, as in `ddl info | head -1`.
pub(crate) fn reader_has_gone(error: &anyhow::Error) -> bool {
    kinds(error).any(|kind| kind == ErrorKind::BrokenPipe)
}

/// An error and its causes, each printed once (some errors already include their cause), with advice on a full disk and
/// similar faults.
pub(crate) fn words(error: &anyhow::Error) -> String {
    let mut message = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !message.contains(&cause) {
            let separator = if message.is_empty() { "" } else { ": " };
            message = message + separator + &cause;
        }
    }
    if let Some(advice) = advice(error) {
        message = message + "; " + advice;
    }
    message
}

fn advice(error: &anyhow::Error) -> Option<&'static str> {
    kinds(error).find_map(|kind| match kind {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            Some("make room and run the same command again")
        }
        ErrorKind::ReadOnlyFilesystem => Some("choose a writable place"),
        ErrorKind::PermissionDenied => Some("get permission, or choose another place"),
        _ => None,
    })
}

fn kinds(error: &anyhow::Error) -> impl Iterator<Item = ErrorKind> {
    error.chain().filter_map(|cause| Some(cause.downcast_ref::<Error>()?.kind()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context as _;

    #[test]
    fn the_cause_is_found_behind_its_context() {
        let error = |kind: ErrorKind| {
            let failed: Result<(), Error> = Err(kind.into());
            failed.context("cannot write to a file").unwrap_err()
        };
        assert!(reader_has_gone(&error(ErrorKind::BrokenPipe)));
        assert!(!reader_has_gone(&error(ErrorKind::StorageFull)));
        assert!(advice(&error(ErrorKind::StorageFull)).is_some_and(|advice| advice.contains("make room")));
        assert_eq!(advice(&error(ErrorKind::InvalidData)), None);
    }

    #[test]
    fn durations_read_well() {
        let said = [7, 67, 3_725].map(|seconds| human(Duration::from_secs(seconds)));
        assert_eq!(said, ["7 s", "1 min 7 s", "1 h 2 min"]);
    }
}
