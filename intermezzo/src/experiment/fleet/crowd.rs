//! The robots of a fleet, told apart, and somebody who interrupts them at random.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::time::Duration;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Event, GoalId, Urgency};
use agent_link::{Clock, Session, wire};
use maps::Site;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tokio::sync::mpsc;
use zenoh::pubsub::Subscriber;
use zenoh::qos::CongestionControl;

use super::super::follow::{Ending, Followed, drive, going};
use super::super::stamps::Stamps;
use super::host::{keys, number_of};
use crate::exit::Failure;

/// Where all events of all robots are told.
const EVENTS: &str = "intermezzo/*/event";

/// A robot that stands, or speaks, when it is to be interrupted is looked at again so much later.
const LOOK_AGAIN_S: f64 = 0.5;

/// What has become of the interruptions of a while.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    /// Emergencies that were put.
    pub(super) put: usize,
    /// Those that broke off what the robot did.
    pub(super) broken: Vec<Stamps>,
    /// Those that came too late to break anything off, or served it.
    pub(super) others: usize,
}

impl Tally {
    /// Emergencies that have not come to their end.
    pub(super) fn open(&self) -> usize {
        self.put - self.broken.len() - self.others
    }
}

/// A fleet, and somebody who interrupts it.
pub(super) struct Crowd<'a> {
    session: Session,
    clock: Clock,
    site: &'a Site,
    robots: Vec<Followed>,
    /// When which robot is to be interrupted next, on everybody's clock.
    due: BinaryHeap<Reverse<(Time, u32)>>,
    /// Seconds of everybody's clock between two interruptions of a robot, on average.
    every_s: f64,
    random: ChaCha8Rng,
    asked: u64,
    heard: mpsc::UnboundedReceiver<(u32, Symbol, Event)>,
    _subscriber: Subscriber<()>,
    pub(super) tally: Tally,
}

impl<'a> Crowd<'a> {
    /// Of that many robots, none of which has anything to do yet.
    pub(super) async fn new(
        session: &Session,
        clock: Clock,
        site: &'a Site,
        robots: u32,
        every_s: f64,
        seed: u64,
    ) -> Result<Self, Failure> {
        let (tell, heard) = mpsc::unbounded_channel();
        let subscriber = session
            .declare_subscriber(EVENTS)
            .callback(move |sample| {
                let number = number_of(sample.key_expr().as_str());
                let event = wire::numbered_event_from_line(&sample.payload().to_bytes());
                if let (Some(number), Ok((agent, _, event))) = (number, event) {
                    let _ = tell.send((number, agent, event));
                }
            })
            .await
            .map_err(Failure::failed)?;
        Ok(Self {
            session: session.clone(),
            clock,
            site,
            robots: (0..robots).map(|_| Followed::default()).collect(),
            due: BinaryHeap::new(),
            every_s,
            random: ChaCha8Rng::seed_from_u64(seed),
            asked: 0,
            heard,
            _subscriber: subscriber,
            tally: Tally::default(),
        })
    }

    /// Sends every robot on a tour.
    pub(super) async fn set_out(&mut self) -> Result<(), Failure> {
        for number in 0..self.robots.len() {
            self.tour(number as u32).await?;
        }
        Ok(())
    }

    /// How many robots drive.
    pub(super) fn driving(&self) -> usize {
        let drives = |robot: &&Followed| {
            let doing = robot.doing.as_ref();
            doing.is_some_and(|doing| drive(self.site, &doing.action).is_some())
        };
        self.robots.iter().filter(drives).count()
    }

    /// Lets robots drive for that long, without interrupting them.
    pub(super) async fn watch(&mut self, for_: Duration) -> Result<(), Failure> {
        self.due.clear();
        self.until(tokio::time::Instant::now() + for_).await
    }

    /// Interrupts them for that long.
    pub(super) async fn interrupt(&mut self, for_: Duration) -> Result<(), Failure> {
        let now = self.clock.now();
        for number in 0..self.robots.len() {
            let at = now + self.pause();
            self.due.push(Reverse((at, number as u32)));
        }
        self.until(tokio::time::Instant::now() + for_).await
    }

