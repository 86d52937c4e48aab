//! Claim 9: what the second fit adds to the first (1996 paper, sections 4.2 and 4.3).

use super::evidence::{geometric_mean, percent, range, short, span};
use super::finding::Finding;
use super::patches::{FIRST_PASS, GAUSSIAN, MEAN, Patches, TWO_PASS, times};
use crate::Study;

/// The noises at which the fits are compared: those that the paper discusses, in inter-finger distances.
const NOISES: [f64; 2] = [0.05, 0.1];
/// "Dramatically": the rms error is at least halved.
const DRAMATIC: f64 = 2.0;

/// Claim 9.
pub(super) fn improves_dramatically(study: &Study) -> Result<Finding, String> {
    let patches = Patches::of(study)?;
    let objects = patches.objects(TWO_PASS);
    if objects.is_empty() {
        return Err(format!("the table has no estimator labelled {TWO_PASS:?}"));
    }
    let (mut parts, mut holds) = (Vec::new(), true);
    for noise in NOISES {
        let gaussian = gains(&patches, GAUSSIAN, TWO_PASS, noise)?;
        let mean = gains(&patches, MEAN, TWO_PASS, noise)?;
        holds &= gaussian.0 >= DRAMATIC && mean.0 >= DRAMATIC;
        let told = |(average, range): (f64, (f64, f64))| {
            format!("{} ({})", short(average), span(range, short))
        };
        parts.push(format!(
            "at {} noise {} for K and {} for H",
            percent(noise),
            told(gaussian),
            told(mean)
        ));
    }
    let beyond: Vec<String> = patches
        .other_methods()
        .into_iter()
        .filter_map(|method| beyond(&patches, method))
        .collect();
    let beyond = if beyond.is_empty() {
        String::new()
    } else {
        format!(" Beyond the paper's letter: {}.", beyond.join("; "))
    };
    Ok(Finding {
        holds,
        measured: format!(
            "The rms error of the first fit alone over that of both, as a geometric mean over {} surfaces (range): {}.{beyond}",
            objects.len(),
            parts.join(", "),
        ),
        why: format!(
            "Holds if that mean is at least {DRAMATIC} for K and H at both noises: a dramatic gain halves the error at least."
        ),
    })
}

/// The rms error of the first fit over that of `method`: geometric mean over the surfaces, and range.
fn gains(
    patches: &Patches<'_>,
    quantity: &str,
    method: &str,
    noise: f64,
) -> Result<(f64, (f64, f64)), String> {
    let objects = patches.objects(method);
    let ratio = |object: &&str| {
        let first = patches.rms(quantity, object, FIRST_PASS, noise)?;
        Ok(first / patches.rms(quantity, object, method, noise)?)
    };
    let ratios = objects
        .iter()
        .map(ratio)
        .collect::<Result<Vec<f64>, String>>()?;
    geometric_mean(&ratios)
        .zip(range(ratios.iter().copied()))
        .ok_or_else(|| format!("the table has no estimator labelled {method:?}"))
}

/// The gains of another method, if the table has them.
fn beyond(patches: &Patches<'_>, method: &str) -> Option<String> {
    let at = |noise: f64| {
        let gain = |quantity| Some(times(gains(patches, quantity, method, noise).ok()?.0));
        Some(format!(
            "{} and {} at {}",
            gain(GAUSSIAN)?,
            gain(MEAN)?,
            percent(noise)
        ))
    };
    let parts = NOISES
        .into_iter()
        .map(at)
        .collect::<Option<Vec<String>>>()?;
    Some(format!("{method} {}", parts.join(", ")))
}
