//! Claims 1 and 2: noise in the angular velocity (1996 paper, section 4.1.1).

use super::evidence::{
    convex_rows, groups, near, numbers, percent, range, roll_angle, short, span,
};
use super::finding::Finding;
use crate::Study;

const NOISE: &str = "scene.noise.angular_velocity.fraction";
const QUANTITY: &str = "normal_curvature_u";

/// From this R₂/R₁ up the paper calls the growth of the error dramatic, …
const FLAT: f64 = 50.0;
/// … which we take as a mean error of at least this many times the noise, …
const DRAMATIC: f64 = 10.0;
/// … if up to this R₂/R₁ …
const ROUND: f64 = 5.0;
/// … it is at most this many times the noise.
const TAME: f64 = 2.0;
/// Amplification is compared with 1 + 1/RCR up to this noise, where it is linear, …
const SMALL_NOISE: f64 = 0.01;
/// … and must agree to this share.
const AMPLIFICATION_AGREES: f64 = 0.05;
/// A length that "does not matter" changes the mean error by at most this share.
const UNAFFECTED: f64 = 0.05;

/// Row of the table: 1/RCR, noise and errors.
struct Sample {
    flatness: f64,
    noise: f64,
    mean: f64,
    rms: Option<f64>,
}

fn sample(study: &Study, row: usize) -> Result<Option<Sample>, String> {
    let radius = numbers(study, &[row], "scene.probe.radius")?[0];
    let noise = numbers(study, &[row], NOISE)?[0];
    let statistic = |name: &str| study.cells().statistic(row, name);
    let (Some(truth), Some(mean)) = (statistic("truth"), statistic("relative_mean_abs_error"))
    else {
        return Ok(None);
    };
    let flatness = 1.0 / (truth * radius);
    Ok((noise > 0.0).then_some(Sample {
        flatness,
        noise,
        mean,
        rms: statistic("relative_rms_error"),
    }))
}

/// Claim 1.
pub(super) fn grows_as_rcr_falls(study: &Study) -> Result<Finding, String> {
    let rows = convex_rows(study, QUANTITY)?;
    let (mut pairs, mut growing) = (0, 0);
    let mut samples = Vec::new();
    for group in groups(study, &rows, &["scene.object", "scene.probe"]) {
        let mut group: Vec<Sample> = group
            .into_iter()
            .filter_map(|row| sample(study, row).transpose())
            .collect::<Result<_, _>>()?;
        group.sort_by(|a, b| a.flatness.total_cmp(&b.flatness));
        for pair in group
            .windows(2)
            .filter(|pair| !near(pair[0].flatness, pair[1].flatness))
        {
            pairs += 1;
            growing += usize::from(pair[1].mean > pair[0].mean);
        }
        samples.extend(group);
    }
    let gain = |keep: fn(f64) -> bool| {
        range(
            samples
                .iter()
                .filter(|s| keep(s.flatness))
                .map(|s| s.mean / s.noise),
        )
    };
    let flat = gain(|f| f >= FLAT * (1.0 - 1e-9))
        .ok_or(format!("no object with R₂ of {FLAT} R₁ or more"))?;
    let round = gain(|f| f <= ROUND * (1.0 + 1e-9))
        .ok_or(format!("no object with R₂ of {ROUND} R₁ or less"))?;
    let amplification = amplification(study, &samples);

    let mut measured = format!(
        "The mean error rises in {growing} of {pairs} steps to a lower relative curvature; it is {} × the noise for R₂ ≥ {FLAT} R₁, {} × for R₂ ≤ {ROUND} R₁.",
        span(flat, short),
        span(round, short),
    );
    if let Some(ratio) = amplification {
        measured += &format!(
            " The rms error is {} × the predicted noise × (1 + 1/RCR)/√12.",
            span(ratio, short)
        );
    }
    let agrees = amplification.is_none_or(|(low, high)| {
        low >= 1.0 - AMPLIFICATION_AGREES && high <= 1.0 + AMPLIFICATION_AGREES
    });
    Ok(Finding {
        holds: pairs > 0 && growing == pairs && flat.0 >= DRAMATIC && round.1 <= TAME && agrees,
        measured,
        why: format!(
            "Holds if it rises in every step, is at least {DRAMATIC} × the noise from R₂ = {FLAT} R₁ up and at most {TAME} × up to {ROUND} R₁{}.",
            match amplification {
                Some(_) => format!(
                    ", and the prediction is met to {} up to {} noise",
                    percent(AMPLIFICATION_AGREES),
                    percent(SMALL_NOISE)
                ),
                None => String::new(),
            }
        ),
    })
}

