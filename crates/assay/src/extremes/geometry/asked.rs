//! Every question to every surface, at numbers that nobody means.

use nalgebra::{Point3, Vector3};
use palpate_geometry::{Parameters, Shape, Surface, SurfaceError};

use super::super::hostile::{EXTREME, NOT_FINITE};
use super::super::{Case, Outcome};
use super::shapes;

/// The numbers of an answer.
type Numbers = Result<Vec<f64>, SurfaceError>;
type Question = fn(&Shape, f64, f64) -> Numbers;

const QUESTIONS: [(&str, Question); 6] = [
    ("geometry::Surface::chart", |surface, a, b| {
        let jet = surface.chart(Parameters::new(a, b))?;
        let parts = [jet.point.coords, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv];
        Ok(parts.iter().flatten().copied().collect())
    }),
    ("geometry::Surface::chart_geometry", |surface, a, b| {
        let found = surface.chart_geometry(Parameters::new(a, b))?;
        let form = found.curvature;
        let mut numbers = vec![form.k_uu, form.k_uv, form.k_vv];
        numbers.extend(found.metric.iter().chain(found.torsion.iter()));
        numbers.extend(found.frame.normal.iter());
        Ok(numbers)
    }),
    ("geometry::Surface::level_set", |surface, a, b| {
        let found = surface.level_set(&Point3::new(a, b, b))?;
        Ok((found.normal.iter())
            .chain(found.second_form.iter())
            .copied()
            .collect())
    }),
    ("geometry::Surface::curvature_along", |surface, a, b| {
        let (normal, form) = surface.curvature_along(&Point3::new(a, b, b), &Vector3::x())?;
        let mut numbers = vec![form.k_uu, form.k_uv, form.k_vv];
        numbers.extend(normal.iter());
        Ok(numbers)
    }),
    ("geometry::Surface::closest_point", |surface, a, b| {
        let found = surface.closest_point(&Point3::new(a, b, b))?;
        Ok(found.iter().copied().collect())
    }),
    ("geometry::Surface::contact_at", |surface, a, b| {
        let found = surface.contact_at(a, b)?;
        Ok(found.iter().copied().collect())
    }),
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (entry, ask) in QUESTIONS {
        for shape in shapes(1.0) {
            let asked = shape.clone();
            let input = format!("{} at NaN and infinities", shape.name());
            cases.push(Case::refusal(entry, input, move || {
                let answers = NOT_FINITE.map(|bad| ask(&asked, bad, bad));
                answers
                    .into_iter()
                    .reduce(Result::or)
                    .expect("three numbers")
            }));
        }
        for size in [1e-9, 1e9] {
            let input = format!("9 surfaces of size {size:e} at 256 pairs of extreme numbers");
            cases.push(Case::new(entry, input, move || all_finite(ask, size)));
        }
    }
    cases
}

fn all_finite(ask: Question, size: f64) -> Outcome {
    let pairs = EXTREME.into_iter().flat_map(|a| EXTREME.map(|b| (a, b)));
    let asked = pairs.flat_map(|(a, b)| shapes(size).map(|shape| ask(&shape, a, b)));
    Outcome::of_all(asked)
}
