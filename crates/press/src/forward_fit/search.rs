//! From readings to an estimate: start, robust fit, wrong markers, noise, intervals.

use nalgebra::Vector3;

use super::bias::relative_bias;
use super::minimise::{inverse, minimise};
use super::problem::{
    ACROSS, ALONG, BASELINE, CURVATURE, GAIN, INDENTATION, Problem, Square, State, Sums,
};
use super::profile::{Profile, profile};
use super::start::{median, starts};
use super::{ForwardFit, Prior, Reading};
use crate::{Estimated, Interval, PressError, PressEstimate, Verdict};

/// A residual beyond this many standard deviations is wrong, not noisy: chance brings one in two million.
const WRONG: f64 = 5.0;
/// At most this share of the markers can be wrong; if more seem so, the model is.
const MOST_WRONG: f64 = 1.0 / 8.0;
/// Residuals count less and less beyond this while it is not known which are wrong.
const ROBUST: f64 = 3.0;
/// What a further step must promise to lower chi-squared by, before and after it is known which are wrong.
const ROUGHLY: f64 = 1e-2;
const EXACTLY: f64 = 1e-8;
/// No displacement is taken to be more exact than this share of the largest.
const EXACT: f64 = 1e-10;
/// By how much a contact must explain the readings better than none.
const SEEN: f64 = 16.0;
/// The normal quantile of a two-sided interval of 95 %.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// A search for the press behind a reading.
#[derive(Clone)]
pub(super) struct Search<'a> {
    problem: Problem<'a>,
    /// Whether the noise of normal and of tangential displacements must be found.
    find_normal: bool,
    find_tangential: bool,
    /// The largest displacement that was read.
    largest: f64,
}

impl<'a> Problem<'a> {
    /// All that is not known is sought; every marker counts, and all with a standard deviation of 1.
    pub(super) fn new(fit: &'a ForwardFit, reading: &'a Reading<'a>) -> Self {
        let mut sought = [true; super::problem::UNKNOWNS];
        sought[INDENTATION] = reading.indentation.is_none_or(|known| known.std > 0.0);
        sought[BASELINE] = fit.baseline != Prior::Exact;
        sought[GAIN] = fit.gain != Prior::Exact;
        let mut problem = Self {
            fit,
            reading,
            sought,
            normal_std: 1.0,
            tangential_std: 1.0,
            kept: vec![true; reading.normal.len()],
            circle: None,
            tolerance: f64::INFINITY,
        };
        if !problem.uses_tangential() {
            problem.circle = common_circle(reading);
            problem.sought[ACROSS] = problem.circle.is_none();
        }
        problem
    }

    /// Only markers within the window count.
    pub(super) fn keep_window(&mut self, state: &State) {
        let Some(window) = self.fit.window else {
            return;
        };
        let markers = self.reading.markers;
        for (kept, place) in self.kept.iter_mut().zip(markers.places()) {
            *kept = markers.sight(&state.place, place).distance <= window;
        }
    }
}

/// The pole of the great circle on which all markers lie, if they do.
fn common_circle(reading: &Reading<'_>) -> Option<Vector3<f64>> {
    let mut spread = nalgebra::Matrix3::zeros();
    for place in reading.markers.places() {
        spread += place.direction.as_ref() * place.direction.as_ref().transpose();
    }
    let eigen = spread.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let flat = eigen.eigenvalues[least] <= 1e-12 * reading.markers.places().len() as f64;
    flat.then(|| eigen.eigenvectors.column(least).into_owned())
}

impl<'a> Search<'a> {
    pub(super) fn new(fit: &'a ForwardFit, reading: &'a Reading<'a>) -> Result<Self, PressError> {
        let mut problem = Problem::new(fit, reading);
        let (equations, needed) = (problem.equations(), problem.unknowns());
        let free_noise = usize::from(fit.normal_std.is_none_or(|std| std == 0.0));
        if equations < needed + free_noise {
            return Err(PressError::TooFewMarkers {
                markers: reading.normal.len(),
                equations,
                needed: needed + free_noise,
            });
        }
        let least = reading.normal.iter().copied().fold(f64::INFINITY, f64::min);
        let most = reading
            .normal
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        if least == most {
            return Err(PressError::NoContact {
                improvement: 0.0,
                needed: SEEN,
            });
        }
        let largest = most.abs().max(least.abs());
        let stated = |std: Option<f64>| std.filter(|&std| std > 0.0);
        let (normal, tangential) = (stated(fit.normal_std), stated(fit.tangential_std));
        problem.normal_std = normal.unwrap_or(0.1 * largest);
        problem.tangential_std = tangential.unwrap_or(problem.normal_std);
        Ok(Self {
            find_normal: normal.is_none(),
            find_tangential: tangential.is_none(),
            problem,
            largest,
        })
    }

