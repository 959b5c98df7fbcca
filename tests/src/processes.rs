//! What the system says of a process: its processor time and its memory. Linux tells in `/proc`; elsewhere nothing is
//! known, and the tests say so.

use std::time::Duration;

/// The kernel counts in hundredths of a second for programs, whatever it does itself.
const TICKS_A_SECOND: f64 = 100.0;

/// Processor time of the process so far, its own and the system's for it, of all its threads. Still known when it has ended
/// and nobody has asked how.
#[must_use]
pub fn processor_time(id: u32) -> Option<Duration> {
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The second field is the program's name in parentheses, and may hold anything.
    let (_, fields) = stat.rsplit_once(')')?;
    let ticks: Vec<f64> = fields
        .split_whitespace()
        .skip(11) // state and ten numbers
        .take(2)
        .map(|field| field.parse().ok())
        .collect::<Option<_>>()?;
    Some(Duration::from_secs_f64(
        ticks.iter().sum::<f64>() / TICKS_A_SECOND,
    ))
}

/// Bytes of this process that are in memory now, or were and are swapped out.
#[must_use]
pub fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kibibytes = |name: &str| -> Option<u64> {
        let line = status.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().strip_suffix("kB")?.trim().parse().ok()
    };
    Some(1024 * (kibibytes("VmRSS:")? + kibibytes("VmSwap:").unwrap_or(0)))
}

#[cfg(test)]
mod tests {
    use super::{processor_time, resident_bytes};

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_is_told_of() {
        let before = processor_time(std::process::id()).expect("Linux tells");
        let mut sum = 0_u64;
        while processor_time(std::process::id()).expect("Linux tells") <= before {
            sum = std::hint::black_box(sum + 1);
        }
        let small = resident_bytes().expect("Linux tells");
        let ballast = vec![1_u8; 32 << 20];
        let large = resident_bytes().expect("Linux tells");
        assert!(large > small + (16 << 20), "{small}, then {large}");
        drop(std::hint::black_box(ballast));
    }
}
