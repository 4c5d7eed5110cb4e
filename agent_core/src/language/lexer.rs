//! Parentheses and words.

use logos::Logos;

/// What the text is made of. Every text can be cut into these: whether a word is a name is asked
/// where a name is expected, since only there can the answer be explained.
#[derive(Logos, Clone, Copy, Debug, Eq, PartialEq)]
#[logos(skip r"\s+")]
#[logos(skip(r";[^\n]*", allow_greedy = true))]
pub(super) enum Token {
    /// `(`
    #[token("(")]
    Open,
    /// `)`
    #[token(")")]
    Close,
    /// A name, a variable, a keyword, a number or a sign.
    #[regex(r"[^\s();]+")]
    Word,
}
