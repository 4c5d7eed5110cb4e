//! A domain as it was read, once for all maps.

use std::sync::Arc;

use super::code::Code;
use super::groups::{self, Members};
use super::intern::Names;
use super::same;
use crate::model::{Domain, ExecutionModel};
use crate::planner::Problem;
use crate::planner::invariants::mutex_groups;

/// What follows from a domain and its execution model alone. To find it out takes longer than to
/// read a map, and an agent is given one map after the other.
#[derive(Debug)]
pub(super) struct Reading {
    pub domain: Arc<Domain>,
    pub model: Arc<ExecutionModel>,
    /// The names in the domain.
    pub names: Names,
    pub code: Arc<Code>,
    /// Facts of which at most one holds, if they are to be one variable.
    pub groups: Vec<Members>,
}

impl Reading {
    /// Reads the domain of a problem.
    pub fn new(problem: &Problem, merges: bool) -> Self {
        let (domain, model) = (problem.domain.clone(), problem.model.clone());
        let mut names = Names::default();
        let code = Arc::new(Code::new(&mut names, &domain, &model));
        let groups = match merges {
            true => groups::disjoint(&mutex_groups(&domain, &model)),
            false => Vec::new(),
        };
        Self {
            domain,
            model,
            names,
            code,
            groups,
        }
    }

    /// Whether it is of this domain and execution model.
    pub fn is_of(&self, problem: &Problem) -> bool {
        same(&self.domain, &problem.domain) && same(&self.model, &problem.model)
    }
}
