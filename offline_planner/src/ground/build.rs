//! From what can be reached to the ground problem.

use super::formula::{Conjunction, Lit};
use super::join::{Ground, Truth, each, simplify};
use super::lifted::{Lifted, LiftedEffect, Rule, What};
use super::model::{Action, Check, Conditional, Literal, Method, Model, NONE, Span, Task};
use super::origin::Origin;
use super::reach::{Reached, bound};
use crate::compile::ObjectId;

/// Makes the ground problem. `None` if the problem as a whole cannot be done.
pub(super) fn build(lifted: &Lifted<'_>, mut reached: Reached) -> Option<Model> {
    let top = *reached.node_of[lifted.compiled.top.index()].first()?;
    if !reached.nodes[top as usize].done {
        return None;
    }
    let by_head = by_head(lifted, &reached);
    let live = live(lifted, &reached, &by_head, top);
    let mut task_of = vec![NONE; reached.nodes.len()];
    let mut count = 0;
    for (node, live) in live.iter().enumerate() {
        if *live {
            task_of[node] = count;
            count += 1;
        }
    }
    let mut first_fact = Vec::with_capacity(lifted.space.predicates());
    let mut facts = 0;
    for place in 0..lifted.space.predicates() {
        first_fact.push(facts as u32);
        if lifted.fluent[place] {
            facts += reached.tables[place].len();
        }
    }
    let mut model = Model::default();
    model.facts = facts;
    model.init = vec![0; facts.div_ceil(64)];
    model.top = task_of[top as usize];
    let mut build = Build {
        lifted,
        first_fact,
        reached: &reached,
        task_of: &task_of,
        model,
    };
    for place in 0..lifted.space.predicates() {
        if lifted.fluent[place] {
            for row in 0..reached.initial[place] {
                let fact = build.first_fact[place] as usize + row;
                build.model.init[fact / 64] |= 1 << (fact % 64);
            }
        }
    }
    for (node, live) in live.iter().enumerate() {
        if *live {
            let task = build.task(node, by_head.of(node));
            build.model.tasks.push(task);
        }
    }
    let mut model = build.model;
    model.origin = Origin::new(lifted, &mut reached);
    Some(model)
}

/// Instances by the node that they do.
struct ByHead {
    start: Vec<u32>,
    made: Vec<u32>,
}

impl ByHead {
    fn of(&self, node: usize) -> &[u32] {
        &self.made[self.start[node] as usize..self.start[node + 1] as usize]
    }
}

/// Those instances that are complete: all their subtasks can be done.
fn by_head(lifted: &Lifted<'_>, reached: &Reached) -> ByHead {
    let complete = |index: &usize| {
        let made = &reached.made[*index];
        match &lifted.rules[made.rule as usize].what {
            What::Link { subs, .. } => made.progress as usize == subs.len(),
            What::Action { .. } => true,
        }
    };
    let mut start = vec![0_u32; reached.nodes.len() + 1];
    for index in (0..reached.made.len()).filter(complete) {
        start[reached.made[index].head as usize + 1] += 1;
    }
    for node in 0..reached.nodes.len() {
        start[node + 1] += start[node];
    }
    let mut next = start.clone();
    let mut made = vec![0; start.last().map_or(0, |count| *count as usize)];
    for index in (0..reached.made.len()).filter(complete) {
        let place = &mut next[reached.made[index].head as usize];
        made[*place as usize] = index as u32;
        *place += 1;
    }
    ByHead { start, made }
}

/// Nodes that come up from the top down through complete instances.
fn live(lifted: &Lifted<'_>, reached: &Reached, by_head: &ByHead, top: u32) -> Vec<bool> {
    let mut live = vec![false; reached.nodes.len()];
    live[top as usize] = true;
    let mut open = vec![top];
    while let Some(node) = open.pop() {
        for made in by_head.of(node as usize) {
            let made = &reached.made[*made as usize];
            if let What::Link { subs, .. } = &lifted.rules[made.rule as usize].what {
                for sub in subs {
                    let sub = node_of(lifted, reached, sub, &reached.values[made.values..]);
                    if !std::mem::replace(&mut live[sub as usize], true) {
                        open.push(sub);
                    }
                }
            }
        }
    }
    live
}

