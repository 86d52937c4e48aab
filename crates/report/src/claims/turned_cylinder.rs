//! Claim 13: a cylinder across the parameters of a tensor product (1996 paper, sections 4.2 and 4.3).

use super::evidence::{geometric_mean, near, percent, short, span};
use super::finding::Finding;
use super::patches::{GAUSSIAN, MEAN, Patches, TWO_PASS, times};
use crate::Study;

const STRAIGHT: &str = "cylinder";
const TURNED: &str = "turned cylinder";
/// Compared up to this noise, in inter-finger distances: beyond it the paper calls the method unreliable anyway.
const NOISIEST: f64 = 0.1;
/// An effect makes the turned cylinder's rms error of K larger by at least this factor: an rms error over some
/// hundred trials is itself uncertain by a few percent.
const EFFECT: f64 = 1.1;

/// Claim 13.
pub(super) fn is_fitted_worse(study: &Study) -> Result<Finding, String> {
    let patches = Patches::of(study)?;
    let noises = patches.noises(|noise| noise > 0.0 && noise <= NOISIEST * (1.0 + 1e-9));
    let [least, ..] = noises.as_slice() else {
        return Err(format!(
            "the table has no noise up to {}",
            percent(NOISIEST)
        ));
    };
    let most = noises.iter().copied().fold(*least, f64::max);
    let gaussian = ratio(&patches, GAUSSIAN, TWO_PASS, &noises)?;
    let mean = ratio(&patches, MEAN, TWO_PASS, &noises)?;
    let (straight, turned) = (
        patches.share(STRAIGHT, TWO_PASS, most)?,
        patches.share(TURNED, TWO_PASS, most)?,
    );
    let others: Vec<String> = patches
        .other_methods()
        .into_iter()
        .filter_map(|method| {
            Some(format!(
                "{method} {}",
                times(ratio(&patches, GAUSSIAN, method, &noises).ok()?)
            ))
        })
        .collect();
    let others = if others.is_empty() {
        String::new()
    } else {
        format!(" Beyond the paper's letter, for K: {}.", others.join(", "))
    };
    let levels = if near(*least, most) {
        percent(most)
    } else {
        span((100.0 * least, 100.0 * most), short) + " %"
    };
    Ok(Finding {
        holds: gaussian >= EFFECT,
        measured: format!(
            "The rms error of two-pass on the turned cylinder is {} that on the straight one for K and {} for H (geometric means over noises of {levels}); at {} it classifies {} of the turned and {} of the straight one correctly.{others}",
            times(gaussian),
            times(mean),
            percent(most),
            percent(turned),
            percent(straight),
        ),
        why: format!("Holds if the error of K is at least {EFFECT} times as large."),
    })
}

/// The rms error on the turned cylinder over that on the straight one, as a geometric mean over `noises`.
fn ratio(
    patches: &Patches<'_>,
    quantity: &str,
    method: &str,
    noises: &[f64],
) -> Result<f64, String> {
    let at = |noise: &f64| {
        let turned = patches.rms(quantity, TURNED, method, *noise)?;
        Ok(turned / patches.rms(quantity, STRAIGHT, method, *noise)?)
    };
    let ratios = noises
        .iter()
        .map(at)
        .collect::<Result<Vec<f64>, String>>()?;
    geometric_mean(&ratios).ok_or_else(|| "the table has no noise".to_owned())
}
