//! A machine that writes down all it hears, and what a station promises of it.

mod disk;
mod exchange;

use std::collections::VecDeque;
use std::convert::Infallible;

use super::*;
use crate::model::{Atom, FactChange};
use crate::protocol::durable::{Rows, Unreadable, read_row};
use crate::protocol::{Command, Happening, Machine, Output, Report};

/// Does what it is told by commands, and remembers what it has heard.
#[derive(Clone, Debug, Default)]
struct Toy {
    /// In short.
    heard: Vec<String>,
    next: u64,
    outputs: VecDeque<Output<Infallible>>,
    ledger: Ledger,
    suspended: Vec<ActionId>,
}

fn id(number: u64) -> ActionId {
    ActionId {
        agent: "above".into(),
        epoch: 1,
        number,
    }
}

fn execute(number: u64) -> Instruction {
    Instruction::Execute {
        id: id(number),
        action: Atom::new("go", []),
        map: None,
    }
}

impl Toy {
    fn instruct(&mut self, instruction: Instruction) {
        let to = "below".into();
        self.outputs.push_back(Output::Instruct { to, instruction });
    }
}

impl Machine for Toy {
    type In = Infallible;
    type Out = Infallible;

    fn handle(&mut self, at: Time, input: Input<Infallible>) -> Option<Reply> {
        match input {
            // Begin the next thing, or stop the last one.
            Input::Command(command) => {
                match command {
                    Command::Resume(_) => {
                        self.next += 1;
                        self.instruct(execute(self.next));
                    }
                    Command::Suspend(_) => {
                        self.instruct(Instruction::Suspend { id: id(self.next) })
                    }
                    Command::Cancel(door) if door == "door" => {
                        self.outputs.push_back(Output::Observed {
                            facts: vec![FactChange::Remove(Atom::new("open", ["door"]))],
                            reported_to: None,
                        });
                        self.outputs.push_back(Output::Seen {
                            to: "above".into(),
                            facts: vec![FactChange::Remove(Atom::new("at", ["door"]))],
                            reported: false,
                        });
                    }
                    Command::Cancel(goal) => self.outputs.push_back(Output::Event(Event {
                        at,
                        goal: Some(goal),
                        stack_depth: 0,
                        what: Happening::GoalSucceeded,
                    })),
                }
                Some(Reply::Command(Ok(())))
            }
            Input::Instruction { from, instruction } => {
                let id = instruction.id().clone();
                let verb = match instruction {
                    Instruction::Execute { .. } => "execute",
                    Instruction::Suspend { .. } => "suspend",
                    Instruction::Resume { .. } => "resume",
                    Instruction::Clear { .. } => "clear",
                };
                self.heard.push(format!("{verb} {}", id.number));
                let suspends = verb == "suspend";
                self.suspended.retain(|known| *known != id);
                self.suspended.extend(suspends.then(|| id.clone()));
                let report = match suspends {
                    true => Report::Suspended { facts: Vec::new() },
                    false => Report::Started,
                };
                self.outputs.push_back(Output::Report {
                    to: from,
                    id,
                    report,
                });
                Some(Reply::Instruction(match suspends {
                    true => Answer::Suspending,
                    false => Answer::Accepted,
                }))
            }
            Input::Answer { to, .. } => {
                self.heard.push(format!("answer {}", to.id().number));
                None
            }
            Input::Report { id, report } => {
                let how = match report {
                    Report::Started => "started",
                    _ => "suspended",
                };
                self.heard.push(format!("{how} {}", id.number));
                None
            }
            Input::Reborn { name } => {
                self.heard.push(format!("reborn {name}"));
                None
            }
            _ => None,
        }
    }

    fn poll_output(&mut self) -> Option<Output<Infallible>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        None
    }
}

