//! Whether actions alone are a decomposition of the problem's tasks.
//!
//! The states between the actions are known, so this is parsing: which tasks can be done by the
//! actions from here to there? Answers are kept in tables, one for each task and place (as in
//! tabled logic programs), so that recursion in the methods, to the left or without any action,
//! comes to an end.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::Report;
use crate::fault::{Fault, Kind};
use crate::model::{Call, Formula, Id, Method, Model, TaskId};
use crate::plan::between_markers;
use crate::solve::{Solver, Values, World, value};
use crate::state::{State, cost};

/// Checks actions that stand one on a line.
pub(crate) fn check(model: &Model, text: &str) -> Result<Report, Fault> {
    let actions = read(model, text)?;
    let history = History::of(model, &actions)?;
    let methods = model.methods.iter().chain([&model.root]);
    if let Some(method) = methods.into_iter().find(|method| method.chain.is_none()) {
        let what = format!("`{}` is not totally ordered", method.name);
        return Err(Fault::new(Kind::Unjudgeable, what));
    }
    let mut search = Search {
        model,
        actions: &actions,
        history: &history,
        methods: vec![Vec::new(); model.tasks.len()],
        tables: Vec::new(),
        table_of: FxHashMap::default(),
        open: Vec::new(),
        seen: FxHashSet::default(),
        farthest: 0,
        done: false,
    };
    search.run()?;
    let costs = actions
        .iter()
        .map(|action| cost(model, &model.tasks[action.task], &action.arguments));
    Ok(Report {
        actions: actions.len(),
        decompositions: 0,
        cost: costs.sum(),
    })
}

struct Step {
    task: TaskId,
    arguments: Vec<Id>,
}

fn read(model: &Model, text: &str) -> Result<Vec<Step>, Fault> {
    let marked = text.lines().any(|line| line.trim() == "==>");
    let lines: Vec<(usize, &str)> = if marked {
        between_markers(text)?
    } else {
        let lines = text.lines().enumerate();
        lines
            .map(|(index, line)| (index + 1, line.trim()))
            .collect()
    };
    let mut steps = Vec::new();
    for (number, line) in lines {
        let line = line.split(';').next().unwrap_or_default();
        let line = line.replace(['(', ')'], " ").to_ascii_lowercase();
        let mut words: Vec<&str> = line.split_ascii_whitespace().collect();
        if words.contains(&"->") || words.first() == Some(&"root") {
            continue;
        }
        if words
            .first()
            .is_some_and(|word| word.parse::<u64>().is_ok())
        {
            words.remove(0);
        }
        let [name, arguments @ ..] = words.as_slice() else {
            continue;
        };
        let unknown = |what: &str, name: &str| {
            Fault::new(
                Kind::UnknownName,
                format!("line {number}: no {what} `{name}`"),
            )
        };
        let task = model.task_ids.get(*name).copied();
        let task = task.filter(|task| model.tasks[*task].action.is_some());
        let task = task.ok_or_else(|| unknown("action", name))?;
        let arguments: Vec<Id> = (arguments.iter())
            .map(|word| {
                model
                    .objects
                    .find(word)
                    .ok_or_else(|| unknown("object", word))
            })
            .collect::<Result<_, _>>()?;
        if !of_sorts(model, task, &arguments) {
            let what = format!("line {number}: wrong arguments of `{name}`");
            return Err(Fault::new(Kind::WrongArguments, what));
        }
        steps.push(Step { task, arguments });
    }
    Ok(steps)
}

fn of_sorts(model: &Model, task: TaskId, arguments: &[Id]) -> bool {
    let sorts = &model.tasks[task].sorts;
    let mut pairs = arguments.iter().zip(sorts);
    arguments.len() == sorts.len() && pairs.all(|(object, sort)| model.sorts[*sort].has(*object))
}

/// The states before each action and after the last.
struct History {
    /// From when on a fact is true or not, oldest first.
    changes: FxHashMap<Box<[Id]>, Vec<(usize, bool)>>,
    /// All facts that are ever true, by predicate.
    facts: Vec<Vec<Box<[Id]>>>,
}

