//! Instances of a rule that a new tuple makes possible.

use super::formula::{Arg, Formula, Lit};
use super::lifted::{Lifted, Rule};
use super::space::UNKNOWN;
use super::tables::{MASKED, Mask, Relation};

/// Finds all bindings of `rule` in which the atom number `trigger` (0 is the head, then the body)
/// is the row last joined of its relation, appends them to `found`, one after another, and says
/// how many there are.
///
/// An atom before the trigger must not be that very row, so that no binding is found twice.
pub(super) fn bindings(
    rule: &Rule,
    trigger: usize,
    tables: &mut [Relation],
    found: &mut Vec<u32>,
) -> usize {
    let atoms: Vec<&Lit> = std::iter::once(&rule.head).chain(&rule.body).collect();
    let relation = atoms[trigger].relation as usize;
    let row = tables[relation].joined - 1;
    let mut join = Join {
        used: vec![false; atoms.len()],
        bound: vec![UNKNOWN; rule.vars],
        atoms,
        trigger,
        row,
        unequal: &rule.unequal,
        found,
        count: 0,
    };
    join.used[trigger] = true;
    let mut trail = Vec::new();
    if join.unify(trigger, tables[relation].row(row), &mut trail) {
        join.extend(tables);
    }
    join.count
}

struct Join<'r> {
    atoms: Vec<&'r Lit>,
    used: Vec<bool>,
    bound: Vec<u32>,
    trigger: usize,
    row: usize,
    unequal: &'r [(Arg, Arg)],
    found: &'r mut Vec<u32>,
    count: usize,
}

impl Join<'_> {
    fn value(&self, arg: Arg) -> u32 {
        value(arg, &self.bound)
    }

    fn unify(&mut self, atom: usize, row: &[u32], trail: &mut Vec<u16>) -> bool {
        for (arg, object) in self.atoms[atom].args.iter().zip(row) {
            match arg {
                Arg::Object(constant) if constant == object => {}
                Arg::Var(var) if self.bound[usize::from(*var)] == *object => {}
                Arg::Var(var) if self.bound[usize::from(*var)] == UNKNOWN => {
                    self.bound[usize::from(*var)] = *object;
                    trail.push(*var);
                }
                _ => return false,
            }
        }
        true
    }

    fn excluded(&self, atom: usize, row: usize) -> bool {
        atom < self.trigger
            && row == self.row
            && self.atoms[atom].relation == self.atoms[self.trigger].relation
    }

    /// Takes the atom with the fewest matches and goes through them.
    fn extend(&mut self, tables: &mut [Relation]) {
        let differ = self.unequal.iter().all(|(a, b)| {
            let (a, b) = (self.value(*a), self.value(*b));
            a != b || a == UNKNOWN
        });
        if !differ {
            return;
        }
        let mut settled = Vec::new();
        let mut best: Option<(usize, usize, Mask)> = None;
        let mut possible = true;
        let mut key = Vec::new();
        for atom in 0..self.atoms.len() {
            if self.used[atom] {
                continue;
            }
            let lit = self.atoms[atom];
            let table = &mut tables[lit.relation as usize];
            key.clear();
            let mut mask: Mask = 0;
            let mut complete = true;
            for (column, arg) in lit.args.iter().enumerate() {
                let value = value(*arg, &self.bound);
                if value == UNKNOWN {
                    complete = false;
                } else if column < MASKED {
                    mask |= 1 << column;
                    key.push(value);
                } else if complete {
                    key.push(value);
                }
            }
            if complete {
                let holds = table
                    .find(&key)
                    .is_some_and(|row| row < table.joined && !self.excluded(atom, row));
                if !holds {
                    possible = false;
                    break;
                }
                self.used[atom] = true;
                settled.push(atom);
                continue;
            }
            key.truncate(mask.count_ones() as usize);
            table.prepare(mask);
            let count = table.matches(mask, &key).len();
            if best.is_none_or(|(_, least, _)| count < least) {
                best = Some((atom, count, mask));
            }
            if count == 0 {
                possible = false;
                break;
            }
        }
        if possible {
            match best {
                None => {
                    self.found.extend_from_slice(&self.bound);
                    self.count += 1;
                }
                Some((atom, count, mask)) => self.go_through(atom, count, mask, tables),
            }
        }
        for atom in settled {
            self.used[atom] = false;
        }
    }

    fn go_through(&mut self, atom: usize, count: usize, mask: Mask, tables: &mut [Relation]) {
        let lit = self.atoms[atom];
        let relation = lit.relation as usize;
        let key: Vec<u32> = lit
            .args
            .iter()
            .enumerate()
            .take(MASKED)
            .filter(|(column, _)| mask & (1 << column) != 0)
            .map(|(_, arg)| self.value(*arg))
            .collect();
        self.used[atom] = true;
        let mut trail = Vec::new();
        for place in 0..count {
            let table = &tables[relation];
            let row = table.matches(mask, &key).get(place);
            if self.excluded(atom, row) {
                continue;
            }
            if self.unify(atom, table.row(row), &mut trail) {
                self.extend(tables);
            }
            for var in trail.drain(..) {
                self.bound[usize::from(var)] = UNKNOWN;
            }
        }
        self.used[atom] = false;
    }
}

