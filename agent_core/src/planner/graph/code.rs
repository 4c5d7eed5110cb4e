//! The domain in numbers.

use super::intern::{Map, NONE, Names};
use crate::model::{
    Change, Clause, CostRule, Domain, ExecutionModel, Number, Parameter, Pattern, Term,
};

/// A term: a variable or an object.
#[derive(Clone, Copy, Debug)]
pub(super) enum Arg {
    Variable(usize),
    Object(u32),
}

impl Arg {
    /// What it stands for; [`NONE`] if that is not bound.
    pub fn bound(self, bindings: &[u32]) -> u32 {
        match self {
            Self::Variable(index) => bindings.get(index).copied().unwrap_or(NONE),
            Self::Object(object) => object,
        }
    }
}

/// An atom with variables.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub name: u32,
    pub args: Vec<Arg>,
}

/// [`Clause`] in numbers; variables of quantifiers are there with their types alone.
#[derive(Clone, Debug)]
pub(super) enum Test {
    Fact(bool, Shape),
    Equal(bool, Arg, Arg),
    Any(Vec<Vec<Test>>),
    Every(Vec<u32>, Vec<Test>),
    Exists(Vec<u32>, Vec<Test>),
}

impl Test {
    /// Whether everything is bound that it speaks of, apart from variables of its own.
    pub fn is_bound(&self, bindings: &[u32]) -> bool {
        let bound = |arg: &Arg| match arg {
            Arg::Variable(index) => bindings.get(*index).is_none_or(|object| *object != NONE),
            Arg::Object(_) => true,
        };
        match self {
            Self::Fact(_, shape) => shape.args.iter().all(bound),
            Self::Equal(_, a, b) => bound(a) && bound(b),
            Self::Any(choices) => choices.iter().flatten().all(|test| test.is_bound(bindings)),
            Self::Every(_, inner) | Self::Exists(_, inner) => {
                inner.iter().all(|test| test.is_bound(bindings))
            }
        }
    }

    /// Calls `found` with every predicate in it.
    fn each_predicate(&self, found: &mut dyn FnMut(u32)) {
        match self {
            Self::Fact(_, shape) => found(shape.name),
            Self::Equal(..) => {}
            Self::Any(choices) => {
                for test in choices.iter().flatten() {
                    test.each_predicate(found);
                }
            }
            Self::Every(_, inner) | Self::Exists(_, inner) => {
                for test in inner {
                    test.each_predicate(found);
                }
            }
        }
    }
}

/// [`Number`] in numbers.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Constant(f64),
    Function(Shape),
    Sum(Vec<Value>),
    Product(Vec<Value>),
    Difference(Box<(Value, Value)>),
    Quotient(Box<(Value, Value)>),
}

/// [`Change`] in numbers.
#[derive(Clone, Debug)]
pub(super) struct Write {
    /// The types of the variables that range over objects.
    pub over: Vec<u32>,
    pub when: Vec<Test>,
    pub fact: Shape,
}

/// A number under a condition, with variables of its own.
#[derive(Clone, Debug)]
pub(super) struct Rule {
    pub kinds: Vec<u32>,
    pub given: Vec<Test>,
    pub value: Value,
    /// What a task leaves true.
    pub establishes: Vec<Shape>,
}

/// An operator.
#[derive(Clone, Debug)]
pub(super) struct Operator {
    pub kinds: Vec<u32>,
    pub precondition: Vec<Test>,
    pub remove: Vec<Write>,
    pub add: Vec<Write>,
    pub cost: Value,
    pub rules: Vec<Rule>,
}

/// A method.
#[derive(Clone, Debug)]
pub(super) struct Method {
    pub kinds: Vec<u32>,
    pub head: Vec<Arg>,
    pub precondition: Vec<Test>,
    pub subtasks: Vec<Shape>,
}

