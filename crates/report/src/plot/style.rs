//! Colours and markers: the Okabe–Ito palette, told apart by shape as well.

use plotters::style::RGBColor;

/// Okabe and Ito's colours that carry a line on white (their yellow does not).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Up,
    Diamond,
    Down,
    Ring,
    Plus,
    Cross,
}

const MARKERS: [Marker; 8] = [
    Marker::Circle,
    Marker::Square,
    Marker::Up,
    Marker::Diamond,
    Marker::Down,
    Marker::Ring,
    Marker::Plus,
    Marker::Cross,
];

/// The look of one series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Style {
    pub(crate) colour: RGBColor,
    pub(crate) marker: Marker,
}

impl Style {
    /// The look of the `index`-th value of a study's axis; 56 in a row differ.
    pub(crate) fn of(index: usize) -> Self {
        Self {
            colour: COLOURS[index % COLOURS.len()],
            marker: MARKERS[index % MARKERS.len()],
        }
    }

    /// The colour mixed half with white.
    pub(crate) fn pale(self) -> RGBColor {
        let half = |channel: u8| u8::try_from((u16::from(channel) + 255) / 2).unwrap_or(u8::MAX);
        let RGBColor(r, g, b) = self.colour;
        RGBColor(half(r), half(g), half(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_56_styles_differ() {
        for a in 0..56 {
            for b in 0..a {
                assert_ne!(Style::of(a), Style::of(b), "{a} {b}");
            }
        }
    }
}
