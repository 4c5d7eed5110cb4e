//! Plans as text, in the format of the planning competition of 2020.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::fault::{Fault, Faults, Kind};
use crate::model::{Id, Model, TaskId};

/// The number of a node: its place among the lines of the plan.
pub(crate) type NodeId = usize;

/// An action or a decomposition.
#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) id: u64,
    pub(crate) task: TaskId,
    /// Where its arguments stand in [`Plan::arguments`].
    arguments: (u32, u32),
    /// For a decomposition its method's name, as the index of a list of methods.
    pub(crate) method: Option<u32>,
    /// Where its children stand in [`Plan::children`].
    children: (u32, u32),
}

/// A plan whose lines have been read one by one; how they hang together is not checked yet.
#[derive(Debug, Default)]
pub(crate) struct Plan<'m> {
    pub(crate) nodes: Vec<Node>,
    /// The nodes that are actions, in the order of the file.
    pub(crate) actions: Vec<NodeId>,
    arguments: Vec<Id>,
    /// First ids, later turned into numbers of nodes.
    pub(crate) children: Vec<u64>,
    /// The methods that are named, each with all that have that name.
    pub(crate) methods: Vec<&'m [usize]>,
    pub(crate) roots: Option<Vec<u64>>,
}

impl Plan<'_> {
    pub(crate) fn arguments(&self, node: NodeId) -> &[Id] {
        let (start, end) = self.nodes[node].arguments;
        &self.arguments[start as usize..end as usize]
    }

    pub(crate) fn children_range(&self, node: NodeId) -> Range<usize> {
        let (start, end) = self.nodes[node].children;
        start as usize..end as usize
    }

    pub(crate) fn call(&self, model: &Model, node: NodeId) -> String {
        model.call(self.nodes[node].task, self.arguments(node))
    }
}

/// The lines between the markers, numbered from one.
pub(crate) fn between_markers(text: &str) -> Result<Vec<(usize, &str)>, Fault> {
    let malformed = |what: &str| Fault::new(Kind::Malformed, what);
    let mut lines = Vec::new();
    let mut started = false;
    let mut ended = false;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        match line {
            "==>" if started => return Err(malformed("a second `==>`: only one plan at a time")),
            "==>" => started = true,
            "<==" => ended = started,
            _ if started && !ended && !line.is_empty() => lines.push((index + 1, line)),
            _ => (),
        }
        if line == "<==" && !started {
            return Err(malformed("`<==` without `==>`"));
        }
    }
    match (started, ended) {
        (false, _) => Err(malformed("no `==>`: there is no plan in this")),
        (true, false) => Err(malformed("no `<==`: the plan is not complete")),
        (true, true) => Ok(lines),
    }
}

/// Reads lines into nodes.
struct Reader<'m> {
    model: &'m Model,
    plan: Plan<'m>,
    method_numbers: FxHashMap<String, u32>,
    faults: Faults,
    lower: String,
}

/// Reads a plan, or says which of its lines make no sense.
pub(crate) fn read<'m>(text: &str, model: &'m Model) -> Result<Plan<'m>, Vec<Fault>> {
    let mut reader = Reader {
        model,
        plan: Plan::default(),
        method_numbers: FxHashMap::default(),
        faults: Faults::default(),
        lower: String::new(),
    };
    for (number, line) in between_markers(text).map_err(|fault| vec![fault])? {
        reader.line(number, line);
    }
    reader.faults.check()?;
    Ok(reader.plan)
}

