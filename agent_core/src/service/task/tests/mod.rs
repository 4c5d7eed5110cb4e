//! The task service by itself, and many of them in a world that goes wrong.

mod random;
mod rig;

use std::collections::BTreeSet;

use super::*;
use crate::model::Atom;
use crate::protocol::Answer;
use crate::service::Award;

const CAN: Option<Time> = Some(Time(10_000_000));

fn at(secs: f64) -> Time {
    Time::from_secs(secs)
}

fn service(name: &str) -> TaskService {
    let mut service = TaskService::new(name.into(), 1, Times::default());
    service.settle(Time::ZERO);
    service
}

fn new_task() -> NewTask {
    NewTask {
        what: Atom::new("serve", ["guest1"]),
        urgency: Urgency::Normal,
        priority: 0,
        deadline: None,
    }
}

fn outputs(service: &mut TaskService) -> Vec<TaskOutput> {
    std::iter::from_fn(|| service.poll_output()).collect()
}

/// Lets `service` hear what is said in `outputs`.
fn hear(service: &mut TaskService, now: Time, outputs: &[TaskOutput]) {
    for output in outputs {
        if let TaskOutput::Say(message) = output {
            service.settle(now);
            service.heard(message);
        }
    }
    service.settle(now);
}

/// Answers all that is to be found out.
fn assess(service: &mut TaskService, now: Time, outputs: &[TaskOutput], cost: Option<Time>) {
    for output in outputs {
        if let TaskOutput::Assess(offer) = output {
            service.assessed(offer, cost, BTreeSet::new());
        }
    }
    service.settle(now);
}

fn given(outputs: &[TaskOutput]) -> Option<(Symbol, ActionId)> {
    outputs.iter().find_map(|output| match output {
        TaskOutput::Give { to, id, .. } => Some((to.clone(), id.clone())),
        _ => None,
    })
}

/// A publisher `p` that has heard of `w`, and has given it a task.
fn a_task_that_was_given() -> (TaskService, TaskService, ActionId) {
    let (mut p, mut w) = (service("p"), service("w"));
    let said = outputs(&mut w);
    hear(&mut p, at(0.0), &said);
    p.settle(at(2.0));
    outputs(&mut p);
    let said = {
        w.settle(at(2.0));
        outputs(&mut w)
    };
    hear(&mut p, at(2.0), &said);
    p.publish(Some("t".into()), new_task());
    p.settle(at(2.0));
    let offered = outputs(&mut p);
    assess(&mut p, at(2.0), &offered, None);
    hear(&mut w, at(2.1), &offered);
    let asked = outputs(&mut w);
    assess(&mut w, at(2.1), &asked, CAN);
    let bids = outputs(&mut w);
    hear(&mut p, at(2.2), &bids);
    let decided = outputs(&mut p);
    let (to, id) = given(&decided).expect("all have answered");
    assert_eq!(to, "w");
    (p, w, id)
}

#[test]
fn a_vehicle_that_is_alone_gives_its_task_to_itself_at_once() {
    let mut alone = service("a");
    alone.settle(at(5.0));
    outputs(&mut alone);
    alone.publish(Some("t".into()), new_task());
    alone.settle(at(5.0));
    let offered = outputs(&mut alone);
    assess(&mut alone, at(5.0), &offered, CAN);
    let (to, id) = given(&outputs(&mut alone)).unwrap();
    assert_eq!(to, "a");
    let success = Report::Success { facts: Vec::new() };
    assert!(alone.reported(&id, &success));
    let ended = outputs(&mut alone);
    let done = Outcome::Done {
        by: Some("a".into()),
    };
    assert!(
        ended
            .iter()
            .any(|it| matches!(it, TaskOutput::Ended { outcome, .. } if *outcome == done))
    );
    assert!(alone.published().is_empty());
}

#[test]
fn of_two_that_answer_at_once_the_cheaper_gets_the_task_and_of_equals_the_first_by_name() {
    for (costs, winner) in [([30, 20], "c"), ([20, 20], "b")] {
        let mut a = service("a");
        let mut others = [service("b"), service("c")];
        for other in &mut others {
            let said = outputs(other);
            hear(&mut a, at(0.0), &said);
        }
        a.publish(Some("t".into()), new_task());
        a.settle(at(0.0));
        let offered = outputs(&mut a);
        assess(&mut a, at(0.0), &offered, None);
        for (other, cost) in others.iter_mut().zip(costs) {
            hear(other, at(0.1), &offered);
            let asked = outputs(other);
            assess(other, at(0.1), &asked, Some(at(f64::from(cost))));
            let bids = outputs(other);
            hear(&mut a, at(0.1), &bids);
        }
        a.settle(at(0.3));
        let given: Vec<_> = outputs(&mut a)
            .into_iter()
            .filter_map(|output| match output {
                TaskOutput::Give { to, .. } => Some(to),
                _ => None,
            })
            .collect();
        assert_eq!(given, [Symbol::from(winner)]);
    }
}

