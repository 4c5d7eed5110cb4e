//! What must hold of a text or a message from outside, whatever it is. The corpus is read with the same functions in the
//! ordinary tests. Each returns whether the input was understood.

use agent_core::protocol::{Command, GoalRequest, Urgency};

/// The wire types, as `agent_link` has them.
use crate::wire::{self, Acknowledgement, Message, Observed, ReportBody};

/// What a user may put: a goal, a command, facts.
pub fn from_user(bytes: &[u8]) -> bool {
    let mut understood = false;
    for urgency in [Urgency::Normal, Urgency::Emergency] {
        if let Ok(goal) = wire::goal_from_user(urgency, bytes) {
            understood = true;
            let text = wire::goal_to_wire(&goal).expect("a goal that was read can be written");
            let again = wire::goal_from_user(urgency, text.as_bytes());
            let again: GoalRequest = again.expect("and read again");
            // A deadline may be rounded once, and not twice.
            let twice = wire::goal_to_wire(&again).expect("and written again");
            let thrice = wire::goal_from_user(urgency, twice.as_bytes()).expect("and read");
            assert_eq!(again, thrice);
        }
    }
    if let Ok(command) = wire::command_from_user(bytes) {
        understood = true;
        let text = wire::command_to_wire(&command).expect("a command can be written");
        let again: Command = wire::command_from_user(text.as_bytes()).expect("and read again");
        assert_eq!(command, again);
    }
    understood | wire::facts_from_user(bytes).is_ok()
}

/// What agents send to each other, and what they tell.
pub fn from_agents(bytes: &[u8]) -> bool {
    let mut understood = false;
    if let Ok(message) = wire::read::<Message<serde_json::Value>>("message", bytes) {
        let envelope = agent_core::protocol::Envelope::from(message);
        let body = || envelope.body.clone();
        if let Ok(instruction) = wire::body::<wire::Instruction>("instruction", body()) {
            understood = true;
            let core: agent_core::protocol::Instruction = instruction.into();
            let value = wire::to_value(&wire::Instruction::from(&core)).expect("it can be written");
            let again = wire::body::<wire::Instruction>("instruction", value);
            let again: agent_core::protocol::Instruction = again.expect("and read again").into();
            assert_eq!(core, again);
        }
        if let Ok(report) = wire::body::<ReportBody>("report", body()) {
            understood = true;
            let core: agent_core::protocol::Report = report.report.into();
            let _ = wire::Report::from(&core);
        }
    }
    understood |= wire::read::<Acknowledgement>("answer", bytes).is_ok();
    if let Ok(observed) = wire::read::<Observed>("facts", bytes) {
        understood = true;
        let _ = observed.into_facts();
    }
    if let Ok((agent, event)) = wire::event_from_line(bytes) {
        understood = true;
        let line = wire::event_to_line(agent.as_str(), &event).expect("it can be written");
        let (_, again) = wire::event_from_line(line.as_bytes()).expect("and read again");
        // Times and costs may be rounded once, and not twice.
        let twice = wire::event_to_line(agent.as_str(), &again).expect("it can be written");
        assert_eq!(
            wire::event_from_line(twice.as_bytes()).expect("and read").1,
            again
        );
    }
    understood
}
