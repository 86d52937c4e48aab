//! Tests `palpate estimate press` with simulated markers.

use super::desk::{Desk, number_at};

#[test]
fn both_curvatures_of_a_roller_are_estimated() {
    // These readings are of a press on a roller with a radius of 10 mm. They were computed by boundary elements, which
    // do not assume Hertz's contact law.
    let desk = Desk::new();
    desk.write(
        "r.csv",
        include_str!("../../../../examples/press-roller.csv"),
    );
    let line = "estimate press r.csv --sensor-radius 20 --depth 0 --method elliptic";
    let estimate = desk.json(line);
    for (name, curvature) in [("curvature_max", 0.1), ("curvature_min", 0.0)] {
        let end = |end| number_at(&estimate, &format!("/principal/{name}/interval95/{end}"));
        assert!(end(0) <= curvature && curvature <= end(1), "{estimate}");
        assert!(end(1) - end(0) < 0.02, "{estimate}");
    }
    let axis = number_at(&estimate, "/principal/axis_deg");
    assert!((axis.abs() - 90.0).abs() < 2.0, "{axis}");
}