/// Range of measured over predicted rms error, where the prediction applies: independent uniform errors, one
/// per probe, of eight probes (four of which see each direction).
fn amplification(study: &Study, samples: &[Sample]) -> Option<(f64, f64)> {
    let word = |path: &str| study.setting(path).and_then(toml::Value::as_str);
    let applies = word("scene.noise.angular_velocity.kind") == Some("uniform")
        && word("scene.noise.angular_velocity.when").is_none_or(|when| when == "per-probe")
        && study
            .setting("scene.motion.directions_deg")
            .is_none_or(is_two_in_each_direction);
    let small = samples
        .iter()
        .filter(|s| applies && s.noise <= SMALL_NOISE * (1.0 + 1e-9));
    range(small.filter_map(|s| Some(s.rms? * 12f64.sqrt() / (s.noise * (1.0 + s.flatness)))))
}

/// Whether these directions are the paper's: two probes in each of ±u and ±v.
fn is_two_in_each_direction(directions: &toml::Value) -> bool {
    let degrees = |value: &toml::Value| {
        let number = value.as_float();
        number.or_else(|| value.as_integer().map(|integer| integer as f64))
    };
    let given: Option<Vec<f64>> = directions
        .as_array()
        .and_then(|array| array.iter().map(degrees).collect());
    given.is_some_and(|given| given == [0.0, 0.0, 90.0, 90.0, 180.0, 180.0, 270.0, 270.0])
}

/// Claim 2.
pub(super) fn length_does_not_matter(study: &Study) -> Result<Finding, String> {
    match study
        .setting("scene.object.kind")
        .and_then(toml::Value::as_str)
    {
        Some("sphere") => {}
        Some(other) => return Err(format!("the object is no sphere but a {other}")),
        None => return Err("scene.object.kind is not in the config".to_owned()),
    }
    let rows = convex_rows(study, QUANTITY)?;
    let (mut lengths, mut changes) = (Vec::new(), Vec::new());
    for group in groups(study, &rows, &["scene.motion"]) {
        let mut errors = Vec::new();
        for row in group {
            let length = roll_angle(study, row)
                .ok_or("the table and the config do not tell the length of the rolls")?;
            if let Some(sample) = sample(study, row)? {
                errors.push((length, sample.mean));
            }
        }
        let Some((shortest, longest)) = range(errors.iter().map(|e| e.0)) else {
            continue;
        };
        let Some((low, high)) = range(errors.iter().map(|e| e.1)) else {
            continue;
        };
        if !near(shortest, longest) && high > 0.0 {
            lengths.extend([shortest, longest]);
            changes.push((high - low) / high);
        }
    }
    let (Some(lengths), Some((_, change))) = (range(lengths), range(changes.iter().copied()))
    else {
        return Err("the table has one length of roll only".to_owned());
    };
    Ok(Finding {
        holds: change <= UNAFFECTED,
        measured: format!(
            "From the shortest to the longest roll ({}, rad or arc length) the mean error changes by at most {}, over {} combinations of radius and noise.",
            span(lengths, short),
            percent(change),
            changes.len(),
        ),
        why: format!(
            "Holds if no combination changes by more than {}.",
            percent(UNAFFECTED)
        ),
    })
}
