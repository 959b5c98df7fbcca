//! Edits of a valid file, chosen by bytes. They reach the code behind a reader's first checks.

use arbitrary::Unstructured;

const ODD_NUMBERS: &str = "0 -0.0 1 -1 2 3 65536 65537 4294967296 9007199254740993 9223372036854775807 \
                           18446744073709551615 1e308 1e-320 0.5 null";

/// A number below `limit`; 0 if `limit` is 0, or the choices are used up.
pub(super) fn below(choices: &mut Unstructured<'_>, limit: usize) -> usize {
    choices.int_in_range(0..=limit.saturating_sub(1)).unwrap_or(0)
}

/// The next byte; 0 if the choices are used up.
pub(super) fn byte(choices: &mut Unstructured<'_>) -> u8 {
    choices.arbitrary().unwrap_or(0)
}

/// The file with edits until the choices are used up: truncated, parts removed, doubled, overwritten or inserted, a
/// number replaced by an unusual one.
pub(super) fn edited(choices: &mut Unstructured<'_>, whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    while !choices.is_empty() {
        let way = byte(choices) % 6;
        let start = below(choices, bytes.len() + 1);
        let end = (start + below(choices, 64)).min(bytes.len());
        match way {
            0 => bytes.truncate(start),
            1 => drop(bytes.drain(start..end)),
            2 => bytes.extend_from_within(start..end),
            3 | 4 => {
                let new = choices.arbitrary::<[u8; 4]>().unwrap_or_default();
                let new = &new[..=end % 4];
                let overwritten = if way == 3 { new.len() } else { 0 };
                let end = (start + overwritten).min(bytes.len());
                drop(bytes.splice(start..end, new.iter().copied()));
            }
            _ => {
                let number = ODD_NUMBERS.split(' ').nth(end % 16).unwrap_or_default();
                replace_number(&mut bytes, start, number);
            }
        }
    }
    bytes
}

/// Replaces the first number written in digits at or after `place`.
fn replace_number(bytes: &mut Vec<u8>, place: usize, number: &str) {
    let in_number = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    let Some(start) = bytes[place..].iter().position(u8::is_ascii_digit) else {
        return;
    };
    let start = place + start;
    let length = bytes[start..].iter().take_while(|byte| in_number(byte)).count();
    bytes.splice(start..start + length, number.bytes());
}
