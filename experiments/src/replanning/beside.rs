//! What is not in the paper's tables: the same interruptions with a door that closes meanwhile, and how
//! far the robot drives afterwards.

use agent_core::model::{Fact, FactChange};

use super::{COLUMNS, PLANNERS, Row, lines};
use crate::{Cell, Table};

/// For each of the paper's rows, a door on the shortest way from the emergency's place to the goal.
pub(super) const CLOSES: [&str; 6] = [
    "door3_5", "door2_4", "door3_5", "door4_6", "door3_5", "door3_5",
];

/// A door is closed.
pub(super) fn closing(door: &str) -> FactChange {
    FactChange::Remove(Fact::new("open", [door]))
}

/// The figures of rows in which a door closes.
pub(super) fn doors(rows: &[Row]) -> Table {
    let title = "The same, and a door on the way closes when the emergency comes";
    let columns = COLUMNS.into_iter().chain(["closes"]);
    let mut table = Table::new("doors", title, columns.collect::<Vec<_>>());
    for (row, mut cells) in lines(rows) {
        cells.push(row.closes.into());
        table.push(cells);
    }
    table
}

/// How far it is from where the emergency has ended, as the robot goes.
pub(super) fn routes(rows: &[Row]) -> Table {
    let mut table = Table::new(
        "routes",
        "Metres from the emergency's place to the goal",
        [
            "start",
            "goal",
            "interruption",
            "emergency",
            "closes",
            "planner",
            "route_m",
        ],
    );
    for row in rows {
        for (planner, (name, _)) in PLANNERS.into_iter().enumerate() {
            let mut cells: Vec<Cell> = row.words().into();
            cells.extend([row.closes.into(), name.into(), row.route_m[planner].into()]);
            table.push(cells);
        }
    }
    table
}
