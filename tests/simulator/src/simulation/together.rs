//! One clock and one network for all robots that there are.

use std::collections::BTreeMap;

use agent_core::model::Time;

use crate::fleet::Fleet;
use crate::ground::Ground;
use crate::mutant::Mutant;
use crate::scenario::Scenario;

use super::{Due, MOST_STEPS, Outcome, Simulation};

/// The network that has robots mixed up does so with every message of this number.
const MIXED_UP: u64 = 150;

/// Runs a scenario of one robot. `tells`: with its story.
pub fn run(ground: &Ground, scenario: &Scenario, mutant: Option<Mutant>, tells: bool) -> Outcome {
    let mut together = Together::new(ground, [scenario], mutant, tells);
    together.go();
    together.outcome()
}

/// Runs robots beside each other.
///
/// None changes anything of another: with `fleet.alone`, what each does is compared with what it
/// does when it is alone.
pub fn run_fleet(ground: &Ground, fleet: &Fleet, mutant: Option<Mutant>, tells: bool) -> Outcome {
    let mut together = Together::new(ground, &fleet.robots, mutant, tells);
    together.go();
    let traces: Vec<u64> = together.robots.iter().map(|robot| robot.trace).collect();
    let mut outcome = together.outcome();
    if fleet.alone && outcome.broken.is_none() {
        for (robot, (scenario, trace)) in fleet.robots.iter().zip(traces).enumerate() {
            let mut alone = Together::new(ground, [scenario], mutant, false);
            alone.go();
            if alone.robots.iter().any(|robot| robot.trace != trace) {
                let broken = format!("robot {robot} does otherwise when it is alone");
                outcome.broken = Some(broken);
            }
        }
    }
    outcome
}

/// Robots, and what is due for them.
struct Together<'a> {
    robots: Vec<Simulation<'a>>,
    now: Time,
    due: BTreeMap<(Time, u64), (u8, Due)>,
    counter: u64,
    mixes_up: bool,
}

impl<'a> Together<'a> {
    fn new(
        ground: &'a Ground,
        scenarios: impl IntoIterator<Item = &'a Scenario>,
        mutant: Option<Mutant>,
        tells: bool,
    ) -> Self {
        let robots = (0..).zip(scenarios);
        let robots =
            robots.map(|(n, scenario)| Simulation::new(ground, scenario, n, mutant, tells));
        let mut together = Self {
            robots: robots.collect(),
            now: Time::ZERO,
            due: BTreeMap::new(),
            counter: 0,
            mixes_up: mutant == Some(Mutant::MixUpRobots),
        };
        for robot in 0..together.robots.len() {
            together.take_planned(robot);
        }
        together
    }

    fn go(&mut self) {
        for _ in 0..MOST_STEPS * self.robots.len() as u64 {
            match self.step() {
                None => {
                    for robot in &mut self.robots {
                        if robot.peace {
                            robot.judge();
                        } else {
                            robot.broken(|| "it ended before there was peace".to_owned());
                        }
                    }
                    return;
                }
                Some(robot) => {
                    if self.robots[robot].law.broken.is_some() {
                        return;
                    }
                }
            }
        }
        for robot in &mut self.robots {
            robot.broken(|| "it goes round in circles".to_owned());
        }
    }

    /// The robot for which something has happened; `None` if nothing is left to happen.
    fn step(&mut self) -> Option<usize> {
        let wakes = self.robots.iter().enumerate();
        let wakes = wakes.filter_map(|(n, robot)| Some((robot.next_wake()?, n)));
        let wake = wakes.min_by_key(|((at, _), _)| *at);
        let next = self.due.first_key_value().map(|((at, _), _)| *at);
        let wake = wake.filter(|((at, _), _)| next.is_none_or(|next| *at < next));
        if let Some(((at, who), robot)) = wake {
            self.at(at, robot).wake(who);
            self.take_planned(robot);
            return Some(robot);
        }
        let ((at, number), (robot, due)) = self.due.pop_first()?;
        let mut robot = usize::from(robot);
        if self.mixes_up && matches!(due, Due::Deliver { .. }) && number % MIXED_UP == 0 {
            robot = (robot + 1) % self.robots.len();
        }
        self.at(at, robot).happen(due);
        self.take_planned(robot);
        Some(robot)
    }

    fn at(&mut self, at: Time, robot: usize) -> &mut Simulation<'a> {
        self.now = self.now.max(at);
        let robot = &mut self.robots[robot];
        robot.now = self.now;
        robot
    }

    fn take_planned(&mut self, robot: usize) {
        for (at, due) in self.robots[robot].planned.drain(..) {
            self.counter += 1;
            let to = match &due {
                Due::Deliver { robot, .. } => *robot,
                _ => robot as u8,
            };
            self.due.insert((at, self.counter), (to, due));
        }
    }

    fn outcome(mut self) -> Outcome {
        let many = self.robots.len() > 1;
        let mut all = Outcome::default();
        let mut story: Vec<(Time, String)> = Vec::new();
        for (n, robot) in self.robots.iter_mut().enumerate() {
            all.counts += &robot.outcome.counts;
            let broken = robot.law.broken.take();
            let broken = broken.map(|what| {
                if many {
                    format!("robot {n}: {what}")
                } else {
                    what
                }
            });
            all.broken = all.broken.or(broken);
            let lines = robot.story.drain(..);
            story.extend(lines.map(|(at, line)| {
                let line = if many { format!("{n} {line}") } else { line };
                (at, line)
            }));
        }
        story.sort_by_key(|(at, _)| *at);
        let lines = story.into_iter();
        all.story = lines
            .map(|(at, line)| format!("{:>9.4} {line}", at.secs()))
            .collect();
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_runs_twice_alike() {
        let ground = Ground::new();
        for seed in 0..20 {
            let scenario = Scenario::of(seed);
            let one = run(&ground, &scenario, None, true);
            let other = run(&ground, &scenario, None, true);
            assert_eq!(one.story, other.story);
        }
    }

    #[test]
    fn robots_beside_each_other_do_what_they_do_alone() {
        let ground = Ground::new();
        for seed in 0..20 {
            let fleet = Fleet::of(seed);
            let together = run_fleet(&ground, &fleet, None, true);
            assert_eq!(together.broken, None);
            for (n, scenario) in fleet.robots.iter().enumerate() {
                let alone = run(&ground, scenario, None, true);
                let prefix = format!("{n} ");
                let own = together.story.iter().filter_map(|line| {
                    let (at, line) = line.split_at_checked(10)?;
                    Some(format!("{at}{}", line.strip_prefix(&prefix)?))
                });
                assert_eq!(own.collect::<Vec<_>>(), alone.story);
            }
        }
    }
}
