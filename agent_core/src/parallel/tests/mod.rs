//! Relations, cliques and layers against an oracle that knows nothing of them.

mod against_oracle;
mod examples;
mod oracle;

pub(super) use against_oracle::Chance;