#[test]
fn an_execution_that_was_not_bid_for_since_the_start_is_not_begun() {
    let (_, _, id) = a_task_that_was_given();
    let mut again = service("w");
    let refused = again.take(at(2.3), &id);
    assert!(matches!(refused, Err(Unwilling::NotBidFor(..))));
}

#[test]
fn an_execution_that_comes_when_its_lease_would_have_run_out_is_not_begun() {
    let (_, mut w, id) = a_task_that_was_given();
    let lease = Times::default().lease;
    // Counted from when it was offered.
    assert!(w.clone().take(at(1.9) + lease, &id).is_ok());
    let refused = w.take(at(2.0) + lease, &id);
    assert_eq!(refused, Err(Unwilling::TooLate(id)));
}

#[test]
fn nobody_renews_the_lease_of_what_another_has_awarded() {
    let (_, mut w, id) = a_task_that_was_given();
    let lease = Times::default().lease;
    let award = Award {
        task: "t".into(),
        id: id.clone(),
        what: new_task().what,
        to: "w".into(),
    };
    let mut renewed = w.clone();
    for (by, service) in [("p", &mut renewed), ("x", &mut w)] {
        let message = Message {
            by: by.into(),
            at: at(3.0),
            body: Body::Tasks(Tasks {
                awards: vec![award.clone()],
                ..Tasks::default()
            }),
        };
        service.settle(at(3.0));
        service.heard(&message);
    }
    let late = at(2.5) + lease;
    assert!(renewed.take(late, &id).is_ok());
    assert_eq!(w.take(late, &id).err(), Some(Unwilling::TooLate(id)));
}

#[test]
fn a_lease_that_is_not_renewed_runs_out_before_the_task_is_offered_again() {
    let (mut p, mut w, id) = a_task_that_was_given();
    w.take(at(2.3), &id).unwrap();
    let said = outputs(&mut p);
    hear(&mut w, at(2.3), &said);
    // The publisher does not see the vehicle any more, and names it no more.
    p.neighbour(&"w".into(), false);
    let mut gave_up = None;
    let mut offered_again = None;
    for step in 30..200 {
        let now = at(f64::from(step) * 0.1);
        p.settle(now);
        let said = outputs(&mut p);
        hear(&mut w, now, &said);
        let offered = said.iter().any(|output| {
            matches!(output, TaskOutput::Say(Message { body: Body::Tasks(tasks), .. }) if !tasks.offers.is_empty())
        });
        if offered {
            offered_again.get_or_insert(now);
        }
        if outputs(&mut w)
            .iter()
            .any(|output| matches!(output, TaskOutput::GiveUp { .. }))
        {
            gave_up.get_or_insert(now);
        }
    }
    let (gave_up, offered_again) = (gave_up.unwrap(), offered_again.unwrap());
    assert!(
        gave_up + Times::default().rest <= offered_again,
        "{gave_up} {offered_again}"
    );
    assert_ne!(p.published()["t"].id, id);
}

#[test]
fn a_vehicle_that_was_started_again_gives_up_what_others_had_given_it() {
    let (mut p, mut w, id) = a_task_that_was_given();
    w.take(at(2.3), &id).unwrap();
    let rows = w.write_down().into_iter();
    let rows: crate::protocol::Rows = rows.filter_map(|row| Some((row.key, row.value?))).collect();
    let mut again = TaskService::new("w".into(), 2, Times::default());
    again.recall(&rows).unwrap();
    let given_up = outputs(&mut again);
    assert!(
        given_up
            .iter()
            .any(|it| matches!(it, TaskOutput::GiveUp { publisher, id: which, .. } if *publisher == "p" && *which == id))
    );
    // It says so, and the task is offered again without delay, and without counting as a failure.
    p.neighbour(&"w".into(), false);
    let reason = "started again".to_owned();
    let failure = Report::Failure {
        reason,
        facts: Vec::new(),
        blocked_by: Vec::new(),
    };
    assert!(p.reported(&id, &failure));
    let task = &p.published()["t"];
    assert_eq!(task.stage, Stage::Open);
    assert!(task.failures.is_empty());
}

