//! Atoms, conditions and numbers with variables in them.

use super::error::Faults;
use super::fit::{Closeness, Sort, misfits, no_constant};
use super::near::hint;
use super::tree::{Kind, Tree};
use super::typed_list::name;
use crate::model::{Clause, Condition, Domain, Number, Parameter, Pattern, Symbol, Term};

/// What the names in an expression may refer to.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    /// The variables.
    pub(super) parameters: &'a [Parameter],
    /// The declarations to check against, for whoever has them at hand.
    pub(super) domain: Option<&'a Domain>,
}

/// Parts of HDDL and PDDL that a later part of the language may bring.
pub(super) const NOT_YET: &[&str] = &[
    "or",
    "imply",
    "exists",
    "forall",
    "when",
    "decrease",
    "assign",
    "scale-up",
    "scale-down",
    "<",
    ">",
    "<=",
    ">=",
];

/// Says that `tree` is HDDL, but none that is read here.
pub(super) fn not_yet(tree: &Tree, what: &str, faults: &mut Faults) {
    faults.add(tree.at, format!("`{what}` is not supported yet: `{tree}`"));
}

impl Scope<'_> {
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
        if let Some(index) = among().position(|variable| variable == word) {
            return Some(Term::Variable(index));
        }
        let hint = hint(word, among(), "; declare it among the parameters");
        faults.add(
            tree.at,
            format!("the variable `{word}` is not declared{hint}"),
        );
        None
    }

    /// A name with arguments, of the given sort.
    pub(super) fn pattern(&self, tree: &Tree, sort: Sort, faults: &mut Faults) -> Option<Pattern> {
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
                faults.add(at.unwrap_or(head).at, misfit.to_string());
            }
        }
        Some(pattern)
    }

    /// A conjunction of literals, however nested. `()` is none.
    pub(super) fn condition(&self, tree: &Tree, faults: &mut Faults) -> Condition {
        let mut out = Vec::new();
        self.collect(tree, &mut out, faults);
        out
    }

    fn collect(&self, tree: &Tree, out: &mut Condition, faults: &mut Faults) {
        match (tree.head(), tree.list()) {
            (_, Some([])) => {}
            (Some("and"), Some(items)) => {
                for item in &items[1..] {
                    self.collect(item, out, faults);
                }
            }
            _ => out.extend(self.literal(tree, faults)),
        }
    }

    /// A fact, an equality, or one of them negated.
    pub(super) fn literal(&self, tree: &Tree, faults: &mut Faults) -> Option<Clause> {
        let Some("not") = tree.head() else {
            return self.positive(tree, true, faults);
        };
        match tree.list() {
            Some([_, inner]) if matches!(inner.head(), Some("and" | "not")) => {
                let what = "not of anything but a fact or an equality";
                not_yet(tree, what, faults);
                None
            }
            Some([_, inner]) => self.positive(inner, false, faults),
            _ => {
                faults.add(tree.at, "`not` takes one condition: `(not (at ?x))`");
                None
            }
        }
    }

    fn positive(&self, tree: &Tree, holds: bool, faults: &mut Faults) -> Option<Clause> {
        match (tree.head(), tree.list()) {
            (Some("="), Some([_, left, right])) => {
                if [left, right].iter().any(|side| side.list().is_some()) {
                    not_yet(tree, "= of numbers in a condition", faults);
                    return None;
                }
                let left = self.known_term(left, faults);
                let right = self.known_term(right, faults);
                Some(Clause::Equal(holds, left?, right?))
            }
            (Some("="), _) => {
                faults.add(tree.at, "`=` takes two arguments: `(= ?x ?y)`");
                None
            }
            (Some(head), _) if NOT_YET.contains(&head) => {
                not_yet(tree, head, faults);
                None
            }
            _ => {
                let pattern = self.pattern(tree, Sort::Predicate, faults)?;
                Some(Clause::Fact(holds, pattern))
            }
        }
    }

    /// A term outside an atom, whose declaration would have been asked there.
    fn known_term(&self, tree: &Tree, faults: &mut Faults) -> Option<Term> {
        let term = self.term(tree, faults)?;
        if let (Some(domain), Term::Constant(name)) = (self.domain, &term)
            && !domain.constants.contains_key(name)
        {
            let misfit = no_constant(domain, name, self.parameters);
            faults.add(tree.at, misfit.to_string());
        }
        Some(term)
    }

    /// A number: as written, a function, or reckoned from others.
    pub(super) fn number(&self, tree: &Tree, faults: &mut Faults) -> Option<Number> {
        let items = match &tree.kind {
            Kind::Word(word) => {
                let number = decimal(word);
                if number.is_none() {
                    faults.add(
                        tree.at,
                        format!(
                            "expected a number such as `2.5` or a function such as `(length \
                             ?arc)`, found `{word}`"
                        ),
                    );
                }
                return number.map(Number::Constant);
            }
            Kind::List(items) => items,
        };
        let sign = match tree.head() {
            Some(sign @ ("+" | "*" | "-" | "/")) => sign,
            _ => {
                let function = self.pattern(tree, Sort::Function, faults)?;
                return Some(Number::Function(function));
            }
        };
        let parts: Vec<Option<Number>> = items[1..]
            .iter()
            .map(|part| self.number(part, faults))
            .collect();
        let parts: Vec<Number> = parts.into_iter().collect::<Option<_>>()?;
        let wanted = match sign {
            "+" | "*" if parts.is_empty() => "at least one number",
            "-" | "/" if parts.len() != 2 => "two numbers",
            _ => "",
        };
        if !wanted.is_empty() {
            faults.add(tree.at, format!("`{sign}` takes {wanted}: `{tree}`"));
            return None;
        }
        let mut rest = parts.into_iter();
        match (sign, rest.next(), rest.next()) {
            ("+", Some(first), second) => Some(Number::Sum(chain(first, second, rest))),
            ("*", Some(first), second) => Some(Number::Product(chain(first, second, rest))),
            ("-", Some(left), Some(right)) => {
                Some(Number::Difference(Box::new(left), Box::new(right)))
            }
            (_, _, Some(Number::Constant(0.0))) => {
                faults.add(tree.at, format!("this divides by zero: `{tree}`"));
                None
            }
            (_, Some(left), Some(right)) => Some(Number::Quotient(Box::new(left), Box::new(right))),
            _ => None,
        }
    }
}

fn chain(first: Number, second: Option<Number>, rest: impl Iterator<Item = Number>) -> Vec<Number> {
    std::iter::once(first).chain(second).chain(rest).collect()
}

/// A finite number in the usual notation. Rust would also read `inf` and `nan`.
pub(super) fn decimal(word: &str) -> Option<f64> {
    let digits = word.strip_prefix(['-', '+']).unwrap_or(word);
    if !digits.starts_with(|first: char| first.is_ascii_digit() || first == '.') {
        return None;
    }
    word.parse().ok().filter(|number: &f64| number.is_finite())
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
