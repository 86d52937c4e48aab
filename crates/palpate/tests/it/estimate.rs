//! Tests `palpate estimate roll` on readings without mistakes.

use serde_json::Value;

use super::desk::{Desk, assert_close, number_at};

/// Two noiseless rolls of a probe of radius 10 mm on a sphere of radius 40 mm.
const EXACT: &str = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm
0,0,-0.5,4,0
1,0.5,0,0,4
";

/// Noisy readings of four rolls of a probe of radius 10 mm on a sphere of radius 40 mm.
const SCATTERED: &str = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm
0,0,-0.5,4.1,0
1,0.5,0,0,4.1
2,0,0.5,-3.9,0
3,-0.5,0,0,-3.9
";

fn estimate(readings: &str, options: &str) -> Value {
    let desk = Desk::new();
    desk.write("r.csv", readings);
    desk.json(&format!("estimate roll r.csv --probe-radius 10 {options}"))
}

fn curvatures(json: &Value) -> [f64; 2] {
    ["normal_curvature_u", "normal_curvature_v"].map(|name| json[name]["value"].as_f64().unwrap())
}

#[test]
fn quantities_have_value_std_and_unit() {
    let json = estimate(SCATTERED, "--method least-squares");
    for (name, value, unit) in [
        ("normal_curvature_u", 0.025, "1/mm"),
        ("normal_curvature_v", 0.025, "1/mm"),
        ("gaussian_curvature", 0.025 * 0.025, "1/mm^2"),
        ("mean_curvature", 0.025, "1/mm"),
        ("arc_length", 4.0, "mm"),
    ] {
        let quantity = json[name].as_object().unwrap();
        assert_eq!(
            quantity.keys().collect::<Vec<_>>(),
            ["interval95", "std", "unit", "value"],
            "{name}"
        );
        assert_close(quantity["value"].as_f64().unwrap(), value, 1e-12);
        assert_eq!(quantity["unit"], unit);
        assert_eq!(quantity["std"].is_null(), name == "arc_length");
    }
    assert_eq!(json["probes"], 4);
    assert_eq!(json["method"], "least-squares");
    assert_eq!(json["unresolved_probes"], Value::Array(Vec::new()));
}

#[test]
fn intervals_use_students_t_unless_the_noise_is_stated() {
    let half_width = |options: &str| {
        let quantity = &estimate(SCATTERED, options)["mean_curvature"];
        let [low, high] = ["/interval95/0", "/interval95/1"].map(|end| number_at(quantity, end));
        assert_close(0.5 * (low + high), number_at(quantity, "/value"), 1e-12);
        (high - low) / (2.0 * number_at(quantity, "/std"))
    };
    // The half-width of the 95 % interval, divided by the standard deviation, is a quantile of a distribution. Without
    // stated noise, this is Student's t distribution with five degrees of freedom; with stated noise, the normal
    // distribution.
    assert_close(half_width(""), 2.570_582, 1e-6);
    assert_close(half_width("--shift-std 0.1"), 1.959_964, 1e-6);
}

#[test]
fn standard_errors_are_estimated_from_the_residuals() {
    let json = estimate(SCATTERED, "");
    assert_eq!(json["std_from"], "the residuals");
    // Four components of the shifts deviate by 0.1 mm. Four rolls have 8 components and the fit has 3 parameters, so
    // there are 5 degrees of freedom.
    let residual = (4.0 * 0.1_f64.powi(2) / 5.0).sqrt();
    assert_close(number_at(&json, "/residual_rms/value"), residual, 1e-9);
    // Two rolls of 0.5 rad determine the travel t = 8 mm of the contact per radian. The curvature is 1/t minus the
    // curvature of the probe. So its standard deviation is the standard deviation of t times 1/t² = 1/64.
    let std = residual / (0.5 * 2.0_f64.sqrt()) / 64.0;
    assert_close(number_at(&json, "/normal_curvature_u/std"), std, 1e-9);
}

#[test]
fn an_outlier_is_named_by_its_number() {
    // The contact moves by 4 mm per half radian, with errors of up to 0.02 mm. But the shift of probe 13 is 1 mm too
    // short.
    let rows = [
        "10,0,-0.5,4.02,0",
        "11,0.5,0,-0.02,4",
        "12,0,0.5,-4,0.02",
        "13,-0.5,0,0,-3",
        "14,0,-0.5,3.98,0.01",
        "15,0.5,0,0.01,3.98",
        "16,0,0.5,-4.01,-0.02",
        "17,-0.5,0,0.01,-4.01",
    ];
    let readings = format!(
        "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n{}\n",
        rows.join("\n")
    );
    let json = estimate(&readings, "--shift-std 0.02");
    assert!(json["p_value"].as_f64().unwrap() < 1e-6);
    let warnings = json["warnings"].to_string();
    for words in [
        r#""code":"outlier""#,
        r#""code":"poor-fit""#,
        "probe 13 contradicts the other readings",
    ] {
        assert!(warnings.contains(words), "{words}: {warnings}");
    }
    // If the noise is estimated, there is no p-value, but the warning nevertheless names the probe.
    let found = estimate(&readings, "");
    assert_eq!(found["p_value"], Value::Null);
    assert!(found["warnings"].to_string().contains("outlier"), "{found}");
}

#[test]
fn without_residuals_there_is_no_standard_error() {
    let json = estimate(EXACT, "");
    assert_eq!(json["normal_curvature_u"]["std"], Value::Null);
    assert!(json["std_from"].as_str().unwrap().starts_with("none"));
    for curvature in curvatures(&json) {
        assert_close(curvature, 0.025, 1e-12);
    }
}

#[test]
fn standard_errors_follow_from_the_pitch() {
    let json = estimate(SCATTERED, "--pitch 0.3");
    assert_eq!(json["std_from"], "the pads' pitch");
    let std = 0.3 / 6.0_f64.sqrt() / (0.5 * 2.0_f64.sqrt()) / 64.0;
    assert_close(number_at(&json, "/normal_curvature_u/std"), std, 1e-9);
    assert_eq!(curvatures(&json), curvatures(&estimate(SCATTERED, "")));
}

#[test]
fn a_contact_that_did_not_move_bounds_the_radius() {
    let readings = format!("{EXACT}12,0,-0.11,0,0\n13,0,0,0,0\n");
    let bound = |options| {
        let unresolved = estimate(&readings, options)["unresolved_probes"].clone();
        // Only probe 12 is listed as unresolved, because probe 13 did not roll at all.
        assert_eq!(unresolved.as_array().unwrap().len(), 1);
        assert_eq!(unresolved[0]["probe"], 12);
        assert_eq!(unresolved[0]["unit"], "mm");
        unresolved[0]["radius_below"].clone()
    };
    // Probe 12, of radius R₁, turned by 0.11 rad, but its contact moved by less than the pitch of 1 mm. On an object of
    // radius R₂, this means R₁R₂/(R₁ + R₂) · 0.11 < 1, which is a bound on R₂.
    assert_close(bound("--pitch 1").as_f64().unwrap(), 100.0, 1e-9);
    // Even on a plane the contact would have moved by only 1.1 mm, so a pitch of 6 mm gives no bound.
    assert_eq!(bound("--pitch 6"), Value::Null);
    assert_eq!(bound(""), Value::Null);
}