    pub(super) fn run(mut self) -> Result<PressEstimate, PressError> {
        let (mut state, mut sums) = self.begin()?;
        // The profile may find a better fit than the one it starts from.
        for _ in 0..4 {
            self.seen(&sums)?;
            let covariance = inverse(&sums.hessian).ok_or(PressError::Undetermined {
                what: "some combination of curvature, place, indentation, baseline and gain is free",
            })?;
            let limit = self.limit();
            match profile(&self.problem, &state, &sums, &covariance, limit * limit) {
                Profile::Interval(interval) => {
                    return self.estimate(&state, &sums, &covariance, interval);
                }
                Profile::Better(better) => {
                    state = better;
                    sums = self.settle(&mut state)?;
                }
            }
        }
        Err(PressError::Undetermined {
            what: "the sum of squares has no clear minimum",
        })
    }

    /// The best of the fits that are begun; where the noise is to be found, the one that finds the least.
    fn begin(&mut self) -> Result<(State, Sums), PressError> {
        let mut fits = self.robust_fits()?;
        if !self.find_normal {
            fits.truncate(1);
        }
        let mut failure = PressError::OutOfRange;
        let mut best: Option<(Self, State, Sums)> = None;
        for mut state in fits {
            let mut settled = self.clone();
            match settled.settle(&mut state) {
                Ok(sums) => {
                    let noise = settled.problem.normal_std;
                    let is_better =
                        |(best, _, _): &(Self, State, Sums)| noise < best.problem.normal_std;
                    if best.as_ref().is_none_or(is_better) {
                        best = Some((settled, state, sums));
                    }
                }
                Err(error) => failure = error,
            }
        }
        let (settled, state, sums) = best.ok_or(failure)?;
        *self = settled;
        Ok((state, sums))
    }

    /// Fits that no few markers can lead astray, the best first.
    fn robust_fits(&self) -> Result<Vec<State>, PressError> {
        let mut problem = self.problem.clone();
        problem.tolerance = ROBUST;
        let mut fits: Vec<(f64, State)> = Vec::new();
        let mut failure = PressError::NoContact {
            improvement: 0.0,
            needed: SEEN,
        };
        let few = if self.find_normal { 6 } else { 2 };
        for start in starts(&problem).into_iter().take(few) {
            problem.keep_window(&start);
            match minimise(&problem, start, ROUGHLY) {
                Ok((state, sums)) => fits.push((sums.chi_squared, state)),
                Err(error) => failure = error,
            }
        }
        fits.sort_by(|one, other| one.0.total_cmp(&other.0));
        if fits.is_empty() {
            return Err(failure);
        }
        Ok(fits.into_iter().map(|(_, state)| state).collect())
    }

    /// Least squares over the markers that are not wrong, with the noise that they show where it must be found.
    fn settle(&mut self, state: &mut State) -> Result<Sums, PressError> {
        const ROUNDS: usize = 8;
        let mut last = None;
        for round in 0..ROUNDS {
            let kept = self.problem.kept.clone();
            self.find_noise(state, round < 2)?;
            self.choose(state)?;
            if round > 0 && kept == self.problem.kept && !self.is_noise_new(&mut last) {
                break;
            }
            (*state, _) = minimise(&self.problem, *state, EXACTLY)?;
        }
        self.problem.sums(state)
    }

