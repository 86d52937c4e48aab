//! Weighted least squares through the rolling equations, for crossings of pad edges and for contact points.
//!
//! The unknowns are the coefficients of the object's shape, and for each roll its start and the error of its rotation.
//! The unknowns of each roll are eliminated from the normal equations, so that the computing time is proportional to
//! the number of rolls. If the derivatives were computed with the measured rotations, the errors of these rotations
//! would bias the estimate. Therefore the estimated errors are first subtracted from the rotations (a fit with errors
//! in variables).

mod changing_curvature;
mod estimated_noise;

use nalgebra::{Matrix2, Matrix2x3, Matrix4, SMatrix, SVector, Vector2, Vector4};

use crate::crossings::Crossing;
use crate::rolled_path::{
    LocalShape, MAX_COEFFICIENTS, PathPoint, RollRotations, StartFrame, by_coefficients, drive_of,
};
pub(crate) use crate::symmetric::inverse_of;

use estimated_noise::SharedError;
pub(crate) use estimated_noise::{EstimatedNoise, MIN_SHARE};

/// Largest number of steps of a fit.
const MAX_STEPS: usize = 100;

/// A fit ends if Newton's decrement is below this value. The decrement is the squared distance of the estimate from the
/// minimum, in units of the standard errors.
const DECREMENT: f64 = 1e-6;
/// If the tolerance of a fit is at least this value, the fit only provides a first guess. Its result is then accepted
/// even if the fit did not converge.
const ROUGH: f64 = 1e-4;
/// Derivatives are computed as finite differences. For this, an unknown is changed by this value.
pub(crate) const STEP: f64 = 1e-6;
/// A fit also ends if the largest change of an unknown is below this value, but above half of the largest change in the
/// step before. Further steps would then hardly improve the fit.
const SETTLED: f64 = 1e-5;
/// A step of a fit is its largest change of an unknown. If the ratio of a step to the previous step exceeds this value,
/// the steps seem to alternate between two points, and the next steps are halved.
const ALTERNATING: f64 = 0.8;
/// Smallest standard deviation of contact points in a weighted fit, in radii of the probe. All samples of a roll share
/// a rotation error. With a smaller standard deviation, rounding errors would hide the effect of this shared error.
const MIN_STD: f64 = 1e-5;

/// One reading of a roll.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Observation {
    /// A crossing of a pad edge.
    Crossing(Crossing),
    /// The mean of several contact points, and their number.
    Contact(Vector2<f64>, f64),
}

/// A roll that a fit uses. Distances are in radii of the probe.
#[derive(Clone, Debug)]
pub(crate) struct RollData {
    /// Index of the roll among all rolls.
    pub(crate) roll: usize,
    /// Number of rolls that change pads at the same samples.
    pub(crate) repeats: f64,
    pub(crate) is_start_known: bool,
    /// Contact point at the start of the roll, or a first guess of it.
    pub(crate) start: Vector2<f64>,
    /// Standard deviation of the first guess `start`, in radii of the probe; infinite if the fit must ignore the guess.
    pub(crate) start_std: f64,
    /// Largest accepted distance of the start from `start` along each axis, in radii of the probe.
    pub(crate) start_limit: f64,
    /// Rotations of the probe at the readings. If the probe spins, there are more rotations between the readings.
    pub(crate) rotations: RollRotations,
    /// The readings, each with the index of its rotation in `rotations`.
    pub(crate) observations: Vec<(usize, Observation)>,
}

/// Noise of the readings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitNoise {
    /// Standard deviation of contact points, or of the contact at a crossing of a pad edge, in radii of the probe.
    pub(crate) contact_std: f64,
    /// Standard deviation (rad) of the part of a rotation's error that does not depend on the rotation. This error is
    /// independent in each sample.
    pub(crate) rotation_std: f64,
    /// Standard deviation of the error of the rotation in each sample, divided by the rotation.
    pub(crate) relative_sample_std: f64,
    /// Standard deviation of the relative error that all rotations of a roll have in common.
    pub(crate) relative_roll_std: f64,
    /// Whether the fit estimates the noise from its residuals: the noise of contact points, and the relative error that
    /// all rotations of a roll have in common.
    pub(crate) is_estimated: bool,
    /// If the variance of a contact point is estimated from residuals, it is at least this value (in squared radii of
    /// the probe).
    pub(crate) min_variance: f64,
    /// Weights of a normal prior with mean 0 for the coefficients of the shape: the inverse of the prior variance of each
    /// coefficient, or 0 if it has no prior.
    pub(crate) prior: [f64; MAX_COEFFICIENTS],
}

