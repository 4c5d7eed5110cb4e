//! What a station writes down of itself, and how it comes back from that.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::mailboxes::Sending;
use super::{Effect, Station};
use crate::model::Symbol;
use crate::protocol::delivery::{Heard, Inbox, Outbox};
use crate::protocol::durable::{Durable, Ledger, Row, Rows, Unreadable, read_row, read_rows};
use crate::protocol::{Answer, Event};

const LINE: &str = "s/line";
const EPOCH: &str = "s/epoch";
const NEXT_EVENT: &str = "s/next-event";
const EVENT: &str = "s/event/";
const OBSERVED: &str = "s/observed/";
const SEEN: &str = "s/seen/";
const NEIGHBOUR: &str = "s/neighbour/";
const INSTRUCTIONS_IN: &str = "s/in/instruction/";
const REPORTS_IN: &str = "s/in/report/";
const LOCAL_IN: &str = "s/in/local/";
const INSTRUCTIONS_OUT: &str = "s/out/instruction/";
const REPORTS_OUT: &str = "s/out/report/";

/// The epoch of the last start of the station that has written these rows; `None` if none has. That
/// of the next start must be greater.
///
/// # Errors
/// If the row cannot be read.
pub fn last_epoch(rows: &Rows) -> Result<Option<u64>, Unreadable> {
    read_row(rows, EPOCH)
}

