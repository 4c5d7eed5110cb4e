//! One tree, played to an agent and judged.

use super::*;

pub(super) struct Case<P> {
    tree: Tree,
    dice: Dice,
    agent: Agent<P>,
    attempts: u32,
    seed: u64,
    now: Time,
    events: Vec<Event>,
    goals: usize,
    stopping: bool,
}

impl<P: Planner> Case<P> {
    pub(super) fn new(seed: u64, planner: P) -> Self {
        let mut dice = Dice::new(seed);
        let tree = Tree::new(&mut dice);
        let (configuration, attempts) = tree.configuration(&mut dice);
        Self {
            agent: Agent::new(configuration, planner),
            tree,
            dice,
            attempts,
            seed,
            now: Time::ZERO,
            events: Vec::new(),
            goals: 0,
            stopping: false,
        }
    }

    pub(super) fn give(&mut self, input: Input<std::convert::Infallible>) {
        self.now = self.now + Time::from_secs(0.1);
        self.agent.handle(self.now, input);
        while self.agent.wake_at() == Some(Time::ZERO) {
            self.agent.handle(self.now, Input::Wake);
        }
        self.agent.check();
        self.events.clear();
        self.stopping = false;
        while let Some(output) = self.agent.poll_output() {
            match output {
                Output::Event(event) => self.events.push(event),
                Output::Instruct {
                    instruction: Instruction::Suspend { .. },
                    ..
                } => self.stopping = true,
                _ => {}
            }
        }
    }

    pub(super) fn some_facts(&mut self) -> Vec<FactChange> {
        let count = self.dice.roll(3);
        let facts = (0..count).map(|_| {
            let fact = atom(&format!("(p{})", self.dice.roll(FACTS)));
            match self.dice.chance(50) {
                true => FactChange::Add(fact),
                false => FactChange::Remove(fact),
            }
        });
        facts.collect()
    }

    pub(super) fn goal(&mut self, urgency: Urgency) {
        self.goals += 1;
        let count = 1 + self.dice.roll(2);
        let tasks = (0..count).map(|_| atom(&name(Do::Task(self.dice.roll(2)))));
        let goal = GoalRequest {
            id: Some(format!("goal{}", self.goals).into()),
            tasks: tasks.collect(),
            urgency,
            priority: 0,
            deadline: None,
        };
        self.give(Input::Goal(goal));
    }

    /// The running action, as the oracle knows it.
    pub(super) fn running(&self) -> Option<(Item, Vec<Do>, Above)> {
        let execution = self.agent.running.as_ref()?.execution()?;
        let step = &execution.step;
        let above = std::iter::successors(step.frame.as_ref(), |frame| frame.parent.as_ref());
        let above = above.map(|frame| (number(frame.task.purpose()), list(&frame.rest)));
        Some((step.item.clone(), list(&step.rest), above.collect()))
    }

    /// What ought to come of it if the running action fails now, with the belief as it is going to be.
    pub(super) fn expected(
        &self,
        state: State,
        undo: Option<Do>,
        tally: &mut Tally,
    ) -> Option<Expected> {
        let (item, rest, above) = self.running()?;
        let failed = item.purpose().clone();
        let running = self.agent.running()?;
        let mut failures = running.failures.clone();
        *failures.entry(failed.clone()).or_default() += 1;
        let forbidden = |least: u32| -> BTreeSet<usize> {
            let often = failures.iter().filter(|(_, times)| **times >= least);
            let acts = often.filter_map(|(action, _)| match number(action) {
                Do::Act(number) => Some(number),
                _ => None,
            });
            acts.collect()
        };
        let least = |list: &[Do], without: &BTreeSet<usize>| {
            let direct = self.tree.solve(state, list, without);
            let undone = undo.and_then(|undo| {
                let list = [&[undo], list].concat();
                self.tree.solve(state, &list, without)
            });
            direct.into_iter().chain(undone).min()
        };
        for (strict, times) in [(true, 1), (false, self.attempts)] {
            let without = forbidden(times);
            if !strict {
                let again = [&[number(&failed)], rest.as_slice()].concat();
                if let Some(cost) = least(&again, &without) {
                    tally.again += 1;
                    return Some(Expected::Again(cost));
                }
            }
            for (level, (task, rest)) in above.iter().enumerate() {
                let anew = [&[*task], rest.as_slice()].concat();
                if let Some(cost) = least(&anew, &without) {
                    *tally.levels.entry(level + 1).or_default() += 1;
                    tally.lenient += usize::from(!strict);
                    return Some(Expected::Anew(name(*task), level + 1, cost));
                }
            }
        }
        // A plan that was kept may be followed although it could not be made now: conditions of methods
        // count when a task is decomposed.
        let without = forbidden(self.attempts);
        let mut kept = Vec::new();
        for plan in &running.plans {
            let steps = plan.steps.iter();
            if steps
                .clone()
                .any(|step| !matches!(step.item, Item::Task(_)))
            {
                return None;
            }
            let acts: Vec<Do> = steps.map(|step| number(step.purpose())).collect();
            kept.extend(self.tree.solve(state, &acts, &without));
        }
        if let Some(cost) = kept.into_iter().min() {
            tally.again += 1;
            return Some(Expected::Again(cost));
        }
        tally.nothing += 1;
        Some(Expected::Nothing)
    }