    /// Lets the interruptions that have begun come to their end, for no longer than that.
    pub(super) async fn settle(&mut self, patience: Duration) -> Result<(), Failure> {
        self.due.clear();
        let until = tokio::time::Instant::now() + patience;
        while self.tally.open() > 0 && tokio::time::Instant::now() < until {
            let soon = tokio::time::Instant::now() + Duration::from_millis(50);
            self.until(soon).await?;
        }
        Ok(())
    }

    async fn until(&mut self, end: tokio::time::Instant) -> Result<(), Failure> {
        loop {
            let next = self.due.peek().map(|Reverse((at, _))| *at);
            let due = async {
                match next {
                    Some(at) => self.clock.sleep_until(at).await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                biased;
                () = tokio::time::sleep_until(end) => return Ok(()),
                () = due => self.one_is_due().await?,
                heard = self.heard.recv() => {
                    let (number, agent, event) = heard
                        .ok_or_else(|| Failure::failed("nothing is heard any more"))?;
                    self.take_in(number, &agent, &event).await?;
                }
            }
        }
    }

    async fn take_in(&mut self, number: u32, agent: &Symbol, event: &Event) -> Result<(), Failure> {
        let Some(robot) = self.robots.get_mut(number as usize) else {
            return Ok(());
        };
        robot.heard(agent, event);
        if let Some(reason) = robot.rejected() {
            return Err(Failure::failed(format_args!(
                "an emergency was rejected: {reason}"
            )));
        }
        match robot.ended(self.site) {
            Some(Ending::Broken(stamps)) => self.tally.broken.push(stamps),
            Some(Ending::TooLate | Ending::Kept) => self.tally.others += 1,
            None => {}
        }
        if robot.tour.is_none() {
            self.tour(number).await?;
        }
        Ok(())
    }

    async fn one_is_due(&mut self) -> Result<(), Failure> {
        let Some(Reverse((_, number))) = self.due.pop() else {
            return Ok(());
        };
        let now = self.clock.now();
        let robot = self.robots.get(number as usize);
        let free = robot.filter(|robot| !robot.is_interrupted());
        let doing = free.and_then(|robot| robot.doing.as_ref());
        let from = doing.and_then(|doing| drive(self.site, &doing.action));
        let Some((from, _)) = from else {
            let later = Time::from_secs(LOOK_AGAIN_S * self.clock.speed());
            self.due.push(Reverse((now + later, number)));
            return Ok(());
        };
        let id = self.name("emergency");
        if let Some(robot) = self.robots.get_mut(number as usize) {
            robot.interrupted(id.clone(), self.clock.now());
        }
        self.tally.put += 1;
        self.ask(number, Urgency::Emergency, &id, &from).await?;
        let pause = self.pause();
        self.due.push(Reverse((now + pause, number)));
        Ok(())
    }

    async fn tour(&mut self, number: u32) -> Result<(), Failure> {
        let id = self.name("tour");
        let count = self.site.nodes().count();
        let place = self.random.random_range(0..count);
        let target = self.site.nodes().nth(place);
        let target = target.map(|node| node.name().clone()).unwrap_or_default();
        if let Some(robot) = self.robots.get_mut(number as usize) {
            robot.tour = Some(id.clone());
        }
        self.ask(number, Urgency::Normal, &id, &target).await
    }

    async fn ask(
        &self,
        number: u32,
        urgency: Urgency,
        id: &GoalId,
        to: &Symbol,
    ) -> Result<(), Failure> {
        let keys = keys(number)?;
        let key = match urgency {
            Urgency::Normal => keys.goal_normal(),
            Urgency::Emergency => keys.goal_emergency(),
        };
        let text = wire::goal_to_wire(&going(id, urgency, to)).map_err(Failure::failed)?;
        let put = self.session.put(key, text);
        let put = put.congestion_control(CongestionControl::Block);
        put.await.map_err(Failure::failed)
    }

    /// The time to the next interruption of a robot: as between any events that do not wait for each
    /// other.
    fn pause(&mut self) -> Time {
        let lot: f64 = self.random.random_range(f64::EPSILON..1.0);
        Time::from_secs(-lot.ln() * self.every_s * self.clock.speed())
    }

    fn name(&mut self, kind: &str) -> GoalId {
        self.asked += 1;
        GoalId::from(format!("{kind}-{}", self.asked))
    }
}
