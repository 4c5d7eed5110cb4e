//! Whether every name in an execution model is declared, and fits.

use super::super::fit::{
    Closeness, Misfit, Sort, misfits, no_constant, type_is_declared, undeclared_hint,
};
use super::DomainError;
use crate::model::{
    ActionModel, Clause, Domain, Effect, ExecutionModel, Number, Parameter, Pattern, Symbol,
    TaskModel, Term,
};

/// Checks all names of the model; whatever cannot be looked up is not looked at any further.
pub(super) fn check_names(domain: &Domain, model: &ExecutionModel, errors: &mut Vec<DomainError>) {
    let nothing: &[Parameter] = &[];
    for (name, action) in &model.actions {
        let mut place = Place::new(domain, name, nothing, errors);
        match domain.operators.get(name) {
            Some(operator) => {
                place.parameters = &operator.parameters;
                place.action(action);
            }
            None => place.undeclared(&format!("action.{name}"), Sort::Action, name),
        }
    }
    for (name, task) in &model.tasks {
        let mut place = Place::new(domain, name, &task.parameters, errors);
        match domain.tasks.get(name) {
            Some(_) => place.task(task),
            None => place.undeclared(&format!("task.{name}"), Sort::Task, name),
        }
    }
    for predicate in &model.observable {
        let mut place = Place::new(domain, predicate, nothing, errors);
        match domain.predicates.get(predicate) {
            Some(_) => place.observable(),
            None => place.undeclared("observable", Sort::Predicate, predicate),
        }
    }
    for (key, predicates) in [("shared", &model.shared), ("asked", &model.asked)] {
        for predicate in predicates {
            if !domain.predicates.contains_key(predicate) {
                Place::new(domain, predicate, nothing, errors).undeclared(
                    key,
                    Sort::Predicate,
                    predicate,
                );
            }
        }
    }
    for (index, arising) in model.arising.iter().enumerate() {
        let name = Symbol::from(format!("arising.{}", index + 1));
        let mut place = Place::new(domain, &name, &arising.parameters, errors);
        place.types(&format!("{name}.variables"), &arising.parameters);
        place.condition(&format!("{name}.when"), &arising.when);
        place.pattern(
            &format!("{name}.task"),
            Sort::Step,
            &arising.task,
            Closeness::Possible,
        );
    }
    for (index, projection) in model.projections.iter().enumerate() {
        let name = Symbol::from(format!("projection.{}", index + 1));
        let mut place = Place::new(domain, &name, &projection.parameters, errors);
        place.types(&format!("{name}.variables"), &projection.parameters);
        // `then` is in the words of the level above, which are not known here.
        place.condition(&format!("{name}.when"), &projection.when);
    }
}

/// One entry of the model: what it belongs to, and which variables it may use.
struct Place<'a> {
    domain: &'a Domain,
    subject: &'a Symbol,
    parameters: &'a [Parameter],
    errors: &'a mut Vec<DomainError>,
}

impl<'a> Place<'a> {
    fn new(
        domain: &'a Domain,
        subject: &'a Symbol,
        parameters: &'a [Parameter],
        errors: &'a mut Vec<DomainError>,
    ) -> Self {
        Self {
            domain,
            subject,
            parameters,
            errors,
        }
    }

    fn action(&mut self, action: &ActionModel) {
        let key = |rest: &str| format!("action.{}.{rest}", self.subject);
        let [duration, timeout, protected, goal_states] =
            ["duration_s", "timeout_s", "protected", "goal_states"].map(key);
        let suspension_keys = ["effect", "resume", "rollback", "reach"]
            .map(|rest| key(&format!("suspension.{rest}")));
        let cost_keys = ["cost.variables", "cost.given", "cost.cost"].map(key);
        if let Some(number) = &action.duration_s {
            self.number(&duration, number);
        }
        if let Some(number) = &action.timeout_s {
            self.number(&timeout, number);
        }
        self.condition(&protected, &action.protected);
        self.condition(&goal_states, &action.goal_states);
        if !action.goal_states.is_empty() && action.timeout_s.is_none() {
            self.errors.push(DomainError::NoTimeOut {
                key: goal_states,
                action: self.subject.clone(),
            });
        }
        for rule in &action.costs {
            let mut place = Place::new(self.domain, self.subject, &rule.parameters, self.errors);
            let [variables, given, cost] = &cost_keys;
            place.types(variables, &rule.parameters);
            place.condition(given, &rule.given);
            place.number(cost, &rule.cost);
        }
        let Some(suspension) = &action.suspension else {
            return;
        };
        let [effect, resume, rollback, reach] = &suspension_keys;
        self.effect(effect, &suspension.effect);
        self.step(resume, Sort::Action, &suspension.resume);
        if let Some(pattern) = &suspension.rollback {
            self.step(rollback, Sort::Action, pattern);
        }
        if let Some(pattern) = &suspension.reach {
            self.step(reach, Sort::Step, pattern);
        }
    }

