//! Estimates the principal curvatures of an object from one press, by a least-squares fit of an elliptic contact with a
//! half-space.
//!
//! The fit parameters are the matrix logarithm S of the relative-curvature tensor, the place of the contact and the
//! indentation. The eigenvalues of S are ln(1/R_s + κ), where R_s is the sensor's radius and κ a principal curvature of
//! the object. Every S is a possible contact, because 1/R_s + κ is then positive. S is smooth even where both
//! curvatures are equal and the axis is undefined.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use palpate_statistics::student_half_width;

use crate::forward_fit::MIN_READINGS_PER_PARAMETER;
use crate::{
    Bounds, EllipticContact, Estimated, ForwardFit, GoodnessOfFit, Interval, Markers, Measured,
    Place, PressError, PressEstimate, PrincipalCurvatures, Prior, Reading, Verdict,
};

/// Number of fitted parameters: the components xx, xy and yy of the matrix logarithm S of the curvature tensor, two
/// coordinates of the contact, and the indentation.
const UNKNOWNS: usize = 6;
const INDENTATION: usize = 5;

type Step = SVector<f64, UNKNOWNS>;
type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

const MAX_STEPS: usize = 60;

/// The minimisation stops if the next step is predicted to decrease chi-squared by less than this value.
const ENOUGH: f64 = 1e-6;

/// Step for numerical derivatives with respect to a fitted parameter, relative to the scale of this parameter.
const DIFFERENCE: f64 = 1e-4;

/// Limit of the fitted logarithm ln(C/C_s), where C is a relative curvature and C_s the sensor's curvature. The
/// logarithm is limited to ± this value.
const LOG_RANGE: f64 = 11.0;

/// Largest value of ln(C/C_s) that is reported as the end of an interval. C is a relative curvature, and C_s the
/// sensor's curvature. A larger end is reported as unbounded.
const MAX_LOG: f64 = 8.0;

/// Number of directions in which bounds of the normal curvature are computed.
const DIRECTIONS: usize = 360;

/// Number of repetitions of the fit if the noise is not stated. Before each repetition, the noise is estimated from the
/// residuals.
const NOISE_PASSES: usize = 2;

impl ForwardFit {
    /// Estimates both principal curvatures from a reading. In the result, `relative_curvature` is the mean of both
    /// relative principal curvatures, and `contact_radius` is the geometric mean of the semi-axes.
    pub(crate) fn elliptic_estimate(
        &self,
        reading: &Reading<'_>,
    ) -> Result<PressEstimate, PressError> {
        let has_priors = self.baseline != Prior::Exact || self.gain != Prior::Exact;
        let half_space = self.body.sideways().filter(|_| !has_priors);
        let what =
            "the elliptic estimator supports only a half-space, without fitted baseline and gain";
        let half_space = half_space.ok_or(PressError::Undetermined { what })?;
        let round = Self {
            is_elliptic: false,
            ..self.clone()
        };
        let skin = reading.markers.skin();
        let (curvature, place, indentation) = match round.estimate(reading) {
            Ok(found) if !found.is_detected => {
                let what = "the displacements show no contact";
                return Err(PressError::Undetermined { what });
            }
            Ok(found) => (
                found.most_likely_curvature,
                skin.place(found.contact),
                found.indentation.value,
            ),
            Err(PressError::OtherBody { .. } | PressError::OffMarkers { .. }) => guess(reading)?,
            Err(error) => return Err(error),
        };
        let log = libm::log(curvature);
        let mut problem = Problem::new(self, half_space, reading)?;
        let start = |unequal: f64| State {
            log: Vector3::new(log + unequal, 0.0, log - unequal),
            place,
            indentation,
        };
        let mut best = problem.minimise(start(0.0))?;
        for unequal in [0.5, -0.5] {
            let fit = problem.minimise(start(unequal))?;
            if fit.chi_squared < best.chi_squared {
                best = fit;
            }
        }
        for _ in 0..NOISE_PASSES {
            if !problem.estimate_noise(&best) {
                break;
            }
            best = problem.minimise(best.state)?;
        }
        problem.outcome(&best)
    }

