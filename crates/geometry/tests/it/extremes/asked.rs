//! Every question to every surface, at numbers that nobody means.

use nalgebra::{Point3, Vector3};
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_geometry::{CurvatureForm, Parameters, Shape, Surface, SurfaceError, formula::Formula};
use palpate_verdict::{Answer, NOT_FINITE, extreme_pairs, rows};

rows! {
    question.entry, "{name} at {bad:e}", question.errors[usize::from(is_graph)] => (question.ask)(&shape, bad, bad),
        for question in QUESTIONS, for (name, is_graph, shape) in shapes(1.0), for bad in NOT_FINITE;
    question.entry, "9 surfaces of size {size:e} at 256 pairs of extreme numbers" =>
        all_finite(&question, size, answered),
        for question in QUESTIONS, for (size, answered) in [1e-9, 1e9].into_iter().zip(question.answered);
}

/// A question to a surface at a place, and what is known of the answers.
struct Question {
    entry: &'static str,
    ask: fn(&Shape, f64, f64) -> Result<Vec<f64>, SurfaceError>,
    /// Error at places that are none: of surfaces with parameters of their own, and of graphs over x and y.
    errors: [&'static str; 2],
    /// Number of answers of surfaces of size 1e-9 and 1e9, to nine times 256 questions.
    answered: [u32; 2],
}

const QUESTIONS: [Question; 6] = [
    Question {
        entry: "geometry::Surface::chart",
        ask: |surface, a, b| {
            let jet = surface.chart(Parameters::new(a, b))?;
            let parts = [jet.point.coords, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv];
            Ok(parts.iter().flatten().copied().collect())
        },
        errors: ["chart-singular", "off-domain"],
        answered: [840, 840],
    },
    Question {
        entry: "geometry::Surface::chart_geometry",
        ask: |surface, a, b| {
            let found = surface.chart_geometry(Parameters::new(a, b))?;
            let parts = found.metric.iter().chain(&found.torsion);
            let parts = parts.chain(&found.frame.normal).copied();
            Ok(parts.chain(form(&found.curvature)).collect())
        },
        errors: ["chart-singular", "off-domain"],
        answered: [812, 830],
    },
    Question {
        entry: "geometry::Surface::level_set",
        ask: |surface, a, b| {
            let found = surface.level_set(&Point3::new(a, b, b))?;
            let parts = found.normal.iter().chain(&found.second_form);
            Ok(parts.copied().collect())
        },
        errors: ["off-domain"; 2],
        answered: [812, 824],
    },
    Question {
        entry: "geometry::Surface::curvature_along",
        ask: |surface, a, b| {
            let (normal, curvature) =
                surface.curvature_along(&Point3::new(a, b, b), &Vector3::x())?;
            Ok(form(&curvature)
                .into_iter()
                .chain(normal.iter().copied())
                .collect())
        },
        errors: ["off-domain"; 2],
        answered: [907, 1105],
    },
    Question {
        entry: "geometry::Surface::closest_point",
        ask: |surface, a, b| {
            let found = surface.closest_point(&Point3::new(a, b, b))?;
            Ok(found.iter().copied().collect())
        },
        errors: ["no-closest-point", "off-domain"],
        answered: [761, 826],
    },
    Question {
        entry: "geometry::Surface::contact_at",
        ask: |surface, a, b| Ok(surface.contact_at(a, b)?.iter().copied().collect()),
        errors: ["off-domain"; 2],
        answered: [546, 729],
    },
];

fn all_finite(question: &Question, size: f64, answered: u32) -> Result<Answer, String> {
    let asked = extreme_pairs()
        .flat_map(|(a, b)| shapes(size).map(|(_, _, shape)| (question.ask)(&shape, a, b)));
    Answer::counted(asked, answered, &question.errors)
}

const fn form(form: &CurvatureForm) -> [f64; 3] {
    [form.k_uu, form.k_uv, form.k_vv]
}

/// One surface of every kind, about as large as `size`: its name, whether it is a graph over x and y, and itself.
fn shapes(size: f64) -> [(&'static str, bool, Shape); 9] {
    let parameters = [("h".to_owned(), 0.2 * size), ("s".to_owned(), size)];
    let wavy = Formula::parse("h*sin(x/s)*cos(y/s)", &parameters.into()).unwrap();
    let ellipsoid = Ellipsoid::new([size, 0.8 * size, 0.5 * size]).unwrap();
    [
        Shape::Sphere(Sphere::new(size).unwrap()),
        Shape::Dish(Dish::new(size).unwrap()),
        Shape::Plane(Plane),
        Shape::Cylinder(Cylinder::new(size, 0.4).unwrap()),
        Shape::Ellipsoid(ellipsoid),
        Shape::Torus(Torus::new(size, 0.3 * size).unwrap()),
        Shape::Paraboloid(Graph::paraboloid(0.5 / size).unwrap()),
        Shape::Saddle(Graph::saddle(0.2 / size).unwrap()),
        Shape::HeightField(Graph::of_formula(wavy)),
    ]
    .map(|shape| {
        let name = shape.name();
        let is_graph = ["paraboloid", "saddle", "height-field"].contains(&name);
        (name, is_graph, shape)
    })
}
