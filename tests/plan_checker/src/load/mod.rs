//! From the text of a domain and a problem to a [`Model`].

mod formula;
mod network;
mod types;

use rustc_hash::FxHashMap;

use crate::fault::{Fault, Kind};
use crate::model::{Action, Call, Cost, Formula, Id, Method, Model, Names, Task, TaskId, Variable};
use crate::sexpr::{Sexpr, read};
use formula::Scope;
use types::{Types, typed};

/// What is said of tasks and their order, in a method as in the problem.
const NETWORK: &[&str] = &[
    ":parameters",
    ":subtasks",
    ":tasks",
    ":ordered-subtasks",
    ":ordered-tasks",
    ":ordering",
    ":order",
    ":constraints",
];

/// More variables than anybody writes; the search for values recurs once for each.
const MOST_VARIABLES: usize = 500;

/// Reads both files.
pub(crate) fn load(domain: &str, problem: &str) -> Result<Model, Fault> {
    let domain = read(domain, "domain")?;
    let problem = read(problem, "problem")?;
    let mut loader = Loader::default();
    let of_domain = |fault| of_file("domain", fault);
    let of_problem = |fault| of_file("problem", fault);
    let domain = sections(&domain, "domain").map_err(of_domain)?;
    let problem = sections(&problem, "problem").map_err(of_problem)?;
    loader.types(domain).map_err(of_domain)?;
    loader.objects(domain, ":constants").map_err(of_domain)?;
    loader.objects(problem, ":objects").map_err(of_problem)?;
    loader.declarations(domain).map_err(of_domain)?;
    loader.definitions(domain).map_err(of_domain)?;
    loader.problem(problem).map_err(of_problem)
}

fn of_file(file: &str, fault: Fault) -> Fault {
    Fault::new(fault.kind, format!("{file}, {}", fault.what))
}

fn sections<'a>(whole: &'a Sexpr, what: &str) -> Result<&'a [Sexpr], Fault> {
    let items = whole.expect_list("a definition")?;
    match items {
        [define, name, sections @ ..]
            if define.word() == Some("define") && name.head() == Some(what) =>
        {
            Ok(sections)
        }
        _ => Err(whole.fault(format_args!("expected (define ({what} NAME) …)"))),
    }
}

/// The values of `:keyword value` pairs.
struct Parts<'a>(FxHashMap<&'a str, &'a Sexpr>);

impl<'a> Parts<'a> {
    fn new(items: &'a [Sexpr], known: &[&str]) -> Result<Self, Fault> {
        let mut parts = FxHashMap::default();
        for pair in items.chunks(2) {
            let [keyword, value] = pair else {
                return Err(pair[0].fault("a keyword without a value"));
            };
            let word = keyword.expect_word("a keyword")?;
            if !known.contains(&word) {
                return Err(keyword.fault(format_args!("`{word}` is not known here")));
            }
            if parts.insert(word, value).is_some() {
                return Err(keyword.fault(format_args!("a second `{word}`")));
            }
        }
        Ok(Self(parts))
    }

    fn get(&self, keyword: &str) -> Option<&'a Sexpr> {
        self.0.get(keyword).copied()
    }
}

#[derive(Default)]
struct Loader {
    types: Types,
    objects: Names,
    predicates: Names,
    predicate_arities: Vec<usize>,
    functions: Names,
    function_arities: Vec<usize>,
    tasks: Vec<Task>,
    task_ids: FxHashMap<String, TaskId>,
    methods: Vec<Method>,
    method_ids: FxHashMap<String, Vec<usize>>,
    costs: bool,
}

impl Loader {
    fn types(&mut self, sections: &[Sexpr]) -> Result<(), Fault> {
        for section in sections.iter().filter(|s| s.head() == Some(":types")) {
            for (name, parents) in typed(&section.expect_list("types")?[1..])? {
                self.types.declare(name, &parents);
            }
        }
        Ok(())
    }

    fn objects(&mut self, sections: &[Sexpr], keyword: &str) -> Result<(), Fault> {
        for section in sections.iter().filter(|s| s.head() == Some(keyword)) {
            for (name, types) in typed(&section.expect_list("objects")?[1..])? {
                let object = self.objects.intern(name);
                let known = self.types.give(object, &types);
                known.map_err(|unknown| section.fault(unknown_type(&unknown)))?;
            }
        }
        Ok(())
    }

