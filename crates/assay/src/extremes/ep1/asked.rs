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
        let input = format!("noise {part} from 1e-300 to 1e300: finite deviations");
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
            let drive = Vector2::new(angle.cos(), angle.sin()) * 0.1;
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

fn noises(part: usize) -> Outcome {
    let mut found = vec![0.0];
    for exponent in (-300..=300).step_by(10) {
        let noise = noise(part, 10f64.powi(exponent));
        for radius in [1e-9, 1.0, 1e9] {
            found.extend(estimate(radius, noise, &good()).iter().flat_map(numbers));
        }
    }
    Answer::finite(found).into()
}

fn pairs() -> Outcome {
    let mut found = vec![0.0];
    for rotation in EXTREME {
        for shift in EXTREME {
            let mut readings = good();
            readings[0].rotation.x = rotation;
            readings[1].shift.y = shift;
            readings[2].shift.x = rotation;
            let noise = noise(2, 1e-3);
            found.extend(estimate(1.0, noise, &readings).iter().flat_map(numbers));
        }
    }
    Answer::finite(found).into()
}
