//! Somebody who always has something for the robot to do.

use std::sync::Arc;
use std::time::Duration;

use agent_core::language::parse_tasks;
use agent_core::protocol::{GoalRequest, Urgency};
use agent_link::{Client, ClientError};
use tokio::sync::{Mutex, watch};
use tokio::task::JoinHandle;

use crate::chance::Chance;
use crate::observer::Observer;

/// There are no more people to be greeted.
pub const MOST_GOALS: usize = 600;
/// So many are open at a time, one within the other as far as they are emergencies.
const OPEN: usize = 5;
/// Whoever asks has to wait for a robot that is down.
const PATIENCE: Duration = Duration::from_secs(90);

/// A goal that was accepted.
#[derive(Clone, Debug)]
pub struct Accepted {
    pub id: String,
    /// What the world is to count once.
    pub deed: Option<String>,
}

/// Gives goals in a task of its own.
pub struct Feeder {
    accepted: Arc<Mutex<Vec<Accepted>>>,
    answers: watch::Receiver<usize>,
    stop: watch::Sender<bool>,
    task: Mutex<Option<JoinHandle<()>>>,
}

impl Feeder {
    pub fn start(client: Client, observer: Arc<Observer>, seed: u64) -> Self {
        let accepted = Arc::new(Mutex::new(Vec::new()));
        let (answered, answers) = watch::channel(0);
        let (stop, stopped) = watch::channel(false);
        let list = accepted.clone();
        let task = tokio::spawn(async move {
            let mut chance = Chance::new(seed);
            for number in 0..MOST_GOALS {
                until_few_are_open(&observer, &list, &stopped).await;
                if *stopped.borrow() {
                    return;
                }
                tokio::time::sleep(chance.millis(20..400)).await;
                let id = format!("g{number}");
                let (task, has_deed) = chance.task(number);
                let goal = GoalRequest {
                    id: Some(id.as_str().into()),
                    tasks: parse_tasks(&task).unwrap(),
                    urgency: match chance.below(2) {
                        0 => Urgency::Normal,
                        _ => Urgency::Emergency,
                    },
                    priority: i32::try_from(chance.below(4)).unwrap(),
                    deadline: chance.deadline(),
                };
                if ask(&client, goal).await {
                    let deed = has_deed.then(|| format!("(greet p{number})"));
                    list.lock().await.push(Accepted { id, deed });
                }
                answered.send_modify(|answers| *answers += 1);
            }
        });
        Self {
            accepted,
            answers,
            stop,
            task: Mutex::new(Some(task)),
        }
    }

    /// Returns when the next goal has been answered, or after `patience`.
    pub async fn next_answer(&self, patience: Duration) {
        let mut answers = self.answers.clone();
        answers.mark_unchanged();
        let _ = tokio::time::timeout(patience, answers.changed()).await;
    }

    /// No more goals.
    pub fn stop(&self) {
        self.stop.send_replace(true);
    }

    /// All that were accepted, once nothing is asked any more.
    pub async fn goals(&self) -> Vec<Accepted> {
        if let Some(task) = self.task.lock().await.take() {
            task.await.unwrap();
        }
        self.accepted.lock().await.clone()
    }
}

async fn until_few_are_open(
    observer: &Observer,
    list: &Mutex<Vec<Accepted>>,
    stopped: &watch::Receiver<bool>,
) {
    let accepted: Vec<String> = list
        .lock()
        .await
        .iter()
        .map(|goal| goal.id.clone())
        .collect();
    let few = observer.until(Duration::MAX, |books| {
        let open = accepted.iter().filter(|id| !books.ends.contains_key(*id));
        (open.count() < OPEN).then_some(())
    });
    let mut stopped = stopped.clone();
    tokio::select! {
        _ = few => {}
        _ = stopped.wait_for(|stopped| *stopped) => {}
    }
}

/// Whether it was accepted. Asks until there is an answer: with the same name it is the same goal.
async fn ask(client: &Client, goal: GoalRequest) -> bool {
    let asked = tokio::time::Instant::now();
    loop {
        match client.goal(goal.clone()).await {
            Ok(verdict) if verdict.accepted => return true,
            Ok(verdict) => {
                println!("           refused: {}", verdict.reason.unwrap_or_default());
                return false;
            }
            Err(ClientError::NoAnswer { .. }) if asked.elapsed() < PATIENCE => {}
            Err(error) => panic!("{goal:?}: {error}"),
        }
    }
}
