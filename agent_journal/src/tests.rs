#![allow(clippy::panic)]

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use redb::StorageBackend;
use redb::backends::InMemoryBackend;

use super::*;

fn whose() -> Identity {
    Identity {
        robot: "museum".into(),
        role: "parent".into(),
        place: "5eed".into(),
    }
}

fn row(key: &str, value: &str) -> Row {
    Row {
        key: key.into(),
        value: Some(value.into()),
    }
}

fn gone(key: &str) -> Row {
    Row {
        key: key.into(),
        value: None,
    }
}

struct Place {
    _directory: tempfile::TempDir,
    path: PathBuf,
}

/// A directory, and in it the path of a journal that is not there yet.
fn place() -> Place {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("museum/parent.redb");
    Place {
        _directory: directory,
        path,
    }
}

/// A journal with a row, closed in order.
fn written(place: &Place) {
    let (mut journal, _) = Journal::open(&place.path, whose()).unwrap();
    journal.commit(&[row("s/a", "one")]).unwrap();
}

/// Opening is refused with words that contain `words`, and the file is as it was.
fn refused(place: &Place, words: &str) -> JournalError {
    let before = fs::read(&place.path).unwrap();
    let error = Journal::open(&place.path, whose()).unwrap_err();
    let text = error.to_string();
    assert!(text.contains(words), "{text}");
    assert!(text.contains(&place.path.display().to_string()), "{text}");
    assert!(text.contains("move it away"), "{text}");
    assert!(
        fs::read(&place.path).unwrap() == before,
        "it was written to"
    );
    error
}

#[test]
fn what_was_written_is_there_again() {
    let place = place();
    let (mut journal, rows) = Journal::open(&place.path, whose()).unwrap();
    assert!(rows.is_empty());
    journal
        .commit(&[row("s/a", "one"), row("s/b", "two")])
        .unwrap();
    journal.commit(&[row("s/a", "three"), gone("s/b")]).unwrap();
    assert_eq!((journal.row_count(), journal.content_bytes()), (1, 8));
    drop(journal);
    let (_, rows) = Journal::open(&place.path, whose()).unwrap();
    assert_eq!(rows, Rows::from([("s/a".into(), b"three".to_vec())]));
}

/// Former versions of redb (4.1) took some of its own files for damaged.
#[test]
fn a_journal_that_was_closed_is_sound_however_large_it_was() {
    for pages in 0..10 {
        let place = place();
        for round in 0..3_usize {
            let (mut journal, rows) = Journal::open(&place.path, whose()).unwrap();
            assert_eq!(rows.len(), if round == 0 { 0 } else { pages });
            let value = "x".repeat(900 + round * 700);
            for number in 0..pages {
                journal
                    .commit(&[row(&format!("s/{number}"), &value)])
                    .unwrap();
            }
        }
    }
}

#[test]
fn what_was_written_is_there_after_a_process_that_died() {
    let (place, died) = (place(), place());
    let (mut journal, _) = Journal::open(&place.path, whose()).unwrap();
    journal.commit(&[row("s/a", "one")]).unwrap();
    // As the disk is at the moment of the death.
    fs::create_dir_all(died.path.parent().unwrap()).unwrap();
    fs::copy(&place.path, &died.path).unwrap();
    let (_, rows) = Journal::open(&died.path, whose()).unwrap();
    assert_eq!(rows, Rows::from([("s/a".into(), b"one".to_vec())]));
}

#[test]
fn a_journal_whose_rows_make_no_sense_to_their_reader_is_left_untouched() {
    let place = place();
    written(&place);
    let before = fs::read(&place.path).unwrap();
    let (journal, _) = Journal::open(&place.path, whose()).unwrap();
    drop(journal);
    assert!(fs::read(&place.path).unwrap() == before);
}

#[test]
fn a_journal_has_one_writer() {
    let place = place();
    let _first = Journal::open(&place.path, whose()).unwrap();
    let error = Journal::open(&place.path, whose()).unwrap_err();
    assert!(matches!(error, JournalError::InUse { .. }), "{error}");
}

