//! Compares the final contacts of five rolls with the results of an independent program. Positions are accurate to
//! 1e-9, and path lengths to 1e-6.

use nalgebra::Point3;
use palpate_geometry::Shape;
use palpate_rolling::{Chart, HeldAxis, Motion};

use crate::scenes::{dop853, ellipsoid, height_field, paraboloid, roll, saddle, sphere};

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

#[test]
fn both_forms_of_the_contact_equations_have_the_golden_contacts() {
    let cases = cases();
    assert_eq!(cases.len(), 5);
    for case in cases {
        for chart in [Chart::Free, Chart::Montana(HeldAxis::Transported)] {
            let model = dop853(1e-12, chart);
            let end = roll(case.radius, &case.object, case.start, model, case.motion);
            let on_object = (end.on_object - case.on_object).amax();
            let on_probe = (end.on_probe(case.radius) - case.on_probe).amax();
            let arc = (end.arc_length - case.arc_length).abs();
            let what = format!(
                "{} {chart:?}: {on_object:e} {on_probe:e} {arc:e}",
                case.name
            );
            assert!(on_object < 1e-9 && on_probe < 1e-9 && arc < 1e-6, "{what}");
        }
    }
}
