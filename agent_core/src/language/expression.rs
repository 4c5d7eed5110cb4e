//! Atoms and terms with variables in them.

use super::error::Faults;
use super::fit::{Closeness, Misfit, Sort, misfits, no_constant};
use super::near::hint;
use super::number::decimal;
use super::tree::Tree;
use super::typed_list::{name, parameters};
use crate::model::{Domain, Parameter, Pattern, Symbol, Term};

/// What the names in an expression may refer to.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    /// The variables. Of two with the same name the later one counts, which is the inner one.
    pub(super) parameters: &'a [Parameter],
    /// The declarations to check against, for whoever has them at hand.
    pub(super) domain: Option<&'a Domain>,
}

/// Parts of PDDL that HDDL's total-order fragment has no place for.
pub(super) const UNSUPPORTED: &[&str] = &[
    "decrease",
    "assign",
    "scale-up",
    "scale-down",
    "<",
    ">",
    "<=",
    ">=",
    "preference",
];

/// Says that `tree` is PDDL, but none that is read here.
pub(super) fn unsupported(tree: &Tree, what: &str, faults: &mut Faults) {
    faults.add(tree.at, format!("`{what}` is not supported: `{tree}`"));
}

impl<'a> Scope<'a> {
    /// A variable of the scope, or an object.
    pub(super) fn term(&self, tree: &Tree, faults: &mut Faults) -> Option<Term> {
        let word = tree.word().unwrap_or_default();
        if !word.starts_with('?') {
            return object(tree, faults).map(Term::Constant);
        }
        let among = || {
            self.parameters
                .iter()
                .map(|parameter| parameter.name.as_str())
        };
        if let Some(index) = among().rposition(|variable| variable == word) {
            return Some(Term::Variable(index));
        }
        let hint = hint(word, among(), "; declare it among the parameters");
        faults.add(
            tree.at,
            format!("the variable `{word}` is not declared{hint}"),
        );
        None
    }

    /// A term outside an atom, whose declaration would have been asked there.
    pub(super) fn known_term(&self, tree: &Tree, faults: &mut Faults) -> Option<Term> {
        let term = self.term(tree, faults)?;
        if let (Some(domain), Term::Constant(name)) = (self.domain, &term)
            && !domain.constants.contains_key(name)
        {
            let misfit = no_constant(domain, name, self.parameters);
            faults.add(tree.at, misfit.to_string());
        }
        Some(term)
    }

    /// A name with arguments, of the given sort.
    pub(super) fn pattern(&self, tree: &Tree, sort: Sort, faults: &mut Faults) -> Option<Pattern> {
        if faults.is_enough() {
            return None;
        }
        let Some((head, arguments)) = tree.list().and_then(|items| items.split_first()) else {
            faults.add(
                tree.at,
                format!("expected something like `(name ?x)`, found `{tree}`"),
            );
            return None;
        };
        let name = name(head, "a name", faults);
        let args: Vec<Option<Term>> = arguments
            .iter()
            .map(|argument| self.term(argument, faults))
            .collect();
        let args: Vec<Term> = args.into_iter().collect::<Option<_>>()?;
        let pattern = Pattern { name: name?, args };
        if let Some(domain) = self.domain {
            let found = misfits(domain, sort, &pattern, self.parameters, Closeness::Possible);
            for (index, misfit) in found {
                let at = index.and_then(|index| arguments.get(index));
                let at = at.unwrap_or(head).at;
                match misfit {
                    // It is never true, or never done, which has a meaning.
                    Misfit::Kind { .. } => faults.slip(at, misfit.to_string()),
                    _ => faults.add(at, misfit.to_string()),
                }
            }
        }
        Some(pattern)
    }

    /// The parts of `(forall (?x - node) …)` and its like: the variables, and what is said of them.
    pub(super) fn quantified<'t>(
        &self,
        tree: &'t Tree,
        faults: &mut Faults,
    ) -> Option<(Vec<Parameter>, &'t Tree)> {
        let Some([word, variables, body]) = tree.list() else {
            let word = tree.head().unwrap_or_default();
            faults.add(
                tree.at,
                format!("write `({word} (?x - node) (…))`: variables, then one thing said of them"),
            );
            return None;
        };
        let Some(items) = variables.list() else {
            faults.add(variables.at, "expected variables such as `(?x - node)`");
            return None;
        };
        let variables = parameters(items, self.domain, faults);
        for variable in &variables {
            if self
                .parameters
                .iter()
                .any(|outer| outer.name == variable.name)
            {
                let name = &variable.name;
                faults.slip(
                    word.at,
                    format!("`{name}` is already a variable; give the quantified one another name"),
                );
            }
        }
        Some((variables, body))
    }

    /// The variables of this scope and then `inner` ones.
    pub(super) fn with(&self, inner: &[Parameter]) -> Vec<Parameter> {
        [self.parameters, inner].concat()
    }
}

/// An object, in a place where no variable can be. A number is one too: `(speak 30)`.
pub(super) fn object(tree: &Tree, faults: &mut Faults) -> Option<Symbol> {
    match tree.word() {
        Some(word) if decimal(word).is_some() => Some(Symbol::from(word)),
        Some(word) if word.starts_with('?') => {
            faults.add(
                tree.at,
                format!("expected an object, found the variable `{word}`"),
            );
            None
        }
        _ => name(tree, "an object", faults),
    }
}
