//! Domains and problems made at random: small ones, in which everything that a condition or an
//! effect can be occurs.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::random::Random;
use crate::model::{
    ActionModel, Atom, Belief, Change, Clause, Condition, CostRule, Domain, Effect, ExecutionModel,
    Fact, FactChange, Map, Method, Number, Operator, Parameter, Pattern, Suspension, Symbol, Task,
    TaskModel, Term,
};

/// A domain and what may happen in it.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub domain: Arc<Domain>,
    pub model: Arc<ExecutionModel>,
    pub map: Arc<Map>,
    pub belief: Belief,
    /// Facts that may change without an action.
    pub changing: Vec<Fact>,
    /// Functions of which the value may change.
    pub functions: Vec<Fact>,
    /// Tasks that may be asked for.
    pub tasks: Vec<Task>,
    /// Where the robot may be; if it is always at one place, which changes by going alone or by
    /// being carried.
    pub spots: Vec<Fact>,
}

struct Maker<'a> {
    random: &'a mut Random,
    objects: BTreeMap<Symbol, Symbol>,
    domain: Domain,
    model: ExecutionModel,
    /// The robot is always at one place, which estimates need.
    one_place: bool,
}

const KINDS: [&str; 3] = ["spot", "thing", "object"];

fn parameter(name: &str, kind: &str) -> Parameter {
    Parameter {
        name: Symbol::from(format!("?{name}")),
        kind: Symbol::from(kind),
    }
}

fn pattern(name: &str, variables: &[usize]) -> Pattern {
    Pattern {
        name: Symbol::from(name),
        args: variables.iter().map(|v| Term::Variable(*v)).collect(),
    }
}

fn fact(wanted: bool, name: &str, variables: &[usize]) -> Clause {
    Clause::Fact(wanted, pattern(name, variables))
}

fn effect(remove: Vec<Change>, add: Vec<Change>) -> Effect {
    Effect { remove, add }
}

/// A scene from a seed.
pub(super) fn scene(random: &mut Random) -> Scene {
    let mut objects = BTreeMap::new();
    for number in 0..random.between(2, 4) {
        objects.insert(Symbol::from(format!("s{number}")), Symbol::from("spot"));
    }
    for number in 0..random.between(1, 2) {
        objects.insert(Symbol::from(format!("t{number}")), Symbol::from("thing"));
    }
    let types = [("spot", "object"), ("thing", "object")];
    let domain = Domain {
        name: Symbol::from("random"),
        types: types.map(|(a, b)| (a.into(), b.into())).into(),
        ..Domain::default()
    };
    let mut maker = Maker {
        random,
        objects,
        domain,
        model: ExecutionModel::default(),
        one_place: false,
    };
    maker.one_place = maker.random.chance(60);
    maker.predicates();
    maker.moving();
    for number in 0..maker.random.between(2, 4) {
        maker.operator(number);
    }
    for number in 0..maker.random.between(1, 4) {
        maker.task(number);
    }
    if maker.one_place {
        maker.estimates();
    }
    maker.finish()
}

