//! An agent that is made again from what it has written down is the agent that it was, and no
//! damage to what it has written down makes it anything that its invariants forbid.
//!
//! Every case is a history from a seed. `RECALL_SEED=7` repeats one; `RECALLS=100000` asks for more.

use std::convert::Infallible;

use super::*;
use crate::agent::tests::history::{Dice, History};
use crate::agent::tests::toy;
use crate::planner::{Frame, GraphPlanner, NaivePlanner, Settings};
use crate::protocol::{ActionId, Input, Instruction, Machine, Output};

fn seeds(usual: u64) -> Range<u64> {
    let asked = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    match (asked("RECALL_SEED"), asked("RECALLS")) {
        (Some(seed), _) => seed..seed + 1,
        (None, count) => 0..count.unwrap_or(usual),
    }
}

fn graph() -> GraphPlanner {
    GraphPlanner::new(Settings::default())
}

fn naive() -> NaivePlanner {
    NaivePlanner::new(Settings::default())
}

fn drained<P: Planner>(agent: &mut Agent<P>) -> Vec<Output<Infallible>> {
    std::iter::from_fn(|| agent.poll_output()).collect()
}

fn apply(rows: &mut Rows, changes: Vec<Row>) {
    for Row { key, value } in changes {
        match value {
            Some(value) => rows.insert(key, value),
            None => rows.remove(&key),
        };
    }
}

/// All rows of an agent that has not written any of them yet.
fn whole<P: Planner + Clone>(agent: &Agent<P>) -> Rows {
    let mut agent = agent.clone();
    let memory = std::mem::take(&mut agent.memory);
    let believed = [&agent.belief, &memory.configured];
    let facts = believed.iter().flat_map(|belief| belief.facts());
    let values = believed.iter().flat_map(|belief| belief.values());
    let touched = facts.chain(values.map(|(function, _)| function)).cloned();
    agent.memory = Memory {
        touched: touched.collect(),
        configured: memory.configured.clone(),
        ..Memory::default()
    };
    // Maps keep their numbers.
    for (number, map) in &memory.maps {
        agent.memory.next_map = *number;
        agent.memory.number_of(map, &agent.own_map);
    }
    let mut rows = Rows::new();
    apply(&mut rows, agent.write_down());
    rows
}

/// Gives it time until it waits for somebody else.
fn think<P: Planner>(agent: &mut Agent<P>, now: crate::model::Time) {
    for _ in 0..100_000 {
        if agent.wake_at().is_none_or(|at| at > now) {
            return;
        }
        agent.handle(now, Input::Wake);
        if agent.wake_at() != Some(crate::model::Time::ZERO) {
            return;
        }
    }
    panic!("it does not come to rest");
}

fn recalled<P: Planner>(epoch: u64, planner: P, rows: &Rows) -> Result<Agent<P>, Unreadable> {
    let mut agent = toy::agent(epoch, planner);
    agent.recall(rows)?;
    Ok(agent)
}

/// Of every number there is one frame, however often it is met: a task is told by it.
fn frames_are_told_apart<P: Planner>(agent: &Agent<P>) -> bool {
    let mut numbers: BTreeMap<u64, usize> = BTreeMap::new();
    for intention in agent.all_intentions() {
        let agendas = intention.agendas.iter().map(|agenda| &agenda.tasks);
        let steps = intention.plans.iter().flat_map(|plan| &plan.steps);
        let steps = steps.chain(intention.records.iter().map(|record| &record.step));
        let mut frames: Vec<&Arc<Frame>> = steps.clone().flat_map(|s| &s.frame).collect();
        for mut list in agendas.chain(steps.map(|step| &step.rest)) {
            while let Some((_, frame, rest)) = list.first() {
                frames.extend(frame);
                list = rest;
            }
        }
        while let Some(frame) = frames.pop() {
            let address = Arc::as_ptr(frame).addr();
            if *numbers.entry(frame.id).or_insert(address) != address {
                return false;
            }
            frames.extend(&frame.parent);
        }
    }
    true
}

/// Runs a history of an agent that writes itself down after every input, and shows each state with
/// the rows and the history up to there, in which restarts are as frequent as anything else.
fn live<P: Planner + Clone>(
    seed: u64,
    planner: fn() -> P,
    mut show: impl FnMut(&Agent<P>, &Rows, &History, u64),
) {
    let mut dice = Dice::new(seed ^ 0x5eed);
    let mut history = History::new(seed);
    let mut epoch = 1;
    let mut agent = toy::agent(epoch, planner());
    let mut rows = Rows::new();
    for _ in 0..60 {
        let input = history.next();
        agent.handle(history.now, input);
        if dice.chance(70) {
            think(&mut agent, history.now);
        }
        history.hear(&drained(&mut agent));
        agent.check();
        assert!(frames_are_told_apart(&agent), "RECALL_SEED={seed}");
        apply(&mut rows, agent.write_down());
        assert_eq!(
            rows,
            whole(&agent),
            "RECALL_SEED={seed}: a change was missed"
        );
        show(&agent, &rows, &history, epoch);
        if dice.chance(8) {
            epoch += 1;
            let again = recalled(epoch, planner(), &rows);
            agent = again.unwrap_or_else(|fault| panic!("RECALL_SEED={seed}: {fault}"));
            if dice.chance(80) {
                for input in history.neighbours() {
                    agent.handle(history.now, input);
                }
            }
        }
    }
}