fn node_of(lifted: &Lifted<'_>, reached: &Reached, sub: &Lit, values: &[u32]) -> u32 {
    let key: Vec<u32> = sub.args.iter().map(|arg| bound(*arg, values)).collect();
    reached.tables[sub.relation as usize]
        .find(&key)
        .map_or(NONE, |row| {
            reached.node_of[sub.relation as usize - lifted.space.first_task()][row]
        })
}

struct Build<'b> {
    lifted: &'b Lifted<'b>,
    first_fact: Vec<u32>,
    reached: &'b Reached,
    task_of: &'b [u32],
    model: Model,
}

impl Build<'_> {
    fn task(&mut self, node: usize, made: &[u32]) -> Task {
        let first = self.model.methods.len() as u32;
        for index in made {
            let one = &self.reached.made[*index as usize];
            let rule = &self.lifted.rules[one.rule as usize];
            let values = &self.reached.values[one.values..one.values + rule.vars];
            match &rule.what {
                What::Action { action, effects } => {
                    let number = self.model.actions.len() as u32;
                    let args: Vec<ObjectId> = values.iter().map(|value| ObjectId(*value)).collect();
                    let width = self.lifted.compiled.action(*action).kinds.len();
                    let cost = self.lifted.compiled.cost(*action, &args[..width]).0;
                    let artificial = self.lifted.compiled.goal == Some(*action);
                    let origin = if artificial { NONE } else { *index };
                    self.action(rule, values, effects, cost, origin);
                    return Task::Action(number);
                }
                What::Link { subs, .. } => {
                    let Some((pre, check)) = self.condition(rule, values) else {
                        continue;
                    };
                    let subs: Vec<u32> = subs
                        .iter()
                        .map(|sub| {
                            let sub = node_of(self.lifted, self.reached, sub, values);
                            self.task_of[sub as usize]
                        })
                        .collect();
                    let subs = self.model.list(subs);
                    self.model.methods.push(Method {
                        task: self.task_of[node],
                        pre,
                        check,
                        subs,
                        origin: *index,
                    });
                }
            }
        }
        Task::Methods(first, self.model.methods.len() as u32 - first)
    }

    fn action(
        &mut self,
        rule: &Rule,
        values: &[u32],
        effects: &[LiftedEffect],
        cost: u64,
        origin: u32,
    ) {
        let (pre, check) = self.condition(rule, values).unwrap_or_else(|| {
            self.model.checks.push(Check::Never);
            (Span::default(), self.model.checks.len() as u32 - 1)
        });
        let first = self.model.conditionals.len() as u32;
        let (mut add, mut del) = (Vec::new(), Vec::new());
        let lifted = self.lifted;
        for effect in effects {
            let mut env = values.to_vec();
            each(&effect.over, lifted, &mut env, &mut |env| {
                let key: Vec<u32> = effect
                    .fact
                    .args
                    .iter()
                    .map(|arg| bound(*arg, env))
                    .collect();
                let Some(fact) = self.fact(effect.fact.relation, &key) else {
                    return;
                };
                let Some((literals, check)) = self.conjunction(&effect.when, env) else {
                    return;
                };
                if literals.is_empty() && check == NONE {
                    let list = if effect.add { &mut add } else { &mut del };
                    list.push(fact);
                } else {
                    let when = self.model.set(literals);
                    self.model.conditionals.push(Conditional {
                        when,
                        check,
                        add: effect.add,
                        fact,
                    });
                }
            });
        }
        let conditional = (first, self.model.conditionals.len() as u32 - first);
        del.retain(|fact| !add.contains(fact));
        let (del, add) = (self.model.set(del), self.model.set(add));
        self.model.actions.push(Action {
            pre,
            check,
            del,
            add,
            conditional,
            cost,
            origin,
        });
    }

    /// The fact's number; `None` if it never holds.
    fn fact(&self, relation: u32, key: &[u32]) -> Option<u32> {
        let row = self.reached.tables[relation as usize].find(key)?;
        Some(self.first_fact[relation as usize] + row as u32)
    }

    fn truth(&self, relation: u32, key: &[u32]) -> (Truth, u32) {
        let row = self.reached.tables[relation as usize].find(key);
        match (row, self.lifted.is_fluent(relation)) {
            (None, _) => (Truth::False, 0),
            (Some(_), false) => (Truth::True, 0),
            (Some(row), true) => (Truth::Open, row as u32),
        }
    }

    fn condition(&mut self, rule: &Rule, values: &[u32]) -> Option<(Span, u32)> {
        let condition = Conjunction {
            positive: rule.body.clone(),
            negative: rule.negative.clone(),
            equal: rule.unequal.iter().map(|(a, b)| (false, *a, *b)).collect(),
            hidden: Vec::new(),
            checks: rule.checks.clone(),
        };
        let mut env = values.to_vec();
        let (literals, check) = self.conjunction(&condition, &mut env)?;
        Some((self.model.set(literals), check))
    }

    /// Literals and check of a conjunction whose variables have values; `None` if it never holds.
    fn conjunction(
        &mut self,
        condition: &Conjunction,
        env: &mut Vec<u32>,
    ) -> Option<(Vec<Literal>, u32)> {
        let mut literals = Vec::new();
        for (sign, lits) in [(true, &condition.positive), (false, &condition.negative)] {
            for lit in lits {
                let key: Vec<u32> = lit.args.iter().map(|arg| bound(*arg, env)).collect();
                match self.truth(lit.relation, &key) {
                    (Truth::Open, row) => {
                        let fact = self.first_fact[lit.relation as usize] + row;
                        literals.push(fact * 2 + u32::from(!sign));
                    }
                    (truth, _) if (truth == Truth::True) == sign => {}
                    _ => return None,
                }
            }
        }
        for (sign, a, b) in &condition.equal {
            if (bound(*a, env) == bound(*b, env)) != *sign {
                return None;
            }
        }
        let mut checks = Vec::new();
        for formula in &condition.checks {
            let ground = simplify(formula, self.lifted, env, &mut |relation, key| {
                self.truth(relation, key)
            });
            self.sort_out(ground, &mut literals, &mut checks)?;
        }
        let check = match checks.len() {
            0 => return Some((literals, NONE)),
            1 => checks.swap_remove(0),
            _ => Check::All(checks),
        };
        self.model.checks.push(check);
        Some((literals, self.model.checks.len() as u32 - 1))
    }

    fn sort_out(
        &self,
        ground: Ground,
        literals: &mut Vec<Literal>,
        checks: &mut Vec<Check>,
    ) -> Option<()> {
        match ground {
            Ground::Known(true) => {}
            Ground::Known(false) => return None,
            Ground::Fact(sign, relation, row) => literals.push(self.literal(sign, relation, row)),
            Ground::All(parts) => {
                for part in parts {
                    self.sort_out(part, literals, checks)?;
                }
            }
            Ground::Any(_) => checks.push(self.check(&ground)),
        }
        Some(())
    }

    fn literal(&self, sign: bool, relation: u32, row: u32) -> Literal {
        (self.first_fact[relation as usize] + row) * 2 + u32::from(!sign)
    }

    fn check(&self, ground: &Ground) -> Check {
        match ground {
            Ground::Known(true) => Check::All(Vec::new()),
            Ground::Known(false) => Check::Never,
            Ground::Fact(sign, relation, row) => {
                Check::Literal(self.literal(*sign, *relation, *row))
            }
            Ground::All(parts) => Check::All(parts.iter().map(|part| self.check(part)).collect()),
            Ground::Any(parts) => Check::Any(parts.iter().map(|part| self.check(part)).collect()),
        }
    }
}
