//! Every process of a robot is killed and frozen, at random and at the moments at which it hurts most,
//! in the middle of emergencies within emergencies. The world goes on and counts, and an observer
//! that only listens keeps the books: every goal that was accepted ends, none twice, none is lost,
//! and what is to be done once is never done twice.
//!
//! `KILLS=200 SEED=7 SPEED=20 cargo test --release -p intermezzo --test kills -- --nocapture`
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test, and one that is watched"
)]

mod chance;
mod feeder;
mod observer;
mod rig;
mod times;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use nix::sys::signal::Signal;
use tokio::time::Instant;

use chance::{Blow, Chance, How, Stroke, When};
use feeder::{Accepted, Feeder};
use observer::{Books, Observer};
use rig::{ROLES, Rig};
use times::Times;

/// The robot is there again within this, whatever was done to it: a frozen role is only noticed and killed
/// after some seconds.
const RECOVERY: Duration = Duration::from_secs(60);
/// A recovery from kills alone that takes longer is worth a look.
const SLOW: Duration = Duration::from_secs(2);
/// For a moment that may not come.
const MOMENT: Duration = Duration::from_secs(3);
/// All goals that are left are done within this once nothing is killed any more.
const AFTERMATH: Duration = Duration::from_secs(240);

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).map_or(usual, |text| text.parse().unwrap())
}

#[tokio::test(flavor = "multi_thread")]
async fn whatever_is_killed_every_accepted_goal_ends_and_none_twice() {
    let kills = usize::try_from(number("KILLS", 12)).unwrap();
    let seed = number("SEED", 1);
    let speed = number("SPEED", 20);
    println!("{kills} kills, seed {seed}, {speed} times as fast as real time");
    let mut chance = Chance::new(seed);
    let mut rig = Rig::new(feeder::MOST_GOALS, speed as f64).await;
    let observer = Arc::new(Observer::new(&rig.session, &rig.keys).await);
    all_there(&rig, &observer, &[]).await;
    let feeder = Feeder::start(rig.client.clone(), observer.clone(), chance.seed());
    let mut times = Times::default();
    let begun = Instant::now();
    let mut done = 0;
    while done < kills {
        let blow = chance.blow();
        done += strike(&mut rig, &observer, &feeder, &blow, &mut times).await;
        println!(
            "{:>7.1} s  {done:>4} {:?} {}",
            begun.elapsed().as_secs_f64(),
            blow.when,
            words(&blow.strokes)
        );
        note_the_world(&rig, &observer).await;
        assert_no_faults(&rig, &observer);
    }
    feeder.stop();
    all_there(&rig, &observer, &[]).await;
    let goals = feeder.goals().await;
    let ended = observer
        .until(AFTERMATH, |books| {
            missing(books, &goals).is_empty().then_some(())
        })
        .await;
    assert_no_faults(&rig, &observer);
    if ended.is_none() {
        let books = observer.books();
        panic!(
            "seed {seed}: these goals were accepted and have not ended: {:?}\n{}\n{}",
            missing(&books, &goals),
            rig.told(),
            books.told()
        );
    }
    note_the_world(&rig, &observer).await;
    println!("{}", audit(&observer.books(), &goals, seed));
    println!("{times}");
    assert!(goals.len() >= kills / 4, "too few goals to be a test");
    rig.end().await;
}

/// The accepted goals of which nobody has heard that they ended.
fn missing<'a>(books: &Books, goals: &'a [Accepted]) -> Vec<&'a str> {
    let ids = goals.iter().map(|goal| goal.id.as_str());
    ids.filter(|id| !books.ends.contains_key(*id)).collect()
}

/// Compares what was heard with the world's own books: a deed is done once if its goal succeeded, and
/// never twice.
fn audit(books: &Books, goals: &[Accepted], seed: u64) -> String {
    let mut ends: BTreeMap<&str, usize> = BTreeMap::new();
    let mut deeds = 0;
    for goal in goals {
        let end = books.ends[&goal.id].values().next().unwrap();
        *ends.entry(end).or_default() += 1;
        let Some(deed) = &goal.deed else { continue };
        let times = books.times(deed);
        deeds += times;
        let right = match end.as_str() {
            "goal_succeeded" => times == 1,
            _ => times <= 1,
        };
        assert!(
            right,
            "seed {seed}: {} ended with {end}, and {deed} was done {times} times",
            goal.id
        );
    }
    let heard = |event: &str| books.counts.get(event).copied().unwrap_or_default();
    format!(
        "{} goals accepted, all ended: {ends:?}; {deeds} deeds done; {} suspensions, {} resumptions",
        goals.len(),
        heard("parent goal_suspended"),
        heard("parent goal_resumed"),
    )
}

