//! A story in words.

use crate::boss::goal;
use crate::happen::Left;
use crate::letter::Side;
use crate::model::{Protocol, Step};
use crate::state::State;

impl Protocol {
    /// In words, what a step does.
    pub fn tell(&self, state: &State, step: &Step) -> String {
        let tables = &*self.tables;
        let letter = |place: usize| {
            let letter = state.wire.get(place);
            let words = letter.map(|letter| tables.letter(*letter).to_string());
            words.unwrap_or_default()
        };
        let world = tables.world(state.world);
        match step {
            Step::Ask(number) => format!("a user asks for {}", goal(*number)),
            Step::Deliver(place) => format!("arrives: {}", letter(*place)),
            Step::DeliverOneOfTwo(place) => {
                format!("arrives, AND WILL AGAIN: {}", letter(*place))
            }
            Step::Lose(place) => format!("IS LOST: {}", letter(*place)),
            Step::RepeatUnheard(side, place) => {
                let lost = letter(*place);
                format!(
                    "IS LOST: {lost}; the {} repeats what it answers",
                    side.name()
                )
            }
            Step::Repeat(side) => format!("the {} repeats what is not answered", side.name()),
            Step::Written(side) => format!("the {}'s disk has it", side.name()),
            Step::Finish => {
                let doing = world.doing.as_ref().map(|(.., action)| action.to_string());
                format!("the world has done {}", doing.unwrap_or_default())
            }
            Step::Sense => format!("the arm hears {:?}", world.says.front()),
            Step::Notice => {
                let how = match state.notices % 2 {
                    0 => "gone",
                    _ => "there",
                };
                format!(
                    "the {} hears that the {} is {how}",
                    Side::Arm.name(),
                    Side::Boss.name()
                )
            }
            Step::Crash(side, left) => {
                let what = match left {
                    Left::Before => "and starts again from what was written before".to_owned(),
                    Left::All(sent) => format!(
                        "after a writing, when {sent} effects of it had got out, and starts again"
                    ),
                };
                format!("THE {} DIES {what}", side.name())
            }
        }
    }
}
