//! Exact readings, as far as doubles hold them: curvature told from far flatter to far sharper than the
//! probe.

use nalgebra::Vector2;
use palpate_ep1::{Ep1Error, Estimate, LeastSquares, ProbeReading, ReadingNoise};
use palpate_verdict::{Answer, Precise, rows};

const OF: &str = "ep1::LeastSquares::of";
const RATIOS: [f64; 9] = [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e11];

rows! {
    OF, "probe {radius:e}, curvature of {ratio:e} times its" => isotropic(radius, ratio, 0.1),
        for ratio in RATIOS, for radius in [1e-9, 1.0, 1e9];
    OF, "curvature of {ratio:e} times the probe's" => isotropic(1.0, ratio, 0.1),
        for ratio in RATIOS[..5].iter().map(|ratio| -0.9 * ratio);
    OF, "ridge of {ratio:e} times the probe's curvature, flat along it" => ridge(ratio), for ratio in RATIOS;
    OF, "probes of {theta:e} rad" => isotropic(1.0, 0.3, theta),
        for theta in [1e-40, 1e-12, 1e-6, 1e-3, 1.0, 6000.0, 1e40];
    OF, "probes of {theta:e} rad", "out-of-range" => isotropic(1.0, 0.3, theta), for theta in [1e-100, 1e-60, 1e60];
    OF, "probes of 1e100 rad", "unresolvable" => isotropic(1.0, 0.3, 1e100);
    OF, "hollow of 1 - {gap:e} of the probe's curvature" => isotropic(1.0, gap - 1.0, 0.1),
        for gap in [1e-3, 1e-6, 1e-9, 1e-12];
    OF, "probes that turn {across:e} times as far across as along" => lopsided(across),
        for across in [1.0, 1e-2, 1e-4, 1e-5];
    OF, "probes that turn {across:e} times as far across as along", "unresolvable" => lopsided(across),
        for across in [0.0, 1e-9, 1e-7];
    OF, "contacts that move by {along:e} and {across:e} of their way on a plane", "unresolved" => moved(along, across),
        for [along, across] in [[1e-14, 1e-14], [1e-14, -1e-14], [-1e-14, -1e-14], [0.5, -1e-14]];
    OF, "contacts that move by {along:e} and {across:e} of their way on a plane", "not-rolling" => moved(along, across),
        for [along, across] in [[1e-12, -0.5], [0.5, -0.5], [-0.5, -0.5]];
    OF, "curvature of {ratio:e} times the probe's: not resolved", "unresolved" => isotropic(1.0, ratio, 0.1),
        for ratio in [1e13, 1e16, 1e100];
}

fn of(radius: f64, readings: &[ProbeReading]) -> Result<Estimate, Ep1Error> {
    LeastSquares::of(radius, ReadingNoise::default(), readings)
}

fn moved(along: f64, across: f64) -> Result<Estimate, Ep1Error> {
    of(
        1.0,
        &readings(1.0, [1.0 / along - 1.0, 1.0 / across - 1.0], 0.1, 1.0),
    )
}

/// `Δp_i = g_i/(K₁ + k_i)` of eight probes, where the object's axes are the probe's.
fn readings(radius: f64, curvatures: [f64; 2], theta: f64, across: f64) -> Vec<ProbeReading> {
    let eighth = std::f64::consts::FRAC_PI_4;
    (0..8)
        .map(|probe| {
            let (sin, cos) = libm::sincos(f64::from(probe) * eighth + 0.1);
            let drive = [cos * theta, sin * theta * across];
            let shift = [0, 1].map(|axis| {
                let relative = 1.0 / Precise::new(radius) + curvatures[axis];
                (Precise::new(drive[axis]) / relative).to_f64()
            });
            ProbeReading {
                rotation: Vector2::new(drive[1], -drive[0]),
                shift: Vector2::from(shift),
            }
        })
        .collect()
}

/// All that an estimate says.
fn numbers(estimate: &Estimate) -> [f64; 8] {
    let form = estimate.curvature;
    [
        form.k_uu,
        form.k_uv,
        form.k_vv,
        estimate.gaussian_curvature.value,
        estimate.mean_curvature.value,
        estimate.arc_length,
        estimate.mobility()[(0, 0)],
        estimate.mobility()[(1, 1)],
    ]
}

/// The bound stated: `1e-15 (2 + K₁/|k| + |k|/K₁)`.
fn isotropic(radius: f64, ratio: f64, theta: f64) -> Result<Answer, Ep1Error> {
    let curvature = ratio / radius;
    let readings = readings(radius, [curvature; 2], theta, 1.0);
    let estimate = of(radius, &readings)?;
    let form = estimate.curvature;
    let pairs = [(form.k_uu, curvature), (form.k_vv, curvature)];
    let bound = 1e-15 * (2.0 + 1.0 / ratio.abs() + ratio.abs());
    // A hollow that nearly fits magnifies: `K₁/(K₁ + k)`.
    let condition = estimate.amplification(0.0).unwrap_or(1.0).abs() / (1.0 + ratio).min(1.0);
    Ok(Answer::all_near(pairs)
        .within(bound)
        .conditioned(condition)
        .also(numbers(&estimate)))
}

/// Flat along u, sharp along v; errors on the scale of the probe's curvature and the object's.
fn ridge(ratio: f64) -> Result<Answer, Ep1Error> {
    let readings = readings(1.0, [0.0, ratio], 0.1, 1.0);
    let estimate = of(1.0, &readings)?;
    let form = estimate.curvature;
    let pairs = [(form.k_uu, 0.0), (form.k_vv, ratio), (form.k_uv, 0.0)];
    let answer = Answer::all_at_scale(pairs, 1.0 + ratio).within(1e-15 * (2.0 + ratio));
    Ok(answer.also(numbers(&estimate)))
}

/// The condition number of the normal equations is the square of the ratio.
fn lopsided(across: f64) -> Result<Answer, Ep1Error> {
    let readings = readings(1.0, [0.5, 0.5], 0.1, across);
    let estimate = of(1.0, &readings)?;
    let form = estimate.curvature;
    let pairs = [(form.k_uu, 0.5), (form.k_vv, 0.5)];
    Ok(Answer::all_near(pairs)
        .within(1e-14)
        .conditioned(across.powi(-2))
        .also(numbers(&estimate)))
}