    /// Whether the noise has changed noticeably since the last call.
    fn is_noise_new(&self, last: &mut Option<[f64; 2]>) -> bool {
        let now = [self.problem.normal_std, self.problem.tangential_std];
        let same = |last: [f64; 2]| {
            last.iter()
                .zip(now)
                .all(|(last, now)| (now - last).abs() <= 1e-3 * now)
        };
        let found = self.find_normal || self.find_tangential;
        let is_new = found && !last.is_some_and(same);
        *last = Some(now);
        is_new
    }

    /// Standard deviations from the residuals of the markers that count: from their median (`robustly`) or their squares.
    fn find_noise(&mut self, state: &State, robustly: bool) -> Result<(), PressError> {
        if !(self.find_normal || self.find_tangential) {
            return Ok(());
        }
        let problem = &self.problem;
        let contact = problem.contact(state)?;
        let (mut normal, mut tangential) = (Vec::new(), Vec::new());
        for marker in (0..problem.kept.len()).filter(|&marker| problem.kept[marker]) {
            let [inward, x, y] = problem.residuals_at(&contact, state, marker);
            normal.push((inward * problem.normal_std).abs());
            tangential.extend([x, y].map(|along| (along * problem.tangential_std).abs()));
        }
        let equations = problem.equations() as f64;
        let freedom = equations - problem.unknowns() as f64;
        let correction = (equations / freedom.max(1.0)).sqrt();
        let floor = EXACT * self.largest;
        let std = |residuals: &[f64]| {
            // The median of |x| is 0.6745 standard deviations.
            let raw = if robustly {
                median(residuals) / 0.674_489_750_196_082
            } else {
                let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
                (squares / residuals.len().max(1) as f64).sqrt()
            };
            (raw * correction).max(floor)
        };
        let (found_normal, found_tangential) = (std(&normal), std(&tangential));
        if self.find_normal {
            self.problem.normal_std = found_normal;
        }
        if self.find_tangential && self.problem.uses_tangential() {
            self.problem.tangential_std = found_tangential;
        }
        Ok(())
    }

    /// Which markers count: those within the window that are not wrong.
    fn choose(&mut self, state: &State) -> Result<(), PressError> {
        let problem = &mut self.problem;
        problem.kept.fill(true);
        problem.keep_window(state);
        let contact = problem.contact(state)?;
        let inside = problem.kept.iter().filter(|&&kept| kept).count();
        let is_wrong = |marker: &usize| {
            let residuals = problem.residuals_at(&contact, state, *marker);
            residuals.iter().any(|residual| residual.abs() > WRONG)
        };
        let wrong: Vec<usize> = (0..problem.kept.len())
            .filter(|&marker| problem.kept[marker])
            .filter(is_wrong)
            .collect();
        let most = (MOST_WRONG * inside as f64).max(1.0) as usize;
        if wrong.len() <= most {
            for marker in wrong {
                problem.kept[marker] = false;
            }
        }
        let (equations, needed) = (problem.equations(), problem.unknowns());
        if equations < needed {
            return Err(PressError::TooFewMarkers {
                markers: problem.kept.iter().filter(|&&kept| kept).count(),
                equations,
                needed,
            });
        }
        Ok(())
    }

    /// The half-width of a 95 % interval, in standard deviations.
    fn limit(&self) -> f64 {
        if self.find_normal {
            student_95(self.problem.equations() - self.problem.unknowns())
        } else {
            NORMAL_95
        }
    }

    /// That a contact explains the readings better than none.
    fn seen(&self, sums: &Sums) -> Result<(), PressError> {
        let problem = &self.problem;
        let baseline = match problem.fit.baseline {
            Prior::Exact => 0.0,
            Prior::Within(_) | Prior::Free => {
                let kept = problem.reading.normal.iter().zip(&problem.kept);
                let (sum, count) = kept
                    .filter(|(_, kept)| **kept)
                    .fold((0.0, 0.0), |(sum, count), (value, _)| {
                        (sum + value, count + 1.0)
                    });
                sum / count
            }
        };
        let without: f64 = problem.unmoved(baseline);
        let improvement = without - sums.chi_squared;
        if improvement >= SEEN {
            Ok(())
        } else {
            Err(PressError::NoContact {
                improvement,
                needed: SEEN,
            })
        }
    }

