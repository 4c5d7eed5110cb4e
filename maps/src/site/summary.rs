//! A map in one line.

use std::fmt;

use super::Site;

/// How much there is on a map.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Summary {
    /// Nodes.
    pub nodes: usize,
    /// Passages, each counted once, whichever ways it can be taken.
    pub passages: usize,
    /// Those that can be taken one way only.
    pub one_way: usize,
    /// Doors.
    pub doors: usize,
    /// Those that stand closed when the world begins.
    pub closed: usize,
    /// Areas.
    pub areas: usize,
}

impl Summary {
    pub(super) fn of(site: &Site) -> Self {
        Self {
            nodes: site.nodes().count(),
            passages: site.passages().count(),
            one_way: site.passages().filter(|one| one.is_one_way()).count(),
            doors: site.doors().count(),
            closed: site.doors().filter(|one| !one.is_open_at_first()).count(),
            areas: site.areas().count(),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, {}",
            count(self.areas, "area"),
            count(self.nodes, "node")
        )?;
        write!(f, ", {}", count(self.passages, "passage"))?;
        if self.one_way > 0 {
            write!(f, " ({} one-way)", self.one_way)?;
        }
        write!(f, ", {}", count(self.doors, "door"))?;
        if self.closed > 0 {
            write!(f, " ({} closed)", self.closed)?;
        }
        Ok(())
    }
}

fn count(number: usize, what: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {what}{plural}")
}