impl Durable for Toy {
    fn write_down(&mut self) -> Vec<Row> {
        self.ledger
            .put("m/toy".to_owned(), &(&self.heard, self.next));
        self.ledger.take()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.ledger = Ledger::of(rows, "m/");
        (self.heard, self.next) = read_row(rows, "m/toy")?.unwrap_or_default();
        Ok(())
    }

    fn is_suspended(&self, _: &Symbol, id: &ActionId) -> bool {
        self.suspended.contains(id)
    }
}

type Post = Station<Toy, u64>;

/// A station with the disk it writes to.
struct Desk {
    name: &'static str,
    epoch: u64,
    station: Post,
    disk: Rows,
    /// Given to the disk, and not on it yet.
    writing: Option<Vec<Row>>,
}

impl Desk {
    fn new(name: &'static str, epoch: u64) -> Self {
        Self {
            name,
            epoch,
            station: Post::new(name.into(), epoch, Toy::default()),
            disk: Rows::new(),
            writing: None,
        }
    }

    fn handle(&mut self, arrival: Arrival<Infallible>, sender: Option<u64>) {
        self.station.handle(Time::ZERO, arrival, sender);
    }

    fn command(&mut self, command: Command) {
        self.handle(Arrival::Input(Input::Command(command)), None);
    }

    fn start_writing(&mut self) {
        if self.writing.is_none() {
            self.writing = self.station.write_down();
        }
    }

    fn end_writing(&mut self) {
        for row in self.writing.take().into_iter().flatten() {
            match row.value {
                Some(value) => self.disk.insert(row.key, value),
                None => self.disk.remove(&row.key),
            };
        }
        self.station.written();
    }

    fn write(&mut self) {
        self.end_writing();
        self.start_writing();
        self.end_writing();
    }

    /// The process dies and starts anew, with what was on the disk.
    fn restart(&mut self) {
        self.epoch += 1;
        self.writing = None;
        self.station = Post::recall(self.name.into(), self.epoch, Toy::default(), &self.disk)
            .expect("what a station writes it can read");
    }

    fn effects(&mut self) -> Vec<Effect<Infallible, u64>> {
        std::iter::from_fn(|| self.station.poll_effect()).collect()
    }

    fn heard(&self) -> &[String] {
        &self.station.machine().heard
    }
}

fn go() -> Command {
    Command::Resume("".into())
}

fn stop() -> Command {
    Command::Suspend("".into())
}

fn instruction(effect: &Effect<Infallible, u64>) -> Option<Envelope<Instruction>> {
    match effect {
        Effect::Instruct { message, .. } => Some(message.clone()),
        _ => None,
    }
}

#[test]
fn nothing_starts_before_it_is_written_down() {
    let mut above = Desk::new("above", 1);
    above.command(go());
    assert_eq!(above.effects(), []);
    above.start_writing();
    assert_eq!(above.effects(), []);
    above.end_writing();
    assert_eq!(above.effects().iter().filter_map(instruction).count(), 1);
}

#[test]
fn what_is_decided_while_the_disk_is_busy_waits_for_the_next_writing() {
    let mut above = Desk::new("above", 1);
    above.command(go());
    above.start_writing();
    above.command(go());
    above.end_writing();
    assert_eq!(above.effects().iter().filter_map(instruction).count(), 1);
    above.write();
    assert_eq!(above.effects().iter().filter_map(instruction).count(), 1);
}

#[test]
fn stopping_does_not_wait_for_the_disk() {
    let mut above = Desk::new("above", 1);
    above.command(go());
    above.write();
    above.effects();
    above.command(stop());
    let [Effect::StopAhead { message, .. }] = &above.effects()[..] else {
        panic!("a suspension goes ahead, and alone");
    };
    assert_eq!(message.seq, 2);
    above.write();
    let after = above.effects();
    assert_eq!(
        instruction(&after[0]).map(|m| (m.seq, m.body)),
        Some((2, message.body.clone()))
    );
}

