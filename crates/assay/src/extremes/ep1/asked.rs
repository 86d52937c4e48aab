//! Readings and noises that nobody means.

use nalgebra::Vector2;
use palpate_ep1::{Ep1Error, Estimate, LeastSquares, ProbeReading, ReadingNoise};

use super::super::answer::Named;
use super::super::hostile::{EXTREME, NO_LENGTHS, NOT_FINITE};
use super::super::{Answer, Case, Outcome};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for bad in NO_LENGTHS {
        let input = format!("radius {bad:e}");
        cases.push(Case::refusal("ep1::LeastSquares::new", input, move || {
            estimate(bad, none(), &good())
        }));
    }
    for bad in NOT_FINITE {
        for part in 0..4 {
            let names = ["rotation x", "rotation y", "shift u", "shift v"];
            let input = format!("{} {bad:e}", names[part]);
            cases.push(Case::refusal("ep1::LeastSquares::of", input, move || {
                let mut readings = good();
                let reading = &mut readings[1];
                match part {
                    0 => reading.rotation.x = bad,
                    1 => reading.rotation.y = bad,
                    2 => reading.shift.x = bad,
                    _ => reading.shift.y = bad,
                }
                estimate(1.0, none(), &readings)
            }));
        }
        for part in 0..4 {
            let input = format!(
                "noise {} {bad:e}",
                ["relative", "rotation", "shift", "resolution"][part]
            );
            cases.push(Case::refusal("ep1::LeastSquares::new", input, move || {
                estimate(1.0, noise(part, bad), &good())
            }));
        }
    }
    for part in 0..4 {
        let input = format!("noise {part} of -1");
        cases.push(Case::refusal("ep1::LeastSquares::new", input, move || {
            estimate(1.0, noise(part, -1.0), &good())
        }));
        let input =
            format!("noise {part} from 1e-300 to 1e300: the curvature's error over its bound");
        cases.push(Case::new("ep1::LeastSquares::of", input, move || {
            noises(part)
        }));
    }
    for (input, readings) in [
        ("no probe", vec![]),
        ("one probe", good()[..1].to_vec()),
        ("eight probes alike", vec![good()[0]; 8]),
        ("probes that did not turn", vec![ProbeReading::default(); 8]),
        ("contacts that did not move", still()),
        ("contacts that moved backwards", backwards()),
    ] {
        cases.push(Case::refusal("ep1::LeastSquares::of", input, move || {
            estimate(1.0, none(), &readings)
        }));
    }
    cases.push(Case::new(
        "ep1::LeastSquares::of",
        "256 pairs of extreme rotations and shifts: finite",
        pairs,
    ));
    cases
}

fn none() -> ReadingNoise {
    ReadingNoise::default()
}

fn noise(part: usize, size: f64) -> ReadingNoise {
    let mut noise = none();
    match part {
        0 => noise.relative_rotation_std = size,
        1 => noise.rotation_std_rad = size,
        2 => noise.shift_std = size,
        _ => noise.shift_resolution = size,
    }
    noise
}

/// Three probes of radius 1 on a sphere of radius 2.
fn good() -> Vec<ProbeReading> {
    [0.0, 1.0, 2.0]
        .map(|angle: f64| {
            let drive = Vector2::new(libm::cos(angle), libm::sin(angle)) * 0.1;
            ProbeReading {
                rotation: Vector2::new(drive.y, -drive.x),
                shift: drive / 1.5,
            }
        })
        .to_vec()
}

fn still() -> Vec<ProbeReading> {
    let still = |reading: ProbeReading| ProbeReading {
        shift: Vector2::zeros(),
        ..reading
    };
    good().into_iter().map(still).collect()
}

fn backwards() -> Vec<ProbeReading> {
    let turned = |reading: ProbeReading| ProbeReading {
        shift: -reading.shift,
        ..reading
    };
    good().into_iter().map(turned).collect()
}

fn estimate(
    radius: f64,
    noise: ReadingNoise,
    readings: &[ProbeReading],
) -> Result<Estimate, Named> {
    LeastSquares::of(radius, noise, readings).map_err(|error: Ep1Error| Named(error.name()))
}

/// All that an estimate says, with its deviations.
fn numbers(estimate: &Estimate) -> Vec<f64> {
    let form = estimate.curvature;
    let measured = [
        estimate.normal_curvature_u,
        estimate.normal_curvature_v,
        estimate.gaussian_curvature,
        estimate.mean_curvature,
    ];
    let deviations = measured.iter().filter_map(|measured| measured.std);
    (measured.iter().map(|measured| measured.value))
        .chain(deviations)
        .chain([form.k_uu, form.k_uv, form.k_vv, estimate.arc_length])
        .chain(estimate.mobility().iter().copied())
        .collect()
}

/// Whatever the noise, exact readings tell `k = 1.5 − 1/R`, within the bound stated, and deviations are finite.
fn noises(part: usize) -> Outcome {
    let levels = (-300..=300)
        .step_by(10)
        .map(|exponent| 10f64.powi(exponent));
    let asked = levels.flat_map(|level| [1e-9, 1.0, 1e9].map(|radius| (level, radius)));
    let mut pairs = Vec::new();
    let mut all = Vec::new();
    let mut refused = None;
    for (level, radius) in asked {
        match estimate(radius, noise(part, level), &good()) {
            Ok(estimate) => {
                let form = estimate.curvature;
                let truth = 1.5 - 1.0 / radius;
                let ratio = (truth * radius).abs();
                let allowed = 1e-15 * (2.0 + 1.0 / ratio + ratio) * truth.abs();
                let off = |found: f64| ((found - truth) / allowed, 0.0);
                pairs.extend([form.k_uu, form.k_vv].map(off));
                all.extend(numbers(&estimate));
            }
            Err(error) => refused = Some(error),
        }
    }
    match refused {
        Some(error) if pairs.is_empty() => Err::<Answer, _>(error).into(),
        _ => Answer::all_at_scale(pairs, 1.0)
            .within(1.0)
            .also(all)
            .into(),
    }
}

fn pairs() -> Outcome {
    let pairs = EXTREME
        .into_iter()
        .flat_map(|rotation| EXTREME.map(|shift| (rotation, shift)));
    Outcome::of_all(pairs.map(|(rotation, shift)| {
        let mut readings = good();
        readings[0].rotation.x = rotation;
        readings[1].shift.y = shift;
        readings[2].shift.x = rotation;
        estimate(1.0, noise(2, 1e-3), &readings).map(|estimate| numbers(&estimate))
    }))
}
