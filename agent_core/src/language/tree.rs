//! Nested lists of words, each with its place in the text.

use std::fmt;

use logos::Logos;

use super::error::Faults;
use super::lexer::Token;

/// Deeper than anyone writes, and shallow enough for readers that call themselves.
const MAX_DEPTH: usize = 200;

/// Where a section of a domain begins. Inside another section it betrays a missing `)`.
const SECTIONS: &[&str] = &[
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    ":method",
    ":action",
    ":objects",
    ":init",
    ":goal",
    ":htn",
    ":metric",
];

/// A word or a list.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// The byte of the text at which it begins.
    pub(super) at: usize,
    pub(super) kind: Kind,
}

/// What a [`Tree`] is.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// In lower case as a rule, as HDDL does not tell upper from lower.
    Word(String),
    /// What stands between two parentheses.
    List(Vec<Tree>),
}

impl Tree {
    pub(super) fn word(&self) -> Option<&str> {
        match &self.kind {
            Kind::Word(word) => Some(word),
            Kind::List(_) => None,
        }
    }

    pub(super) fn list(&self) -> Option<&[Tree]> {
        match &self.kind {
            Kind::Word(_) => None,
            Kind::List(items) => Some(items),
        }
    }

    /// The first word of a list: what it is about.
    pub(super) fn head(&self) -> Option<&str> {
        self.list()?.first()?.word()
    }

    fn render(&self, out: &mut String) {
        // Only for messages: enough to recognise it is enough.
        if out.len() > 60 {
            return;
        }
        match &self.kind {
            Kind::Word(word) => out.push_str(word),
            Kind::List(items) => {
                out.push('(');
                for (index, item) in items.iter().enumerate() {
                    if index > 0 {
                        out.push(' ');
                    }
                    item.render(out);
                }
                out.push(')');
            }
        }
    }
}

impl fmt::Display for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = String::new();
        self.render(&mut out);
        if out.chars().count() > 60 {
            write!(f, "{} …", out.chars().take(60).collect::<String>())
        } else {
            f.write_str(&out)
        }
    }
}

/// Reads all trees of a text, their words in lower case. What cannot be nested properly is a
/// fault.
pub(super) fn read(text: &str, faults: &mut Faults) -> Vec<Tree> {
    read_with(text, str::to_lowercase, faults)
}

/// Reads all trees of a text, their words as they are written.
pub(super) fn read_as_written(text: &str, faults: &mut Faults) -> Vec<Tree> {
    read_with(text, str::to_owned, faults)
}

fn read_with(text: &str, fold: fn(&str) -> String, faults: &mut Faults) -> Vec<Tree> {
    // The lists that are open, outermost first, and on the bottom what stands in none.
    let mut open: Vec<(usize, Vec<Tree>)> = Vec::new();
    let mut done = Vec::new();
    for (token, span) in Token::lexer(text).spanned() {
        let at = span.start;
        match token {
            Ok(Token::Open) if open.len() == MAX_DEPTH => {
                faults.add(at, format!("more than {MAX_DEPTH} parentheses deep"));
                return done;
            }
            Ok(Token::Open) => open.push((at, Vec::new())),
            Ok(Token::Close) => match open.pop() {
                Some((at, items)) => append(&mut open, &mut done, at, Kind::List(items)),
                None => faults.add(
                    at,
                    "this `)` closes nothing: remove it, or add a `(` before",
                ),
            },
            Ok(Token::Word) | Err(()) => {
                let word = text.get(span).unwrap_or_default();
                if at == 0 && word == "\u{feff}" {
                    continue; // a byte order mark
                }
                let (sign, rest) = split(word);
                if !sign.is_empty() {
                    let kind = Kind::Word(sign.to_owned());
                    append(&mut open, &mut done, at, kind);
                }
                let (at, word) = (at + sign.len(), fold(rest));
                let begins = open.last().is_some_and(|(_, items)| items.is_empty());
                if begins && open.len() > 2 && SECTIONS.contains(&word.as_str()) {
                    close_section(&mut open, &mut done, &word, faults);
                }
                append(&mut open, &mut done, at, Kind::Word(word));
            }
        }
    }
    if let Some((at, _)) = open.last() {
        faults.add(*at, "this `(` is never closed: add a `)`");
    }
    while let Some((at, items)) = open.pop() {
        append(&mut open, &mut done, at, Kind::List(items));
    }
    done
}

/// Some write `(?x -room)` and `(=?x ?y)`: a sign before a name or a variable is a word of its own.
fn split(word: &str) -> (&str, &str) {
    match word.as_bytes() {
        [b'-' | b'=' | b'<', next, ..] if next.is_ascii_alphabetic() || *next == b'?' => {
            word.split_at(1)
        }
        _ => ("", word),
    }
}

fn append(open: &mut [(usize, Vec<Tree>)], done: &mut Vec<Tree>, at: usize, kind: Kind) {
    let tree = Tree { at, kind };
    match open.last_mut() {
        Some((_, items)) => items.push(tree),
        None => done.push(tree),
    }
}

/// Closes the section that is still open where `word` begins the next one.
fn close_section(
    open: &mut Vec<(usize, Vec<Tree>)>,
    done: &mut Vec<Tree>,
    word: &str,
    faults: &mut Faults,
) {
    let Some(next) = open.pop() else { return };
    if let Some((at, _)) = open.get(1) {
        faults.add(
            *at,
            format!("this section is not closed before the next `({word}` begins: add a `)`"),
        );
    }
    while open.len() > 1 {
        if let Some((at, items)) = open.pop() {
            append(open, done, at, Kind::List(items));
        }
    }
    open.push(next);
}
