//! What the domain's actions are to a robot: the vocabulary of `perform`.

use std::collections::BTreeMap;
use std::fmt;

use agent_core::model::{Action, Atom, Domain, ExecutionModel, Number, Pattern, Symbol, Term};
use serde::{Deserialize, Serialize};

/// How long a door takes to open or close, and a deed to be done, where the execution model gives no
/// constant.
const DEFAULT_DURATION_S: f64 = 2.0;

/// What a robot can do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Skill {
    /// `(drive ARC NODE)`: to the node at an end of the arc, from wherever it stands on it.
    Drive {
        /// Along this arc.
        arc: Symbol,
        /// To this end.
        to: Symbol,
    },
    /// `(speak SECONDS)`: for that long.
    Speak {
        /// How long.
        duration_s: f64,
    },
    /// `(set-door DOOR open|closed)`: it moves when the action's time is over.
    SetDoor {
        /// Which.
        door: Symbol,
        /// Open it, or close it.
        open: bool,
        /// How long that takes.
        duration_s: f64,
    },
    /// `(deed NAME ARG…)`: whatever that is to people. It is done when the action's time is over.
    Deed {
        /// In the model's own words.
        what: Action,
        /// How long that takes.
        duration_s: f64,
    },
}

impl Skill {
    /// The arc that it drives along.
    pub(super) fn arc(&self) -> Option<&Symbol> {
        match self {
            Self::Drive { arc, .. } => Some(arc),
            Self::Speak { .. } | Self::SetDoor { .. } | Self::Deed { .. } => None,
        }
    }
}

/// Why the execution model was refused, in the words of its author.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum VocabularyError {
    /// A misspelt name, most likely.
    #[error("the execution model speaks of `{0}`, which is not an action of the domain")]
    UnknownAction(Symbol),
    /// Not in the vocabulary.
    #[error(
        "action `{action}`: a robot cannot perform `{perform}`; it knows (drive ARC NODE), \
         (speak SECONDS), (set-door DOOR open|closed) and (deed NAME ARG…)"
    )]
    UnknownSkill {
        /// The action.
        action: Symbol,
        /// What stands there.
        perform: Symbol,
    },
    /// Too many arguments or too few.
    #[error("action `{action}`: `{perform}` takes {wanted} argument(s), not {given}")]
    ArgumentCount {
        /// The action.
        action: Symbol,
        /// What stands there.
        perform: Symbol,
        /// As the vocabulary has it.
        wanted: usize,
        /// As written.
        given: usize,
    },
    /// Not a length of time, or not a state of a door.
    #[error("action `{action}`: `{argument}` is not {wanted}")]
    WrongArgument {
        /// The action.
        action: Symbol,
        /// As written.
        argument: Symbol,
        /// What could stand there.
        wanted: &'static str,
    },
    /// The robot lets no door hang half open.
    #[error("action `{action}` cannot be suspended: a robot ends what it has begun of `{perform}`")]
    NotSuspendable {
        /// The action.
        action: Symbol,
        /// What stands there.
        perform: Symbol,
    },
}

/// Every action that a robot can be told to do.
#[derive(Clone, Debug)]
pub struct Vocabulary {
    entries: BTreeMap<Symbol, Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    parameters: usize,
    perform: Pattern,
    suspendable: bool,
    once: bool,
    duration_s: Option<f64>,
}

impl Vocabulary {
    /// Reads what the execution model says of the domain's actions. Actions without `perform` are
    /// not for a robot.
    pub fn new(domain: &Domain, model: &ExecutionModel) -> Result<Self, VocabularyError> {
        let mut entries = BTreeMap::new();
        for (action, about) in &model.actions {
            let Some(perform) = &about.perform else {
                continue;
            };
            let operator = domain
                .operators
                .get(action)
                .ok_or_else(|| VocabularyError::UnknownAction(action.clone()))?;
            check(action, perform)?;
            let suspendable = about.suspension.is_some();
            if suspendable && matches!(perform.name.as_str(), "set-door" | "deed") {
                return Err(VocabularyError::NotSuspendable {
                    action: action.clone(),
                    perform: perform.name.clone(),
                });
            }
            let duration_s = match about.duration_s {
                Some(Number::Constant(duration_s)) => Some(duration_s),
                _ => None,
            };
            entries.insert(
                action.clone(),
                Entry {
                    parameters: operator.parameters.len(),
                    perform: perform.clone(),
                    suspendable,
                    once: !about.repeatable,
                    duration_s,
                },
            );
        }
        Ok(Self { entries })
    }

