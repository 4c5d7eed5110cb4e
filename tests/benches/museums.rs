//! What planning costs as the museum grows, measured on whole agents: `cargo bench -p intermezzo_tests`.
//!
//! Every row is measured with the planner from scratch and with the incremental one in the same run; what
//! counts are the ratios, and how a row changes with the size.
#![expect(clippy::print_stdout, reason = "the table is what it is for")]

use std::time::{Duration, Instant};

use agent_core::planner::{NaivePlanner, Planner, Settings};
use agent_core::protocol::{Happening, Input, Urgency};
use intermezzo_tests::{Ground, Rig, door_change};

const SIZES: [u32; 5] = [40, 400, 4_000, 40_000, 100_000];

fn main() {
    let sizes: Vec<u32> = match std::env::var("SIZES") {
        Ok(text) => text
            .split(',')
            .filter_map(|size| size.parse().ok())
            .collect(),
        Err(_) => SIZES.to_vec(),
    };
    for size in sizes {
        let begun = Instant::now();
        let ground = Ground::of(size);
        println!("{size} nodes: made ready in {:.1?}", begun.elapsed());
        for (row, sample) in measure(&ground, || NaivePlanner::new(Settings::default())) {
            println!(
                "  {row:40} {:>12.1?} {:>8} expanded",
                sample.median(),
                sample.count
            );
        }
    }
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
