//! What processes take of the machine, as the system says.

use std::fs;
use std::time::Duration;

/// Of a second, in which the system counts processor time: it has been 100 on every Linux since the
/// numbers are shown to processes.
const TICKS_PER_S: f64 = 100.0;

/// What a process has taken so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Usage {
    /// Processor time, of all its threads.
    pub(super) cpu: Duration,
    /// Memory that it holds at present, in bytes.
    pub(super) memory_bytes: u64,
}

/// Of the process of that number; nothing if the system does not say, or there is none.
pub(super) fn of(pid: u32) -> Usage {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    Usage {
        cpu: cpu(&stat).unwrap_or_default(),
        memory_bytes: memory_bytes(&status).unwrap_or_default(),
    }
}

fn cpu(stat: &str) -> Option<Duration> {
    // The name, in brackets, may have blanks and brackets in it.
    let (_, fields) = stat.rsplit_once(')')?;
    let mut fields = fields.split_whitespace();
    // The state is the third field, times in user and kernel mode are the 14th and 15th.
    let user: u64 = fields.nth(11)?.parse().ok()?;
    let kernel: u64 = fields.next()?.parse().ok()?;
    Some(Duration::from_secs_f64(
        (user + kernel) as f64 / TICKS_PER_S,
    ))
}

fn memory_bytes(status: &str) -> Option<u64> {
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_says_of_a_process_is_understood() {
        let stat = "42 (a) b c) S 1 42 42 0 -1 4194560 1 2 3 4 250 50 7 8 20 0 9 0 100 1 2";
        assert_eq!(cpu(stat), Some(Duration::from_secs(3)));
        let status = "Name:\tx\nVmPeak:\t  9 kB\nVmRSS:\t  2048 kB\n";
        assert_eq!(memory_bytes(status), Some(2 << 20));
        assert_eq!(cpu("nonsense"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_takes_memory() {
        assert!(of(std::process::id()).memory_bytes > 0);
    }
}