#[test]
fn what_is_no_journal_is_refused_and_left_untouched() {
    let place = place();
    written(&place);
    for content in [&b"key = \"value\"\n"[..], &[], &[0; 5000]] {
        fs::write(&place.path, content).unwrap();
        let error = refused(&place, "is not a journal");
        assert!(matches!(error, JournalError::Foreign { .. }), "{error}");
    }
    fs::remove_file(&place.path).unwrap();
    let other = Database::create(&place.path).unwrap();
    drop(other);
    refused(&place, "does not say what it is");
}

#[test]
fn a_journal_of_another_is_refused_and_left_untouched() {
    let place = place();
    for (other, words) in [
        (
            Identity {
                robot: "other".into(),
                ..whose()
            },
            "that of robot `other`, not `museum`",
        ),
        (
            Identity {
                role: "child".into(),
                ..whose()
            },
            "that of role `child`, not `parent`",
        ),
        (
            Identity {
                place: "0000".into(),
                ..whose()
            },
            "that of place `0000`, not `5eed`",
        ),
    ] {
        drop(Journal::open(&place.path, other).unwrap());
        refused(&place, words);
        fs::remove_file(&place.path).unwrap();
    }
}

#[test]
fn a_newer_journal_is_refused_and_left_untouched() {
    let place = place();
    written(&place);
    let database = Database::create(&place.path).unwrap();
    let transaction = database.begin_write().unwrap();
    transaction
        .open_table(ABOUT)
        .unwrap()
        .insert(FORMAT_KEY, "3")
        .unwrap();
    transaction.commit().unwrap();
    drop(database);
    let error = refused(&place, "journal format 3; this one reads journal format 2");
    assert!(matches!(error, JournalError::Newer { .. }), "{error}");
    let mut bytes = fs::read(&place.path).unwrap();
    bytes[64] = 4;
    fs::write(&place.path, bytes).unwrap();
    refused(&place, "file format 4");
}

#[test]
fn a_journal_that_is_cut_short_is_refused_and_left_untouched() {
    let place = place();
    written(&place);
    let whole = fs::read(&place.path).unwrap();
    for len in [10, 300, 4096, whole.len() / 2, whole.len() - 1] {
        fs::write(&place.path, &whole[..len]).unwrap();
        let error = refused(&place, "cut short");
        assert!(matches!(error, JournalError::Damaged { .. }), "{error}");
    }
}

/// Whichever byte of a journal is another, it is either refused and left as it is, or nothing that
/// was written in it is different.
#[test]
fn a_changed_byte_is_noticed_or_of_no_consequence() {
    let place = place();
    written(&place);
    let whole = fs::read(&place.path).unwrap();
    // What is zero all over is not in use; of the rest, a byte here and there.
    let used: Vec<usize> = (0..whole.len()).filter(|at| whole[*at] != 0).collect();
    let head = used.iter().copied().filter(|at| *at < 320);
    let body = used.iter().copied().filter(|at| *at >= 320).step_by(97);
    let mut noticed = 0;
    for at in head.chain(body) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x11;
        fs::write(&place.path, &bytes).unwrap();
        match Journal::open(&place.path, whose()) {
            Ok((_, rows)) => {
                let expected = Rows::from([("s/a".into(), b"one".to_vec())]);
                assert_eq!(rows, expected, "{at}");
            }
            Err(_) => {
                assert!(fs::read(&place.path).unwrap() == bytes, "{at}: written to");
                noticed += 1;
            }
        }
    }
    assert!(noticed > 0);
}

#[test]
fn the_file_does_not_grow_with_history() {
    let place = place();
    let (mut journal, _) = Journal::open(&place.path, whose()).unwrap();
    let goal = |journal: &mut Journal, number: usize| {
        let key = format!("m/goal/{number}");
        journal.commit(&[row(&key, &"x".repeat(2000))]).unwrap();
        journal.commit(&[gone(&key)]).unwrap();
    };
    (0..10).for_each(|number| goal(&mut journal, number));
    let few = fs::metadata(&place.path).unwrap().len();
    (10..500).for_each(|number| goal(&mut journal, number));
    assert_eq!(fs::metadata(&place.path).unwrap().len(), few);
}

