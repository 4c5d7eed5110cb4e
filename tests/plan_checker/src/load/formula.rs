//! Conditions and effects.

use super::types::{Types, typed};
use super::{Loader, checked, number, unknown_type};
use crate::fault::Fault;
use crate::model::{Action, Atom, Change, Cost, Formula, Quantified, Term, Variable};
use crate::sexpr::Sexpr;

/// The variables that may be named. Those of quantifiers stay in the list but lose their names
/// where the quantifier ends.
#[derive(Default)]
pub(super) struct Scope {
    pub(super) variables: Vec<Variable>,
    named: Vec<usize>,
}

impl Scope {
    /// Of the list behind `:parameters`, which may be missing.
    pub(super) fn of(types: &mut Types, parameters: Option<&Sexpr>) -> Result<Self, Fault> {
        let mut scope = Self::default();
        if let Some(parameters) = parameters {
            scope.open(types, parameters)?;
            let mut names: Vec<_> = scope.variables.iter().map(|v| &v.name).collect();
            names.sort_unstable();
            if names.windows(2).any(|pair| pair[0] == pair[1]) {
                return Err(parameters.fault("a variable is declared twice"));
            }
        }
        Ok(scope)
    }

    fn open(&mut self, types: &mut Types, list: &Sexpr) -> Result<Vec<usize>, Fault> {
        let mut slots = Vec::new();
        for (name, kinds) in typed(list.expect_list("variables")?)? {
            if !name.starts_with('?') {
                return Err(list.fault(format_args!("`{name}` is no variable")));
            }
            let sort = types.sort(&kinds);
            let sort = sort.map_err(|unknown| list.fault(unknown_type(&unknown)))?;
            slots.push(self.variables.len());
            self.named.push(self.variables.len());
            self.variables.push(Variable {
                name: name.to_owned(),
                sort,
            });
        }
        self.variables = checked(std::mem::take(&mut self.variables), list)?;
        Ok(slots)
    }

    fn close(&mut self, slots: &[usize]) {
        self.named.truncate(self.named.len() - slots.len());
    }

    fn find(&self, name: &str) -> Option<usize> {
        let mut named = self.named.iter().rev().copied();
        named.find(|slot| self.variables[*slot].name == name)
    }
}

impl Loader {
    pub(super) fn term(&self, term: &Sexpr, scope: &Scope) -> Result<Term, Fault> {
        let name = term.expect_word("a variable or an object")?;
        let (found, what) = if name.starts_with('?') {
            (scope.find(name).map(Term::Variable), "variable")
        } else {
            (self.objects.find(name).map(Term::Object), "object")
        };
        found.ok_or_else(|| term.fault(format_args!("no {what} `{name}`")))
    }

    pub(super) fn terms(&self, items: &[Sexpr], scope: &Scope) -> Result<Vec<Term>, Fault> {
        items.iter().map(|item| self.term(item, scope)).collect()
    }

    pub(super) fn atom(&self, atom: &Sexpr, scope: &Scope) -> Result<Atom, Fault> {
        let items = atom.expect_list("a fact")?;
        let name = atom.head().ok_or_else(|| atom.fault("expected a fact"))?;
        let id = self.predicates.find(name);
        let id = id.ok_or_else(|| atom.fault(format_args!("no predicate `{name}`")))?;
        let wanted = self.predicate_arities[id as usize];
        if items.len() != wanted + 1 {
            return Err(atom.fault(format_args!("`{name}` takes {wanted} arguments")));
        }
        let terms = self.terms(&items[1..], scope)?;
        Ok(Atom { name: id, terms })
    }

    pub(super) fn function(&self, function: &Sexpr, scope: &Scope) -> Result<Atom, Fault> {
        let items = function.expect_list("a function")?;
        let name = function.head().unwrap_or_default();
        let id = self.functions.find(name);
        let id = id.ok_or_else(|| function.fault(format_args!("no function `{name}`")))?;
        if items.len() != self.function_arities[id as usize] + 1 {
            return Err(function.fault(format_args!("`{name}` has another number of arguments")));
        }
        let terms = self.terms(&items[1..], scope)?;
        Ok(Atom { name: id, terms })
    }

    /// A condition that may be missing, which is always true.
    pub(super) fn condition(
        &mut self,
        condition: Option<&Sexpr>,
        scope: &mut Scope,
    ) -> Result<Formula, Fault> {
        match condition {
            Some(condition) => self.formula(condition, scope, true),
            None => Ok(Formula::And(Vec::new())),
        }
    }