/// Whether something was stopped without being killed.
fn frozen(blow: &Blow) -> bool {
    let mut strokes = blow.strokes.iter();
    strokes.any(|stroke| matches!(stroke.how, How::Freeze(_)))
}

fn words(strokes: &[Stroke]) -> String {
    let words: Vec<String> = strokes
        .iter()
        .map(|stroke| match stroke.how {
            How::Kill => format!("kills {}", stroke.whom),
            How::Freeze(None) => format!("freezes {}", stroke.whom),
            How::Freeze(Some(time)) => format!("freezes {} for {time:?}", stroke.whom),
        })
        .collect();
    words.join(" and ")
}

async fn note_the_world(rig: &Rig, observer: &Observer) {
    let done = rig.done().await;
    observer.books().world(&done);
}

fn assert_no_faults(rig: &Rig, observer: &Observer) {
    let faults = observer.books().faults.clone();
    assert!(faults.is_empty(), "{}\n{}", faults.join("\n"), rig.told());
}

/// Waits until every role is there, those with an epoch in a start after that.
async fn all_there(rig: &Rig, observer: &Observer, before: &[(&'static str, Option<u64>)]) {
    let there = observer.until(RECOVERY, |books| {
        let all = ROLES.iter().all(|role| books.epoch(role).is_some());
        let new = before
            .iter()
            .all(|(role, epoch)| books.epoch(role) > *epoch);
        (all && new).then_some(())
    });
    assert!(
        there.await.is_some(),
        "not every role has come back within {RECOVERY:?}:\n{}",
        rig.told()
    );
}

/// Does it when its moment has come; counts processes that were killed or frozen.
async fn strike(
    rig: &mut Rig,
    observer: &Observer,
    feeder: &Feeder,
    blow: &Blow,
    times: &mut Times,
) -> usize {
    match blow.when {
        When::After(delay) => tokio::time::sleep(delay).await,
        When::On(agent, event) => {
            let from = observer.books().last.as_ref().map(|(number, _)| *number);
            // If it does not come, any moment will do.
            let _ = observer
                .until(MOMENT, |books| {
                    let (number, last) = books.last.as_ref()?;
                    let wanted = last["agent"] == agent && last["event"] == event;
                    (Some(*number) > from && wanted).then_some(())
                })
                .await;
        }
        When::OnAnswer => feeder.next_answer(MOMENT).await,
    }
    let epochs = ROLES.map(|role| (role, observer.books().epoch(role)));
    let begun = Instant::now();
    let mut struck = 0;
    let mut new: Vec<(&'static str, Option<u64>)> = Vec::new();
    let mut up_killed = false;
    let mut thaws = Vec::new();
    for stroke in &blow.strokes {
        let signal = match stroke.how {
            How::Kill => Signal::SIGKILL,
            How::Freeze(_) => Signal::SIGSTOP,
        };
        if !rig.signal(stroke.whom, signal) {
            // It is just being started again.
            continue;
        }
        struck += 1;
        times.struck(stroke);
        match stroke.how {
            How::Kill if stroke.whom == "up" => up_killed = true,
            How::Kill => new.extend(epochs.iter().filter(|(role, _)| *role == stroke.whom)),
            How::Freeze(Some(time)) => thaws.push((begun + time, stroke.whom)),
            How::Freeze(None) => {}
        }
    }
    thaws.sort();
    if up_killed {
        // Its roles end, all of them, even one that is frozen for good: nobody else would wake it.
        for stroke in &blow.strokes {
            if stroke.whom != "up" && matches!(stroke.how, How::Freeze(None)) {
                thaws.push((begun, stroke.whom));
            }
        }
        rig.up_has_ended().await;
        rig.start_up();
        new = epochs.to_vec();
    }
    for (at, whom) in thaws {
        tokio::time::sleep_until(at).await;
        // It may have been killed meanwhile, being frozen.
        rig.signal(whom, Signal::SIGCONT);
    }
    if blow.rest && struck > 0 {
        all_there(rig, observer, &new).await;
        let ready = Instant::now();
        if ready - begun > SLOW && !frozen(blow) {
            println!("           slow:\n{}", rig.told());
        }
        let moved = observer
            .until(MOMENT, |books| books.moved.filter(|moved| *moved >= ready))
            .await;
        if !frozen(blow) {
            times.recovered(up_killed, ready - begun, moved.map(|moved| moved - begun));
        }
    }
    struck
}
