//! Sensors without contact: strain of the folded skin, image area of markers, and cutting patterns.

use palpate_estimators::CutPattern;
use palpate_scene::{Scene, Scenes};
use palpate_study::config::{Study, parse};

const GORES: &str =
    r#"layout = { kind = "gores", gores = 4, rows = [1, 3, 3, 5, 7], row_spacing_deg = 11.9 }"#;
const DISCS: &str = "discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 }";

fn text(probe: &str, lines: &str) -> String {
    format!(
        r#"name = "a-study"
length_unit = "mm"

[scene]
kind = "fingertip"
probe = {{ kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, {probe} }}
{lines}
"#
    )
}

fn study(text: &str) -> Study {
    parse("study.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn values(text: &str) -> Vec<(&'static str, f64)> {
    let scene = study(text)
        .estimable_scene(0)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.trials(1000), 1);
    let mut values = Vec::new();
    scene
        .trial(0, |quantity, outcome| {
            values.push((scene.quantities()[quantity].name, outcome.estimate));
        })
        .unwrap();
    values
}

#[test]
fn folding_strain_equals_the_closed_form() {
    let strains = values(&text(GORES, ""));
    assert_eq!(strains.len(), 2);
    // At the upper end of a seam, the shear is s = π/n, where n is the number of gores (flat pieces of the skin). The
    // largest stretch at this end is σ = s/2 + √(1 + s²/4), and the strain is σ − 1.
    let shear = std::f64::consts::PI / 4.0;
    let greatest = 0.5 * shear + (1.0 + 0.25 * shear * shear).sqrt() - 1.0;
    assert_eq!(strains[0].0, "greatest_fold_strain");
    assert!((strains[0].1 - greatest).abs() < 1e-12, "{strains:?}");
    assert_eq!(strains[1].0, "rms_fold_strain");
    assert!(strains[1].1 < 0.5 * greatest, "{strains:?}");
}

#[test]
fn the_image_area_follows_from_the_lens() {
    let area = |lens: &str, polar_deg: f64| {
        let lines = format!(
            "sensor = {{ lens = \"{lens}\", size_px = 640, field_deg = 65 }}\nview = {{ polar_deg = {polar_deg} }}"
        );
        let found = values(&text(&format!("{GORES}, {DISCS}"), &lines));
        assert_eq!(found[2].0, "marker_area");
        found[2].1
    };
    let polar = 50_f64.to_radians();
    // At the polar angle θ, an equidistant lens magnifies areas by θ/sin θ, and a pinhole lens by 1/cos³ θ.
    let fisheye = area("fisheye", 50.0) / area("fisheye", 0.0);
    assert!(
        (fisheye / (polar / libm::sin(polar)) - 1.0).abs() < 2e-3,
        "{fisheye}"
    );
    let pinhole = area("pinhole", 50.0) / area("pinhole", 0.0);
    assert!(
        (pinhole * libm::cos(polar).powi(3) - 1.0).abs() < 2e-2,
        "{pinhole}"
    );
    // At the apex, the image of the magenta disc is larger than the image of the yellow disc, so the area of the
    // magenta disc is the marker's area. The magenta disc has a diameter of 2 mm and is 17 mm away from the camera. The
    // focal length is f = 319.5 px / 65°.
    let f = 319.5 / 65_f64.to_radians();
    let expected = std::f64::consts::PI * (f / 17.0_f64).powi(2);
    let apex = area("fisheye", 0.0);
    assert!((apex / expected - 1.0).abs() < 5e-3, "{apex} {expected}");
    // This skin is not folded from gores (flat pieces), so it has no strain of folding.
    let lattice = "layout = { kind = \"lattice\", pitch = 6.0, cap_deg = 60.0 }";
    let camera = "sensor = { lens = \"fisheye\", size_px = 640, field_deg = 65 }";
    let unfolded = values(&text(&format!("{lattice}, {DISCS}"), camera));
    assert_eq!(unfolded, [("marker_area", apex)]);
}

