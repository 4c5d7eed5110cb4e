//! Every plan that fuzzing has kept is read again.
#![expect(
    clippy::print_stderr,
    reason = "says which text it was that went wrong"
)]

use std::fs;
use std::path::Path;

#[path = "../../../fuzz/targets/level.rs"]
mod level;

#[test]
fn every_plan_of_the_corpus_is_read_or_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/plan");
    let mut texts = 0;
    for entry in fs::read_dir(folder).expect("the corpus is there") {
        let path = entry.expect("it can be read").path();
        eprintln!("{}", path.display());
        let bytes = fs::read(&path).expect("it can be read");
        let text = String::from_utf8_lossy(&bytes);
        texts += 1;
        let empty = "==>\nroot\n<==";
        let found = [
            plan_checker::check(level::LEVEL, level::PROBLEM, &text).err(),
            plan_checker::check_sequence(level::LEVEL, level::PROBLEM, &text).err(),
            plan_checker::check(&text, level::PROBLEM, empty).err(),
            plan_checker::check(level::LEVEL, &text, empty).err(),
        ];
        for faults in found.into_iter().flatten() {
            assert!(!faults.is_empty(), "refused without a fault");
        }
    }
    assert!(texts > 5, "only {texts} texts");
}
