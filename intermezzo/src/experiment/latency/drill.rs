//! A robot on a tour without end, and somebody who interrupts it again and again.

use std::time::Duration;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Command, GoalId, Urgency};
use agent_link::{Client, Clock, Keys, Session, wire};
use maps::Site;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use zenoh::qos::CongestionControl;

use super::super::follow::{Ending, Followed, drive, going};
use super::bare::Bare;
use super::witness::{Heard, Witness};
use crate::exit::Failure;

/// Nothing that is waited for takes longer, planning in the largest museum included.
const PATIENCE: Duration = Duration::from_secs(180);

/// A drive is interrupted this long, in seconds of the world, after it has begun, at the earliest.
const SETTING_OFF_S: f64 = 0.3;

/// And at the latest when at top speed it could have covered this share of its way: so it is never too
/// near to its end to brake.
const SHARE_OF_WAY: f64 = 0.7;

/// What emergencies ask for.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Emergency {
    /// To go back to where the drive began: little to plan.
    Near,
    /// To go to a node anywhere, which takes a large plan; it is cancelled once its first action has
    /// begun.
    Far,
}

/// Somebody who interrupts a robot.
pub(super) struct Drill<'a> {
    client: Client,
    session: Session,
    keys: Keys,
    clock: Clock,
    site: &'a Site,
    witness: Witness,
    bare: Bare,
    random: ChaCha8Rng,
    /// How many goals were asked for.
    asked: u64,
    robot: Followed,
}

impl<'a> Drill<'a> {
    /// With two clients of the robot's router: one that asks and listens, and one that sends back
    /// what it is sent.
    pub(super) async fn new(
        session: &Session,
        other: &Session,
        keys: &Keys,
        clock: Clock,
        site: &'a Site,
        seed: u64,
    ) -> Result<Self, Failure> {
        Ok(Self {
            client: Client::new(session, keys),
            session: session.clone(),
            keys: keys.clone(),
            clock,
            site,
            witness: Witness::of(session, keys, clock).await?,
            bare: Bare::between(session, other, &format!("intermezzo-bare/{}", keys.robot()))
                .await?,
            random: ChaCha8Rng::seed_from_u64(seed),
            asked: 0,
            robot: Followed::default(),
        })
    }

    /// One interruption, and one bare round trip on the way to it.
    pub(super) async fn interrupt(
        &mut self,
        kind: Emergency,
    ) -> Result<(Ending, Option<Duration>), Failure> {
        let all = async {
            let (from, bare) = self.until_well_on_its_way().await?;
            let ending = self.one(kind, from).await?;
            Ok((ending, bare))
        };
        match tokio::time::timeout(PATIENCE, all).await {
            Ok(done) => done,
            Err(_) => Err(Failure::failed(format_args!(
                "an interruption has not come to its end within {PATIENCE:?}"
            ))),
        }
    }

    /// Returns where the drive has begun, and how long a bare round trip took: as long after what was
    /// sent before as the emergency will be, so that neither finds the threads more awake.
    async fn until_well_on_its_way(&mut self) -> Result<(Symbol, Option<Duration>), Failure> {
        loop {
            if self.robot.tour.is_none() {
                self.begin_tour().await?;
            }
            let drive = self.robot.doing.as_ref().and_then(|doing| {
                let (from, length_m) = drive(self.site, &doing.action)?;
                Some((from, length_m, doing.since))
            });
            let Some((from, length_m, since)) = drive else {
                self.hear().await?;
                continue;
            };
            let latest_s = (length_m * SHARE_OF_WAY).max(SETTING_OFF_S + 0.1);
            let wait_s = self.random.random_range(SETTING_OFF_S..latest_s);
            let after = |share: f64| since + Time::from_secs(wait_s * share);
            if self.drives_on(since, after(0.5)).await? {
                let bare = self.bare.round_trip().await;
                if self.drives_on(since, after(1.0)).await? {
                    return Ok((from, bare));
                }
            }
        }
    }

    /// Whether the drive that has begun `since` goes on at that time, which is to come. If not, another
    /// has begun, or none.
    async fn drives_on(&mut self, since: Time, until: Time) -> Result<bool, Failure> {
        let in_time = self.clock.now() < until;
        loop {
            tokio::select! {
                biased;
                heard = self.witness.next() => {
                    self.take_in(heard)?;
                    let doing = self.robot.doing.as_ref();
                    if doing.is_none_or(|doing| doing.since != since) {
                        return Ok(false);
                    }
                }
                () = self.clock.sleep_until(until), if in_time => return Ok(true),
            }
        }
    }

    /// Interrupts, and follows the interruption to its end.
    async fn one(&mut self, kind: Emergency, from: Symbol) -> Result<Ending, Failure> {
        let target = match kind {
            Emergency::Near => from,
            Emergency::Far => self.anywhere(),
        };
        let id = self.name("emergency");
        let goal = going(&id, Urgency::Emergency, &target);
        let text = wire::goal_to_wire(&goal).map_err(Failure::failed)?;
        let key = self.keys.goal_emergency();
        self.robot.interrupted(id.clone(), self.clock.now());
        self.session
            .put(key, text)
            .congestion_control(CongestionControl::Block)
            .await
            .map_err(Failure::failed)?;
        let mut cancelled = false;
        loop {
            if let Some(ending) = self.robot.ended(self.site) {
                return Ok(ending);
            }
            self.hear().await?;
            if let Some(reason) = self.robot.rejected() {
                return Err(Failure::failed(format_args!(
                    "an emergency was rejected: {reason}"
                )));
            }
            if kind == Emergency::Far && self.robot.has_begun() && !cancelled {
                cancelled = true;
                self.cancel(&id).await?;
            }
        }
    }

    async fn cancel(&self, id: &GoalId) -> Result<(), Failure> {
        let command = Command::Cancel(id.clone());
        // It may have ended meanwhile.
        let verdict = self.client.command(&command).await;
        verdict.map(|_| ()).map_err(Failure::failed)
    }

    async fn begin_tour(&mut self) -> Result<(), Failure> {
        let target = self.anywhere();
        let id = self.name("tour");
        let goal = going(&id, Urgency::Normal, &target);
        self.robot.tour = Some(id);
        let verdict = self.client.goal(goal).await.map_err(Failure::failed)?;
        match verdict.reason {
            Some(reason) if !verdict.accepted => Err(Failure::failed(format_args!(
                "a tour was rejected: {reason}"
            ))),
            _ => Ok(()),
        }
    }

    async fn hear(&mut self) -> Result<(), Failure> {
        let heard = self.witness.next().await;
        self.take_in(heard)
    }

    fn take_in(&mut self, heard: Option<(Time, Heard)>) -> Result<(), Failure> {
        let (at, heard) =
            heard.ok_or_else(|| Failure::failed("nothing is heard of the robot any more"))?;
        match heard {
            Heard::Event(agent, event) => self.robot.heard(&agent, &event),
            Heard::Seen { motion, since } => self.robot.seen(motion, since, at),
        }
        Ok(())
    }

    fn anywhere(&mut self) -> Symbol {
        let count = self.site.nodes().count();
        let place = self.random.random_range(0..count);
        let node = self.site.nodes().nth(place);
        node.map(|node| node.name().clone()).unwrap_or_default()
    }

    fn name(&mut self, kind: &str) -> GoalId {
        self.asked += 1;
        GoalId::from(format!("{kind}-{}", self.asked))
    }
}