#[test]
fn what_has_not_been_told_to_start_is_not_stopped_ahead() {
    let mut above = Desk::new("above", 1);
    above.command(go());
    above.command(stop());
    assert_eq!(above.effects(), []);
}

#[test]
fn what_starts_only_now_is_stopped_without_waiting_for_another_writing() {
    let mut above = Desk::new("above", 1);
    above.command(go());
    above.start_writing();
    above.command(stop());
    assert_eq!(above.effects(), []);
    above.end_writing();
    let effects = above.effects();
    let [Effect::Instruct { .. }, Effect::StopAhead { message, .. }] = &effects[..] else {
        panic!("what stops it follows at once: {effects:?}");
    };
    assert_eq!((message.seq, message.body.id()), (2, &id(1)));
}

#[test]
fn a_suspension_that_ran_ahead_is_followed_once() {
    let (mut above, mut below) = (Desk::new("above", 1), Desk::new("below", 1));
    above.command(go());
    above.command(stop());
    above.write();
    let sent: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    below.handle(Arrival::Instruction(sent[0].clone()), Some(1));
    below.handle(Arrival::StopAhead(sent[1].clone()), None);
    below.handle(Arrival::Instruction(sent[1].clone()), Some(2));
    below.handle(Arrival::StopAhead(sent[1].clone()), None);
    assert_eq!(below.heard(), ["execute 1", "suspend 1"]);
    below.write();
    let answers: Vec<_> = below
        .effects()
        .into_iter()
        .filter_map(|effect| match effect {
            Effect::Respond {
                to: 2, response, ..
            } => Some(response),
            _ => None,
        })
        .collect();
    let answer = Some(Answer::Suspending);
    assert_eq!(answers, [Response::Applied { seq: 2, answer }]);
}

#[test]
fn a_start_that_was_overtaken_by_its_stop_is_stopped_in_the_same_step() {
    let (mut above, mut below) = (Desk::new("above", 1), Desk::new("below", 1));
    above.command(go());
    above.command(go());
    above.command(stop());
    above.write();
    let sent: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    below.handle(Arrival::Instruction(sent[0].clone()), None);
    // The machine knows nothing of that execution yet; the toy says yes to everything.
    below.station.ahead.insert(
        "above".into(),
        Ahead {
            epoch: 1,
            seq: 3,
            id: id(2),
            stopping: false,
        },
    );
    below.handle(Arrival::Instruction(sent[1].clone()), None);
    assert_eq!(below.heard(), ["execute 1", "execute 2", "suspend 2"]);
    below.handle(Arrival::Instruction(sent[2].clone()), None);
    assert_eq!(below.heard().len(), 3, "its original has been followed");
}

#[test]
fn the_ends_of_goals_are_told_again_after_a_restart_with_the_same_number() {
    let mut above = Desk::new("above", 1);
    above.command(Command::Cancel("tour".into()));
    above.write();
    let told = above.effects();
    assert!(matches!(&told[..], [Effect::Event { number: 1, .. }]));
    above.restart();
    assert_eq!(above.effects(), told);
}

#[test]
fn a_neighbour_without_its_memory_is_noticed_once_from_above_and_from_below() {
    let (mut above, mut below) = (Desk::new("above", 1), Desk::new("below", 1));
    above.command(go());
    above.write();
    let first: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    below.handle(Arrival::Instruction(first[0].clone()), None);
    let mut forgetful = Desk::new("above", 5);
    forgetful.command(go());
    forgetful.command(go());
    forgetful.write();
    for message in forgetful.effects().iter().filter_map(instruction) {
        below.handle(Arrival::Instruction(message), None);
    }
    assert_eq!(
        below.heard(),
        ["execute 1", "reborn above", "execute 1", "execute 2"]
    );

    let answered = |line, seq| Arrival::Answered {
        by: "below".into(),
        line,
        seq,
        answer: Answer::Accepted,
    };
    above.command(go());
    above.command(go());
    above.handle(answered(1, 1), None);
    above.handle(answered(7, 2), None);
    above.handle(answered(7, 3), None);
    above.command(go());
    above.handle(answered(7, 4), None);
    assert_eq!(
        above.heard(),
        ["answer 1", "reborn below", "answer 4"],
        "what the former one was told is given up"
    );
    for line in [7, 9] {
        let name = "below".into();
        above.handle(Arrival::Appeared { name, line }, None);
    }
    assert_eq!(
        above.heard().last().map(String::as_str),
        Some("reborn below")
    );
    assert_eq!(
        above.heard().len(),
        4,
        "noticed once more, by its appearing"
    );
}

