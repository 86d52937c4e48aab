//! Coverage of the intervals of EP2 on random surfaces.

use anyhow::Result;
use nalgebra::Vector3;
use palpate_ep2::{Contact, Curvature, Ep2Error, Method, Patch, Penalised};
use palpate_statistics::NORMAL_95;
use serde::Serialize;

use super::coverage::{Coverage, Sums};
use super::glide_contacts::{GlideSetup, Path, cases};
use super::surface::{Place, Surface};
use super::{Options, case_scores, scenes};

/// Coverage of the intervals of a case, on all its surfaces or those of one kind.
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
    /// Share of trials without an interval. Each counts as a miss.
    pub failed: f64,
    /// Share of true curvatures within intervals of 50 %.
    pub coverage50: f64,
    /// Share of true curvatures within intervals of 80 %.
    pub coverage80: f64,
    /// Share of true curvatures within intervals of 95 %.
    pub coverage95: f64,
    /// Share of surfaces with a 95 % coverage of at least 85 %.
    pub surfaces_above_85: f64,
    /// 95 % coverage of the surface with the lowest one.
    pub lowest: f64,
    /// Stated standard deviation over error, both root mean squares: median over the surfaces.
    pub std_per_rms: f64,
    /// Mean width of 95 % intervals, in finger distances to the power −2 or −1. All intervals are closed.
    pub width: f64,
    /// Root mean square of the errors.
    pub rms: f64,
    /// Whether a row of `all` surfaces meets the limits for contacts with or without normals; `None` in other rows.
    pub is_within_limits: Option<bool>,
}

/// Limits of a case, over all its surfaces.
struct Limits {
    coverage95: [f64; 2],
    min_surfaces_above_85: f64,
    std_per_rms: [f64; 2],
}

const WITH_NORMALS: Limits = Limits {
    coverage95: [0.92, 0.98],
    min_surfaces_above_85: 0.9,
    std_per_rms: [0.8, 1.5],
};
const WITHOUT_NORMALS: Limits = Limits {
    coverage95: [0.88, 0.99],
    min_surfaces_above_85: 0.8,
    std_per_rms: [0.8, 1.8],
};

impl Limits {
    fn are_met(&self, score: &Score) -> bool {
        let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
        within(self.coverage95, score.coverage95)
            && score.surfaces_above_85 >= self.min_surfaces_above_85
            && within(self.std_per_rms, score.std_per_rms)
    }
}

/// Scores of all cases. `report` gets each as soon as it is computed.
///
/// # Errors
/// If a surface has no contacts, or `report` fails.
pub fn scores(options: Options<'_>, report: impl Fn(&Score) -> Result<()>) -> Result<Vec<Score>> {
    case_scores(cases(), GlideSetup::name, options, report, |case| {
        let surfaces = scenes(options, |index| {
            let surface = Surface::random(options.seed, index);
            Ok((surface.kind(), sums(case, &surface, index, options)?))
        })?;
        Ok(scores_of_case(case, &surfaces))
    })
}

/// Number of rows that meet their limits, in words.
pub fn summary(scores: &[Score]) -> String {
    let limited = scores.iter().filter_map(|score| score.is_within_limits);
    let (all, within) = limited.fold((0, 0), |(all, within), is_within| {
        (all + 1, within + u64::from(is_within))
    });
    format!("{within} of {all} cases within the limits")
}

