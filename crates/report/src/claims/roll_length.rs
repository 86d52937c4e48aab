//! Claims 3 and 4: the length of the roll on a paraboloid z = −c r² (1996 paper, section 4.1.2), scored at
//! equal arc lengths. Lengths are in probe radii.

use super::evidence::{convex_rows, near, numbers, percent, range, short, span};
use super::finding::Finding;
use crate::Study;

/// The arc lengths at which paraboloids are compared.
const SHORT: f64 = 0.1;
const LONG: f64 = 0.3;
/// The paper's line between a good estimate and a bad one.
const GOOD: f64 = 0.15;
/// "Rapidly": tripling the length more than triples the error, where the error is still below one half.
const RAPID: f64 = 3.0;
const SATURATED: f64 = 0.5;
/// The paraboloid that the paper gives up, and the range that it keeps.
const HOPELESS: f64 = 5.0;
const KEPT: (f64, f64) = (0.01, 1.0);

/// Row of the table: the paraboloid, the arc length, the noise and the mean relative error.
struct Sample {
    c: f64,
    length: f64,
    noise: f64,
    error: f64,
}

fn samples(study: &Study) -> Result<Vec<Sample>, String> {
    let rows = convex_rows(study, "normal_curvature_u")?;
    let radius = numbers(study, &rows, "scene.probe.radius")?;
    let c = numbers(study, &rows, "scene.object.c")?;
    let length = numbers(study, &rows, "scene.motion.arc_length")?;
    let sample = |(at, row): (usize, &usize)| {
        let error = study.cells().statistic(*row, "relative_mean_abs_error")?;
        let noise = study
            .number(*row, "scene.noise.angular_velocity.fraction")
            .unwrap_or(0.0);
        Some(Sample {
            c: c[at] * radius[at],
            length: length[at] / radius[at],
            noise,
            error,
        })
    };
    Ok(rows.iter().enumerate().filter_map(sample).collect())
}

/// The paraboloids for which `keep` holds, flattest first.
fn paraboloids(samples: &[Sample], keep: impl Fn(f64) -> bool) -> Vec<f64> {
    let mut all: Vec<f64> = samples.iter().map(|s| s.c).filter(|c| keep(*c)).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| near(*a, *b));
    all
}

fn kept(samples: &[Sample]) -> Vec<f64> {
    paraboloids(samples, |c| {
        c >= KEPT.0 * (1.0 - 1e-9) && c <= KEPT.1 * (1.0 + 1e-9)
    })
}

/// The noiseless error at one place.
fn noiseless(samples: &[Sample], c: f64, length: f64) -> Result<f64, String> {
    samples
        .iter()
        .find(|s| near(s.c, c) && near(s.length, length) && s.noise == 0.0)
        .map(|s| s.error)
        .ok_or_else(|| {
            format!(
                "no noiseless estimate for c = {} at an arc length of {length} R₁",
                short(c)
            )
        })
}

/// Claim 3.
pub(super) fn grows_rapidly(study: &Study) -> Result<Finding, String> {
    let samples = samples(study)?;
    let (mut growth, mut parts) = (Vec::new(), Vec::new());
    for c in paraboloids(&samples, |_| true).into_iter().rev() {
        let (near_end, far_end) = (
            noiseless(&samples, c, SHORT)?,
            noiseless(&samples, c, LONG)?,
        );
        parts.push(format!(
            "{} and {} (c = {})",
            percent(near_end),
            percent(far_end),
            short(c)
        ));
        if far_end < SATURATED && near_end > 0.0 {
            growth.push(far_end / near_end);
        }
    }
    let hopeless = noiseless(&samples, HOPELESS, SHORT)?;
    let growth =
        range(growth).ok_or("no paraboloid has an error between 0 and one half at both lengths")?;
    Ok(Finding {
        holds: growth.0 >= RAPID && hopeless > GOOD,
        measured: format!(
            "Without noise, at arc lengths of {SHORT} and {LONG} R₁: {}. Tripling the length multiplies errors below {} by {}.",
            parts.join(", "),
            percent(SATURATED),
            span(growth, short),
        ),
        why: format!(
            "Holds if tripling the length multiplies those errors by at least {RAPID}, and c = {HOPELESS} is off by more than {} already at {SHORT} R₁.",
            percent(GOOD)
        ),
    })
}

