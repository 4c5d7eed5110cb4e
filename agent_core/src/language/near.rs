//! What a misspelt name was probably meant to be.

/// Among more names than these nobody's slip is looked for.
const ENOUGH: usize = 2000;

/// The name most like `name`, if one is so much alike that it may have been meant.
pub fn nearest<'a>(name: &str, among: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Nobody's slip of the pen is that long, and the distance takes the product of both lengths.
    if name.len() > 100 {
        return None;
    }
    // Of two letters, one more slip leaves nothing to recognise.
    let allowed = (name.chars().count() / 3).min(3);
    among
        .into_iter()
        .take(ENOUGH)
        .filter(|other| other.len().abs_diff(name.len()) <= 4 * allowed)
        .map(|other| (distance(name, other), other))
        .filter(|(distance, _)| *distance <= allowed)
        .min()
        .map(|(_, other)| other)
}

/// "; did you mean `x`?", or else `otherwise`.
pub(super) fn hint<'a>(
    name: &str,
    among: impl IntoIterator<Item = &'a str>,
    otherwise: &str,
) -> String {
    nearest(name, among).map_or_else(
        || otherwise.to_owned(),
        |near| format!("; did you mean `{near}`?"),
    )
}

/// How many letters must be added, left out, replaced or swapped with their neighbour.
fn distance(from: &str, to: &str) -> usize {
    let from: Vec<char> = from.chars().collect();
    let to: Vec<char> = to.chars().collect();
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for row in 1..=from.len() {
        let mut this = vec![row];
        for column in 1..=to.len() {
            let replaced = usize::from(from[row - 1] != to[column - 1]);
            let mut best = (last[column - 1] + replaced)
                .min(last[column] + 1)
                .min(this[column - 1] + 1);
            let swapped = row > 1
                && column > 1
                && from[row - 1] == to[column - 2]
                && from[row - 2] == to[column - 1];
            if swapped {
                best = best.min(before[column - 2] + 1);
            }
            this.push(best);
        }
        before = std::mem::replace(&mut last, this);
    }
    last[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_one_slip_is_recognised() {
        let names = ["located", "open", "at"];
        assert_eq!(nearest("loctaed", names), Some("located"));
        assert_eq!(nearest("opne", names), Some("open"));
        assert_eq!(nearest("explained", names), None);
        assert_eq!(nearest("it", names), None);
    }
}
