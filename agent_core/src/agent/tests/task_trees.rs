//! Repair by partial backtracking, over task trees made at random: the task that is decomposed anew is
//! the lowest above the failed action that has another solution.
//!
//! The oracle knows the domain as numbers and tries everything; it shares nothing with the planners.
//! `TREE_SEED=7` repeats one case; `TREES=100000` asks for more.

mod case;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::sync::Arc;

use super::history::Dice;
use crate::agent::{Agent, Configuration, Executors, Policy, Repair};
use crate::language::{parse_atom, parse_domain, parse_effects, parse_literal, parse_pattern};
use crate::model::{
    Action, ActionModel, Atom, ExecutionModel, FactChange, Map, Number, Suspension, Time,
};
use crate::planner::{GraphPlanner, Item, NaivePlanner, Planner, Settings, TaskList};
use crate::protocol::{
    Answer, Event, GoalId, GoalRequest, Happening, Input, Instruction, Machine, Output, Report,
    Urgency,
};
use case::Case;

const FACTS: usize = 6;
const ACTIONS: usize = 6;
const TASKS: usize = 5;

/// Facts are bits; those from [`FACTS`] on say that an action is half done.
type State = u32;

fn half(action: usize) -> usize {
    FACTS + action
}

#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Do {
    Act(usize),
    Undo(usize),
    Task(usize),
}

#[derive(Clone, Debug, Default)]
struct Act {
    wants: Vec<(usize, bool)>,
    removes: Vec<usize>,
    adds: Vec<usize>,
    /// Must hold while it runs; then it is to be confirmed, too, and may be undone.
    protects: Option<usize>,
}

#[derive(Clone, Debug, Default)]
struct Method {
    wants: Option<(usize, bool)>,
    subtasks: Vec<Do>,
}

/// Tasks that something is a part of, the nearest first, and what follows each.
type Above = Vec<(Do, Vec<Do>)>;

/// A domain as numbers.
#[derive(Clone, Debug)]
struct Tree {
    acts: Vec<Act>,
    /// A task has only tasks of higher numbers under it.
    tasks: Vec<Vec<Method>>,
}

fn literal(dice: &mut Dice) -> (usize, bool) {
    (dice.roll(FACTS), dice.chance(75))
}

fn holds(state: State, fact: usize) -> bool {
    state & (1 << fact) != 0
}

impl Tree {
    fn new(dice: &mut Dice) -> Self {
        let acts = (0..ACTIONS).map(|_| {
            let wants: Vec<_> = (0..dice.roll(3)).map(|_| literal(dice)).collect();
            let positive = wants
                .iter()
                .find(|(_, holds)| *holds)
                .map(|(fact, _)| *fact);
            let adds: Vec<usize> = (0..1 + dice.roll(2)).map(|_| dice.roll(FACTS)).collect();
            let removes = (0..dice.roll(2)).map(|_| dice.roll(FACTS)).collect();
            Act {
                protects: positive.filter(|_| dice.chance(60)),
                wants,
                removes,
                adds,
            }
        });
        let acts = acts.collect();
        let tasks = (0..TASKS).map(|task| {
            let methods = (0..1 + dice.roll(3)).map(|_| Method {
                wants: dice.chance(40).then(|| literal(dice)),
                subtasks: (0..dice.roll(4))
                    .map(|_| match task + 1 < TASKS && dice.chance(60) {
                        true => Do::Task(task + 1 + dice.roll(TASKS - task - 1)),
                        false => Do::Act(dice.roll(ACTIONS)),
                    })
                    .collect(),
            });
            methods.collect()
        });
        Self {
            tasks: tasks.collect(),
            acts,
        }
    }