    fn estimate(
        &self,
        state: &State,
        sums: &Sums,
        covariance: &Square,
        interval: Interval,
    ) -> Result<PressEstimate, PressError> {
        let problem = &self.problem;
        let contact = problem.contact(state)?;
        self.on_markers(state, contact.radius)?;
        let limit = self.limit();
        let stds = Stds::new(problem, state, covariance)?;
        let around = |value: f64, std: f64| Estimated {
            value,
            std,
            interval: Interval {
                low: Some(value - limit * std),
                high: Some(value + limit * std),
            },
        };
        let skin = problem.reading.markers.skin();
        let unbiased = without_bias(
            contact.relative_curvature,
            relative_bias(problem, state, covariance),
            interval,
        );
        let relative_curvature = Estimated {
            value: unbiased,
            std: stds.relative_curvature * (unbiased / contact.relative_curvature),
            interval,
        };
        let freedom = problem.equations() - problem.unknowns();
        let nuisance = |index: usize, value: f64| {
            problem.sought[index].then(|| around(value, covariance[(index, index)].sqrt()))
        };
        let window = problem.fit.window.unwrap_or(f64::INFINITY);
        let distance = |marker: usize| {
            let place = &problem.reading.markers.places()[marker];
            problem.reading.markers.sight(&state.place, place).distance
        };
        Ok(PressEstimate {
            sensor_curvature: skin.curvature(),
            relative_curvature,
            most_likely_curvature: contact.relative_curvature,
            indentation: around(state.indentation, stds.indentation),
            contact_radius: around(contact.radius, stds.contact_radius),
            contact: skin.chart(state.place.direction.as_ref()),
            contact_std: stds.contact,
            baseline: nuisance(BASELINE, state.baseline),
            gain: nuisance(GAIN, state.gain),
            wrong_markers: (0..problem.kept.len())
                .filter(|&marker| !problem.kept[marker] && distance(marker) <= window)
                .collect(),
            normal_std: problem.normal_std,
            tangential_std: problem.uses_tangential().then_some(problem.tangential_std),
            r_squared: problem.r_squared(state)?,
            reduced_chi_squared: sums.chi_squared / freedom.max(1) as f64,
            verdict: verdict(interval, skin.curvature()),
        })
    }

    /// That some marker is near the contact, or that markers surround it.
    fn on_markers(&self, state: &State, radius: f64) -> Result<(), PressError> {
        let markers = self.problem.reading.markers;
        let mut bearings = Vec::with_capacity(markers.places().len());
        let mut nearest = f64::INFINITY;
        for place in markers.places() {
            let sight = markers.sight(&state.place, place);
            nearest = nearest.min(sight.distance);
            bearings.push(sight.bearing.y.atan2(sight.bearing.x));
        }
        if nearest <= 2.0 * radius {
            return Ok(());
        }
        bearings.sort_by(f64::total_cmp);
        let turn = std::f64::consts::TAU;
        let around = bearings
            .iter()
            .skip(1)
            .chain([&(bearings[0] + turn)])
            .copied()
            .collect::<Vec<_>>();
        let gap = bearings
            .iter()
            .zip(around)
            .map(|(one, next)| next - one)
            .fold(0.0, f64::max);
        if gap > 0.5 * turn + 1e-6 {
            return Err(PressError::OffMarkers { distance: nearest });
        }
        Ok(())
    }
}

impl Problem<'_> {
    /// Chi-squared if nothing had moved but by the baseline.
    fn unmoved(&self, baseline: f64) -> f64 {
        let mut squared = 0.0;
        for marker in (0..self.kept.len()).filter(|&marker| self.kept[marker]) {
            squared += ((self.reading.normal[marker] - baseline) / self.normal_std).powi(2);
            if let Some(tangential) = self.reading.tangential.filter(|_| self.uses_tangential()) {
                let [x, y] = tangential[marker];
                squared += (x * x + y * y) / (self.tangential_std * self.tangential_std);
            }
        }
        squared
    }

    /// The share of the variance of the normal displacements that count which the model explains.
    fn r_squared(&self, state: &State) -> Result<f64, PressError> {
        let contact = self.contact(state)?;
        let moved = self.displacements(&contact, state);
        let pairs = || {
            let read = self.reading.normal.iter().zip(&moved).zip(&self.kept);
            read.filter(|(_, kept)| **kept)
                .map(|((read, moved), _)| (*read, moved.normal))
        };
        let count = pairs().count().max(1) as f64;
        let mean = pairs().map(|(read, _)| read).sum::<f64>() / count;
        let (left, all) = pairs().fold((0.0, 0.0), |(left, all), (read, moved)| {
            (left + (read - moved).powi(2), all + (read - mean).powi(2))
        });
        Ok(if all > 0.0 { 1.0 - left / all } else { 0.0 })
    }
}

