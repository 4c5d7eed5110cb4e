//! The same in a team: a room and three vehicles, each of which speaks under its own name alone.

use crate::{ASK, LOOK, Row, Table, everybody_tries_everything};

const TEAM: Table = Table {
    everybody: &["operator", "viewer", "supervisor", "room", "k1", "k2", "k3"],
    questions: &QUESTIONS,
    puts: &PUTS,
};

const QUESTIONS: [Row; 36] = [
    ("goal/normal", ASK, &["k1"]),
    ("goal/normal/operator", &["operator"], &["k1"]),
    ("goal/normal/k2", &[], &[]),
    ("goal/emergency", ASK, &["k1"]),
    ("goal/command", ASK, &["k1"]),
    ("goal/answers", &[], &[]),
    ("k1/goal/normal", ASK, &["k1"]),
    ("k2/goal/emergency", ASK, &["k2"]),
    ("k3/goal/command", ASK, &["k3"]),
    ("facts", ASK, &["room"]),
    ("room/status", LOOK, &["room"]),
    ("k1/goals", LOOK, &["k1"]),
    ("k3/belief", LOOK, &["k3"]),
    ("room/instruction", &[], &[]),
    ("room/instruction/k1", &["k1"], &["room"]),
    ("room/instruction/k3", &["k3"], &["room"]),
    ("room/instruction/operator", &[], &[]),
    ("room/report/k1", &[], &[]),
    ("k1/instruction", &[], &[]),
    ("k1/instruction/k2", &["k2"], &["k1"]),
    ("k1/instruction/operator", &[], &[]),
    ("k1/instruction/room", &[], &[]),
    ("k3/instruction/k1", &["k1"], &["k3"]),
    ("k1/report", &[], &[]),
    ("k1/report/room", &["room"], &["k1"]),
    ("k1/report/k2", &["k2"], &["k1"]),
    ("k2/report/k3", &["k3"], &["k2"]),
    ("k2/report/room", &["room"], &["k2"]),
    ("room/facts", &["k1", "k2", "k3"], &["room"]),
    ("room/facts/k1", &["k1"], &["room"]),
    ("room/facts/k3", &["k3"], &["room"]),
    ("k1/facts", &[], &[]),
    ("team/k1", &[], &[]),
    ("world/command", &[], &[]),
    (
        "supervisor/status",
        &["operator", "viewer"],
        &["supervisor"],
    ),
    (
        "clock",
        &["operator", "viewer", "supervisor", "k1", "k2", "k3"],
        &["room"],
    ),
];

const PUTS: [Row; 23] = [
    ("team", &[], &[]),
    ("team/k1", &["k1"], &["k2", "k3"]),
    ("team/k3", &["k3"], &["k1", "k2"]),
    ("team/operator", &[], &[]),
    ("team/room", &[], &[]),
    ("event", &["room", "k1", "k2", "k3"], LOOK),
    ("goal/normal", ASK, &["k1"]),
    ("goal/normal/k1", &[], &[]),
    ("goal/emergency/operator", &["operator"], &["k1"]),
    ("goal/command", &[], &[]),
    ("goal/answers", &["k1", "k2", "k3"], LOOK),
    ("k1/goal/emergency", ASK, &["k1"]),
    ("k2/goal/normal", ASK, &["k2"]),
    ("k2/goal/command", &[], &[]),
    ("facts", ASK, &["room"]),
    ("room/facts", &[], &[]),
    ("room/facts/k1", &["room"], &["k1"]),
    ("room/facts/k3", &["room"], &["k3"]),
    ("room/instruction/k1", &[], &[]),
    ("k1/instruction/k2", &[], &[]),
    ("k1/report/room", &[], &[]),
    ("world/pose", &["room"], LOOK),
    ("clock", &[], &[]),
];

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn with_certificates_a_vehicle_speaks_for_itself_and_to_whom_it_may() {
    everybody_tries_everything("certs", &TEAM).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn with_passwords_a_vehicle_speaks_for_itself_and_to_whom_it_may() {
    everybody_tries_everything("passwords", &TEAM).await;
}
