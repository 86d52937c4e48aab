//! The markers from above, with their displacements along the skin as arrows.

mod draw;

use super::subtitle;
use super::table::Trace;
use crate::plot::canvas::Point;
use crate::plot::layout::{EDGE, LEADING, TEXT, TICK_GAP, TITLE};
use crate::plot::lettering::{width, wrap};
use crate::plot::scale::{Scale, Spacing, Tick, round_step};
use crate::words;

const WIDTH: f64 = 960.0;
/// Room for the key, and between it and the box.
const KEY: f64 = 240.0;
const GAP: f64 = 30.0;
/// Displacements smaller than this are none.
const LEAST: f64 = 1e-290;

/// The picture with the place of everything.
pub(crate) struct Quiver {
    trace: Trace,
    pub(crate) title: String,
    subtitle: Vec<String>,
    pub(crate) size: (f64, f64),
    /// Upper left corner of the box, and its side.
    corner: Point,
    side: f64,
    x: Scale,
    y: Scale,
    /// Scale of the shade that shows the true normal displacement.
    shade: Scale,
    /// Radius of a marker.
    radius: f64,
    /// Pixels per unit of displacement; none if nothing moves along the skin.
    stretch: Option<f64>,
    /// Length of the arrow in the key.
    sample: f64,
}

impl Quiver {
    /// Finds room for everything.
    pub(super) fn of(trace: Trace) -> Self {
        let [x, y] = axes(&trace);
        let labels = y.ticks(5).into_iter();
        let label = labels.map(|Tick { label, .. }| width(&label, TEXT));
        let left = EDGE + label.fold(0.0, f64::max) + TICK_GAP + 2.0;
        let side = WIDTH - left - GAP - KEY - EDGE;
        let subtitle = wrap(&subtitle(&trace), TEXT, WIDTH - 2.0 * EDGE);
        let line = TEXT * LEADING;
        let top = EDGE + TITLE * LEADING + subtitle.len() as f64 * line + 14.0 + line + 6.0;
        let bottom = top + side + TICK_GAP + 2.0 * line + 10.0;

        // Sized so that neighbours in an even pattern would not touch.
        let apart = side / (trace.markers.len() as f64).sqrt();
        let moves = trace.markers.iter().flat_map(|marker| {
            let read = marker.reading.and_then(|reading| reading.tangential);
            marker.truth.tangential.into_iter().chain(read)
        });
        let longest = moves.map(|[x, y]| libm::hypot(x, y)).fold(0.0, f64::max);
        let stretch = (longest > LEAST).then(|| (0.8 * apart).clamp(12.0, 70.0) / longest);
        let normals = trace.markers.iter().map(|marker| marker.truth.normal);
        Self {
            title: "Displacement of the markers along the skin".to_owned(),
            subtitle,
            size: (WIDTH, (bottom + EDGE - 6.0).ceil()),
            corner: (left, top),
            side,
            x,
            y,
            shade: Scale::around(Spacing::Linear, normals),
            radius: (0.17 * apart).clamp(2.0, 11.0),
            stretch,
            sample: stretch.map_or(0.0, |_| round_step(0.8 * longest)),
            trace,
        }
    }

    /// A label with the unit of the tables.
    fn in_unit(&self, label: &str) -> String {
        words::with_unit(label, &words::unit(&self.trace.unit))
    }
}

/// Axes of the same scale around all markers.
fn axes(trace: &Trace) -> [Scale; 2] {
    let ends = [0, 1].map(|axis| {
        let along = trace.markers.iter().map(|marker| marker.place[axis]);
        Scale::around(Spacing::Linear, along).ends()
    });
    let half = |(low, high): (f64, f64)| 0.5 * (high - low);
    let reach = half(ends[0]).max(half(ends[1]));
    ends.map(|(low, high)| {
        let middle = low + half((low, high));
        Scale::exactly(middle - reach, middle + reach)
    })
}