    fn declarations(&mut self, sections: &[Sexpr]) -> Result<(), Fault> {
        for section in sections {
            let items = section.expect_list("a section")?;
            match section.head() {
                Some(":predicates") => {
                    for each in &items[1..] {
                        declare(each, &mut self.predicates, &mut self.predicate_arities)?;
                    }
                }
                Some(":functions") => {
                    for each in items[1..].iter().filter(|each| each.list().is_some()) {
                        declare(each, &mut self.functions, &mut self.function_arities)?;
                    }
                }
                Some(":task" | ":action") => self.declare_task(section, items)?,
                _ => (),
            }
        }
        Ok(())
    }

    fn declare_task(&mut self, section: &Sexpr, items: &[Sexpr]) -> Result<(), Fault> {
        let name = items.get(1).and_then(Sexpr::word);
        let name = name.ok_or_else(|| section.fault("a task without a name"))?;
        let parameters = items[2..]
            .chunks(2)
            .find(|pair| pair[0].word() == Some(":parameters"));
        let parameters = parameters.and_then(|pair| pair.get(1));
        let scope = Scope::of(&mut self.types, parameters)?;
        let sorts = scope.variables.iter().map(|v| v.sort).collect();
        if self.task_ids.contains_key(name) {
            return Err(section.fault(format_args!("a second task or action `{name}`")));
        }
        self.task_ids.insert(name.to_owned(), self.tasks.len());
        self.tasks.push(Task {
            name: name.to_owned(),
            sorts,
            action: None,
        });
        Ok(())
    }

    fn definitions(&mut self, sections: &[Sexpr]) -> Result<(), Fault> {
        for section in sections {
            let items = section.expect_list("a section")?;
            match section.head() {
                Some(":action") => self.action(items)?,
                Some(":method") => {
                    let method = self.method(section, items)?;
                    let index = self.methods.len();
                    let named = self.method_ids.entry(method.name.clone()).or_default();
                    named.push(index);
                    self.methods.push(method);
                }
                Some(
                    ":requirements" | ":types" | ":constants" | ":predicates" | ":functions"
                    | ":task",
                ) => (),
                _ => return Err(section.fault("a section that is not known here")),
            }
        }
        Ok(())
    }

    fn action(&mut self, items: &[Sexpr]) -> Result<(), Fault> {
        let known = [":parameters", ":precondition", ":effect"];
        let parts = Parts::new(&items[2..], &known)?;
        let mut scope = Scope::of(&mut self.types, parts.get(":parameters"))?;
        let condition = self.condition(parts.get(":precondition"), &mut scope)?;
        let mut action = Action {
            variables: Vec::new(),
            condition,
            changes: Vec::new(),
            costs: Vec::new(),
        };
        if let Some(effect) = parts.get(":effect") {
            let always = Formula::And(Vec::new());
            self.effect(effect, &mut scope, (&[], &always), &mut action)?;
        }
        self.costs |= !action.costs.is_empty();
        action.variables = scope.variables;
        let task = items[1].word().and_then(|name| self.task_ids.get(name));
        if let Some(task) = task {
            self.tasks[*task].action = Some(action);
        }
        Ok(())
    }

    fn method(&mut self, section: &Sexpr, items: &[Sexpr]) -> Result<Method, Fault> {
        let name = items.get(1).and_then(Sexpr::word);
        let name = name.ok_or_else(|| section.fault("a method without a name"))?;
        let known = [&[":task", ":precondition"], NETWORK].concat();
        let parts = Parts::new(&items[2..], &known)?;
        let scope = Scope::of(&mut self.types, parts.get(":parameters"))?;
        let head = parts.get(":task");
        let head = head.ok_or_else(|| section.fault("a method without a task"))?;
        let head = self.call(head, &scope)?;
        if self.tasks[head.task].action.is_some() {
            return Err(section.fault("a method for an action"));
        }
        self.network(name, Some(head), scope, &parts)
    }

