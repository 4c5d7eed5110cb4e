//! The plans for a goal as a table, with what each hangs on, and in words why one is followed.

use std::fmt::Write;

use comfy_table::{CellAlignment, Table};
use serde_json::Value;

use super::people::{rows, width};
use crate::style::{ADVICE, BAD, DIM, GOOD};

/// What stands left of a table.
const INDENT: usize = 9;
/// What a table needs beside its two broad columns.
const NARROW_COLUMNS: usize = 26;
/// Columns are not made narrower than this, whatever the screen.
const NARROWEST: usize = 24;
/// Of longer plans and lists the rest is counted.
const SHOWN: usize = 14;

/// The alternatives of one goal, as an agent has answered, for people. Nothing if there is nothing to
/// tell.
pub(crate) fn alternatives(goal: &Value) -> String {
    let mut text = String::new();
    let plans = list(&goal["plans"]);
    if !plans.is_empty() {
        for row in table(plans).lines() {
            // Colours come last: a table counts characters.
            let row = row
                .replace('▶', &format!("{GOOD}▶{GOOD:#}"))
                .replace('✗', &format!("{BAD}✗{BAD:#}"));
            let _ = writeln!(text, "{:INDENT$}{row}", "");
        }
    }
    let mut remarks: Vec<(String, _)> = Vec::new();
    if let Some(because) = because(goal) {
        remarks.push((because, DIM));
    }
    if let Some(better) = better(goal) {
        remarks.push((better, ADVICE));
    }
    if goal["complete"] == false && !goal["place"].is_null() {
        let words = "not everything was looked at: there may be more and better plans";
        remarks.push((words.to_owned(), DIM));
    }
    for (words, style) in remarks {
        for row in rows(&words, width().saturating_sub(INDENT + 2).max(NARROWEST)) {
            let _ = writeln!(text, "{:INDENT$}  {style}{row}{style:#}", "");
        }
    }
    text
}

