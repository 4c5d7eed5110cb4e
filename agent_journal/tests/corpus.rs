//! Every journal and every row that fuzzing has kept is read again.
#![expect(
    clippy::print_stderr,
    reason = "says which file it was that went wrong"
)]

use std::fs;
use std::path::Path;

#[path = "../../fuzz/targets/level.rs"]
#[allow(dead_code, reason = "problems are for plans")]
mod level;
#[path = "../../fuzz/targets/memory.rs"]
mod memory;

/// How many inputs there are, and how many of them are in order.
fn read_all(target: &str, read: impl Fn(&[u8]) -> bool) -> (usize, usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    let entries = fs::read_dir(folder.join(target)).expect("the corpus is there");
    let (mut inputs, mut in_order) = (0, 0);
    for entry in entries {
        let path = entry.expect("it can be read").path();
        eprintln!("{}", path.display());
        inputs += 1;
        in_order += usize::from(read(&fs::read(&path).expect("it can be read")));
    }
    (inputs, in_order)
}

#[test]
fn every_row_of_the_corpus_is_recalled_or_named() {
    let written = memory::written();
    let goals = written.keys().filter(|key| key.starts_with("m/goal/"));
    assert_eq!(goals.count(), 2, "one above the other: {written:?}");
    for (place, value) in written.values().enumerate() {
        let as_written = [&[u8::try_from(place).expect("there are few")], &value[..]].concat();
        assert!(
            memory::recall(&written, &as_written),
            "what was written is recalled"
        );
    }
    let (inputs, in_order) = read_all("rows", |input| memory::recall(&written, input));
    assert!(inputs > in_order && inputs > 5, "{in_order} of {inputs}");
}

#[test]
fn every_file_of_the_corpus_is_a_journal_or_refused() {
    let (inputs, in_order) = read_all("journal", memory::open);
    assert!(inputs > in_order && inputs > 3, "{in_order} of {inputs}");
}