impl<M: Durable, T> Station<M, T>
where
    M::Out: Clone,
{
    /// For a machine that has just been made, in a new epoch: with all that one of its name has
    /// written down, if that is anything.
    ///
    /// What was not acknowledged is sent again, and the last ends of goals are told again.
    ///
    /// # Errors
    /// If a row cannot be read, or does not fit the machine.
    pub fn recall(
        name: Symbol,
        epoch: u64,
        mut machine: M,
        rows: &Rows,
    ) -> Result<Self, Unreadable> {
        let Some(line) = read_row(rows, LINE)? else {
            return Ok(Self::new(name, epoch, machine));
        };
        let _: Option<u64> = read_row(rows, EPOCH)?;
        machine.recall(rows)?;
        let mut station = Self::new(name, epoch, machine);
        // What the machine has said at its start stands behind what it had said before.
        let first = std::mem::take(&mut station.held);
        station.line = line;
        station.ledger = Ledger::of(rows, "s/");
        station.next_event = read_row(rows, NEXT_EVENT)?.unwrap_or(1);
        for row in read_rows::<Event>(rows, EVENT) {
            let (number, event) = row?;
            let number = parse(EVENT, number)?;
            station.last_ends.push_back((number, event.clone()));
            station.ready.push_back(Effect::Event { number, event });
        }
        for row in read_rows(rows, OBSERVED) {
            let (_, (facts, reported_to)) = row?;
            station
                .ready
                .push_back(Effect::Observed { facts, reported_to });
        }
        for row in read_rows(rows, SEEN) {
            let (_, (to, facts, reported)) = row?;
            station.ready.push_back(Effect::Seen {
                to,
                facts,
                reported,
            });
        }
        for row in read_rows(rows, NEIGHBOUR) {
            let (neighbour, line) = row?;
            station.neighbours.insert(neighbour.into(), line);
        }
        station.mailboxes.instructions_in = inbox(rows, INSTRUCTIONS_IN)?;
        station.mailboxes.reports_in = inbox(rows, REPORTS_IN)?;
        station.mailboxes.local_in = inbox(rows, LOCAL_IN)?;
        station.mailboxes.instructions_out = outboxes(rows, INSTRUCTIONS_OUT)?;
        station.mailboxes.reports_out = outboxes(rows, REPORTS_OUT)?;
        station.send_again();
        for (_, effect) in first {
            station.say_at_start(effect);
        }
        Ok(station)
    }

    fn send_again(&mut self) {
        let instructions = self.mailboxes.instructions_out.iter();
        let instructions: Vec<_> = instructions
            .flat_map(|(to, sending)| sending.outbox.waiting().map(move |m| (to, m)))
            .map(|(to, (seq, body))| Effect::Instruct {
                to: to.clone(),
                message: self.envelope(seq, body.clone()),
            })
            .collect();
        let reports = self.mailboxes.reports_out.iter();
        let reports: Vec<_> = reports
            .flat_map(|(to, sending)| sending.outbox.waiting().map(move |m| (to, m)))
            .map(|(to, (seq, body))| Effect::Report {
                to: to.clone(),
                message: self.envelope(seq, body.clone()),
            })
            .collect();
        self.ready.extend(instructions);
        self.ready.extend(reports);
    }

    /// What the machine has said when it recalled, numbered behind what it had said before.
    fn say_at_start(&mut self, effect: Effect<M::Out, T>) {
        match effect {
            Effect::Instruct { to, message } => self.send_instruction(to, message.body),
            Effect::Report { to, message } => {
                let seq = self.mailboxes.push_report(&to, message.body.clone());
                let message = self.envelope(seq, message.body);
                self.hold(Effect::Report { to, message });
            }
            Effect::Event { event, .. } => self.tell_event(event),
            other => self.hold(other),
        }
    }

    /// The rows of the station itself that are different.
    pub(super) fn own_rows(&mut self) -> Vec<Row> {
        let (ledger, noted) = (&mut self.ledger, &mut self.noted);
        if noted.next_event == 0 {
            ledger.put(LINE.to_owned(), &self.line);
            ledger.put(EPOCH.to_owned(), &self.epoch);
        }
        if renew(&mut noted.next_event, self.next_event) {
            ledger.put(NEXT_EVENT.to_owned(), &self.next_event);
        }
        let last_end = self.last_ends.back().map(|(number, _)| *number);
        if renew(&mut noted.last_end, last_end) {
            let mut keys = BTreeSet::new();
            for (number, event) in &self.last_ends {
                let key = format!("{EVENT}{number:020}");
                put_once(ledger, &mut keys, key, event);
            }
            ledger.keep_only(EVENT, &keys);
        }
        // It goes out once this is written, unless the process dies just then.
        let mut keys = BTreeSet::new();
        let mut seen = BTreeSet::new();
        for (_, effect) in &self.held {
            match effect {
                Effect::Observed { facts, reported_to } => {
                    let key = format!("{OBSERVED}{:020}", keys.len());
                    ledger.put(key.clone(), &(facts, reported_to));
                    keys.insert(key);
                }
                Effect::Seen {
                    to,
                    facts,
                    reported,
                } => {
                    let key = format!("{SEEN}{:020}", seen.len());
                    ledger.put(key.clone(), &(to, facts, reported));
                    seen.insert(key);
                }
                _ => {}
            }
        }
        if renew(&mut noted.observed, Some(keys.len())) || !keys.is_empty() {
            ledger.keep_only(OBSERVED, &keys);
        }
        if renew(&mut noted.seen, Some(seen.len())) || !seen.is_empty() {
            ledger.keep_only(SEEN, &seen);
        }
        for (name, line) in &self.neighbours {
            if noted.neighbours.renew(name, *line) {
                ledger.put(format!("{NEIGHBOUR}{name}"), line);
            }
        }
        let boxes = &self.mailboxes;
        let [instructions_out, reports_out] = &mut noted.outboxes;
        let [instructions, reports, local] = &mut noted.inboxes;
        put_inbox(
            ledger,
            instructions,
            INSTRUCTIONS_IN,
            &boxes.instructions_in,
        );
        put_inbox(ledger, reports, REPORTS_IN, &boxes.reports_in);
        put_inbox(ledger, local, LOCAL_IN, &boxes.local_in);
        for (to, sending) in &boxes.instructions_out {
            put_outbox(
                ledger,
                instructions_out,
                INSTRUCTIONS_OUT,
                to,
                &sending.outbox,
            );
        }
        for (to, sending) in &boxes.reports_out {
            put_outbox(ledger, reports_out, REPORTS_OUT, to, &sending.outbox);
        }
        ledger.take()
    }
}

/// Of everything that is written down, what is different whenever that is: so what is still the
/// same need not be looked at. At first, and after a start, nothing is noted.
#[derive(Clone, Debug, Default)]
pub(super) struct Noted {
    /// Never 0 once it is noted.
    next_event: u64,
    last_end: Option<u64>,
    observed: Option<usize>,
    /// How many wait that are for one superior.
    seen: Option<usize>,
    neighbours: Marks<u64>,
    /// Those of instructions, reports and what is local.
    inboxes: [Marks<(u64, u64, u64)>; 3],
    /// Those of instructions and reports.
    outboxes: [Marks<(u64, u64)>; 2],
}

