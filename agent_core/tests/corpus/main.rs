//! Every text that fuzzing has kept is read again.
//!
//! The texts are in `fuzz/corpus`, one folder a target.

#![expect(
    clippy::print_stderr,
    reason = "says which text it was that went wrong"
)]

mod checks;

use std::fs;
use std::path::PathBuf;

use agent_core::language::parse_domain;
use agent_core::model::Domain;

fn corpus(target: &str) -> Vec<(PathBuf, String)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../fuzz/corpus")
        .join(target);
    let entries = fs::read_dir(&folder).expect("the corpus is there");
    let mut texts: Vec<(PathBuf, String)> = entries
        .map(|entry| {
            let path = entry.expect("it can be read").path();
            let bytes = fs::read(&path).expect("it can be read");
            (path, String::from_utf8_lossy(&bytes).into_owned())
        })
        .collect();
    texts.sort();
    assert!(texts.len() > 5, "there are texts in {}", folder.display());
    texts
}

fn lamps() -> Domain {
    parse_domain(checks::DOMAIN).expect("nothing is wrong with it")
}

fn replay(target: &str, check: impl Fn(&str)) {
    for (path, text) in corpus(target) {
        // Shown only if something goes wrong.
        eprintln!("{}", path.display());
        check(&text);
    }
}

#[test]
fn every_domain_of_the_corpus_is_read_or_its_faults_are_told() {
    replay("domain", checks::domain);
}

#[test]
fn every_problem_of_the_corpus_is_read_or_its_faults_are_told() {
    let domain = lamps();
    replay("problem", |text| checks::problem(text, &domain));
}

#[test]
fn every_piece_of_the_corpus_is_read_or_refused() {
    let domain = lamps();
    replay("pieces", |text| checks::pieces(text, &domain));
}