impl Maker<'_> {
    fn predicates(&mut self) {
        self.declare("at", &["spot"]);
        self.declare("on", &["spot", "spot"]);
        self.declare("link", &["spot", "spot"]);
        self.declare("open", &["spot", "spot"]);
        self.declare("wet", &["spot"]);
        for number in 0..self.random.between(2, 4) {
            let arity = *self.random.pick(&[0, 1, 1, 1, 2]);
            let kinds: Vec<&str> = (0..arity).map(|_| self.random.word(&KINDS)).collect();
            self.declare(&format!("p{number}"), &kinds);
        }
        self.model.observable.push(Symbol::from("open"));
        if self.random.chance(50) {
            self.model.observable.push(Symbol::from("p0"));
        }
        for function in ["far", "toll"] {
            self.domain
                .functions
                .insert(function.into(), vec![parameter("a", "spot")]);
        }
    }

    fn declare(&mut self, name: &str, kinds: &[&str]) {
        let parameters = kinds.iter().map(|kind| parameter("a", kind)).collect();
        self.domain.predicates.insert(name.into(), parameters);
    }

    /// A robot that goes from spot to spot, may be stopped between two, and goes on or back.
    fn moving(&mut self) {
        let spot = |name: &str| parameter(name, "spot");
        let two = vec![spot("a"), spot("b")];
        let toll = match self.random.below(3) {
            0 => Number::Constant(self.random.between(0, 5) as f64),
            1 => Number::Function(pattern("toll", &[1])),
            _ => Number::Sum(vec![
                Number::Function(pattern("far", &[0])),
                Number::Constant(1.0),
            ]),
        };
        let go = Operator {
            name: "move".into(),
            parameters: two.clone(),
            precondition: vec![
                fact(true, "at", &[0]),
                fact(true, "link", &[0, 1]),
                fact(true, "open", &[0, 1]),
            ],
            effect: effect(
                vec![pattern("at", &[0]).into()],
                vec![pattern("at", &[1]).into()],
            ),
            cost: toll,
        };
        let off = |name: &str, end: usize, cost: f64| Operator {
            name: name.into(),
            parameters: two.clone(),
            precondition: vec![fact(true, "on", &[0, 1])],
            effect: effect(
                vec![pattern("on", &[0, 1]).into()],
                vec![pattern("at", &[end]).into()],
            ),
            cost: Number::Constant(cost),
        };
        for operator in [go, off("resume-move", 1, 1.0), off("return", 0, 2.0)] {
            self.domain
                .operators
                .insert(operator.name.clone(), operator);
        }
        self.model.actions.insert(
            "move".into(),
            ActionModel {
                suspension: Some(Suspension {
                    effect: effect(
                        vec![pattern("at", &[0]).into()],
                        vec![pattern("on", &[0, 1]).into()],
                    ),
                    resume: pattern("resume-move", &[0, 1]),
                    rollback: self.random.chance(70).then(|| pattern("return", &[0, 1])),
                    reach: self.random.chance(50).then(|| pattern("go", &[0])),
                }),
                ..ActionModel::default()
            },
        );
        self.domain.tasks.insert("go".into(), vec![spot("x")]);
        let method = |parameters: Vec<Parameter>, precondition, subtasks| Method {
            name: "go".into(),
            parameters,
            task: pattern("go", &[0]),
            precondition,
            subtasks,
        };
        let mut step = vec![fact(true, "at", &[1]), fact(true, "link", &[1, 2])];
        if self.random.chance(50) {
            step.push(Clause::Equal(false, Term::Variable(0), Term::Variable(1)));
        }
        if self.random.chance(70) {
            step.push(fact(true, "open", &[1, 2]));
        }
        self.domain.methods.extend([
            method(vec![spot("x")], vec![fact(true, "at", &[0])], Vec::new()),
            method(
                vec![spot("x"), spot("y"), spot("z")],
                step,
                vec![pattern("move", &[1, 2]), pattern("go", &[0])],
            ),
            method(
                vec![spot("x"), spot("y"), spot("z")],
                vec![fact(true, "on", &[1, 2])],
                vec![pattern("return", &[1, 2]), pattern("go", &[0])],
            ),
        ]);
    }

    /// A predicate that actions are about, with variables in scope for its arguments; now and
    /// then an object.
    fn fact_about(&mut self, scope: &[Parameter]) -> Option<Pattern> {
        let names = ["p0", "p1", "p2", "p3", "at", "open"];
        let name = Symbol::from(self.random.word(&names));
        let wanted = self.domain.predicates.get(&name)?.clone();
        let mut args = Vec::new();
        for parameter in wanted {
            let fits = |given: &Symbol| self.domain.is_a(given, &parameter.kind);
            let variables = scope.iter().enumerate().filter(|(_, v)| fits(&v.kind));
            let variables: Vec<Term> = variables.map(|(v, _)| Term::Variable(v)).collect();
            let objects = self.objects.iter().filter(|(_, given)| fits(given));
            let objects: Vec<Term> = objects.map(|(o, _)| Term::Constant(o.clone())).collect();
            let some = match variables.is_empty() || self.random.chance(20) {
                true => objects,
                false => variables,
            };
            args.push(self.random.pick(&some).clone());
        }
        Some(Pattern { name, args })
    }

    fn condition(&mut self, scope: &[Parameter], depth: usize) -> Condition {
        let count = *self.random.pick(&[0, 1, 1, 2]);
        (0..count)
            .filter_map(|_| self.clause(scope, depth))
            .collect()
    }

    fn clause(&mut self, scope: &[Parameter], depth: usize) -> Option<Clause> {
        let kind = self.random.word(&KINDS);
        let inner = [scope, &[parameter("q", kind)]].concat();
        let over = vec![parameter("q", kind)];
        Some(match self.random.below(if depth == 0 { 6 } else { 10 }) {
            0..=3 => Clause::Fact(true, self.fact_about(scope)?),
            4 => Clause::Fact(false, self.fact_about(scope)?),
            5 if scope.len() > 1 => {
                let (a, b) = (
                    self.random.below(scope.len()),
                    self.random.below(scope.len()),
                );
                Clause::Equal(self.random.chance(30), Term::Variable(a), Term::Variable(b))
            }
            5 => return None,
            6 | 7 => Clause::Any(vec![
                self.condition(scope, depth - 1),
                vec![self.clause(scope, depth - 1)?],
            ]),
            8 => Clause::Every(over, vec![self.clause(&inner, depth - 1)?]),
            _ => Clause::Exists(over, self.condition(&inner, depth - 1)),
        })
    }

    fn change(&mut self, scope: &[Parameter], adds: bool) -> Option<Change> {
        let mut over = Vec::new();
        let mut inner = scope.to_vec();
        if self.random.chance(25) {
            over.push(parameter("q", self.random.word(&KINDS)));
            inner.extend(over.clone());
        }
        let when = match self.random.chance(25) {
            true => self.condition(&inner, 1),
            false => Vec::new(),
        };
        let mut fact = self.fact_about(&inner)?;
        // Where the robot is, moving alone decides, most of the time.
        if fact.name == "at" && self.random.chance(if adds { 90 } else { 30 }) {
            fact = self.fact_about(&inner)?;
        }
        // It may be nowhere, but not at two places.
        if fact.name == "at" && adds && self.one_place {
            return None;
        }
        Some(Change { over, when, fact })
    }

    fn changes(&mut self, scope: &[Parameter], most: usize, adds: bool) -> Vec<Change> {
        let count = self.random.between(0, most);
        (0..count)
            .filter_map(|_| self.change(scope, adds))
            .collect()
    }

    fn operator(&mut self, number: usize) {
        let count = self.random.below(3);
        let parameters: Vec<Parameter> = (0..count)
            .map(|place| parameter(&format!("v{place}"), self.random.word(&KINDS[..2])))
            .collect();
        let name = Symbol::from(format!("o{number}"));
        let cost = match parameters.first() {
            Some(first) if first.kind == "spot" && self.random.chance(40) => {
                Number::Function(pattern(self.random.word(&["far", "toll"]), &[0]))
            }
            _ => Number::Constant(self.random.between(0, 4) as f64),
        };
        let operator = Operator {
            name: name.clone(),
            precondition: self.condition(&parameters, 2),
            effect: effect(
                self.changes(&parameters, 2, false),
                self.changes(&parameters, 2, true),
            ),
            cost,
            parameters: parameters.clone(),
        };
        self.domain.operators.insert(name.clone(), operator);
        let mut model = ActionModel::default();
        if self.random.chance(25) {
            // What no action changes, or estimates would not be lower bounds.
            model.costs.push(CostRule {
                parameters: [parameters.clone(), vec![parameter("w", "spot")]].concat(),
                given: vec![fact(true, "wet", &[count])],
                cost: Number::Constant(self.random.between(1, 6) as f64),
            });
        }
        if self.random.chance(40) {
            let resume = Symbol::from(format!("resume-{name}"));
            let mut resuming = self.domain.operators[&name].clone();
            resuming.name = resume.clone();
            resuming.precondition.clear();
            self.domain.operators.insert(resume.clone(), resuming);
            let all: Vec<usize> = (0..count).collect();
            model.suspension = Some(Suspension {
                effect: effect(
                    self.changes(&parameters, 1, false),
                    self.changes(&parameters, 1, true),
                ),
                resume: pattern(resume.as_str(), &all),
                rollback: None,
                reach: None,
            });
        }
        self.model.actions.insert(name, model);
    }

    fn task(&mut self, number: usize) {
        let count = self.random.below(3);
        let parameters: Vec<Parameter> = (0..count)
            .map(|place| parameter(&format!("v{place}"), self.random.word(&KINDS[..2])))
            .collect();
        let name = Symbol::from(format!("d{number}"));
        self.domain.tasks.insert(name.clone(), parameters.clone());
        for _ in 0..self.random.between(1, 3) {
            let mut scope = parameters.clone();
            for place in 0..self.random.below(3) {
                scope.push(parameter(&format!("w{place}"), self.random.word(&KINDS)));
            }
            let precondition = self.condition(&scope, 2);
            let count = self.random.below(4);
            let subtasks = (0..count).filter_map(|_| self.subtask(number, &scope));
            let mut subtasks: Vec<Pattern> = subtasks.collect();
            let only_actions = subtasks.iter().all(|s| self.is_operator(s));
            let acts = !subtasks.is_empty() && only_actions;
            if acts && self.random.chance(20) {
                let all: Vec<usize> = (0..parameters.len()).collect();
                subtasks.push(pattern(name.as_str(), &all));
            }
            self.domain.methods.push(Method {
                name: name.clone(),
                parameters: scope,
                task: pattern(name.as_str(), &(0..parameters.len()).collect::<Vec<_>>()),
                precondition,
                subtasks,
            });
        }
    }

    fn is_operator(&self, pattern: &Pattern) -> bool {
        self.domain.operators.contains_key(&pattern.name)
    }

    /// An action, a way to somewhere, or a task that was made before: task lists do not grow for
    /// ever.
    fn subtask(&mut self, number: usize, scope: &[Parameter]) -> Option<Pattern> {
        let name = match self.random.below(10) {
            0..=4 => format!("o{}", self.random.below(4)),
            5 | 6 => String::from("go"),
            _ => format!("d{}", self.random.below(number.max(1))),
        };
        if name == format!("d{number}") {
            return None;
        }
        let name = Symbol::from(name);
        let operators = self.domain.operators.get(&name).map(|o| &o.parameters);
        let wanted = self.domain.tasks.get(&name).or(operators)?.clone();
        let mut args = Vec::new();
        for parameter in wanted {
            let fits = |given: &Symbol| self.domain.is_a(given, &parameter.kind);
            let variables = scope.iter().enumerate().filter(|(_, v)| fits(&v.kind));
            let objects = self.objects.iter().filter(|(_, given)| fits(given));
            let mut some: Vec<Term> = variables.map(|(v, _)| Term::Variable(v)).collect();
            if some.is_empty() {
                some = objects.map(|(o, _)| Term::Constant(o.clone())).collect();
            }
            args.push(self.random.pick(&some).clone());
        }
        Some(Pattern { name, args })
    }

    /// That a way costs at least what is said of its end, which it does if no move is cheaper.
    fn estimates(&mut self) {
        let go = &self.domain.operators["move"].cost;
        if !matches!(go, Number::Function(_)) {
            return;
        }
        self.model.tasks.insert(
            "go".into(),
            TaskModel {
                parameters: vec![parameter("x", "spot"), parameter("y", "spot")],
                given: vec![
                    fact(true, "at", &[1]),
                    fact(false, "at", &[0]),
                    Clause::Every(
                        vec![parameter("a", "spot"), parameter("b", "spot")],
                        vec![fact(false, "on", &[2, 3])],
                    ),
                ],
                estimate: Number::Function(pattern("toll", &[0])),
                establishes: vec![pattern("at", &[0])],
            },
        );
    }

    /// All atoms of a name with objects of these types.
    fn ground(&self, name: &Symbol, parameters: &[Parameter]) -> Vec<Atom> {
        let mut lists: Vec<Vec<Symbol>> = vec![Vec::new()];
        for parameter in parameters {
            let fits = |given: &Symbol| self.domain.is_a(given, &parameter.kind);
            let objects = self.objects.iter().filter(|(_, given)| fits(given));
            let objects: Vec<&Symbol> = objects.map(|(object, _)| object).collect();
            let longer = |list: &Vec<Symbol>| {
                let list = list.clone();
                objects
                    .iter()
                    .map(move |o| [&list[..], &[(*o).clone()]].concat())
                    .collect::<Vec<_>>()
            };
            lists = lists.iter().flat_map(longer).collect();
        }
        let atom = |args| Atom {
            name: name.clone(),
            args,
        };
        lists.into_iter().map(atom).collect()
    }

    fn finish(self) -> Scene {
        let (mut map, mut belief) = (Map::default(), Belief::default());
        let mut changing = Vec::new();
        let mut spots = Vec::new();
        for (name, parameters) in &self.domain.predicates.clone() {
            for fact in self.ground(name, parameters) {
                match name.as_str() {
                    "link" => {
                        if fact.args[0] != fact.args[1] && self.random.chance(60) {
                            map.facts.apply(&FactChange::Add(fact));
                        }
                        continue;
                    }
                    "at" => {
                        spots.push(fact.clone());
                        if self.one_place {
                            continue;
                        }
                    }
                    "on" => continue,
                    _ => {}
                }
                let percent = if name == "open" { 80 } else { 40 };
                if name != "at" && self.random.chance(percent) {
                    belief.apply(&FactChange::Add(fact.clone()));
                }
                changing.push(fact);
            }
        }
        belief.apply(&FactChange::Add(self.random.pick(&spots).clone()));
        let mut functions = Vec::new();
        for (name, parameters) in &self.domain.functions.clone() {
            for function in self.ground(name, parameters) {
                let value = self.random.between(0, 5) as f64;
                let change = FactChange::Set(function.clone(), value);
                match name == "toll" && self.random.chance(70) {
                    true => belief.apply(&change),
                    false => map.facts.apply(&change),
                };
                functions.push(function);
            }
        }
        let mut tasks = Vec::new();
        for (name, parameters) in &self.domain.tasks {
            tasks.extend(self.ground(name, parameters));
        }
        map.objects = self.objects;
        Scene {
            domain: Arc::new(self.domain),
            model: Arc::new(self.model),
            map: Arc::new(map),
            belief,
            changing,
            functions,
            tasks,
            spots,
        }
    }
}
