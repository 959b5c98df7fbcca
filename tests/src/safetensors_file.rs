//! Parsing of a safetensors file by hand: its length, its header, its numbers.

use serde_json::Value;
use std::error::Error;

/// Header and numbers of a file.
///
/// # Errors
/// Text that describes the defect.
pub fn parts(bytes: &[u8]) -> Result<(Value, &[u8]), Box<dyn Error>> {
    let (length, rest) = bytes.split_first_chunk::<8>().ok_or("shorter than the length of a header")?;
    let length = usize::try_from(u64::from_le_bytes(*length))?;
    let (header, numbers) = rest.split_at_checked(length).ok_or("ends within its header")?;
    let header: Value = serde_json::from_slice(header)?;
    let tensors = header.as_object().ok_or("the header is not an object")?;
    let end = tensors.values().filter_map(|tensor| tensor["data_offsets"][1].as_u64()).max().unwrap_or(0);
    if end != numbers.len() as u64 {
        return Err(format!("{} bytes of numbers, {end} expected", numbers.len()).into());
    }
    Ok((header, numbers))
}

/// The bytes of a file of these parts.
pub fn join(header: &Value, numbers: &[u8]) -> Vec<u8> {
    let mut header = header.to_string();
    // The numbers begin at a multiple of eight bytes.
    let padding = header.len().next_multiple_of(8) - header.len();
    header += &" ".repeat(padding);
    let length = (header.len() as u64).to_le_bytes();
    [&length[..], header.as_bytes(), numbers].concat()
}
