//! What the experiment on replanning says, as far as it does not depend on the machine.
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed"
)]

use std::collections::BTreeMap;

use experiments::{Cell, Report, Table, replanning};

fn report() -> Report {
    replanning(2, &mut ()).unwrap()
}

fn table<'a>(report: &'a Report, name: &str) -> &'a Table {
    report
        .tables
        .iter()
        .find(|table| table.name == name)
        .unwrap()
}

/// The rows by the names of their columns.
fn rows(table: &Table) -> Vec<BTreeMap<&str, &Cell>> {
    let named = |row: &'_ Vec<Cell>| -> BTreeMap<&str, usize> {
        let names = table.columns.iter().map(String::as_str);
        names.zip(0..row.len()).collect()
    };
    let rows = table.rows.iter();
    rows.map(|row| {
        let places = named(row);
        places
            .into_iter()
            .map(|(name, at)| (name, &row[at]))
            .collect()
    })
    .collect()
}

fn count(cell: &Cell) -> u64 {
    match cell {
        Cell::Count(count) => *count,
        other => panic!("{other:?} was not counted"),
    }
}

fn text(cell: &Cell) -> &str {
    match cell {
        Cell::Text(text) => text,
        other => panic!("{other:?} is no text"),
    }
}

#[test]
fn the_figures_have_the_columns_that_were_promised_and_a_row_for_each_level_and_planner() {
    let report = report();
    let csv = table(&report, "replanning").csv();
    let mut lines = csv.lines();
    assert_eq!(
        lines.next(),
        Some(
            "row,start,goal,interruption,emergency,level,planner,median_us,p10_us,p90_us,upkeep_us,expanded,evaluated"
        )
    );
    assert_eq!(lines.count(), 36);
}

#[test]
fn every_row_keeps_or_revises_the_parent_s_plan_as_the_paper_s_does() {
    let report = report();
    let verdicts: Vec<(&str, &str)> = rows(table(&report, "replanning_ratios"))
        .iter()
        .filter(|row| text(row["level"]) == "parent")
        .map(|row| (text(row["emergency"]), text(row["plan"])))
        .collect();
    let expected = [
        ("n38", "kept"),
        ("n28", "revised"),
        ("n29", "kept"),
        ("n13", "revised"),
        ("n4", "kept"),
        ("n12", "kept"),
    ];
    assert_eq!(verdicts, expected);
}

#[test]
fn online_never_expands_more_than_naive_to_resume() {
    let report = report();
    let rows = rows(table(&report, "replanning"));
    for pair in rows.chunks_exact(2) {
        assert_eq!(
            [text(pair[0]["planner"]), text(pair[1]["planner"])],
            ["online", "naive"]
        );
        let [online, naive] = [0, 1].map(|planner| count(pair[planner]["expanded"]));
        assert!(online <= naive, "{:?}", pair[0]);
        assert!(naive > 0, "{:?}", pair[1]);
    }
}

#[test]
fn online_drives_as_far_as_naive_and_farther_where_a_door_on_the_way_has_closed() {
    let report = report();
    let routes = rows(table(&report, "routes"));
    let length_m = |planner: &str, emergency: &str, is_closed: bool| {
        let mut routes = routes.iter().filter(|row| {
            text(row["planner"]) == planner
                && text(row["emergency"]) == emergency
                && (*row["closes"] != Cell::Empty) == is_closed
        });
        match routes.next().unwrap()["route_m"] {
            Cell::Measure(length_m) => *length_m,
            other => panic!("{other:?} is no length"),
        }
    };
    for emergency in ["n38", "n28", "n29", "n13", "n4", "n12"] {
        for is_closed in [false, true] {
            let [online, naive] =
                ["online", "naive"].map(|planner| length_m(planner, emergency, is_closed));
            assert!(
                (online - naive).abs() < 1e-9,
                "{emergency}: {online} m, {naive} m"
            );
        }
        let [open, closed] =
            [false, true].map(|is_closed| length_m("online", emergency, is_closed));
        assert!(closed > open, "{emergency}: {closed} m, {open} m");
    }
    // As in the map: n28, n26, n16, n14, n7, n5, n1.
    assert!((length_m("online", "n28", false) - 30.642).abs() < 1e-9);
}

#[test]
fn a_door_that_closes_has_its_figures_in_a_table_of_its_own() {
    let report = report();
    let figures = rows(table(&report, "doors"));
    assert_eq!(figures.len(), 6 * 3 * 2);
    assert!(
        figures
            .iter()
            .all(|row| text(row["closes"]).starts_with("door"))
    );
}
