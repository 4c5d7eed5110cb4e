//! Every value that travels arrives as it left, and no bytes bring a reader down.

use agent_core::model::{self, Atom, Cost, FactChange, Time};
use agent_core::protocol::{
    self, ActionId, Envelope, Event, GoalRequest, Happening, Resumption, Urgency,
};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

use super::*;

/// None of these is a word of the language, which cannot be a name.
fn name() -> impl Strategy<Value = String> {
    "x[a-z0-9_-]{0,8}"
}

fn atom() -> impl Strategy<Value = Atom> {
    (name(), vec(name(), 0..4))
        .prop_map(|(name, args)| Atom::new(&name, args.iter().map(String::as_str)))
}

fn change() -> impl Strategy<Value = FactChange> {
    let value = proptest::num::f64::NORMAL | proptest::num::f64::ZERO;
    prop_oneof![
        atom().prop_map(FactChange::Add),
        atom().prop_map(FactChange::Remove),
        (atom(), value).prop_map(|(function, value)| FactChange::Set(function, value)),
    ]
}

/// Up to thirty years, to the microsecond.
fn time() -> impl Strategy<Value = Time> {
    (0..1_000_000_000_000_000_u64).prop_map(Time)
}

fn action_id() -> impl Strategy<Value = ActionId> {
    ("[a-z.]{1,8}", any::<u64>(), any::<u64>()).prop_map(|(agent, epoch, number)| ActionId {
        agent: agent.into(),
        epoch,
        number,
    })
}

fn map() -> impl Strategy<Value = model::Map> {
    let objects = proptest::collection::btree_map(name(), name(), 0..4);
    (objects, vec(change(), 0..6), vec(change(), 0..3)).prop_map(|(objects, facts, news)| {
        let mut belief = model::Belief::default();
        belief.apply_all(&facts);
        let objects = objects.into_iter().map(|(o, t)| (o.into(), t.into()));
        model::Map {
            objects: objects.collect(),
            facts: belief,
            news,
        }
    })
}

fn instruction() -> impl Strategy<Value = protocol::Instruction> {
    use protocol::Instruction as I;
    prop_oneof![
        (action_id(), atom(), option::of(map())).prop_map(|(id, action, map)| I::Execute {
            id,
            action,
            map
        }),
        action_id().prop_map(|id| I::Suspend { id }),
        (action_id(), option::of(map())).prop_map(|(id, map)| I::Resume { id, map }),
        action_id().prop_map(|id| I::Clear { id }),
    ]
}

fn report() -> impl Strategy<Value = protocol::Report> {
    use protocol::Report as R;
    let changes = || vec(change(), 0..4);
    prop_oneof![
        Just(R::Started),
        // The reader of JSON is exact to the last digit but one, which is enough for this.
        (0..=1024_u16).prop_map(|n| R::Progress {
            fraction: f64::from(n) / 1024.0
        }),
        changes().prop_map(|facts| R::Success { facts }),
        (any::<String>(), changes(), vec(atom(), 0..3)).prop_map(|(reason, facts, blocked_by)| {
            R::Failure {
                reason,
                facts,
                blocked_by,
            }
        }),
        (any::<String>(), changes()).prop_map(|(reason, facts)| R::Unknown { reason, facts }),
        changes().prop_map(|facts| R::Suspended { facts }),
    ]
}

fn answer() -> impl Strategy<Value = protocol::Answer> {
    use protocol::Answer as A;
    prop_oneof![
        Just(A::Accepted),
        Just(A::Suspending),
        time().prop_map(|finishes_in| A::Refused { finishes_in }),
        report().prop_map(|outcome| A::Finished { outcome }),
        any::<String>().prop_map(|reason| A::Rejected { reason }),
    ]
}

