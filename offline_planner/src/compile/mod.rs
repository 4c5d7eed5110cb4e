//! A domain and a problem with numbers for names: what every search here works on.
//!
//! Variables stay variables (whoever wants ground actions makes them from this), but types are sets
//! of objects, names are places in lists, and what can never be used is gone. The tasks of the
//! problem are the subtasks of one artificial method of one artificial task; its parameters are
//! those of `:htn`, its precondition the constraints, and its last subtask an artificial action
//! without effects whose precondition is the goal.

mod changes;
mod condition;
mod cost;
mod ids;
mod kinds;
mod necessary;
mod prune;
mod read;

use agent_core::model::{Cost, Domain, Instance, Symbol};

pub use condition::{Change, Clause, Condition, FactPattern, Quantified, Term, each_fact, width};
pub use cost::CostRule;
pub use ids::{ActionId, KindId, MethodId, ObjectId, PredicateId, TaskId};
pub use kinds::{Kind, Kinds};
pub use read::Unfit;

/// A whole planning problem. See the module.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// Names of the objects, constants among them.
    pub objects: Vec<Symbol>,
    /// Sets of objects that variables range over.
    pub kinds: Kinds,
    /// What facts are about.
    pub predicates: Vec<Predicate>,
    /// What holds at first: for each predicate its tuples, one after another.
    pub init: Vec<Vec<ObjectId>>,
    /// What can be executed; [`Compiled::goal`] is among them.
    pub actions: Vec<Action>,
    /// What can be decomposed; [`Compiled::top`] is among them.
    pub tasks: Vec<Task>,
    /// How; in the order in which they are written.
    pub methods: Vec<Method>,
    /// The artificial task that stands for the whole problem; it has no arguments and, unless the
    /// problem was found impossible, one method.
    pub top: TaskId,
    /// The artificial action that asks for the goal; none if anything may hold in the end.
    pub goal: Option<ActionId>,
    /// The facts among the goals, and until when something can be done for them.
    pub goals: Vec<Goal>,
    /// Whether the domain says what actions cost. If not, each counts one.
    pub has_costs: bool,
}

/// A fact that must hold in the end, or must not.
#[derive(Clone, Debug)]
pub struct Goal {
    /// Whether it must hold.
    pub holds: bool,
    /// The fact; without variables.
    pub fact: FactPattern,
    /// The last task of the problem that can bring it about, by its place among the subtasks of
    /// the one method of [`Compiled::top`]. Once that task is done, it must be so and stay so.
    pub last_help: Option<usize>,
}

/// What facts are about.
#[derive(Clone, Debug)]
pub struct Predicate {
    /// Its name.
    pub name: Symbol,
    /// What its arguments can be: every fact that can ever hold has its arguments in these.
    pub kinds: Vec<KindId>,
    /// Whether some action can make a fact of it true.
    pub added: bool,
    /// Whether some action can make a fact of it false.
    pub removed: bool,
}

impl Predicate {
    /// Whether what holds at first holds for ever.
    pub fn is_static(&self) -> bool {
        !self.added && !self.removed
    }
}

/// Something that can be executed.
#[derive(Clone, Debug)]
pub struct Action {
    /// Its name.
    pub name: Symbol,
    /// What its parameters can be.
    pub kinds: Vec<KindId>,
    /// When it can be executed.
    pub precondition: Condition,
    /// What it brings about; all removals come before all additions.
    pub effect: Vec<Change>,
    /// What it costs.
    pub cost: CostRule,
}

/// Something that can be decomposed.
#[derive(Clone, Debug)]
pub struct Task {
    /// Its name.
    pub name: Symbol,
    /// What its parameters can be.
    pub kinds: Vec<KindId>,
    /// In the order in which they are written.
    pub methods: Vec<MethodId>,
    /// What must hold when it is begun, or it cannot be carried through whatever the method; in
    /// terms of its parameters.
    pub necessary: Condition,
}

/// One way to decompose a task.
#[derive(Clone, Debug)]
pub struct Method {
    /// Its name.
    pub name: Symbol,
    /// What it decomposes.
    pub task: TaskId,
    /// The task's arguments in terms of the method's variables; one may stand twice.
    pub head: Vec<Term>,
    /// What each of its variables can be. Narrowed: an object that the task or a subtask would
    /// refuse is not in it.
    pub kinds: Vec<KindId>,
    /// When it can be used.
    pub precondition: Condition,
    /// What else must hold when it is used, or it cannot be carried through: conditions of its
    /// subtasks that nothing before them can bring about. To look at them is never wrong, and
    /// never needed.
    pub necessary: Condition,
    /// What is to be done instead, in this order.
    pub subtasks: Vec<Subtask>,
}

/// An action or a task with terms for arguments.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Subtask {
    /// What.
    pub step: Step,
    /// With which.
    pub args: Vec<Term>,
}

/// An action or a task.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Hash)]
pub enum Step {
    /// To be executed.
    Action(ActionId),
    /// To be decomposed.
    Task(TaskId),
}

impl Compiled {
    /// Puts numbers for names.
    ///
    /// # Errors
    /// If domain and problem do not fit each other. Those that were read from text do.
    pub fn new(domain: &Domain, instance: &Instance) -> Result<Self, Unfit> {
        let mut compiled = read::read(domain, instance)?;
        prune::prune(&mut compiled);
        necessary::find(&mut compiled);
        Ok(compiled)
    }

    /// The set of objects of that number.
    pub fn kind(&self, id: KindId) -> &Kind {
        self.kinds.get(id)
    }

    /// The predicate of that number.
    pub fn predicate(&self, id: PredicateId) -> &Predicate {
        &self.predicates[id.index()]
    }

    /// The action of that number.
    pub fn action(&self, id: ActionId) -> &Action {
        &self.actions[id.index()]
    }

    /// The task of that number.
    pub fn task(&self, id: TaskId) -> &Task {
        &self.tasks[id.index()]
    }

    /// The method of that number.
    pub fn method(&self, id: MethodId) -> &Method {
        &self.methods[id.index()]
    }

    /// Whether `step` is no part of what the user wrote.
    pub fn is_artificial(&self, step: Step) -> bool {
        match step {
            Step::Action(action) => self.goal == Some(action),
            Step::Task(task) => self.top == task,
        }
    }

    /// What the action costs; one if the domain has no costs; nothing if it is artificial.
    pub fn cost(&self, action: ActionId, args: &[ObjectId]) -> Cost {
        if self.goal == Some(action) {
            Cost::ZERO
        } else if self.has_costs {
            self.action(action).cost.of(args)
        } else {
            Cost(1_000_000)
        }
    }

    /// What holds at first, as tuples of arguments.
    pub fn init_of(&self, predicate: PredicateId) -> impl Iterator<Item = &[ObjectId]> {
        let arity = self.predicate(predicate).kinds.len();
        let tuples = &self.init[predicate.index()];
        // A predicate without parameters that holds is written as one object that means nothing.
        tuples
            .chunks(arity.max(1))
            .map(move |tuple| &tuple[..arity])
    }
}
