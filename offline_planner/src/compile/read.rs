//! From names to numbers.

use std::sync::Arc;

use agent_core::model::{self, Domain, Instance, Number, Parameter, Pattern, Symbol};
use rustc_hash::FxHashMap;

use super::cost::Values;
use super::{
    Action, ActionId, Change, Clause, Compiled, Condition, CostRule, FactPattern, KindId, Kinds,
    Method, MethodId, ObjectId, Predicate, PredicateId, Quantified, Step, Subtask, Task, TaskId,
    Term, each_fact,
};

/// Domain and problem do not fit each other.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// A name is used that neither declares.
    #[error("`{0}` is used but not declared")]
    Unknown(Symbol),
    /// A name is used with more or fewer arguments than it was declared with.
    #[error("`{0}` is used with a number of arguments that it was not declared with")]
    Arity(Symbol),
    /// A variable is used outside of what declares it.
    #[error("`{0}` is used with a variable that nothing declares")]
    Variable(Symbol),
}

/// Names of the artificial parts, which nobody sees unless something goes wrong; with blanks, so
/// that they are nobody else's.
const TOP: &str = "the problem";
const GOAL: &str = "the goal";

pub(super) fn read(domain: &Domain, instance: &Instance) -> Result<Compiled, Unfit> {
    Reader::new(domain, instance).read()
}

struct Reader<'a> {
    domain: &'a Domain,
    instance: &'a Instance,
    objects: Vec<Symbol>,
    object_ids: FxHashMap<Symbol, ObjectId>,
    kinds: Kinds,
    kind_ids: FxHashMap<Symbol, KindId>,
    predicate_ids: FxHashMap<Symbol, PredicateId>,
    steps: FxHashMap<Symbol, Step>,
}

impl<'a> Reader<'a> {
    fn new(domain: &'a Domain, instance: &'a Instance) -> Self {
        let mut objects: Vec<Symbol> = Vec::new();
        let mut object_ids = FxHashMap::default();
        for name in domain.constants.keys().chain(instance.objects.keys()) {
            object_ids.entry(name.clone()).or_insert_with(|| {
                objects.push(name.clone());
                ObjectId::new(objects.len() - 1)
            });
        }
        let mut steps = FxHashMap::default();
        for (index, name) in domain.tasks.keys().enumerate() {
            steps.insert(name.clone(), Step::Task(TaskId::new(index)));
        }
        for (index, name) in domain.operators.keys().enumerate() {
            steps.insert(name.clone(), Step::Action(ActionId::new(index)));
        }
        let names = domain.predicates.keys().enumerate();
        Self {
            domain,
            instance,
            objects,
            object_ids,
            kinds: Kinds::default(),
            kind_ids: FxHashMap::default(),
            predicate_ids: names
                .map(|(index, name)| (name.clone(), PredicateId::new(index)))
                .collect(),
            steps,
        }
    }