/// Claim 4.
pub(super) fn within_15_percent(study: &Study) -> Result<Finding, String> {
    let samples = samples(study)?;
    let kept = kept(&samples);
    let [flattest, .., sharpest] = kept.as_slice() else {
        return Err(format!(
            "fewer than two paraboloids with c from {} to {}",
            KEPT.0, KEPT.1
        ));
    };
    if !near(*flattest, KEPT.0) || !near(*sharpest, KEPT.1) {
        return Err(format!(
            "the paraboloids c = {} and c = {} are not both in the table",
            KEPT.0, KEPT.1
        ));
    }
    let mut worst: f64 = 0.0;
    for &c in &kept {
        worst = worst
            .max(noiseless(&samples, c, SHORT)?)
            .max(noiseless(&samples, c, LONG)?);
    }
    let off = samples
        .iter()
        .filter(|s| s.noise == 0.0)
        .map(|s| (s.error - exact_error(s.c * s.length)).abs());
    let off = off.fold(0.0, f64::max);
    let crossings = match off > 1e-6 {
        true => format!(
            "Noiseless errors differ from the closed form by up to {}.",
            percent(off)
        ),
        false => {
            let all = paraboloids(&samples, |_| true).into_iter().rev();
            let all = all.map(|c| format!("{:.4} R₁ (c = {})", crossing() / c, short(c)));
            format!(
                "{} is crossed at {}.",
                percent(GOOD),
                all.collect::<Vec<_>>().join(", ")
            )
        }
    };
    let noisy = noisy(&samples, &kept);
    let noisy = if noisy.is_empty() {
        String::new()
    } else {
        format!(
            " With noise, at {LONG} R₁, the worst mean error of c = 1 to 0.01 is {}.",
            noisy.join(", ")
        )
    };
    Ok(Finding {
        holds: worst <= GOOD,
        measured: format!(
            "Without noise the worst error of c = 1 to 0.01 at arc lengths of {SHORT} and {LONG} R₁ is {}. {crossings}{noisy}",
            percent(worst),
        ),
        why: format!(
            "Holds if every c from 1 to 0.01 is within {} without noise at both lengths. Crossings follow from the closed form, a slope angle of atan(2 c r) at the end of the arc. The paper states radii of 500 to 2.5 for C of 5 to 0.01, which contradict each other: the apex of z = −C r² has the radius 1/(2C), 0.1 to 50 R₁, which is used here.",
            percent(GOOD)
        ),
    })
}

/// Twice c times the arc length from the apex of z = −c r² to where the slope is `x`.
fn arc(x: f64) -> f64 {
    0.5 * (x * libm::hypot(1.0, x) + libm::asinh(x))
}

/// The slope up to which a condition holds.
fn slope(is_below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1e9);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match is_below(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

/// Relative error of the curvature at the apex without noise, of a roll over `share`, c times the arc length: the mean
/// curvature along the roll is its slope angle over the arc length.
fn exact_error(share: f64) -> f64 {
    let end = slope(|x| arc(x) < 2.0 * share);
    1.0 - libm::atan(end) / (2.0 * share)
}

/// c times the arc length at which the error without noise is 15 %.
fn crossing() -> f64 {
    let end = slope(|x| libm::atan(x) > (1.0 - GOOD) * arc(x));
    0.5 * arc(end)
}

/// The worst mean error among `kept` at each level of noise.
fn noisy(samples: &[Sample], kept: &[f64]) -> Vec<String> {
    let mut levels: Vec<f64> = samples
        .iter()
        .map(|s| s.noise)
        .filter(|noise| *noise > 0.0)
        .collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| near(*a, *b));
    let worst = |level: f64| {
        let here = samples
            .iter()
            .filter(|s| near(s.noise, level) && near(s.length, LONG));
        let errors = here
            .filter(|s| kept.iter().any(|c| near(*c, s.c)))
            .map(|s| s.error);
        range(errors).map(|(_, worst)| format!("{} at {} noise", percent(worst), percent(level)))
    };
    levels.into_iter().filter_map(worst).collect()
}