    /// Cramér–Rao bounds for a fit of both principal curvatures; [`ForwardFit::bounds`] describes the other arguments.
    /// The true contact is at the skin coordinates `at`. `axis` is the angle between the contact's longer axis and the
    /// x axis at the contact.
    pub(crate) fn elliptic_bounds(
        &self,
        markers: &Markers,
        contact: &EllipticContact,
        (at, axis): ([f64; 2], f64),
        tangential: bool,
        indentation_std: Option<f64>,
    ) -> Option<Bounds> {
        let half_space = self.body.sideways()?;
        let moved = markers.elliptic_displacements(contact, at, axis, half_space.1);
        let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
        let along: Vec<[f64; 2]> = moved.iter().map(|moved| moved.tangential).collect();
        let value = contact.indentation;
        let reading = Reading {
            markers,
            normal: &normal,
            tangential: tangential.then_some(along.as_slice()),
            indentation: indentation_std.map(|std| Measured { value, std }),
        };
        let problem = Problem::new(self, half_space, &reading).ok()?;
        if problem.is_estimated[0] || tangential && problem.is_estimated[1] {
            return None;
        }
        let [smaller, larger] = contact.relative_curvatures;
        let [low, high] = [libm::log(smaller), libm::log(larger)];
        let (sine, cosine) = libm::sincos(axis);
        let state = State {
            log: Vector3::new(
                low * cosine * cosine + high * sine * sine,
                (low - high) * sine * cosine,
                low * sine * sine + high * cosine * cosine,
            ),
            place: markers.skin().place(at),
            indentation: value,
        };
        let stds = Stds::new(&problem.fit_at(state).ok()?.0.hessian)?;
        let mean = 0.5 * (smaller + larger);
        let across = axis + std::f64::consts::FRAC_PI_2;
        let mean_std = stds.mean([larger, smaller], [across, axis]);
        // If both principal curvatures are equal, there is no axis of the smaller curvature. The principal curvatures
        // are then not smooth functions of the fitted parameters, so no bounds on their standard deviations are
        // computed.
        let principal = (high > low).then(|| {
            let axis_std = stds.turn(axis) / (high - low);
            [
                larger * stds.along(across),
                smaller * stds.along(axis),
                axis_std,
            ]
        });
        Some(Bounds {
            relative_curvature: mean * mean_std,
            indentation: stds.indentation(),
            contact_radius: stds.contact_radius(contact, mean_std),
            principal,
        })
    }
}

/// Covariance of the fitted parameters. The methods compute standard errors from it, to first order in the noise.
struct Stds(Square);

impl Stds {
    fn new(hessian: &Square) -> Option<Self> {
        let inverse = hessian.try_inverse()?;
        let is_finite = inverse.iter().all(|part| part.is_finite());
        let is_positive = (0..UNKNOWNS).all(|index| inverse[(index, index)] > 0.0);
        (is_finite && is_positive).then_some(Self(inverse))
    }

    /// Standard error of a weighted sum of the components xx, xy and yy of the tensor S, which is the logarithm of the
    /// relative-curvature tensor. `weights` contains the three weights.
    fn tensor(&self, weights: &Vector3<f64>) -> f64 {
        let tensor: Matrix3<f64> = self.0.fixed_view::<3, 3>(0, 0).into();
        weights.dot(&(tensor * weights)).max(0.0).sqrt()
    }

    /// Standard error of the logarithm of the relative curvature in the direction `angle`.
    fn along(&self, angle: f64) -> f64 {
        self.tensor(&along(angle))
    }

    /// Standard error of the component xy of the tensor S (the logarithm of the relative-curvature tensor), in axes
    /// that are rotated by `angle`.
    fn turn(&self, angle: f64) -> f64 {
        let (sine, cosine) = libm::sincos(2.0 * angle);
        self.tensor(&(0.5 * Vector3::new(-sine, 2.0 * cosine, sine)))
    }

    /// Standard error of the mean of the two relative curvatures `larger` and `smaller`, divided by this mean. `angles`
    /// contains the angles between the directions of the two curvatures and the x axis.
    fn mean(&self, [larger, smaller]: [f64; 2], angles: [f64; 2]) -> f64 {
        let [first, second] = angles.map(along);
        self.tensor(&((first * larger + second * smaller) / (larger + smaller)))
    }