    fn read(mut self) -> Result<Compiled, Unfit> {
        let mut predicates = Vec::new();
        for (name, parameters) in &self.domain.predicates {
            predicates.push(Predicate {
                name: name.clone(),
                kinds: self.kinds_of(parameters),
                added: false,
                removed: false,
            });
        }
        let mut tasks = Vec::new();
        for (name, parameters) in &self.domain.tasks {
            tasks.push(Task {
                name: name.clone(),
                kinds: self.kinds_of(parameters),
                methods: Vec::new(),
                necessary: Condition::new(),
            });
        }
        let has_costs = self
            .domain
            .operators
            .values()
            .any(|operator| operator.cost != Number::Constant(0.0));
        let values = Arc::new(self.values());
        let mut actions = Vec::new();
        for (name, operator) in &self.domain.operators {
            let scope = operator.parameters.len();
            let effect = self.effect(name, &operator.effect, scope)?;
            actions.push(Action {
                name: name.clone(),
                kinds: self.kinds_of(&operator.parameters),
                precondition: self.condition(name, &operator.precondition, scope)?,
                effect,
                cost: CostRule::new(&operator.cost, &values, &|name| {
                    self.object_ids.get(name).copied()
                }),
            });
        }
        let mut methods = Vec::new();
        for method in &self.domain.methods {
            let scope = method.parameters.len();
            let Some(Step::Task(task)) = self.steps.get(&method.task.name).copied() else {
                return Err(Unfit::Unknown(method.task.name.clone()));
            };
            methods.push(Method {
                name: method.name.clone(),
                task,
                head: self.terms(&method.task, scope)?,
                kinds: self.kinds_of(&method.parameters),
                precondition: self.condition(&method.name, &method.precondition, scope)?,
                necessary: Condition::new(),
                subtasks: self.subtasks(&method.subtasks, scope)?,
            });
        }
        let top = TaskId::new(tasks.len());
        let goal = self.whole_problem(&mut tasks, &mut methods, &mut actions)?;
        for (index, method) in methods.iter().enumerate() {
            tasks[method.task.index()]
                .methods
                .push(MethodId::new(index));
        }
        let init = self.init(&mut predicates)?;
        let mut compiled = Compiled {
            objects: self.objects,
            kinds: self.kinds,
            predicates,
            init,
            actions,
            tasks,
            methods,
            top,
            goal,
            goals: Vec::new(),
            has_costs,
        };
        compiled.fit()?;
        compiled.widen();
        Ok(compiled)
    }

    /// The artificial task, its method and the artificial action.
    fn whole_problem(
        &mut self,
        tasks: &mut Vec<Task>,
        methods: &mut Vec<Method>,
        actions: &mut Vec<Action>,
    ) -> Result<Option<ActionId>, Unfit> {
        let (name, instance) = (Symbol::from(TOP), self.instance);
        let scope = instance.parameters.len();
        let mut subtasks = self.subtasks(&instance.tasks, scope)?;
        let goal = if instance.goal.is_empty() {
            None
        } else {
            let goal = ActionId::new(actions.len());
            actions.push(Action {
                name: Symbol::from(GOAL),
                kinds: Vec::new(),
                precondition: self.condition(&Symbol::from(GOAL), &instance.goal, 0)?,
                effect: Vec::new(),
                cost: CostRule::new(&Number::Constant(0.0), &Arc::default(), &|_| None),
            });
            subtasks.push(Subtask {
                step: Step::Action(goal),
                args: Vec::new(),
            });
            Some(goal)
        };
        let kinds = self.kinds_of(&instance.parameters);
        methods.push(Method {
            name: name.clone(),
            task: TaskId::new(tasks.len()),
            head: Vec::new(),
            kinds,
            precondition: self.condition(&name, &instance.constraints, scope)?,
            necessary: Condition::new(),
            subtasks,
        });
        tasks.push(Task {
            name,
            kinds: Vec::new(),
            methods: Vec::new(),
            necessary: Condition::new(),
        });
        Ok(goal)
    }

    fn kinds_of(&mut self, parameters: &[Parameter]) -> Vec<KindId> {
        parameters
            .iter()
            .map(|parameter| self.kind(&parameter.kind))
            .collect()
    }

    fn kind(&mut self, name: &Symbol) -> KindId {
        if let Some(id) = self.kind_ids.get(name) {
            return *id;
        }
        // A name may be both a constant and an object of the problem, with either type.
        let mut members = Vec::new();
        for declared in [&self.domain.constants, &self.instance.objects] {
            for (object, kind) in declared {
                if self.domain.is_a(kind, name) {
                    members.push(self.object_ids[object]);
                }
            }
        }
        let id = self.kinds.of(members);
        self.kind_ids.insert(name.clone(), id);
        id
    }

    fn object(&self, name: &Symbol) -> Result<ObjectId, Unfit> {
        let known = self.object_ids.get(name).copied();
        known.ok_or_else(|| Unfit::Unknown(name.clone()))
    }