fn happening() -> impl Strategy<Value = Happening> {
    use Happening as H;
    let words = any::<String>;
    let cost = || (0..1_000_000_000_000_u64).prop_map(Cost);
    let urgency = prop_oneof![Just(Urgency::Normal), Just(Urgency::Emergency)];
    let how = prop_oneof![
        Just(Resumption::Continued),
        Just(Resumption::Alternative),
        Just(Resumption::Repaired),
        Just(Resumption::Replanned),
    ];
    let execution = || (action_id(), atom());
    prop_oneof![
        (vec(atom(), 0..3), urgency, any::<i32>()).prop_map(|(tasks, urgency, priority)| {
            H::GoalAccepted {
                tasks,
                urgency,
                priority,
            }
        }),
        words().prop_map(|reason| H::GoalRejected { reason }),
        Just(H::GoalStarted),
        (words(), option::of(atom())).prop_map(|(why, action)| H::GoalSuspended { why, action }),
        (how, words(), any::<u64>()).prop_map(|(how, why, expanded)| H::GoalResumed {
            how,
            why,
            expanded
        }),
        Just(H::GoalSucceeded),
        words().prop_map(|reason| H::GoalFailed { reason }),
        words().prop_map(|reason| H::GoalUnknown { reason }),
        atom().prop_map(|atom| H::NeighbourLost { name: atom.name }),
        atom().prop_map(|atom| H::NeighbourBack { name: atom.name }),
        vec(atom(), 0..3).prop_map(|blocked_by| H::GoalBlocked { blocked_by }),
        atom().prop_map(|what| H::TaskOffered {
            what,
            urgency: Urgency::Emergency
        }),
        (atom(), atom()).prop_map(|(what, to)| H::TaskGiven { what, to: to.name }),
        (atom(), option::of(atom()), option::of(words())).prop_map(|(what, by, failure)| {
            H::TaskEnded {
                what,
                by: by.map(|by| by.name),
                failure,
            }
        }),
        (atom(), vec(atom(), 0..3), vec(atom(), 0..3)).prop_map(|(name, held, tasks)| {
            H::VehicleLost {
                name: name.name,
                held,
                tasks,
            }
        }),
        (atom(), vec(change(), 0..3)).prop_map(|(by, changes)| H::FactsTold {
            by: by.name,
            changes
        }),
        (
            vec(atom(), 0..4),
            cost(),
            vec(cost(), 0..3),
            words(),
            any::<u64>()
        )
            .prop_map(|(steps, cost, alternatives, why, expanded)| {
                H::PlanSelected {
                    steps,
                    cost,
                    alternatives,
                    why,
                    expanded,
                }
            }),
        (words(), any::<usize>()).prop_map(|(why, kept)| H::PlanRevised { why, kept }),
        (
            vec(atom(), 0..3),
            vec(atom(), 0..2),
            vec((atom(), vec(atom(), 0..2)), 0..2),
            0_u32..1000,
            words()
        )
            .prop_map(|(actions, beside, after, saving, why)| {
                H::ActionsCombined {
                    actions,
                    beside,
                    after,
                    saving_s: f64::from(saving) / 4.0,
                    why,
                }
            }),
        (atom(), any::<usize>(), atom()).prop_map(|(task, levels, failed)| H::TaskRepaired {
            task,
            levels,
            failed
        }),
        execution().prop_map(|(id, action)| H::ActionStarted { id, action }),
        execution().prop_map(|(id, action)| H::ActionStopping { id, action }),
        execution().prop_map(|(id, action)| H::ActionSuspended { id, action }),
        execution().prop_map(|(id, action)| H::ActionResumed { id, action }),
        execution().prop_map(|(id, action)| H::ActionRolledBack { id, action }),
        (execution(), option::of(words())).prop_map(|((id, action), failure)| {
            H::ActionFinished {
                id,
                action,
                failure,
            }
        }),
        execution().prop_map(|(id, action)| H::RecordCleared { id, action }),
        vec(change(), 0..4).prop_map(|changes| H::BeliefChanged { changes }),
    ]
}

/// Through the text and back.
fn sent<T: Serialize + DeserializeOwned>(body: T) -> T {
    let envelope = Envelope {
        from: "parent".into(),
        line: 1,
        settled: 0,
        to_line: 0,
        epoch: 3,
        seq: 17,
        body: to_value(&body).unwrap(),
    };
    let text = write(&Message::from(&envelope)).unwrap();
    let message: Message<Value> = read("message", text.as_bytes()).unwrap();
    let arrived = Envelope::from(message);
    assert_eq!((arrived.epoch, arrived.seq), (3, 17));
    super::body("body", arrived.body).unwrap()
}

