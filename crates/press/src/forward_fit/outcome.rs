//! The estimate that is reported of a press, from the state that fits best.

use nalgebra::Vector3;

use super::bias::relative_bias;
use super::problem::{
    ACROSS, ALONG, BASELINE, CURVATURE, GAIN, INDENTATION, Problem, Square, State, Sums,
};
use crate::{Estimated, GoodnessOfFit, Interval, PressError, PressEstimate, Verdict};

/// The estimate at the least sum of squares; `limit` is half the width of a 95 % interval in standard deviations.
pub(super) fn outcome(
    problem: &Problem<'_>,
    state: &State,
    sums: &Sums,
    covariance: &Square,
    interval: Interval,
    limit: f64,
) -> Result<PressEstimate, PressError> {
    let contact = problem.contact(state)?;
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
        indentation: positive(around(state.indentation, stds.indentation)),
        contact_radius: positive(around(contact.radius, stds.contact_radius)),
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
        reduced_chi_squared: sums.chi_squared / problem.freedom().max(1) as f64,
        goodness: problem.goodness(sums),
        is_seen: true,
        only_marker: None,
        verdict: Verdict::of(interval, skin.curvature()),
    })
}

impl Problem<'_> {
    /// Goodness of a fit whose noise is stated.
    pub(super) fn goodness(&self, sums: &Sums) -> Option<GoodnessOfFit> {
        self.knows_noise()
            .then(|| GoodnessOfFit::new(sums.chi_squared, self.freedom()))
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

/// A curvature without its bias (a share of it), within its interval. The radius is nearly Gaussian; where it may as
/// well be 0, its inverse is taken at the radius of two standard deviations.
fn without_bias(curvature: f64, bias: f64, interval: Interval) -> f64 {
    let corrected = if bias > 1.0 {
        curvature / (2.0 * bias.sqrt())
    } else if bias > 0.0 {
        curvature / (1.0 + bias)
    } else {
        curvature * (1.0 - bias)
    };
    let corrected = interval.low.map_or(corrected, |low| corrected.max(low));
    interval.high.map_or(corrected, |high| corrected.min(high))
}

/// A length that cannot be negative.
fn positive(estimated: Estimated) -> Estimated {
    let Interval { low, high } = estimated.interval;
    let low = low.map(|low| low.max(0.0));
    Estimated {
        interval: Interval { low, high },
        ..estimated
    }
}