    /// Whether that action must not be done again when nobody knows if it was done (decision 11).
    pub fn is_once(&self, action: &Action) -> bool {
        let entry = self.entries.get(&action.name);
        entry.is_some_and(|entry| entry.once)
    }

    /// What that action is to the robot, and whether it can be suspended; or in words why it is
    /// nothing that a robot can do.
    pub fn skill(&self, action: &Action) -> Result<(Skill, bool), String> {
        let entry = self
            .entries
            .get(&action.name)
            .ok_or_else(|| format!("a robot cannot do `{}`", action.name))?;
        if action.args.len() != entry.parameters {
            return Err(format!(
                "`{}` takes {} argument(s), not {}",
                action.name,
                entry.parameters,
                action.args.len()
            ));
        }
        let bindings: Vec<_> = action.args.iter().cloned().map(Some).collect();
        let performed = entry
            .perform
            .ground(&bindings)
            .ok_or_else(|| format!("`{}` leaves a variable open", action.name))?;
        let skill = parse(&performed, entry.duration_s)
            .map_err(|(argument, wanted)| format!("`{argument}` is not {wanted}"))?;
        Ok((skill, entry.suspendable))
    }
}

/// What can be known before the action has its arguments.
fn check(action: &Symbol, perform: &Pattern) -> Result<(), VocabularyError> {
    let wanted = match perform.name.as_str() {
        "drive" | "set-door" => 2,
        "speak" => 1,
        "deed" => perform.args.len().max(1),
        _ => {
            return Err(VocabularyError::UnknownSkill {
                action: action.clone(),
                perform: perform.name.clone(),
            });
        }
    };
    if perform.args.len() != wanted {
        return Err(VocabularyError::ArgumentCount {
            action: action.clone(),
            perform: perform.name.clone(),
            wanted,
            given: perform.args.len(),
        });
    }
    let last = perform.args.last();
    if let (Some(Term::Constant(argument)), "speak" | "set-door") = (last, perform.name.as_str()) {
        let args = vec![argument.clone(); wanted];
        let trial = Atom {
            name: perform.name.clone(),
            args,
        };
        parse(&trial, None).map_err(|(argument, wanted)| VocabularyError::WrongArgument {
            action: action.clone(),
            argument,
            wanted,
        })?;
    }
    Ok(())
}

/// Or the argument that does not fit, and what would.
fn parse(performed: &Atom, duration_s: Option<f64>) -> Result<Skill, (Symbol, &'static str)> {
    match (performed.name.as_str(), performed.args.as_slice()) {
        ("drive", [arc, to]) => Ok(Skill::Drive {
            arc: arc.clone(),
            to: to.clone(),
        }),
        ("speak", [seconds]) => match seconds.as_str().parse::<f64>() {
            Ok(duration_s) if duration_s.is_finite() && duration_s >= 0.0 => {
                Ok(Skill::Speak { duration_s })
            }
            _ => Err((seconds.clone(), "a number of seconds")),
        },
        ("set-door", [door, state]) => {
            let open = match state.as_str() {
                "open" => true,
                "closed" => false,
                _ => return Err((state.clone(), "`open` or `closed`")),
            };
            Ok(Skill::SetDoor {
                door: door.clone(),
                open,
                duration_s: duration_s.unwrap_or(DEFAULT_DURATION_S),
            })
        }
        ("deed", [name, args @ ..]) => Ok(Skill::Deed {
            what: Atom {
                name: name.clone(),
                args: args.to_vec(),
            },
            duration_s: duration_s.unwrap_or(DEFAULT_DURATION_S),
        }),
        // `check` has let through nothing else.
        _ => Err((performed.name.clone(), "something that a robot performs")),
    }
}

impl fmt::Display for Skill {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive { arc, to } => write!(f, "(drive {arc} {to})"),
            Self::Speak { duration_s } => write!(f, "(speak {duration_s})"),
            Self::SetDoor { door, open, .. } => {
                let state = if *open { "open" } else { "closed" };
                write!(f, "(set-door {door} {state})")
            }
            Self::Deed { what, .. } => {
                write!(f, "(deed {}", what.name)?;
                what.args.iter().try_for_each(|arg| write!(f, " {arg}"))?;
                f.write_str(")")
            }
        }
    }
}
