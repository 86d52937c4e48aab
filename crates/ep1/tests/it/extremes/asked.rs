//! Readings and noises that nobody means.

use palpate_ep1::{Ep1Error, Estimate, LeastSquares, ProbeReading, ReadingNoise};
use palpate_geometry::CurvatureForm;
use palpate_verdict::{Answer, NO_LENGTHS, NOT_FINITE, decades, extreme_pairs, rows};

use crate::readings;

const NEW: &str = "ep1::LeastSquares::new";
const OF: &str = "ep1::LeastSquares::of";
/// Number of the 61 sizes of each noise with which probes of three radii tell the curvature; beyond them the
/// deviations leave the doubles.
const ANSWERED: [[usize; 3]; 4] = [[36, 38, 40], [35, 38, 39], [35, 38, 39], [61, 61, 61]];

rows! {
    NEW, "radius {bad:e}", if bad == f64::MAX { "unresolved" } else { "out-of-range" } =>
        estimate(bad, none(), &good()), for bad in NO_LENGTHS;
    OF, "{name} {bad:e}", "not-finite" => estimate(1.0, none(), &with(part, bad)),
        for bad in NOT_FINITE,
        for (part, name) in ["rotation x", "rotation y", "shift u", "shift v"].into_iter().enumerate();
    NEW, "noise {name} {bad:e}", "out-of-range" => estimate(1.0, noise(part, bad), &good()),
        for bad in NOT_FINITE,
        for (part, name) in ["relative", "rotation", "shift", "resolution"].into_iter().enumerate();
    NEW, "noise {part} of -1", "out-of-range" => estimate(1.0, noise(part, -1.0), &good()), for part in 0..4;
    OF, "noise {part} from 1e-300 to 1e300, radius {radius:e}: the curvature's error over its bound" =>
        noises(part, radius, answered),
        for (part, answered) in ANSWERED.into_iter().enumerate().filter(|(part, _)| *part != 1),
        for (radius, answered) in [1e-9, 1.0, 1e9].into_iter().zip(answered);
    OF, "noise shift 1e200: deviations beyond the doubles", "out-of-range" => estimate(1.0, noise(2, 1e200), &good());
    OF, "no probe", "too-few-probes" => estimate(1.0, none(), &[]);
    OF, "one probe", "too-few-probes" => estimate(1.0, none(), &good()[..1]);
    OF, "eight probes alike", "unresolvable" => estimate(1.0, none(), &[good()[0]; 8]);
    OF, "probes that did not turn", "unresolvable" => estimate(1.0, none(), &[ProbeReading::default(); 8]);
    OF, "contacts that did not move", "unresolved" => estimate(1.0, none(), &moved(0.0));
    OF, "contacts that moved backwards", "not-rolling" => estimate(1.0, none(), &moved(-1.0));
    OF, "256 pairs of extreme rotations and shifts: finite" => pairs();
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
    let directions = [0.0, 1.0, 2.0].map(|direction| (direction, 0.1));
    readings(1.0, &CurvatureForm::isotropic(0.5), &directions)
}

fn with(part: usize, bad: f64) -> Vec<ProbeReading> {
    let mut readings = good();
    let ProbeReading { rotation, shift } = &mut readings[1];
    let numbers = if part < 2 { rotation } else { shift };
    numbers[part % 2] = bad;
    readings
}

/// Contacts that moved by that share of their way.
fn moved(share: f64) -> Vec<ProbeReading> {
    let mut readings = good();
    readings
        .iter_mut()
        .for_each(|reading| reading.shift *= share);
    readings
}

fn estimate(
    radius: f64,
    noise: ReadingNoise,
    readings: &[ProbeReading],
) -> Result<Estimate, Ep1Error> {
    LeastSquares::of(radius, noise, readings)
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

/// Whatever the noise, exact readings tell `k = 1.5 − 1/R`, within the bound stated, and deviations are finite, or out
/// of range.
fn noises(part: usize, radius: f64, answered: usize) -> Result<Answer, Ep1Error> {
    let estimates = decades(-300, 300, 10).map(|std| estimate(radius, noise(part, std), &good()));
    let in_range = estimates.filter(|one| !matches!(one, Err(Ep1Error::OutOfRange)));
    let estimates: Vec<Estimate> = in_range.collect::<Result<_, _>>()?;
    assert_eq!(estimates.len(), answered);
    let truth = 1.5 - 1.0 / radius;
    let ratio = (truth * radius).abs();
    let allowed = 1e-15 * (2.0 + 1.0 / ratio + ratio) * truth.abs();
    let forms = estimates.iter().map(|estimate| estimate.curvature);
    let found = forms.flat_map(|form| [form.k_uu, form.k_vv]);
    let pairs = found.map(|found| ((found - truth) / allowed, 0.0));
    let answer = Answer::all_at_scale(pairs, 1.0).within(1.0);
    Ok(answer.also(estimates.iter().flat_map(numbers)))
}

fn pairs() -> Result<Answer, String> {
    let calls = extreme_pairs().map(|(rotation, shift)| {
        let mut readings = good();
        readings[0].rotation.x = rotation;
        readings[1].shift.y = shift;
        readings[2].shift.x = rotation;
        estimate(1.0, noise(2, 1e-3), &readings).map(|estimate| numbers(&estimate))
    });
    Answer::counted(
        calls,
        50,
        &[
            "not-finite",
            "out-of-range",
            "unresolved",
            "not-rolling",
            "unresolvable",
        ],
    )
}