    /// What it takes at least to do all this, in actions, without some of them.
    fn solve(&self, state: State, list: &[Do], without: &BTreeSet<usize>) -> Option<usize> {
        let Some((first, rest)) = list.split_first() else {
            return Some(0);
        };
        match *first {
            Do::Act(number) => {
                let act = &self.acts[number];
                let mut wants = act.wants.iter();
                if without.contains(&number) || !wants.all(|(fact, is)| holds(state, *fact) == *is)
                {
                    return None;
                }
                let after = self.after(state, number);
                self.solve(after, rest, without).map(|more| more + 1)
            }
            Do::Undo(number) => {
                let half = 1 << half(number);
                (state & half != 0).then_some(())?;
                self.solve(state & !half, rest, without).map(|m| m + 1)
            }
            Do::Task(number) => {
                let applies = |method: &&Method| {
                    let wants = method.wants;
                    wants.is_none_or(|(fact, is)| holds(state, fact) == is)
                };
                let ways = self.tasks[number].iter().filter(applies);
                ways.filter_map(|method| {
                    let list = [method.subtasks.as_slice(), rest].concat();
                    self.solve(state, &list, without)
                })
                .min()
            }
        }
    }

    fn after(&self, state: State, number: usize) -> State {
        let act = &self.acts[number];
        let gone = act.removes.iter().fold(state, |s, fact| s & !(1 << fact));
        act.adds.iter().fold(gone, |s, fact| s | 1 << fact)
    }

    fn hddl(&self) -> String {
        let literals = |wants: &[(usize, bool)]| {
            let mut text = String::from("(and");
            for (fact, holds) in wants {
                let _ = match holds {
                    true => write!(text, " (p{fact})"),
                    false => write!(text, " (not (p{fact}))"),
                };
            }
            text + ")"
        };
        let mut text = String::from("(define (domain trees) (:predicates");
        for fact in 0..FACTS + ACTIONS {
            let _ = write!(text, " (p{fact})");
        }
        text += ") (:functions (total-cost) - number)\n";
        for (number, methods) in self.tasks.iter().enumerate() {
            let _ = writeln!(text, "(:task t{number} :parameters ())");
            for (index, method) in methods.iter().enumerate() {
                let _ = write!(text, "(:method m{number}-{index} :parameters () ");
                let wants: Vec<_> = method.wants.into_iter().collect();
                let _ = write!(
                    text,
                    ":task (t{number}) :precondition {} ",
                    literals(&wants)
                );
                text += ":ordered-subtasks (and";
                for subtask in &method.subtasks {
                    let _ = write!(text, " {}", name(*subtask));
                }
                text += "))\n";
            }
        }
        for (number, act) in self.acts.iter().enumerate() {
            let mut changes: Vec<(usize, bool)> = Vec::new();
            changes.extend(act.removes.iter().map(|fact| (*fact, false)));
            changes.extend(act.adds.iter().map(|fact| (*fact, true)));
            // What is removed and added is added.
            changes.retain(|(fact, holds)| *holds || !act.adds.contains(fact));
            let cost = "(increase (total-cost) 1)";
            let all = |more: &[(usize, bool)]| {
                let text = literals(&[&changes, more].concat());
                format!("{} {cost})", &text[..text.len() - 1])
            };
            let half = half(number);
            for (name, wants, effect) in [
                (format!("a{number}"), literals(&act.wants), all(&[])),
                (
                    format!("resume-{number}"),
                    format!("(p{half})"),
                    all(&[(half, false)]),
                ),
                (
                    format!("undo-{number}"),
                    format!("(p{half})"),
                    format!("(and (not (p{half})) {cost})"),
                ),
            ] {
                let _ = writeln!(
                    text,
                    "(:action {name} :parameters () :precondition {wants} :effect {effect})"
                );
            }
        }
        text + ")"
    }

