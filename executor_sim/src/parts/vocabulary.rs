//! What the domain's actions are to the parts of a vehicle: the vocabulary of `perform`.

use std::collections::BTreeMap;

use agent_core::model::{
    Action, ActionModel, Atom, Belief, Domain, ExecutionModel, Number, Pattern, Symbol, Term,
};

use super::{Errand, PartName, Work};
use crate::VocabularyError;

/// How long something takes of which the execution model says nothing, in seconds.
const DEFAULT_DURATION_S: f64 = 2.0;

/// Verbs that are the base's, as in a vehicle that is nothing else.
const OF_THE_BASE: [&str; 3] = ["drive", "set-door", "deed"];

/// Verbs of the arm, and how many arguments they take after their name.
const OF_THE_ARM: [(&str, usize); 7] = [
    ("grasp", 1),
    ("stow", 2),
    ("take", 2),
    ("set-back", 1),
    ("put-down", 1),
    ("hand-over", 2),
    ("wipe", 1),
];

/// Why the execution model was refused, in the words of its author.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum PartsError {
    /// What the base is to do.
    #[error(transparent)]
    Base(#[from] VocabularyError),
    /// A misspelt name, most likely.
    #[error("the execution model speaks of `{0}`, which is not an action of the domain")]
    UnknownAction(Symbol),
    /// Not in the vocabulary.
    #[error(
        "action `{action}`: no part of a vehicle can perform `{perform}`; there are (drive ARC \
         NODE), (set-door DOOR open|closed), (deed NAME ARG…), (arm grasp BOTTLE), (arm stow BOTTLE \
         SLOT), (arm take BOTTLE SLOT), (arm set-back BOTTLE), (arm put-down BOTTLE), (arm hand-over \
         BOTTLE GUEST), (arm wipe PLACE), (watch SECONDS), (speak SECONDS) and (ask GUEST)"
    )]
    UnknownErrand {
        /// The action.
        action: Symbol,
        /// What stands there.
        perform: String,
    },
    /// Too many arguments or too few.
    #[error("action `{action}`: `{perform}` takes {wanted} argument(s), not {given}")]
    ArgumentCount {
        /// The action.
        action: Symbol,
        /// What stands there.
        perform: String,
        /// As the vocabulary has it.
        wanted: usize,
        /// As written.
        given: usize,
    },
    /// Not a length of time.
    #[error("action `{action}`: `{argument}` is not a number of seconds")]
    NotSeconds {
        /// The action.
        action: Symbol,
        /// As written.
        argument: Symbol,
    },
    /// A guest reaches for it.
    #[error("action `{0}` cannot be suspended: nobody pulls back what a guest reaches for")]
    NotSuspendable(Symbol),
}

/// What an action is to a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// The base's; towards that place, if it is a drive.
    Base {
        /// The end of the arc.
        to: Option<Symbol>,
    },
    /// Another part's.
    Part {
        /// What, and how long it takes.
        work: Work,
        /// Whether it can be suspended.
        suspendable: bool,
    },
}

/// Every action that a vehicle can be told to do.
#[derive(Clone, Debug)]
pub struct PartsVocabulary {
    entries: BTreeMap<Symbol, Entry>,
    /// What durations depend on.
    map: Belief,
    base: ExecutionModel,
}

#[derive(Clone, Debug)]
struct Entry {
    parameters: usize,
    perform: Pattern,
    suspendable: bool,
    duration: Option<Number>,
    /// Of the action that takes it up again, in its own parameters, and these in ours.
    again: Option<(Number, Vec<Term>)>,
}

impl PartsVocabulary {
    /// Reads what the execution model says of the domain's actions; `map` has the values that their
    /// durations depend on. Actions without `perform` are for nobody here.
    pub fn new(domain: &Domain, model: &ExecutionModel, map: Belief) -> Result<Self, PartsError> {
        let mut entries = BTreeMap::new();
        let mut base = model.clone();
        base.actions.clear();
        for (action, about) in &model.actions {
            let Some(perform) = &about.perform else {
                continue;
            };
            let operator = domain.operators.get(action);
            let operator = operator.ok_or_else(|| PartsError::UnknownAction(action.clone()))?;
            if OF_THE_BASE.contains(&perform.name.as_str()) {
                base.actions.insert(action.clone(), about.clone());
            } else {
                check(action, about, perform)?;
            }
            let again = about.suspension.as_ref().and_then(|suspension| {
                let resume = model.actions.get(&suspension.resume.name)?;
                Some((resume.duration_s.clone()?, suspension.resume.args.clone()))
            });
            let entry = Entry {
                parameters: operator.parameters.len(),
                perform: perform.clone(),
                suspendable: about.suspension.is_some(),
                duration: about.duration_s.clone(),
                again,
            };
            entries.insert(action.clone(), entry);
        }
        // In the base's own words, if something is wrong with what it is to do.
        crate::Vocabulary::new(domain, &base)?;
        Ok(Self { entries, map, base })
    }

    /// What the execution model says of the actions of the base.
    pub(crate) fn of_the_base(&self) -> &ExecutionModel {
        &self.base
    }

