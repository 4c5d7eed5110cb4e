//! What an agent has in mind about one goal: agendas, plans, and records to resume from.

use std::collections::{BTreeMap, BTreeSet};

use super::goal::Goal;
use crate::model::{Action, Fact, Symbol};
use crate::planner::{Agenda, Frame, Item, Origin, Plan, Step, TaskList};
use crate::protocol::ActionId;

/// An action that an executor has suspended and can pick up again.
///
/// Invariant: the executor has been told to suspend it, has reported that it did, and has not been
/// told since to resume or clear it.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The execution.
    pub id: ActionId,
    /// Who keeps the record.
    pub executor: Symbol,
    /// What was being done.
    pub step: Step,
}

/// A goal with all that is kept for it (Algorithm 2 step 2: suspended plans and action).
#[derive(Clone, Debug, PartialEq)]
pub struct Intention {
    /// What it is for.
    pub goal: Goal,
    /// The ways to what remains, from the beginning of their first task. Never empty.
    pub agendas: Vec<Agenda>,
    /// Alternative plans, the one followed first.
    pub plans: Vec<Plan>,
    /// Suspended actions, the latest last.
    pub records: Vec<Record>,
    /// Whether work on it has begun.
    pub started: bool,
    /// Why it ends as soon as what is half done has been rolled back.
    pub cancelled: Option<String>,
    /// Whoever wanted it has forgotten it: it ends as it is, without anything being rolled back.
    pub orphaned: bool,
    /// Whether its first plan held when that was last looked at.
    pub fits: bool,
    /// Facts that executors named as missing.
    pub blocked_by: BTreeSet<Fact>,
    /// How often an action has failed.
    pub failures: BTreeMap<Action, u32>,
    /// The one that has failed last, until something is begun, and whether it was told what that is.
    pub failed: Option<(Action, bool)>,
    /// Why the last one did.
    pub last_failure: Option<String>,
    /// Executions of which the executor has lost the record.
    pub(super) lost: BTreeSet<ActionId>,
    /// Tasks under which something was done that must not be done again.
    pub(super) done_once: BTreeSet<u64>,
}

impl Intention {
    /// Nothing done yet.
    pub fn new(goal: Goal) -> Self {
        let tasks = TaskList::of_tasks(goal.tasks.iter().cloned());
        Self {
            goal,
            agendas: vec![Agenda {
                tasks,
                origin: Origin::Goal,
            }],
            plans: Vec::new(),
            records: Vec::new(),
            started: false,
            cancelled: None,
            orphaned: false,
            fits: true,
            blocked_by: BTreeSet::new(),
            failures: BTreeMap::new(),
            failed: None,
            last_failure: None,
            lost: BTreeSet::new(),
            done_once: BTreeSet::new(),
        }
    }

    /// Whether there is nothing left to do: a plan is successful (Algorithm 2, step 7d).
    pub fn is_over(&self) -> bool {
        self.plans
            .iter()
            .any(|plan| plan.steps.is_empty() && plan.rest.is_empty())
    }

    /// The agendas once `step` has been executed: what follows it, and every task that is still
    /// open, again.
    pub fn after(&mut self, step: &Step, may_be_repeated: bool) {
        self.failed = None;
        if !may_be_repeated {
            let open =
                std::iter::successors(step.frame.as_deref(), |frame| frame.parent.as_deref());
            self.done_once.extend(open.map(|frame| frame.id));
        }
        let mut agendas = vec![Agenda {
            tasks: step.rest.clone(),
            origin: Origin::Tail,
        }];
        if let Some((_, Some(frame), _)) = step.rest.first() {
            agendas.extend(self.ancestors(frame));
        }
        self.set_agendas(agendas);
    }

    /// The agendas while `step` has begun and not ended: itself, and every task that it is a part
    /// of, again. `resume`: the item that takes it up if it was suspended, and the task that
    /// reaches the place for that.
    pub fn around(
        &mut self,
        step: &Step,
        resume: Option<(Item, Option<Item>)>,
        undo: Option<Item>,
    ) {
        let put = |item: &Item, tasks: &TaskList| tasks.prepend(item.clone(), step.frame.clone());
        let original = Item::Task(step.purpose().clone());
        let mut again = Vec::new();
        // What was rolled back, or is the undoing itself, is not begun anew for its own sake.
        if !matches!(step.item, Item::RollBack { .. }) {
            again.push(Agenda {
                tasks: put(&original, &step.rest),
                origin: Origin::Again,
            });
        }
        again.extend(step.frame.iter().flat_map(|frame| self.ancestors(frame)));
        if again.is_empty() {
            again.push(Agenda {
                tasks: step.rest.clone(),
                origin: Origin::Tail,
            });
        }
        let mut agendas = Vec::new();
        if let Some((item, reach)) = resume {
            let resumed = put(&item, &step.rest);
            agendas.extend(reach.map(|reach| Agenda {
                tasks: put(&reach, &resumed),
                origin: Origin::Reach,
            }));
            agendas.push(Agenda {
                tasks: resumed,
                origin: Origin::Resume,
            });
        }
        if let Some(undo) = undo {
            agendas.extend(again.iter().map(|agenda| Agenda {
                tasks: put(&undo, &agenda.tasks),
                origin: Origin::RollBack,
            }));
        }
        agendas.extend(again);
        self.set_agendas(agendas);
    }

