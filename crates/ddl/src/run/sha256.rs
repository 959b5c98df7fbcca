//! A SHA-256 in hexadecimal.

use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;

pub(crate) fn in_hex(hasher: Sha256) -> String {
    let digest = hasher.finalize();
    digest.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}"); // writing to a string cannot fail
        text
    })
}
