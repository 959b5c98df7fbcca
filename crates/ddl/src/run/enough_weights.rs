//! Checks that a file can hold the weights of a network before the network is made, because a damaged configuration may
//! describe a network larger than the memory.

use crate::error::DdlError;
use std::path::Path;

/// Bytes of a weight in the files of a run.
const BYTES: u64 = 4;

/// Refuses a file that is too short for this many weights. A missing file is left to its reader.
pub(crate) fn require(path: &Path, min_weight_count: u64) -> Result<(), DdlError> {
    let Ok(file) = std::fs::metadata(path) else {
        return Ok(());
    };
    if !file.is_file() || file.len() / BYTES >= min_weight_count {
        return Ok(());
    }
    let problem = format!(
        "is {} bytes long, too short for the network of the config.json beside it, which has more than \
         {min_weight_count} \
         weights; restore the matching file or config.json, or delete it and run the same `ddl train` command \
         again",
        file.len()
    );
    Err(DdlError::run(path, problem))
}
