//! Robots that are stopped and started again: they stand still in between, and go on where they were.

use std::process::Stdio;

use agent_link::session::{self, Role};
use agent_link::{Client, Keys, Session, View};
use nix::sys::signal::Signal;
use serde_json::Value;
use tokio::process::{Child, Command};
use tokio::time::timeout;

use crate::harness::{PATIENCE, User};

/// A world that goes on when its robot does not.
struct World {
    session: Session,
    endpoint: String,
    client: Client,
    /// Killed when this is dropped.
    _process: Child,
}

impl World {
    async fn new(speed: &str) -> Self {
        let listen = Vec::new();
        let session = session::open(&Role::Router { listen }, None).await.unwrap();
        let endpoint = session::endpoints(&session).await.remove(0);
        let process = Command::new(env!("CARGO_BIN_EXE_intermezzo"))
            .args(["role", "world", "--until-stdin-ends", "--speed", speed])
            .args(["--robot", "robot", "--connect", &endpoint])
            .stdin(Stdio::piped())
            .kill_on_drop(true)
            .spawn()
            .unwrap();
        let keys = Keys::new("robot").unwrap();
        Self {
            client: Client::new(&session, &keys),
            session,
            endpoint,
            _process: process,
        }
    }

    async fn status(&self) -> Value {
        self.client.look("world", View::Status).await.unwrap()
    }

    /// Returns when the robot has set off.
    async fn until_it_drives(&self) {
        let driving = async { while self.status().await["odometer_m"].as_f64().unwrap() == 0.0 {} };
        timeout(PATIENCE, driving).await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_stands_still_when_its_processes_have_ended_however_that_came() {
    for signal in [Signal::SIGINT, Signal::SIGKILL] {
        let user = User::new().await;
        // Slow enough for the end to come while it drives.
        let world = World::new("4").await;
        let elsewhere = ["--no-world", "--connect", &world.endpoint];
        let mut up = user.up(&elsewhere).await;
        user.ok(&["goal", "(go n40)"]).await;
        up.until_doing("arc5").await;
        world.until_it_drives().await;
        up.end_by(signal).await;
        up.assert_nobody_is_left().await;
        let status = world.status().await;
        assert_eq!(status["speed_m_s"], 0.0, "{signal}: {status}");
        // Not where it was driving to: it was stopped.
        assert_eq!(status["place"]["Arc"]["arc"], "arc5", "{signal}: {status}");
        session::close(world.session).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_accepted_is_done_after_the_next_start_from_where_the_robot_stands() {
    for signal in [Signal::SIGINT, Signal::SIGKILL] {
        let user = User::new().await;
        let state = user.path().join("state");
        let state = ["--state", state.to_str().unwrap()];
        let mut up = user.up(&state).await;
        let waiting = user.run(&["goal", "(guide n40)", "--id", "tour", "--wait"]);
        let story = async {
            up.until_doing("arc5").await;
            user.ok(&["goal", "(go n28)", "--emergency", "--id", "toilet"])
                .await;
            up.until_goal("toilet", "action_started").await;
            up.end_by(signal).await;
            up.assert_nobody_is_left().await;
            let mut up = user.up(&state).await;
            up.until_goal("toilet", "goal_succeeded").await;
            up.until_goal("tour", "goal_succeeded").await;
            up
        };
        let (said, up) = tokio::join!(waiting, story);
        assert_eq!(said.code, Some(0), "{said:?}");
        assert!(said.err.contains("the robot is there again"), "{said:?}");
        // It was begun before.
        assert_eq!(up.of_goal("tour"), ["goal_resumed", "goal_succeeded"]);
        let status = user.ok(&["status"]).await.out;
        assert!(status.contains("at n40"), "{status}");
    }
}
