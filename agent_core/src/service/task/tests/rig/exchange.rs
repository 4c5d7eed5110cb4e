//! What the services say to each other and to the bodies, and what comes of it.

use super::*;

impl World {
    /// Has something handled, as a vehicle does: what is due comes first.
    pub(super) fn tell(&mut self, who: usize, input: impl FnOnce(&mut TaskService)) {
        let Some(mut service) = self.vehicles[who].service.take() else {
            return;
        };
        service.settle(self.now);
        self.drain(who, &mut service);
        input(&mut service);
        service.settle(self.now);
        self.drain(who, &mut service);
        let due = service.wake_at().map(|at| at.max(self.now));
        let vehicle = &mut self.vehicles[who];
        for row in service.write_down() {
            match row.value {
                Some(value) => vehicle.rows.insert(row.key, value),
                None => vehicle.rows.remove(&row.key),
            };
        }
        vehicle.service = Some(service);
        if let Some(due) = due
            && vehicle.woken_at.is_none_or(|at| due < at)
        {
            vehicle.woken_at = Some(due);
            self.at(due, What::Wake(who));
        }
    }

    pub(super) fn drain(&mut self, who: usize, service: &mut TaskService) {
        while let Some(output) = service.poll_output() {
            match output {
                TaskOutput::Say(message) => self.broadcast(who, &message),
                TaskOutput::Assess(offer) => {
                    let cost = self.able.get(&(who, offer.task.clone())).copied();
                    service.assessed(&offer, cost, BTreeSet::new());
                    service.settle(self.now);
                }
                TaskOutput::Give { to, id, what, .. } => {
                    let to = index(&to);
                    self.say(|| format!("{} gives {what} to {} as {id}", NAMES[who], NAMES[to]));
                    if to == who {
                        let task = service.taken()[&id].task.clone();
                        self.begin(who, service, &id, task, what, who);
                    } else {
                        self.send(who, to, Parcel::Give(id));
                    }
                }
                TaskOutput::TakeBack { from, id } => {
                    let from = index(&from);
                    if from == who {
                        self.stop(who, &id);
                        service.let_go(&id);
                    } else {
                        self.send(who, from, Parcel::TakeBack(id));
                    }
                }
                TaskOutput::GiveUp { publisher, id, .. } => {
                    self.say(|| format!("{} gives {id} up", NAMES[who]));
                    self.given_up += 1;
                    // It says so when it stands still. If its process was started again, its body may
                    // have gone on without it for a while.
                    let rests = self.stop(who, &id).unwrap_or(self.now);
                    let longest = self.vehicles[who].resting.values().max().copied();
                    let rests = rests.max(longest.unwrap_or(self.now));
                    self.at(rests, What::SayGivenUp(who, index(&publisher), id));
                }
                TaskOutput::Ended { task, outcome, .. } => {
                    self.say(|| format!("{task} has ended: {outcome:?}"));
                    let before = self.ended.insert(task.clone(), outcome);
                    assert_eq!(before, None, "{task} ends twice");
                }
            }
        }
    }

    pub(super) fn broadcast(&mut self, from: usize, message: &Message) {
        for to in 0..self.vehicles.len() {
            if to == from || !self.connected(from, to) {
                continue;
            }
            let copies = match self.faults.messages {
                true if self.chance.one_in(5) => 0,
                true if self.chance.one_in(8) => 2,
                _ => 1,
            };
            for _ in 0..copies {
                let late = self.faults.messages && self.chance.one_in(6);
                let most = if late { 3.0 } else { 0.02 };
                self.soon(0.001, most, What::Message(to, message.clone()));
            }
        }
    }

    pub(super) fn send(&mut self, from: usize, to: usize, parcel: Parcel) {
        self.lanes.entry((from, to)).or_default().push_back(parcel);
        self.soon(0.001, 0.02, What::Parcel(from, to));
    }

    /// The first of what is on its way from one to the other, if both are there.
    pub(super) fn parcel(&mut self, from: usize, to: usize) {
        let there = self.lives(from)
            && self.lives(to)
            && self.connected(from, to)
            && !self.vehicles[from].frozen
            && !self.vehicles[to].frozen;
        let waits = self
            .lanes
            .get(&(from, to))
            .is_some_and(|lane| !lane.is_empty());
        if !waits {
            return;
        }
        if !there {
            if !self.vehicles[from].dead_for_good && !self.vehicles[to].dead_for_good {
                self.soon(0.1, 0.3, What::Parcel(from, to));
            }
            return;
        }
        let lane = self
            .lanes
            .get_mut(&(from, to))
            .and_then(VecDeque::pop_front);
        if let Some(parcel) = lane {
            self.deliver(from, to, parcel);
        }
        self.soon(0.001, 0.02, What::Parcel(from, to));
    }

