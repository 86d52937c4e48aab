//! Displacements against the distance from the contact: normal, and along the skin if they were read.

use super::contact::outward;
use super::table::{Displacement, Trace};
use crate::ReportError;
use crate::plot::drawing::Figure;
use crate::plot::scale::{Scale, Spacing};
use crate::plot::series::{self, Content, OPEN_MARKER, Plot, PointSet, SeriesKey};
use crate::plot::sheet::{MARKER, Words};
use crate::plot::style::{Marker, Style};
use palpate_study::label::{spoken_unit, with_unit};

/// Draws the plots below each other, the normal displacement on top.
pub(super) fn figure(trace: &Trace) -> Result<Figure, ReportError> {
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
    let words = Words {
        name: "trace-profile".to_owned(),
        title: "Displacement of the markers away from the contact".to_owned(),
        subtitle: trace.subtitle(),
        notes: Vec::new(),
    };
    series::figure(words, plots)
}

/// Points of a component of each marker's displacement, true and read.
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
    Plot {
        x_label: String::new(),
        y_label,
        x: x.clone(),
        y: Scale::around(Spacing::Linear, values),
        panels: vec![Content {
            points,
            ..Content::default()
        }],
        series: SeriesKey::default(),
        marks: Vec::new(),
        marker: MARKER,
        key: Vec::new(),
    }
}
