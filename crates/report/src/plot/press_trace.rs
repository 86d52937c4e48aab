//! Figures of one press: the true and the measured displacements of the markers.

mod marker_table;
mod outward;
mod quiver;

use super::drawing::Figure;
use super::scale::{Scale, Spacing};
use super::series::{self, Content, OPEN_MARKER, Plot, PointSet};
use super::sheet::Words;
use super::style::{Marker, Style};
use crate::phrases::with_unit;
use crate::{Files, ReportError};
use marker_table::{Displacement, Trace};
use outward::outward;
use palpate_study::label::spoken_unit;

/// Draws two figures of a press from the `trace.csv` and `readings.csv` that `palpate trace` wrote.
///
/// The figure `quiver` shows the markers from above. Arrows show the true and measured displacements along the skin,
/// and shades of grey show the normal displacement. The figure `trace-profile` shows the normal displacement over the
/// distance from the contact and, if it was measured, the displacement along the skin away from the contact.
///
/// A reading belongs to the marker at the same position. A marker without a reading is crossed out.
///
/// # Errors
/// [`ReportError`] if a table is missing or malformed, if its lengths have different units, or if a reading is not at
/// the position of a marker.
pub fn press_figures(files: &Files) -> Result<Vec<Figure>, ReportError> {
    let trace = marker_table::read(files)?;
    Ok(vec![quiver::figure(&trace)?, profile(&trace)?])
}

/// Draws the figure `trace-profile`: the normal displacement over the distance from the contact and, below it, the
/// displacement along the skin.
fn profile(trace: &Trace) -> Result<Figure, ReportError> {
    let label = |text: &str| with_unit(text, &spoken_unit(&trace.unit));
    let distances: Vec<f64> = trace.markers.iter().map(|marker| marker.radial).collect();
    let x = Scale::around(Spacing::Linear, distances.iter().copied());
    let normal = places(trace, |_, moved| Some(moved.normal));
    let samples = normal.iter().map(|set| (set.label.clone(), set.style));
    let samples = samples.collect();
    let mut plots = vec![plot(normal, &x, label("displacement inward"))];
    plots[0].series.points = samples;
    if trace.reads_tangential {
        let places_of = trace.markers.iter().map(|marker| marker.place);
        let away = outward(&places_of.collect::<Vec<_>>(), &distances);
        let along = places(trace, |at, moved| {
            let ([x, y], [east, north]) = (moved.tangential?, away[at]?);
            Some(x * east + y * north)
        });
        plots.push(plot(
            along,
            &x,
            label("displacement along the skin, outward"),
        ));
    }
    if let Some(last) = plots.last_mut() {
        last.x_label = label("distance from the contact");
    }
    let title = "Displacement of the markers away from the contact";
    let words = Words::new("trace-profile", title, &trace.subtitle(), &[]);
    series::figure(words, plots)
}

/// Points of one component of the displacement over the distance from the contact: one set of points with the true
/// values, and one with the readings.
fn places(trace: &Trace, component: impl Fn(usize, &Displacement) -> Option<f64>) -> Vec<PointSet> {
    let markers = || trace.markers.iter().enumerate();
    let truth =
        markers().filter_map(|(at, marker)| Some((marker.radial, component(at, &marker.truth)?)));
    let read = markers()
        .filter_map(|(at, marker)| Some((marker.radial, component(at, marker.reading.as_ref()?)?)));
    let set = |label: &str, index: usize, marker: Marker, at: Vec<(f64, f64)>| PointSet {
        label: label.to_owned(),
        style: Style {
            marker,
            ..Style::of(index)
        },
        size: OPEN_MARKER,
        at,
    };
    vec![
        set("truth", 0, Marker::Dash, truth.collect()),
        set("reading", 1, Marker::Dot, read.collect()),
    ]
}

fn plot(points: Vec<PointSet>, x: &Scale, y_label: String) -> Plot {
    let values = points.iter().flat_map(|set| &set.at).map(|place| place.1);
    let y = Scale::around(Spacing::Linear, values);
    let content = Content {
        points,
        ..Content::default()
    };
    Plot::new([String::new(), y_label], [x.clone(), y], vec![content])
}