/// The domain and its execution model.
#[derive(Clone, Debug, Default)]
pub(super) struct Code {
    pub operators: Map<u32, Operator>,
    /// By task, in the order in which they are written.
    pub methods: Map<u32, Vec<Method>>,
    /// By task, the types of its arguments.
    pub tasks: Map<u32, Vec<u32>>,
    /// By task.
    pub estimates: Map<u32, Rule>,
    pub observable: Vec<u32>,
    /// Predicates that effects change, those of suspensions included.
    pub changing: Vec<u32>,
    /// By task and action: the predicates that doing it may ask for, to the last subtask, sorted.
    pub reads: Map<u32, Vec<u32>>,
    /// The predicates on which it hangs what can be done.
    pub decisive: Vec<u32>,
}

impl Code {
    pub fn new(names: &mut Names, domain: &Domain, model: &ExecutionModel) -> Self {
        let mut code = Self::default();
        for (name, operator) in &domain.operators {
            let action = model.actions.get(name);
            let rules = action.into_iter().flat_map(|action| &action.costs);
            let operator = Operator {
                kinds: kinds(names, &operator.parameters),
                precondition: tests(names, &operator.precondition),
                remove: writes(names, &operator.effect.remove),
                add: writes(names, &operator.effect.add),
                cost: value(names, &operator.cost),
                rules: rules.map(|rule| cost_rule(names, rule)).collect(),
            };
            code.operators.insert(names.number(name), operator);
        }
        for (task, parameters) in &domain.tasks {
            let kinds = kinds(names, parameters);
            code.tasks.insert(names.number(task), kinds);
        }
        for method in &domain.methods {
            let task = names.number(&method.task.name);
            let method = Method {
                kinds: kinds(names, &method.parameters),
                head: shape(names, &method.task).args,
                precondition: tests(names, &method.precondition),
                subtasks: method.subtasks.iter().map(|s| shape(names, s)).collect(),
            };
            code.methods.entry(task).or_default().push(method);
        }
        for (task, model) in &model.tasks {
            let rule = Rule {
                kinds: kinds(names, &model.parameters),
                given: tests(names, &model.given),
                value: value(names, &model.estimate),
                establishes: model.establishes.iter().map(|s| shape(names, s)).collect(),
            };
            code.estimates.insert(names.number(task), rule);
        }
        code.observable = model.observable.iter().map(|p| names.number(p)).collect();
        code.changing = changing(names, domain, model);
        code.close();
        code
    }

    /// What doing each task and action may ask for.
    fn close(&mut self) {
        let mut reads: Map<u32, Vec<u32>> = Map::default();
        let mut decisive = Vec::new();
        for (name, operator) in &self.operators {
            let found = reads.entry(*name).or_default();
            let rules = operator.rules.iter().flat_map(|rule| &rule.given);
            let writes = operator.remove.iter().chain(&operator.add);
            each(&operator.precondition, &mut |p| decisive.push(p));
            let asked = operator.precondition.iter().chain(rules);
            each(
                asked.chain(writes.flat_map(|write| &write.when)),
                &mut |p| {
                    found.push(p);
                },
            );
        }
        for (task, rule) in &self.estimates {
            let found = reads.entry(*task).or_default();
            each(&rule.given, &mut |p| found.push(p));
        }
        for (task, methods) in &self.methods {
            let found = reads.entry(*task).or_default();
            for method in methods {
                each(&method.precondition, &mut |p| {
                    found.push(p);
                    decisive.push(p);
                });
            }
        }
        for found in reads.values_mut() {
            tidy(found);
        }
        // What the subtasks ask for, until nothing is added.
        let mut grows = true;
        while std::mem::take(&mut grows) {
            for (task, methods) in &self.methods {
                let subtasks = methods.iter().flat_map(|method| &method.subtasks);
                let below = subtasks.filter_map(|subtask| reads.get(&subtask.name));
                let mut all: Vec<u32> = below.flatten().copied().collect();
                let before = reads.entry(*task).or_default();
                all.extend(before.iter());
                tidy(&mut all);
                grows |= all.len() > before.len();
                *before = all;
            }
        }
        tidy(&mut decisive);
        self.reads = reads;
        self.decisive = decisive;
    }
}