fn value(arg: Arg, bound: &[u32]) -> u32 {
    match arg {
        Arg::Var(var) => bound.get(usize::from(var)).copied().unwrap_or(UNKNOWN),
        Arg::Object(object) => object,
    }
}

/// What is known of a fact.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Truth {
    /// Never true, or never again asked for.
    False,
    /// Always true.
    True,
    /// It depends on the state.
    Open,
}

/// What a condition comes to once its variables are bound.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Ground {
    /// Always true or always false.
    Known(bool),
    /// The fact, by relation and row, holds or does not.
    Fact(bool, u32, u32),
    /// All of these.
    All(Vec<Ground>),
    /// One of these.
    Any(Vec<Ground>),
}

/// Tells what is known of a fact, and its row.
pub(super) type Lookup<'f> = dyn FnMut(u32, &[u32]) -> (Truth, u32) + 'f;

/// Evaluates as much of `formula` as does not depend on the state. `env` has the values of the
/// variables and grows as quantifiers need it; `fact` tells what is known of a fact, and its row.
pub(super) fn simplify(
    formula: &Formula,
    lifted: &Lifted<'_>,
    env: &mut Vec<u32>,
    fact: &mut Lookup<'_>,
) -> Ground {
    match formula {
        Formula::Fact(sign, lit) => {
            let key: Vec<u32> = lit.args.iter().map(|arg| value(*arg, env)).collect();
            match fact(lit.relation, &key) {
                (Truth::True, _) => Ground::Known(*sign),
                (Truth::False, _) => Ground::Known(!sign),
                (Truth::Open, row) => Ground::Fact(*sign, lit.relation, row),
            }
        }
        Formula::Equal(sign, a, b) => Ground::Known((value(*a, env) == value(*b, env)) == *sign),
        Formula::All(parts) => {
            let parts = parts.iter().map(|part| simplify(part, lifted, env, fact));
            all(parts.collect())
        }
        Formula::Any(parts) => {
            let parts = parts.iter().map(|part| simplify(part, lifted, env, fact));
            any(parts.collect())
        }
        Formula::Every(over, inner) => {
            let mut parts = Vec::new();
            each(over, lifted, env, &mut |env| {
                parts.push(simplify(inner, lifted, env, fact));
            });
            all(parts)
        }
        Formula::Exists(over, inner) => {
            let mut parts = Vec::new();
            each(over, lifted, env, &mut |env| {
                parts.push(simplify(inner, lifted, env, fact));
            });
            any(parts)
        }
    }
}

/// Calls `then` with every choice of objects for the variables of a quantifier.
pub(super) fn each(
    over: &[(u16, u32)],
    lifted: &Lifted<'_>,
    env: &mut Vec<u32>,
    then: &mut dyn FnMut(&mut Vec<u32>),
) {
    let Some(((var, kind), others)) = over.split_first() else {
        then(env);
        return;
    };
    let place = usize::from(*var);
    if env.len() <= place {
        env.resize(place + 1, UNKNOWN);
    }
    for object in lifted.members(*kind) {
        env[place] = object.0;
        each(others, lifted, env, then);
    }
    env[place] = UNKNOWN;
}

fn all(parts: Vec<Ground>) -> Ground {
    let mut kept = Vec::new();
    for part in parts {
        match part {
            Ground::Known(true) => {}
            Ground::Known(false) => return Ground::Known(false),
            Ground::All(inner) => kept.extend(inner),
            part => kept.push(part),
        }
    }
    match kept.len() {
        0 => Ground::Known(true),
        1 => kept.swap_remove(0),
        _ => Ground::All(kept),
    }
}

fn any(parts: Vec<Ground>) -> Ground {
    let mut kept = Vec::new();
    for part in parts {
        match part {
            Ground::Known(false) => {}
            Ground::Known(true) => return Ground::Known(true),
            Ground::Any(inner) => kept.extend(inner),
            part => kept.push(part),
        }
    }
    match kept.len() {
        0 => Ground::Known(false),
        1 => kept.swap_remove(0),
        _ => Ground::Any(kept),
    }
}
