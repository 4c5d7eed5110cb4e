//! A domain and a problem, with names turned into numbers.

use rustc_hash::FxHashMap;

/// The number of an object, a predicate or a function, each counted for itself.
pub(crate) type Id = u32;

/// Names and their numbers.
#[derive(Debug, Default)]
pub(crate) struct Names {
    ids: FxHashMap<String, Id>,
    names: Vec<String>,
}

impl Names {
    pub(crate) fn intern(&mut self, name: &str) -> Id {
        if let Some(id) = self.ids.get(name) {
            return *id;
        }
        let id = self.names.len() as Id;
        self.ids.insert(name.to_owned(), id);
        self.names.push(name.to_owned());
        id
    }

    pub(crate) fn find(&self, name: &str) -> Option<Id> {
        self.ids.get(name).copied()
    }

    pub(crate) fn name(&self, id: Id) -> &str {
        self.names.get(id as usize).map_or("?", |name| name)
    }

    pub(crate) fn len(&self) -> usize {
        self.names.len()
    }
}

/// The objects of a type, or of one of several.
#[derive(Debug)]
pub(crate) struct Sort {
    pub(crate) name: String,
    pub(crate) members: Vec<Id>,
    pub(crate) has: Vec<bool>,
}

impl Sort {
    pub(crate) fn has(&self, object: Id) -> bool {
        self.has.get(object as usize).copied().unwrap_or(false)
    }
}

/// The number of a [`Sort`].
pub(crate) type SortId = usize;

/// A variable of the scope, or an object.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Term {
    Variable(usize),
    Object(Id),
}

/// A predicate or function and its arguments.
#[derive(Clone, Debug)]
pub(crate) struct Atom {
    pub(crate) name: Id,
    pub(crate) terms: Vec<Term>,
}

/// A condition with negation only at the leaves, and `forall` written as "there is none that not".
#[derive(Clone, Debug)]
pub(crate) enum Formula {
    /// True if the atom's truth is as said.
    Atom(Atom, bool),
    /// True if equality is as said.
    Equal(Term, Term, bool),
    /// True if membership is as said.
    OfSort(Term, SortId, bool),
    And(Vec<Formula>),
    Or(Vec<Formula>),
    /// True if there being such values is as said.
    Some(Quantified, bool),
}

/// A condition on variables of its own, which are slots of the scope as all others are.
#[derive(Clone, Debug)]
pub(crate) struct Quantified {
    pub(crate) slots: Vec<usize>,
    /// The variables of the body that are not its own.
    pub(crate) free: Vec<usize>,
    pub(crate) body: Box<Formula>,
}

impl Quantified {
    pub(crate) fn new(slots: Vec<usize>, body: Formula) -> Self {
        let mut free = Vec::new();
        body.collect_free(&mut free);
        free.sort_unstable();
        free.dedup();
        free.retain(|slot| !slots.contains(slot));
        Self {
            slots,
            free,
            body: Box::new(body),
        }
    }
}

impl Formula {
    fn collect_free(&self, into: &mut Vec<usize>) {
        let mut term = |term: &Term| {
            if let Term::Variable(slot) = term {
                into.push(*slot);
            }
        };
        match self {
            Self::Atom(atom, _) => atom.terms.iter().for_each(term),
            Self::Equal(left, right, _) => {
                term(left);
                term(right);
            }
            Self::OfSort(left, ..) => term(left),
            Self::And(parts) | Self::Or(parts) => {
                for part in parts {
                    part.collect_free(into);
                }
            }
            Self::Some(quantified, _) => into.extend(&quantified.free),
        }
    }
}

/// A variable's name and its type; those of parameters first, those of quantifiers after.
#[derive(Clone, Debug)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) sort: SortId,
}

/// A change of the state.
#[derive(Debug)]
pub(crate) struct Change {
    pub(crate) over: Vec<usize>,
    pub(crate) when: Formula,
    pub(crate) atom: Atom,
    pub(crate) add: bool,
}

/// What is added to the cost of the plan.
#[derive(Debug)]
pub(crate) enum Cost {
    Number(f64),
    Function(Atom),
}

/// What a primitive task does.
#[derive(Debug)]
pub(crate) struct Action {
    pub(crate) variables: Vec<Variable>,
    pub(crate) condition: Formula,
    pub(crate) changes: Vec<Change>,
    pub(crate) costs: Vec<Cost>,
}