    fn place(&self) -> [f64; 2] {
        [3, 4].map(|index| self.0[(index, index)].sqrt())
    }

    fn indentation(&self) -> f64 {
        self.0[(INDENTATION, INDENTATION)].sqrt()
    }

    /// Standard error of the contact radius a. The square a² is proportional to δ/C, where δ is the indentation and C
    /// the mean curvature. The errors of δ and C are treated as independent.
    fn contact_radius(&self, contact: &EllipticContact, mean_std: f64) -> f64 {
        0.5 * contact.radius() * libm::hypot(mean_std, self.indentation() / contact.indentation)
    }
}

/// Start values of the fit. The contact starts at the marker that moved most, and the object's curvature starts at the
/// curvature of the sensor. The relative curvature is then 2/R_s, with the sensor's radius R_s. On a nearly flat skin,
/// the start value of the curvature is computed from the extent of the area of the markers instead.
fn guess(reading: &Reading<'_>) -> Result<(f64, Place, f64), PressError> {
    let markers = reading.markers;
    let (marker, largest) = reading
        .normal
        .iter()
        .enumerate()
        .max_by(|one, other| one.1.total_cmp(other.1))
        .ok_or(PressError::OutOfRange)?;
    let indentation = reading
        .indentation
        .map_or(1.5 * largest, |known| known.value);
    if indentation.is_nan() || indentation <= 0.0 {
        return Err(PressError::NoIndentation { indentation });
    }
    Ok((
        2.0 * markers.scale().recip(),
        markers.places()[marker],
        indentation,
    ))
}

#[derive(Clone, Copy, Debug)]
struct State {
    log: Vector3<f64>,
    place: Place,
    indentation: f64,
}

/// Eigenvalues of a symmetric tensor (xx, xy, yy), the larger one first, and the angle of the direction of the larger
/// eigenvalue.
fn principal(tensor: &Vector3<f64>) -> ([f64; 2], f64) {
    let (mean, half) = (0.5 * (tensor[0] + tensor[2]), 0.5 * (tensor[0] - tensor[2]));
    let radius = libm::hypot(half, tensor[1]);
    let angle = 0.5 * libm::atan2(tensor[1], half);
    ([mean + radius, mean - radius], angle)
}

/// Three weights of the components xx, xy and yy of a symmetric tensor. The weighted sum is the tensor's component in
/// the direction `angle`.
fn along(angle: f64) -> Vector3<f64> {
    let (sine, cosine) = libm::sincos(angle);
    Vector3::new(cosine * cosine, 2.0 * sine * cosine, sine * sine)
}

struct Fit {
    state: State,
    /// Differences between readings and model in standard deviations, in this order: normal displacements, tangential
    /// displacements, the stated indentation.
    residuals: Vec<f64>,
    chi_squared: f64,
    /// Half the Hessian of chi-squared with respect to the fitted parameters.
    hessian: Square,
}

struct Problem<'a> {
    half_space: (f64, f64),
    reading: &'a Reading<'a>,
    /// Standard deviations of the noise of normal and tangential displacements.
    stds: [f64; 2],
    /// Whether the noise of the normal and of the tangential displacements is estimated from the residuals.
    is_estimated: [bool; 2],
}

impl<'a> Problem<'a> {
    fn new(
        fit: &ForwardFit,
        half_space: (f64, f64),
        reading: &'a Reading<'a>,
    ) -> Result<Self, PressError> {
        let largest = reading
            .normal
            .iter()
            .fold(0.0, |most: f64, moved| most.max(moved.abs()));
        let stated = [fit.normal_std, fit.tangential_std].map(|std| std.filter(|&std| std > 0.0));
        let std = |stated: Option<f64>| stated.unwrap_or(0.05 * largest).max(1e-10 * largest);
        if largest.is_nan() || largest <= 0.0 {
            return Err(PressError::OutOfRange);
        }
        Ok(Self {
            half_space,
            reading,
            stds: stated.map(std),
            is_estimated: stated.map(|std| std.is_none()),
        })
    }