    fn configuration(&self, dice: &mut Dice) -> (Configuration, u32) {
        let domain = parse_domain(&self.hddl()).expect("a domain");
        let mut model = ExecutionModel::default();
        for (number, act) in self.acts.iter().enumerate() {
            let Some(protects) = act.protects else {
                continue;
            };
            let pattern = |text: String| parse_pattern(&text, &[]).expect("a pattern");
            let literal = |fact: usize| parse_literal(&format!("(p{fact})"), &[]).expect("a fact");
            let left = format!("(p{})", half(number));
            model.actions.insert(
                format!("a{number}").as_str().into(),
                ActionModel {
                    timeout_s: Some(Number::Constant(1e6)),
                    protected: vec![literal(protects)],
                    goal_states: vec![literal(act.adds[0])],
                    suspension: Some(Suspension {
                        effect: parse_effects(&[&left], &[], &domain).expect("an effect"),
                        resume: pattern(format!("(resume-{number})")),
                        rollback: Some(pattern(format!("(undo-{number})"))),
                        reach: None,
                    }),
                    ..ActionModel::default()
                },
            );
        }
        model.observable = (0..FACTS / 2)
            .map(|fact| format!("p{fact}").as_str().into())
            .collect();
        let attempts = 1 + dice.roll(3) as u32;
        let facts = (0..FACTS).filter(|_| dice.chance(50));
        let facts = facts.map(|fact| FactChange::Add(atom(&format!("(p{fact})"))));
        let configuration = Configuration {
            name: "mid".into(),
            epoch: 1,
            domain: Arc::new(domain),
            model: Arc::new(model),
            map: Map::default(),
            maps_below: Arc::new(()),
            facts: facts.collect(),
            executors: Executors::one("left"),
            policy: Policy {
                repair: Repair::Nearest,
                keep_what_helps: false,
                attempts,
                ..Policy::default()
            },
        };
        (configuration, attempts)
    }
}

fn atom(text: &str) -> Atom {
    parse_atom(text).expect("an atom")
}

fn name(what: Do) -> String {
    match what {
        Do::Act(number) => format!("(a{number})"),
        Do::Undo(number) => format!("(undo-{number})"),
        Do::Task(number) => format!("(t{number})"),
    }
}

fn number(atom: &Atom) -> Do {
    let name = atom.name.as_str();
    let read = |rest: &str| rest.parse().expect("a number");
    match (name.strip_prefix("undo-"), name.strip_prefix('a')) {
        (Some(rest), _) => Do::Undo(read(rest)),
        (_, Some(rest)) => Do::Act(read(rest)),
        _ => Do::Task(read(&name[1..])),
    }
}

fn list(tasks: &TaskList) -> Vec<Do> {
    tasks.items().map(|item| number(item.purpose())).collect()
}

/// What ought to come of a failure.
#[derive(Debug, Eq, PartialEq)]
enum Expected {
    /// This task is decomposed anew, so far above, and it takes so many actions from then on.
    Anew(String, usize, usize),
    /// The action is tried again.
    Again(usize),
    /// There is no plan at all.
    Nothing,
}

#[derive(Debug, Default)]
struct Tally {
    levels: BTreeMap<usize, usize>,
    lenient: usize,
    again: usize,
    nothing: usize,
    undone: usize,
    others: usize,
}

fn seeds(usual: u64) -> std::ops::Range<u64> {
    let asked = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    match (asked("TREE_SEED"), asked("TREES")) {
        (Some(seed), _) => seed..seed + 1,
        (None, count) => 0..count.unwrap_or(usual),
    }
}

#[test]
#[expect(
    clippy::print_stderr,
    reason = "what was tried is worth seeing with --nocapture"
)]
fn the_task_that_is_decomposed_anew_is_the_lowest_that_has_another_solution() {
    let mut tally = Tally::default();
    let seeds = seeds(2000);
    let all = seeds.end - seeds.start > 1;
    for seed in seeds {
        Case::new(seed, NaivePlanner::new(Settings::default())).run(&mut tally);
        Case::new(seed, GraphPlanner::new(Settings::default())).run(&mut tally);
    }
    eprintln!("{tally:?}");
    if all {
        let level = |level| tally.levels.get(&level).copied().unwrap_or_default();
        let seen = [
            level(1),
            level(2),
            level(3),
            tally.lenient,
            tally.again,
            tally.nothing,
            tally.undone,
            tally.others,
        ];
        assert!(seen.iter().all(|seen| *seen > 10), "{tally:?}");
    }
}
