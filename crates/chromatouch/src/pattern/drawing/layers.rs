//! Layers of a drawing, and how lengths are written in it.

/// Layer of the gores' outlines.
pub(super) const CUT: &str = "CUT";
/// Layer of the middle meridians and the seam marks.
pub(super) const FOLD: &str = "FOLD";
/// Layer of the inner discs.
pub(super) const MAGENTA: &str = "MAGENTA";
/// Layer of the outer discs.
pub(super) const YELLOW: &str = "YELLOW";

/// A length in millimetres, to a nanometre.
pub(super) fn millimetres(value: f64) -> String {
    let written = format!("{value:.6}");
    match written.strip_prefix('-') {
        Some(size) if size.bytes().all(|byte| matches!(byte, b'0' | b'.')) => size.to_owned(),
        _ => written,
    }
}