#[test]
fn what_was_meant_for_one_who_has_lost_its_memory_is_not_followed_by_the_next() {
    let (mut above, mut below) = (Desk::new("above", 1), Desk::new("below", 4));
    let appeared = |line| Arrival::Appeared {
        name: "below".into(),
        line,
    };
    above.handle(appeared(4), None);
    above.command(go());
    above.command(go());
    above.write();
    let meant: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    let mut next = Desk::new("below", 9);
    next.handle(Arrival::Instruction(meant[0].clone()), Some(1));
    assert!(next.heard().is_empty(), "{:?}", next.heard());
    next.write();
    let rejected = next.effects().into_iter().any(|effect| {
        matches!(
            effect,
            Effect::Respond {
                response: Response::Applied {
                    answer: Some(Answer::Rejected { .. }),
                    ..
                },
                ..
            }
        )
    });
    assert!(rejected);
    below.handle(Arrival::Instruction(meant[0].clone()), None);
    assert_eq!(below.heard(), ["execute 1"]);

    above.command(go());
    above.handle(appeared(9), None);
    above.command(go());
    above.write();
    let sent: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    assert_eq!(
        sent.iter().map(|m| (m.seq, m.to_line)).collect::<Vec<_>>(),
        [(4, 9)]
    );
    above.restart();
    let again: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    assert_eq!(
        again.len(),
        1,
        "only what is meant for the new one is sent again"
    );
    next.handle(Arrival::Instruction(again[0].clone()), None);
    assert_eq!(next.heard(), ["execute 4"]);
}

#[test]
fn a_journal_with_a_damaged_row_is_not_recalled() {
    let mut above = Desk::new("above", 1);
    above.command(go());
    above.write();
    for key in above.disk.keys().cloned().collect::<Vec<_>>() {
        let mut rows = above.disk.clone();
        let bytes = rows.get_mut(&key).expect("its key was just listed");
        bytes.push(0);
        let recalled = Post::recall("above".into(), 2, Toy::default(), &rows);
        assert_eq!(recalled.map(|_| ()).unwrap_err().key, key);
    }
}

#[test]
fn a_resumption_that_was_overtaken_by_the_next_stop_is_stopped_and_only_then_reported() {
    let (mut above, mut below) = (Desk::new("above", 1), Desk::new("below", 1));
    above.command(go());
    above.command(stop());
    above.write();
    let mut sent: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    for message in sent.drain(..) {
        below.handle(Arrival::Instruction(message), None);
    }
    let message = |seq, body| Envelope {
        from: "above".into(),
        line: 1,
        epoch: 1,
        seq,
        settled: 0,
        to_line: 0,
        body,
    };
    let resume = Instruction::Resume {
        id: id(1),
        map: None,
    };
    let suspend = Instruction::Suspend { id: id(1) };
    below.handle(Arrival::StopAhead(message(4, suspend.clone())), None);
    assert_eq!(below.heard(), ["execute 1", "suspend 1"], "it stands");
    below.handle(Arrival::Instruction(message(3, resume)), None);
    below.handle(Arrival::Instruction(message(4, suspend)), None);
    assert_eq!(below.heard()[2..], ["resume 1", "suspend 1"]);
}
