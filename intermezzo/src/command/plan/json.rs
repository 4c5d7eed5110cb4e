//! What came out, for programs.

use std::io::{self, Write};

use offline_planner::Solution;
use offline_planner::plan::NodeId;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// A plan as one object. It may have millions of steps: nothing of it is kept.
pub(super) fn plan(out: &mut impl Write, solution: &Solution, seconds: f64) -> io::Result<()> {
    serde_json::to_writer(&mut *out, &Plan(solution, seconds))?;
    out.write_all(b"\n")
}

/// That there is no plan, or none was found.
pub(super) fn no_plan(
    out: &mut impl Write,
    verdict: &str,
    why: &str,
    seconds: f64,
) -> io::Result<()> {
    let object = serde_json::json!({
        "verdict": verdict,
        "why": why,
        "seconds": seconds,
    });
    writeln!(out, "{object}")
}

struct Plan<'a>(&'a Solution, f64);

impl Serialize for Plan<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(solution, seconds) = self;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("verdict", "plan")?;
        map.serialize_entry("length", &solution.length())?;
        map.serialize_entry("cost", &super::cost(solution))?;
        map.serialize_entry("optimal", &solution.optimal)?;
        map.serialize_entry("seconds", seconds)?;
        map.serialize_entry("actions", &Actions(solution))?;
        map.serialize_entry("roots", &Roots(solution))?;
        map.serialize_entry("tasks", &Tasks(solution))?;
        map.end()
    }
}

struct Actions<'a>(&'a Solution);

impl Serialize for Actions<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let solution = self.0;
        let actions = solution.actions().iter().copied();
        serializer.collect_seq(actions.map(|id| Each(solution, id)))
    }
}

struct Roots<'a>(&'a Solution);

impl Serialize for Roots<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.roots().map(|id| id.0))
    }
}

/// Tasks before what they are decomposed into.
struct Tasks<'a>(&'a Solution);

impl Serialize for Tasks<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let solution = self.0;
        let mut open: Vec<NodeId> = solution.roots().collect();
        open.reverse();
        let tasks = std::iter::from_fn(|| {
            while let Some(id) = open.pop() {
                if solution.method_name(id).is_some() {
                    let first = open.len();
                    open.extend(solution.children(id));
                    open[first..].reverse();
                    return Some(id);
                }
            }
            None
        });
        let tasks: Vec<NodeId> = tasks.collect();
        serializer.collect_seq(tasks.into_iter().map(|id| Each(solution, id)))
    }
}

/// An action, or a task with its method.
struct Each<'a>(&'a Solution, NodeId);

impl Serialize for Each<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(solution, id) = *self;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("id", &id.0)?;
        map.serialize_entry("name", solution.name(id).as_str())?;
        map.serialize_entry("arguments", &Arguments(solution, id))?;
        if let Some(method) = solution.method_name(id) {
            map.serialize_entry("method", method.as_str())?;
            map.serialize_entry("subtasks", &Children(solution, id))?;
        }
        map.end()
    }
}

struct Arguments<'a>(&'a Solution, NodeId);

impl Serialize for Arguments<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(solution, id) = *self;
        let arguments = solution.arguments(id).iter();
        serializer.collect_seq(arguments.map(|object| solution.object(*object).as_str()))
    }
}

struct Children<'a>(&'a Solution, NodeId);

impl Serialize for Children<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.children(self.1).map(|id| id.0))
    }
}
