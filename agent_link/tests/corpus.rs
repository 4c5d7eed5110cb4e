//! Every message that fuzzing has kept is read again.
#![expect(
    clippy::print_stderr,
    reason = "says which message it was that went wrong"
)]

use std::fs;
use std::path::Path;

use agent_link::wire;

#[path = "../../fuzz/targets/reading.rs"]
mod reading;

/// How many messages there are, and how many of them were understood.
fn read_all(target: &str, read: impl Fn(&[u8]) -> bool) -> (usize, usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    let entries = fs::read_dir(folder.join(target)).expect("the corpus is there");
    let (mut messages, mut understood) = (0, 0);
    for entry in entries {
        let path = entry.expect("it can be read").path();
        eprintln!("{}", path.display());
        let bytes = fs::read(&path).expect("it can be read");
        messages += 1;
        understood += usize::from(read(&bytes));
    }
    (messages, understood)
}

#[test]
fn every_message_of_a_user_in_the_corpus_is_understood_or_refused() {
    let (messages, understood) = read_all("user", reading::from_user);
    assert!(
        messages > understood && understood > 5,
        "{understood} of {messages}"
    );
}

#[test]
fn every_message_of_an_agent_in_the_corpus_is_understood_or_refused() {
    let (messages, understood) = read_all("wire", reading::from_agents);
    assert!(
        messages > understood && understood > 5,
        "{understood} of {messages}"
    );
}
