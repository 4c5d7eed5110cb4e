//! The way back from the ground problem to what the author wrote.

use super::formula::Arg;
use super::lifted::{Lifted, Reading, Source, What};
use super::model::{Model, NONE, Task};
use super::reach::Reached;
use super::space::UNKNOWN;
use crate::compile::{Compiled, MethodId, ObjectId};
use crate::plan::Choices;

/// What methods and actions were made of.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origin {
    links: Vec<LinkOrigin>,
    /// By made instance: its rule and where its values begin.
    made: Vec<(u32, u32)>,
    values: Vec<u32>,
}

#[derive(Clone, Debug)]
struct LinkOrigin {
    method: Option<MethodId>,
    first: bool,
    canonical: Vec<u16>,
    resolve: Vec<Arg>,
}

impl Origin {
    pub(super) fn new(lifted: &Lifted<'_>, reached: &mut Reached) -> Self {
        let links = lifted.rules.iter().zip(&lifted.readings);
        Self {
            links: links
                .map(|(rule, reading)| match &rule.what {
                    What::Link {
                        source,
                        first,
                        canonical,
                        ..
                    } => LinkOrigin {
                        method: match source {
                            Source::Method(method) => Some(*method),
                            Source::Variant => None,
                        },
                        first: *first,
                        canonical: canonical.clone(),
                        resolve: reading
                            .as_ref()
                            .map_or(Vec::new(), |Reading { resolve }| resolve.clone()),
                    },
                    What::Action { .. } => LinkOrigin {
                        method: None,
                        first: false,
                        canonical: Vec::new(),
                        resolve: Vec::new(),
                    },
                })
                .collect(),
            made: reached
                .made
                .iter()
                .map(|made| (made.rule, made.values as u32))
                .collect(),
            values: std::mem::take(&mut reached.values),
        }
    }

    /// About how much memory this takes.
    pub fn bytes(&self) -> usize {
        self.made.len() * 8 + self.values.len() * 4
    }
}

/// A method as it was chosen, its variables found bit by bit.
struct Entry {
    link: u32,
    values: Vec<u32>,
}

/// The plan as choices of the author's methods, given the ground methods in the order in which
/// the first task left is decomposed by them. `None` if they do not fit the model.
pub(crate) fn choices(compiled: &Compiled, model: &Model, methods: &[u32]) -> Option<Choices> {
    let origin = &model.origin;
    let mut entries: Vec<Entry> = Vec::new();
    let mut stack = vec![(model.top, NONE)];
    let mut next = methods.iter();
    while let Some((task, owner)) = stack.pop() {
        if let Task::Action(_) = model.tasks[task as usize] {
            continue;
        }
        let method = &model.methods[*next.next()? as usize];
        if method.task != task {
            return None;
        }
        let (rule, values) = *origin.made.get(method.origin as usize)?;
        let link = &origin.links[rule as usize];
        let mut entry = owner;
        if link.method.is_some() {
            if link.first {
                entry = entries.len() as u32;
                entries.push(Entry {
                    link: rule,
                    values: Vec::new(),
                });
            }
            let found = &mut entries.get_mut(entry as usize)?.values;
            for (place, canonical) in link.canonical.iter().enumerate() {
                let canonical = usize::from(*canonical);
                if found.len() <= canonical {
                    found.resize(canonical + 1, UNKNOWN);
                }
                found[canonical] = origin.values[values as usize + place];
            }
        }
        let subs = model.get(method.subs);
        stack.extend(subs.iter().rev().map(|sub| (*sub, entry)));
    }
    if next.next().is_some() {
        return None;
    }
    let mut choices = Choices::default();
    for entry in &entries {
        let link = &origin.links[entry.link as usize];
        let method = link.method?;
        let kinds = &compiled.method(method).kinds;
        let mut bindings = Vec::with_capacity(kinds.len());
        for place in 0..kinds.len() {
            let arg = *link.resolve.get(place)?;
            bindings.push(match arg {
                Arg::Object(object) => ObjectId(object),
                Arg::Var(var) => match entry.values.get(usize::from(var)) {
                    Some(value) if *value != UNKNOWN => ObjectId(*value),
                    _ => anything(compiled, method, link, arg)?,
                },
            });
        }
        choices.push(method, &bindings);
    }
    Some(choices)
}

/// An object for a variable on which nothing depends.
fn anything(
    compiled: &Compiled,
    method: MethodId,
    link: &LinkOrigin,
    arg: Arg,
) -> Option<ObjectId> {
    let kinds = &compiled.method(method).kinds;
    let mut same = link
        .resolve
        .iter()
        .zip(kinds)
        .filter(|(other, _)| **other == arg)
        .map(|(_, kind)| compiled.kind(*kind));
    let first = same.next()?;
    let others: Vec<_> = same.collect();
    let fits = |object: &&ObjectId| others.iter().all(|kind| kind.contains(**object));
    first.members.iter().find(fits).copied()
}
