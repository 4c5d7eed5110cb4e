//! What planning costs as the museum grows, measured on whole agents: `cargo bench -p intermezzo_tests`.
//!
//! Every row is measured with the planner from scratch and with the incremental one in the same run; what
//! counts are the ratios, and how a row changes with the size.
#![expect(clippy::print_stdout, reason = "the table is what it is for")]

use std::time::{Duration, Instant};

use agent_core::planner::{AnyPlanner, Planner, PlannerKind, Settings};
use agent_core::protocol::{Happening, Input, Urgency};
use intermezzo_tests::{Ground, Rig, door_change};

const SIZES: [u32; 5] = [40, 400, 4_000, 40_000, 100_000];
const PLANNERS: [(&str, PlannerKind); 2] = [
    ("scratch", PlannerKind::Naive),
    ("graph", PlannerKind::Graph),
];

/// By row and planner, what was measured at each size.
type Curve = Vec<(&'static str, [Vec<Sample>; 2])>;

fn main() {
    if let Ok(asked) = std::env::var("MEMORY_OF") {
        return memory(&asked);
    }
    let asked = std::env::var("SIZES");
    let sizes: Vec<u32> = asked.map_or_else(
        |_| SIZES.to_vec(),
        |text| {
            text.split(',')
                .filter_map(|size| size.parse().ok())
                .collect()
        },
    );
    let mut curve = Curve::new();
    for size in &sizes {
        let ground = Ground::of(*size);
        for (planner, (_, kind)) in PLANNERS.into_iter().enumerate() {
            let measured = measure(&ground, || AnyPlanner::new(kind, Settings::default()));
            for (row, sample) in measured {
                let place = curve.iter().position(|(known, _)| *known == row);
                let place = place.unwrap_or_else(|| {
                    curve.push((row, [Vec::new(), Vec::new()]));
                    curve.len() - 1
                });
                curve[place].1[planner].push(sample);
            }
        }
        println!("measured at {size} nodes");
    }
    show(&sizes, &curve);
    for (name, _) in PLANNERS {
        if let Some(size) = sizes.last() {
            ask_for_memory(*size, name);
        }
    }
}

/// Times are medians; beside them the nodes expanded (of slices, how many there were).
fn show(sizes: &[u32], curve: &Curve) {
    print!("{:32} {:8}", "", "nodes");
    for size in sizes {
        print!(" {size:>20}");
    }
    println!();
    for (row, by_planner) in curve {
        for ((name, _), samples) in PLANNERS.iter().zip(by_planner) {
            print!("{row:32} {name:8}");
            for sample in samples {
                print!(" {:>11.1?} {:>8}", sample.median(), sample.count);
            }
            println!();
        }
        print!("{:32} {:8}", "", "ratio");
        for (scratch, graph) in by_planner[0].iter().zip(&by_planner[1]) {
            let ratio = graph.median().as_secs_f64() / scratch.median().as_secs_f64();
            print!(" {ratio:>11.3} {:>8}", "");
        }
        println!();
    }
}

/// The most room that a parent takes, map included, in a process of its own.
fn ask_for_memory(size: u32, planner: &str) {
    let told = std::env::current_exe().and_then(|program| {
        std::process::Command::new(program)
            .env("MEMORY_OF", format!("{size} {planner}"))
            .status()
    });
    if let Err(error) = told {
        println!("memory was not measured: {error}");
    }
}

fn memory(asked: &str) {
    let (size, planner) = asked.split_once(' ').unwrap_or((asked, "graph"));
    let kind = PLANNERS.iter().find(|(name, _)| *name == planner);
    let kind = kind.map_or_else(PlannerKind::default, |(_, kind)| *kind);
    let ground = Ground::of(size.parse().unwrap_or(40));
    let mut rig = Rig::new(&ground, AnyPlanner::new(kind, Settings::default()));
    rig.go(&ground.target, Urgency::Normal);
    rig.emergency(&ground.nearby);
    rig.run();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let most = status.lines().find(|line| line.starts_with("VmHWM"));
    println!(
        "{size} nodes, {planner}: {}",
        most.unwrap_or("the system does not say")
    );
}

#[derive(Default)]
struct Sample {
    times: Vec<Duration>,
    count: u64,
}

impl Sample {
    fn time(&mut self, what: impl FnOnce()) {
        let begun = Instant::now();
        what();
        self.times.push(begun.elapsed());
    }

    fn median(&self) -> Duration {
        let mut times = self.times.clone();
        times.sort_unstable();
        times.get(times.len() / 2).copied().unwrap_or_default()
    }

    fn most(&self) -> Duration {
        self.times.iter().max().copied().unwrap_or_default()
    }
}

fn measure<P: Planner>(ground: &Ground, planner: impl Fn() -> P) -> Vec<(&'static str, Sample)> {
    let mut rows = Vec::new();
    let mut made = Sample::default();
    let mut rig = None;
    made.time(|| rig = Some(Rig::new(ground, planner())));
    let Some(mut rig) = rig else { return rows };
    rows.push(("an agent is made", made));

    let mut first = Sample::default();
    first.time(|| rig.go(&ground.target, Urgency::Normal));
    first.count = rig.expanded();
    rows.push(("the first plan", first));

    let mut elsewhere = Sample::default();
    for open in [false, true].repeat(20) {
        elsewhere.time(|| {
            rig.give(Input::Observation(vec![door_change(
                &ground.door_elsewhere,
                open,
            )]));
            rig.think();
        });
    }
    rows.push(("a door elsewhere", elsewhere));
    let mut after = Sample::default();
    rig.happened.clear();
    after.time(|| {
        rig.done();
        rig.think();
    });
    after.count = rig.expanded();
    rows.push(("the next action after that", after));
    rig.run();

    let mut predicted = Sample::default();
    for node in ["n1", &ground.target].repeat(5) {
        rig.go(node, Urgency::Normal);
        while rig.doing.is_some() {
            rig.happened.clear();
            predicted.time(|| {
                rig.done();
                rig.think();
            });
            if rig.doing.is_none() {
                predicted.times.pop();
            }
        }
    }
    rows.push(("an action as predicted", predicted));

    for (row, door) in [
        ("resumed, nothing changed", None),
        ("resumed, a door closed", ground.door_on_the_way.as_ref()),
    ] {
        let mut resumed = Sample::default();
        for _ in 0..5 {
            rig.go("n1", Urgency::Normal);
            rig.run();
            rig.go(&ground.target, Urgency::Normal);
            rig.emergency(&ground.nearby);
            if let Some(door) = door {
                rig.give(Input::Observation(vec![door_change(door, false)]));
            }
            rig.run_to_the_last_action();
            rig.happened.clear();
            resumed.time(|| {
                rig.done();
                rig.think();
            });
            let taken_up = |what: &Happening| matches!(what, Happening::GoalResumed { .. });
            assert!(rig.happened.iter().any(taken_up), "{:?}", rig.happened);
            resumed.count = rig.expanded();
            rig.run();
            if let Some(door) = door {
                rig.give(Input::Observation(vec![door_change(door, true)]));
            }
        }
        rows.push((row, resumed));
    }

    rig.go("n1", Urgency::Normal);
    rig.run();
    rig.go(&ground.target, Urgency::Normal);
    let mut all = Sample::default();
    rig.happened.clear();
    all.time(|| {
        for as_at_first in [false, true] {
            rig.give(Input::Observation(ground.all_doors(as_at_first)));
            rig.done();
            rig.think();
        }
    });
    all.count = rig.expanded();
    rows.push(("every door changes, and back", all));
    rig.run();

    let mut far = Sample::default();
    let mut slice = Sample::default();
    let mut answer = Sample::default();
    rig.go("n1", Urgency::Normal);
    rig.run();
    rig.happened.clear();
    far.time(|| {
        slice.time(|| rig.ask(&format!("(go {})", ground.far_end), Urgency::Normal));
        let mut slices = 0;
        while rig.thinks() {
            slices += 1;
            slice.time(|| rig.give(Input::Wake));
        }
        slice.count = slices;
    });
    far.count = rig.expanded();
    slice.times = vec![slice.most()];
    rows.push(("the plan to the far end", far));
    rows.push(("its longest slice", slice));
    let mut rig = Rig::new(ground, planner());
    rig.ask(&format!("(go {})", ground.far_end), Urgency::Normal);
    for _ in 0..3 {
        rig.give(Input::Wake);
    }
    answer.time(|| rig.ask(&format!("(go {})", ground.nearby), Urgency::Emergency));
    answer.time(|| {
        rig.think();
    });
    answer.times = vec![answer.times[0]];
    rows.push(("an emergency is heard meanwhile", answer));
    rows
}
