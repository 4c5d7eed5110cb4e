//! Tables and numbers about a whole run.

use std::fmt::Write;

use crate::instances::Instance;
use crate::outcome::{End, Outcome};
use crate::peers::Peers;
use crate::run::Limits;

type Row<'a> = (&'a Instance, Outcome);

/// Below this, in seconds of CPU, the reference is too fast for a ratio to mean much.
const WORTH_COMPARING_S: f64 = 0.2;
/// No time is measured more exactly than this.
const CLOCK_S: f64 = 0.001;

/// One line for each instance.
pub fn table(rows: &[Row<'_>], peers: &Peers, reference: &str) -> String {
    let names = rows.iter().map(|(instance, _)| instance.name().len());
    let width = names.max().unwrap_or(0).max(8);
    let mut text = format!(
        "{:width$} {:>8} {:>8} {:>7} {:>8} {:>8} {:>6} {:>9} {:>9}  check\n",
        "instance", "wall s", "CPU s", "MiB", "steps", "peers'", "ratio", "ref CPU s", "speed-up"
    );
    for (instance, outcome) in rows {
        let usage = &outcome.usage;
        let length = outcome.length();
        let shortest = peers.shortest(instance);
        let ratio = length.zip(shortest).map(length_ratio);
        let peer = peers.solved_by(reference, instance);
        let speed = peer
            .filter(|_| length.is_some())
            .map(|peer| peer.cpu_s / cpu(outcome));
        let shown = |number: Option<usize>| number.map_or("-".to_owned(), |n| n.to_string());
        let decimal = |number: Option<f64>| number.map_or("-".to_owned(), |n| format!("{n:.2}"));
        // Strings have no errors.
        let _ = writeln!(
            text,
            "{:width$} {:>8.3} {:>8.3} {:>7.0} {:>8} {:>8} {:>6} {:>9} {:>9}  {}",
            instance.name(),
            usage.wall_s,
            usage.cpu_s,
            usage.memory_mib,
            shown(length),
            shown(shortest),
            decimal(ratio),
            decimal(peer.map(|peer| peer.cpu_s)),
            decimal(speed),
            outcome.status()
        );
    }
    text
}

/// How many were solved, how fast, and with what plans.
pub fn summary(rows: &[Row<'_>], peers: &Peers, reference: &str, limits: &Limits) -> String {
    let solved = |rows: &[&Row<'_>]| rows.iter().filter(|row| row.1.length().is_some()).count();
    let by_reference = |rows: &[&Row<'_>]| {
        let them = |row: &&&Row<'_>| peers.solved_by(reference, row.0).is_some();
        rows.iter().filter(them).count()
    };
    let by_any = |rows: &[&Row<'_>]| rows.iter().filter(|row| peers.solved(row.0)).count();
    let all: Vec<&Row<'_>> = rows.iter().collect();
    let mut text = "\nsolved".to_owned();
    let mut folders: Vec<&str> = rows.iter().map(|row| row.0.folder.as_str()).collect();
    folders.dedup();
    for folder in folders {
        let here: Vec<&Row<'_>> = rows.iter().filter(|row| row.0.folder == folder).collect();
        let _ = write!(
            text,
            "\n  {folder:24} {:3} of {:3} ({reference} {}, any peer {})",
            solved(&here),
            here.len(),
            by_reference(&here),
            by_any(&here)
        );
    }
    let proved = rows
        .iter()
        .filter(|row| matches!(row.1.end, End::Unsolvable));
    let wrong = rows.iter().filter(|row| row.1.is_wrong()).count();
    let _ = writeln!(
        text,
        "\n  {:24} {:3} of {:3} ({reference} {}, any peer {}); {} proved unsolvable; {wrong} wrong",
        "all",
        solved(&all),
        all.len(),
        by_reference(&all),
        by_any(&all),
        proved.count()
    );
    let hard = rows.iter().filter_map(|row| {
        let peer = peers.solved_by(reference, row.0)?;
        (peer.cpu_s > WORTH_COMPARING_S).then_some((row, peer))
    });
    let hard: Vec<_> = hard.collect();
    // What is not solved counts as if it had been, at the last moment.
    let cpu_of = |row: &Row<'_>| match row.1.length() {
        Some(_) => cpu(&row.1),
        None => limits.seconds,
    };
    let wall_of = |row: &Row<'_>| match row.1.length() {
        Some(_) => row.1.usage.wall_s.max(CLOCK_S),
        None => limits.seconds,
    };
    let by_cpu = mean(hard.iter().map(|(row, peer)| peer.cpu_s / cpu_of(row)));
    let by_wall = mean(hard.iter().map(|(row, peer)| peer.wall_s / wall_of(row)));
    let missed = hard.iter().filter(|(row, _)| row.1.length().is_none());
    let _ = writeln!(
        text,
        "speed-up over {reference} where it needs more than {WORTH_COMPARING_S} s of CPU, geometric \
         mean of {}: {by_cpu} by CPU, {by_wall} by wall clock ({} not solved, counted as {} s)",
        hard.len(),
        missed.count(),
        limits.seconds
    );
    let ratios: Vec<f64> = (rows.iter())
        .filter_map(|row| Some(length_ratio((row.1.length()?, peers.shortest(row.0)?))))
        .collect();
    let _ = writeln!(
        text,
        "length against the shorter of the peers' plans, geometric mean of {}: {}",
        ratios.len(),
        mean(ratios.iter().copied())
    );
    text
}

/// All rows, for other programs.
pub fn csv(rows: &[Row<'_>]) -> String {
    let mut text = "domain,instance,status,wall_s,cpu_s,memory_mib,steps\n".to_owned();
    for (instance, outcome) in rows {
        let usage = &outcome.usage;
        let steps = outcome.length().map_or(String::new(), |n| n.to_string());
        let _ = writeln!(
            text,
            "{},{},\"{}\",{:.4},{:.4},{:.1},{steps}",
            instance.folder,
            instance.file,
            outcome.status().replace('"', "'"),
            usage.wall_s,
            usage.cpu_s,
            usage.memory_mib
        );
    }
    text
}

fn cpu(outcome: &Outcome) -> f64 {
    outcome.usage.cpu_s.max(CLOCK_S)
}

/// Plans without a step are as long as any other without a step.
fn length_ratio((ours, theirs): (usize, usize)) -> f64 {
    ours.max(1) as f64 / theirs.max(1) as f64
}

/// The geometric mean; of nothing it is nothing.
fn mean(ratios: impl Iterator<Item = f64>) -> String {
    let logarithms: Vec<f64> = ratios.map(f64::ln).collect();
    if logarithms.is_empty() {
        return "-".to_owned();
    }
    let mean = (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp();
    format!("{mean:.2}")
}
