//! What one of the two does when something happens to it, and what it says then.

use agent_core::model::Symbol;
use agent_core::protocol::{
    ActionId, Answer, Arrival, Effect, Input, Instruction, Response, Unreadable,
};

use crate::boss::{Bosses, request};
use crate::fence::Fence;
use crate::letter::{Letter, Side, Way};
use crate::mutant::Mutant;
use crate::node::Node;
use crate::role::Role;
use crate::world::{Motor, Sensor};

/// All memories begin at the first start: none is lost here.
const LINE: u64 = 1;

/// Something that happens to one of the two.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A user asks for that goal.
    Ask(usize),
    /// A letter arrives.
    Arrives(Box<Letter>),
    /// What was being written is on the disk.
    Written,
    /// It hears the world.
    Hears(Sensor),
    /// Its neighbour is there, or is not.
    Neighbour(bool),
    /// Its neighbour was gone and is there again.
    Again,
    /// It dies and starts again.
    Dies(Left),
    /// Nobody dies any more.
    Spared,
}

/// What a crash in the middle of a writing leaves.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Left {
    /// What had been written before.
    Before,
    /// All of it, and that many of the effects that waited for it got out.
    All(u8),
}

/// What comes of it outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// A letter is on the wire.
    Letter(Letter),
    /// A user was told that the goal is accepted.
    Acknowledged(usize),
    /// The motors were told something.
    Motor(Motor),
    /// It has heard that an execution will not be resumed.
    Cleared(ActionId),
    /// It has died; what follows comes from the next process.
    Died,
    /// Something that must not be.
    Broken(String),
}

/// What every step needs.
#[derive(Clone, Debug)]
pub struct Rules {
    /// What makes superiors.
    pub bosses: Bosses,
    /// What is wrong on purpose.
    pub mutant: Option<Mutant>,
}

impl Rules {
    /// One that has just started for the first time, and what it says.
    pub fn first<M: Role>(&self) -> (Node<M>, Vec<Said>) {
        let machine = M::make(&self.bosses, LINE);
        let node = Node::start(LINE, machine, Default::default());
        let mut said = Vec::new();
        let node = self.greeted(node.expect("an empty disk can be read"), &mut said);
        (node, said)
    }

    /// What becomes of it, and what it says.
    pub fn happens<M: Role>(&self, node: &Node<M>, event: Event) -> (Node<M>, Vec<Said>) {
        let mut said = Vec::new();
        let mut node = node.clone();
        match event {
            Event::Ask(number) => {
                let input = Input::Goal(request(number));
                node.take(Arrival::Input(input), Some(Way::User(number)));
            }
            Event::Arrives(letter) => self.arrives(&mut node, *letter, &mut said),
            Event::Written => {
                if self.mutant == Some(Mutant::Unwritten) {
                    node.flight = node.flight.take().map(|_| Vec::new());
                }
                node.written();
            }
            Event::Hears(sensor) => {
                if let Some(sensor) = M::hears(sensor) {
                    node.take(Arrival::Input(Input::Local(sensor)), None);
                }
            }
            Event::Neighbour(there) => node.take(neighbour::<M>(there), None),
            Event::Again => {
                node.take(neighbour::<M>(false), None);
                node.take(neighbour::<M>(true), None);
            }
            Event::Dies(left) => return self.dies(node, left),
            Event::Spared => {
                node.is_spared = true;
                return (node, said);
            }
        }
        self.pump(&mut node, &mut said);
        (node, said)
    }

    /// How many effects wait for the writing that is under way.
    pub fn released<M: Role>(&self, node: &Node<M>) -> u8 {
        let mut node = node.clone();
        node.written();
        let effects = node.effects(false).len().saturating_sub(1);
        u8::try_from(effects).unwrap_or(u8::MAX)
    }

    /// As it is found after a restart, before it has said anything.
    pub fn recalled<M: Role>(&self, node: &Node<M>) -> Result<Node<M>, Unreadable> {
        let epoch = node.epoch + 1;
        let machine = M::make(&self.bosses, epoch);
        Node::start(epoch, machine, Mutant::found(self.mutant, &node.disk))
    }

    fn arrives<M: Role>(&self, node: &mut Node<M>, letter: Letter, said: &mut Vec<Said>) {
        if M::SIDE == Side::Arm {
            Fence::arrives(node, &letter);
        }
        if Mutant::ignores(self.mutant, &letter) {
            return;
        }
        if let Some(again) = Mutant::again(self.mutant, node, &letter) {
            node.take(again, None);
        }
        let (arrival, way) = match letter {
            Letter::Response { response, line, .. } => {
                return self.answered(node, response, line, said);
            }
            Letter::StopAhead(message) => (Arrival::StopAhead(message), None),
            Letter::Instruction(message) => {
                let way = Way::Neighbour {
                    epoch: message.epoch,
                };
                (Arrival::Instruction(message), Some(way))
            }
            Letter::Report(message) => {
                let way = Way::Neighbour {
                    epoch: message.epoch,
                };
                (Arrival::Report(message), Some(way))
            }
        };
        node.take(arrival, way);
    }

