//! Every process of a robot is killed and frozen, at random and at the moments at which it hurts most,
//! in the middle of emergencies within emergencies. The world goes on and counts, and an observer
//! that only listens keeps the books: every goal that was accepted ends, none twice, none is lost,
//! and what is to be done once is never done twice. Meanwhile doors close, actions fail, stop late or refuse to stop,
//! and some goals have deadlines, so that goals succeed, fail, and end as unknown.
//!
//! In another run the world's process is one of those that are killed.
//!
//! `KILLS=200 SEED=7 SPEED=20 cargo test --release -p intermezzo --test kills -- --nocapture --test-threads 1`
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test, and one that is watched"
)]

mod chance;
mod doors;
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
use doors::Doors;
use feeder::{Accepted, Feeder};
use observer::{Books, Observer};
use rig::{Reality, Rig};
use times::Times;

/// The robot is there again within this, whatever was done to it: a frozen role is only noticed and killed
/// after some seconds.
const RECOVERY: Duration = Duration::from_secs(60);
/// A recovery that takes longer is worth a look, unless nobody can know yet.
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
    run(Reality::Safe, 12).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn and_so_it_is_if_the_world_s_process_dies_though_it_may_forget_its_last_moment() {
    run(Reality::Mortal, 6).await;
}

async fn run(reality: Reality, usual_kills: u64) {
    let kills = usize::try_from(number("KILLS", usual_kills)).unwrap();
    let seed = number("SEED", 1);
    let speed = number("SPEED", 20);
    println!("{kills} kills, seed {seed}, {speed} times as fast as real time, {reality:?} reality");
    let mut chance = Chance::new(seed);
    let mut rig = Rig::new(feeder::MOST_GOALS, speed as f64, seed, reality).await;
    let observer = Arc::new(Observer::new(&rig.session, &rig.keys).await);
    all_there(&rig, &observer, &[]).await;
    let feeder = Feeder::start(rig.client.clone(), observer.clone(), chance.seed());
    let doors = Doors::start(rig.client.clone(), chance.seed());
    let mut times = Times::default();
    let begun = Instant::now();
    let mut done = 0;
    while done < kills {
        let blow = chance.blow(rig.roles());
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
    let closed = doors.stop().await;
    all_there(&rig, &observer, &[]).await;
    let goals = feeder.goals().await;
    let ended = observer.until(AFTERMATH, |books| {
        missing(books, &goals).is_empty().then_some(())
    });
    let ended = tokio::select! {
        ended = ended => ended,
        () = doors::are_open(&rig.client) => None,
    };
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
    println!("doors closed {closed} times");
    println!("{}", audit(&observer.books(), &goals, seed, reality));
    println!("{times}");
    // With a world that dies, and closed doors, few come to their end in the same time.
    assert!(goals.len() >= kills / 8, "too few goals to be a test");
    rig.end().await;
}

/// The accepted goals of which nobody has heard that they ended.
fn missing<'a>(books: &Books, goals: &'a [Accepted]) -> Vec<&'a str> {
    let ids = goals.iter().map(|goal| goal.id.as_str());
    ids.filter(|id| !books.ends.contains_key(*id)).collect()
}

/// Compares what was heard with the world's own books: a deed is done once if its goal succeeded, and
/// never twice. A world that was killed may have forgotten a deed that it had told of.
fn audit(books: &Books, goals: &[Accepted], seed: u64, reality: Reality) -> String {
    let mut ends: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut deeds, mut forgotten) = (0, 0);
    for goal in goals {
        let end = books.ends[&goal.id].values().next().unwrap();
        *ends.entry(end).or_default() += 1;
        let Some(deed) = &goal.deed else { continue };
        let times = books.times(deed);
        deeds += times;
        let right = match end.as_str() {
            "goal_succeeded" if times == 0 && reality == Reality::Mortal => {
                forgotten += 1;
                true
            }
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
        "{} goals accepted, all ended: {ends:?}; {deeds} deeds done, {forgotten} forgotten by the world; {} suspensions, {} resumptions",
        goals.len(),
        heard("parent goal_suspended"),
        heard("parent goal_resumed"),
    )
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
        let all = rig.roles().iter().all(|role| books.epoch(role).is_some());
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
    let epochs: Vec<_> = {
        let books = observer.books();
        let roles = rig.roles().iter();
        roles.map(|role| (*role, books.epoch(role))).collect()
    };
    let mut begun = Instant::now();
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
            How::Freeze(Some(time)) => thaws.push((begun + time, stroke.whom)),
            How::Kill | How::Freeze(None) => {
                new.extend(epochs.iter().filter(|(role, _)| *role == stroke.whom));
            }
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
        new = epochs;
    }
    for (at, whom) in thaws {
        tokio::time::sleep_until(at).await;
        // It may have been killed meanwhile, being frozen.
        if rig.signal(whom, Signal::SIGCONT) && !up_killed {
            begun = Instant::now();
        }
    }
    if blow.rest && struck > 0 {
        all_there(rig, observer, &new).await;
        let ready = Instant::now();
        let for_good = |stroke: &Stroke| matches!(stroke.how, How::Freeze(None));
        if ready - begun > SLOW && !blow.strokes.iter().any(for_good) {
            println!("           slow:\n{}", rig.told());
        }
        let moved = observer
            .until(MOMENT, |books| books.moved.filter(|moved| *moved >= ready))
            .await;
        times.recovered(blow, ready - begun, moved.map(|moved| moved - begun));
    }
    struck
}
