//! Single changes at random places: the plan is then wrong, or it only says the same otherwise.

use std::collections::BTreeMap;

use plan_checker::{check, check_sequence};

use crate::{DELIVERY, LETTER, POST};

/// Small, repeatable chance.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        // Steele and Vigna's splitmix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) as usize % limit
    }
}

type Lines = Vec<Vec<String>>;

fn lines(plan: &str) -> Lines {
    let start = plan.find("==>").expect("there is a plan") + 3;
    let end = plan.find("<==").expect("it ends");
    let lines = plan[start..end].trim().lines();
    lines
        .map(|line| line.split_whitespace().map(str::to_owned).collect())
        .collect()
}

fn text(lines: &Lines) -> String {
    let lines: Vec<String> = lines.iter().map(|line| line.join(" ")).collect();
    format!("==>\n{}\n<==\n", lines.join("\n"))
}

fn mutated(lines: &Lines, chance: &mut Chance) -> Lines {
    let mut lines = lines.clone();
    let line = chance.below(lines.len());
    let word = chance.below(lines[line].len());
    let other_line = chance.below(lines.len());
    let other_word = chance.below(lines[other_line].len());
    match chance.below(6) {
        0 => lines.swap(line, other_line),
        1 => {
            lines.remove(line);
        }
        2 => {
            lines[line].remove(word);
        }
        3 => lines[line][word] = lines[other_line][other_word].clone(),
        4 => {
            let last = lines[line].len() - 1;
            let other = chance.below(last + 1);
            lines[line].swap(word, other);
        }
        _ => {
            let inserted = lines[other_line][other_word].clone();
            lines[line].insert(word, inserted);
        }
    }
    lines.retain(|line| !line.is_empty());
    lines
}

/// What a plan says: its actions in their order, and the tree without ids and without the order in
/// which children are listed.
fn meaning(lines: &Lines) -> (Vec<String>, String) {
    let nodes: BTreeMap<&str, &[String]> = (lines.iter())
        .map(|line| (line[0].as_str(), &line[1..]))
        .collect();
    fn tree(id: &str, nodes: &BTreeMap<&str, &[String]>) -> String {
        let words = nodes.get(id).copied().unwrap_or_default();
        let arrow = words.iter().position(|word| word == "->");
        let Some(arrow) = arrow else {
            return words.join(" ");
        };
        let mut children: Vec<String> = (words[arrow + 2..].iter())
            .map(|child| tree(child, nodes))
            .collect();
        children.sort();
        format!("{} [{}]", words[..arrow + 2].join(" "), children.join("; "))
    }
    let actions = (lines.iter())
        .filter(|line| line[0] != "root" && !line.iter().any(|word| word == "->"))
        .map(|line| line[1..].join(" "));
    let roots = nodes.get("root").copied().unwrap_or_default();
    let mut roots: Vec<String> = roots.iter().map(|id| tree(id, &nodes)).collect();
    roots.sort();
    (actions.collect(), roots.join("; "))
}

#[test]
fn a_changed_plan_is_refused_or_says_the_same() {
    let original = lines(DELIVERY);
    let mut refused = 0;
    let mut same = 0;
    for seed in 0..3000 {
        let mutant = mutated(&original, &mut Chance(seed));
        let plan = text(&mutant);
        if check(POST, LETTER, &plan).is_err() {
            refused += 1;
            assert_ne!(mutant, original, "seed {seed}: refused unchanged");
            continue;
        }
        same += 1;
        // The domain and the problem have this one plan only.
        assert_eq!(meaning(&mutant), meaning(&original), "seed {seed}: {plan}");
        assert!(check_sequence(POST, LETTER, &plan).is_ok(), "seed {seed}");
    }
    assert!(
        refused > 1000 && same > 100,
        "{refused} refused, {same} the same"
    );
}
