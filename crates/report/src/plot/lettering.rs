//! The built-in fonts: how wide a text is, where it breaks, and its outlines as pixels.

use ab_glyph::{Font, FontRef, Glyph, GlyphId, PxScale, point};
use std::sync::LazyLock;

/// A sans-serif, and one with more characters to fall back on.
static FONTS: LazyLock<Vec<FontRef<'static>>> = LazyLock::new(|| {
    [
        epaint_default_fonts::UBUNTU_LIGHT,
        epaint_default_fonts::HACK_REGULAR,
    ]
    .into_iter()
    .filter_map(|bytes| FontRef::try_from_slice(bytes).ok())
    .collect()
});

/// Viewers of an SVG have their own sans-serif, which may be wider than ours by this factor.
const ROOM: f64 = 1.12;
/// Height of a capital, in ems.
const CAPITAL: f32 = 0.69;

/// Width that `text` needs at `size` pixels per em, in pixels.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let (_, end) = glyphs(text, size as f32);
    ROOM * f64::from(end)
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

/// The text as covered pixels (x, y, share covered), from its left end and the middle height of its capitals;
/// and its width.
pub(crate) fn pixels(text: &str, size: f64) -> (Vec<(i32, i32, f64)>, f64) {
    let size = size as f32;
    let (glyphs, end) = glyphs(text, size);
    let mut pixels = Vec::new();
    for (font, mut glyph) in glyphs {
        glyph.position.y = CAPITAL / 2.0 * size;
        let Some(outline) = font.outline_glyph(glyph) else {
            continue;
        };
        let corner = outline.px_bounds().min;
        outline.draw(|x, y, share| {
            let at = (corner.x as i32 + x as i32, corner.y as i32 + y as i32);
            pixels.push((at.0, at.1, f64::from(share.clamp(0.0, 1.0))));
        });
    }
    (pixels, f64::from(end))
}

/// The glyphs of `text` on a baseline from (0, 0), and where it ends.
fn glyphs(text: &str, size: f32) -> (Vec<(&'static FontRef<'static>, Glyph)>, f32) {
    let mut end = 0.0;
    let mut before: Option<(usize, GlyphId)> = None;
    let mut glyphs = Vec::new();
    for c in text.chars() {
        let at = FONTS
            .iter()
            .position(|font| font.glyph_id(c).0 != 0)
            .unwrap_or(0);
        let Some(font) = FONTS.get(at) else { break };
        let units = size / font.units_per_em().unwrap_or(1000.0);
        let id = font.glyph_id(c);
        if let Some((_, previous)) = before.filter(|(same, _)| *same == at) {
            end += units * font.kern_unscaled(previous, id);
        }
        let scale = PxScale::from(units * font.height_unscaled());
        glyphs.push((font, id.with_scale_and_position(scale, point(end, 0.0))));
        end += units * font.h_advance_unscaled(id);
        before = Some((at, id));
    }
    (glyphs, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_have_every_character_a_label_may_use() {
        for c in "|%²³/·×−°µ…⁰¹⁴⁵⁶⁷⁸⁹⁻()₁₂κωψΔ≥≤é–δσν’“”".chars()
        {
            assert!(
                FONTS.iter().any(|font| font.glyph_id(c).0 != 0),
                "no glyph for {c:?}"
            );
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

    #[test]
    fn capitals_stand_in_the_middle_and_within_the_width() {
        let (pixels, width) = pixels("HIH", 100.0);
        let covered = |pick: fn(&(i32, i32, f64)) -> i32| {
            let all = || pixels.iter().filter(|p| p.2 > 0.5).map(pick);
            (all().min().unwrap(), all().max().unwrap())
        };
        let (left, right) = covered(|p| p.0);
        assert!(
            left >= 0 && f64::from(right) <= width,
            "{left} {right} {width}"
        );
        let (top, bottom) = covered(|p| p.1);
        assert!((top + bottom).abs() <= 3, "{top} {bottom}");
    }
}