/// Standard deviations of what is reported.
pub(super) struct Stds {
    pub(super) relative_curvature: f64,
    pub(super) indentation: f64,
    pub(super) contact_radius: f64,
    pub(super) contact: [f64; 2],
}

impl Stds {
    pub(super) fn new(
        problem: &Problem<'_>,
        state: &State,
        covariance: &Square,
    ) -> Result<Self, PressError> {
        let variance = |one: usize, other: usize| {
            if problem.sought[one] && problem.sought[other] {
                covariance[(one, other)]
            } else {
                0.0
            }
        };
        let contact = problem.contact(state)?;
        let [_, slope] = problem.fit.body.indentation_of(contact.radius)?;
        // C D(a) = δ: C D' da = dδ − δ d ln C.
        let share = 1.0 / (contact.relative_curvature * slope);
        let depth = state.indentation;
        let of_radius = variance(INDENTATION, INDENTATION)
            - 2.0 * depth * variance(INDENTATION, CURVATURE)
            + depth * depth * variance(CURVATURE, CURVATURE);
        // On a circle the axes at the contact are the circle's own.
        let axes = problem
            .reading
            .markers
            .skin()
            .place_at(state.place.direction.as_ref());
        let along = |axis: &Vector3<f64>| {
            let (x, y) = (axis.dot(&state.place.x_axis), axis.dot(&state.place.y_axis));
            let squared = x * x * variance(ALONG, ALONG)
                + 2.0 * x * y * variance(ALONG, ACROSS)
                + y * y * variance(ACROSS, ACROSS);
            squared.max(0.0).sqrt()
        };
        Ok(Self {
            relative_curvature: contact.relative_curvature * variance(CURVATURE, CURVATURE).sqrt(),
            indentation: variance(INDENTATION, INDENTATION).sqrt(),
            contact_radius: share * of_radius.max(0.0).sqrt(),
            contact: [along(&axes.x_axis), along(&axes.y_axis)],
        })
    }
}

/// A curvature without its bias (a share of it), within its interval. Divided by what it is too large by rather than
/// lowered: a curvature that may be anything is not estimated as none.
fn without_bias(curvature: f64, bias: f64, interval: Interval) -> f64 {
    let corrected = if bias > 0.0 {
        curvature / (1.0 + bias)
    } else {
        curvature * (1.0 - bias)
    };
    corrected.clamp(
        interval.low.unwrap_or(0.0),
        interval.high.unwrap_or(f64::INFINITY),
    )
}

/// What an interval of the relative curvature tells of the object, for a sensor of this curvature.
fn verdict(interval: Interval, sensor: f64) -> Verdict {
    let Interval { low, high } = interval;
    match (low, high) {
        (Some(low), _) if low > sensor => Verdict::Convex,
        (_, Some(high)) if high < sensor => Verdict::Concave,
        (Some(low), Some(high)) if high - low < sensor => Verdict::FlatWithinNoise,
        _ => Verdict::NotResolved,
    }
}

/// The quantile of Student's t for a two-sided interval of 95 % (Fisher's expansion; within 1e-3 from 4 degrees of
/// freedom, on the long side of it below).
fn student_95(freedom: usize) -> f64 {
    const FEW: [f64; 4] = [12.706_205, 12.706_205, 4.302_653, 3.182_446];
    if let Some(exact) = FEW.get(freedom) {
        return *exact;
    }
    let (z, n) = (NORMAL_95, freedom as f64);
    let (z3, z5, z7) = (z.powi(3), z.powi(5), z.powi(7));
    z + (z3 + z) / (4.0 * n)
        + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n)
        + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n * n * n)
}