    /// Number of measured displacement components. The stated indentation does not count.
    fn readings(&self) -> usize {
        self.reading.normal.len()
            * if self.reading.tangential.is_some() {
                3
            } else {
                1
            }
    }

    fn contact(&self, state: &State) -> Result<(EllipticContact, f64), PressError> {
        let ([larger, smaller], angle) = principal(&state.log);
        let own = libm::log(self.reading.markers.scale().recip());
        if (smaller - own).abs().max((larger - own).abs()) > LOG_RANGE {
            return Err(PressError::OutOfRange);
        }
        let curvatures = [libm::exp(smaller), libm::exp(larger)];
        let contact = EllipticContact::new(self.half_space.0, curvatures, state.indentation)?;
        // The longer axis of the contact is in the direction of the smaller curvature.
        Ok((contact, angle + std::f64::consts::FRAC_PI_2))
    }

    fn residuals(&self, state: &State) -> Result<Vec<f64>, PressError> {
        let (contact, axis) = self.contact(state)?;
        let moved =
            self.reading
                .markers
                .moved_by_ellipse(&contact, &state.place, axis, self.half_space.1);
        let [normal_std, tangential_std] = self.stds;
        let normal = self.reading.normal.iter().zip(&moved);
        let mut residuals: Vec<f64> = normal
            .map(|(read, moved)| (read - moved.normal) / normal_std)
            .collect();
        for (read, moved) in self.reading.tangential.into_iter().flatten().zip(&moved) {
            let both = read.iter().zip(moved.tangential);
            residuals.extend(both.map(|(read, moved)| (read - moved) / tangential_std));
        }
        if let Some(known) = self.reading.indentation {
            let std = known.std.max(1e-9 * known.value);
            residuals.push((known.value - state.indentation) / std);
        }
        Ok(residuals)
    }

    fn stepped(&self, state: &State, step: &Step) -> State {
        let skin = self.reading.markers.skin();
        let place = if step[3] == 0.0 && step[4] == 0.0 {
            state.place
        } else {
            skin.place_at(&skin.beyond(&state.place, step[3], step[4]))
        };
        State {
            log: state.log + step.fixed_rows::<3>(0),
            place,
            indentation: state.indentation + step[INDENTATION],
        }
    }

    fn fit_at(&self, state: State) -> Result<(Fit, Step), PressError> {
        let residuals = self.residuals(&state)?;
        let size = self.contact(&state)?.0.semi_axes[1];
        let units = [1.0, 1.0, 1.0, size, size, state.indentation];
        let mut slopes = Vec::with_capacity(UNKNOWNS);
        for (index, unit) in units.into_iter().enumerate() {
            let mut step = Step::zeros();
            step[index] = DIFFERENCE * unit;
            let ahead = self.residuals(&self.stepped(&state, &step))?;
            let behind = self.residuals(&self.stepped(&state, &-step))?;
            let width = 2.0 * DIFFERENCE * unit;
            let slope = ahead
                .iter()
                .zip(&behind)
                .map(|(ahead, behind)| (behind - ahead) / width);
            slopes.push(slope.collect::<Vec<f64>>());
        }
        let dot =
            |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
        let fit = Fit {
            state,
            chi_squared: dot(&residuals, &residuals),
            hessian: Square::from_fn(|row, column| dot(&slopes[row], &slopes[column])),
            residuals,
        };
        let gradient = Step::from_fn(|row, _| dot(&slopes[row], &fit.residuals));
        Ok((fit, gradient))
    }