proptest! {
    #[test]
    fn instructions_arrive_as_they_left(instruction in instruction()) {
        let arrived: protocol::Instruction = sent(Instruction::from(&instruction)).into();
        prop_assert_eq!(arrived, instruction);
    }

    #[test]
    fn reports_arrive_as_they_left(id in action_id(), report in report()) {
        let body = ReportBody { id: Text(id.clone()), report: (&report).into() };
        let arrived = sent(body);
        prop_assert_eq!(arrived.id.0, id);
        prop_assert_eq!(protocol::Report::from(arrived.report), report);
    }

    #[test]
    fn answers_arrive_as_they_left(answer in answer(), seq in any::<u64>()) {
        let text = write(&Acknowledgement::applied(7, seq, Some((&answer).into()))).unwrap();
        let arrived: Acknowledgement = read("answer", text.as_bytes()).unwrap();
        prop_assert_eq!(arrived.seq, Some(seq));
        prop_assert_eq!(arrived.answer.map(protocol::Answer::from), Some(answer));
        prop_assert_eq!(arrived.refused, None);
    }

    #[test]
    fn events_arrive_as_they_left(
        at in time(),
        goal in option::of(name()),
        stack_depth in any::<usize>(),
        what in happening(),
    ) {
        let event = Event { at, goal: goal.map(Into::into), stack_depth, what };
        let line = event_to_line("child", &event).unwrap();
        prop_assert!(!line.contains('\n'));
        let (agent, arrived) = event_from_line(line.as_bytes()).unwrap();
        prop_assert_eq!(agent, "child");
        prop_assert_eq!(arrived, event);
    }

    #[test]
    fn goals_arrive_as_they_left(
        id in option::of(name()),
        tasks in vec(atom(), 1..4),
        priority in any::<i32>(),
        deadline in option::of((1..1_000_000_000_000_u64).prop_map(Time)),
    ) {
        let id = id.map(Into::into);
        let goal = GoalRequest { id, tasks, urgency: Urgency::Normal, priority, deadline };
        let text = goal_to_wire(&goal).unwrap();
        prop_assert_eq!(goal_from_user(Urgency::Normal, text.as_bytes()).unwrap(), goal);
    }

    #[test]
    fn observed_facts_arrive_as_they_left(facts in vec(change(), 0..6), seq in any::<u64>()) {
        let text = write(&Observed::new(7, seq, &facts, Some(&"child".into()))).unwrap();
        let arrived: Observed = read("facts", text.as_bytes()).unwrap();
        prop_assert_eq!((arrived.epoch, arrived.seq), (7, seq));
        prop_assert_eq!(arrived.reported_to.as_deref(), Some("child"));
        prop_assert_eq!(arrived.into_facts(), facts);
    }

    #[test]
    fn no_bytes_bring_a_reader_down(bytes in vec(any::<u8>(), 0..300)) {
        read_everything(&bytes);
    }

    #[test]
    fn nor_does_what_looks_like_a_message(text in r#"[(){}\[\]":,a-z0-9 .\-+=v?;]{0,120}"#) {
        read_everything(text.as_bytes());
        read_everything(format!(r#"{{"v":1,"task":"{text}"}}"#).as_bytes());
        read_everything(format!(r#"{{"facts":["({text})"]}}"#).as_bytes());
        read_everything(format!(r#"{{"v":1,"verb":"suspend","id":"{text}"}}"#).as_bytes());
    }
}

/// Whatever comes of it.
fn read_everything(bytes: &[u8]) {
    let _ = goal_from_user(Urgency::Emergency, bytes);
    let _ = command_from_user(bytes);
    let _ = facts_from_user(bytes);
    let _ = event_from_line(bytes);
    let _ = read::<Message<Value>>("message", bytes);
    let _ = read::<Observed>("facts", bytes);
    let _ = read::<Instruction>("instruction", bytes);
    let _ = read::<ReportBody>("report", bytes);
    let _ = read::<Acknowledgement>("answer", bytes);
}

#[test]
fn what_travels_can_be_read_by_people() {
    let event = Event {
        at: Time::from_secs(4.0),
        goal: Some("fetch".into()),
        stack_depth: 1,
        what: Happening::ActionFinished {
            id: ActionId {
                agent: "parent".into(),
                epoch: 3,
                number: 17,
            },
            action: Atom::new("go", ["n4"]),
            failure: None,
        },
    };
    assert_eq!(
        event_to_line("parent", &event).unwrap(),
        r#"{"v":1,"t_s":4.0,"agent":"parent","goal":"fetch","stack_depth":1,"event":"action_finished","action_id":"parent.3.17","action":"(go n4)","failure":null}"#
    );
    let refused = protocol::Answer::Refused {
        finishes_in: Time::from_secs(2.5),
    };
    assert_eq!(
        write(&Answer::from(&refused)).unwrap(),
        r#"{"answer":"refused","finishes_in_s":2.5}"#
    );
}

#[test]
fn a_message_of_another_version_is_refused_and_says_so() {
    let error = read::<Acknowledgement>("answer", br#"{"v":2,"seq":1}"#).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the message is of version 2, but this program speaks version 1: run the same release on both sides"
    );
    let error = read::<Acknowledgement>("answer", br#"{"seq":1}"#).unwrap_err();
    assert!(error.to_string().contains("does not say its version"));
}

#[test]
fn depth_is_bounded_in_json_and_in_the_language() {
    let deep = "[".repeat(USER_LIMIT_BYTES);
    assert!(read::<Value>("answer", deep.as_bytes()).is_err());
    let deep = "(".repeat(USER_LIMIT_BYTES);
    assert!(facts_from_user(deep.as_bytes()).is_err());
}