    /// What that action is; or in words why it is nothing that a vehicle can do.
    pub fn job(&self, action: &Action) -> Result<Job, String> {
        let entry = self.entries.get(&action.name);
        let entry =
            entry.ok_or_else(|| format!("no part of a vehicle can do `{}`", action.name))?;
        if action.args.len() != entry.parameters {
            return Err(format!(
                "`{}` takes {} argument(s), not {}",
                action.name,
                entry.parameters,
                action.args.len()
            ));
        }
        let bindings: Vec<Option<Symbol>> = action.args.iter().cloned().map(Some).collect();
        let performed = entry.perform.ground(&bindings);
        let performed =
            performed.ok_or_else(|| format!("`{}` leaves a variable open", action.name))?;
        if OF_THE_BASE.contains(&performed.name.as_str()) {
            let to = match (performed.name.as_str(), performed.args.as_slice()) {
                ("drive", [_, to]) => Some(to.clone()),
                _ => None,
            };
            return Ok(Job::Base { to });
        }
        let (errand, seconds) = parse(&performed)
            .ok_or_else(|| format!("`{performed}` is nothing that a part performs"))?;
        let duration_s = |number: &Number, bindings: &[Option<Symbol>]| {
            let value = evaluate(number, bindings, &self.map)?;
            (value.is_finite() && value >= 0.0).then_some(value)
        };
        let said = entry.duration.as_ref();
        let said = said.and_then(|number| duration_s(number, &bindings));
        let left_s = seconds.or(said).unwrap_or(DEFAULT_DURATION_S);
        let again = entry.again.as_ref().and_then(|(number, terms)| {
            let terms: Vec<_> = terms.iter().map(|term| term.bound(&bindings)).collect();
            duration_s(number, &terms)
        });
        let work = Work {
            errand,
            left_s,
            again_s: again.unwrap_or(left_s),
        };
        Ok(Job::Part {
            work,
            suspendable: entry.suspendable,
        })
    }
}

/// What can be known before the action has its arguments.
fn check(action: &Symbol, about: &ActionModel, perform: &Pattern) -> Result<(), PartsError> {
    let unknown = || PartsError::UnknownErrand {
        action: action.clone(),
        perform: written(perform),
    };
    let (given, wanted) = match perform.name.as_str() {
        "watch" | "speak" | "ask" => (perform.args.len(), 1),
        "arm" => {
            let Some(Term::Constant(verb)) = perform.args.first() else {
                return Err(unknown());
            };
            let known = OF_THE_ARM.iter().find(|(known, _)| verb == known);
            let (_, wanted) = known.ok_or_else(unknown)?;
            if verb == "hand-over" && about.suspension.is_some() {
                return Err(PartsError::NotSuspendable(action.clone()));
            }
            (perform.args.len() - 1, *wanted)
        }
        _ => return Err(unknown()),
    };
    if given != wanted {
        return Err(PartsError::ArgumentCount {
            action: action.clone(),
            perform: written(perform),
            wanted,
            given,
        });
    }
    if let ("watch" | "speak", Some(Term::Constant(argument))) =
        (perform.name.as_str(), perform.args.first())
        && seconds(argument).is_none()
    {
        return Err(PartsError::NotSeconds {
            action: action.clone(),
            argument: argument.clone(),
        });
    }
    Ok(())
}

fn written(perform: &Pattern) -> String {
    let args = perform.args.iter().map(|term| match term {
        Term::Variable(_) => "?…".to_owned(),
        Term::Constant(object) => object.to_string(),
    });
    let words: Vec<String> = std::iter::once(perform.name.to_string())
        .chain(args)
        .collect();
    format!("({})", words.join(" "))
}

fn seconds(text: &Symbol) -> Option<f64> {
    let value: f64 = text.as_str().parse().ok()?;
    (value.is_finite() && value >= 0.0).then_some(value)
}

/// The errand, and how long it takes if it says so itself.
fn parse(performed: &Atom) -> Option<(Errand, Option<f64>)> {
    let args: Vec<&str> = performed.args.iter().map(Symbol::as_str).collect();
    let errand = match (performed.name.as_str(), args.as_slice()) {
        ("watch", [_]) => return Some((Errand::Watch, Some(seconds(&performed.args[0])?))),
        ("speak", [_]) => return Some((Errand::Speak, Some(seconds(&performed.args[0])?))),
        ("ask", [guest]) => Errand::Ask {
            guest: (*guest).into(),
        },
        ("arm", ["grasp", bottle]) => Errand::Grasp {
            bottle: (*bottle).into(),
        },
        ("arm", ["stow", bottle, slot]) => Errand::Stow {
            bottle: (*bottle).into(),
            slot: (*slot).into(),
        },
        ("arm", ["take", bottle, slot]) => Errand::Take {
            bottle: (*bottle).into(),
            slot: (*slot).into(),
        },
        ("arm", ["set-back", bottle]) => Errand::SetBack {
            bottle: (*bottle).into(),
        },
        ("arm", ["put-down", bottle]) => Errand::PutDown {
            bottle: (*bottle).into(),
        },
        ("arm", ["hand-over", bottle, guest]) => Errand::HandOver {
            bottle: (*bottle).into(),
            guest: (*guest).into(),
        },
        ("arm", ["wipe", place]) => Errand::Wipe {
            place: (*place).into(),
        },
        _ => return None,
    };
    Some((errand, None))
}

/// A number of the map. `None` if it depends on something that the map does not say.
fn evaluate(number: &Number, bindings: &[Option<Symbol>], map: &Belief) -> Option<f64> {
    let value = |number: &Number| evaluate(number, bindings, map);
    match number {
        Number::Constant(value) => Some(*value),
        Number::Function(function) => map.value(&function.ground(bindings)?),
        Number::Sum(parts) => parts
            .iter()
            .map(value)
            .try_fold(0.0, |sum, part| Some(sum + part?)),
        Number::Product(parts) => parts
            .iter()
            .map(value)
            .try_fold(1.0, |product, part| Some(product * part?)),
        Number::Difference(first, second) => Some(value(first)? - value(second)?),
        Number::Quotient(first, second) => Some(value(first)? / value(second)?),
    }
}

impl Job {
    /// Which part does it.
    pub fn part(&self) -> PartName {
        match self {
            Self::Base { .. } => PartName::Base,
            Self::Part { work, .. } => work.errand.part(),
        }
    }
}
