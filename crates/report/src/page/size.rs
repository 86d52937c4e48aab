//! Sizes of figures on the page.

use crate::Figure;

/// Part of its size to which a figure shrinks before it scrolls sideways: its text is then as high as 11 pixels.
const LEAST_SCALE: f64 = 0.61;

/// Width below which a figure does not shrink, pixels.
pub(super) fn least(figure: &Figure) -> f64 {
    (LEAST_SCALE * figure.width()).ceil()
}