fn each<'a>(tests: impl IntoIterator<Item = &'a Test>, found: &mut dyn FnMut(u32)) {
    for test in tests {
        test.each_predicate(found);
    }
}

fn tidy(numbers: &mut Vec<u32>) {
    numbers.sort_unstable();
    numbers.dedup();
}

fn changing(names: &mut Names, domain: &Domain, model: &ExecutionModel) -> Vec<u32> {
    let suspensions = model.actions.values().filter_map(|a| a.suspension.as_ref());
    let operators = domain.operators.values().map(|operator| &operator.effect);
    let effects = operators.chain(suspensions.map(|suspension| &suspension.effect));
    let mut changing: Vec<u32> = effects
        .flat_map(|effect| effect.remove.iter().chain(&effect.add))
        .map(|change| names.number(&change.fact.name))
        .collect();
    changing.extend(model.observable.iter().map(|p| names.number(p)));
    tidy(&mut changing);
    changing
}

fn arg(names: &mut Names, term: &Term) -> Arg {
    match term {
        Term::Variable(index) => Arg::Variable(*index),
        Term::Constant(object) => Arg::Object(names.number(object)),
    }
}

fn shape(names: &mut Names, pattern: &Pattern) -> Shape {
    Shape {
        name: names.number(&pattern.name),
        args: pattern.args.iter().map(|term| arg(names, term)).collect(),
    }
}

fn kinds(names: &mut Names, parameters: &[Parameter]) -> Vec<u32> {
    let kinds = parameters.iter().map(|parameter| &parameter.kind);
    kinds.map(|kind| names.number(kind)).collect()
}

fn tests(names: &mut Names, condition: &[Clause]) -> Vec<Test> {
    condition.iter().map(|clause| test(names, clause)).collect()
}

fn test(names: &mut Names, clause: &Clause) -> Test {
    match clause {
        Clause::Fact(wanted, pattern) => Test::Fact(*wanted, shape(names, pattern)),
        Clause::Equal(wanted, a, b) => Test::Equal(*wanted, arg(names, a), arg(names, b)),
        Clause::Any(choices) => Test::Any(choices.iter().map(|c| tests(names, c)).collect()),
        Clause::Every(over, inner) => Test::Every(kinds(names, over), tests(names, inner)),
        Clause::Exists(over, inner) => Test::Exists(kinds(names, over), tests(names, inner)),
    }
}

fn value(names: &mut Names, number: &Number) -> Value {
    match number {
        Number::Constant(constant) => Value::Constant(*constant),
        Number::Function(pattern) => Value::Function(shape(names, pattern)),
        Number::Sum(terms) => Value::Sum(terms.iter().map(|t| value(names, t)).collect()),
        Number::Product(factors) => {
            Value::Product(factors.iter().map(|f| value(names, f)).collect())
        }
        Number::Difference(a, b) => Value::Difference(Box::new((value(names, a), value(names, b)))),
        Number::Quotient(a, b) => Value::Quotient(Box::new((value(names, a), value(names, b)))),
    }
}

fn writes(names: &mut Names, changes: &[Change]) -> Vec<Write> {
    let write = |change: &Change| Write {
        over: kinds(names, &change.over),
        when: tests(names, &change.when),
        fact: shape(names, &change.fact),
    };
    changes.iter().map(write).collect()
}

fn cost_rule(names: &mut Names, rule: &CostRule) -> Rule {
    Rule {
        kinds: kinds(names, &rule.parameters),
        given: tests(names, &rule.given),
        value: value(names, &rule.cost),
        establishes: Vec::new(),
    }
}
