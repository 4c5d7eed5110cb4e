//! Where things are said: `intermezzo/<robot>/…`.

/// A name that cannot be part of a key.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum NameError {
    /// zenoh gives these characters a meaning, or terminals do.
    #[error(
        "`{0}` cannot be a name: use letters, digits, `-`, `_` and `.`, at most {MAX_NAME_LENGTH} of them"
    )]
    NotAName(String),
    /// An agent of this name would sit on one of the robot's own keys.
    #[error("no agent can be named `{0}`: that is a key of the robot itself")]
    Reserved(String),
}

/// Names are typed and read by people; longer ones are mistakes.
const MAX_NAME_LENGTH: usize = 64;

/// The first chunks below the robot that are not agents. `world` and `executor` are agents.
const RESERVED: [&str; 7] = [
    "goal",
    "facts",
    "event",
    "clock",
    "alive",
    "supervisor",
    "team",
];

/// In `intermezzo/<robot>/goal/emergency/<sender>`.
const SENDER_PLACE: usize = 4;

/// The keys of one robot.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Keys {
    robot: String,
}

/// The keys of one agent of a robot.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct AgentKeys {
    prefix: String,
}

impl Keys {
    /// The keys of the robot of this name.
    pub fn new(robot: &str) -> Result<Self, NameError> {
        check_name(robot)?;
        Ok(Self {
            robot: robot.to_owned(),
        })
    }

    /// The robot's name.
    pub fn robot(&self) -> &str {
        &self.robot
    }

    /// The keys of one of its agents.
    pub fn agent(&self, name: &str) -> Result<AgentKeys, NameError> {
        check_name(name)?;
        if RESERVED.contains(&name) {
            return Err(NameError::Reserved(name.to_owned()));
        }
        Ok(AgentKeys {
            prefix: self.under(name),
        })
    }

    fn under(&self, rest: &str) -> String {
        format!("intermezzo/{}/{rest}", self.robot)
    }

    /// Goals that wait for their turn: put or query.
    pub fn goal_normal(&self) -> String {
        self.under("goal/normal")
    }

    /// Goals that interrupt: put or query.
    pub fn goal_emergency(&self) -> String {
        self.under("goal/emergency")
    }

    /// As [`goal_normal`](Self::goal_normal), by somebody who says who that is.
    pub fn goal_normal_by(&self, sender: &str) -> Result<String, NameError> {
        self.goal_by(&self.goal_normal(), sender)
    }

    /// As [`goal_emergency`](Self::goal_emergency), by somebody who says who that is.
    pub fn goal_emergency_by(&self, sender: &str) -> Result<String, NameError> {
        self.goal_by(&self.goal_emergency(), sender)
    }

    fn goal_by(&self, key: &str, sender: &str) -> Result<String, NameError> {
        check_name(sender)?;
        Ok(format!("{key}/{sender}"))
    }

    /// Who asks for a goal on this key, if it says so.
    pub fn read_sender(key: &str) -> Option<&str> {
        let sender = key.split('/').nth(SENDER_PLACE)?;
        check_name(sender).ok().map(|()| sender)
    }

    /// Who says something on a key that ends with that.
    pub fn read_last(key: &str) -> Option<&str> {
        let (_, last) = key.rsplit_once('/')?;
        check_name(last).ok().map(|()| last)
    }

    /// What became of goals that came by plain put: published.
    pub fn goal_answers(&self) -> String {
        self.under("goal/answers")
    }

    /// Suspend, resume or cancel a goal: query.
    pub fn goal_command(&self) -> String {
        self.under("goal/command")
    }

    /// What turned out otherwise in the world: put or query.
    pub fn facts(&self) -> String {
        self.under("facts")
    }

    /// All events of all agents: published.
    pub fn event(&self) -> String {
        self.under("event")
    }

    /// What one vehicle says to all others of its team: published.
    pub fn team(&self, vehicle: &str) -> Result<String, NameError> {
        self.agent(vehicle)?;
        Ok(self.under(&format!("team/{vehicle}")))
    }

    /// What anyone says to all others of a team.
    pub fn team_any(&self) -> String {
        self.under("team/*")
    }

    /// The world's clock: query.
    pub fn clock(&self) -> String {
        self.under("clock")
    }

    /// From the controller to the world it moves in: query.
    pub fn world_command(&self) -> String {
        self.under("world/command")
    }

    /// Where everything is: published, the latest counts.
    pub fn world_pose(&self) -> String {
        self.under("world/pose")
    }

    /// From the world to the controller: query.
    pub fn executor_sensor(&self) -> String {
        self.under("executor/sensor")
    }

    /// How the processes of the roles are, where `intermezzo up` looks after them: query.
    pub fn supervisor_status(&self) -> String {
        self.under("supervisor/status")
    }

    /// The liveliness token of one start of an agent. Without the epoch, a process that takes the
    /// place of one that hangs would appear unseen.
    pub fn alive(&self, agent: &str, epoch: u64) -> Result<String, NameError> {
        self.alive_remembering(agent, epoch, epoch)
    }

    /// The same for an agent whose memory begins in an earlier epoch: neighbours see by it whether
    /// one that has started again knows what was before.
    pub fn alive_remembering(
        &self,
        agent: &str,
        epoch: u64,
        line: u64,
    ) -> Result<String, NameError> {
        self.agent(agent)?;
        let start = match line == epoch {
            true => epoch.to_string(),
            false => format!("{epoch}-{line}"),
        };
        Ok(self.under(&format!("alive/{agent}/{start}")))
    }

    /// The liveliness tokens of all agents.
    pub fn alive_any(&self) -> String {
        self.under("alive/*/*")
    }