    pub(super) fn deliver(&mut self, from: usize, to: usize, parcel: Parcel) {
        let now = self.now;
        // What is due comes first.
        self.tell(to, |_| {});
        match parcel {
            Parcel::Give(id) => {
                let mut taken = None;
                self.tell(to, |service| taken = Some(service.take(now, &id).cloned()));
                let answer = match taken.expect("it lives") {
                    Ok(taken) => {
                        let Some(mut service) = self.vehicles[to].service.take() else {
                            return;
                        };
                        self.begin(to, &mut service, &id, taken.task, taken.what, from);
                        self.vehicles[to].service = Some(service);
                        Answer::Accepted
                    }
                    Err(why) => {
                        let reason = why.to_string();
                        Answer::Rejected { reason }
                    }
                };
                self.send(to, from, Parcel::Answer(id, answer));
            }
            Parcel::Answer(id, answer) => self.tell(to, |service| service.answered(&id, &answer)),
            Parcel::TakeBack(id) => {
                self.stop(to, &id);
                self.tell(to, |service| service.let_go(&id));
            }
            Parcel::Report(id, report) => {
                self.tell(to, |service| {
                    service.reported(&id, &report);
                });
            }
        }
    }

    pub(super) fn begin(
        &mut self,
        who: usize,
        service: &mut TaskService,
        id: &ActionId,
        task: TaskId,
        what: Task,
        publisher: usize,
    ) {
        if self.done.contains_key(&task) {
            // It sees that there is nothing to do.
            self.found_done += 1;
            let success = Report::Success { facts: Vec::new() };
            service.let_go(id);
            self.report(who, service, publisher, id.clone(), success);
            return;
        }
        self.begun += 1;
        let left = self.chance.within(1.0, 20.0);
        let work = Work {
            task,
            what,
            publisher,
            left,
            version: 0,
            since: None,
            busy_until: Time::ZERO,
        };
        self.vehicles[who].work.insert(id.clone(), work);
        self.resume_work(who);
    }

    pub(super) fn report(
        &mut self,
        who: usize,
        service: &mut TaskService,
        publisher: usize,
        id: ActionId,
        report: Report,
    ) {
        if publisher == who {
            service.reported(&id, &report);
            service.settle(self.now);
        } else {
            self.send(who, publisher, Parcel::Report(id, report));
        }
    }

    /// Returns when it stands still.
    pub(super) fn stop(&mut self, who: usize, id: &ActionId) -> Option<Time> {
        let rest = Times::default().rest.secs();
        let work = self.vehicles[who].work.remove(id)?;
        let until = match work.since {
            Some(_) => self.now + self.chance.within(0.0, rest),
            None => work.busy_until,
        };
        self.vehicles[who].resting.insert(work.task, until);
        Some(until)
    }

    /// The body comes to rest within `longest_s`.
    pub(super) fn pause_work(&mut self, who: usize, longest_s: f64) {
        let now = self.now;
        let busy_until = now + self.chance.within(0.0, longest_s);
        for work in self.vehicles[who].work.values_mut() {
            if let Some(since) = work.since.take() {
                work.busy_until = busy_until;
                work.left = work.left.since(now.since(since));
                work.version += 1;
            }
        }
    }

    pub(super) fn resume_work(&mut self, who: usize) {
        let now = self.now;
        let sees = self.vehicles[who].sees.clone();
        let mut ends = Vec::new();
        for (id, work) in &mut self.vehicles[who].work {
            let may = work.publisher == who || sees.contains(&work.publisher);
            if may && work.since.is_none() {
                work.since = Some(now);
                work.version += 1;
                ends.push((now + work.left, id.clone(), work.version));
            }
        }
        for (at, id, version) in ends {
            self.at(at, What::Work(who, id, version));
        }
    }

    pub(super) fn finish(&mut self, who: usize, id: &ActionId, version: u64) {
        let vehicle = &self.vehicles[who];
        let Some(work) = vehicle.work.get(id).cloned() else {
            return;
        };
        if work.version != version || vehicle.frozen {
            return;
        }
        // What is due comes first: its lease may have run out.
        self.tell(who, |_| {});
        if self.vehicles[who].work.remove(id).is_none() {
            return;
        }
        let fails = self.faults.work && self.chance.one_in(6);
        let report = if fails {
            failure("it did not work out")
        } else {
            self.say(|| format!("{} has done {}", NAMES[who], work.what));
            *self.done.entry(work.task.clone()).or_default() += 1;
            Report::Success { facts: Vec::new() }
        };
        let mut service = self.vehicles[who].service.take().expect("it is at work");
        service.let_go(id);
        self.report(who, &mut service, work.publisher, id.clone(), report);
        self.vehicles[who].service = Some(service);
        self.tell(who, |_| {});
    }

    /// Nobody works at what somebody else works at, or is only coming to rest from.
    pub(super) fn check(&mut self) {
        let now = self.now;
        let mut at_work: BTreeMap<&TaskId, usize> = BTreeMap::new();
        for (who, vehicle) in self.vehicles.iter_mut().enumerate() {
            vehicle.resting.retain(|_, until| *until > now);
            let working = vehicle.work.values();
            let working = working.filter(|work| work.since.is_some() || work.busy_until > now);
            let working = working.map(|work| &work.task);
            let busy: BTreeSet<&TaskId> = working.chain(vehicle.resting.keys()).collect();
            for task in busy {
                let other = at_work.insert(task, who);
                assert_eq!(
                    other.map(|other| NAMES[other]),
                    None,
                    "seed {}: {} is at work on {task} as well at {now}:\n{}",
                    self.seed,
                    NAMES[who],
                    self.log.join("\n")
                );
            }
        }
    }
}
