//! Random numbers with a printed seed, so that a failure can be reproduced.

use std::time::Duration;

/// A random number generator with its seed.
#[derive(Debug)]
pub struct Chance(pub fastrand::Rng);

impl Chance {
    /// A new seed at every call, which is printed.
    pub fn new(what: &str) -> Self {
        let seed = std::hash::BuildHasher::hash_one(&std::hash::RandomState::new(), what);
        eprintln!("{what}: seed {seed}");
        Self(fastrand::Rng::with_seed(seed))
    }

    /// A whole number below `limit`.
    pub fn below(&mut self, limit: u64) -> u64 {
        self.0.u64(..limit.max(1))
    }

    /// A random moment in the `index`-th of `count` equal parts of a time.
    pub fn moment(&mut self, (index, count): (u32, u32), whole: Duration) -> Duration {
        let part = whole / count;
        let within = Duration::from_micros(self.below(part.as_micros() as u64));
        part * index + within
    }
    /// Positions in a file: some of the first sixteen bytes, and others anywhere. Half of the others are in the first
    /// kilobytes, which hold the header.
    pub fn places(&mut self, length: usize, count: usize) -> Vec<usize> {
        let heads = (0..16.min(length)).step_by(if count < 16 { 5 } else { 1 });
        let limits = [length, length.min(4096)].into_iter().cycle().take(count);
        let anywhere = limits.map(|limit| self.below(limit as u64) as usize);
        heads.chain(anywhere).collect()
    }

    /// The bytes with one bit flipped at `place`.
    pub fn turned(&mut self, bytes: &[u8], place: usize) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        bytes[place] ^= 1 << self.below(8);
        bytes
    }
}
