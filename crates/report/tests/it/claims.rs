//! Tests each claim with tables that agree with it, tables that contradict it, and tables without the numbers that it
//! needs.

use crate::fixture::{Cells, Numbers, angular_velocity, config, differs, holds, untestable};
use palpate_report::{Study, Verdict, score};

// ---- Claims 1 and 2: noise in the angular velocity

#[test]
fn claim_1_differs_if_the_error_does_not_grow_or_the_prediction_fails() {
    let axes = "scene.object.radius_cm,scene.noise.angular_velocity.fraction";
    let table = |error: fn(f64) -> f64| {
        let mut cells = Cells::new(axes);
        for radius in [500.0, 50.0, 5.0] {
            cells.push(
                &format!("{radius},0.01"),
                Numbers::new(1.0 / radius, error(radius)),
            );
        }
        cells.study(&config("sphere", "claims = [1]"))
    };
    differs(&table(|_| 0.1), &["0 of 2 steps"]);
    // The error grows with the radius of the object, as the claim states. But it is 1.1 times as large as predicted, so
    // the verdict must be `differs`.
    differs(
        &table(|r| 0.011 * (1.0 + r) / 12f64.sqrt()),
        &["1.1 × the predicted"],
    );
}

#[test]
fn claim_1_needs_flat_objects_and_a_noise() {
    let mut cells = Cells::new("scene.object.radius_cm");
    cells.push("5", Numbers::new(0.2, 0.01));
    let study = cells.study(&config("sphere", "claims = [1]"));
    untestable(&study, &["steps to a lower relative curvature"]);
    let without = config("sphere", "claims = [1]").replace("fraction = 0.01", "std = 0.01");
    untestable(
        &cells.study(&without),
        &["scene.noise.angular_velocity.fraction"],
    );
}

#[test]
fn claim_2_compares_lengths() {
    let table = |growth: f64, kind: &str| {
        let mut cells = Cells::new("scene.object.radius_cm,scene.motion.duration_s");
        for radius in [5.0, 1.0] {
            for duration in [1.0, 2.0, 5.0] {
                cells.push(
                    &format!("{radius},{duration}"),
                    Numbers::new(1.0 / radius, 0.01 + growth * duration),
                );
            }
        }
        cells.study(&config(kind, "claims = [2]"))
    };
    holds(&table(0.0, "sphere"), &["0.1 to 0.5"]);
    differs(&table(0.001, "sphere"), &["26.7 %"]);
    untestable(&table(0.0, "paraboloid"), &["of a sphere"]);
    let study = angular_velocity("claims = [2]");
    untestable(&study, &["rolls of different length"]);
}

// ---- Claims 3 and 4: the length of the roll

/// A study of rolls on paraboloids z = −c r², with and without noise. `error` computes the relative error of the
/// curvature without noise from the coefficient c and the arc length of the roll.
fn paraboloids(claims: &str, error: impl Fn(f64, f64) -> f64) -> Study {
    let mut cells = Cells::new(
        "scene.object.c_per_cm,scene.motion.arc_length_cm,scene.noise.angular_velocity.fraction",
    );
    for c in [5.0, 1.0, 0.5, 0.1, 0.01] {
        for length in [0.01, 0.03, 0.1, 0.3, 1.0] {
            for noise in [0.0, 0.01] {
                let error = error(c, length).max(noise);
                cells.push(
                    &format!("{c},{length},{noise}"),
                    Numbers::new(2.0 * c, error),
                );
            }
        }
    }
    cells.study(&config("paraboloid", claims))
}

#[test]
fn claims_3_and_4_differ_for_other_errors() {
    let study = paraboloids("claims = [3, 4]", |_, length| 0.6 * length);
    let scores = score(&[study]);
    differs(&scores[0], &["by 3"]);
    differs(
        &scores[1],
        &["18 %", "differ from the closed form by up to 60 %"],
    );
}

#[test]
fn claims_3_and_4_name_the_cell_they_lack() {
    let mut cells = Cells::new("scene.object.c_per_cm,scene.motion.arc_length_cm");
    cells.push("1,0.1", Numbers::new(2.0, 0.02));
    let noiseless =
        config("paraboloid", "claims = [3, 4]").replace("fraction = 0.01", "fraction = 0.0");
    let study = cells.study(&noiseless);
    let scores = score(&[study]);
    untestable(&scores[0], &["tripling the length"]);
    untestable(&scores[1], &["c = 0.01"]);
}

// ---- Claims 5 to 8 and 20: pads

/// A study of rolls on a square grid of pads. Without random offsets of the pads, a roll starts at the centre of a pad.
/// The only error of this roll is that the measured shift of the contact is rounded to whole pads. With random offsets,
/// `random` computes the relative error of the curvature from the pitch of the pads, the radius of the object and the
/// rate of rotation.
fn pads(claims: &str, random: impl Fn(f64, f64, f64) -> f64) -> Study {
    let mut cells = Cells::new(
        "scene.sensor.pitch_cm,scene.object.radius_cm,scene.sensor.offset,scene.motion.rate_rad_per_s",
    );
    for pitch in [0.001, 0.01, 0.05, 0.1] {
        for radius in [500.0, 50.0, 5.0, 1.0, 0.5, 0.2] {
            for rate in [0.1, 0.2, 0.5, 1.0] {
                let shift = rate / (1.0 + 1.0 / radius);
                let read = (shift / pitch + 1e-9_f64).round() * pitch;
                let (estimate, truth) = (rate / read - 1.0, 1.0 / radius);
                let error = (estimate - truth).abs() / truth;
                let centred = if read == 0.0 {
                    Numbers {
                        truth: Some(truth),
                        trials: 1,
                        failures: 1,
                        ..Numbers::default()
                    }
                } else {
                    Numbers {
                        trials: 1,
                        mean: Some(estimate),
                        ..Numbers::new(truth, error)
                    }
                };
                cells.push(&format!("{pitch},{radius},centred,{rate}"), centred);
                let random = Numbers::new(truth, random(pitch, radius, rate));
                cells.push(&format!("{pitch},{radius},random,{rate}"), random);
            }
        }
    }
    cells.study(&config("sphere", claims))
}

