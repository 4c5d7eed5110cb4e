//! What executors answer, and what superiors make of it.

use agent_core::model::Time;
use agent_core::protocol::{Answer, Instruction};

use super::Law;
use crate::process::Role;
use crate::scenario::Who;

/// An instruction: who was told, in which line, by whom, in which line, and its number.
pub type Told = (Who, u64, Who, u64, u64);

impl Law {
    /// Whether that instruction was answered before.
    pub fn was_answered(&self, told: Told) -> bool {
        self.answers.contains_key(&told)
    }

    /// An instruction that comes again is answered as it was, whoever was killed meanwhile.
    pub fn answers(&mut self, now: Time, told: Told, answer: &Answer) {
        match self.answers.get(&told) {
            None => {
                self.answers.insert(told, answer.clone());
            }
            Some(before) if before == answer => {}
            Some(before) => {
                let (who, _, superior, _, number) = told;
                let before = format!("{before:?}");
                self.broken(now, || {
                    format!(
                        "{who} answers {superior}'s #{number} {answer:?}, after it had answered {before}"
                    )
                });
            }
        }
    }

    /// Whoever was told by an answer how something has ended waits for no report of it, which
    /// may be long in coming.
    pub fn heeds(
        &mut self,
        now: Time,
        who: Who,
        role: &Role,
        instruction: &Instruction,
        answer: &Answer,
    ) {
        let executing = role.as_agent().and_then(|agent| agent.executing());
        if let Answer::Finished { .. } = answer
            && executing.is_some_and(|(id, ..)| id == instruction.id())
        {
            let id = instruction.id();
            self.broken(now, || {
                format!("{who} was answered how {id} has ended, and has it done still")
            });
        }
    }
}