    /// Agent and epoch of a liveliness token.
    pub fn read_alive(key: &str) -> Option<(&str, u64)> {
        let (agent, epoch, _) = Self::read_remembering(key)?;
        Some((agent, epoch))
    }

    /// Agent and epoch of a liveliness token, and the epoch in which the agent's memory begins.
    pub fn read_remembering(key: &str) -> Option<(&str, u64, u64)> {
        let (rest, start) = key.rsplit_once('/')?;
        let (_, agent) = rest.rsplit_once('/')?;
        let (epoch, line) = start.split_once('-').unwrap_or((start, start));
        Some((agent, epoch.parse().ok()?, line.parse().ok()?))
    }
}

impl AgentKeys {
    fn under(&self, rest: &str) -> String {
        format!("{}/{rest}", self.prefix)
    }

    /// From a superior: query.
    pub fn instruction(&self) -> String {
        self.under("instruction")
    }

    /// From an executor of this agent: query.
    pub fn report(&self) -> String {
        self.under("report")
    }

    /// Facts for superiors that did not cause them: published, and query for all that hold.
    pub fn facts(&self) -> String {
        self.under("facts")
    }

    /// What comes on one of its keys, from somebody of that name.
    ///
    /// # Errors
    /// If that cannot be part of a key.
    pub fn by(key: &str, sender: &str) -> Result<String, NameError> {
        check_name(sender)?;
        Ok(format!("{key}/{sender}"))
    }

    /// What comes on one of its keys, from anyone who says who that is.
    pub fn by_any(key: &str) -> String {
        format!("{key}/*")
    }

    /// As [`facts`](Self::facts), for one superior alone.
    ///
    /// # Errors
    /// If its name cannot be part of a key.
    pub fn facts_for(&self, superior: &str) -> Result<String, NameError> {
        Self::by(&self.facts(), superior)
    }

    /// Goals for this agent in particular that wait for their turn: put or query.
    pub fn goal_normal(&self) -> String {
        self.under("goal/normal")
    }

    /// Goals for this agent in particular that interrupt: put or query.
    pub fn goal_emergency(&self) -> String {
        self.under("goal/emergency")
    }

    /// Suspend, resume or cancel a goal of this agent's: query.
    pub fn goal_command(&self) -> String {
        self.under("goal/command")
    }

    /// One of the views into the agent: query.
    pub fn view(&self, view: &str) -> String {
        self.under(view)
    }
}

/// What can be a chunk of a key and also be typed and printed without surprise.
fn check_name(name: &str) -> Result<(), NameError> {
    let fits = !name.is_empty()
        && name.len() <= MAX_NAME_LENGTH
        && name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c));
    if fits {
        Ok(())
    } else {
        Err(NameError::NotAName(name.chars().take(80).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_begin_with_the_robot() {
        let keys = Keys::new("museum-1").unwrap();
        assert_eq!(keys.goal_normal(), "intermezzo/museum-1/goal/normal");
        assert_eq!(
            keys.agent("child").unwrap().instruction(),
            "intermezzo/museum-1/child/instruction"
        );
        let alive = keys.alive("child", 7).unwrap();
        assert_eq!(alive, "intermezzo/museum-1/alive/child/7");
        assert_eq!(Keys::read_alive(&alive), Some(("child", 7)));
        let alive = keys.alive_remembering("child", 7, 5).unwrap();
        assert_eq!(alive, "intermezzo/museum-1/alive/child/7-5");
        assert_eq!(Keys::read_alive(&alive), Some(("child", 7)));
        assert_eq!(Keys::read_remembering(&alive), Some(("child", 7, 5)));
    }

    #[test]
    fn the_key_of_a_goal_may_say_who_asks() {
        let keys = Keys::new("museum-1").unwrap();
        let key = keys.goal_emergency_by("anna").unwrap();
        assert_eq!(key, "intermezzo/museum-1/goal/emergency/anna");
        assert_eq!(Keys::read_sender(&key), Some("anna"));
        assert_eq!(Keys::read_sender(&keys.goal_emergency()), None);
        assert_eq!(Keys::read_sender("intermezzo/r/goal/normal/*"), None);
        assert!(keys.goal_normal_by("a/b").is_err());
    }

    #[test]
    fn keys_of_a_team_say_who_speaks() {
        let keys = Keys::new("r").unwrap();
        assert_eq!(keys.team("k1"), Ok("intermezzo/r/team/k1".to_owned()));
        assert!(keys.team("*").is_err());
        let room = keys.agent("room").unwrap();
        let key = AgentKeys::by(&room.instruction(), "k1").unwrap();
        assert_eq!(key, "intermezzo/r/room/instruction/k1");
        assert_eq!(Keys::read_last(&key), Some("k1"));
        assert_eq!(Keys::read_last(&AgentKeys::by_any(&room.report())), None);
        assert!(AgentKeys::by(&room.instruction(), "k1/**").is_err());
        assert!(room.facts_for("*").is_err());
    }

    #[test]
    fn names_that_would_reach_into_other_keys_are_refused() {
        for name in ["", "a/b", "*", "**", "$*", "a b", "a?", "a#", "ä", "a\n"] {
            assert_eq!(
                Keys::new(name),
                Err(NameError::NotAName(name.to_owned())),
                "{name:?}"
            );
        }
        let keys = Keys::new("r").unwrap();
        for name in RESERVED {
            assert_eq!(keys.agent(name), Err(NameError::Reserved(name.to_owned())));
        }
        assert!(keys.agent("executor").is_ok());
        assert!(keys.agent("world").is_ok());
        assert!(keys.agent(&"x".repeat(65)).is_err());
    }
}
