//! Compares the final contacts of five rolls with the results of an independent program. Positions are accurate to
//! 1e-9, and path lengths to 1e-6.

use nalgebra::Point3;
use palpate_geometry::Shape;
use palpate_rolling::{Chart, HeldAxis, Model, Motion};

use crate::scenes::{difference, ellipsoid, height_field, paraboloid, roll, saddle, sphere};

struct Case {
    name: String,
    object: Shape,
    start: (f64, f64),
    motion: Motion,
    radius: f64,
    on_object: Point3<f64>,
    on_probe: Point3<f64>,
    arc_length: f64,
}

fn cases() -> Vec<Case> {
    let mut reader = csv::Reader::from_reader(include_str!("golden.csv").as_bytes());
    reader
        .records()
        .map(|record| {
            let record = record.unwrap();
            let number = |column: usize| record[column].parse::<f64>().unwrap();
            let parameter = |name: &str| -> f64 {
                let pair = record[2]
                    .split(' ')
                    .find_map(|pair| pair.strip_prefix(name))
                    .unwrap();
                pair.strip_prefix('=').unwrap().parse().unwrap()
            };
            let object = match &record[1] {
                "paraboloid" => paraboloid(parameter("c")),
                "saddle" => saddle(parameter("a")),
                "ellipsoid" => ellipsoid(parameter("a"), parameter("b"), parameter("c")),
                "sphere" => sphere(parameter("radius")),
                "height-field" => height_field(
                    "A*sin(k*x)*cos(k*y)",
                    &[("A", parameter("A")), ("k", parameter("k"))],
                ),
                other => panic!("unknown object {other}"),
            };
            Case {
                name: record[0].to_owned(),
                object,
                start: (number(3), number(4)),
                motion: Motion::rolling(number(5).to_radians(), number(6), number(7)),
                radius: number(8),
                on_object: Point3::new(number(9), number(10), number(11)),
                on_probe: Point3::new(number(12), number(13), number(14)),
                arc_length: number(15),
            }
        })
        .collect()
}

fn check(chart: Chart) {
    let model = Model::Dop853 {
        tolerance: 1e-12,
        chart,
    };
    let cases = cases();
    assert_eq!(cases.len(), 5);
    for case in cases {
        let end = roll(case.radius, &case.object, case.start, model, case.motion);
        let on_object = (end.on_object - case.on_object).amax();
        let on_probe = (end.on_probe(case.radius) - case.on_probe).amax();
        let arc = (end.arc_length - case.arc_length).abs();
        assert!(
            on_object < 1e-9,
            "{}: on object off by {on_object:e}",
            case.name
        );
        assert!(
            on_probe < 1e-9,
            "{}: on probe off by {on_probe:e}",
            case.name
        );
        assert!(arc < 1e-6, "{}: arc off by {arc:e}", case.name);
    }
}

#[test]
fn chart_free() {
    check(Chart::Free);
}

#[test]
fn montana() {
    check(Chart::Montana(HeldAxis::Transported));
}

#[test]
fn both_forms_agree() {
    for case in cases() {
        let end = |chart| {
            let model = Model::Dop853 {
                tolerance: 1e-12,
                chart,
            };
            roll(case.radius, &case.object, case.start, model, case.motion)
        };
        let free = end(Chart::Free);
        let charts = end(Chart::Montana(HeldAxis::Transported));
        let off = difference(&free, &charts, case.radius);
        assert!(off < 1e-9, "{}: {off:e}", case.name);
    }
}