/// Scores of both curvatures, on all surfaces and on those of each kind.
fn scores_of_case(case: &GlideSetup, surfaces: &[(&'static str, [Sums; 2])]) -> Vec<Score> {
    let mut scores = Vec::new();
    for on in ["all", "quadric and waves", "ball"] {
        for (place, quantity) in ["gaussian_curvature", "mean_curvature"]
            .into_iter()
            .enumerate()
        {
            let of_kind = surfaces
                .iter()
                .filter(|(kind, _)| on == "all" || on == *kind);
            let sums: Vec<&Sums> = of_kind.map(|(_, sums)| &sums[place]).collect();
            if !sums.is_empty() {
                scores.push(score(case, on, quantity, &sums));
            }
        }
    }
    scores
}

fn score(case: &GlideSetup, on: &'static str, quantity: &'static str, sums: &[&Sums]) -> Score {
    let coverage = Coverage::new(sums);
    let estimates: f64 = sums.iter().map(|one| one.estimates).sum();
    let mean = |part: fn(&Sums) -> f64| sums.iter().map(|one| part(one)).sum::<f64>() / estimates;
    let mut ratios: Vec<f64> = sums.iter().map(|one| one.std_per_rms()).collect();
    ratios.sort_by(f64::total_cmp);
    let score = Score {
        case: case.name(),
        on,
        quantity,
        surfaces: sums.len(),
        failed: coverage.failed,
        coverage50: coverage.shares[0],
        coverage80: coverage.shares[1],
        coverage95: coverage.shares[2],
        surfaces_above_85: coverage.scenes_above_85,
        lowest: coverage.lowest,
        std_per_rms: ratios[ratios.len() / 2],
        width: 2.0 * NORMAL_95 * mean(|one| one.std),
        rms: mean(|one| one.square_error).sqrt(),
        is_within_limits: None,
    };
    let limits = match case.normal_std_deg {
        Some(_) => &WITH_NORMALS,
        None => &WITHOUT_NORMALS,
    };
    Score {
        is_within_limits: (on == "all").then(|| limits.are_met(&score)),
        ..score
    }
}

/// Sums of both curvatures on a surface.
fn sums(
    case: &GlideSetup,
    surface: &Surface,
    index: u64,
    options: Options<'_>,
) -> Result<[Sums; 2]> {
    let path = Path::random(options.seed, index);
    let places = path.map_places(surface);
    let method = Penalised {
        noise: case.stated_noise(),
        ..Penalised::default()
    };
    let attempts = options.trials as f64 * places.len() as f64;
    let mut sums = [Sums::new(attempts), Sums::new(attempts)];
    for trial in 0..options.trials {
        let number = index * options.trials + trial;
        let contacts = case.contacts(surface, &path, options.seed, number)?;
        let Ok((_, curvatures)) = estimates(&method, &contacts, &places) else {
            continue;
        };
        for errors in errors(&curvatures, &places) {
            for (sums, (error, std)) in sums.iter_mut().zip(errors) {
                sums.add(error, std);
            }
        }
    }
    Ok(sums)
}

/// Patch of the contacts, and its estimated curvatures at these places.
///
/// # Errors
/// [`Ep2Error`] if a curvature cannot be estimated.
pub(super) fn estimates(
    method: &Penalised,
    contacts: &[Contact],
    places: &[Place],
) -> Result<(Patch, Vec<Curvature>), Ep2Error> {
    let patch = Patch::new(contacts, &Vector3::z())?;
    let fit = method.fit(&patch)?;
    let curvatures = places.iter().map(|place| fit.curvature_at(&place.point));
    let curvatures = curvatures.collect::<Result<_, _>>()?;
    Ok((patch, curvatures))
}

/// Errors and standard deviations of the Gaussian and the mean curvature, at the places where they are known.
pub(super) fn errors(
    curvatures: &[Curvature],
    places: &[Place],
) -> impl Iterator<Item = [(f64, f64); 2]> {
    curvatures
        .iter()
        .zip(places)
        .filter_map(|(curvature, place)| {
            let stated = curvature.uncertainty?;
            let [gaussian, mean] = place.curvatures;
            Some([
                (curvature.gaussian - gaussian, stated.gaussian_std),
                (curvature.mean - mean, stated.mean_std),
            ])
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_ratios_are_those_of_the_estimates() {
        let mut sums = Sums::new(5.0);
        // Of five places one has no interval; errors of ½, 1, 1½ and 3 standard deviations.
        for error in [-0.5, 1.0, 1.5, -3.0] {
            sums.add(0.2 * error, 0.2);
        }
        assert_eq!([0, 1, 2].map(|width| sums.coverage(width)), [0.2, 0.4, 0.6]);
        let mean_square = (0.25 + 1.0 + 2.25 + 9.0) / 4.0;
        assert!((sums.std_per_rms() - 1.0 / f64::sqrt(mean_square)).abs() < 1e-12);
        let case = cases().next().unwrap();
        let both = score(&case, "all", "mean_curvature", &[&sums, &sums]);
        assert!((both.failed - 0.2).abs() < 1e-12 && both.surfaces_above_85 == 0.0);
        assert!((both.width - 2.0 * NORMAL_95 * 0.2).abs() < 1e-12);
        assert!((both.rms - 0.2 * mean_square.sqrt()).abs() < 1e-12);
        assert_eq!(both.is_within_limits, Some(false));
    }

    #[test]
    fn only_rows_of_all_surfaces_have_limits() {
        let case = cases().next().unwrap();
        let mut sums = Sums::new(20.0);
        (0..19).for_each(|_| sums.add(1.0, 1.0));
        sums.add(2.1, 1.0);
        let of = |on| score(&case, on, "mean_curvature", &[&sums]).is_within_limits;
        assert_eq!([of("all"), of("ball")], [Some(true), None]);
    }
}