fn table(plans: &[Value]) -> Table {
    let broad = width().saturating_sub(INDENT + NARROW_COLUMNS);
    let plan_width = (broad * 3 / 5).max(NARROWEST);
    let hangs_width = (broad * 2 / 5).max(NARROWEST);
    let mut table = Table::new();
    table.load_style(comfy_table::presets::UTF8_FULL_CONDENSED);
    table.set_header(["", "cost", "more", "plan", "hangs on"]);
    let first = cost(&plans[0]);
    for (index, plan) in plans.iter().enumerate() {
        let holds = plan["holds"] == true;
        let sign = match (index, holds) {
            (_, false) => "✗",
            (0, true) => "▶",
            _ => "",
        };
        let more = match index {
            0 => String::new(),
            _ => format!("{:+.1}", cost(plan) - first),
        };
        let mut what = rows(&steps(plan), plan_width);
        if let Some(why) = plan["why_not"].as_str() {
            what.extend(rows(&format!("✗ {why}"), plan_width));
        }
        table.add_row([
            sign,
            &format!("{:.1}", cost(plan)),
            &more,
            &what.join("\n"),
            &rows(&hangs_on(plan), hangs_width).join("\n"),
        ]);
    }
    for column in [1, 2] {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn steps(plan: &Value) -> String {
    let all: Vec<&str> = [&plan["steps"], &plan["rest"]]
        .into_iter()
        .flat_map(list)
        .filter_map(Value::as_str)
        .collect();
    match all.is_empty() {
        true => "nothing is left to do".to_owned(),
        false => counted(&all),
    }
}

/// What others can change first: that is what people can do something about.
fn hangs_on(plan: &Value) -> String {
    let (alone, own): (Vec<&Value>, Vec<&Value>) = list(&plan["hangs_on"])
        .iter()
        .partition(|reliance| reliance["changes_alone"] == true);
    let words: Vec<String> = (alone.into_iter().chain(own))
        .filter_map(|reliance| {
            let missing = if reliance["holds"] == true {
                ""
            } else {
                "✗ "
            };
            Some(format!("{missing}{}", reliance["condition"].as_str()?))
        })
        .collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.is_empty() {
        true => "nothing".to_owned(),
        false => counted(&words),
    }
}

fn counted(words: &[&str]) -> String {
    match words.len().checked_sub(SHOWN) {
        // One more takes no more room than to say so.
        Some(left) if left > 1 => format!("{} and {left} more", words[..SHOWN].join(" ")),
        _ => words.join(" "),
    }
}

/// Why the first plan is the one that is followed.
fn because(goal: &Value) -> Option<String> {
    let choice = &goal["choice"];
    let by = choice["by"].as_f64().unwrap_or_default();
    let against = choice["against_others"].as_str()?;
    let running = goal["place"] == "running";
    if goal["plans"][0]["holds"] == false {
        let when = match running {
            true => "at the next choice",
            false => "when its turn comes",
        };
        return Some(format!(
            "the first no longer holds; {when}, the cheapest that does is followed"
        ));
    }
    let against = match against {
        "no_other" => "no other is known".to_owned(),
        "less" => format!("it costs {by:.1} less than the next"),
        "same" => "the next costs the same, and nothing changes without a reason".to_owned(),
        "more" => format!("another costs {by:.1} less by now, but it is not time to choose again"),
        _ => return None,
    };
    let first = match (choice["resumes"].as_str(), choice["undoes"].as_str()) {
        (Some(action), _) => format!("it takes up {action} where that was stopped; "),
        (_, Some(action)) => format!("it first undoes what is half done, by {action}; "),
        _ => String::new(),
    };
    let verb = if running { "follows" } else { "keeps" };
    Some(format!("{verb} the first: {first}{against}"))
}

/// What it would take for a better plan.
fn better(goal: &Value) -> Option<String> {
    let what_if = &goal["what_if"];
    let changes: Vec<&str> = list(&what_if["changes"])
        .iter()
        .filter_map(Value::as_str)
        .collect();
    if changes.is_empty() {
        return None;
    }
    let cheapest = list(&goal["plans"])
        .iter()
        .filter(|plan| plan["holds"] == true)
        .map(cost)
        .min_by(f64::total_cmp);
    let gain = match cheapest {
        Some(cheapest) => format!("{:.1} less", cheapest - cost(what_if)),
        None => "possible".to_owned(),
    };
    Some(format!(
        "{gain} with {}: cost {:.1}, {}",
        counted(&changes),
        cost(what_if),
        steps(what_if)
    ))
}

fn cost(plan: &Value) -> f64 {
    plan["cost"].as_f64().unwrap_or_default()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn told(goal: &Value) -> String {
        let text = anstream::adapter::strip_str(&alternatives(goal)).to_string();
        // Wherever lines are broken.
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    fn goal() -> Value {
        json!({
            "id": "tour", "place": "running", "complete": true,
            "plans": [
                { "steps": ["(enter a b d1)", "(approach n4 b)"], "rest": [], "cost": 20.0,
                  "kept": true, "holds": true, "why_not": null,
                  "hangs_on": [
                    { "condition": "(in a)", "holds": true, "changes_alone": false, "step": 0 },
                    { "condition": "(open d1)", "holds": true, "changes_alone": true, "step": 0 }] },
                { "steps": ["(enter a c d2)"], "rest": [], "cost": 27.5, "kept": false,
                  "holds": false, "why_not": "(open d2) does not hold", "hangs_on": [
                    { "condition": "(open d2)", "holds": false, "changes_alone": true, "step": 0 }] }],
            "choice": { "against_others": "less", "by": 7.5, "resumes": null, "undoes": null },
            "what_if": { "changes": ["(open d3)"], "steps": ["(enter a b d3)"], "cost": 12.0 },
        })
    }

    #[test]
    fn a_plan_is_shown_with_what_it_hangs_on_and_what_others_can_change_first() {
        let told = told(&goal());
        assert!(told.contains("▶"), "{told}");
        assert!(told.contains("(open d1) (in a)"), "{told}");
        assert!(told.contains("+7.5"), "{told}");
        assert!(told.contains("✗ (open d2)"), "{told}");
    }

    #[test]
    fn it_says_why_and_what_it_would_take_for_a_better_one() {
        let told = told(&goal());
        assert!(told.contains("it costs 7.5 less than the next"), "{told}");
        assert!(
            told.contains("8.0 less with (open d3): cost 12.0"),
            "{told}"
        );
    }

    #[test]
    fn a_plan_that_takes_up_an_action_says_so() {
        let mut goal = goal();
        goal["choice"]["resumes"] = json!("(enter a b d1)");
        goal["choice"]["against_others"] = json!("same");
        let told = told(&goal);
        assert!(told.contains("takes up (enter a b d1)"), "{told}");
        assert!(told.contains("nothing changes without a reason"), "{told}");
    }

    #[test]
    fn long_plans_are_counted_and_nothing_is_not_shown() {
        let words = ["x"; 40];
        assert!(counted(&words).ends_with("and 26 more"));
        assert_eq!(alternatives(&json!({ "plans": [], "complete": true })), "");
    }
}
