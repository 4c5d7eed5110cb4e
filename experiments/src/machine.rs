//! What the machine is that something was measured on.

use std::collections::BTreeMap;
use std::fs;

/// Processor, cores, memory and system, as far as the system says, and how this program was built.
pub fn machine() -> BTreeMap<&'static str, String> {
    let mut facts = BTreeMap::new();
    let line = |file: &str, name: &str| {
        let text = fs::read_to_string(file).ok()?;
        let line = text.lines().find(|line| line.starts_with(name))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    facts.extend(line("/proc/cpuinfo", "model name").map(|name| ("processor", name)));
    facts.extend(line("/proc/meminfo", "MemTotal").map(|size| ("memory", size)));
    let system = fs::read_to_string("/proc/sys/kernel/osrelease").ok();
    facts.extend(system.map(|release| ("system", format!("Linux {}", release.trim()))));
    if let Ok(cores) = std::thread::available_parallelism() {
        facts.insert("cores", cores.to_string());
    }
    let load = fs::read_to_string("/proc/loadavg").ok();
    let load = load.and_then(|text| text.split(' ').next().map(ToOwned::to_owned));
    facts.extend(load.map(|load| ("load", load)));
    let build = match cfg!(debug_assertions) {
        true => "debug: the times say nothing",
        false => "release",
    };
    facts.insert("build", build.to_owned());
    facts
}
