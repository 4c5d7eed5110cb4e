//! Whether a goal is exactly what it was when it was written down last. What is shared is compared
//! by where it is: this is asked of every goal after every input.

use std::sync::Arc;

use super::super::{Execution, Goal, Intention, Phase, Record, Running};
use crate::planner::{Agenda, Plan, Step, TaskList};

/// What was written down of a goal.
#[derive(Clone, Debug)]
pub(super) struct Written {
    intention: Intention,
    pursuit: Option<Pursuit>,
    /// The number of its map.
    pub map: Option<u64>,
}

/// [`Running`] but for its goal.
#[derive(Clone, Debug)]
struct Pursuit {
    phase: Phase,
    resumed: bool,
    set_aside: bool,
    broken: Option<String>,
    surprised: bool,
}

impl Written {
    pub fn new(intention: &Intention, running: Option<&Running>, map: Option<u64>) -> Self {
        Self {
            intention: intention.clone(),
            pursuit: running.map(|running| {
                let Running {
                    intention: _,
                    phase,
                    resumed,
                    set_aside,
                    broken,
                    surprised,
                    stage: _,
                } = running;
                Pursuit {
                    phase: phase.clone(),
                    resumed: *resumed,
                    set_aside: *set_aside,
                    broken: broken.clone(),
                    surprised: *surprised,
                }
            }),
            map,
        }
    }

    pub fn is_still(&self, intention: &Intention, running: Option<&Running>) -> bool {
        let pursuit = match (&self.pursuit, running) {
            (None, None) => true,
            (Some(before), Some(now)) => {
                same_phase(&before.phase, &now.phase)
                    && before.resumed == now.resumed
                    && before.set_aside == now.set_aside
                    && before.broken == now.broken
                    && before.surprised == now.surprised
            }
            _ => false,
        };
        pursuit && same_intention(&self.intention, intention)
    }
}

fn same_phase(a: &Phase, b: &Phase) -> bool {
    match (a, b) {
        // Written down alike.
        (Phase::Planning | Phase::Ready(_), Phase::Planning | Phase::Ready(_)) => true,
        (Phase::Executing(a), Phase::Executing(b)) | (Phase::Stopping(a), Phase::Stopping(b)) => {
            let Execution {
                id,
                executor,
                step,
                due,
                done,
            } = a;
            *id == b.id
                && *executor == b.executor
                && same_step(step, &b.step)
                && *due == b.due
                && *done == b.done
        }
        _ => false,
    }
}

fn same_intention(a: &Intention, b: &Intention) -> bool {
    let Intention {
        goal,
        agendas,
        plans,
        records,
        started,
        cancelled,
        orphaned,
        fits,
        blocked_by,
        failures,
        failed,
        last_failure,
        lost,
        done_once,
    } = a;
    same_goal(goal, &b.goal)
        && *started == b.started
        && *fits == b.fits
        && *cancelled == b.cancelled
        && *orphaned == b.orphaned
        && all(agendas, &b.agendas, same_agenda)
        && all(records, &b.records, same_record)
        && all(plans, &b.plans, same_plan)
        && *blocked_by == b.blocked_by
        && *failures == b.failures
        && *failed == b.failed
        && *last_failure == b.last_failure
        && *lost == b.lost
        && *done_once == b.done_once
}

fn same_goal(a: &Goal, b: &Goal) -> bool {
    let Goal {
        id,
        tasks,
        urgency,
        priority,
        deadline,
        number,
        superior,
        map,
    } = a;
    *number == b.number
        && Arc::ptr_eq(map, &b.map)
        && *id == b.id
        && *tasks == b.tasks
        && *urgency == b.urgency
        && *priority == b.priority
        && *deadline == b.deadline
        && *superior == b.superior
}

fn same_agenda(a: &Agenda, b: &Agenda) -> bool {
    let Agenda { tasks, origin } = a;
    same_list(tasks, &b.tasks) && *origin == b.origin
}

fn same_record(a: &Record, b: &Record) -> bool {
    let Record { id, executor, step } = a;
    *id == b.id && *executor == b.executor && same_step(step, &b.step)
}

fn same_plan(a: &Plan, b: &Plan) -> bool {
    let Plan { steps, rest, cost } = a;
    *cost == b.cost && same_list(rest, &b.rest) && all(steps, &b.steps, same_step)
}

fn same_step(a: &Step, b: &Step) -> bool {
    let Step {
        item,
        cost,
        frame,
        rest,
    } = a;
    let same_frame = match (frame, &b.frame) {
        (None, None) => true,
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        _ => false,
    };
    same_frame && same_list(rest, &b.rest) && *cost == b.cost && *item == b.item
}

fn same_list(a: &TaskList, b: &TaskList) -> bool {
    a.address() == b.address()
}

