//! Machines that talk over real zenoh on this machine's loopback.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

mod toys;

use std::time::Duration;

use agent_core::model::{Atom, FactChange, Time};
use agent_core::protocol::{Answer, Command, GoalRequest, Happening, Input, Instruction, Urgency};
use agent_link::{Client, ClientError, Clock, LinkError, View};
use serde_json::{Value, json};

use toys::{Robot, Toy, execute, within};

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn instructions_and_reports_arrive_once_and_in_order() {
    let robot = Robot::start().await;
    let session = robot.client().await;
    let executor = Toy::new("executor").executing();
    let (executor, _) = robot.drive(executor, |_| {}).await;
    let superior = Toy::new("child").instructing("executor", (1..=20).map(execute).collect());
    let (superior, done) = robot
        .drive(superior, |w| w.executors.push("executor".into()))
        .await;
    within(done.until(|seen| reports(seen).len() == 40)).await;

    let superior = superior.stop().await.unwrap();
    let answers: Vec<u64> = superior.seen.iter().filter_map(answered).collect();
    assert_eq!(answers, (1..=20).collect::<Vec<_>>());
    // Each execution: started, then success.
    let expected: Vec<(u64, bool)> = (1..=20).flat_map(|n| [(n, false), (n, true)]).collect();
    assert_eq!(reports(&superior.seen), expected);
    let executor = executor.stop().await.unwrap();
    assert_eq!(executed(&executor.seen), (1..=20).collect::<Vec<_>>());
    agent_link::session::close(session).await;
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn what_is_answered_but_not_heard_is_applied_once() {
    // The superior lives on one robot and its executor on another; between them, in both
    // directions, goes a courier who loses the first answer to everything.
    let near = Robot::start().await;
    let far = near.other("far");
    let down = near.courier("executor/instruction", &far).await;
    let up = far.courier("child/report", &near).await;

    let (executor, _) = far.drive(Toy::new("executor").executing(), |_| {}).await;
    let superior = Toy::new("child").instructing("executor", (1..=3).map(execute).collect());
    let (superior, done) = near.drive(superior, |_| {}).await;
    within(done.until(|seen| reports(seen).len() == 6)).await;

    let superior = superior.stop().await.unwrap();
    let answers: Vec<u64> = superior.seen.iter().filter_map(answered).collect();
    assert_eq!(answers, [1, 2, 3]);
    let expected = [
        (1, false),
        (1, true),
        (2, false),
        (2, true),
        (3, false),
        (3, true),
    ];
    assert_eq!(reports(&superior.seen), expected);
    let executor = executor.stop().await.unwrap();
    assert_eq!(executed(&executor.seen), [1, 2, 3]);
    assert!(down.lost() >= 3 && up.lost() >= 6, "nothing was lost");
    near.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn goals_are_taken_by_put_and_by_query_and_nonsense_is_refused_in_words() {
    let robot = Robot::start().await;
    let (agent, done) = robot
        .drive(Toy::new("parent"), |w| {
            w.takes_goals = true;
            w.takes_facts = true;
        })
        .await;
    let session = robot.client().await;
    let client = Client::new(&session, &robot.keys);

    let goal = GoalRequest {
        id: Some("fetch".into()),
        tasks: vec![Atom::new("go", ["n4"])],
        urgency: Urgency::Emergency,
        priority: 1,
        deadline: Some(Time::from_secs(30.0)),
    };
    let verdict = within(client.goal(goal.clone())).await.unwrap();
    assert!(verdict.accepted);
    assert_eq!(verdict.id.as_deref(), Some("fetch"));
    let verdict = within(client.goal(GoalRequest { id: None, ..goal }))
        .await
        .unwrap();
    assert!(verdict.id.unwrap().starts_with("go-"));

    let mut verdicts = robot.listen(&session, &robot.keys.goal_answers()).await;
    for (sent, accepted, words) in [
        ("(go n5)".to_owned(), true, "(go n5)"),
        (r#"{"task":"(go n5)""#.to_owned(), false, "EOF"),
        (r#"{"task":"(go n5)","v":2}"#.to_owned(), false, "version 2"),
        ("x".repeat(1_000_000), false, "1000000 bytes"),
        ("(fly)".to_owned(), false, "the goal has no task"),
    ] {
        within(robot.put(&session, &robot.keys.goal_normal(), &sent)).await;
        let verdict: Value = within(verdicts.recv()).await.unwrap();
        assert_eq!(verdict["accepted"], json!(accepted), "{verdict}");
        assert!(verdict.to_string().contains(words), "{verdict}");
    }

    let alive = within(client.alive()).await.unwrap();
    assert_eq!(alive, [("parent".to_owned(), 1)]);
    let command = Command::Cancel("fetch".into());
    assert!(within(client.command(&command)).await.unwrap().accepted);
    let told = within(client.facts("(not (open door3_5))")).await.unwrap();
    assert!(told.accepted);
    let told = within(client.facts("(not")).await.unwrap();
    assert!(told.reason.unwrap().contains("cannot read the facts"));
    let status = within(client.look("parent", View::Status)).await.unwrap();
    assert_eq!(status, json!({ "name": "parent" }));
    assert_eq!(
        within(client.look("parent", View::Stack)).await.unwrap(),
        json!({})
    );

    let closed = FactChange::Remove(Atom::new("open", ["door3_5"]));
    within(done.until(|seen| seen.contains(&Input::Observation(vec![closed.clone()])))).await;
    let agent = agent.stop().await.unwrap();
    let goals = agent
        .seen
        .iter()
        .filter(|input| matches!(input, Input::Goal(_)));
    assert_eq!(goals.count(), 4, "what cannot be read reaches nobody");
    agent_link::session::close(session).await;
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_bad_instruction_is_refused_and_the_next_one_is_taken() {
    let robot = Robot::start().await;
    let (executor, _) = robot.drive(Toy::new("executor").executing(), |_| {}).await;
    let session = robot.client().await;
    let key = robot.keys.agent("executor").unwrap().instruction();
    let envelope = |v: u32, epoch: u64, seq: u64, body: Value| {
        json!({"v": v, "from": "child", "line": epoch, "epoch": epoch, "seq": seq, "body": body})
            .to_string()
    };
    let suspend = json!({"verb": "suspend", "id": "child.5.1"});
    let not_an_action = json!({"verb": "execute", "id": "child.5.1", "action": "go"});
    for (sent, words) in [
        ("{".to_owned(), "EOF"),
        (envelope(2, 5, 1, suspend.clone()), "version 2"),
        (
            envelope(1, 5, 1, json!({"verb": "dance"})),
            "unknown variant `dance`",
        ),
        (envelope(1, 5, 2, not_an_action), "rejected"),
        (
            envelope(1, 5, 4, suspend.clone()),
            "message 3 is due, not 4",
        ),
        (envelope(1, 5, 3, suspend.clone()), "suspending"),
        (envelope(1, 5, 3, suspend.clone()), "suspending"),
        (envelope(1, 4, 9, suspend.clone()), "superseded"),
        (envelope(1, 6, 1, suspend.clone()), "suspending"),
    ] {
        let answer = within(robot.ask(&session, &key, &sent)).await;
        assert!(answer.contains(words), "{sent}: {answer}");
    }
    let executor = executor.stop().await.unwrap();
    // The repeated one was applied once, and that the sender has begun anew was noticed.
    let reborn = |input: &&Input<Value>| matches!(input, Input::Reborn { .. });
    assert_eq!(executor.seen.iter().filter(reborn).count(), 1);
    assert_eq!(executor.seen.len(), 3, "{:?}", executor.seen);
    agent_link::session::close(session).await;
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_process_that_was_replaced_steps_down() {
    let robot = Robot::start().await;
    let (executor, _) = robot.drive(Toy::new("executor").executing(), |_| {}).await;
    let new = Toy::new("child").instructing("executor", vec![execute(1)]);
    let (new, done) = robot.drive(new, |w| w.epoch = 9).await;
    within(done.until(|seen| reports(seen).len() == 2)).await;
    // The former one instructs only now; its epoch is older.
    let old = Toy::new("child").instructing("executor", vec![execute(2)]);
    let (old, _) = robot.drive(old, |w| w.epoch = 8).await;
    let error = within(old.ended()).await.unwrap_err();
    assert!(matches!(error, LinkError::Superseded { .. }), "{error}");
    let executor = executor.stop().await.unwrap();
    assert_eq!(executed(&executor.seen), [1]);
    new.stop().await.unwrap();
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn facts_told_before_a_superior_came_reach_it_and_so_do_events_their_watcher() {
    let robot = Robot::start().await;
    let session = robot.client().await;
    let client = Client::new(&session, &robot.keys);
    let mut events = client.events().await.unwrap();
    let facts = vec![FactChange::Add(Atom::new("at", ["n1"]))];
    let (executor, _) = robot
        .drive(Toy::new("executor").telling(facts.clone()), |_| {})
        .await;
    // What was told has been told: its event comes after it.
    let (agent, event) = within(events.next()).await.unwrap().unwrap();
    assert_eq!(agent, "executor");
    assert_eq!(
        event.what,
        Happening::BeliefChanged {
            changes: facts.clone()
        }
    );

    let (superior, done) = robot
        .drive(Toy::new("child"), |w| w.executors.push("executor".into()))
        .await;
    within(done.until(|seen| seen.contains(&Input::Observation(facts.clone())))).await;
    superior.stop().await.unwrap();
    executor.stop().await.unwrap();
    let error = client.look("nobody", View::Status).await.unwrap_err();
    assert!(matches!(error, ClientError::NoAnswer { .. }), "{error}");
    agent_link::session::close(session).await;
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_superior_that_missed_a_fact_asks_for_all() {
    let robot = Robot::start().await;
    let (superior, done) = robot
        .drive(Toy::new("child"), |w| w.executors.push("executor".into()))
        .await;
    // An executor of which only the fifth word arrives.
    let session = robot.client().await;
    let key = robot.keys.agent("executor").unwrap().facts();
    let told = |facts: &[&str]| json!({"v": 1, "epoch": 1, "seq": 5, "facts": facts}).to_string();
    let all = told(&["(at n5)", "(not (open door3_5))"]);
    robot.answer(&session, &key, all).await;
    within(robot.put(&session, &key, &told(&["(at n5)"]))).await;
    let expected = vec![
        FactChange::Add(Atom::new("at", ["n5"])),
        FactChange::Remove(Atom::new("open", ["door3_5"])),
    ];
    within(done.until(|seen| !seen.is_empty())).await;
    let superior = superior.stop().await.unwrap();
    assert_eq!(superior.seen, [Input::Observation(expected)]);
    agent_link::session::close(session).await;
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_machine_that_has_always_more_to_think_about_listens_nevertheless() {
    let robot = Robot::start().await;
    let session = robot.client().await;
    let mut poses = robot.listen(&session, &robot.keys.world_pose()).await;
    let (thinker, _) = robot
        .drive(Toy::new("world").thinking(), |w| {
            w.takes_goals = true;
            w.snapshots_every = Some(Duration::from_millis(10));
        })
        .await;
    let key = robot.keys.goal_emergency();
    for _ in 0..10 {
        let answer = within(robot.ask(&session, &key, "(go n4)")).await;
        assert!(answer.contains(r#""accepted":true"#), "{answer}");
    }
    let pose = within(poses.recv()).await.unwrap();
    assert_eq!(pose["snapshot"], json!({ "name": "world" }));
    assert_eq!(thinker.stop().await.unwrap().seen.len(), 10);
    agent_link::session::close(session).await;
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn all_processes_of_a_robot_have_the_time_of_its_world() {
    let robot = Robot::start().await;
    let session = robot.client().await;
    let asking = Clock::of_world(&session, &robot.keys, Duration::from_secs(20));
    let world = robot.client().await;
    let answering = async {
        let clock = Clock::start(8.0).unwrap();
        let service = clock.serve(&world, &robot.keys).await.unwrap();
        (clock, service)
    };
    let (asked, (clock, _service)) = tokio::join!(within(asking), answering);
    let asked = asked.unwrap();
    assert!((asked.now().secs() - clock.now().secs()).abs() < 0.8);
    let nowhere = agent_link::Keys::new("nowhere").unwrap();
    let error = Clock::of_world(&session, &nowhere, Duration::from_millis(50)).await;
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("no world of robot `nowhere`")
    );
    agent_link::session::close(session).await;
    agent_link::session::close(world).await;
    robot.stop().await;
}

/// The number of the execution that an answer is about.
fn answered(input: &Input<Value>) -> Option<u64> {
    match input {
        Input::Answer {
            to: Instruction::Execute { id, .. },
            answer: Answer::Accepted,
        } => Some(id.number),
        _ => None,
    }
}

/// The executions that reports are about, and whether they are over.
fn reports(seen: &[Input<Value>]) -> Vec<(u64, bool)> {
    seen.iter()
        .filter_map(|input| match input {
            Input::Report { id, report } => Some((id.number, report.is_end())),
            _ => None,
        })
        .collect()
}

/// The executions that an executor was told to begin.
fn executed(seen: &[Input<Value>]) -> Vec<u64> {
    seen.iter()
        .filter_map(|input| match input {
            Input::Instruction {
                instruction: Instruction::Execute { id, .. },
                ..
            } => Some(id.number),
            _ => None,
        })
        .collect()
}
