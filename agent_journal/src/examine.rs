//! Is this a journal, ours, and whole?

use std::panic::{AssertUnwindSafe, catch_unwind};

use agent_core::protocol::Rows;
use redb::{Builder, Database, ReadableDatabase, ReadableTable, TableError};

use super::disk::{AnyMedium, Medium, in_words};
use super::error::JournalError;
use super::overlay::Overlay;
use super::{ABOUT, CACHE_BYTES, FORMAT, Identity, ROWS, about};

/// The rows of what is there, if it is a journal of that identity. Nothing is written to it.
///
/// # Errors
/// If it is not, or it is damaged.
pub(super) fn examine(place: &str, medium: Medium, whose: &Identity) -> Result<Rows, JournalError> {
    let io = |why| JournalError::Io {
        place: place.to_owned(),
        why,
    };
    let len = medium.len().map_err(io)?;
    let mut head = vec![0; len.min(HEAD_BYTES as u64) as usize];
    medium.read(0, &mut head).map_err(io)?;
    check_head(place, &head, len)?;
    let overlay = Overlay::on(medium).map_err(io)?;
    // All sums in it are checked before anything is believed, but where something has been changed
    // on purpose, sums and all, redb may stop with a panic.
    let read = catch_unwind(AssertUnwindSafe(|| read(place, overlay, whose)));
    read.unwrap_or_else(|_| Err(damaged(place, "it cannot be made sense of")))
}

fn damaged(place: &str, why: impl ToString) -> JournalError {
    JournalError::Damaged {
        place: place.to_owned(),
        why: why.to_string(),
    }
}

const HEAD_BYTES: usize = 320;
const MAGIC: &[u8] = b"redb\x1A\x0A\xA9\x0D\x0A";
/// Of redb's own format.
const REDB_FORMAT: u8 = 3;
const PAGE_BYTES: u32 = 4096;

/// What redb takes for granted about the first bytes of a file and does not check. Its format is
/// described in its `docs/design.md`.
fn check_head(place: &str, head: &[u8], len: u64) -> Result<(), JournalError> {
    let foreign = |why: &str| JournalError::Foreign {
        place: place.to_owned(),
        why: why.to_owned(),
    };
    if len == 0 {
        return Err(foreign("it is empty"));
    }
    if !head.starts_with(MAGIC) {
        return Err(foreign("it begins otherwise"));
    }
    if head.len() < HEAD_BYTES {
        return Err(damaged(place, "it is cut short"));
    }
    for slot in [64, 192] {
        match head[slot] {
            format if format > REDB_FORMAT => {
                return Err(JournalError::Newer {
                    place: place.to_owned(),
                    found: format!("file format {format}"),
                    known: format!("file format {REDB_FORMAT}"),
                });
            }
            REDB_FORMAT => {}
            _ => return Err(foreign("it is a database of another kind")),
        }
    }
    let number = |at: usize| {
        let bytes = head[at..at + 4].iter().rev();
        bytes.fold(0_u32, |number, byte| (number << 8) | u32::from(*byte))
    };
    let (page, header, most, full, rest) = (
        number(12),
        u64::from(number(16)),
        u64::from(number(20)),
        u64::from(number(24)),
        u64::from(number(28)),
    );
    if page != PAGE_BYTES || header > 1 << 20 || most == 0 || most > 1 << 20 || rest > most {
        return Err(damaged(place, "its first bytes contradict each other"));
    }
    let rest = if rest > 0 { header + rest } else { 0 };
    let pages = 1 + full * (header + most) + rest;
    let wanted = pages * u64::from(page);
    if wanted > len {
        return Err(damaged(
            place,
            format_args!("it is cut short: {len} bytes are left of {wanted}"),
        ));
    }
    Ok(())
}

fn read(place: &str, overlay: Overlay, whose: &Identity) -> Result<Rows, JournalError> {
    let medium = AnyMedium(Box::new(overlay));
    let mut database = builder()
        .create_with_backend(medium)
        .map_err(|error| damaged(place, in_words(error)))?;
    // What was closed in order is not looked through when it is opened.
    match database.check_integrity() {
        Ok(true) => {}
        Ok(false) => return Err(damaged(place, "some of its sums are wrong")),
        Err(error) => return Err(damaged(place, in_words(error))),
    }
    check_identity(place, &database, whose)?;
    rows(&database).map_err(|error| damaged(place, in_words(error)))
}

pub(super) fn builder() -> Builder {
    let mut builder = Database::builder();
    builder.set_cache_size(CACHE_BYTES);
    builder
}

fn check_identity(place: &str, database: &Database, whose: &Identity) -> Result<(), JournalError> {
    let unreadable = |error: redb::Error| damaged(place, in_words(error));
    let transaction = database
        .begin_read()
        .map_err(|error| unreadable(error.into()))?;
    let about_it = match transaction.open_table(ABOUT) {
        Ok(table) => table,
        Err(TableError::Storage(error)) => return Err(unreadable(error.into())),
        Err(_) => {
            return Err(JournalError::Foreign {
                place: place.to_owned(),
                why: "it does not say what it is".to_owned(),
            });
        }
    };
    let mut found = std::collections::BTreeMap::new();
    let all = about_it.iter().map_err(|error| unreadable(error.into()))?;
    for entry in all {
        let (key, value) = entry.map_err(|error| unreadable(error.into()))?;
        found.insert(key.value().to_owned(), value.value().to_owned());
    }
    for (key, wanted) in about(whose) {
        let found = found.get(key).map_or("", String::as_str);
        if found == wanted {
            continue;
        }
        let place = place.to_owned();
        return Err(match (key, found.parse::<u32>()) {
            (FORMAT_KEY, Ok(number)) if number > FORMAT => JournalError::Newer {
                place,
                found: format!("journal format {number}"),
                known: format!("journal format {FORMAT}"),
            },
            (FORMAT_KEY | WHAT_KEY, _) => JournalError::Foreign {
                place,
                why: format!("its {key} is `{found}`, not `{wanted}`"),
            },
            _ => JournalError::OfAnother {
                place,
                what: key,
                found: found.to_owned(),
                wanted,
            },
        });
    }
    Ok(())
}

/// The key under which a journal says what it is.
pub(super) const WHAT_KEY: &str = "kind";
/// The key under which a journal says its format.
pub(super) const FORMAT_KEY: &str = "format";

pub(super) fn rows(database: &Database) -> Result<Rows, redb::Error> {
    let transaction = database.begin_read()?;
    let table = transaction.open_table(ROWS)?;
    let mut rows = Rows::new();
    for entry in table.iter()? {
        let (key, value) = entry?;
        rows.insert(key.value().to_owned(), value.value().to_vec());
    }
    Ok(rows)
}
