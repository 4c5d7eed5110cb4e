//! What is drawn with: numbers, texts and a few shapes.

use svg::node::element::{Element, Text, Title};

/// A length on the paper, to a tenth of a pixel.
pub(super) fn px(value: f64) -> String {
    let rounded = (value * 10.0).round() / 10.0;
    // No minus before a zero.
    format!("{}", rounded + 0.0)
}

/// A line from point to point, for the `d` of a path.
pub(super) fn line(points: &[[f64; 2]]) -> String {
    let mut path = String::new();
    for (index, [x, y]) in points.iter().enumerate() {
        let step = if index == 0 { 'M' } else { 'L' };
        path.push(step);
        path.push_str(&format!("{} {}", px(*x), px(*y)));
    }
    path
}

/// An element with attributes that are all texts.
pub(super) fn element(name: &str, attributes: &[(&str, &str)]) -> Element {
    let mut element = Element::new(name);
    for (name, value) in attributes {
        element
            .get_attributes_mut()
            .insert((*name).to_owned(), (*value).into());
    }
    element
}

/// Words at a place, in the style of a class.
pub(super) fn words(text: &str, [x, y]: [f64; 2], class: &str) -> Element {
    // As a plain element: there is no line break about the words then.
    let text = Text::new(plain(text));
    text.set("x", px(x))
        .set("y", px(y))
        .set("class", class)
        .into()
}

/// What is shown where the pointer rests.
pub(super) fn tip(text: &str) -> Title {
    Title::new(plain(text))
}

/// Without the characters that XML has no way to write.
pub(super) fn plain(text: &str) -> String {
    text.chars()
        .map(|letter| match letter {
            '\u{fffe}' | '\u{ffff}' => ' ',
            _ if letter.is_control() => ' ',
            _ => letter,
        })
        .collect()
}

/// About how wide a text is drawn: the letters of sans-serif fonts are narrower than they are high.
pub(super) fn width_px(text: &str, size_px: f64) -> f64 {
    let wide = |letter: char| if letter.is_ascii() { 0.58 } else { 1.0 };
    text.chars().map(wide).sum::<f64>() * size_px
}
