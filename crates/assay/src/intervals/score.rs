//! How often intervals hold, and how wide they are.

use std::fmt;

use anyhow::Result;
use nalgebra::Vector3;
use palpate_ep2::{Curvature, Ep2Error, Method, Patch, Penalised};
use palpate_statistics::NORMAL_95;
use serde::Serialize;

use super::case::{Case, Sweep};
use super::options::Options;
use super::sums::{HOLDS, Sums, within};
use super::surface::{Place, Surface};

/// How often the intervals of a case hold, on all its surfaces or those of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// The case.
    pub case: String,
    /// Kind of the surfaces; `all` for all.
    pub on: &'static str,
    /// `gaussian_curvature` or `mean_curvature`.
    pub quantity: &'static str,
    /// Number of surfaces.
    pub surfaces: usize,
    /// Share of trials that gave no interval; a miss of each.
    pub failed: f64,
    /// Shares of true curvatures within intervals of 50 %.
    pub coverage50: f64,
    /// Shares of true curvatures within intervals of 80 %.
    pub coverage80: f64,
    /// Shares of true curvatures within intervals of 95 %.
    pub coverage95: f64,
    /// Share of surfaces on which those of 95 % hold in at least 85 %.
    pub surfaces_above_85: f64,
    /// Coverage of intervals of 95 % on the surface where it is lowest.
    pub lowest: f64,
    /// Median over surfaces of stated standard deviation over error, both root mean squares.
    pub std_per_rms: f64,
    /// Mean width of intervals of 95 %, in distances between fingers to the power −2 or −1; all are closed.
    pub width: f64,
    /// Root mean square of the errors.
    pub rms: f64,
    /// Whether the figures of `all` surfaces are within the limits for contacts with or without normals; `None` of
    /// other rows.
    pub is_within_limits: Option<bool>,
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            case,
            on,
            quantity,
            coverage95,
            surfaces_above_85,
            std_per_rms,
            width,
            failed,
            ..
        } = self;
        write!(
            f,
            "{case}, {on}, {quantity}: {:.1} % covered, {:.1} % of surfaces above 85 %, std/rms {std_per_rms:.2}, \
             width {width:.4}, failed {:.1} %",
            100.0 * coverage95,
            100.0 * surfaces_above_85,
            100.0 * failed
        )?;
        match self.is_within_limits {
            Some(false) => write!(f, ", beyond the limits"),
            _ => Ok(()),
        }
    }
}

/// Limits that the intervals of a case must keep on all surfaces together.
struct Limits {
    coverage95: [f64; 2],
    least_above_85: f64,
    std_per_rms: [f64; 2],
}

impl Limits {
    /// Limits of contacts with normals, and of contacts without.
    const fn of(has_normals: bool) -> Self {
        if has_normals {
            Self {
                coverage95: [0.92, 0.98],
                least_above_85: 0.9,
                std_per_rms: [0.8, 1.5],
            }
        } else {
            Self {
                coverage95: [0.88, 0.99],
                least_above_85: 0.8,
                std_per_rms: [0.8, 1.8],
            }
        }
    }

    fn hold(&self, score: &Score) -> bool {
        let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
        within(self.coverage95, score.coverage95)
            && score.surfaces_above_85 >= self.least_above_85
            && within(self.std_per_rms, score.std_per_rms)
    }
}

/// The scores of a case: on all surfaces, and on those of each kind, of both curvatures.
///
/// # Errors
/// A case that cannot be asked.
pub(super) fn scores(
    case: &Case,
    surfaces: &[Surface],
    options: Options<'_>,
) -> Result<Vec<Score>> {
    let mut all = Vec::new();
    for (index, surface) in surfaces.iter().enumerate() {
        all.push((surface.kind(), sums(case, surface, index as u64, options)?));
    }
    let kinds = ["all", "quadric and waves", "ball"];
    let quantities = ["gaussian_curvature", "mean_curvature"];
    let mut scores = Vec::new();
    for on in kinds {
        for (place, quantity) in quantities.into_iter().enumerate() {
            let of_kind = all.iter().filter(|(kind, _)| on == "all" || on == *kind);
            let sums: Vec<&Sums> = of_kind.map(|(_, sums)| &sums[place]).collect();
            if !sums.is_empty() {
                scores.push(score(case, on, quantity, &sums));
            }
        }
    }
    Ok(scores)
}