/// The state and the normal equations of one roll. Two unknowns of the roll itself, its start and the error of its
/// rotation, are eliminated from the equations.
#[derive(Clone, Debug)]
pub(crate) struct RollFit<const N: usize> {
    pub(crate) start: Vector2<f64>,
    error: Vector2<f64>,
    /// Estimated ratio of the true to the measured rotation.
    ratio: f64,
    pub(crate) information: SMatrix<f64, N, N>,
    pub(crate) gradient: SVector<f64, N>,
    pub(crate) chi_squared: f64,
    /// Logarithm of the roll's part of the evidence, without chi-squared.
    log_weights: f64,
    /// Number of scalar readings minus the number of unknowns of the roll.
    pub(crate) freedom: usize,
    shared: SharedError<N>,
    step: Vector4<f64>,
    /// Derivatives of the roll's own unknowns (two components of its start, two of its rotation error) with respect to
    /// the coefficients of the shape.
    pub(crate) response: SMatrix<f64, 4, N>,
    /// Position of the contact that is farthest from the start on the object, in the frame that is carried along the
    /// path.
    pub(crate) end: Vector2<f64>,
}

/// The result of a fit to all rolls.
#[derive(Clone, Debug)]
pub(crate) struct SeriesFit<const N: usize> {
    pub(crate) shape: LocalShape,
    /// Sum of the normal equations of the rolls. For a shape with one term, the unknowns are the entries uu, uv, vv of
    /// the mobility (contact travel per radian); otherwise they are the coefficients of the shape.
    pub(crate) information: SMatrix<f64, N, N>,
    pub(crate) covariance: SMatrix<f64, N, N>,
    pub(crate) rolls: Vec<RollFit<N>>,
    pub(crate) chi_squared: f64,
    pub(crate) freedom: usize,
    /// The noise, if it is estimated from the residuals.
    pub(crate) estimated: Option<EstimatedNoise>,
}

impl<const N: usize> RollFit<N> {
    fn new(roll: &RollData) -> Self {
        Self {
            start: roll.start,
            error: Vector2::zeros(),
            ratio: 1.0,
            information: SMatrix::zeros(),
            gradient: SVector::zeros(),
            chi_squared: 0.0,
            log_weights: 0.0,
            freedom: 0,
            shared: SharedError {
                information: Matrix2::zeros(),
                mixed: SMatrix::zeros(),
                gradient: Vector2::zeros(),
            },
            step: Vector4::zeros(),
            response: SMatrix::zeros(),
            end: Vector2::zeros(),
        }
    }

    /// Paths of the contact. For each path, one unknown is changed a little. The unknowns are three entries of the
    /// curvature form or of the mobility (contact travel per radian), and two components of the roll's rotation error.
    ///
    /// The rotation error and the mobility change the path in nearly the same way. Therefore the small difference
    /// between the two changes must be exact. Other derivatives are correct only to first order in the curvature of the
    /// probe.
    fn nearby(&self, roll: &RollData, shape: &LocalShape) -> Option<Vec<Vec<PathPoint>>> {
        let mut all = Vec::with_capacity(5);
        for unknown in 0..5 {
            let (mut shape, mut error) = (*shape, self.error);
            if unknown < 3 {
                let mut step = SVector::<f64, N>::zeros();
                step[unknown] = STEP;
                shape = moved(&shape, &step)?.0;
            } else {
                error[unknown - 3] += STEP;
            }
            let mut path = Vec::with_capacity(roll.observations.len());
            roll.rotations
                .path(&shape, &(error * self.ratio), &mut path)?;
            all.push(path);
        }
        Some(all)
    }

