//! Takes out of a ground problem what turns out to be of no use: methods and actions that need
//! what never holds, tasks that come up nowhere, facts that never change or that nothing asks for.

use super::model::{Action, Check, Conditional, Literal, Method, Model, NONE, Span, Task};
use crate::heuristic::relaxed::{Exploration, Relaxed};

/// The same problem, smaller. `None` if there is no plan.
pub(super) fn trim(mut model: Model) -> Option<Model> {
    loop {
        let before = size(&model);
        model = Trim::new(&model)?.run();
        if size(&model) == before {
            return Some(model);
        }
    }
}

fn size(model: &Model) -> (usize, usize, usize, usize) {
    (
        model.facts,
        model.methods.len(),
        model.actions.len(),
        model.tasks.len(),
    )
}

struct Trim<'m> {
    old: &'m Model,
    exploration: Exploration,
    live_tasks: Vec<bool>,
    live_methods: Vec<bool>,
    new: Model,
    fact_of: Vec<u32>,
}

/// What became of a literal.
enum Now {
    True,
    False,
    Open(Literal),
}

impl<'m> Trim<'m> {
    fn new(old: &'m Model) -> Option<Self> {
        let relaxed = Relaxed::new(old);
        let exploration = relaxed.explore(&old.init);
        if !exploration.task(&relaxed, old.top) {
            return None;
        }
        let live_methods: Vec<bool> = (0..old.methods.len())
            .map(|method| exploration.method(&relaxed, method))
            .collect();
        let mut live_tasks = vec![false; old.tasks.len()];
        live_tasks[old.top as usize] = true;
        let mut open = vec![old.top];
        while let Some(task) = open.pop() {
            for method in old.methods_of(task).filter(|method| live_methods[*method]) {
                for sub in old.get(old.methods[method].subs) {
                    if !std::mem::replace(&mut live_tasks[*sub as usize], true) {
                        open.push(*sub);
                    }
                }
            }
        }
        Some(Self {
            old,
            exploration,
            live_tasks,
            live_methods,
            new: Model::default(),
            fact_of: Vec::new(),
        })
    }

    fn run(mut self) -> Model {
        let old = self.old;
        self.number_facts();
        let mut task_of = vec![NONE; old.tasks.len()];
        let live = (0..old.tasks.len()).filter(|task| self.live_tasks[*task]);
        for (number, task) in live.enumerate() {
            task_of[task] = number as u32;
        }
        for task in 0..old.tasks.len() {
            if !self.live_tasks[task] {
                continue;
            }
            let now = match old.tasks[task] {
                Task::Action(action) => {
                    self.action(&old.actions[action as usize]);
                    Task::Action(self.new.actions.len() as u32 - 1)
                }
                Task::Methods(..) => {
                    let first = self.new.methods.len() as u32;
                    for method in old.methods_of(task as u32) {
                        if self.live_methods[method] {
                            self.method(&old.methods[method], &task_of);
                        }
                    }
                    Task::Methods(first, self.new.methods.len() as u32 - first)
                }
            };
            self.new.tasks.push(now);
        }
        self.new.top = task_of[old.top as usize];
        self.new.origin = old.origin.clone();
        self.new
    }

    /// Facts that change and that something asks for.
    fn number_facts(&mut self) {
        let old = self.old;
        let mut asked = vec![false; old.facts];
        let mut ask = |pre: Span, check: u32| {
            for literal in old.get(pre) {
                asked[(literal >> 1) as usize] = true;
            }
            if check != NONE {
                ask_check(&old.checks[check as usize], &mut asked);
            }
        };
        for task in (0..old.tasks.len()).filter(|task| self.live_tasks[*task]) {
            if let Task::Action(action) = old.tasks[task] {
                let action = &old.actions[action as usize];
                ask(action.pre, action.check);
                for effect in old.conditionals_of(action) {
                    ask(effect.when, effect.check);
                }
            }
            for method in old
                .methods_of(task as u32)
                .filter(|method| self.live_methods[*method])
            {
                ask(old.methods[method].pre, old.methods[method].check);
            }
        }
        self.fact_of = vec![NONE; old.facts];
        for fact in (0..old.facts as u32).filter(|fact| asked[*fact as usize]) {
            let changes =
                self.exploration.literal(fact * 2) && self.exploration.literal(fact * 2 + 1);
            if changes {
                self.fact_of[fact as usize] = self.new.facts as u32;
                self.new.facts += 1;
            }
        }
        self.new.init = vec![0; self.new.facts.div_ceil(64)];
        for fact in 0..old.facts as u32 {
            let now = self.fact_of[fact as usize];
            if now != NONE && super::model::has(&old.init, fact) {
                self.new.init[now as usize / 64] |= 1 << (now % 64);
            }
        }
    }