#[test]
fn a_file_that_was_large_once_is_small_after_the_next_start() {
    let (place, died) = (place(), place());
    let (mut journal, _) = Journal::open(&place.path, whose()).unwrap();
    let large = |n: usize| format!("m/{n}");
    let rows: Vec<Row> = (0..20)
        .map(|n| row(&large(n), &"x".repeat(1 << 20)))
        .collect();
    journal.commit(&rows).unwrap();
    let rows: Vec<Row> = (0..20).map(|n| gone(&large(n))).collect();
    journal.commit(&rows).unwrap();
    journal.commit(&[row("s/a", "one")]).unwrap();
    // A process that died did not tidy up.
    fs::create_dir_all(died.path.parent().unwrap()).unwrap();
    fs::copy(&place.path, &died.path).unwrap();
    assert!(fs::metadata(&died.path).unwrap().len() > WORTH_REWRITING_BYTES);
    let (mut journal, rows) = Journal::open(&died.path, whose()).unwrap();
    assert_eq!(rows.len(), 1);
    journal.commit(&[row("s/b", "two")]).unwrap();
    drop(journal);
    let (_, rows) = Journal::open(&died.path, whose()).unwrap();
    assert_eq!(rows.len(), 2);
    assert!(fs::metadata(&died.path).unwrap().len() < WORTH_REWRITING_BYTES);
}

/// In memory, and full when told so.
#[derive(Clone, Debug, Default)]
struct Failing {
    full: Arc<AtomicBool>,
    begun_anew: Arc<AtomicU64>,
}

#[derive(Debug)]
struct FailingMedium(InMemoryBackend, Arc<AtomicBool>);

impl FailingMedium {
    fn check(&self) -> std::io::Result<()> {
        if self.1.load(Ordering::SeqCst) {
            return Err(std::io::ErrorKind::StorageFull.into());
        }
        Ok(())
    }
}

impl StorageBackend for FailingMedium {
    fn len(&self) -> std::io::Result<u64> {
        self.0.len()
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> std::io::Result<()> {
        self.0.read(offset, out)
    }

    fn set_len(&self, len: u64) -> std::io::Result<()> {
        self.0.set_len(len)
    }

    fn sync_data(&self) -> std::io::Result<()> {
        self.check()
    }

    fn write(&self, offset: u64, data: &[u8]) -> std::io::Result<()> {
        self.check()?;
        self.0.write(offset, data)
    }
}

impl Disk for Failing {
    fn name(&self) -> String {
        "memory".into()
    }

    fn look(&self) -> std::io::Result<Option<Medium>> {
        Ok(None)
    }

    fn open(&self) -> std::io::Result<Medium> {
        Err(std::io::ErrorKind::NotFound.into())
    }

    fn begin_anew(&self) -> std::io::Result<Medium> {
        self.begun_anew.fetch_add(1, Ordering::SeqCst);
        let memory = InMemoryBackend::new();
        Ok(Box::new(FailingMedium(memory, self.full.clone())))
    }

    fn put_in_place(&self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn what_was_not_written_is_written_with_the_next_commit() {
    let disk = Failing::default();
    let (mut journal, _) = Journal::on(disk.clone(), whose()).unwrap();
    journal.commit(&[row("s/a", "one")]).unwrap();
    disk.full.store(true, Ordering::SeqCst);
    for _ in 0..3 {
        let error = journal.commit(&[row("s/b", "two")]).unwrap_err();
        assert!(error.to_string().contains("cannot be written"), "{error}");
        assert!(error.to_string().contains("memory"), "{error}");
    }
    disk.full.store(false, Ordering::SeqCst);
    journal.commit(&[]).unwrap();
    journal.commit(&[row("s/c", "three")]).unwrap();
    // What an error has left of a file is not trusted.
    assert_eq!(disk.begun_anew.load(Ordering::SeqCst), 1 + 2 + 1);
    let Kept::Open(database) = &journal.database else {
        panic!("it has just been written");
    };
    let rows = examine::rows(database).unwrap();
    assert_eq!(rows, journal.rows);
    assert_eq!(rows.len(), 3);
}
