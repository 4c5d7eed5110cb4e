//! Whatever the text, the reader answers.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use proptest::prelude::*;

use super::tests::{AREA, NODE};
use super::*;
use crate::model::Domain;

fn read_everything(text: &str) {
    let domain = Domain::default();
    let parameters = ["?a", "?x - room"].map(|text| parse_parameter(text).unwrap());
    let _ = parse_domain(text);
    let _ = parse_atom(text);
    let _ = parse_tasks(text);
    let _ = parse_fact_change(text);
    let _ = parse_parameter(text);
    let _ = parse_pattern(text, &parameters);
    let _ = parse_literal(text, &parameters);
    let _ = parse_effects(&[text], &parameters, &domain);
    let _ = parse_number(text, &parameters);
}

/// A piece of the language, so that texts of them get further than texts of letters.
fn piece() -> impl Strategy<Value = String> {
    let pieces = "( ) (define (domain (:action (:method (:types :parameters :effect :task :ordering \
        ?a ?x - at pass and not forall = < increase (total-cost) + / 0 1e9 room object ; é";
    prop::sample::select(
        pieces
            .split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>(),
    )
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in any::<String>()) {
        read_everything(&text);
    }

    #[test]
    fn no_heap_of_words_makes_the_reader_panic(words in prop::collection::vec(piece(), 0..60)) {
        read_everything(&words.join(" "));
    }

    #[test]
    fn no_damage_to_a_domain_makes_the_reader_panic(
        which in any::<bool>(),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0usize..40, piece()), 1..6),
    ) {
        let mut text = if which { AREA } else { NODE }.to_owned();
        for (place, length, replacement) in cuts {
            let boundary = |mut at: usize, text: &str| {
                while !text.is_char_boundary(at) {
                    at -= 1;
                }
                at
            };
            let from = boundary(place.index(text.len()), &text);
            let to = boundary((from + length).min(text.len()), &text).max(from);
            text.replace_range(from..to, &replacement);
        }
        read_everything(&text);
    }
}