    fn terms(&self, pattern: &Pattern, scope: usize) -> Result<Vec<Term>, Unfit> {
        let terms = pattern.args.iter();
        terms
            .map(|term| self.term(&pattern.name, term, scope))
            .collect()
    }

    fn term(&self, place: &Symbol, term: &model::Term, scope: usize) -> Result<Term, Unfit> {
        match term {
            model::Term::Variable(index) if *index < scope => Ok(Term::Variable(*index)),
            model::Term::Variable(_) => Err(Unfit::Variable(place.clone())),
            model::Term::Constant(name) => Ok(Term::Object(self.object(name)?)),
        }
    }

    fn fact(&self, pattern: &Pattern, scope: usize) -> Result<FactPattern, Unfit> {
        let predicate = self.predicate_ids.get(&pattern.name);
        Ok(FactPattern {
            predicate: *predicate.ok_or_else(|| Unfit::Unknown(pattern.name.clone()))?,
            args: self.terms(pattern, scope)?,
        })
    }

    // Recursive, as what it reads is: whoever made the condition bounded how deep it is.
    fn condition(
        &mut self,
        place: &Symbol,
        condition: &[model::Clause],
        scope: usize,
    ) -> Result<Condition, Unfit> {
        let mut clauses = Vec::new();
        for clause in condition {
            clauses.push(match clause {
                model::Clause::Fact(positive, pattern) => {
                    Clause::Fact(*positive, self.fact(pattern, scope)?)
                }
                model::Clause::Equal(positive, one, other) => Clause::Equal(
                    *positive,
                    self.term(place, one, scope)?,
                    self.term(place, other, scope)?,
                ),
                model::Clause::Any(choices) => {
                    let choices = choices.iter();
                    Clause::Any(
                        choices
                            .map(|choice| self.condition(place, choice, scope))
                            .collect::<Result<_, _>>()?,
                    )
                }
                model::Clause::Every(parameters, inner) => {
                    Clause::Every(self.quantified(place, parameters, inner, scope)?)
                }
                model::Clause::Exists(parameters, inner) => {
                    Clause::Exists(self.quantified(place, parameters, inner, scope)?)
                }
            });
        }
        Ok(clauses)
    }

    fn quantified(
        &mut self,
        place: &Symbol,
        parameters: &[Parameter],
        inner: &[model::Clause],
        scope: usize,
    ) -> Result<Quantified, Unfit> {
        Ok(Quantified {
            first: scope,
            kinds: self.kinds_of(parameters),
            inner: self.condition(place, inner, scope + parameters.len())?,
        })
    }

    fn effect(
        &mut self,
        place: &Symbol,
        effect: &model::Effect,
        scope: usize,
    ) -> Result<Vec<Change>, Unfit> {
        let mut changes = Vec::new();
        for (adds, list) in [(false, &effect.remove), (true, &effect.add)] {
            for change in list {
                let inner = scope + change.over.len();
                changes.push(Change {
                    adds,
                    over: self.kinds_of(&change.over),
                    when: self.condition(place, &change.when, inner)?,
                    fact: self.fact(&change.fact, inner)?,
                });
            }
        }
        Ok(changes)
    }

    fn subtasks(&self, patterns: &[Pattern], scope: usize) -> Result<Vec<Subtask>, Unfit> {
        let subtask = |pattern: &Pattern| {
            let step = self.steps.get(&pattern.name);
            Ok(Subtask {
                step: *step.ok_or_else(|| Unfit::Unknown(pattern.name.clone()))?,
                args: self.terms(pattern, scope)?,
            })
        };
        patterns.iter().map(subtask).collect()
    }

