//! Content of a chart, in the units shown, before it is drawn.

use crate::plot::scale::Scale;
use crate::plot::style::Style;

/// Panels on the same scales, and what is told of them.
#[derive(Debug, Clone)]
pub(crate) struct Chart {
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    /// At least one.
    pub(crate) panels: Vec<Panel>,
    pub(crate) legend: Legend,
    pub(crate) marks: Vec<Mark>,
    /// Whether solid lines carry a marker at each point.
    pub(crate) markers: bool,
}

/// Panel of a chart, the only one or one of several on the same scales.
#[derive(Debug, Clone, Default)]
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

/// Runs of places, broken where there is none.
pub(crate) type Runs = Vec<Vec<(f64, f64)>>;

/// Series in one panel.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) style: Style,
    /// Drawn dashed and without markers: the statistic to compare with.
    pub(crate) dashed: bool,
    /// Points in order of x.
    pub(crate) runs: Runs,
    /// Places of the points that are marked with a circle.
    pub(crate) circled: Vec<(f64, f64)>,
    /// Bars of points: x, and both ends.
    pub(crate) bars: Vec<(f64, [f64; 2])>,
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

/// Scales around all that is drawn and marked, each made by `make` of the places along it.
pub(crate) fn scales(
    panels: &[Panel],
    marks: &[Mark],
    make: impl Fn(usize, &mut dyn Iterator<Item = f64>) -> Scale,
) -> [Scale; 2] {
    let places: Vec<(f64, f64)> = panels.iter().flat_map(Panel::places).collect();
    let marked = |on_x: bool| {
        let on_axis = marks.iter().filter(move |mark| mark.on_x == on_x);
        on_axis.map(|mark| mark.at)
    };
    [
        make(
            0,
            &mut places.iter().map(|place| place.0).chain(marked(true)),
        ),
        make(
            1,
            &mut places.iter().map(|place| place.1).chain(marked(false)),
        ),
    ]
}
