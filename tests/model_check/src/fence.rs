//! What runs ahead to stop something holds it up, whether that has begun or has not (decision 10).
//!
//! This is kept beside the station, which has its own way of knowing, and is compared with what it does.

use agent_core::protocol::{ActionId, Instruction};

use crate::happen::Said;
use crate::letter::{Letter, Side};
use crate::mutant::heard;
use crate::node::Node;
use crate::role::Role;
use crate::world::Motor;

/// Something was to be stopped before its turn.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub struct Fence {
    epoch: u64,
    seq: u64,
    id: ActionId,
    /// Whether what starts it has come since and nothing has moved yet.
    is_due: bool,
}

impl Fence {
    /// A letter arrives at an executor.
    pub(crate) fn arrives<M: Role>(node: &mut Node<M>, letter: &Letter) {
        match letter {
            Letter::StopAhead(message) => {
                let last = heard(&node.disk_to_be(), Side::Arm);
                if let Instruction::Suspend { id } = &message.body
                    && message.seq > last.1
                    && message.epoch >= last.0
                {
                    node.fence = Some(Self {
                        epoch: message.epoch,
                        seq: message.seq,
                        id: id.clone(),
                        is_due: false,
                    });
                }
            }
            Letter::Instruction(message) => {
                node.fence
                    .take_if(|fence| fence.epoch != message.epoch || fence.seq <= message.seq);
                if node.fence.is_none() {
                    return;
                }
                let last = heard(&node.disk_to_be(), Side::Arm);
                if let Some(fence) = &mut node.fence {
                    let starts = matches!(
                        message.body,
                        Instruction::Execute { .. } | Instruction::Resume { .. }
                    );
                    let is_next = message.seq == last.1 + 1;
                    fence.is_due |= starts && is_next && *message.body.id() == fence.id;
                }
            }
            Letter::Report(_) | Letter::Response { .. } => {}
        }
    }

    /// Whether what was to be stopped moves, and is not told to stop in the same breath.
    pub(crate) fn is_run_over<M: Role>(node: &mut Node<M>, said: &[Said]) -> Option<String> {
        let fence = node.fence.as_mut().filter(|fence| fence.is_due)?;
        let motors = said.iter().filter_map(|said| match said {
            Said::Motor(motor) => Some(motor),
            _ => None,
        });
        let began = motors.clone().find_map(|motor| match motor {
            Motor::Go { ticket, id, .. } if *id == fence.id => Some(*ticket),
            _ => None,
        })?;
        fence.is_due = false;
        let mut motors = motors;
        let stops = motors.any(|motor| *motor == Motor::Stop { ticket: began });
        let id = &fence.id;
        (!stops).then(|| format!("S4: {id} starts after what stops it has come"))
    }
}
