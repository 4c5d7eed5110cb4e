//! Stations whose disk is not there, full, or gone at the wrong moment.

use super::*;

fn observe() -> Command {
    Command::Cancel("door".into())
}

fn observed(effects: &[Effect<Infallible, u64>]) -> usize {
    let observed = effects
        .iter()
        .filter(|effect| matches!(effect, Effect::Observed { .. } | Effect::Seen { .. }));
    observed.count()
}

#[test]
fn without_a_journal_everything_goes_out_at_once() {
    let mut above = Desk::new("above", 1);
    above.command(go());
    above.station.release();
    assert_eq!(above.effects().iter().filter_map(instruction).count(), 1);
    above.handle(
        Arrival::Answered {
            by: "below".into(),
            line: 1,
            seq: 1,
            answer: Answer::Accepted,
        },
        None,
    );
    above.command(go());
    above.station.release();
    let sent: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    assert_eq!((sent[0].seq, sent[0].settled), (2, 1));
}

#[test]
fn who_waits_for_a_full_disk_is_told_and_a_repeated_message_is_answered_later() {
    let (mut above, mut below) = (Desk::new("above", 1), Desk::new("below", 1));
    above.command(go());
    above.write();
    let sent: Vec<_> = above.effects().iter().filter_map(instruction).collect();
    below.handle(Arrival::Instruction(sent[0].clone()), Some(1));
    below.start_writing();
    assert_eq!(below.station.refuse_waiting(), [1]);
    assert_eq!(below.station.refuse_waiting(), []);
    below.handle(Arrival::Instruction(sent[0].clone()), Some(2));
    assert_eq!(below.effects(), []);
    below.end_writing();
    below.write();
    let answered: Vec<_> = below
        .effects()
        .into_iter()
        .filter_map(|effect| match effect {
            Effect::Respond { to, .. } => Some(to),
            _ => None,
        })
        .collect();
    assert_eq!(answered, [2]);
    assert_eq!(below.heard(), ["execute 1"]);
}

#[test]
fn an_instruction_that_makes_no_sense_is_rejected_once_and_holds_nothing_up() {
    let mut below = Desk::new("below", 1);
    let message = Envelope {
        from: "above".into(),
        line: 1,
        epoch: 1,
        seq: 1,
        settled: 0,
        to_line: 0,
        body: "it dances".to_owned(),
    };
    below.handle(Arrival::Unreadable(message.clone()), Some(1));
    below.handle(Arrival::Unreadable(message.clone()), Some(2));
    let next = Envelope {
        from: message.from,
        line: 1,
        epoch: 1,
        seq: 2,
        settled: 0,
        to_line: 0,
        body: execute(1),
    };
    below.handle(Arrival::Instruction(next), Some(3));
    below.write();
    let answers: Vec<_> = below
        .effects()
        .into_iter()
        .filter_map(|effect| match effect {
            Effect::Respond { response, .. } => Some(response),
            _ => None,
        })
        .collect();
    let reason = "it dances".to_owned();
    let rejected = Response::Applied {
        seq: 1,
        answer: Some(Answer::Rejected { reason }),
    };
    let accepted = Response::Applied {
        seq: 2,
        answer: Some(Answer::Accepted),
    };
    assert_eq!(answers, [rejected.clone(), rejected, accepted]);
    assert_eq!(below.heard(), ["execute 1"]);
}

#[test]
fn what_was_observed_and_not_told_before_the_process_died_is_told_after() {
    let mut above = Desk::new("above", 1);
    above.command(observe());
    above.start_writing();
    above.end_writing();
    // It dies before the effects go out.
    above.restart();
    assert_eq!(observed(&above.effects()), 2);
    above.command(go());
    above.write();
    above.effects();
    above.restart();
    assert_eq!(observed(&above.effects()), 0, "it has been told");
}