/// One mark for each neighbour.
#[derive(Clone, Debug)]
struct Marks<T>(BTreeMap<Symbol, T>);

impl<T> Default for Marks<T> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<T: Copy + PartialEq> Marks<T> {
    fn of(&self, neighbour: &Symbol) -> Option<T> {
        self.0.get(neighbour).copied()
    }

    /// Whether it was not this before.
    fn renew(&mut self, of: &Symbol, mark: T) -> bool {
        match self.0.get_mut(of) {
            Some(known) => renew(known, mark),
            None => {
                self.0.insert(of.clone(), mark);
                true
            }
        }
    }
}

/// Whether it was not this before.
fn renew<T: PartialEq>(known: &mut T, now: T) -> bool {
    let differs = *known != now;
    *known = now;
    differs
}

/// What is never changed once it is written needs no comparing.
fn put_once<V: Serialize>(
    ledger: &mut Ledger,
    keys: &mut BTreeSet<String>,
    key: String,
    value: &V,
) {
    if !ledger.has(&key) {
        ledger.put(key.clone(), value);
    }
    keys.insert(key);
}

fn put_inbox(
    ledger: &mut Ledger,
    marks: &mut Marks<(u64, u64, u64)>,
    prefix: &str,
    inbox: &Inbox<Answer>,
) {
    for (from, heard) in inbox.senders() {
        if marks.renew(from, heard.mark()) {
            ledger.put(format!("{prefix}{from}"), heard);
        }
    }
}

/// The number of the next message at `…/<receiver>`, and what waits at `…/<receiver>/<number>`.
fn put_outbox<B: Serialize>(
    ledger: &mut Ledger,
    marks: &mut Marks<(u64, u64)>,
    prefix: &str,
    to: &Symbol,
    outbox: &Outbox<B>,
) {
    let known = marks.of(to);
    let (first, next) = outbox.extent();
    if !marks.renew(to, (first, next)) {
        return;
    }
    let key = |seq| format!("{prefix}{to}/{seq:020}");
    let (known_first, known_next) = match known {
        Some(known) => known,
        None => {
            // Whatever is there from before this start.
            let keys = (first..next).map(key).collect();
            ledger.keep_only(&format!("{prefix}{to}/"), &keys);
            (first, 0)
        }
    };
    if next != known_next {
        ledger.put(format!("{prefix}{to}"), &next);
    }
    for seq in known_first..first.min(known_next) {
        ledger.remove(&key(seq));
    }
    for (seq, body) in outbox.waiting().filter(|(seq, _)| *seq >= known_next) {
        // It may have been recalled.
        if !ledger.has(&key(seq)) {
            ledger.put(key(seq), body);
        }
    }
}

fn inbox(rows: &Rows, prefix: &str) -> Result<Inbox<Answer>, Unreadable> {
    let mut senders = Vec::new();
    for row in read_rows::<Heard<Answer>>(rows, prefix) {
        let (from, heard) = row?;
        senders.push((Symbol::from(from), heard));
    }
    Ok(Inbox::with(senders))
}

fn outboxes<B: DeserializeOwned>(
    rows: &Rows,
    prefix: &str,
) -> Result<BTreeMap<Symbol, Sending<B>>, Unreadable> {
    let heads = rows
        .range(prefix.to_owned()..)
        .map_while(|(key, _)| key.strip_prefix(prefix))
        .filter(|rest| !rest.contains('/'));
    let mut outboxes = BTreeMap::new();
    for to in heads {
        let key = format!("{prefix}{to}");
        let next_seq = read_row(rows, &key)?.unwrap_or(1);
        let mut waiting = Vec::new();
        let messages = format!("{key}/");
        for row in read_rows::<B>(rows, &messages) {
            let (seq, body) = row?;
            waiting.push((parse(&messages, seq)?, body));
        }
        let outbox = Outbox::with(next_seq, waiting)
            .ok_or_else(|| Unreadable::new(key, "messages that it speaks of are missing"))?;
        outboxes.insert(Symbol::from(to), Sending::of(outbox));
    }
    Ok(outboxes)
}

fn parse(prefix: &str, number: &str) -> Result<u64, Unreadable> {
    number
        .parse()
        .map_err(|error| Unreadable::new(format!("{prefix}{number}"), error))
}
