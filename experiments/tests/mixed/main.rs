//! Whole evenings at random: several carriers, guests who come and go, accidents, emergencies, vehicles that
//! die, messages that are lost. Judged by what was done in the room.
//!
//! `SEED=7` plays one evening, `RUNS=10000` so many; what fails says its seed and what happened, and
//! `FROM=120` leaves out what happened before.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod judge;
mod play;
mod scene;

use agent_core::model::{Symbol, Task, Time};
use executor_sim::{Spot, Whereabouts};

use play::Evening;
use scene::Scene;

const ORDINARILY: u64 = 30;

fn seeds() -> Vec<u64> {
    let number = |name: &str| std::env::var(name).ok()?.parse::<u64>().ok();
    match (number("SEED"), number("RUNS")) {
        (Some(seed), None) => vec![seed],
        (from, runs) => {
            let from = from.unwrap_or(0);
            (from..from + runs.unwrap_or(ORDINARILY)).collect()
        }
    }
}

/// What is left to be done that could be, in words.
fn unfinished(evening: &Evening) -> Vec<String> {
    let room = evening.team.room();
    let mut left = Vec::new();
    let plans = &evening.scene.restaurant.room().vehicles;
    let able = |skill: &str| {
        let mut living = evening.living();
        living.any(|(name, _)| plans[name].can.contains(&Symbol::from(skill)))
    };
    // A publisher that does not come back keeps its tasks, and one without memory has none. Who only carries
    // publishes nothing that anybody waits for, but for users.
    let lost = evening.dead.iter().chain(&evening.forgetful);
    let publishers_live = lost
        .clone()
        .all(|name| plans[name].can.iter().all(|skill| skill == "carry"));
    let nobody_lost = lost.count() == 0;
    for (name, bottle) in room.things().bottles() {
        match &bottle.spot {
            Spot::Hand { vehicle } | Spot::Slot { vehicle, .. } => {
                // What was meant for a guest whose order died with its publisher stays aboard.
                if !evening.dead.contains(vehicle) && able("watch") && publishers_live {
                    left.push(format!("{name} is {}", bottle.spot));
                }
            }
            Spot::Edge { .. } => {
                let by = evening.judge.in_haste.get(name);
                let knows =
                    |by: &Symbol| !evening.dead.contains(by) && !evening.forgetful.contains(by);
                if by.is_some_and(knows) && able("watch") && publishers_live {
                    left.push(format!("{name} is {}", bottle.spot));
                }
            }
            Spot::Proper { .. } | Spot::Away => {}
        }
    }
    let mut in_vain: Vec<Task> = Vec::new();
    // Without anybody at the door nobody sees who has left, and who is gone is looked for. What nobody can do
    // is not done.
    let excused = |task: &Task| {
        let mut guests = task.args.iter();
        let gone = |it: &executor_sim::Guest| it.whereabouts == Whereabouts::Gone;
        let unseen =
            !able("watch") && guests.any(|it| room.things().guest(it.as_str()).is_some_and(gone));
        let skill = match task.name.as_str() {
            "serve" | "clear" | "clean" => "carry",
            "take-order" | "find" => "order",
            _ => return unseen,
        };
        unseen || !able(skill)
    };
    for guest in evening.judge.waiting(room) {
        let wanted = &room.things().guest(guest.as_str()).unwrap().wants;
        if let Some(bottle) = evening.to_be_had(wanted) {
            if able("carry") && publishers_live {
                left.push(format!("{guest} waits for {bottle}"));
            }
        } else {
            in_vain.push(Task::new("serve", [wanted.as_str(), guest.as_str()]));
        }
    }
    if able("carry") && nobody_lost {
        for place in evening.judge.spills() {
            left.push(format!("{place} is wet"));
        }
    }
    if able("order") && evening.was_dead.is_empty() {
        for guest in evening.judge.unasked(room) {
            left.push(format!("{guest} was not asked"));
        }
    }
    for mover in room.movers() {
        if let Some((_, action, _)) = mover.doing().next()
            && able("watch")
        {
            left.push(format!("{} does {action}", mover.name()));
        }
    }
    for (name, vehicle) in evening.living() {
        for (task, published) in vehicle.tasks().published() {
            if !in_vain.contains(&published.new.what) && !excused(&published.new.what) {
                left.push(format!("{name} has published {task}: {published:?}"));
            }
        }
        for it in vehicle.mind().intentions() {
            if !it
                .goal
                .tasks
                .iter()
                .all(|task| in_vain.contains(task) || excused(task))
            {
                left.push(format!("{name} pursues {} {:?}", it.goal.id, it.goal.tasks));
            }
        }
    }
    left
}

/// Everything ends in that time after the last that was not of the vehicles' doing.
fn patience(scene: &Scene) -> Time {
    let guests = scene.restaurant.room().guests.len();
    Time::from_secs(900.0 + 600.0 * guests as f64)
}

fn run(seed: u64) -> Evening {
    let scene = Scene::of(seed);
    let end = scene.last() + patience(&scene);
    let mut evening = Evening::new(seed, scene);
    evening.play();
    loop {
        let left = unfinished(&evening);
        if left.is_empty() {
            return evening;
        }
        evening.assert(evening.team.now() < end, &left.join("\n"));
        let later = evening.team.now() + Time::from_secs(10.0);
        evening.until(later);
    }
}

#[test]
fn whatever_comes_together_everybody_who_stays_is_served_once_and_nothing_is_lost() {
    for seed in seeds() {
        let evening = run(seed);
        let failures = &evening.course.failures;
        let disturbed = evening.scene.incidents.len() + evening.was_dead.len();
        // Whoever is lost sight of gives back what it has: that is a goal that has failed.
        let most = 40 + 20 * evening.judge.given.len() + 20 * disturbed;
        evening.assert(failures.len() <= most, &format!("{failures:#?}"));
        if std::env::var("RUNS").is_ok() {
            tell(seed, &evening);
        }
    }
}

#[expect(
    clippy::print_stdout,
    reason = "whoever asks for many runs wants to see them"
)]
fn tell(seed: u64, evening: &Evening) {
    let (given, failures) = (evening.judge.given.len(), evening.course.failures.len());
    println!(
        "{seed}: {given} served, {failures} failures, {}",
        evening.team.now()
    );
}
