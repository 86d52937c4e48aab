//! Measures and draws text in the built-in fonts: its width, its line breaks and its pixels.

use ab_glyph::{Font, FontRef};
use std::sync::LazyLock;

/// A sans-serif font, and a second font for characters that the first does not contain.
const FONTS: [&[u8]; 2] = [
    epaint_default_fonts::UBUNTU_LIGHT,
    epaint_default_fonts::HACK_REGULAR,
];

static OUTLINES: LazyLock<Vec<FontRef<'static>>> = LazyLock::new(|| {
    let fonts = FONTS.into_iter().map(FontRef::try_from_slice);
    fonts.filter_map(Result::ok).collect()
});

/// Safety factor for the width of a text. A viewer of the SVG uses its own sans-serif font, which may be wider than the
/// built-in font.
const ROOM: f64 = 1.12;

/// Width of `text` at the font size `em`, increased by the factor [`ROOM`].
pub(crate) fn width(text: &str, em: i32) -> i32 {
    (ROOM * f64::from(em) * set(text, |_, _, _| ())).ceil() as i32
}

/// Computes the position of each letter of a text. For each letter, calls `place` with the font, the letter, and the
/// distance of the letter from the start of the text. Returns the width of the text. Both lengths are in ems (the
/// nominal height of the font).
fn set(text: &str, mut place: impl FnMut(&FontRef<'_>, char, f64)) -> f64 {
    let mut end = 0.0;
    let mut before = None;
    for letter in text.chars() {
        let has_it = |font: &&FontRef<'_>| font.glyph_id(letter).0 != 0;
        let font = OUTLINES.iter().find(has_it).or(OUTLINES.first());
        let Some(font) = font else { continue };
        let em = f64::from(font.units_per_em().unwrap_or(1000.0));
        let glyph = font.glyph_id(letter);
        if let Some(before) = before {
            end += f64::from(font.kern_unscaled(font.glyph_id(before), glyph)) / em;
        }
        place(font, letter, end);
        end += f64::from(font.h_advance_unscaled(glyph)) / em;
        before = Some(letter);
    }
    end
}

/// Calls `pixel` for each pixel of a text, with the position of the pixel and with the share of its area that the text
/// covers (0 to 1). The anchor (`x`, `base`) is on the base line of the text. The share `before` of the text's width is
/// to the left of the anchor.
#[cfg(feature = "png")]
pub(crate) fn pixels(
    text: &str,
    em: f64,
    (x, base): (f64, f64),
    before: f64,
    mut pixel: impl FnMut((i32, i32), f64),
) {
    let start = x - before * em * set(text, |_, _, _| ());
    set(text, |font, letter, along| {
        let height = f64::from(font.height_unscaled() / font.units_per_em().unwrap_or(1000.0));
        let place = ab_glyph::point((start + em * along) as f32, base as f32);
        let glyph = font.glyph_id(letter);
        let glyph = glyph.with_scale_and_position((em * height) as f32, place);
        if let Some(outline) = font.outline_glyph(glyph) {
            let corner = outline.px_bounds().min;
            outline.draw(|across, down, covered| {
                let place = (
                    corner.x as i32 + across as i32,
                    corner.y as i32 + down as i32,
                );
                pixel(place, f64::from(covered));
            });
        }
    });
}

/// Breaks `text` into lines that are at most `limit` wide. A word that is wider than `limit` gets its own line.
pub(crate) fn wrap(text: &str, em: i32, limit: i32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if width(&longer, em) <= limit {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_have_every_character_a_label_may_use() {
        for c in "|%²³/·×−°µ…⁰¹⁴⁵⁶⁷⁸⁹⁻()₁₂κωψΔ≥≤é–δσν’“”".chars()
        {
            let has_it = |font: &FontRef<'_>| font.glyph_id(c).0 != 0;
            assert!(OUTLINES.iter().any(has_it), "no glyph for {c:?}");
        }
    }

    #[test]
    fn text_wraps_at_the_limit() {
        let lines = wrap("one two three four five six", 18, 90);
        assert!(lines.len() > 1, "{lines:?}");
        assert_eq!(lines.join(" "), "one two three four five six");
        assert!(lines.iter().all(|line| width(line, 18) <= 90), "{lines:?}");
        assert!(wrap("", 18, 90).is_empty());
    }
}