fn all<T>(a: &[T], b: &[T], same: fn(&T, &T) -> bool) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Atom, Cost, Map, Time};
    use crate::planner::{Frame, Item, Origin};
    use crate::protocol::{ActionId, Urgency};

    fn step() -> Step {
        let item = Item::Task(Atom::new("go", []));
        let frame = Frame {
            id: 1,
            task: item.clone(),
            rest: TaskList::empty(),
            parent: None,
        };
        Step {
            rest: TaskList::empty().prepend(item.clone(), None),
            item,
            cost: Cost(1),
            frame: Some(Arc::new(frame)),
        }
    }

    fn id(number: u64) -> ActionId {
        ActionId {
            agent: "mid".into(),
            epoch: 1,
            number,
        }
    }

    fn running() -> Running {
        let mut intention = Intention::new(Goal {
            id: "goal".into(),
            tasks: vec![Atom::new("go", [])],
            urgency: Urgency::Normal,
            priority: 0,
            deadline: None,
            number: 1,
            superior: None,
            map: Arc::new(Map::default()),
        });
        intention.plans.push(Plan {
            steps: vec![step()],
            rest: step().rest,
            cost: Cost(1),
        });
        intention.records.push(Record {
            id: id(1),
            executor: "left".into(),
            step: step(),
        });
        Running {
            intention,
            phase: Phase::Executing(Execution {
                id: id(2),
                executor: "left".into(),
                step: step(),
                due: None,
                done: None,
            }),
            resumed: false,
            set_aside: false,
            broken: None,
            surprised: false,
            stage: Default::default(),
        }
    }

    fn execution(running: &mut Running) -> &mut Execution {
        match &mut running.phase {
            Phase::Executing(execution) => execution,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn whatever_is_different_of_a_goal_is_noticed_and_nothing_else() {
        let before = running();
        let written = Written::new(&before.intention, Some(&before), None);
        assert!(written.is_still(&before.intention, Some(&before)));
        let copy = before.clone();
        assert!(written.is_still(&copy.intention, Some(&copy)));
        let alike = || step().rest;
        let changes: &[fn(&mut Running)] = &[
            |it| it.resumed = true,
            |it| it.set_aside = true,
            |it| it.broken = Some(String::new()),
            |it| it.surprised = true,
            |it| it.phase = Phase::Planning,
            |it| it.phase = Phase::Stopping(execution(it).clone()),
            |it| execution(it).id = id(3),
            |it| execution(it).executor = "right".into(),
            |it| execution(it).due = Some(Time::ZERO),
            |it| execution(it).done = Some(Vec::new()),
            |it| execution(it).step.frame = None,
            |it| execution(it).step.frame = step().frame,
            |it| execution(it).step.cost = Cost(2),
            |it| execution(it).step.item = Item::Task(Atom::new("stay", [])),
            |it| it.intention.goal.map = Arc::new(Map::default()),
            |it| it.intention.goal.deadline = Some(Time::ZERO),
            |it| it.intention.agendas[0].origin = Origin::Tail,
            |it| it.intention.agendas.clear(),
            |it| it.intention.plans[0].cost = Cost(2),
            |it| it.intention.plans[0].steps.clear(),
            |it| it.intention.plans.clear(),
            |it| it.intention.records[0].executor = "right".into(),
            |it| it.intention.records[0].id = id(3),
            |it| it.intention.records[0].step = step(),
            |it| it.intention.records.clear(),
            |it| it.intention.started = true,
            |it| it.intention.fits = false,
            |it| it.intention.orphaned = true,
            |it| it.intention.cancelled = Some(String::new()),
            |it| it.intention.failed = Some((Atom::new("go", []), true)),
            |it| it.intention.last_failure = Some(String::new()),
            |it| it.intention.blocked_by.extend([Atom::new("open", [])]),
            |it| it.intention.failures.extend([(Atom::new("go", []), 1)]),
            |it| it.intention.lost.extend([id(1)]),
            |it| it.intention.done_once.extend([1]),
        ];
        for (number, change) in changes.iter().enumerate() {
            let mut after = before.clone();
            change(&mut after);
            assert!(
                !written.is_still(&after.intention, Some(&after)),
                "{number}"
            );
        }
        // What only looks alike has another place in the network.
        for change in [0, 1, 2] {
            let mut after = before.clone();
            match change {
                0 => execution(&mut after).step.rest = alike(),
                1 => after.intention.plans[0].rest = alike(),
                _ => after.intention.agendas[0].tasks = alike(),
            }
            assert!(
                !written.is_still(&after.intention, Some(&after)),
                "{change}"
            );
        }
        assert!(!written.is_still(&before.intention, None));
    }
}