    fn formula(
        &mut self,
        formula: &Sexpr,
        scope: &mut Scope,
        truth: bool,
    ) -> Result<Formula, Fault> {
        let items = formula.expect_list("a condition")?;
        let Some(head) = formula.head() else {
            return match (items.is_empty(), truth) {
                (true, true) => Ok(Formula::And(Vec::new())),
                (true, false) => Ok(Formula::Or(Vec::new())),
                (false, _) => Err(formula.fault("expected a condition")),
            };
        };
        match (head, &items[1..]) {
            ("and", parts) => self.parts(parts, scope, truth, truth),
            ("or", parts) => self.parts(parts, scope, truth, !truth),
            ("not", [part]) => self.formula(part, scope, !truth),
            ("imply", [when, then]) => {
                let parts = vec![
                    self.formula(when, scope, !truth)?,
                    self.formula(then, scope, truth)?,
                ];
                Ok(joined(parts, !truth))
            }
            ("forall", [list, body]) => {
                let slots = scope.open(&mut self.types, list)?;
                let body = self.formula(body, scope, false)?;
                scope.close(&slots);
                Ok(Formula::Some(Quantified::new(slots, body), !truth))
            }
            ("exists", [list, body]) => {
                let slots = scope.open(&mut self.types, list)?;
                let body = self.formula(body, scope, true)?;
                scope.close(&slots);
                Ok(Formula::Some(Quantified::new(slots, body), truth))
            }
            ("=", [left, right]) => {
                let (left, right) = (self.term(left, scope)?, self.term(right, scope)?);
                Ok(Formula::Equal(left, right, truth))
            }
            ("sort" | "sortof" | "typeof", [left, dash, kind]) if dash.word() == Some("-") => {
                let left = self.term(left, scope)?;
                let sort = self.types.sort(&[kind.expect_word("a type")?]);
                let sort = sort.map_err(|unknown| kind.fault(unknown_type(&unknown)))?;
                Ok(Formula::OfSort(left, sort, truth))
            }
            ("not" | "imply" | "forall" | "exists" | "=" | "when" | "preference", _) => {
                Err(formula.fault(format_args!("`{head}` makes no sense like this")))
            }
            _ => Ok(Formula::Atom(self.atom(formula, scope)?, truth)),
        }
    }

    fn parts(
        &mut self,
        parts: &[Sexpr],
        scope: &mut Scope,
        truth: bool,
        all: bool,
    ) -> Result<Formula, Fault> {
        let parts = parts.iter().map(|part| self.formula(part, scope, truth));
        Ok(joined(parts.collect::<Result<_, _>>()?, all))
    }

    /// Adds what an effect does to `action`; `within` is what it is quantified over and depends on.
    pub(super) fn effect(
        &mut self,
        effect: &Sexpr,
        scope: &mut Scope,
        within: (&[usize], &Formula),
        action: &mut Action,
    ) -> Result<(), Fault> {
        let items = effect.expect_list("an effect")?;
        let (over, when) = within;
        let change = |atom, add| Change {
            over: over.to_vec(),
            when: when.clone(),
            atom,
            add,
        };
        match (effect.head(), items) {
            (None, []) => Ok(()),
            (Some("and"), [_, parts @ ..]) => {
                for part in parts {
                    self.effect(part, scope, within, action)?;
                }
                Ok(())
            }
            (Some("forall"), [_, list, body]) => {
                let slots = scope.open(&mut self.types, list)?;
                let all = [over, slots.as_slice()].concat();
                self.effect(body, scope, (&all, when), action)?;
                scope.close(&slots);
                Ok(())
            }
            (Some("when"), [_, condition, body]) => {
                let condition = self.formula(condition, scope, true)?;
                let both = joined(vec![when.clone(), condition], true);
                self.effect(body, scope, (over, &both), action)
            }
            (Some("not"), [_, atom]) => {
                action.changes.push(change(self.atom(atom, scope)?, false));
                Ok(())
            }
            (Some("increase"), [_, _, by]) if over.is_empty() => {
                let cost = match by.word() {
                    Some(word) => number(word),
                    None => Some(Cost::Function(self.function(by, scope)?)),
                };
                let cost = cost.ok_or_else(|| by.fault("expected a number"))?;
                action.costs.push(cost);
                Ok(())
            }
            (Some("when" | "forall" | "not" | "increase" | "decrease" | "assign"), _) => {
                Err(effect.fault("an effect of this form is not known"))
            }
            _ => {
                action.changes.push(change(self.atom(effect, scope)?, true));
                Ok(())
            }
        }
    }
}

/// All of the parts, or any.
fn joined(mut parts: Vec<Formula>, all: bool) -> Formula {
    if parts.len() == 1 {
        return parts.remove(0);
    }
    if !all {
        return Formula::Or(parts);
    }
    let mut flat = Vec::new();
    for part in parts {
        match part {
            Formula::And(parts) => flat.extend(parts),
            other => flat.push(other),
        }
    }
    Formula::And(flat)
}