#[test]
fn an_agent_that_recalls_what_another_has_written_down_writes_down_the_same() {
    for seed in seeds(60) {
        live(seed, graph, |_, rows, _, epoch| {
            let again = recalled(epoch + 1, graph(), rows);
            let mut again = again.unwrap_or_else(|fault| panic!("RECALL_SEED={seed}: {fault}"));
            again.check();
            assert_eq!(whole(&again), *rows, "RECALL_SEED={seed}");
            assert_eq!(again.write_down(), [], "RECALL_SEED={seed}");
        });
    }
}

/// In the words of the epoch before.
fn said(outputs: &[Output<Infallible>], epoch: u64) -> String {
    let before = epoch - 1;
    format!("{outputs:#?}")
        .replace(&format!("epoch: {epoch},"), &format!("epoch: {before},"))
        .replace(&format!("mid.{epoch}."), &format!("mid.{before}."))
}

/// The same input, in the words of the new epoch for what was begun in it.
fn renamed(input: Input<Infallible>, epoch: u64, from: u64) -> Input<Infallible> {
    let rename = |mut id: ActionId| {
        if id.agent == "mid" && id.epoch == epoch - 1 && id.number >= from {
            id.epoch = epoch;
        }
        id
    };
    match input {
        Input::Report { id, report } => Input::Report {
            id: rename(id),
            report,
        },
        Input::Answer { to, answer } => Input::Answer {
            answer,
            to: match to {
                Instruction::Execute { id, action, map } => Instruction::Execute {
                    id: rename(id),
                    action,
                    map,
                },
                Instruction::Suspend { id } => Instruction::Suspend { id: rename(id) },
                Instruction::Resume { id, map } => Instruction::Resume {
                    id: rename(id),
                    map,
                },
                Instruction::Clear { id } => Instruction::Clear { id: rename(id) },
            },
        },
        other => other,
    }
}

#[test]
fn an_agent_that_recalls_goes_on_as_the_other_does() {
    for seed in seeds(60) {
        let mut dice = Dice::new(seed ^ 0xf0);
        live(seed, naive, |agent, rows, history, epoch| {
            if !dice.chance(15) {
                return;
            }
            let (mut agent, mut history) = (agent.clone(), history.clone());
            let from = agent.next_action;
            let again = recalled(epoch + 1, naive(), rows);
            let mut again = again.unwrap_or_else(|fault| panic!("RECALL_SEED={seed}: {fault}"));
            // What happens only once at a start.
            again.neighbours = agent.neighbours.clone();
            agent.restarted = true;
            for number in 0..15 {
                let input = history.next();
                let same = renamed(input.clone(), epoch + 1, from);
                agent.handle(history.now, input.clone());
                again.handle(history.now, same);
                think(&mut agent, history.now);
                think(&mut again, history.now);
                let outputs = drained(&mut agent);
                assert_eq!(
                    said(&outputs, epoch + 1),
                    said(&drained(&mut again), epoch + 1),
                    "RECALL_SEED={seed}: {number} inputs later, {input:?}"
                );
                history.hear(&outputs);
            }
        });
    }
}

/// One damage, at random.
fn damaged(rows: &Rows, dice: &mut Dice) -> Rows {
    let mut rows = rows.clone();
    let keys: Vec<String> = rows.keys().cloned().collect();
    let key = dice.pick(&keys).clone();
    match dice.roll(6) {
        0 => {
            rows.remove(&key);
        }
        1 => {
            let other = dice.pick(&keys).clone();
            let (a, b) = (rows[&key].clone(), rows[&other].clone());
            rows.insert(key, b);
            rows.insert(other, a);
        }
        2 => {
            let value = rows.remove(&key).unwrap_or_default();
            rows.insert(format!("{key}{}", dice.roll(10)), value);
        }
        3 => {
            let mut value = rows[&key].clone();
            value.truncate(dice.roll(value.len()));
            rows.insert(key, value);
        }
        _ => {
            let mut value = rows[&key].clone();
            for _ in 0..1 + dice.roll(3) {
                let place = dice.roll(value.len());
                if let Some(byte) = value.get_mut(place) {
                    *byte = match dice.chance(50) {
                        true => *byte ^ (1 << dice.roll(8)),
                        false => dice.roll(256) as u8,
                    };
                }
            }
            rows.insert(key, value);
        }
    }
    rows
}

#[test]
fn rows_that_are_damaged_are_refused_or_make_a_valid_agent() {
    let (mut refused, mut taken) = (0, 0);
    for seed in seeds(60) {
        let mut dice = Dice::new(seed ^ 0xda);
        live(seed, naive, |_, rows, history, epoch| {
            for _ in 0..3 {
                let damaged = damaged(rows, &mut dice);
                let Ok(mut agent) = recalled(epoch + 1, naive(), &damaged) else {
                    refused += 1;
                    continue;
                };
                taken += 1;
                agent.check();
                let mut history = history.clone();
                for _ in 0..6 {
                    let input = history.next();
                    agent.handle(history.now, input);
                    think(&mut agent, history.now);
                    history.hear(&drained(&mut agent));
                    agent.check();
                    agent.write_down();
                }
            }
        });
    }
    let names: BTreeSet<bool> = BTreeSet::from([refused > 0, taken > 0]);
    assert_eq!(
        names,
        BTreeSet::from([true]),
        "{refused} refused, {taken} taken"
    );
}