    /// Computes the contacts and the normal equations of the roll.
    fn linearise(
        &mut self,
        roll: &RollData,
        noise: &FitNoise,
        shape: &LocalShape,
        covariance: &SMatrix<f64, N, N>,
        path: &mut Vec<PathPoint>,
    ) -> Option<()> {
        roll.rotations
            .path(shape, &(self.error * self.ratio), path)?;
        let relative = shape.relative();
        // The contact depends on the product of the mobility and the rotation error. Their estimation errors are
        // correlated, so this product has a bias. `product` is this bias as a rotation error. The prior of the rotation
        // error below compensates for it.
        let joint = covariance.fixed_rows::<3>(0) * self.response.fixed_rows::<2>(2).transpose();
        let product = relative * Vector2::new(joint[0] + joint[4], joint[1] + joint[5]);
        let frame = StartFrame::new(&self.start);
        let mut of_shape = SMatrix::<f64, N, N>::zeros();
        let mut mixed = SMatrix::<f64, 4, N>::zeros();
        let mut own = Matrix4::zeros();
        let mut gradient = SVector::<f64, N>::zeros();
        let mut own_gradient = Vector4::zeros();
        let (mut chi_squared, mut count, mut log_weights) = (0.0, 0, 0.0);
        let knows_error = noise.relative_roll_std == 0.0;
        let measured = roll.rotations.rotations();
        // All or none of the derivatives must include the effect of the spin.
        let is_mixed = N == 3 && roll.rotations.is_spun();
        let nearby = match knows_error && !is_mixed {
            true => Vec::new(),
            false => self.nearby(roll, shape)?,
        };
        for &(index, ref observation) in &roll.observations {
            let at = &path[index];
            let place = frame.place(at);
            let by_drive = place.by_path * at.mobility;
            // The error of the rotation about the contact normal is proportional to the rotation since the start of the
            // roll. It therefore turns the contact's path from start to end by half of its final value. All readings of
            // the roll share this error.
            let turned = match roll.rotations.has_spin() {
                true => noise.relative_roll_std * drive_of(&measured[index]).norm() * 0.5,
                false => 0.0,
            };
            let turned = at.x.norm_squared() * turned * turned * roll.observations.len() as f64;
            let mut shared = Matrix2::zeros();
            let (residual, weight, rotation_error, rows) = match observation {
                Observation::Crossing(crossing) => {
                    let residual = crossing.offset - crossing.normal.dot(&place.place);
                    let across = by_drive.tr_mul(&crossing.normal);
                    // An error of the rotation about the contact normal turns the contact's path about its start.
                    let aside = crossing.normal.perp(&(place.by_path * at.x));
                    // A weight computed from the measured rotation would depend on its error and bias the estimate.
                    let drive = drive_of(&measured[index]);
                    let growth = crossing.change.dot(&drive) / drive.norm().max(f64::MIN_POSITIVE);
                    let change = crossing.change - self.error * (self.ratio * growth);
                    let width = Crossing::width(&across, &change);
                    let variance = (across.norm_squared() + aside * aside) * crossing.variance
                        + (width * width + crossing.gap * crossing.gap) / 12.0
                        + noise.contact_std * noise.contact_std * roll.repeats
                        + turned;
                    log_weights -= 0.5 * libm::log(variance);
                    let normal = crossing.normal;
                    let weight = normal * normal.transpose() / variance;
                    // Errors of measured rotations bias the estimate. At a crossing, the rotation error is so small
                    // that the bias is negligible, so it is not corrected.
                    (normal * residual, weight, Vector2::zeros(), 1)
                }
                Observation::Contact(contact, samples) => {
                    let residual = contact - place.place;
                    if noise.is_estimated {
                        shared = by_drive * -drive_of(&measured[index]).norm();
                    }
                    let rounded = libm::hypot(MIN_STD, MIN_SHARE * noise.relative_roll_std);
                    let own = noise.contact_std * noise.contact_std / samples
                        + rounded * rounded
                        + turned;
                    let square = by_drive * by_drive.transpose();
                    let (mut weight, mut error) = (Matrix2::zeros(), Vector2::zeros());
                    // The standard deviation of the noise is proportional to the true rotation, so the weight is
                    // computed from the corrected rotation. A weight computed from the measured rotation would depend
                    // on its error and bias the estimate.
                    for _ in 0..2 {
                        let size = (relative * (at.x + at.mobility * error)).norm();
                        let relative_std = noise.relative_sample_std * size;
                        let variance = (noise.rotation_std * noise.rotation_std
                            + relative_std * relative_std)
                            / samples;
                        weight = (Matrix2::identity() * own + square * variance).try_inverse()?;
                        error = by_drive.tr_mul(&(weight * residual)) * variance;
                    }
                    (residual, weight, error, 2)
                }
            };
            let x = at.x + at.mobility * rotation_error;
            let mut slopes = slopes_at::<N>(shape, &x, &place.by_path, &by_drive);
            let mut own_slopes = SMatrix::<f64, 2, 4>::zeros();
            own_slopes.fixed_view_mut::<2, 2>(0, 2).copy_from(&shared);
            if !roll.is_start_known {
                own_slopes
                    .fixed_view_mut::<2, 2>(0, 0)
                    .copy_from(&place.by_start);
            }
            if !nearby.is_empty() {
                let without = slopes_at::<N>(shape, &at.x, &place.by_path, &by_drive);
                for (unknown, path) in nearby.iter().enumerate() {
                    let slope = (frame.place(&path[index]).place - place.place) / STEP;
                    if unknown < 3 {
                        let more = slope - without.column(unknown);
                        slopes.set_column(unknown, &(slopes.column(unknown) + more));
                    } else if !knows_error {
                        own_slopes.set_column(unknown - 1, &slope);
                    }
                }
            }
            let weighted = weight * residual;
            of_shape += slopes.tr_mul(&(weight * slopes));
            mixed += own_slopes.tr_mul(&(weight * slopes));
            own += own_slopes.tr_mul(&(weight * own_slopes));
            gradient += slopes.tr_mul(&weighted);
            own_gradient += own_slopes.tr_mul(&weighted);
            chi_squared += residual.dot(&weighted);
            count += rows;
        }
        // If the start or the rotation error is fixed, the derivatives of the readings with respect to it are 0, so the
        // fit does not change it. In this case, its weight is 1, which only keeps the matrix invertible. Otherwise its
        // weight is the inverse of its prior variance.
        let prior = 1.0 / (roll.start_std * roll.start_std);
        // The readings may not determine both components of the start. This is the number that they determine.
        let of_start = own.fixed_view::<2, 2>(0, 0).into_owned();
        let with_prior = of_start + Matrix2::from_diagonal_element(prior);
        let determined = with_prior
            .try_inverse()
            .map(|inverse| (of_start * inverse).trace());
        let error_prior = match knows_error {
            true => 1.0,
            false => noise.relative_roll_std.powi(-2),
        };
        for part in 0..2 {
            if roll.is_start_known {
                own[(part, part)] = 1.0;
            } else {
                own[(part, part)] += prior;
                own_gradient[part] += prior * (roll.start[part] - self.start[part]);
            }
        }
        if noise.is_estimated {
            self.shared = SharedError::new(&own, &mixed, &own_gradient)?;
            own.fixed_view_mut::<2, 4>(2, 0).fill(0.0);
            own.fixed_view_mut::<4, 2>(0, 2).fill(0.0);
            mixed.fixed_view_mut::<2, N>(2, 0).fill(0.0);
            own_gradient.fixed_view_mut::<2, 1>(2, 0).fill(0.0);
        }
        for part in 0..2 {
            own[(part + 2, part + 2)] += error_prior;
            let error = self.error[part] + if N == 3 { product[part] } else { 0.0 };
            own_gradient[part + 2] -= error_prior * error;
            chi_squared += error_prior * error * error;
        }
        let determinant = own.determinant();
        let inverse = own.cholesky()?.inverse();
        self.response = -inverse * mixed;
        self.step = inverse * own_gradient;
        self.log_weights = (log_weights - 0.5 * libm::log(determinant)) / roll.repeats
            + 0.5 * own_gradient.dot(&self.step);
        self.information = of_shape + mixed.tr_mul(&self.response);
        self.gradient = gradient - mixed.tr_mul(&self.step);
        self.chi_squared = chi_squared;
        let determined = determined.filter(|_| !roll.is_start_known).unwrap_or(0.0);
        self.freedom = usize::saturating_sub(count, determined.round() as usize);
        let size = |one: &&PathPoint| one.x.norm_squared();
        let order = |one: &&PathPoint, other: &&PathPoint| size(one).total_cmp(&size(other));
        if let Some(farthest) = path.iter().max_by(order) {
            self.end = farthest.x;
            let measured = measured.last().map(drive_of).unwrap_or_default();
            let size = measured.norm().max(f64::MIN_POSITIVE);
            self.ratio = (measured - self.error * (self.ratio * size)).norm() / size;
        }
        Some(())
    }
}

