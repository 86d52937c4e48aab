//! The built-in fonts: how wide a text is, and where it breaks.

use ab_glyph::{Font, FontRef, GlyphId};
#[cfg(feature = "png")]
use ab_glyph::{OutlineCurve, Point, point};
use std::sync::LazyLock;

/// A sans-serif, and one with more characters to fall back on.
const FONTS: [&[u8]; 2] = [
    epaint_default_fonts::UBUNTU_LIGHT,
    epaint_default_fonts::HACK_REGULAR,
];

static OUTLINES: LazyLock<Vec<FontRef<'static>>> = LazyLock::new(|| {
    let fonts = FONTS.into_iter().map(FontRef::try_from_slice);
    fonts.filter_map(Result::ok).collect()
});

/// Viewers of an SVG have their own sans-serif, which may be wider than ours by this factor.
const ROOM: f64 = 1.12;

/// Width that `text` needs at `size` pixels per em, in pixels.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    ROOM * f64::from(set(text, size as f32, |_, _, _, _| ()))
}

/// Sets a text at `size` pixels per em: hands over each glyph, its font, how far from the start it stands, and pixels
/// per unit of its font. Gives the width of the whole.
fn set(text: &str, size: f32, mut place: impl FnMut(&FontRef<'_>, GlyphId, f32, f32)) -> f32 {
    let mut end = 0.0;
    for (at, letters) in runs(text) {
        let Some(font) = OUTLINES.get(at) else { break };
        let unit = size / font.units_per_em().unwrap_or(1000.0);
        let mut before: Option<GlyphId> = None;
        for c in letters.chars() {
            let id = font.glyph_id(c);
            if let Some(previous) = before {
                end += unit * font.kern_unscaled(previous, id);
            }
            place(font, id, end, unit);
            end += unit * font.h_advance_unscaled(id);
            before = Some(id);
        }
    }
    end
}

/// A text as outlines.
#[cfg(feature = "png")]
pub(crate) struct Lettering {
    /// Outlines in pixels from the start of the base line, to the right and down; one begins where a curve does not go on
    /// from the one before.
    pub(crate) curves: Vec<OutlineCurve>,
    /// Width in pixels.
    pub(crate) width: f32,
    /// Height of small letters in pixels.
    pub(crate) x_height: f64,
}

#[cfg(feature = "png")]
impl Lettering {
    /// Outlines of `text` at `size` pixels per em.
    pub(crate) fn new(text: &str, size: f64) -> Self {
        let mut curves = Vec::new();
        let width = set(text, size as f32, |font, id, left, unit| {
            let at = |p: Point| point(left + unit * p.x, -unit * p.y);
            let outline = font.outline(id).map(|outline| outline.curves);
            curves.extend(outline.into_iter().flatten().map(|curve| match curve {
                OutlineCurve::Line(a, b) => OutlineCurve::Line(at(a), at(b)),
                OutlineCurve::Quad(a, b, c) => OutlineCurve::Quad(at(a), at(b), at(c)),
                OutlineCurve::Cubic(a, b, c, d) => OutlineCurve::Cubic(at(a), at(b), at(c), at(d)),
            }));
        });
        let mut x_height = 0.0;
        set("x", size as f32, |font, id, _, unit| {
            let bounds = font.outline(id).map(|outline| outline.bounds);
            x_height = bounds.map_or(0.0, |bounds| unit * bounds.min.y.max(bounds.max.y));
        });
        Self {
            curves,
            width,
            x_height: x_height.into(),
        }
    }
}

/// Runs of letters that one font has, each with the number of the font.
fn runs(text: &str) -> Vec<(usize, &str)> {
    let font_of = |c: char| {
        let has_it = |font: &FontRef<'_>| font.glyph_id(c).0 != 0;
        OUTLINES.iter().position(has_it).unwrap_or(0)
    };
    let mut runs: Vec<(usize, &str)> = Vec::new();
    let mut start = 0;
    for (at, c) in text.char_indices() {
        let font = font_of(c);
        let end = at + c.len_utf8();
        match runs.last_mut() {
            Some((same, run)) if *same == font => *run = &text[start..end],
            _ => {
                start = at;
                runs.push((font, &text[at..end]));
            }
        }
    }
    runs
}

/// `text` in lines of at most `limit` pixels; a longer word stands alone.
pub(crate) fn wrap(text: &str, size: f64, limit: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if width(&longer, size) <= limit {
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
        let lines = wrap("one two three four five six", 18.0, 90.0);
        assert!(lines.len() > 1, "{lines:?}");
        assert_eq!(lines.join(" "), "one two three four five six");
        assert!(
            lines.iter().all(|line| width(line, 18.0) <= 90.0),
            "{lines:?}"
        );
        assert!(wrap("", 18.0, 90.0).is_empty());
    }
}
