//! The second paper's two cases: not only their totals but what is done in them.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use experiments::{Case, Cell, PAPER_WAITS_S, RATIO_BAND, Restaurants, both_cases, restaurant};

/// What a vehicle did after the second guest had sat down, without names of bottles, slots and ways.
fn plan(case: &Case, vehicle: &str) -> Vec<String> {
    let deeds = case.course.deeds_of(vehicle).into_iter();
    let words = deeds.map(|deed| {
        let args: Vec<&str> = deed.action.args.iter().map(|arg| arg.as_str()).collect();
        let args = match (deed.action.name.as_str(), args.as_slice()) {
            ("move", [from, to, ..]) => format!("{from} {to}"),
            ("grasp" | "put-on-tray" | "take-from-tray", [bottle, ..]) => (*bottle).to_owned(),
            ("put-drink", [_, kind, guest, ..]) => format!("{kind} {guest}"),
            (_, [guest, ..]) => (*guest).to_owned(),
            (_, []) => String::new(),
        };
        format!("{} {args}", deed.action.name)
    });
    words.collect()
}

fn cases() -> [Case; 2] {
    both_cases(None).expect("both guests are served")
}

#[test]
fn networked_and_in_parallel_both_drinks_are_fetched_before_one_round_to_both_tables() {
    let [networked, _] = cases();
    assert_eq!(
        plan(&networked, "k3"),
        [
            "grasp drink-a1",
            "put-on-tray drink-a1",
            "grasp drink-b1",
            "put-on-tray drink-b1",
            "move kitchen table1",
            "take-from-tray drink-a1",
            "put-drink drink-a cc",
            "move table1 table2",
            "take-from-tray drink-b1",
            "put-drink drink-b lzh1",
        ]
    );
    assert_eq!(plan(&networked, "k2"), ["recognise lzh1", "ask lzh1"]);
}

#[test]
fn alone_and_one_after_the_other_the_second_drink_takes_a_trip_of_its_own() {
    let [_, alone] = cases();
    assert_eq!(
        plan(&alone, "k3"),
        [
            "grasp drink-a1",
            "put-on-tray drink-a1",
            "move kitchen table1",
            "take-from-tray drink-a1",
            "put-drink drink-a cc",
            "move table1 table2",
            "detect lzh1",
            "ask lzh1",
            "move table2 kitchen",
            "grasp drink-b1",
            "put-on-tray drink-b1",
            "move kitchen table2",
            "take-from-tray drink-b1",
            "put-drink drink-b lzh1",
        ]
    );
}

#[test]
fn the_second_guest_waits_as_long_as_in_the_paper_and_the_first_45_s_more_in_parallel() {
    let [networked, alone] = cases();
    let waited = [networked.second_waited_s, alone.second_waited_s];
    for (waited_s, paper_s) in waited.into_iter().zip(PAPER_WAITS_S) {
        assert!(
            (waited_s - paper_s).abs() < 1e-3,
            "{waited_s} for {paper_s}"
        );
    }
    let more_s = networked.first_waited_s - alone.first_waited_s;
    assert!((more_s - 45.0).abs() < 1e-3, "{more_s}");
}

#[test]
fn with_every_duration_varied_the_ratio_stays_in_its_band() {
    for seed in 0..30 {
        let [networked, alone] = both_cases(Some(seed)).expect("both guests are served");
        let ratio = networked.second_waited_s / alone.second_waited_s;
        let [least, most] = RATIO_BAND;
        assert!((least..=most).contains(&ratio), "seed {seed}: {ratio}");
    }
}

#[test]
fn everybody_is_served_in_small_evenings_and_the_report_says_how_soon() {
    let what = Restaurants {
        runs: 1,
        guests: vec![2, 5],
        carriers: vec![1, 2],
        evenings: 1,
        seed: 7,
    };
    let report = restaurant(&what, &mut ()).expect("everybody is served");
    let names: Vec<&str> = report
        .tables
        .iter()
        .map(|table| table.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "restaurant",
            "restaurant_ratio",
            "restaurant_evenings",
            "restaurant_plans"
        ]
    );
    assert_eq!(report.tables[2].rows.len(), 8);
}

#[test]
fn nothing_fails_where_one_carrier_serves_and_nobody_disturbs_it() {
    let what = Restaurants {
        runs: 1,
        guests: vec![10],
        carriers: vec![1],
        evenings: 3,
        seed: 1,
    };
    let report = restaurant(&what, &mut ()).expect("everybody is served");
    let evenings = &report.tables[2];
    for row in &evenings.rows {
        assert_eq!(row.last(), Some(&Cell::Count(0)), "{row:?}");
    }
}
