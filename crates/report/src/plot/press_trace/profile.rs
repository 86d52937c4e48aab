//! Displacements against the distance from the contact: normal, and along the skin if they were read.

use super::contact::outward;
use super::subtitle;
use super::table::{Displacement, Trace};
use crate::plot::figure::{Figure, Legend, Panel, PointSet};
use crate::plot::layout::Layout;
use crate::plot::scale::{Scale, Spacing};
use crate::plot::style::{Marker, Style};
use crate::words;

/// The figures, from the top, and where they stand.
pub(super) fn stack(trace: &Trace) -> Vec<(Figure, Layout)> {
    let normal = places(trace, |_, moved| Some(moved.normal));
    let x = Scale::around(
        Spacing::Linear,
        trace.markers.iter().map(|marker| marker.radial),
    );
    let label = |text: &str| words::with_unit(text, &words::unit(&trace.unit));
    let mut figures = vec![Figure {
        name: "trace-profile".to_owned(),
        title: "Displacement of the markers away from the contact".to_owned(),
        subtitle: subtitle(trace),
        legend: Legend {
            points: normal
                .iter()
                .map(|set| (set.label.clone(), set.style))
                .collect(),
            ..Legend::default()
        },
        ..figure(normal, &x, label("displacement inward"))
    }];
    if trace.reads_tangential {
        let places_of = trace.markers.iter().map(|marker| marker.place);
        let distances = trace.markers.iter().map(|marker| marker.radial);
        let away = outward(
            &places_of.collect::<Vec<_>>(),
            &distances.collect::<Vec<_>>(),
        );
        let along = places(trace, |at, moved| {
            let ([x, y], [east, north]) = (moved.tangential?, away[at]?);
            Some(x * east + y * north)
        });
        figures.push(figure(
            along,
            &x,
            label("displacement along the skin, outward"),
        ));
    }
    if let Some(last) = figures.last_mut() {
        last.x_label = label("distance from the contact");
    }
    Layout::stack(figures)
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
        at,
    };
    vec![
        set("truth", 0, Marker::Dash, truth.collect()),
        set("reading", 1, Marker::Dot, read.collect()),
    ]
}

fn figure(points: Vec<PointSet>, x: &Scale, y_label: String) -> Figure {
    let values = points.iter().flat_map(|set| &set.at).map(|place| place.1);
    Figure {
        name: String::new(),
        title: String::new(),
        subtitle: String::new(),
        x_label: String::new(),
        y_label,
        x: x.clone(),
        y: Scale::around(Spacing::Linear, values),
        panels: vec![Panel {
            title: None,
            lines: Vec::new(),
            points,
        }],
        legend: Legend::default(),
        marks: Vec::new(),
        notes: Vec::new(),
        markers: true,
    }
}