    fn task(&mut self, task: &TaskModel) {
        let key = |rest: &str| format!("task.{}.{rest}", self.subject);
        let [variables, given, estimate, establishes] =
            ["variables", "given", "estimate", "establishes"].map(key);
        self.types(&variables, &task.parameters);
        self.condition(&given, &task.given);
        self.number(&estimate, &task.estimate);
        for pattern in &task.establishes {
            self.pattern(&establishes, Sort::Predicate, pattern, Closeness::Possible);
        }
    }

    /// An action that removes such a fact only forgets what it had seen; but one that brings it
    /// about would make waiting for others pointless.
    fn observable(&mut self) {
        for operator in self.domain.operators.values() {
            if operator
                .effect
                .add
                .iter()
                .any(|change| change.fact.name == *self.subject)
            {
                self.errors.push(DomainError::ObservableAdded {
                    key: "observable".to_owned(),
                    predicate: self.subject.clone(),
                    action: operator.name.clone(),
                });
            }
        }
    }

    fn types(&mut self, key: &str, parameters: &[Parameter]) {
        for parameter in parameters {
            if !type_is_declared(self.domain, &parameter.kind) {
                self.errors.push(DomainError::UndeclaredType {
                    key: key.to_owned(),
                    kind: parameter.kind.clone(),
                });
            }
        }
    }

    fn condition(&mut self, key: &str, condition: &[Clause]) {
        for literal in condition {
            match literal {
                Clause::Fact(_, pattern) => {
                    self.pattern(key, Sort::Predicate, pattern, Closeness::Possible);
                }
                Clause::Equal(_, left, right) => {
                    for term in [left, right] {
                        self.constant(key, term);
                    }
                }
                Clause::Any(choices) => {
                    for choice in choices {
                        self.condition(key, choice);
                    }
                }
                Clause::Every(variables, inner) | Clause::Exists(variables, inner) => {
                    self.types(key, variables);
                    self.condition(key, inner);
                }
            }
        }
    }

    fn effect(&mut self, key: &str, effect: &Effect) {
        for change in effect.remove.iter().chain(&effect.add) {
            self.types(key, &change.over);
            self.condition(key, &change.when);
            self.pattern(key, Sort::Predicate, &change.fact, Closeness::Possible);
        }
    }

    fn number(&mut self, key: &str, number: &Number) {
        match number {
            Number::Constant(_) => {}
            Number::Function(pattern) => {
                self.pattern(key, Sort::Function, pattern, Closeness::Possible);
            }
            Number::Sum(parts) | Number::Product(parts) => {
                for part in parts {
                    self.number(key, part);
                }
            }
            Number::Difference(left, right) | Number::Quotient(left, right) => {
                self.number(key, left);
                self.number(key, right);
            }
        }
    }

    /// An action or a task that the agent puts into plans, so that it must fit whatever the
    /// arguments are.
    fn step(&mut self, key: &str, sort: Sort, pattern: &Pattern) {
        if sort == Sort::Action && self.domain.tasks.contains_key(&pattern.name) {
            self.errors.push(DomainError::NotAnAction {
                key: key.to_owned(),
                action: self.subject.clone(),
                task: pattern.name.clone(),
            });
            return;
        }
        self.pattern(key, sort, pattern, Closeness::Always);
    }

    fn pattern(&mut self, key: &str, sort: Sort, pattern: &Pattern, closeness: Closeness) {
        let found = misfits(self.domain, sort, pattern, self.parameters, closeness);
        for (_, misfit) in found {
            self.misfit(key, misfit);
        }
    }

    fn constant(&mut self, key: &str, term: &Term) {
        if let Term::Constant(name) = term
            && !self.domain.constants.contains_key(name)
        {
            self.misfit(key, no_constant(self.domain, name, self.parameters));
        }
    }

    fn undeclared(&mut self, key: &str, sort: Sort, name: &Symbol) {
        let hint = undeclared_hint(self.domain, sort, name.as_str());
        let name = name.clone();
        self.misfit(key, Misfit::Undeclared { name, sort, hint });
    }

    fn misfit(&mut self, key: &str, misfit: Misfit) {
        self.errors.push(DomainError::Misfit {
            key: key.to_owned(),
            misfit,
        });
    }
}
