//! Coverage of the intervals of EP1 on random rolls, and its warnings if readings contradict the model.
//!
//! The intervals are those of the normal distribution if the noise is stated, and of Student's if it is estimated from the
//! residuals.

use anyhow::Result;
use palpate_ep1::{LeastSquares, ReadingNoise};

use super::coverage::{Score, Sums, Tally, below_5_percent, contain_truth};
use super::roll_case::{Case, Family, Flaw, RADIUS};
use super::{Options, case_scores, scenes};

/// Scores of all families. `report` gets each as soon as it is computed.
///
/// # Errors
/// If a scene cannot be set up, or `report` fails.
pub fn scores(options: Options<'_>, report: impl Fn(&Score) -> Result<()>) -> Result<Vec<Score>> {
    case_scores(Family::all(), Family::name, options, report, |family| {
        let scenes = scenes(options, |number| {
            tally(
                &Case::random(*family, options.seed, number)?,
                options.trials,
            )
        })?;
        Ok([score(family, &scenes)])
    })
}

/// Trials of a scene.
fn tally(case: &Case, trials: u64) -> Result<Tally> {
    let mut tally = Tally {
        sums: Sums::new(2.0 * trials as f64),
        ..Tally::default()
    };
    for trial in 0..trials {
        let readings = case.readings(trial)?;
        let (fit, mut estimate) = match LeastSquares::fitted(case.radius, case.stated, &readings) {
            Ok(fitted) => fitted,
            Err(error) => {
                tally.failures.add([error.name()]);
                continue;
            }
        };
        let goodness = fit.goodness(&estimate, &readings);
        let misfits = fit.misfits(&estimate, &readings);
        if goodness.is_none() {
            // As `estimate roll` does without a stated noise.
            let noise = ReadingNoise {
                shift_std: estimate.residual(&readings).0,
                ..case.stated
            };
            estimate = LeastSquares::of(case.radius, noise, &readings)?;
        }
        let warnings = misfits.iter().map(|misfit| misfit.code());
        tally.add_estimate(goodness.map(|fit| fit.p_value), warnings);
        let both = [
            (estimate.normal_curvature_u, case.truth.k_uu),
            (estimate.normal_curvature_v, case.truth.k_vv),
        ];
        for (measured, truth) in both {
            let (error, std) = (measured.value - truth, measured.std.unwrap_or(0.0));
            let hits = contain_truth(error, std, case.half_widths);
            tally.sums.add_hits(error, std, hits);
        }
    }
    Ok(tally)
}

/// Score of a family from its scenes.
fn score(family: &Family, scenes: &[Tally]) -> Score {
    let sum = |part: fn(&Tally) -> f64| scenes.iter().map(part).sum::<f64>();
    let all: Vec<&Tally> = scenes.iter().collect();
    let (score, shares) = Score::new(family.name(), &all);
    let width = 2.0 * family.half_widths()[2] * RADIUS * sum(|scene| scene.sums.std)
        / sum(|scene| scene.sums.estimates);
    Score {
        width: Some(width),
        below_5_percent: Some(below_5_percent(scenes)),
        is_within_limits: match family.flaw {
            Flaw::Radius => None,
            _ if family.is_wrong() => Some(shares.meet_limits()),
            _ => Some(shares.false_alarms_are_rare()),
        },
        ..score
    }
}

/// Configs of rolls with the smallest and the largest values of each sound family, with the family's name. Lengths, angles
/// and noise are divided or multiplied by `factor`.
#[cfg(test)]
pub(super) fn configs(factor: f64) -> Vec<(String, String)> {
    let sound = Family::all().into_iter().filter(Family::is_sound);
    let ends = |family: Family| [0, 1].map(|end| (family.name(), family.config(end, factor)));
    sound.flat_map(ends).collect()
}