    fn minimise(&self, start: State) -> Result<Fit, PressError> {
        let (mut best, mut gradient) = self.fit_at(start)?;
        let mut damping = 1e-3;
        for _ in 0..MAX_STEPS {
            let mut damped = best.hessian;
            for index in 0..UNKNOWNS {
                damped[(index, index)] *= 1.0 + damping;
            }
            let Some(step) = damped.cholesky().map(|factor| factor.solve(&gradient)) else {
                damping *= 10.0;
                continue;
            };
            let promise = 2.0 * gradient.dot(&step) - step.dot(&(best.hessian * step));
            if promise <= ENOUGH {
                break;
            }
            let state = self.stepped(&best.state, &step);
            let squared = self
                .residuals(&state)
                .map(|left| left.iter().map(|one| one * one).sum::<f64>());
            if squared.is_ok_and(|squared| squared < best.chi_squared) {
                (best, gradient) = self.fit_at(state)?;
                damping *= 0.2;
            } else if damping > 1e10 {
                break;
            } else {
                damping = damping.max(1e-6) * 10.0;
            }
        }
        Ok(best)
    }

    /// Estimates the standard deviations of the noise that were not stated, from the residuals of a fit. Returns
    /// `false` if all standard deviations were stated.
    fn estimate_noise(&mut self, fit: &Fit) -> bool {
        let count = self.reading.normal.len();
        let share = 1.0 - UNKNOWNS as f64 / self.readings().max(UNKNOWNS + 1) as f64;
        let mut is_changed = false;
        // With few markers, one standard deviation is estimated from all residuals, as in `ForwardFit`.
        let kinds = match count < MIN_READINGS_PER_PARAMETER * UNKNOWNS {
            true => [0..self.readings(), 0..self.readings()],
            false => [0..count, count..self.readings()],
        };
        let stds = self.stds;
        for (kind, range) in kinds.into_iter().enumerate() {
            if self.is_estimated[kind] && !range.is_empty() {
                let length = |index| fit.residuals[index] * stds[usize::from(index >= count)];
                let readings = range.len() as f64;
                let squared: f64 = range.map(|index| length(index) * length(index)).sum();
                self.stds[kind] = (squared / readings / share).sqrt().max(1e-9 * stds[kind]);
                is_changed = true;
            }
        }
        is_changed
    }

