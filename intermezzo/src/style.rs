//! Colours, each with one meaning. They are left out where they would not be seen as such.

use anstyle::{AnsiColor, Style};

/// Something failed.
pub(crate) const BAD: Style = AnsiColor::Red.on_default().bold();
/// Something was reached.
pub(crate) const GOOD: Style = AnsiColor::Green.on_default().bold();
/// What to do about it.
pub(crate) const ADVICE: Style = AnsiColor::Cyan.on_default();
/// A goal that interrupts.
pub(crate) const URGENT: Style = AnsiColor::Red.on_default();
/// Something was set aside, or stands in the way.
pub(crate) const ASIDE: Style = AnsiColor::Yellow.on_default();
/// Something was taken up again.
pub(crate) const AGAIN: Style = AnsiColor::Cyan.on_default();
/// Of less importance.
pub(crate) const DIM: Style = Style::new().dimmed();
/// Headings, and what people say.
pub(crate) const BOLD: Style = Style::new().bold();
