//! Machines with a journal, over real zenoh on this machine's loopback: whoever is killed is as one
//! that was slow.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

mod toys;

use agent_core::model::Atom;
use agent_core::protocol::{Command, GoalRequest, Happening, Input, Instruction, Report, Urgency};
use agent_link::session::Session;
use agent_link::{Client, LinkError, View};
use serde_json::{Value, json};

use toys::disk::ToyDisk;
use toys::{Robot, Toy, execute, id, within};

fn goal(id: &str) -> GoalRequest {
    GoalRequest {
        id: Some(id.into()),
        tasks: vec![Atom::new("go", ["n4"])],
        urgency: Urgency::Normal,
        priority: 0,
        deadline: None,
    }
}

/// Asks until the answer is as it should be.
async fn until(client: &Client, agent: &str, view: View, is_so: impl Fn(&Value) -> bool) -> Value {
    let asking = async {
        loop {
            let shown = client.look(agent, view).await.unwrap();
            if is_so(&shown) {
                return shown;
            }
            tokio::task::yield_now().await;
        }
    };
    within(asking).await
}

/// All that a machine has decided is on the disk.
async fn until_written(client: &Client, agent: &str) {
    until(client, agent, View::Journal, |journal| {
        journal["waiting"] == 0 && journal["commits"] != 0
    })
    .await;
}

