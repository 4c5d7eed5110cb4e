//! From an agent to its rows.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::super::{Agent, Ended, Execution, Intention, Phase, ResumedBy, Running, WaitsFor};
use super::network::Writer;
use super::rows::{
    AgendaRow, AgentRow, EndedRow, ExecutionRow, FactRow, GoalRow, MapRow, OriginRow, PhaseRow,
    PlanRow, RecordRow, RunningRow, ToldRow, ValueRow,
};
use super::same::Written;
use super::{AGENT, ENDED, FACT, GOAL, MAP, Memory, TOLD, VALUE, key_of, numbered};
use crate::model::Map;
use crate::planner::{Origin, Planner};

impl Memory {
    /// Puts down all that may be different.
    pub fn note<P: Planner>(&mut self, agent: &Agent<P>) {
        self.note_belief(agent);
        self.note_told(agent);
        self.note_ended(agent);
        let mut maps = BTreeSet::new();
        let map = self.number_of(&agent.map, &agent.own_map);
        maps.extend(map);
        self.note_goals(agent, &mut maps);
        let stack = agent.stack.entries().iter();
        let waiting = agent.waiting.intentions().iter();
        let aside = agent.aside.goals().iter();
        let head = AgentRow {
            next_action: agent.next_action,
            next_goal: agent.next_goal,
            next_ended: agent.next_ended,
            last_executor: agent.last_executor.clone(),
            hold: agent.hold.clone(),
            map,
            running: agent.running().map(number),
            stack: stack
                .map(|entry| {
                    let held = entry.resumed_by == ResumedBy::Superior;
                    (number(&entry.intention), held)
                })
                .collect(),
            waiting: waiting.map(number).collect(),
            aside: aside
                .map(|(intention, waits_for)| {
                    let facts = match waits_for {
                        WaitsFor::User => None,
                        WaitsFor::Facts(facts) => Some(facts.iter().cloned().collect()),
                    };
                    (number(intention), facts)
                })
                .collect(),
        };
        self.ledger.put(AGENT.to_owned(), &head);
        let (ledger, gone) = (&mut self.ledger, |number: &u64| !maps.contains(number));
        self.maps.retain(|(number, _)| {
            if gone(number) {
                ledger.remove(&numbered(MAP, *number));
            }
            !gone(number)
        });
    }

    fn note_belief<P: Planner>(&mut self, agent: &Agent<P>) {
        for fact in std::mem::take(&mut self.touched) {
            let key = key_of(FACT, &fact);
            match agent.belief.holds(&fact) {
                holds if holds == self.configured.holds(&fact) => self.ledger.remove(&key),
                holds => {
                    let fact = fact.clone();
                    self.ledger.put(key, &FactRow { fact, holds });
                }
            }
            let key = key_of(VALUE, &fact);
            let value = agent.belief.value(&fact);
            match value {
                Some(value) if self.configured.value(&fact) != Some(value) => {
                    let function = fact;
                    self.ledger.put(key, &ValueRow { function, value });
                }
                _ => self.ledger.remove(&key),
            }
        }
    }

    fn note_told<P: Planner>(&mut self, agent: &Agent<P>) {
        let same = |(told, values): &(_, _)| *told == agent.told && *values == agent.new_values;
        if !self.told.as_ref().is_some_and(same) {
            let row = ToldRow {
                facts: agent.told.facts().cloned().collect(),
                new_values: agent.new_values.clone(),
            };
            self.ledger.put(TOLD.to_owned(), &row);
            self.told = Some((agent.told.clone(), agent.new_values.clone()));
        }
    }

    fn note_ended<P: Planner>(&mut self, agent: &Agent<P>) {
        let first = agent.next_ended - agent.ended.len() as u64;
        for gone in self.ended.start..self.ended.end.min(first) {
            self.ledger.remove(&numbered(ENDED, gone));
        }
        let new = self.ended.end.max(first);
        let ended = agent.ended.range((new - first) as usize..);
        for (number, ended) in (new..).zip(ended) {
            let Ended {
                id,
                tasks,
                superior,
                outcome,
                at,
            } = ended.clone();
            let row = EndedRow {
                id,
                tasks,
                superior,
                outcome,
                at,
            };
            self.ledger.put(numbered(ENDED, number), &row);
        }
        self.ended = first..agent.next_ended;
    }

    fn note_goals<P: Planner>(&mut self, agent: &Agent<P>, maps: &mut BTreeSet<u64>) {
        let mut live = 0;
        for intention in agent.all_intentions() {
            live += 1;
            let number = number(intention);
            let running = agent.running.as_ref();
            let running = running.filter(|running| std::ptr::eq(&running.intention, intention));
            let written = self.goals.get(&number);
            if let Some(written) = written.filter(|it| it.is_still(intention, running)) {
                maps.extend(written.map);
                continue;
            }
            let map = self.number_of(&intention.goal.map, &agent.own_map);
            maps.extend(map);
            let row = goal_row(intention, running, map);
            self.ledger.put(numbered(GOAL, number), &row);
            let written = Written::new(intention, running, map);
            self.goals.insert(number, written);
        }
        if live < self.goals.len() {
            let live: BTreeSet<u64> = agent.all_intentions().map(number).collect();
            let ledger = &mut self.ledger;
            self.goals.retain(|number, _| {
                let lives = live.contains(number);
                if !lives {
                    ledger.remove(&numbered(GOAL, *number));
                }
                lives
            });
        }
    }