#[test]
fn a_publisher_that_was_started_again_still_knows_who_has_its_task() {
    let (mut p, _, id) = a_task_that_was_given();
    let rows = p.write_down().into_iter();
    let rows: crate::protocol::Rows = rows.filter_map(|row| Some((row.key, row.value?))).collect();
    let mut again = TaskService::new("p".into(), 2, Times::default());
    again.recall(&rows).unwrap();
    again.settle(at(3.0));
    assert!(matches!(&again.published()["t"].stage, Stage::Given { to, .. } if *to == "w"));
    let success = Report::Success { facts: Vec::new() };
    assert!(again.reported(&id, &success));
    assert!(again.published().is_empty());
}

#[test]
fn who_finishes_late_has_done_the_task_all_the_same_and_the_next_one_is_called_back() {
    let (mut p, mut w, id) = a_task_that_was_given();
    p.neighbour(&"w".into(), false);
    p.settle(at(20.0));
    outputs(&mut p);
    w.settle(at(20.0));
    let task = &p.published()["t"];
    assert_eq!(task.stage, Stage::Open);
    let offer = task.id.clone();
    // It does the task itself now.
    p.settle(at(20.1));
    let offered = outputs(&mut p);
    assess(&mut p, at(20.1), &offered, CAN);
    p.settle(at(21.5));
    let offered = outputs(&mut p);
    assess(&mut p, at(21.5), &offered, CAN);
    let mut all = offered;
    all.append(&mut outputs(&mut p));
    let second = p.published()["t"].id.clone();
    assert_eq!(second, offer);
    let success = Report::Success { facts: Vec::new() };
    assert!(p.reported(&id, &success));
    let after = outputs(&mut p);
    assert!(
        after.iter().any(
            |it| matches!(it, TaskOutput::TakeBack { from, id } if *from == "p" && *id == second)
        ),
        "{after:?}"
    );
    assert!(p.published().is_empty());
}

#[test]
fn a_task_that_all_have_failed_at_three_times_has_failed() {
    let mut alone = service("a");
    alone.settle(at(5.0));
    outputs(&mut alone);
    alone.publish(Some("t".into()), new_task());
    let mut times = 0;
    let mut outcome = None;
    for step in 0..100 {
        let now = at(5.0 + f64::from(step) * 0.1);
        alone.settle(now);
        let said = outputs(&mut alone);
        assess(&mut alone, now, &said, CAN);
        for output in said.into_iter().chain(outputs(&mut alone)) {
            match output {
                TaskOutput::Give { id, .. } => {
                    times += 1;
                    let failure = Report::Failure {
                        reason: "the glass is broken".to_owned(),
                        facts: Vec::new(),
                        blocked_by: Vec::new(),
                    };
                    alone.let_go(&id);
                    alone.reported(&id, &failure);
                }
                TaskOutput::Ended { outcome: how, .. } => outcome = Some(how),
                _ => {}
            }
        }
    }
    assert_eq!(times, 3);
    let reason = "the glass is broken".to_owned();
    assert_eq!(outcome, Some(Outcome::Failed { reason }));
}

#[test]
fn an_instruction_that_was_refused_is_offered_again_under_another_name() {
    let (mut p, _, id) = a_task_that_was_given();
    let reason = "no".to_owned();
    p.answered(&id, &Answer::Rejected { reason });
    let task = &p.published()["t"];
    assert_eq!(task.stage, Stage::Open);
    assert_ne!(task.id, id);
}

#[test]
fn a_task_nobody_can_do_stays_open_until_somebody_can() {
    let mut a = service("a");
    a.settle(at(5.0));
    outputs(&mut a);
    a.publish(Some("t".into()), new_task());
    for step in 0..50 {
        let now = at(5.0 + f64::from(step));
        a.settle(now);
        let said = outputs(&mut a);
        assess(&mut a, now, &said, None);
        assert!(given(&outputs(&mut a)).is_none());
    }
    a.settle(at(60.0));
    let said = outputs(&mut a);
    assess(&mut a, at(60.0), &said, CAN);
    assert!(given(&outputs(&mut a)).is_some());
}