impl History {
    /// Does the actions one after the other, and looks whether that leads to the goal.
    fn of(model: &Model, actions: &[Step]) -> Result<Self, Fault> {
        let mut state = State::initial(model);
        let mut history = Self {
            changes: FxHashMap::default(),
            facts: vec![Vec::new(); model.predicates.len()],
        };
        for fact in &model.initially {
            history.note(fact, 0, true);
        }
        for (now, action) in actions.iter().enumerate() {
            let task = &model.tasks[action.task];
            let changes = state.changes(model, task, &action.arguments);
            let changes = changes.map_err(|part| {
                let call = model.call(action.task, &action.arguments);
                let number = now + 1;
                let what = format!("action {number}: {part} of {call} does not hold here");
                Fault::new(Kind::Precondition, what)
            })?;
            for (fact, truth) in changes {
                if state.set(&fact, truth) {
                    history.note(&fact, now + 1, truth);
                }
            }
        }
        let solver = Solver {
            model,
            world: &state,
            variables: &model.goal_variables,
        };
        if solver.holds(&model.goal, &mut vec![None; model.goal_variables.len()]) {
            Ok(history)
        } else {
            Err(Fault::new(Kind::Goal, "at the end, the goal does not hold"))
        }
    }

    fn note(&mut self, fact: &[Id], from: usize, truth: bool) {
        if let Some(changes) = self.changes.get_mut(fact) {
            changes.push((from, truth));
        } else {
            self.facts[fact[0] as usize].push(fact.into());
            self.changes.insert(fact.into(), vec![(from, truth)]);
        }
    }
}

struct At<'a> {
    history: &'a History,
    now: usize,
}

impl World for At<'_> {
    fn holds(&self, fact: &[Id]) -> bool {
        let Some(changes) = self.history.changes.get(fact) else {
            return false;
        };
        let until_now = changes.partition_point(|(from, _)| *from <= self.now);
        until_now > 0 && changes[until_now - 1].1
    }

    fn candidates(&self, predicate: Id) -> &[Box<[Id]>] {
        &self.history.facts[predicate as usize]
    }
}

/// A question: where can this task end that begins here?
#[derive(Clone, Eq, Hash, PartialEq)]
struct Question {
    task: TaskId,
    arguments: Vec<Option<Id>>,
    start: usize,
}

#[derive(Default)]
struct Table {
    answers: Vec<(Vec<Id>, usize)>,
    known: FxHashSet<(Vec<Id>, usize)>,
    asked_by: Vec<Item>,
}

/// A method of which some subtasks are done.
#[derive(Clone, Eq, Hash, PartialEq)]
struct Item {
    /// `None` for the problem's own tasks.
    method: Option<usize>,
    /// Whose question it helps to answer.
    table: usize,
    values: Values,
    done: usize,
    now: usize,
}

struct Search<'a> {
    model: &'a Model,
    actions: &'a [Step],
    history: &'a History,
    methods: Vec<Vec<usize>>,
    tables: Vec<Table>,
    table_of: FxHashMap<Question, usize>,
    open: Vec<Item>,
    seen: FxHashSet<Item>,
    farthest: usize,
    done: bool,
}

impl<'a> Search<'a> {
    fn run(&mut self) -> Result<(), Fault> {
        for (index, method) in self.model.methods.iter().enumerate() {
            if let Some(head) = &method.head {
                self.methods[head.task].push(index);
            }
        }
        self.start(None, usize::MAX, &[], 0);
        while let Some(item) = self.open.pop() {
            self.farthest = self.farthest.max(item.now);
            self.advance(&item);
            if self.done {
                return Ok(());
            }
        }
        let what = match self.actions.get(self.farthest) {
            Some(action) => {
                let call = self.model.call(action.task, &action.arguments);
                let number = self.farthest + 1;
                format!("no decomposition of the tasks goes on with action {number}, {call}")
            }
            None => "no decomposition of the tasks ends with these actions".to_owned(),
        };
        Err(Fault::new(Kind::NotARefinement, what))
    }

