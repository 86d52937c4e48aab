//! Tests `palpate sensitivity`, which finds the field of a scene that changes the error most.

use super::desk::{Desk, STUDY, noiseless};

#[test]
fn effects_are_those_of_the_error_law() {
    let desk = Desk::with(STUDY);
    let command = "sensitivity c.toml --set object.radius=50 --trials 400";
    let answer = desk.json(&format!("{command} --out out"));
    let effects = answer["effects"].as_array().unwrap();
    // The effect of a field is the exponent of this field in the power law of the error. The error is the noise times
    // 1/R₁ + 1/R₂, where R₁ = 10 is the radius of the probe and R₂ = 50 the radius of the ball. So the exponents of R₁
    // and R₂ are −5/6 and −1/6. On a ball, the length and the rate of the roll have no effect.
    for (field, expected) in [
        ("scene.noise.angular_velocity.fraction", 1.0),
        ("scene.probe.radius_mm", -5.0 / 6.0),
        ("scene.object.radius_mm", -1.0 / 6.0),
        ("scene.motion.duration_s", 0.0),
        ("scene.motion.rate_rad_per_s", 0.0),
    ] {
        let found = effects.iter().find(|one| one["field"] == field);
        let effect = found.unwrap_or_else(|| panic!("no {field}: {answer}"));
        let off = effect["effect"].as_f64().unwrap() - expected;
        assert!(off.abs() < 0.02, "{effect}");
        assert!(effect["effect_std"].as_f64().unwrap() < 0.02, "{effect}");
    }
    assert_eq!(effects[0]["field"], "scene.noise.angular_velocity.fraction");
    let table = desk.table("out/sensitivity.csv");
    assert_eq!(
        table.text(0, "field"),
        "scene.noise.angular_velocity.fraction"
    );
    let figures = [
        "sensitivity.csv",
        "sensitivity.png",
        "sensitivity.svg",
        "sensitivity.txt",
    ];
    assert_eq!(desk.names("out"), figures);
    desk.palpate(command)
        .prints("not measured: scene.motion.spin_rad_per_s: it is 0");
    desk.assert_alike_on_any_threads(command, &["sensitivity.csv"]);
}

#[test]
fn scenes_and_settings_without_an_answer_are_refused() {
    let desk = Desk::with(&noiseless());
    desk.palpate("sensitivity c.toml")
        .fails(2, "no error that could change");
    desk.palpate("sensitivity c.toml --step 0")
        .fails(2, "step is 0; it must be above 0");
}