#[test]
fn a_marker_beyond_the_field_fails_as_out_of_field() {
    let lines = "view = { polar_deg = 80 }";
    let scene = study(&text(&format!("{GORES}, {DISCS}"), lines))
        .estimable_scene(0)
        .unwrap();
    assert_eq!(scene.trial(0, |_, _| ()), Err("out-of-field"));
    assert!(matches!(scene, Scene::Sensor(_)));
}

#[test]
fn a_pattern_is_drawn_in_millimetres() {
    let probe = format!("{GORES}, {DISCS}");
    let in_mm = CutPattern::of(&study(&text(&probe, ""))).unwrap();
    assert_eq!((in_mm.gores, in_mm.markers), (4, 77));
    assert!(in_mm.dxf.contains("MAGENTA") && in_mm.svg.contains("mm"));
    assert_eq!(in_mm.strain_by_gores.rows.len(), 10);
    assert!(
        (in_mm.strain.rows.iter().flatten())
            .map(|field| field.parse::<f64>().unwrap())
            .all(f64::is_finite)
    );
    let in_cm = text(&probe, "")
        .replace("\"mm\"", "\"cm\"")
        .replace(
            "radius = 20.0, marker_depth = 2.0",
            "radius = 2.0, marker_depth = 0.2",
        )
        .replace(
            "= 2.0, yellow_diameter = 2.0, separation = 2.0",
            "= 0.2, yellow_diameter = 0.2, separation = 0.2",
        );
    assert_eq!(CutPattern::of(&study(&in_cm)).unwrap().dxf, in_mm.dxf);
}

#[test]
fn patterns_that_cannot_be_are_refused_at_the_field() {
    let probe = format!("{GORES}, {DISCS}");
    let plain = text(&probe, "");
    for (text, path) in [
        (plain.replace("length_unit = \"mm\"", ""), "length_unit"),
        (
            plain.replace("gores = 4", "gores = 1"),
            "scene.probe.layout.gores",
        ),
        (
            text(
                &format!("layout = {{ kind = \"lattice\", pitch = 4.0, cap_deg = 60 }}, {DISCS}"),
                "",
            ),
            "scene.probe.layout",
        ),
        (text(GORES, ""), "scene.probe"),
        (
            plain.replace("yellow_diameter = 2.0", "yellow_diameter = 4.5"),
            "scene.probe.discs",
        ),
        (
            plain.replace("row_spacing_deg = 11.9", "row_spacing_deg = 20.0"),
            "scene.probe.layout",
        ),
        (
            plain.replace("radius = 20.0", "radius = 1e9"),
            "scene.probe.radius",
        ),
        (
            plain.replace("separation = 2.0", "separation = 5.0"),
            "scene.probe.discs.separation",
        ),
    ] {
        let error = match parse("study.toml", &text) {
            Ok(study) => CutPattern::of(&study).unwrap_err(),
            Err(error) => error,
        };
        assert_eq!(error.path, path, "{error}");
    }
    let rolling = "name = \"a\"\n[scene]\nkind = \"roll\"\nprobe = { kind = \"sphere\", radius = 1 }\nobject = { kind = \"plane\" }\nmotion = { rate_rad_per_s = 0.1, duration_s = 1.0 }\n";
    let error = CutPattern::of(&study(rolling)).unwrap_err();
    assert_eq!(error.path, "scene.kind");
}

#[test]
fn discs_wider_than_the_sensor_have_no_area() {
    let lattice = r#"layout = { kind = "lattice", pitch = 4.0, cap_deg = 65.0 }"#;
    let wide = DISCS.replace("magenta_diameter = 2.0", "magenta_diameter = 60.0");
    let scene = study(&text(&format!("{lattice}, {wide}"), "")).estimable_scene(0);
    let error = scene.map(|_| ()).unwrap_err();
    assert!(error.path.starts_with("scene.probe.discs"), "{error}");
}