    fn outcome(&self, best: &Fit) -> Result<PressEstimate, PressError> {
        let uses_tangential = self.reading.tangential.is_some();
        let is_estimated = self.is_estimated[0] || uses_tangential && self.is_estimated[1];
        let equations = self.readings() + usize::from(self.reading.indentation.is_some());
        let needed = UNKNOWNS + usize::from(is_estimated);
        if equations < needed {
            return Err(PressError::TooFewMarkers {
                markers: self.reading.normal.len(),
                equations,
                needed,
            });
        }
        let freedom = equations - UNKNOWNS;
        let what = "the markers do not determine both curvatures";
        let stds = Stds::new(&best.hessian).ok_or(PressError::Undetermined { what })?;
        let limit = if is_estimated {
            student_half_width(0.95, freedom)
        } else {
            student_half_width(0.95, 1_000_000)
        };
        let (contact, axis) = self.contact(&best.state)?;
        let skin = self.reading.markers.skin();
        skin.holds_contact(contact.semi_axes[0])?;
        let radius = contact.radius();
        self.reading.markers.see_around(&best.state.place, radius)?;
        let ([larger, smaller], angle) = principal(&best.state.log);
        let own = skin.curvature();
        let own_log = -libm::log(self.reading.markers.scale());
        if larger - own_log > MAX_LOG {
            let what = "the readings give no upper bound on the larger curvature";
            return Err(PressError::Undetermined { what });
        }
        let mut bounds = [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];
        for direction in 0..DIRECTIONS {
            let angle = angle + std::f64::consts::PI * direction as f64 / DIRECTIONS as f64;
            let value = along(angle).dot(&best.state.log);
            let width = limit * stds.along(angle);
            let ends = [value - width, value + width];
            // The larger principal curvature is the largest normal curvature of all directions. Therefore both ends of
            // its interval are the largest ends of the intervals of the normal curvatures. For the smaller principal
            // curvature, they are the smallest ends.
            bounds[0] = [0, 1].map(|end| bounds[0][end].max(ends[end]));
            bounds[1] = [0, 1].map(|end| bounds[1][end].min(ends[end]));
        }
        let across = stds.turn(angle);
        // Noise increases the difference between the two eigenvalues of a tensor on average. `repulsion` is this bias,
        // to second order in the noise.
        let gap = larger - smaller;
        let repulsion = (across * across / gap).min(0.5 * gap);
        // In axes that are rotated by the angle Δ from the estimated axis, the mixed component of the tensor is gap ·
        // sin(2Δ)/2, where `gap` is the difference between the eigenvalues. The 95 % interval of the axis contains the
        // angles at which this component is 0 within the noise. If the noise allows every angle, the standard error is
        // `unknown`, which is that of a uniformly distributed axis.
        let unknown = std::f64::consts::PI / 12.0_f64.sqrt();
        let sine = 2.0 * limit * across / gap;
        let axis_std = if sine < 1.0 {
            0.5 * libm::asin(sine) / limit
        } else {
            unknown
        };
        let finite = |log: f64| (log - own_log < MAX_LOG).then(|| libm::exp(log) - own);
        let curvature = |log: f64, bias: f64, angle: f64, [low, high]: [f64; 2]| {
            let std = stds.along(angle);
            // The readings are nearly linear in the radius of curvature. The estimated curvature is the inverse of this
            // radius, so noise makes it too large on average.
            let value = (log - bias - libm::log1p(std * std)).clamp(low, high);
            Estimated {
                value: libm::exp(value) - own,
                std: libm::exp(value) * std,
                interval: Interval {
                    low: Some(libm::exp(low) - own),
                    high: finite(high),
                },
            }
        };
        let mut curvatures = [
            curvature(larger, repulsion, angle, bounds[0]),
            curvature(smaller, -repulsion, axis, bounds[1]),
        ];
        // If both curvatures are about equal, the corrections may reverse their order.
        let values = curvatures.map(|curvature| curvature.value);
        curvatures[0].value = values[0].max(values[1]);
        curvatures[1].value = values[0].min(values[1]);
        let [mean, mean_std] = {
            let [larger, smaller] = [
                libm::exp(larger - repulsion),
                libm::exp(smaller + repulsion),
            ];
            let mean_std = stds.mean([larger, smaller], [angle, axis]);
            [0.5 * (larger + smaller), mean_std]
        };
        let half_width = libm::exp(limit * mean_std);
        let interval = Interval {
            low: Some(mean / half_width),
            high: finite(libm::log(mean * half_width)).map(|high| high + own),
        };
        let value = mean / (1.0 + mean_std * mean_std);
        let normal = &self.reading.normal;
        let average = normal.iter().sum::<f64>() / normal.len() as f64;
        let all: f64 = normal.iter().map(|read| (read - average).powi(2)).sum();
        let left: f64 = best.residuals[..normal.len()]
            .iter()
            .map(|one| one * one)
            .sum();
        Ok(PressEstimate {
            sensor_curvature: own,
            relative_curvature: Estimated {
                value,
                std: value * mean_std,
                interval,
            },
            most_likely_curvature: mean,
            principal: Some(PrincipalCurvatures {
                curvatures,
                axis: half_turn(axis),
                axis_std,
                contact,
            }),
            indentation: Estimated::normal(best.state.indentation, stds.indentation(), limit)
                .positive(),
            contact_radius: Estimated::normal(
                radius,
                stds.contact_radius(&contact, mean_std),
                limit,
            )
            .positive(),
            contact: skin.chart(best.state.place.direction.as_ref()),
            contact_std: stds.place(),
            baseline: None,
            gain: None,
            wrong_markers: Vec::new(),
            normal_std: self.stds[0],
            tangential_std: uses_tangential.then_some(self.stds[1]),
            r_squared: if all > 0.0 {
                1.0 - left * self.stds[0] * self.stds[0] / all
            } else {
                0.0
            },
            reduced_chi_squared: best.chi_squared / freedom.max(1) as f64,
            goodness: (!is_estimated).then(|| GoodnessOfFit::new(best.chi_squared, freedom)),
            is_detected: true,
            only_marker: None,
            verdict: Verdict::of(interval, own),
        })
    }
}

/// The angle of an axis, reduced to the range from −π/2 to π/2. An axis has no sign, so half turns do not change it.
fn half_turn(angle: f64) -> f64 {
    angle - std::f64::consts::PI * (angle / std::f64::consts::PI).round()
}