impl SeriesFit<3> {
    /// Logarithm of the evidence for the noise that this fit assumes, up to a constant. The evidence is the probability
    /// density of the crossings, integrated over all shapes, starts and rotation errors (Laplace's approximation).
    pub(crate) fn log_evidence(&self) -> f64 {
        let (mut evidence, mut gradient) = (-0.5 * self.chi_squared, SVector::zeros());
        for roll in &self.rolls {
            evidence += roll.log_weights;
            gradient += roll.gradient;
        }
        // Chi-squared was computed before the last step of the fit. Add the effect of this step.
        evidence += 0.5 * gradient.dot(&(self.covariance * gradient));
        evidence - 0.5 * libm::log(self.information.determinant())
    }
}

impl<const N: usize> SeriesFit<N> {
    /// Fits the object's shape to `rolls`, starting from `shape`. The steps end if the coefficients change by less than
    /// `tolerance`. `None` if the readings do not determine the coefficients.
    pub(crate) fn new(
        rolls: &[RollData],
        noise: &FitNoise,
        shape: LocalShape,
        tolerance: f64,
    ) -> Option<Self> {
        let mut fit = Self {
            shape,
            information: SMatrix::zeros(),
            covariance: SMatrix::zeros(),
            rolls: rolls.iter().map(RollFit::new).collect(),
            chi_squared: 0.0,
            freedom: 0,
            estimated: None,
        };
        let mut path = Vec::new();
        let (mut last_change, mut damping) = (f64::INFINITY, 1.0);
        for _ in 0..MAX_STEPS {
            let mut gradient = SVector::<f64, N>::zeros();
            fit.information = SMatrix::zeros();
            (fit.chi_squared, fit.freedom) = (0.0, 0);
            for (roll, state) in rolls.iter().zip(&mut fit.rolls) {
                state.linearise(roll, noise, &fit.shape, &fit.covariance, &mut path)?;
                fit.information += state.information;
                gradient += state.gradient;
                fit.chi_squared += state.chi_squared;
                fit.freedom += state.freedom;
            }
            let prior = SVector::<f64, N>::from_column_slice(&noise.prior[..N]);
            let own = SVector::<f64, N>::from_column_slice(&fit.shape.tensors[..N]);
            fit.information += SMatrix::from_diagonal(&prior);
            gradient -= prior.component_mul(&own);
            fit.chi_squared += own.dot(&prior.component_mul(&own));
            fit.freedom += prior.iter().filter(|weight| **weight > 0.0).count();
            fit.freedom = fit.freedom.saturating_sub(N);
            fit.covariance = inverse_of(&fit.information)?;
            let full = fit.covariance * gradient;
            let (shape, share) = moved(&fit.shape, &full)?;
            let step = full * (share * damping);
            fit.shape = match damping < 1.0 {
                true => moved(&fit.shape, &step)?.0,
                false => shape,
            };
            let mut change = step.amax();
            for (roll, state) in rolls.iter().zip(&mut fit.rolls) {
                let own = state.step * (share * damping) + state.response * step;
                // Keep the estimated start of the roll on the roll's first pad. The crossings of pad edges may hardly
                // determine the start. In a model with too few terms, the fit would then move the start far away to
                // reduce the residuals.
                let before = state.start;
                for part in 0..2 {
                    let moved = before[part] + own[part];
                    let guess = roll.start[part];
                    state.start[part] = moved
                        .max(guess - roll.start_limit)
                        .min(guess + roll.start_limit);
                }
                // The largest change includes the changes of the roll's start and of its rotation error.
                let moved = (state.start - before).amax();
                change = change.max(moved).max(own.fixed_rows::<2>(2).amax());
                state.error += own.fixed_rows::<2>(2);
            }
            // Newton's decrement is the squared distance of the estimate from the minimum, in units of the standard
            // errors.
            let scale = fit.chi_squared / fit.freedom.max(1) as f64;
            let decrement = gradient.dot(&full) / scale.clamp(f64::MIN_POSITIVE, 1.0);
            // The changes may stop decreasing before they are below the tolerance, because of rounding errors and of
            // weights that depend on the result.
            let is_settled = change < SETTLED && change > 0.5 * last_change;
            if change < tolerance || is_settled || (share == 1.0 && decrement < DECREMENT) {
                return fit.chi_squared.is_finite().then_some(fit);
            }
            // Successive steps may alternate between two points, because starts and shape depend on each other. Half of
            // a step leads to the middle between these points.
            if change > ALTERNATING * last_change {
                damping = 0.5;
            }
            last_change = change;
        }
        // If rolls contradict each other, the fit may not converge. With a rough tolerance, the result is still good
        // enough as the start of a search.
        (tolerance >= ROUGH && fit.chi_squared.is_finite()).then_some(fit)
    }

