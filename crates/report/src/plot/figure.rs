//! A figure before it is drawn: what stands where, in the units shown.

use super::scale::Scale;
use super::style::Style;

/// Everything a drawing needs.
#[derive(Debug, Clone)]
pub(crate) struct Figure {
    /// File stem.
    pub(crate) name: String,
    pub(crate) title: String,
    /// Sample size and what is held fixed.
    pub(crate) subtitle: String,
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    /// At least one, all on the same scales.
    pub(crate) panels: Vec<Panel>,
    pub(crate) legend: Legend,
    pub(crate) marks: Vec<Mark>,
    /// What is not drawn, and why.
    pub(crate) notes: Vec<String>,
}

/// One of the small multiples.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) title: Option<String>,
    pub(crate) lines: Vec<Line>,
}

/// One series in one panel.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) style: Style,
    /// Drawn dashed and without markers: the statistic to compare with.
    pub(crate) dashed: bool,
    /// Points in order of x, broken where a value cannot be drawn.
    pub(crate) runs: Vec<Vec<(f64, f64)>>,
}

/// The key to the lines; empty if there is one series and nothing to compare.
#[derive(Debug, Clone, Default)]
pub(crate) struct Legend {
    pub(crate) title: String,
    pub(crate) entries: Vec<(String, Style)>,
    /// What the solid and the dashed lines are.
    pub(crate) compared: Option<(String, String)>,
}

/// A labelled reference line.
#[derive(Debug, Clone)]
pub(crate) struct Mark {
    pub(crate) on_x: bool,
    pub(crate) at: f64,
    pub(crate) label: String,
}
