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
    let _ = parse_domain_strictly(text);
    let _ = parse_problem(text, &domain);
    let _ = Spelling::of(&[text]);
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

/// What must not take long, nor much memory, nor the stack: each text is small, and what it means
/// naively is not.
#[test]
fn a_little_text_is_never_a_lot_of_work() {
    let domain = |sections: &str| format!("(define (domain d) {sections})");
    let numbered = |prefix: &str, count: usize| -> String {
        (0..count)
            .map(|index| format!(" {prefix}{index}"))
            .collect()
    };
    let tower: String = (1..20_000)
        .map(|index| format!(" k{index} - k{}", index - 1))
        .collect();
    let in_circle = format!("{tower} k0 - k19999");
    let facts = "(p) ".repeat(4_000);
    let deep = |word: &str, depth: usize| {
        format!(
            "{}(p){}",
            format!("({word} ").repeat(depth),
            ")".repeat(depth)
        )
    };
    let action = |precondition: &str, effect: &str| {
        domain(&format!(
            "(:predicates (p)) (:functions (total-cost)) \
             (:action a :precondition {precondition} :effect {effect})"
        ))
    };
    let texts = [
        domain(&format!("(:types{tower})")),
        domain(&format!("(:types{in_circle})")),
        domain(&format!("(:types{} - a)", numbered("k", 20_000))),
        domain(&format!(
            "(:predicates (p{} - (either{})))",
            numbered("?v", 5_000),
            numbered("k", 5_000)
        )),
        domain(&format!("(:predicates (p{}))", numbered("?v", 50_000))),
        action("()", &format!("(when (and {facts}) (and {facts}))")),
        action(
            "()",
            &format!("(forall ({}) (and {facts}))", numbered("?v", 4_000)),
        ),
        action(&deep("not", 150), "()"),
        action(&deep("or", 150), "()"),
        action(&deep("imply (p)", 150), "()"),
        action(&deep("exists (?x)", 150), "()"),
        action("()", &deep("when (p)", 150)),
        action("()", &deep("forall (?x)", 150)),
        action(
            "()",
            &format!(
                "(increase (total-cost) {})",
                deep("+ 1", 150).replace("(p)", "1")
            ),
        ),
        action(&deep("not", 100_000), "()"),
        action(&"(q) ".repeat(20_000), &"(q) ".repeat(20_000)),
        domain(&"(:method m :task (t))".repeat(10_000)),
        domain(&format!(
            "(:task t :parameters ()) (:method m :task (t) :subtasks (and{}) :ordering (and{}))",
            (0..10_000)
                .map(|index| format!(" (i{index} (t))"))
                .collect::<String>(),
            (1..10_000)
                .map(|index| format!(" (< i{} i{index})", index - 1))
                .collect::<String>(),
        )),
    ];
    for text in texts {
        match parse_domain(&text) {
            // What was read can be dropped, copied, compared and written as well.
            Ok(domain) => {
                let again = parse_domain(&write_domain(&domain)).ok();
                assert!(again == Some(domain), "{text}");
            }
            Err(errors) => {
                let shown = report("f", &text, &errors);
                assert!(shown.len() < 20_000, "{} bytes for {errors:?}", shown.len());
            }
        }
    }
}
