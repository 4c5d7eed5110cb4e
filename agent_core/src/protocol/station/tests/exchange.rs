//! Two stations, a wire that loses, repeats and reorders, and processes that die at any moment.
//!
//! `EXCHANGES=30000 cargo test -p agent_core exchange` plays more of them; `EXCHANGE=7` only the one of that seed.

use super::*;
use crate::protocol::ReportBody;

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % sides as u64) as usize
    }
}

/// What is on the wire between two desks.
#[derive(Clone, Debug)]
enum Letter {
    Down(Envelope<Instruction>),
    Ahead(Envelope<Instruction>),
    Up(Envelope<ReportBody>),
    /// From `below`.
    Answered(Arrival<Infallible>),
    /// From `above`.
    Delivered(Arrival<Infallible>),
}

impl Letter {
    /// The number that is answered.
    fn seq(&self) -> Option<u64> {
        match self {
            Self::Down(message) => Some(message.seq),
            Self::Up(message) => Some(message.seq),
            Self::Ahead(_) | Self::Answered(_) | Self::Delivered(_) => None,
        }
    }
}

const ABOVE: usize = 0;
const BELOW: usize = 1;

struct Exchange {
    desks: [Desk; 2],
    wire: Vec<Letter>,
    /// What each process goes on sending until it is answered.
    sending: [Vec<Letter>; 2],
}

impl Exchange {
    fn new() -> Self {
        Self {
            desks: [Desk::new("above", 1), Desk::new("below", 1)],
            wire: Vec::new(),
            sending: [Vec::new(), Vec::new()],
        }
    }

    fn restart(&mut self, who: usize) {
        self.desks[who].restart();
        self.sending[who].clear();
    }

    /// The oldest message that is not answered goes out, again.
    fn send(&mut self, who: usize) {
        self.wire.extend(self.sending[who].first().cloned());
    }

    fn deliver(&mut self, letter: Letter) {
        match letter {
            Letter::Down(m) => self.desks[BELOW].handle(Arrival::Instruction(m), Some(0)),
            Letter::Ahead(m) => self.desks[BELOW].handle(Arrival::StopAhead(m), None),
            Letter::Up(m) => self.desks[ABOVE].handle(Arrival::Report(m), Some(0)),
            Letter::Answered(answer) => self.answered(ABOVE, answer),
            Letter::Delivered(answer) => self.answered(BELOW, answer),
        }
    }

    fn answered(&mut self, who: usize, arrival: Arrival<Infallible>) {
        if let Arrival::Answered { seq, .. } | Arrival::Delivered { seq, .. } = &arrival
            && self.sending[who].first().and_then(Letter::seq) == Some(*seq)
        {
            self.sending[who].remove(0);
        }
        self.desks[who].handle(arrival, None);
    }

    /// What the processes may say now goes onto the wire.
    fn pump(&mut self) {
        for who in [ABOVE, BELOW] {
            for effect in self.desks[who].effects() {
                match effect {
                    Effect::Instruct { message, .. } => {
                        self.sending[who].push(Letter::Down(message));
                    }
                    Effect::Report { message, .. } => self.sending[who].push(Letter::Up(message)),
                    Effect::StopAhead { message, .. } => self.wire.push(Letter::Ahead(message)),
                    Effect::Respond { response, line, .. } => self.respond(who, response, line),
                    other => panic!("nobody decided {other:?}"),
                }
            }
        }
    }

    fn respond(&mut self, who: usize, response: Response, line: u64) {
        let by = self.desks[who].name.into();
        let Response::Applied { seq, answer } = response else {
            assert!(
                matches!(response, Response::Gap { .. } | Response::Superseded { .. }),
                "{response:?}"
            );
            return;
        };
        self.wire.push(if who == ABOVE {
            Letter::Delivered(Arrival::Delivered { by, line, seq })
        } else if let Some(answer) = answer {
            Letter::Answered(Arrival::Answered {
                by,
                line,
                seq,
                answer,
            })
        } else {
            // A copy of what was answered and written down long since.
            return;
        });
    }

    fn heard(&self, who: usize, what: &str) -> Vec<u64> {
        let all = self.desks[who].heard().iter();
        all.filter_map(|line| line.strip_prefix(what)?.trim().parse().ok())
            .collect()
    }
}

fn wild_exchange(seed: u64) {
    let mut dice = Dice(seed);
    let mut exchange = Exchange::new();
    let mut begun = 0;
    for _ in 0..250 {
        let who = dice.roll(2);
        match dice.roll(12) {
            0 if begun < 6 => {
                begun += 1;
                exchange.desks[ABOVE].command(go());
            }
            1 if begun > 0 => exchange.desks[ABOVE].command(stop()),
            2 => exchange.restart(who),
            3 => exchange.desks[who].start_writing(),
            4 => exchange.desks[who].end_writing(),
            5 if !exchange.wire.is_empty() => {
                let lost = dice.roll(exchange.wire.len());
                exchange.wire.swap_remove(lost);
            }
            6 if !exchange.wire.is_empty() => {
                let repeated = exchange.wire[dice.roll(exchange.wire.len())].clone();
                exchange.wire.push(repeated);
            }
            7 => exchange.send(who),
            _ if !exchange.wire.is_empty() => {
                let any = dice.roll(exchange.wire.len());
                let letter = exchange.wire.swap_remove(any);
                exchange.deliver(letter);
            }
            _ => {}
        }
        exchange.pump();
    }
    // Nobody dies and nothing is lost any more.
    for _ in 0..200 {
        for who in [ABOVE, BELOW] {
            exchange.desks[who].write();
            exchange.pump();
            exchange.send(who);
            for letter in std::mem::take(&mut exchange.wire) {
                exchange.deliver(letter);
            }
        }
    }
    let given: Vec<u64> = (1..=exchange.desks[ABOVE].station.machine().next).collect();
    let (applied, told) = (
        exchange.heard(BELOW, "execute"),
        exchange.heard(ABOVE, "started"),
    );
    assert_eq!(applied, given, "seed {seed}: applied once and in order");
    assert_eq!(told, given, "seed {seed}: told once and in order");
    let left = exchange.sending.iter().map(Vec::len).sum::<usize>();
    assert_eq!(left, 0, "seed {seed}: all is answered");
    for desk in &mut exchange.desks {
        desk.write();
        let (mut rows, before) = (desk.disk.clone(), desk.heard().to_vec());
        desk.restart();
        assert_eq!(desk.heard(), before, "seed {seed}");
        desk.write();
        // Every start has an epoch of its own.
        rows.remove("s/epoch");
        desk.disk.remove("s/epoch");
        assert_eq!(
            desk.disk, rows,
            "seed {seed}: what is recalled is what was written"
        );
    }
}

#[test]
fn whatever_is_lost_or_repeated_and_whoever_dies_each_instruction_is_applied_once_in_order() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse().ok());
    if let Some(seed) = number("EXCHANGE") {
        return wild_exchange(seed);
    }
    for seed in 0..number("EXCHANGES").unwrap_or(2000) {
        wild_exchange(seed);
    }
}