fn score(case: &Case, on: &'static str, quantity: &'static str, sums: &[&Sums]) -> Score {
    let count = sums.len() as f64;
    let mean = |part: &dyn Fn(&Sums) -> f64| sums.iter().map(|one| part(one)).sum::<f64>() / count;
    let stated: f64 = sums.iter().map(|one| one.stated).sum();
    let of_stated = |part: fn(&Sums) -> f64| sums.iter().map(|one| part(one)).sum::<f64>() / stated;
    let mut ratios: Vec<f64> = sums.iter().map(|one| one.std_per_rms()).collect();
    ratios.sort_by(f64::total_cmp);
    let lowest = sums.iter().map(|one| one.coverage(2));
    let score = Score {
        case: case.name(),
        on,
        quantity,
        surfaces: sums.len(),
        failed: mean(&|one| 1.0 - one.stated / one.asked),
        coverage50: mean(&|one| one.coverage(0)),
        coverage80: mean(&|one| one.coverage(1)),
        coverage95: mean(&|one| one.coverage(2)),
        surfaces_above_85: mean(&|one| f64::from(u8::from(one.coverage(2) >= HOLDS))),
        lowest: lowest.fold(1.0, f64::min),
        std_per_rms: ratios[ratios.len() / 2],
        width: 2.0 * NORMAL_95 * of_stated(|one| one.std),
        rms: of_stated(|one| one.square_error).sqrt(),
        is_within_limits: None,
    };
    let limits = Limits::of(case.normal_std_deg.is_some());
    Score {
        is_within_limits: (on == "all").then(|| limits.hold(&score)),
        ..score
    }
}

/// Sums of both curvatures on a surface.
fn sums(case: &Case, surface: &Surface, index: u64, options: Options<'_>) -> Result<[Sums; 2]> {
    let sweep = Sweep::random(options.seed, index);
    let asked = sweep.asked(surface);
    let mut sums = [Sums::default(), Sums::default()];
    for trial in 0..options.trials {
        let number = index * options.trials + trial;
        let contacts = case.contacts(surface, &sweep, options.seed, number)?;
        sums.iter_mut()
            .for_each(|sums| sums.asked += asked.len() as f64);
        let fitted = Patch::new(&contacts, &Vector3::z()).and_then(|patch| {
            let method = Penalised {
                noise: case.told(),
                ..Penalised::default()
            };
            method.fit(&patch)
        });
        let curvatures = fitted.and_then(|fit| {
            let at = |place: &Place| fit.curvature_at(&place.point);
            asked
                .iter()
                .map(at)
                .collect::<Result<Vec<Curvature>, Ep2Error>>()
        });
        for (curvature, place) in curvatures.iter().flatten().zip(&asked) {
            let Some(told) = curvature.uncertainty else {
                continue;
            };
            let [gaussian, mean] = place.curvatures;
            let errors = [
                (curvature.gaussian - gaussian, told.gaussian_std),
                (curvature.mean - mean, told.mean_std),
            ];
            for (sums, (error, std)) in sums.iter_mut().zip(errors) {
                sums.add(error, std, within(error, std));
            }
        }
    }
    Ok(sums)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_ratios_are_those_of_what_was_added() {
        let mut sums = Sums {
            asked: 5.0,
            ..Sums::default()
        };
        // Of five places one has no interval; errors of ½, 1, 1½ and 3 standard deviations.
        for error in [-0.5, 1.0, 1.5, -3.0] {
            sums.add(0.2 * error, 0.2, within(0.2 * error, 0.2));
        }
        assert_eq!([0, 1, 2].map(|width| sums.coverage(width)), [0.2, 0.4, 0.6]);
        let mean_square = (0.25 + 1.0 + 2.25 + 9.0) / 4.0;
        assert!((sums.std_per_rms() - 1.0 / f64::sqrt(mean_square)).abs() < 1e-12);
        let case = crate::intervals::case::cases().next().unwrap();
        let of_both = score(&case, "all", "mean_curvature", &[&sums, &sums]);
        assert!((of_both.failed - 0.2).abs() < 1e-12 && of_both.surfaces_above_85 == 0.0);
        assert!((of_both.width - 2.0 * NORMAL_95 * 0.2).abs() < 1e-12);
        assert!((of_both.rms - 0.2 * mean_square.sqrt()).abs() < 1e-12);
        assert_eq!(of_both.is_within_limits, Some(false));
    }

    #[test]
    fn limits_are_met_within() {
        let case = crate::intervals::case::cases().next().unwrap();
        let mut sums = Sums {
            asked: 20.0,
            ..Sums::default()
        };
        (0..19).for_each(|_| sums.add(1.0, 1.0, within(1.0, 1.0)));
        sums.add(2.1, 1.0, within(2.1, 1.0));
        assert_eq!(
            score(&case, "all", "mean_curvature", &[&sums]).is_within_limits,
            Some(true)
        );
        assert_eq!(
            score(&case, "ball", "mean_curvature", &[&sums]).is_within_limits,
            None
        );
    }
}