    /// The number of a map, which is written down if it is new. None for the agent's own.
    pub(super) fn number_of(&mut self, map: &Arc<Map>, own: &Arc<Map>) -> Option<u64> {
        if Arc::ptr_eq(map, own) {
            return None;
        }
        let known = |(_, known): &&(u64, Arc<Map>)| Arc::ptr_eq(known, map);
        if let Some((number, _)) = self.maps.iter().find(known) {
            return Some(*number);
        }
        // A superior sends the same map again and again.
        let number = match self.maps.iter().find(|(_, known)| known == map) {
            Some((number, _)) => *number,
            None => {
                let number = self.next_map;
                self.next_map += 1;
                self.ledger.put(numbered(MAP, number), &map_row(map));
                number
            }
        };
        self.maps.push((number, map.clone()));
        Some(number)
    }
}

fn number(intention: &Intention) -> u64 {
    intention.goal.number
}

fn map_row(map: &Map) -> MapRow {
    let objects = map.objects.iter();
    MapRow {
        objects: objects.map(|(o, kind)| (o.clone(), kind.clone())).collect(),
        facts: map.facts.facts().cloned().collect(),
        values: map.facts.values().map(|(f, v)| (f.clone(), v)).collect(),
        landmarks: map.facts.landmarks().cloned().collect(),
        news: map.news.clone(),
    }
}

fn goal_row(intention: &Intention, running: Option<&Running>, map: Option<u64>) -> GoalRow {
    let mut writer = Writer::default();
    let agendas = intention.agendas.iter().map(|agenda| AgendaRow {
        tasks: writer.list(&agenda.tasks),
        origin: origin_row(agenda.origin),
    });
    let agendas = agendas.collect();
    let plans = intention.plans.iter().map(|plan| PlanRow {
        steps: plan.steps.iter().map(|step| writer.step(step)).collect(),
        rest: writer.list(&plan.rest),
        cost: plan.cost.0,
    });
    let plans = plans.collect();
    let records = intention.records.iter().map(|record| RecordRow {
        id: record.id.clone(),
        executor: record.executor.clone(),
        step: writer.step(&record.step),
    });
    let records = records.collect();
    let running = running.map(|running| RunningRow {
        phase: match &running.phase {
            // What it waits for leave for is found out anew.
            Phase::Planning | Phase::Ready(_) => PhaseRow::Planning,
            Phase::Executing(execution) => {
                PhaseRow::Executing(execution_row(&mut writer, execution))
            }
            Phase::Stopping(execution) => PhaseRow::Stopping(execution_row(&mut writer, execution)),
        },
        resumed: running.resumed,
        set_aside: running.set_aside,
        broken: running.broken.clone(),
        surprised: running.surprised,
    });
    let goal = &intention.goal;
    let failures = intention.failures.iter();
    GoalRow {
        number: goal.number,
        id: goal.id.clone(),
        tasks: goal.tasks.clone(),
        urgency: goal.urgency,
        priority: goal.priority,
        deadline: goal.deadline,
        superior: goal.superior.clone(),
        map,
        started: intention.started,
        cancelled: intention.cancelled.clone(),
        orphaned: intention.orphaned,
        fits: intention.fits,
        blocked_by: intention.blocked_by.iter().cloned().collect(),
        failures: failures.map(|(a, times)| (a.clone(), *times)).collect(),
        failed: intention.failed.clone(),
        last_failure: intention.last_failure.clone(),
        lost: intention.lost.iter().cloned().collect(),
        done_once: intention.done_once.iter().copied().collect(),
        network: writer.finish(),
        agendas,
        plans,
        records,
        running,
    }
}

fn execution_row(writer: &mut Writer, execution: &Execution) -> ExecutionRow {
    ExecutionRow {
        id: execution.id.clone(),
        executor: execution.executor.clone(),
        step: writer.step(&execution.step),
        due: execution.due,
        done: execution.done.clone(),
    }
}

fn origin_row(origin: Origin) -> OriginRow {
    match origin {
        Origin::Goal => OriginRow::Goal,
        Origin::Tail => OriginRow::Tail,
        Origin::Again => OriginRow::Again,
        Origin::Ancestor => OriginRow::Ancestor,
        Origin::Resume => OriginRow::Resume,
        Origin::Reach => OriginRow::Reach,
        Origin::RollBack => OriginRow::RollBack,
    }
}
