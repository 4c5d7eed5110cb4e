//! Plans as text, in the format of the International Planning Competition of 2020.

use std::io::{self, Write};

use super::{NodeId, Solution};
use crate::compile::Step;

impl Solution {
    /// Writes `==>`, the actions, the roots, the tasks with their methods, `<==`.
    ///
    /// Actions are numbered from zero in the order of execution, tasks after them. What is
    /// artificial in the compiled problem is left out. Give it a writer with a buffer.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let numbers = self.numbers();
        let mut line = Line::default();
        out.write_all(b"==>\n")?;
        for id in self.actions() {
            line.number(numbers[id.0 as usize]);
            self.atom_to(*id, &mut line);
            line.end(out)?;
        }
        line.text("root");
        for id in self.roots() {
            line.blank().number(numbers[id.0 as usize]);
        }
        line.end(out)?;
        for id in self.tasks() {
            line.number(numbers[id.0 as usize]);
            self.atom_to(id, &mut line);
            line.text(" -> ");
            line.text(self.method_name(id).map_or("", |name| name.as_str()));
            for child in self.children(id) {
                line.blank().number(numbers[child.0 as usize]);
            }
            line.end(out)?;
        }
        out.write_all(b"<==\n")
    }

    /// All tasks, outer ones first.
    fn tasks(&self) -> impl Iterator<Item = NodeId> {
        let ids = (0..u32::try_from(self.places()).unwrap_or(u32::MAX)).map(NodeId);
        ids.filter(|id| matches!(self.node(*id).step, Step::Task(_)))
            // The top of all is ours.
            .skip(1)
    }

    fn numbers(&self) -> Vec<u32> {
        let mut numbers = vec![0; self.places()];
        for (number, id) in (0..).zip(self.actions().iter().copied().chain(self.tasks())) {
            numbers[id.0 as usize] = number;
        }
        numbers
    }

    fn atom_to(&self, id: NodeId, line: &mut Line) {
        line.blank().text(self.name(id).as_str());
        for object in self.arguments(id) {
            line.blank().text(self.object(*object).as_str());
        }
    }
}

/// A line in the making; much faster than formatting, and there may be millions.
#[derive(Default)]
struct Line {
    bytes: Vec<u8>,
    digits: itoa::Buffer,
}

impl Line {
    fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    fn number(&mut self, number: u32) {
        self.bytes
            .extend_from_slice(self.digits.format(number).as_bytes());
    }

    fn blank(&mut self) -> &mut Self {
        self.bytes.push(b' ');
        self
    }

    fn end(&mut self, out: &mut impl Write) -> io::Result<()> {
        self.bytes.push(b'\n');
        out.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }
}