    /// What holds at first. A fact whose arguments are not of the declared types widens what the
    /// predicate can be about.
    fn init(&mut self, predicates: &mut [Predicate]) -> Result<Vec<Vec<ObjectId>>, Unfit> {
        let mut init = vec![Vec::new(); predicates.len()];
        for fact in self.instance.init.facts() {
            let unknown = || Unfit::Unknown(fact.name.clone());
            let id = *self.predicate_ids.get(&fact.name).ok_or_else(unknown)?;
            let predicate = &mut predicates[id.index()];
            if predicate.kinds.len() != fact.args.len() {
                return Err(Unfit::Arity(fact.name.clone()));
            }
            for (place, name) in fact.args.iter().enumerate() {
                let object = *self
                    .object_ids
                    .get(name)
                    .ok_or_else(|| Unfit::Unknown(name.clone()))?;
                let kind = self.kinds.get(predicate.kinds[place]);
                if !kind.contains(object) {
                    let mut members = kind.members.clone();
                    members.push(object);
                    predicate.kinds[place] = self.kinds.of(members);
                }
                init[id.index()].push(object);
            }
            if fact.args.is_empty() {
                init[id.index()].push(ObjectId(0));
            }
        }
        Ok(init)
    }

    fn values(&self) -> Values {
        let values = self.instance.init.values();
        values
            .filter_map(|(function, value)| {
                let args = function
                    .args
                    .iter()
                    .map(|name| self.object_ids.get(name).copied());
                let args = args.collect::<Option<Vec<_>>>()?;
                Some(((function.name.clone(), args), value))
            })
            .collect()
    }
}

impl Compiled {
    /// Numbers of arguments, and what can change.
    fn fit(&mut self) -> Result<(), Unfit> {
        let (mut wrong, arities) = (None, &self.predicates);
        let mut fits = |fact: &FactPattern| {
            let predicate = &arities[fact.predicate.index()];
            if predicate.kinds.len() != fact.args.len() {
                wrong.get_or_insert(Unfit::Arity(predicate.name.clone()));
            }
        };
        let of_actions = self.actions.iter().map(|action| &action.precondition);
        let of_methods = self.methods.iter().map(|method| &method.precondition);
        for condition in of_actions.chain(of_methods) {
            each_fact(condition, &mut |_, fact| fits(fact));
        }
        for change in self.actions.iter().flat_map(|action| &action.effect) {
            each_fact(&change.when, &mut |_, fact| fits(fact));
            fits(&change.fact);
        }
        if let Some(wrong) = wrong {
            return Err(wrong);
        }
        for method in &self.methods {
            let task = self.task(method.task);
            if method.head.len() != task.kinds.len() {
                return Err(Unfit::Arity(task.name.clone()));
            }
            for subtask in &method.subtasks {
                let (name, kinds) = match subtask.step {
                    Step::Action(id) => (&self.action(id).name, &self.action(id).kinds),
                    Step::Task(id) => (&self.task(id).name, &self.task(id).kinds),
                };
                if subtask.args.len() != kinds.len() {
                    return Err(Unfit::Arity(name.clone()));
                }
            }
        }
        Ok(())
    }

    /// What an action can add is within what its predicate is about, whatever was declared.
    fn widen(&mut self) {
        for action in &self.actions {
            for change in action.effect.iter().filter(|change| change.adds) {
                for (place, term) in change.fact.args.iter().enumerate() {
                    let wanted = match term {
                        Term::Object(object) => vec![*object],
                        Term::Variable(variable) => {
                            let kinds = action.kinds.iter().chain(&change.over);
                            let kind = kinds.copied().nth(*variable);
                            kind.map_or(Vec::new(), |kind| self.kinds.get(kind).members.clone())
                        }
                    };
                    let predicate = &mut self.predicates[change.fact.predicate.index()];
                    let kind = self.kinds.get(predicate.kinds[place]);
                    if !wanted.iter().all(|object| kind.contains(*object)) {
                        let members = [&kind.members[..], &wanted].concat();
                        predicate.kinds[place] = self.kinds.of(members);
                    }
                }
            }
        }
    }
}
