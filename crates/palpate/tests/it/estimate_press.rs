//! Tests `palpate estimate press` with simulated markers.

use super::desk::{Desk, assert_close, number_at};

#[test]
fn equal_displacements_of_all_markers_are_no_contact() {
    for moved in [0.0, 0.3, -0.3] {
        let mut readings = "x_mm,y_mm,normal_displacement_mm\n".to_owned();
        for row in 0..49 {
            let [x, y] = [row % 7, row / 7].map(|step| 3 * step - 9);
            readings += &format!("{x},{y},{moved}\n");
        }
        for options in [
            "",
            "--indentation 1",
            "--baseline fitted",
            "--normal-std 0.05",
        ] {
            let desk = Desk::new();
            desk.write("r.csv", &readings);
            let line = format!("estimate press r.csv --sensor-radius 20 --depth 2 {options}");
            desk.palpate(&line).fails(1, "no contact was found");
        }
    }
}

#[test]
fn estimates_scale_with_the_unit_of_length() {
    // Normal displacement of the surface at the distance r from the centre of a Hertz contact. The effective radius is
    // 12, and the indentation is 1. Within the contact, the displacement is 1 − r²/24; outside, it decreases.
    let surface = |r: f64| {
        let ratio = r / 12.0_f64.sqrt();
        if ratio <= 1.0 {
            return 1.0 - r * r / 24.0;
        }
        let angle = libm::asin(ratio.recip());
        ((2.0 - ratio * ratio) * angle + (ratio * ratio - 1.0).sqrt()) / std::f64::consts::PI
    };
    for scale in [1.0, 1e-9, 1e9] {
        let mut readings = "radial_position,normal_displacement\n".to_owned();
        for step in -20..=20 {
            let position = 0.5 * f64::from(step);
            let moved = surface(position.abs()) * scale;
            readings += &format!("{},{moved}\n", position * scale);
        }
        let desk = Desk::new();
        desk.write("r.csv", &readings);
        let line = format!("estimate press r.csv --sensor-radius {}", 20.0 * scale);
        let estimate = desk.json(&line);
        for (name, value) in [
            ("effective_radius", 12.0),
            ("object_radius", 30.0),
            ("indentation", 1.0),
        ] {
            let found = number_at(&estimate, &format!("/{name}/value"));
            assert_close(found / scale, value, 1e-5);
        }
        assert_eq!(estimate["object_radius"]["unit"], "unit");
    }
}

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

#[test]
fn a_flat_pad_has_an_infinite_radius() {
    let desk = Desk::new();
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/press-flat-pad.csv"
    );
    for options in [
        "",
        "--indentation 0.5 --indentation-std 0.01",
        "--method elliptic",
    ] {
        let line = format!("estimate press {file} --sensor-radius inf --depth 0 {options}");
        let estimate = desk.json(&line);
        let ends = ["0", "1"]
            .map(|end| number_at(&estimate, &format!("/object_curvature/interval95/{end}")));
        assert!(ends[0] < 0.25 && 0.25 < ends[1], "{options}: {ends:?}");
        assert_eq!(estimate["relative_curvature"], estimate["object_curvature"]);
        let codes = estimate["warnings"].as_array().unwrap().iter();
        assert!(codes.map(|one| &one["code"]).eq(["large-contact"]));
    }
    let line =
        format!("estimate press {file} --sensor-radius inf --method bonded-layer --thickness 1e6");
    desk.palpate(&line).prints("\"verdict\": \"convex\"");
}