async fn client(robot: &Robot) -> (Session, Client) {
    let session = robot.client().await;
    let client = Client::new(&session, &robot.keys);
    (session, client)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn an_acknowledged_goal_survives_a_kill() {
    let robot = Robot::start().await;
    let (_session, client) = client(&robot).await;
    let disk = ToyDisk::default();
    let (agent, _) = robot
        .drive_with(Toy::new("parent"), disk.memory(), |w| w.takes_goals = true)
        .await;
    assert!(within(client.goal(goal("fetch"))).await.unwrap().accepted);
    let found = disk.after_a_kill();
    agent.kill();

    let (agent, _) = robot
        .drive_with(Toy::new("parent"), found.memory(), |w| w.epoch = 2)
        .await;
    let heard = agent.stop().await.unwrap().heard();
    assert!(
        heard.iter().any(|input| input.contains("fetch")),
        "{heard:?}"
    );
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn acknowledging_waits_for_the_disk_and_stopping_does_not() {
    let robot = Robot::start().await;
    let (_session, client) = client(&robot).await;
    let (above, below) = (ToyDisk::default(), ToyDisk::default());
    let (executor, stopped) = robot
        .drive_with(Toy::new("executor"), below.memory(), |_| {})
        .await;
    let superior = Toy::new("child")
        .instructing("executor", vec![execute(1)])
        .commanding("executor");
    let (superior, answered) = robot
        .drive_with(superior, above.memory(), |w| w.takes_goals = true)
        .await;
    let accepted = |input: &Input<Value>| matches!(input, Input::Answer { .. });
    within(answered.until(|seen| seen.iter().any(accepted))).await;
    until_written(&client, "child").await;
    until_written(&client, "executor").await;

    above.shut(true);
    below.shut(true);
    let asking = tokio::spawn(async move {
        let command = Command::Suspend("tour".into());
        client.command(&command).await.unwrap()
    });
    let suspend = Instruction::Suspend { id: id(1) };
    let is_stop = move |input: &Input<Value>| matches!(input, Input::Instruction { instruction, .. } if *instruction == suspend);
    within(stopped.until(|seen| seen.iter().any(&is_stop))).await;
    assert!(
        !asking.is_finished(),
        "nothing was written, so nothing is promised"
    );
    above.shut(false);
    below.shut(false);
    assert!(within(asking).await.unwrap().accepted);
    let superior = superior.stop().await.unwrap();
    let executor = executor.stop().await.unwrap();
    assert_eq!(
        executor.seen.iter().filter(|input| is_stop(input)).count(),
        1
    );
    drop(superior);
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_full_disk_stops_acceptance_until_there_is_room() {
    let robot = Robot::start().await;
    let (_session, client) = client(&robot).await;
    let disk = ToyDisk::default();
    let (agent, _) = robot
        .drive_with(Toy::new("parent"), disk.memory(), |w| w.takes_goals = true)
        .await;
    until_written(&client, "parent").await;
    disk.full(true);
    let verdict = within(client.goal(goal("first"))).await.unwrap();
    let reason = verdict.reason.unwrap();
    assert!(!verdict.accepted);
    assert!(
        reason.contains("the toy disk cannot be written"),
        "{reason}"
    );
    assert!(reason.contains("not acknowledged"), "{reason}");
    let status = within(client.look("parent", View::Status)).await.unwrap();
    assert!(
        status["journal_trouble"]
            .as_str()
            .unwrap()
            .contains("cannot be written")
    );
    // From now on they do not even reach the machine.
    let verdict = within(client.goal(goal("second"))).await.unwrap();
    assert!(!verdict.accepted);
    assert!(verdict.reason.unwrap().contains("cannot be written"));

    disk.full(false);
    let journal = until(&client, "parent", View::Journal, |j| j["error"].is_null()).await;
    assert_eq!(journal["path"], "the toy disk");
    assert!(within(client.goal(goal("third"))).await.unwrap().accepted);
    let found = disk.after_a_kill();
    agent.kill();
    let (agent, _) = robot
        .drive_with(Toy::new("parent"), found.memory(), |w| w.epoch = 2)
        .await;
    let heard = agent.stop().await.unwrap().heard();
    let heard = |id: &str| heard.iter().any(|input| input.contains(id));
    assert_eq!(
        [heard("first"), heard("second"), heard("third")],
        [true, false, true]
    );
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn what_was_not_acknowledged_is_said_again_after_a_kill_and_done_once() {
    let robot = Robot::start().await;
    let (_session, client) = client(&robot).await;
    let (above, below) = (ToyDisk::default(), ToyDisk::default());
    let instructing = || Toy::new("child").instructing("executor", (1..=3).map(execute).collect());
    let (superior, _) = robot
        .drive_with(instructing(), above.memory(), |_| {})
        .await;
    // Its executor is not there yet.
    until_written(&client, "child").await;
    let found = above.after_a_kill();
    superior.kill();

    let (executor, executed) = robot
        .drive_with(Toy::new("executor").executing(), below.memory(), |_| {})
        .await;
    let (superior, answered) = robot
        .drive_with(instructing(), found.memory(), |w| w.epoch = 2)
        .await;
    within(executed.until(|seen| count_executions(seen) == 3)).await;
    let ends = |seen: &[Input<Value>]| {
        let ends = seen.iter().filter(|input| {
            matches!(
                input,
                Input::Report {
                    report: Report::Success { .. },
                    ..
                }
            )
        });
        ends.count()
    };
    within(answered.until(|seen| ends(seen) == 3)).await;
    until_written(&client, "executor").await;
    // Now the executor dies, and its superior does not notice.
    let found = below.after_a_kill();
    executor.kill();
    let (executor, _) = robot
        .drive_with(Toy::new("executor").executing(), found.memory(), |w| {
            w.epoch = 2
        })
        .await;
    until_written(&client, "executor").await;
    let superior = superior.stop().await.unwrap();
    assert_eq!(ends(&superior.seen), 3);
    let reborn = |input: &Input<Value>| matches!(input, Input::Reborn { .. });
    assert!(!superior.seen.iter().any(reborn), "{:?}", superior.seen);
    let executor = executor.stop().await.unwrap();
    assert_eq!(
        count_executions(&executor.seen),
        0,
        "it knows that it has done them"
    );
    let heard = executor.heard();
    let done = heard.iter().filter(|input| input.contains("Execute"));
    assert_eq!(done.count(), 3, "{heard:?}");
    robot.stop().await;
}

fn count_executions(seen: &[Input<Value>]) -> usize {
    let executions = seen.iter().filter(|input| {
        let Input::Instruction { instruction, .. } = input else {
            return false;
        };
        matches!(instruction, Instruction::Execute { .. })
    });
    executions.count()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn the_end_of_a_goal_is_told_again_after_a_kill_with_the_same_number() {
    let robot = Robot::start().await;
    let (session, client) = client(&robot).await;
    let mut raw = robot.listen(&session, &robot.keys.event()).await;
    let mut events = client.events().await.unwrap();
    let disk = ToyDisk::default();
    let toy = || Toy::new("parent").telling_of_goals();
    let (agent, _) = robot
        .drive_with(toy(), disk.memory(), |w| w.takes_goals = true)
        .await;
    assert!(within(client.goal(goal("fetch"))).await.unwrap().accepted);
    let first = within(raw.recv()).await.unwrap();
    assert_eq!((&first["n"], &first["line"]), (&json!(1), &json!(1)));
    let found = disk.after_a_kill();
    agent.kill();
    let (agent, _) = robot
        .drive_with(toy(), found.memory(), |w| {
            w.takes_goals = true;
            w.epoch = 2;
        })
        .await;
    assert_eq!(within(raw.recv()).await.unwrap(), first);
    assert!(within(client.goal(goal("bring"))).await.unwrap().accepted);
    // To whoever listens by the library it is one event.
    for id in ["fetch", "bring"] {
        let (_, event) = within(events.next()).await.unwrap().unwrap();
        assert_eq!(event.what, Happening::GoalSucceeded);
        assert_eq!(event.goal, Some(id.into()));
    }
    agent.stop().await.unwrap();
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_journal_that_does_not_fit_its_machine_is_refused_and_left_untouched() {
    let robot = Robot::start().await;
    let disk = ToyDisk::default();
    let (mut journal, _) = disk.memory().unwrap();
    let nonsense = agent_core::protocol::Row {
        key: "s/line".into(),
        value: Some(vec![0xff; 30]),
    };
    journal.commit(&[nonsense]).unwrap();
    drop(journal);
    let before = disk.bytes();
    let session = robot.client().await;
    let wiring = agent_link::Wiring::new(&robot.keys, "parent", 1);
    let clock = agent_link::Clock::start(1.0).unwrap();
    let toy = Toy::new("parent");
    let driven = agent_link::drive(toy, disk.memory(), wiring, &session, clock, async {});
    let error = within(driven).await.unwrap_err();
    assert!(matches!(error, LinkError::Unreadable { .. }), "{error}");
    let text = error.to_string();
    assert!(
        text.contains("`s/line`") && text.contains("move it away"),
        "{text}"
    );
    assert!(disk.bytes() == before);
    agent_link::session::close(session).await;
    robot.stop().await;
}