    /// Chi-squared of all rolls minus chi-squared without this roll, and the degrees of freedom of this difference.
    /// `None` if the other rolls do not determine the coefficients.
    /// If the noise is estimated, the result includes only the part that is due to the shared rotation errors.
    pub(crate) fn fall_without(&self, roll: &RollFit<N>) -> Option<(f64, usize)> {
        let others = inverse_of(&(self.information - roll.information))?;
        let (own, freedom) = match &self.estimated {
            Some(noise) => (roll.shared.chi_squared(noise.ratio()), roll.freedom.min(2)),
            None => (roll.chi_squared, roll.freedom),
        };
        // The result must include only the effect of the shared rotation errors. With more than three unknowns, the
        // gradient depends mainly on the noise of samples. Therefore leave out the gradient's contribution.
        if self.estimated.is_some() && N > 3 {
            return Some((own, freedom));
        }
        let fall = own + roll.gradient.dot(&(others * roll.gradient));
        fall.is_finite().then_some((fall, freedom))
    }
}

/// Derivatives of the contact's position on the probe with respect to the unknowns of the shape, for a contact at `x`
/// on the object.
pub(crate) fn slopes_at<const N: usize>(
    shape: &LocalShape,
    x: &Vector2<f64>,
    by_path: &Matrix2<f64>,
    by_drive: &Matrix2<f64>,
) -> SMatrix<f64, 2, N> {
    if shape.terms > 1 {
        return by_coefficients(shape.terms, x, by_drive);
    }
    let drive = shape.relative() * x;
    let columns = [[drive.x, 0.0], [drive.y, drive.x], [0.0, drive.y]];
    let slopes = by_path * Matrix2x3::from_columns(&columns.map(Vector2::from));
    SMatrix::from_fn(|row, column| slopes[(row, column.min(2))])
}

/// The shape after a step, and the share of the step that was done. The step is shortened if the contact could not roll
/// after the full step.
pub(crate) fn moved<const N: usize>(
    shape: &LocalShape,
    step: &SVector<f64, N>,
) -> Option<(LocalShape, f64)> {
    let mut share = 1.0;
    for _ in 0..12 {
        let mut tried = *shape;
        if shape.terms == 1 {
            let mobility = shape.relative().try_inverse()?
                + Matrix2::new(step[0], step[1], step[1], step[2]) * share;
            if mobility.determinant() > 1e-12 && mobility.trace() > 0.0 {
                return Some((LocalShape::of_mobility(&mobility)?, share));
            }
        } else {
            for (tensor, step) in tried.tensors.iter_mut().zip(step.iter()) {
                *tensor += step * share;
            }
            let relative = tried.relative();
            if relative.determinant() > 1e-12 && relative.trace() > 0.0 {
                return Some((tried, share));
            }
        }
        share *= 0.5;
    }
    None
}