    /// The first of what it was sending is answered.
    fn answered<M: Role>(
        &self,
        node: &mut Node<M>,
        response: Response,
        line: u64,
        said: &mut Vec<Said>,
    ) {
        let (seq, answer) = match response {
            Response::Applied { seq, answer } => (seq, answer),
            Response::Superseded { seq } => {
                let who = M::SIDE.name();
                let what = format!("S8: message {seq} of the {who} is refused");
                return said.push(Said::Broken(what));
            }
            _ => return,
        };
        let answer = answer.map(|answer| Mutant::answered(self.mutant, answer));
        if let Some(Letter::Instruction(message)) = node.queue.pop_front()
            && let Instruction::Clear { id } = message.body
            && !matches!(answer, Some(Answer::Rejected { .. }))
        {
            said.push(Said::Cleared(id));
        }
        let by = M::SIDE.other().name().into();
        let arrival = match M::SIDE {
            Side::Boss => Arrival::Answered {
                by,
                line,
                seq,
                answer: answer.unwrap_or(Answer::Accepted),
            },
            Side::Arm => Arrival::Delivered { by, line, seq },
        };
        node.take(arrival, None);
        said.extend(node.queue.front().cloned().map(Said::Letter));
    }

    fn dies<M: Role>(&self, mut node: Node<M>, left: Left) -> (Node<M>, Vec<Said>) {
        let mut said = Vec::new();
        if let Left::All(sent) = left {
            node.written();
            let mut effects = node.effects(false);
            effects.truncate(usize::from(sent));
            told(&mut node, effects, &mut said);
        }
        said.push(Said::Died);
        let node = match self.recalled(&node) {
            Ok(node) => self.greeted(node, &mut said),
            Err(error) => {
                said.push(Said::Broken(error.to_string()));
                node
            }
        };
        (node, said)
    }

    /// Whoever starts sees its neighbour at once.
    fn greeted<M: Role>(&self, mut node: Node<M>, said: &mut Vec<Said>) -> Node<M> {
        self.pump(&mut node, said);
        node.take(neighbour::<M>(true), None);
        self.pump(&mut node, said);
        node
    }

    /// What it has to say goes out.
    fn pump<M: Role>(&self, node: &mut Node<M>, said: &mut Vec<Said>) {
        let effects = node.effects(self.mutant == Some(Mutant::Hasty));
        let before = said.len();
        told(node, effects, said);
        let what = Fence::is_run_over(node, &said[before..]);
        said.extend(what.map(Said::Broken));
    }
}

/// These effects get out.
fn told<M: Role>(node: &mut Node<M>, effects: Vec<Effect<M::Out, Way>>, said: &mut Vec<Said>) {
    for effect in effects {
        let letter = match effect {
            Effect::Instruct { message, .. } => Letter::Instruction(message),
            Effect::Report { mut message, .. } => {
                // Nobody keeps answers to reports, so it is the same to everybody how far they are
                // written down.
                message.settled = 0;
                Letter::Report(message)
            }
            Effect::StopAhead { message, .. } => {
                said.push(Said::Letter(Letter::StopAhead(message)));
                continue;
            }
            Effect::Local(message) => {
                said.push(Said::Motor(M::tells(message.body)));
                continue;
            }
            Effect::Respond { to, response, line } => {
                said.push(responded(M::SIDE.other(), to, response, line));
                continue;
            }
            Effect::Observed { .. } | Effect::Seen { .. } | Effect::Event { .. } => continue,
        };
        node.queue.push_back(letter.clone());
        // The others follow when it is answered.
        if node.queue.len() == 1 {
            said.push(Said::Letter(letter));
        }
    }
}

fn responded(to: Side, way: Way, response: Response, line: u64) -> Said {
    match (way, response) {
        (Way::User(number), Response::Goal(Ok(_))) => Said::Acknowledged(number),
        (Way::User(_), response) => Said::Broken(format!("a goal is answered {response:?}")),
        (Way::Neighbour { epoch }, response) => Said::Letter(Letter::Response {
            to,
            epoch,
            response,
            line,
        }),
    }
}

fn neighbour<M: Role>(there: bool) -> Arrival<M::In> {
    let name: Symbol = M::SIDE.other().name().into();
    match there {
        true => Arrival::Appeared { name, line: LINE },
        false => Arrival::Input(Input::Neighbour { name, there }),
    }
}