    /// Every open task from its beginning, as far as nothing under it must not be repeated
    /// (decision 13).
    fn ancestors(&self, frame: &Frame) -> Vec<Agenda> {
        std::iter::successors(Some(frame), |frame| frame.parent.as_deref())
            .filter(|frame| !self.done_once.contains(&frame.id))
            .map(|frame| Agenda {
                tasks: frame.rest.prepend(frame.task.clone(), frame.parent.clone()),
                origin: Origin::Ancestor,
            })
            .collect()
    }

    fn set_agendas(&mut self, agendas: Vec<Agenda>) {
        self.agendas.clear();
        for mut agenda in agendas {
            if !self.lost.is_empty() {
                agenda.tasks = self.mended(&agenda.tasks);
            }
            if !self.agendas.iter().any(|known| known.tasks == agenda.tasks) {
                self.agendas.push(agenda);
            }
        }
    }

    /// Another goal has executed an action whose point is the state it leads to: plans and
    /// agendas that begin with it go on behind it.
    pub fn done_by_another(&mut self, executed: &Action) {
        for plan in &mut self.plans {
            crate::planner::advance(plan, executed);
        }
        let tails: Vec<Agenda> = self
            .agendas
            .iter()
            .filter_map(|agenda| {
                let (item, _, rest) = agenda.tasks.first()?;
                (item.purpose() == executed).then(|| Agenda {
                    tasks: rest.clone(),
                    origin: Origin::Tail,
                })
            })
            .collect();
        let mut agendas = std::mem::take(&mut self.agendas);
        agendas.extend(tails);
        self.set_agendas(agendas);
    }

    /// The record of an execution is gone: whatever would resume or undo it is gone with it.
    pub fn forget(&mut self, id: &ActionId) {
        self.records.retain(|record| record.id != *id);
        self.plans.retain(|plan| !plan.needs(id));
        self.agendas
            .retain(|agenda| !agenda.tasks.items().any(|item| item.needs(id)));
    }

    /// The executor has lost the record of an execution: what would resume it begins anew instead,
    /// wherever that is met from now on, and nothing is left to be undone.
    pub fn lose(&mut self, id: &ActionId) {
        self.lost.insert(id.clone());
        self.records.retain(|record| record.id != *id);
        self.plans.retain(|plan| !plan.needs(id));
        let agendas = std::mem::take(&mut self.agendas);
        self.set_agendas(agendas);
    }

    /// The list without what needs a record that is lost.
    fn mended(&self, tasks: &TaskList) -> TaskList {
        let is_lost = |item: &Item| match item {
            Item::Task(_) => false,
            Item::Resume { id, .. } | Item::RollBack { id, .. } => self.lost.contains(id),
        };
        let (mut before, mut at) = (Vec::new(), tasks);
        let (mut rest, mut whole) = (tasks, 0);
        while let Some((item, frame, after)) = at.first() {
            before.push((item, frame));
            if is_lost(item) {
                (rest, whole) = (after, before.len());
            }
            at = after;
        }
        let before = before.into_iter().take(whole).rev();
        before.fold(rest.clone(), |rest, (item, frame)| match item {
            item if !is_lost(item) => rest.prepend(item.clone(), frame.cloned()),
            Item::Resume { original, .. } => {
                rest.prepend(Item::Task(original.clone()), frame.cloned())
            }
            Item::Task(_) | Item::RollBack { .. } => rest,
        })
    }

    /// The running action goes on for another goal: what is kept here for resuming it becomes
    /// waiting for it to be done.
    pub fn hand_over(&mut self, running: &Step) {
        self.around(running, None, None);
        for plan in &mut self.plans {
            if let Some(first) = plan.steps.first_mut()
                && first.item == running.item
            {
                first.item = Item::Task(running.purpose().clone());
            }
        }
        if let Item::Resume { id, .. } = &running.item {
            self.forget(id);
        }
    }
}
