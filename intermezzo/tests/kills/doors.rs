//! Doors that somebody closes, and opens again after a while.

use std::time::Duration;

use agent_link::Client;
use tokio::sync::watch;
use tokio::task::JoinHandle;

use crate::chance::Chance;

/// Between all parts of the museum, so that there is often another way, and sometimes none.
const DOORS: [&str; 6] = [
    "door1_2", "door1_3", "door2_4", "door3_4", "door3_5", "door4_6",
];
/// Whoever was down has not heard that a door is open, so it is said again.
const AGAIN: Duration = Duration::from_secs(1);

/// Closes one door at a time, in a task of its own.
pub struct Doors {
    stop: watch::Sender<bool>,
    task: JoinHandle<usize>,
}

impl Doors {
    pub fn start(client: Client, seed: u64) -> Self {
        let (stop, mut stopped) = watch::channel(false);
        let task = tokio::spawn(async move {
            let mut chance = Chance::new(seed);
            let mut closed = 0;
            loop {
                let door = DOORS[chance.below(DOORS.len())];
                for (open, millis) in [(false, 200..2000), (true, 200..3000)] {
                    tell(&client, door, open).await;
                    closed += usize::from(!open);
                    let time = tokio::time::sleep(chance.millis(millis));
                    tokio::select! {
                        () = time => {}
                        _ = stopped.wait_for(|stopped| *stopped) => return closed,
                    }
                }
            }
        });
        Self { stop, task }
    }

    /// No door is closed any more. Returns how often one was.
    pub async fn stop(self) -> usize {
        self.stop.send_replace(true);
        self.task.await.unwrap()
    }
}

/// Opens all doors, and says so again and again. Never returns.
pub async fn are_open(client: &Client) {
    loop {
        for door in DOORS {
            tell(client, door, true).await;
        }
        tokio::time::sleep(AGAIN).await;
    }
}

async fn tell(client: &Client, door: &str, open: bool) {
    let text = match open {
        true => format!("(open {door})"),
        false => format!("(not (open {door}))"),
    };
    // That nobody is there to hear it is what this is about.
    let _ = client.facts(&text).await;
}
