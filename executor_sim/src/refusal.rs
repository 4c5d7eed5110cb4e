//! What is answered to messages that are not for a robot or its world.

use agent_core::protocol::{Answer, Input, Rejection, Reply};

/// A reply to whoever waits for one. Goals and commands are for agents.
pub(crate) fn refuse<L>(input: Input<L>, who: &str) -> Option<Reply> {
    match input {
        Input::Goal(goal) => {
            let rejection = goal.tasks.first().map_or(Rejection::NoTask, |task| {
                Rejection::UnknownTask(
                    task.name.clone(),
                    format!("no tasks at all; {who} is not an agent"),
                )
            });
            Some(Reply::Goal(Err(rejection)))
        }
        Input::Command(command) => {
            let (agent_core::protocol::Command::Suspend(goal)
            | agent_core::protocol::Command::Resume(goal)
            | agent_core::protocol::Command::Cancel(goal)) = command;
            Some(Reply::Command(Err(Rejection::UnknownGoal(goal))))
        }
        Input::Instruction { .. } => Some(Reply::Instruction(Answer::Rejected {
            reason: format!("{who} takes no instructions"),
        })),
        Input::Answer { .. }
        | Input::Report { .. }
        | Input::Observation(_)
        | Input::Neighbour { .. }
        | Input::Reborn { .. }
        | Input::Wake
        | Input::Local(_) => None,
    }
}