    fn literal(&self, literal: Literal) -> Now {
        let now = self.fact_of[(literal >> 1) as usize];
        if now != NONE {
            Now::Open(now * 2 + (literal & 1))
        } else if self.exploration.literal(literal) {
            Now::True
        } else {
            Now::False
        }
    }

    /// Literals and check as they are now; `None` if they never hold.
    fn condition(&mut self, pre: Span, check: u32) -> Option<(Vec<Literal>, u32)> {
        let mut literals = Vec::new();
        for literal in self.old.get(pre) {
            match self.literal(*literal) {
                Now::True => {}
                Now::False => return None,
                Now::Open(literal) => literals.push(literal),
            }
        }
        if check == NONE {
            return Some((literals, NONE));
        }
        match self.check(&self.old.checks[check as usize]) {
            Check::Literal(literal) => literals.push(literal),
            Check::All(parts) if parts.is_empty() => {}
            Check::Never => return None,
            open => {
                self.new.checks.push(open);
                return Some((literals, self.new.checks.len() as u32 - 1));
            }
        }
        Some((literals, NONE))
    }

    fn check(&self, check: &Check) -> Check {
        match check {
            Check::Literal(literal) => match self.literal(*literal) {
                Now::True => Check::All(Vec::new()),
                Now::False => Check::Never,
                Now::Open(literal) => Check::Literal(literal),
            },
            Check::All(parts) => {
                let mut kept = Vec::new();
                for part in parts {
                    match self.check(part) {
                        Check::Never => return Check::Never,
                        Check::All(inner) => kept.extend(inner),
                        part => kept.push(part),
                    }
                }
                Check::All(kept)
            }
            Check::Any(parts) => {
                let mut kept = Vec::new();
                for part in parts {
                    match self.check(part) {
                        Check::All(inner) if inner.is_empty() => return Check::All(Vec::new()),
                        Check::Never => {}
                        Check::Any(inner) => kept.extend(inner),
                        part => kept.push(part),
                    }
                }
                match kept.len() {
                    0 => Check::Never,
                    1 => kept.swap_remove(0),
                    _ => Check::Any(kept),
                }
            }
            Check::Never => Check::Never,
        }
    }

    fn facts(&self, facts: Span) -> Vec<u32> {
        let kept = self.old.get(facts).iter();
        kept.map(|fact| self.fact_of[*fact as usize])
            .filter(|fact| *fact != NONE)
            .collect()
    }

    fn action(&mut self, action: &Action) {
        let (pre, check) = self.condition(action.pre, action.check).unwrap_or_else(|| {
            self.new.checks.push(Check::Never);
            (Vec::new(), self.new.checks.len() as u32 - 1)
        });
        let pre = self.new.set(pre);
        let (mut del, mut add) = (self.facts(action.del), self.facts(action.add));
        let first = self.new.conditionals.len() as u32;
        for effect in self.old.conditionals_of(action) {
            let fact = self.fact_of[effect.fact as usize];
            if fact == NONE {
                continue;
            }
            let Some((when, check)) = self.condition(effect.when, effect.check) else {
                continue;
            };
            if when.is_empty() && check == NONE {
                let list = if effect.add { &mut add } else { &mut del };
                list.push(fact);
            } else {
                let when = self.new.set(when);
                self.new.conditionals.push(Conditional {
                    when,
                    check,
                    add: effect.add,
                    fact,
                });
            }
        }
        let conditional = (first, self.new.conditionals.len() as u32 - first);
        del.retain(|fact| !add.contains(fact));
        let (del, add) = (self.new.set(del), self.new.set(add));
        self.new.actions.push(Action {
            pre,
            check,
            del,
            add,
            conditional,
            ..action.clone()
        });
    }

    fn method(&mut self, method: &Method, task_of: &[u32]) {
        let Some((pre, check)) = self.condition(method.pre, method.check) else {
            return;
        };
        let pre = self.new.set(pre);
        let subs = self.old.get(method.subs);
        let subs = self.new.list(subs.iter().map(|sub| task_of[*sub as usize]));
        self.new.methods.push(Method {
            task: task_of[method.task as usize],
            pre,
            check,
            subs,
            origin: method.origin,
        });
    }
}

fn ask_check(check: &Check, asked: &mut [bool]) {
    match check {
        Check::Literal(literal) => asked[(literal >> 1) as usize] = true,
        Check::All(parts) | Check::Any(parts) => {
            for part in parts {
                ask_check(part, asked);
            }
        }
        Check::Never => {}
    }
}