    /// What has come of it.
    pub(super) fn outcome(&self, goal: &GoalId) -> Expected {
        let mut anew = None;
        let plan = self
            .agent
            .running()
            .and_then(|running| running.plans.first());
        let mut length = plan.map_or(0, |plan| plan.steps.len());
        for event in self
            .events
            .iter()
            .filter(|event| event.goal.as_ref() == Some(goal))
        {
            match &event.what {
                Happening::TaskRepaired { task, levels, .. } => {
                    anew = Some((task.to_string(), *levels));
                }
                Happening::GoalBlocked { .. } | Happening::GoalFailed { .. } => {
                    return Expected::Nothing;
                }
                // The task was done already.
                Happening::GoalSucceeded => length = 0,
                _ => {}
            }
        }
        match anew {
            Some((task, level)) => Expected::Anew(task, level, length),
            None => Expected::Again(length),
        }
    }

    /// The plans and agendas of goals that are not pursued.
    pub(super) fn others(&self) -> String {
        let entries = self.agent.stack().entries().iter();
        let others = entries.map(|entry| (&entry.intention.plans, &entry.intention.agendas));
        format!("{:?}", others.collect::<Vec<_>>())
    }

    /// The running action ends in failure. `report`: with which facts.
    pub(super) fn fail(&mut self, report: Report, tally: &mut Tally) {
        let (facts, stopped) = match &report {
            Report::Failure { facts, .. } => (facts.clone(), false),
            Report::Suspended { facts } => (facts.clone(), true),
            _ => return,
        };
        let Some((id, _, _)) = self.agent.executing() else {
            return;
        };
        let id = id.clone();
        let mut belief = self.agent.belief().clone();
        belief.apply_all(&facts);
        let state = belief.facts().fold(0, |state, fact| {
            let bit: u32 = fact.name.as_str()[1..].parse().expect("a number");
            state | 1 << bit
        });
        let Some((item, ..)) = self.running() else {
            return;
        };
        let (Do::Act(act) | Do::Undo(act)) = number(item.purpose()) else {
            return;
        };
        let goal = self.tree.acts[act].adds[0];
        let monitored = self.tree.acts[act].protects.is_some();
        let acting = matches!(number(item.purpose()), Do::Act(_));
        let achieved = acting && monitored && holds(state, goal);
        let undoing_has_failed = self.agent.running().is_some_and(|running| {
            let mut failed = running.failures.keys();
            failed.any(|action| matches!(number(action), Do::Undo(_)))
        });
        let others = self.others();
        let pursued = self.agent.running_goal().unwrap_or_default();
        // What goes first goes first.
        let interrupted = self.agent.waiting().most_urgent().is_some();
        let told = !achieved && !undoing_has_failed && acting && !interrupted;
        let undo = (stopped && acting).then_some(Do::Undo(act));
        tally.undone += usize::from(told && undo.is_some());
        let expected = told.then(|| self.expected(state, undo, tally)).flatten();
        self.give(Input::Report { id, report });
        // What was told may have let one go on that is more urgent.
        let gives_way = self.events.iter().any(|event| {
            event.goal.as_ref() == Some(&pursued)
                && matches!(event.what, Happening::GoalSuspended { .. })
        });
        if let Some(expected) = expected.filter(|_| !gives_way) {
            let outcome = self.outcome(&pursued);
            assert_eq!(
                outcome,
                expected,
                "TREE_SEED={}\n{:#?}\n{}",
                self.seed,
                self.events,
                self.tree.hddl()
            );
            let still = self.agent.running_goal() == Some(pursued);
            if still && others != "[]" {
                tally.others += 1;
                assert_eq!(self.others(), others, "TREE_SEED={}", self.seed);
            }
        }
    }

    pub(super) fn run(&mut self, tally: &mut Tally) {
        for _ in 0..25 {
            let Some((id, action, _)) = self.agent.executing() else {
                self.goal(Urgency::Normal);
                continue;
            };
            let (id, action): (_, Action) = (id.clone(), action.clone());
            match self.dice.roll(100) {
                0..=39 => {
                    let problem = self.agent.problem();
                    let facts = crate::planner::effect_of(&problem, &action);
                    let goal_state = match self.running().map(|(item, ..)| number(item.purpose())) {
                        Some(Do::Act(act)) => Some(self.tree.acts[act].adds[0]),
                        _ => None,
                    };
                    let told = goal_state.map(|it| FactChange::Add(atom(&format!("(p{it})"))));
                    let facts = facts.into_iter().chain(told).collect();
                    let report = Report::Success { facts };
                    self.give(Input::Report { id, report });
                }
                40..=69 => {
                    let report = Report::Failure {
                        reason: "it went wrong".to_owned(),
                        facts: self.some_facts(),
                        blocked_by: Vec::new(),
                    };
                    self.fail(report, tally);
                }
                70..=89 => {
                    let facts = self.some_facts();
                    self.give(Input::Observation(facts));
                    if self.stopping {
                        self.stop(id, tally);
                    }
                }
                _ if self.agent.stack().depth() < 2 => {
                    self.goal(Urgency::Emergency);
                    if self.stopping {
                        let facts = Vec::new();
                        let report = Report::Suspended { facts };
                        self.give(Input::Report { id, report });
                    }
                }
                _ => {}
            }
        }
    }

    /// It was told to stop for a state that it protects.
    pub(super) fn stop(&mut self, id: crate::protocol::ActionId, tally: &mut Tally) {
        self.give(Input::Answer {
            to: Instruction::Suspend { id },
            answer: Answer::Suspending,
        });
        let Some((_, action, true)) = self.agent.executing() else {
            return;
        };
        let Do::Act(act) = number(&atom(&action.to_string().replace("resume-", "a"))) else {
            return;
        };
        let half = FactChange::Add(atom(&format!("(p{})", half(act))));
        self.fail(Report::Suspended { facts: vec![half] }, tally);
    }
}
