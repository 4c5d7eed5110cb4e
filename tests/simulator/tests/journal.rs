//! The product's journal on a disk that forgets what was not synced.

use agent_core::protocol::{Row, Rows};
use agent_journal::{Identity, Journal};
use intermezzo_simulator::dice::Dice;
use intermezzo_simulator::disk::MemoryDisk;

/// How many commits there are, each with a crash at every change of the file.
const COMMITS: u64 = 200;
/// So often the journal itself meets with one, and goes on with what is left.
const CRASH_EVERY: u64 = 5;

fn open(disk: &MemoryDisk) -> (Journal, Rows) {
    let whose = Identity {
        robot: "ring".into(),
        role: "parent".into(),
        place: "ring".into(),
    };
    Journal::on(disk.clone(), whose).expect("a crash leaves a journal that can be read")
}

/// Some rows: new ones, others in place of those of before, and gone ones; now and then large.
fn some(dice: &mut Dice, number: u64) -> Vec<Row> {
    let mut rows = Vec::new();
    for _ in 0..1 + dice.roll(6) {
        let key = format!("m/{}", dice.roll(20));
        let len = match dice.roll(40) {
            0 => 100_000 + dice.roll(1_000_000),
            1..=10 => dice.roll(5_000),
            _ => dice.roll(200),
        };
        let value = (!dice.per_mille(250)).then(|| {
            let mut value = vec![number as u8; len as usize];
            value.extend(number.to_le_bytes());
            value
        });
        rows.push(Row { key, value });
    }
    rows
}

fn with(rows: &Rows, changes: &[Row]) -> Rows {
    let mut rows = rows.clone();
    for Row { key, value } in changes {
        match value {
            Some(value) => rows.insert(key.clone(), value.clone()),
            None => rows.remove(key),
        };
    }
    rows
}

/// What is found after a crash at the `nth` change or sync from now on of a process that has just
/// opened the journal. `None`: it has not come to that.
fn found_after(disk: &MemoryDisk, changes: &[Row], nth: u64, dice: &mut Dice) -> Option<Rows> {
    let disk = disk.fork();
    let (mut journal, _) = open(&disk);
    disk.dies_after(nth);
    let written = journal.commit(changes);
    let died = disk.is_dead();
    assert!(died || written.is_ok(), "{written:?}");
    disk.crash(dice);
    drop(journal);
    let (_, found) = open(&disk);
    if let Ok(()) = written {
        return Some(found).filter(|_| died);
    }
    Some(found)
}

#[test]
fn whenever_a_process_dies_its_journal_is_as_before_a_commit_or_as_after_it() {
    let mut dice = Dice(1);
    let disk = MemoryDisk::default();
    let (mut journal, mut rows) = open(&disk);
    let (mut crashes, mut before, mut after) = (0_u64, 0_u64, 0_u64);
    for number in 0..COMMITS {
        let changes = some(&mut dice, number);
        let next = with(&rows, &changes);
        let fork = disk.fork();
        fork.crash(&mut dice);
        for nth in 0.. {
            let Some(found) = found_after(&fork, &changes, nth, &mut dice) else {
                break;
            };
            assert!(
                found == rows || found == next,
                "commit {number}, change {nth}"
            );
            crashes += 1;
            before += u64::from(found == rows);
            after += u64::from(found == next);
        }
        let dies = number % CRASH_EVERY == 0;
        if dies {
            disk.dies_after(dice.roll(12));
        }
        let written = journal.commit(&changes);
        if dies {
            disk.crash(&mut dice);
            drop(journal);
            let found;
            (journal, found) = open(&disk);
            assert!(found == next || (found == rows && written.is_err()));
            rows = found;
        } else {
            written.expect("nothing is in its way");
            rows = next;
        }
    }
    assert!(
        crashes > COMMITS * 3 && before > 100 && after > 100,
        "{crashes} {before} {after}"
    );
}
