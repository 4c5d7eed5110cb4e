//! The hierarchy of types, and which objects belong where.

use rustc_hash::FxHashMap;

use crate::fault::Fault;
use crate::model::{Id, Names, Sort, SortId};
use crate::sexpr::Sexpr;

/// Splits `a b - t c - (either u v) d` into names with their types.
pub(super) fn typed(items: &[Sexpr]) -> Result<Vec<(&str, Vec<&str>)>, Fault> {
    let mut found: Vec<(&str, Vec<&str>)> = Vec::new();
    let mut untyped = 0;
    let mut items = items.iter();
    while let Some(item) = items.next() {
        let word = item.expect_word("a name")?;
        if word != "-" {
            found.push((word, Vec::new()));
            continue;
        }
        let kind = items
            .next()
            .ok_or_else(|| item.fault("`-` without a type"))?;
        let kinds = match kind {
            Sexpr::Word(word, _) => vec![word.as_str()],
            Sexpr::List(items, _) if kind.head() == Some("either") => items[1..]
                .iter()
                .map(|each| each.expect_word("a type"))
                .collect::<Result<_, _>>()?,
            Sexpr::List(..) => return Err(kind.fault("expected a type")),
        };
        for (_, types) in &mut found[untyped..] {
            types.clone_from(&kinds);
        }
        untyped = found.len();
    }
    for (_, types) in &mut found[untyped..] {
        types.push("object");
    }
    Ok(found)
}

#[derive(Default)]
pub(super) struct Types {
    names: Names,
    parents: Vec<Vec<Id>>,
    /// For each object the types that it was declared with.
    of_objects: Vec<Vec<Id>>,
    sorts: Vec<Sort>,
    sort_ids: FxHashMap<Vec<Id>, SortId>,
}

impl Types {
    /// Declares a type below others, which are thereby declared, too.
    pub(super) fn declare(&mut self, name: &str, parents: &[&str]) {
        let id = self.intern(name) as usize;
        for parent in parents {
            let parent = self.intern(parent);
            self.parents[id].push(parent);
        }
    }

    fn intern(&mut self, name: &str) -> Id {
        let id = self.names.intern(name);
        self.parents.resize(self.names.len(), Vec::new());
        id
    }

    fn find(&mut self, name: &str) -> Result<Id, String> {
        if name == "object" {
            return Ok(self.intern(name));
        }
        self.names.find(name).ok_or_else(|| name.to_owned())
    }

    /// Gives an object its types, or says which of them is unknown.
    pub(super) fn give(&mut self, object: Id, types: &[&str]) -> Result<(), String> {
        let object = object as usize;
        if object >= self.of_objects.len() {
            self.of_objects.resize(object + 1, Vec::new());
        }
        for name in types {
            let id = self.find(name)?;
            self.of_objects[object].push(id);
        }
        Ok(())
    }

    /// The objects of any of these types, or the type that is unknown. Only once all objects have
    /// been given theirs.
    pub(super) fn sort(&mut self, types: &[&str]) -> Result<SortId, String> {
        let mut ids = Vec::new();
        for name in types {
            ids.push(self.find(name)?);
        }
        ids.sort_unstable();
        ids.dedup();
        if let Some(sort) = self.sort_ids.get(&ids) {
            return Ok(*sort);
        }
        let everything = types.contains(&"object");
        let has: Vec<bool> = (self.of_objects.iter())
            .map(|of_object| everything || self.any_below(of_object, &ids))
            .collect();
        let members = has.iter().enumerate().filter(|(_, has)| **has);
        let sort = Sort {
            name: types.join(" or "),
            members: members.map(|(object, _)| object as Id).collect(),
            has,
        };
        self.sorts.push(sort);
        self.sort_ids.insert(ids, self.sorts.len() - 1);
        Ok(self.sorts.len() - 1)
    }

    fn any_below(&self, types: &[Id], wanted: &[Id]) -> bool {
        let mut seen = vec![false; self.parents.len()];
        let mut open = types.to_vec();
        while let Some(each) = open.pop() {
            if wanted.contains(&each) {
                return true;
            }
            if !std::mem::replace(&mut seen[each as usize], true) {
                open.extend(&self.parents[each as usize]);
            }
        }
        false
    }

    pub(super) fn into_sorts(self) -> Vec<Sort> {
        self.sorts
    }
}
