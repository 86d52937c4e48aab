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
    /// Notes on the points that are not drawn, with reasons.
    pub(crate) notes: Vec<String>,
    /// Whether solid lines carry a marker at each point.
    pub(crate) markers: bool,
}

/// Panel of a figure, the only one or one of several on the same scales.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) title: Option<String>,
    pub(crate) lines: Vec<Line>,
    pub(crate) points: Vec<PointSet>,
}

impl Panel {
    /// Every place that is drawn in it.
    pub(crate) fn places(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let lines = self
            .lines
            .iter()
            .flat_map(|line| line.runs.iter().flatten());
        let points = self.points.iter().flat_map(|set| &set.at);
        lines.chain(points).copied()
    }
}

/// Points that are no line, drawn as open markers.
#[derive(Debug, Clone)]
pub(crate) struct PointSet {
    pub(crate) label: String,
    pub(crate) style: Style,
    pub(crate) at: Vec<(f64, f64)>,
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
    /// Labels of the solid and of the dashed lines, where two statistics are compared.
    pub(crate) compared: Option<(String, String)>,
    /// The open markers, by label.
    pub(crate) points: Vec<(String, Style)>,
}

/// A labelled reference line.
#[derive(Debug, Clone)]
pub(crate) struct Mark {
    pub(crate) on_x: bool,
    pub(crate) at: f64,
    pub(crate) label: String,
}
