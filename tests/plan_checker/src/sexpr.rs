//! Expressions in parentheses, as HDDL is written. Names are alike whatever their case.

use crate::fault::{Fault, Kind};

/// So that neither reading nor dropping an expression can exhaust the stack.
const DEEPEST: usize = 200;

/// A word, or a list of expressions, with the line that it begins on.
#[derive(Debug)]
pub(crate) enum Sexpr {
    Word(String, usize),
    List(Vec<Sexpr>, usize),
}

impl Sexpr {
    pub(crate) fn line(&self) -> usize {
        match self {
            Self::Word(_, line) | Self::List(_, line) => *line,
        }
    }

    pub(crate) fn list(&self) -> Option<&[Self]> {
        match self {
            Self::List(items, _) => Some(items),
            Self::Word(..) => None,
        }
    }

    pub(crate) fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word, _) => Some(word),
            Self::List(..) => None,
        }
    }

    /// The word that a list begins with.
    pub(crate) fn head(&self) -> Option<&str> {
        self.list()?.first()?.word()
    }

    pub(crate) fn expect_list(&self, what: &str) -> Result<&[Self], Fault> {
        self.list()
            .ok_or_else(|| self.fault(format_args!("expected {what} in parentheses")))
    }

    pub(crate) fn expect_word(&self, what: &str) -> Result<&str, Fault> {
        self.word()
            .ok_or_else(|| self.fault(format_args!("expected {what}")))
    }

    pub(crate) fn fault(&self, what: impl std::fmt::Display) -> Fault {
        let line = self.line();
        Fault::new(Kind::Unjudgeable, format!("line {line}: {what}"))
    }
}

/// Reads the one expression that a file consists of. `file` is what to call it in faults.
pub(crate) fn read(text: &str, file: &str) -> Result<Sexpr, Fault> {
    let fault = |line: usize, what: &str| {
        Fault::new(Kind::Unjudgeable, format!("{file}, line {line}: {what}"))
    };
    let mut open: Vec<(Vec<Sexpr>, usize)> = Vec::new();
    let mut whole = None;
    for (index, text) in text.lines().enumerate() {
        let line = index + 1;
        let text = text.split(';').next().unwrap_or_default();
        for token in tokens(text) {
            if whole.is_some() {
                return Err(fault(line, "text after the end of the definition"));
            }
            let done = match token {
                "(" => {
                    if open.len() == DEEPEST {
                        return Err(fault(line, "parentheses nested too deeply"));
                    }
                    open.push((Vec::new(), line));
                    continue;
                }
                ")" => match open.pop() {
                    Some((items, line)) => Sexpr::List(items, line),
                    None => return Err(fault(line, "`)` without `(`")),
                },
                word => Sexpr::Word(word.to_ascii_lowercase(), line),
            };
            match open.last_mut() {
                Some((items, _)) => items.push(done),
                None => whole = Some(done),
            }
        }
    }
    match (whole, open.last()) {
        (Some(whole), _) => Ok(whole),
        (None, Some((_, line))) => Err(fault(*line, "`(` without `)`")),
        (None, None) => Err(fault(1, "nothing in it")),
    }
}

fn tokens(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        rest = rest.trim_start();
        let first = rest.chars().next()?;
        let end = if matches!(first, '(' | ')') {
            1
        } else {
            rest.find(|c: char| c.is_whitespace() || matches!(c, '(' | ')'))
                .unwrap_or(rest.len())
        };
        let (token, after) = rest.split_at(end);
        rest = after;
        Some(token)
    })
}
