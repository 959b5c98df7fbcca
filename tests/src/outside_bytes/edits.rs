//! Input bytes as choices and as edits of a valid file. Edits reach the code behind a reader's first checks.

const ODD_NUMBERS: [&str; 16] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "65536",
    "65537",
    "4294967296",
    "9007199254740993",
    "9223372036854775807",
    "18446744073709551615",
    "1e308",
    "1e-320",
    "0.5",
    "null",
];

/// Choices, one after the other; zeros once the bytes are used up.
#[derive(Debug)]
pub(super) struct Choices<'a>(&'a [u8]);

impl<'a> Choices<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub(super) fn edited(bytes: &'a [u8], whole: &[u8]) -> Vec<u8> {
        let mut edited = whole.to_vec();
        let mut choices = Self::new(bytes);
        while !choices.is_empty() {
            choices.edit(&mut edited);
        }
        edited
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn byte(&mut self) -> u8 {
        let [byte] = self.bytes();
        byte
    }

    pub(super) fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let length = N.min(self.0.len());
        bytes[..length].copy_from_slice(&self.0[..length]);
        self.0 = &self.0[length..];
        bytes
    }

    pub(super) fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.0)
    }

    /// A number below `limit`; 0 if `limit` is 0.
    pub(super) fn below(&mut self, limit: usize) -> usize {
        let number = if limit <= 256 {
            usize::from(self.byte())
        } else {
            usize::from(u16::from_le_bytes(self.bytes()))
                + usize::from(limit > 65_536) * (usize::from(self.byte()) << 16)
        };
        number % limit.max(1)
    }

    /// A coordinate: usually a plausible one, occasionally any bits.
    pub(super) fn number(&mut self) -> f64 {
        match self.byte() {
            255 => f64::from_le_bytes(self.bytes()),
            small => f64::from(small) * 0.25 - 30.0,
        }
    }

    /// Edits the bytes: truncates, flips, overwrites, doubles, removes, or replaces a number by an unusual one.
    pub(super) fn edit(&mut self, bytes: &mut Vec<u8>) {
        let place = self.below(bytes.len());
        match self.byte() % 7 {
            0 => bytes.truncate(place),
            1 => {
                let bit = self.byte() % 8;
                if let Some(byte) = bytes.get_mut(place) {
                    *byte ^= 1 << bit;
                }
            }
            2 => {
                let new: [u8; 4] = self.bytes();
                for (byte, new) in bytes[place..].iter_mut().zip(new) {
                    *byte = new;
                }
            }
            3 => {
                let new = self.byte();
                bytes.insert(place, new);
            }
            4 => {
                let end = (place + self.below(64)).min(bytes.len());
                bytes.drain(place..end);
            }
            5 => {
                let end = (place + self.below(64)).min(bytes.len());
                let part = bytes[place..end].to_vec();
                bytes.splice(end..end, part);
            }
            _ => {
                let odd = ODD_NUMBERS[self.below(ODD_NUMBERS.len())];
                replace_number(bytes, place, odd);
            }
        }
    }
}

/// Replaces the first number written in digits at or after `place`.
fn replace_number(bytes: &mut Vec<u8>, place: usize, number: &str) {
    let in_number = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    let Some(start) = bytes[place..].iter().position(u8::is_ascii_digit) else {
        return;
    };
    let start = place + start;
    let length = bytes[start..].iter().take_while(|b| in_number(b)).count();
    bytes.splice(start..start + length, number.bytes());
}