impl<'m> Reader<'m> {
    fn line(&mut self, number: usize, line: &str) {
        let mut words = line.split_ascii_whitespace();
        let first = words.next().unwrap_or_default();
        if first.eq_ignore_ascii_case("root") {
            let roots = words.map(|word| self.id(number, word));
            let roots = roots.collect();
            if self.plan.roots.replace(roots).is_some() {
                self.malformed(number, "a second line of roots");
            }
            return;
        }
        let id = self.id(number, first);
        let Some(name) = words.next() else {
            return self.malformed(number, "an id, but no action or task");
        };
        lowered(&mut self.lower, name);
        let task = self.model.task_ids.get(self.lower.as_str()).copied();
        let start = self.plan.arguments.len() as u32;
        let mut unknown = Vec::new();
        let mut arrow = false;
        for word in words.by_ref() {
            if word == "->" {
                arrow = true;
                break;
            }
            lowered(&mut self.lower, word);
            match self.model.objects.find(&self.lower) {
                Some(object) => self.plan.arguments.push(object),
                None => unknown.push(word),
            }
        }
        let all_known = unknown.is_empty();
        for word in unknown {
            let what = format!("no object `{word}` in domain or problem");
            self.faults.push(Fault::at(Kind::UnknownName, id, what));
        }
        let Some(task) = task else {
            let kind = if arrow { "task" } else { "action" };
            let what = format!("no {kind} `{name}` in the domain");
            return self.faults.push(Fault::at(Kind::UnknownName, id, what));
        };
        let arguments = (start, self.plan.arguments.len() as u32);
        let children_start = self.plan.children.len() as u32;
        let method = if arrow {
            let Some(method) = words.next() else {
                return self.malformed(number, "`->` without a method");
            };
            let Some(method) = self.method(method) else {
                let what = format!("no method `{method}` in the domain");
                return self.faults.push(Fault::at(Kind::UnknownName, id, what));
            };
            for child in words {
                let child = self.id(number, child);
                self.plan.children.push(child);
            }
            Some(method)
        } else {
            self.plan.actions.push(self.plan.nodes.len());
            None
        };
        let primitive = self.model.tasks[task].action.is_some();
        if primitive == arrow {
            let what = if arrow {
                format!("`{name}` is an action, which no method decomposes")
            } else {
                format!("`{name}` is a task, which a method has to decompose")
            };
            self.faults.push(Fault::at(Kind::UnknownName, id, what));
        }
        self.plan.nodes.push(Node {
            id,
            task,
            arguments,
            method,
            children: (children_start, self.plan.children.len() as u32),
        });
        if all_known {
            self.check_arguments(self.plan.nodes.len() - 1);
        }
    }

    fn check_arguments(&mut self, node: NodeId) {
        let model = self.model;
        let id = self.plan.nodes[node].id;
        let task = &model.tasks[self.plan.nodes[node].task];
        let arguments = self.plan.arguments(node);
        let fault = if arguments.len() == task.sorts.len() {
            let mut pairs = arguments.iter().zip(&task.sorts);
            let wrong = pairs.find(|(object, sort)| !model.sorts[**sort].has(**object));
            wrong.map(|(object, sort)| {
                let object = model.objects.name(*object);
                let sort = &model.sorts[*sort].name;
                format!(
                    "`{object}` in `{}` is no {sort}",
                    self.plan.call(model, node)
                )
            })
        } else {
            let (wanted, found) = (task.sorts.len(), arguments.len());
            Some(format!(
                "`{}` takes {wanted} arguments, here it has {found}",
                task.name
            ))
        };
        if let Some(what) = fault {
            self.faults.push(Fault::at(Kind::WrongArguments, id, what));
        }
    }

    fn method(&mut self, name: &str) -> Option<u32> {
        lowered(&mut self.lower, name);
        if let Some(number) = self.method_numbers.get(self.lower.as_str()) {
            return Some(*number);
        }
        let methods = self.model.method_ids.get(self.lower.as_str())?;
        let number = self.plan.methods.len() as u32;
        self.plan.methods.push(methods);
        self.method_numbers.insert(self.lower.clone(), number);
        Some(number)
    }

    fn id(&mut self, number: usize, word: &str) -> u64 {
        word.parse().unwrap_or_else(|_| {
            self.malformed(number, &format!("`{word}` is no id"));
            0
        })
    }

    fn malformed(&mut self, number: usize, what: &str) {
        let what = format!("line {number}: {what}");
        self.faults.push(Fault::new(Kind::Malformed, what));
    }
}

fn lowered(into: &mut String, word: &str) {
    into.clear();
    into.push_str(word);
    into.make_ascii_lowercase();
}
