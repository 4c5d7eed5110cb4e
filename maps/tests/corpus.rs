//! Every execution model and every map that fuzzing has kept is read again.
#![expect(
    clippy::print_stderr,
    reason = "says which text it was that went wrong"
)]

use std::fs;
use std::path::Path;

#[path = "../../fuzz/targets/level.rs"]
#[allow(dead_code, reason = "problems are for plans")]
mod level;

#[test]
fn every_execution_model_of_the_corpus_is_read_or_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/model");
    let mut texts = 0;
    for entry in fs::read_dir(folder).expect("the corpus is there") {
        let path = entry.expect("it can be read").path();
        eprintln!("{}", path.display());
        let bytes = fs::read(&path).expect("it can be read");
        let text = String::from_utf8_lossy(&bytes);
        texts += 1;
        let names = ["lamps.hddl", "lamps.toml"];
        if let Err(findings) = maps::level_from_texts(level::LEVEL, &text, names) {
            assert!(!findings.is_empty(), "refused without a finding");
        }
    }
    assert!(texts > 5, "only {texts} texts");
}

#[test]
fn every_map_of_the_corpus_is_read_or_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/map");
    let (mut texts, mut in_order) = (0, 0);
    for entry in fs::read_dir(folder).expect("the corpus is there") {
        let path = entry.expect("it can be read").path();
        eprintln!("{}", path.display());
        let bytes = fs::read(&path).expect("it can be read");
        texts += 1;
        match maps::Site::from_text("map.geojson", &String::from_utf8_lossy(&bytes)) {
            Ok(site) => {
                in_order += 1;
                let _ = maps::area_level(&site);
            }
            Err(findings) => assert!(!findings.is_empty(), "refused without a finding"),
        }
    }
    assert!(texts > 5 && in_order > 0, "{in_order} of {texts} in order");
}