/// Relative error of the curvature estimate from a roll, if the measured shift of the contact on the probe is rounded
/// to whole pads.
fn rounding(pitch: f64, radius: f64, rate: f64) -> f64 {
    0.2 * pitch / rate * (1.0 + radius).powi(2) / radius
}

#[test]
fn claim_8_takes_half_a_radian_however_a_roll_is_given() {
    for (column, motion, of) in [
        (
            "scene.motion.angle_deg",
            "angle_deg = 1",
            (|_| 0.5_f64.to_degrees()) as fn(f64) -> f64,
        ),
        // Arc length of a roll by θ = 0.5 rad: θ/(1/R₁ + 1/R₂), with the radii R₁ = 2 of the probe and R₂ of the
        // object.
        ("scene.motion.arc_length_cm", "arc_length = 1", |radius| {
            0.5 / (0.5 + 1.0 / radius)
        }),
    ] {
        let mut cells = Cells::new(&format!(
            "scene.sensor.pitch_cm,scene.object.radius_cm,{column}"
        ));
        for radius in [10.0, 0.4] {
            let numbers = Numbers::new(1.0 / radius, 0.2);
            cells.push(&format!("0.1,{radius},{}", of(radius)), numbers);
        }
        let text = config("sphere", "claims = [8]")
            .replace("radius = 1.0", "radius = 2.0")
            .replace("rate_rad_per_s = 0.1, duration_s = 1.0", motion);
        holds(&cells.study(&text), &["20 % (centred, R₂ = 5 R₁)"]);
    }
}

#[test]
fn pad_claims_differ_for_the_opposite() {
    let study = pads("claims = [5, 7, 8]", |pitch, radius, rate| {
        0.01 * rate / pitch / radius
    });
    let scores = score(&[study]);
    differs(&scores[0], &["0 of 72 steps"]);
    differs(&scores[1], &["in 0 of 24"]);
    let study = pads("claims = [8]", |_, _, _| 0.26);
    differs(&study, &["26 % (random offsets"]);
    // Claim 7 uses the rms error of the longest roll, divided by that of the shortest roll. For one object, the error
    // of the shortest roll is 0 here, so the ratio is undefined, and the claim must ignore this object.
    let study = pads("claims = [7]", |pitch, radius, rate| {
        if rate < 0.15 && radius == 1.0 {
            0.0
        } else {
            rounding(pitch, radius, rate)
        }
    });
    holds(&study, &["in 20 of 20"]);
}

#[test]
fn claim_6_differs_without_zeros_and_claim_20_without_bounds() {
    let mut cells = Cells::new("scene.object.radius_cm,scene.sensor.pitch_cm");
    for radius in [50.0, 5.0] {
        cells.push(&format!("{radius},0.1"), Numbers::new(1.0 / radius, 0.5));
    }
    let study = cells.study(&config("sphere", "claims = [6, 20]"));
    let scores = score(&[study]);
    differs(&scores[0], &["0 of 2 cells"]);
    differs(
        &scores[1],
        &["the numbers of these trials are 0 (R₂ = 5 R₁)"],
    );
}

// ---- Claim 21: the sensor in the wrist

fn wrist(factor: f64) -> Study {
    let mut cells = Cells::new("scene.sensor,scene.object.radius_cm");
    for (label, error) in [
        ("wrist 0.54 mm", 0.54 * factor),
        ("pads 0.5 mm", 0.5),
        ("pads 1 mm", 1.0),
        ("pads 2 mm", 2.0),
    ] {
        for radius in [5.0, 1.0] {
            cells.push(
                &format!("{label},{radius}"),
                Numbers::new(1.0 / radius, error * (1.0 + radius)),
            );
        }
    }
    cells.study(&config("sphere", "claims = [21]"))
}

#[test]
fn claim_21_holds_within_its_factor_and_finds_the_pads_it_acts_like() {
    holds(&wrist(1.2), &["1.3 ×"]);
    differs(&wrist(3.0), &["3.24 ×", "pads of 1.62 mm"]);
}

// ---- All claims

#[test]
fn unknown_claims_and_other_quantities_are_not_testable() {
    let study = angular_velocity("claims = [23]");
    untestable(&study, &["no claim"]);
    let mut cells = Cells::new("scene.object.radius_cm");
    cells.push("5", Numbers::new(-0.2, 0.1));
    let study = cells.study(&config(
        "dish",
        "claims = [1, 2, 3, 4, 5, 6, 7, 8, 14, 18, 19, 20, 21, 22]",
    ));
    for score in score(&[study]) {
        assert_eq!(score.verdict, Verdict::NotTestable, "{score:?}");
        assert!(!score.why.is_empty() && !score.paper_says.is_empty() && score.measured.is_empty());
    }
}