    fn method(&self, method: Option<usize>) -> &'a Method {
        match method {
            Some(method) => &self.model.methods[method],
            None => &self.model.root,
        }
    }

    fn solver<'s>(&self, method: &'s Method, world: &'s At<'s>) -> Solver<'s, At<'s>>
    where
        'a: 's,
    {
        Solver {
            model: self.model,
            world,
            variables: &method.variables,
        }
    }

    fn push(&mut self, item: Item) {
        if self.seen.insert(item.clone()) {
            self.open.push(item);
        }
    }

    /// Begins a method for arguments that may be open.
    fn start(&mut self, index: Option<usize>, table: usize, wanted: &[Option<Id>], now: usize) {
        let method = self.method(index);
        let world = At {
            history: self.history,
            now,
        };
        let solver = self.solver(method, &world);
        let mut values = vec![None; method.variables.len()];
        if let Some(head) = &method.head {
            for (term, object) in head.terms.iter().zip(wanted) {
                let Some(object) = object else { continue };
                let mut set = Vec::new();
                if !solver.unify(&[*term], &[*object], &mut values, &mut set) {
                    return;
                }
            }
        }
        let mut begun = Vec::new();
        let asked = free(&method.condition);
        solver.solutions(&method.condition, &asked, &mut values, &mut |values| {
            begun.push(values.clone());
            false
        });
        for values in begun {
            self.push(Item {
                method: index,
                table,
                values,
                done: 0,
                now,
            });
        }
    }

    fn advance(&mut self, item: &Item) {
        let method = self.method(item.method);
        let chain = method.chain.as_deref().unwrap_or_default();
        let Some(next) = chain.get(item.done) else {
            return self.finish(method, item);
        };
        let call = &method.subtasks[*next];
        if self.model.tasks[call.task].action.is_some() {
            if let Some(action) = self.actions.get(item.now)
                && action.task == call.task
            {
                self.resume(item, call, &action.arguments, item.now + 1);
            }
            return;
        }
        let arguments = call.terms.iter().map(|term| value(term, &item.values));
        let question = Question {
            task: call.task,
            arguments: arguments.collect(),
            start: item.now,
        };
        let table = match self.table_of.get(&question) {
            Some(table) => *table,
            None => self.ask(question),
        };
        self.tables[table].asked_by.push(item.clone());
        for (arguments, end) in self.tables[table].answers.clone() {
            self.resume(item, call, &arguments, end);
        }
    }

    fn ask(&mut self, question: Question) -> usize {
        let table = self.tables.len();
        self.tables.push(Table::default());
        for method in self.methods[question.task].clone() {
            self.start(Some(method), table, &question.arguments, question.start);
        }
        self.table_of.insert(question, table);
        table
    }

    /// Goes on with a method of which one more subtask is done.
    fn resume(&mut self, item: &Item, call: &Call, arguments: &[Id], end: usize) {
        let method = self.method(item.method);
        let world = At {
            history: self.history,
            now: end,
        };
        let mut values = item.values.clone();
        let solver = self.solver(method, &world);
        let fits = solver.unify(&call.terms, arguments, &mut values, &mut Vec::new());
        if fits && of_sorts(self.model, call.task, arguments) {
            self.push(Item {
                values,
                done: item.done + 1,
                now: end,
                ..item.clone()
            });
        }
    }

    /// All subtasks are done: an answer, for all values that are still open.
    fn finish(&mut self, method: &Method, item: &Item) {
        let world = At {
            history: self.history,
            now: item.now,
        };
        let anything = Formula::And(Vec::new());
        let all: Vec<usize> = (0..method.parameters).collect();
        let mut values = item.values.clone();
        let mut answers = Vec::new();
        let solver = self.solver(method, &world);
        solver.solutions(&anything, &all, &mut values, &mut |values| {
            let terms = method.head.iter().flat_map(|head| &head.terms);
            answers.push(terms.filter_map(|term| value(term, values)).collect());
            false
        });
        if item.method.is_none() {
            self.done = !answers.is_empty() && item.now == self.actions.len();
            return;
        }
        for arguments in answers {
            self.answer(item.table, arguments, item.now);
        }
    }

    fn answer(&mut self, table: usize, arguments: Vec<Id>, end: usize) {
        let answer = (arguments, end);
        if !self.tables[table].known.insert(answer.clone()) {
            return;
        }
        for asker in self.tables[table].asked_by.clone() {
            let method = self.method(asker.method);
            let chain = method.chain.as_deref().unwrap_or_default();
            let call = &method.subtasks[chain[asker.done]];
            self.resume(&asker, call, &answer.0, end);
        }
        self.tables[table].answers.push(answer);
    }
}

/// The variables that a condition speaks of.
fn free(condition: &Formula) -> Vec<usize> {
    crate::model::Quantified::new(Vec::new(), condition.clone()).free
}
