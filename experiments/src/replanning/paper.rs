//! What the paper has measured: its Tables 1, 2 and 3.

/// A row of the paper's tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperRow {
    /// Where the robot stands at first, and in which area.
    pub start: (&'static str, &'static str),
    /// Where it is to go.
    pub goal: (&'static str, &'static str),
    /// The arc on which it is interrupted.
    pub interruption: (&'static str, &'static str),
    /// Where it has to go meanwhile.
    pub emergency: (&'static str, &'static str),
    /// Whether the parent has to correct its plan.
    pub is_revised: bool,
    /// Seconds, online and naive: those of the parent, of the child, and of both.
    pub seconds: [[f64; 2]; 3],
}

/// What the paper's seconds were measured on.
pub const PAPER_MACHINE: &str =
    "Pentium 4 2.8 GHz, 512 MB, Windows XP; agents in Java, planner in Prolog and Java";

const FROM_FAR: PaperRow = PaperRow {
    start: ("n40", "area8"),
    goal: ("n1", "area1"),
    interruption: ("arc59", "area8"),
    emergency: ("n38", "area8"),
    is_revised: false,
    seconds: [[0.01, 0.37], [0.06, 0.15], [0.06, 0.52]],
};

const FROM_ENTRANCE: PaperRow = PaperRow {
    start: ("n1", "area1"),
    goal: ("n40", "area8"),
    interruption: ("arc5", "area1"),
    emergency: ("n13", "area2"),
    is_revised: true,
    seconds: [[0.24, 0.50], [0.05, 0.06], [0.29, 0.56]],
};

/// The rows, in the paper's order.
pub const PAPER_ROWS: [PaperRow; 6] = [
    FROM_FAR,
    PaperRow {
        emergency: ("n28", "area4"),
        is_revised: true,
        seconds: [[0.13, 0.30], [0.09, 0.11], [0.22, 0.41]],
        ..FROM_FAR
    },
    PaperRow {
        emergency: ("n29", "area7"),
        seconds: [[0.01, 0.30], [0.05, 0.05], [0.05, 0.35]],
        ..FROM_FAR
    },
    FROM_ENTRANCE,
    PaperRow {
        emergency: ("n4", "area1"),
        is_revised: false,
        seconds: [[0.01, 0.36], [0.03, 0.08], [0.04, 0.44]],
        ..FROM_ENTRANCE
    },
    PaperRow {
        emergency: ("n12", "area3"),
        is_revised: false,
        seconds: [[0.01, 0.31], [0.06, 0.07], [0.07, 0.38]],
        ..FROM_ENTRANCE
    },
];