    fn call(&self, call: &Sexpr, scope: &Scope) -> Result<Call, Fault> {
        let items = call.expect_list("a task")?;
        let name = call.head().ok_or_else(|| call.fault("expected a task"))?;
        let task = self.task_ids.get(name);
        let task = *task.ok_or_else(|| call.fault(format_args!("no task `{name}`")))?;
        let terms = self.terms(&items[1..], scope)?;
        let wanted = self.tasks[task].sorts.len();
        if terms.len() != wanted {
            return Err(call.fault(format_args!("`{name}` takes {wanted} arguments")));
        }
        Ok(Call { task, terms })
    }

    fn problem(mut self, sections: &[Sexpr]) -> Result<Model, Fault> {
        let mut root = None;
        let mut initially = Vec::new();
        let mut values = FxHashMap::default();
        let mut goal_scope = Scope::default();
        let mut goal = Formula::And(Vec::new());
        for section in sections {
            let items = section.expect_list("a section")?;
            match section.head() {
                Some(":domain" | ":objects" | ":requirements" | ":metric") => (),
                Some(":htn") => {
                    let parts = Parts::new(&items[1..], NETWORK)?;
                    let scope = Scope::of(&mut self.types, parts.get(":parameters"))?;
                    root = Some(self.network("the problem", None, scope, &parts)?);
                }
                Some(":init") => {
                    for fact in &items[1..] {
                        self.fact(fact, &mut initially, &mut values)?;
                    }
                }
                Some(":goal") => {
                    goal = self.condition(items.get(1), &mut goal_scope)?;
                }
                _ => return Err(section.fault("a section that is not known here")),
            }
        }
        let root = root.ok_or_else(|| {
            Fault::new(
                Kind::Unjudgeable,
                "no `:htn`: the problem has no tasks to do",
            )
        })?;
        Ok(Model {
            objects: self.objects,
            predicates: self.predicates,
            sorts: self.types.into_sorts(),
            tasks: self.tasks,
            task_ids: self.task_ids,
            methods: self.methods,
            method_ids: self.method_ids,
            root,
            initially,
            values,
            goal,
            goal_variables: goal_scope.variables,
            costs: self.costs,
        })
    }

    fn fact(
        &self,
        fact: &Sexpr,
        initially: &mut Vec<Vec<Id>>,
        values: &mut FxHashMap<Vec<Id>, f64>,
    ) -> Result<(), Fault> {
        let scope = Scope::default();
        let items = fact.expect_list("a fact")?;
        if let ("=", [_, function, value]) = (fact.head().unwrap_or_default(), items) {
            let value = value.word().and_then(|word| word.parse::<f64>().ok());
            let value = value.ok_or_else(|| fact.fault("expected a number"))?;
            let function = self.function(function, &scope)?;
            values.insert(ground(function.name, &function.terms), value);
        } else if fact.head() != Some("not") {
            let atom = self.atom(fact, &scope)?;
            initially.push(ground(atom.name, &atom.terms));
        }
        Ok(())
    }
}

fn ground(name: Id, terms: &[crate::model::Term]) -> Vec<Id> {
    let objects = terms.iter().filter_map(|term| match term {
        crate::model::Term::Object(object) => Some(*object),
        crate::model::Term::Variable(_) => None,
    });
    std::iter::once(name).chain(objects).collect()
}

fn declare(each: &Sexpr, names: &mut Names, arities: &mut Vec<usize>) -> Result<(), Fault> {
    let items = each.expect_list("a declaration")?;
    let name = each.head().ok_or_else(|| each.fault("expected a name"))?;
    let arity = typed(&items[1..])?.len();
    let id = names.intern(name) as usize;
    if id == arities.len() {
        arities.push(arity);
    } else if arities[id] != arity {
        return Err(each.fault(format_args!("`{name}` is declared in two ways")));
    }
    Ok(())
}

fn unknown_type(name: &str) -> String {
    format!("no type `{name}`")
}

/// The variables of a scope, with the limit on their number checked.
fn checked(variables: Vec<Variable>, at: &Sexpr) -> Result<Vec<Variable>, Fault> {
    if variables.len() > MOST_VARIABLES {
        return Err(at.fault("too many variables"));
    }
    Ok(variables)
}

/// A cost that is added.
fn number(word: &str) -> Option<Cost> {
    word.parse().ok().map(Cost::Number)
}
