//! A room as a process, with two vehicles that connect to it over the network.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use agent_core::language::parse_atom;
use agent_core::model::{Belief, Time};
use agent_core::protocol::{
    ActionId, Durable, Input, Instruction, Machine, Output, Reply, Report, Row, Rows, Unreadable,
};
use agent_link::session::{self, Role};
use agent_link::{Client, Clock, Inspect, Keys, View, Wiring, drive_agent, epoch_now, runtime};
use serde_json::Value;

const PATIENCE: Duration = Duration::from_secs(40);
const A_MOMENT: Duration = Duration::from_millis(20);

/// The process, which ends with the test.
struct Room(Child);

impl Drop for Room {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start_room(endpoint: &str, state: &str) -> Room {
    let room = Command::new(env!("CARGO_BIN_EXE_executor_sim"))
        .args(["room", "--listen", endpoint, "--speed", "60"])
        .args(["--state", state, "--until-stdin-ends"])
        .stdin(Stdio::piped())
        .spawn();
    Room(room.expect("the program was built"))
}

/// Has one thing done once the room is there, and believes what it is told.
struct Driver {
    name: &'static str,
    action: Option<&'static str>,
    outputs: VecDeque<Output<Infallible>>,
    belief: Arc<Mutex<Belief>>,
}

impl Machine for Driver {
    type In = Infallible;
    type Out = Infallible;

    fn handle(&mut self, _: Time, input: Input<Infallible>) -> Option<Reply> {
        let mut belief = self.belief.lock().expect("nobody panics with it");
        match input {
            Input::Neighbour { name, there: true } if name == "room" => {
                if let Some(action) = self.action.take() {
                    let instruction = Instruction::Execute {
                        id: ActionId {
                            agent: self.name.into(),
                            epoch: 1,
                            number: 1,
                        },
                        action: parse_atom(action).expect("an action"),
                        map: None,
                    };
                    self.outputs.push_back(Output::Instruct {
                        to: name,
                        instruction,
                    });
                }
            }
            Input::Observation(facts)
            | Input::Report {
                report: Report::Success { facts },
                ..
            } => {
                belief.apply_all(&facts);
            }
            _ => {}
        }
        None
    }

    fn poll_output(&mut self) -> Option<Output<Infallible>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        None
    }
}

impl Durable for Driver {
    fn write_down(&mut self) -> Vec<Row> {
        Vec::new()
    }

    fn recall(&mut self, _: &Rows) -> Result<(), Unreadable> {
        Ok(())
    }
}

impl Inspect for Driver {}

/// Looks at the room until it is as it should be.
async fn until(client: &Client, what: &str, fits: impl Fn(&Value) -> bool) -> Value {
    let begun = Instant::now();
    let mut last = Value::Null;
    while begun.elapsed() < PATIENCE {
        if let Ok(status) = client.look("room", View::Status).await {
            if fits(&status) {
                return status;
            }
            last = status;
        }
        tokio::time::sleep(A_MOMENT).await;
    }
    unreachable!("{what} has not come about: {last:#}")
}

#[test]
fn vehicles_drive_their_own_parts_and_a_room_that_is_killed_has_lost_nothing() {
    let port = TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr());
    let endpoint = format!("tcp/127.0.0.1:{}", port.expect("a free port").port());
    let state = tempfile::tempdir().expect("a folder");
    let state = state.path().display().to_string();
    let room = start_room(&endpoint, &state);
    runtime()
        .expect("a runtime")
        .block_on(serve(room, endpoint, &state));
}

async fn serve(room: Room, endpoint: String, state: &str) {
    let keys = Keys::new("robot").expect("a name");
    let role = Role::Client {
        connect: vec![endpoint.clone()],
    };
    let session = session::open(&role, None).await.expect("a session");
    let client = Client::new(&session, &keys);
    let status = until(&client, "the room", |status| status["vehicles"].is_object()).await;
    assert_eq!(status["bottles"]["cola1"]["where"], "at kitchen");
    assert_eq!(status["vehicles"]["k3"]["where"], "at kitchen");

    let beliefs = ["k2", "k3"].map(|_| Arc::new(Mutex::new(Belief::default())));
    let mut drivers = Vec::new();
    for (index, name) in ["k2", "k3"].into_iter().enumerate() {
        let driver = Driver {
            name,
            action: (name == "k3").then_some("(grasp cola1 ann kitchen)"),
            outputs: VecDeque::new(),
            belief: beliefs[index].clone(),
        };
        let (session, keys) = (session.clone(), keys.clone());
        drivers.push(tokio::spawn(async move {
            let clock = Clock::of_world(&session, &keys, PATIENCE).await;
            let wiring = Wiring {
                executors: vec!["room".to_owned()],
                signs: true,
                ..Wiring::new(&keys, name, epoch_now())
            };
            let clock = clock.expect("the room is the clock");
            drive_agent(
                driver,
                None,
                wiring,
                &session,
                clock,
                std::future::pending(),
            )
            .await
        }));
    }
    let accepted = client.facts("(spill table2)").await.expect("an answer");
    assert!(accepted.accepted);
    let held = |status: &Value| status["vehicles"]["k3"]["hand"] == "cola1";
    let before = until(&client, "the grasp", held).await;
    assert_eq!(before["done_count"], 1);
    let begun = Instant::now();
    let believes = |index: usize, fact: &str| {
        let belief: &Mutex<Belief> = &beliefs[index];
        let fact = parse_atom(fact).expect("a fact");
        belief.lock().expect("nobody panics with it").holds(&fact)
    };
    while !(believes(1, "(holding cola1)") && believes(0, "(spill table2)")) {
        assert!(begun.elapsed() < PATIENCE, "they are not told");
        tokio::time::sleep(A_MOMENT).await;
    }
    // Nobody is told where another's body is.
    assert!(believes(0, "(at table2)") && !believes(0, "(at kitchen)"));
    assert!(believes(1, "(at kitchen)") && !believes(1, "(at table2)"));
    assert!(!believes(1, "(spill table2)"));

    drop(room);
    let room = start_room(&endpoint, state);
    let after = until(&client, "the room again", held).await;
    assert_eq!(after["done_count"], 1);
    assert_eq!(after["spills"], before["spills"]);
    assert!(
        after["t_s"].as_f64() >= before["t_s"].as_f64(),
        "time goes on"
    );
    for driver in drivers {
        driver.abort();
    }
    session::close(session).await;
    drop(room);
}
