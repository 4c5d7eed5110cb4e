//! Whoever waits for an experiment.

/// Is shown how far an experiment is, and can end it.
pub trait Onlooker {
    /// So many of so many parts are done, and this is being measured.
    fn see(&mut self, done: u64, of: u64, what: &str);

    /// Whether what there is so far is enough: the experiment ends soon, with that.
    fn has_seen_enough(&self) -> bool;
}

/// Nobody waits.
impl Onlooker for () {
    fn see(&mut self, _: u64, _: u64, _: &str) {}

    fn has_seen_enough(&self) -> bool {
        false
    }
}