/// A task's name and the types of its arguments. Actions are tasks, too.
#[derive(Debug)]
pub(crate) struct Task {
    pub(crate) name: String,
    pub(crate) sorts: Vec<SortId>,
    pub(crate) action: Option<Action>,
}

/// The number of a [`Task`].
pub(crate) type TaskId = usize;

/// A task with terms for arguments.
#[derive(Clone, Debug)]
pub(crate) struct Call {
    pub(crate) task: TaskId,
    pub(crate) terms: Vec<Term>,
}

/// How a task may be done; also the problem's own tasks, which then have no head.
#[derive(Debug)]
pub(crate) struct Method {
    pub(crate) name: String,
    pub(crate) head: Option<Call>,
    /// All variables; the first `parameters` of them are not of quantifiers.
    pub(crate) variables: Vec<Variable>,
    pub(crate) parameters: usize,
    /// Precondition and constraints.
    pub(crate) condition: Formula,
    pub(crate) subtasks: Vec<Call>,
    /// For each subtask those that come after it; for a total order only the next one.
    pub(crate) after: Vec<Vec<usize>>,
    /// For each subtask those that come before it, likewise.
    pub(crate) before: Vec<Vec<usize>>,
    /// The subtasks one after the other, if there is only one such order.
    pub(crate) chain: Option<Vec<usize>>,
}

/// A domain and a problem of it.
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) objects: Names,
    pub(crate) predicates: Names,
    pub(crate) sorts: Vec<Sort>,
    pub(crate) tasks: Vec<Task>,
    pub(crate) task_ids: FxHashMap<String, TaskId>,
    pub(crate) methods: Vec<Method>,
    pub(crate) method_ids: FxHashMap<String, Vec<usize>>,
    /// The problem's tasks as a method.
    pub(crate) root: Method,
    pub(crate) initially: Vec<Vec<Id>>,
    pub(crate) values: FxHashMap<Vec<Id>, f64>,
    pub(crate) goal: Formula,
    pub(crate) goal_variables: Vec<Variable>,
    /// Whether actions say what they cost.
    pub(crate) costs: bool,
}

impl Model {
    /// A task and its arguments, as HDDL writes them.
    pub(crate) fn call(&self, task: TaskId, arguments: &[Id]) -> String {
        let mut text = format!("({}", self.tasks[task].name);
        for argument in arguments {
            text.push(' ');
            text.push_str(self.objects.name(*argument));
        }
        text.push(')');
        text
    }

    /// A formula as HDDL writes it, with the values that its variables have.
    pub(crate) fn formula(
        &self,
        formula: &Formula,
        variables: &[Variable],
        values: &[Option<Id>],
    ) -> String {
        let term = |term: &Term| match term {
            Term::Object(object) => self.objects.name(*object).to_owned(),
            Term::Variable(slot) => match values.get(*slot).copied().flatten() {
                Some(object) => self.objects.name(object).to_owned(),
                None => variables[*slot].name.clone(),
            },
        };
        let not = |truth: bool, text: String| {
            if truth { text } else { format!("(not {text})") }
        };
        let several = |word: &str, parts: &[Formula]| {
            let mut text = format!("({word}");
            for part in parts {
                text.push(' ');
                text.push_str(&self.formula(part, variables, values));
            }
            text + ")"
        };
        match formula {
            Formula::Atom(atom, truth) => {
                let mut text = format!("({}", self.predicates.name(atom.name));
                for each in &atom.terms {
                    text.push(' ');
                    text.push_str(&term(each));
                }
                not(*truth, text + ")")
            }
            Formula::Equal(left, right, truth) => {
                not(*truth, format!("(= {} {})", term(left), term(right)))
            }
            Formula::OfSort(left, sort, truth) => {
                let name = &self.sorts[*sort].name;
                not(*truth, format!("(sortof {} - {name})", term(left)))
            }
            Formula::And(parts) => several("and", parts),
            Formula::Or(parts) => several("or", parts),
            Formula::Some(quantified, truth) => {
                let mut text = "(exists (".to_owned();
                for (index, slot) in quantified.slots.iter().enumerate() {
                    let space = if index == 0 { "" } else { " " };
                    text = text + space + &variables[*slot].name;
                }
                let body = self.formula(&quantified.body, variables, values);
                not(*truth, format!("{text}) {body})"))
            }
        }
    }
}
