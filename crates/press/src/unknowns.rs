//! The list of a press's fit parameters, and chi-squared with its derivatives with respect to these parameters.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::least_squares::solve;
use crate::{Body, Contact, Measured, Place, PressError, Skin};

pub(crate) const UNKNOWNS: usize = 6;
/// Index of the logarithm of the relative curvature among the fit parameters.
pub(crate) const CURVATURE: usize = 0;
/// Index, among the fit parameters, of the contact's position along the x axis at the contact.
pub(crate) const ALONG: usize = 1;
/// Index, among the fit parameters, of the contact's position along the y axis at the contact.
pub(crate) const ACROSS: usize = 2;
pub(crate) const INDENTATION: usize = 3;
/// Index of the first of the two fit parameters that depend on the kind of fit. They are baseline and gain in a fit of
/// displacements, and the object's sideways shift in a fit of images.
pub(crate) const OTHERS: usize = 4;

pub(crate) type Unknowns = SVector<f64, UNKNOWNS>;
pub(crate) type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Limit below which a standard deviation is treated as 0. A parameter counts as exact if the standard deviation of its
/// prior is at most this value times the scale of the parameter. Rounding errors would spoil a fit with such a narrow
/// prior. The smallest noise that a fit assumes is this value times the largest displacement.
pub(crate) const EXACT: f64 = 1e-10;

/// States which parameters of a press are fitted, and contains their normal priors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fitted {
    /// For each fit parameter, whether it is fitted; `false` for exact parameters.
    pub(crate) sought: [bool; UNKNOWNS],
    /// Prior of each fit parameter; `None` for parameters without a prior.
    priors: [Option<Measured>; UNKNOWNS],
}

impl Fitted {
    /// Prepares a fit of all parameters, except for an indentation that is stated exactly. `indentation` is `None` if
    /// no indentation is stated. `others` contains the priors of the two fit parameters that depend on the kind of fit.
    pub(crate) fn new(indentation: Option<Measured>, others: [Option<Measured>; 2]) -> Self {
        let (mut sought, mut priors) = ([true; UNKNOWNS], [None; UNKNOWNS]);
        sought[INDENTATION] = indentation.is_none_or(|known| known.std > EXACT * known.value);
        priors[INDENTATION] = indentation;
        priors[OTHERS..].copy_from_slice(&others);
        Self { sought, priors }
    }

    pub(crate) fn count(&self) -> usize {
        self.sought.iter().filter(|&&sought| sought).count()
    }

    /// The priors of the fitted parameters, each with the index of its parameter.
    pub(crate) fn priors(&self) -> impl Iterator<Item = (usize, Measured)> + '_ {
        let fitted = (0..UNKNOWNS).filter(|&unknown| self.sought[unknown]);
        fitted.filter_map(|unknown| Some((unknown, self.priors[unknown]?)))
    }

    pub(crate) fn prior_sums(&self, state: &State) -> Sums {
        let mut sums = Sums::default();
        for (unknown, Measured { value, std }) in self.priors() {
            let at = match unknown {
                INDENTATION => state.indentation,
                other => state.others[other - OTHERS],
            };
            sums.add_prior(unknown, at - value, std);
        }
        sums
    }
}

/// Chi-squared of a fit, with its derivatives with respect to the fit parameters.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) chi_squared: f64,
    /// Half the gradient of chi-squared with respect to the fit parameters.
    pub(crate) gradient: Unknowns,
    /// Half the Hessian of chi-squared, without second derivatives of the model.
    pub(crate) hessian: Square,
}

impl Sums {
    /// Chi-squared and its derivatives after a small step of the fit parameters, predicted by the quadratic
    /// approximation of chi-squared.
    pub(crate) fn after(&self, step: &Unknowns) -> Self {
        let along = self.hessian * step;
        Self {
            chi_squared: self.chi_squared + 2.0 * self.gradient.dot(step) + step.dot(&along),
            gradient: self.gradient + along,
            hessian: self.hessian,
        }
    }

    pub(crate) fn holding(mut self, held: usize) -> Self {
        self.gradient[held] = 0.0;
        self.hessian.row_mut(held).fill(0.0);
        self.hessian.column_mut(held).fill(0.0);
        self.hessian[(held, held)] = 1.0;
        self
    }

    /// The next step of the Levenberg–Marquardt method; `None` if the damped Hessian is not positive definite.
    pub(crate) fn damped_step(&self, damping: f64) -> Option<Unknowns> {
        let mut damped = self.hessian;
        for index in 0..UNKNOWNS {
            damped[(index, index)] *= 1.0 + damping;
        }
        solve(&damped, &-self.gradient)
    }

    /// Derivatives of all fit parameters with respect to the logarithm of the curvature. When the curvature changes,
    /// the other fit parameters change such that chi-squared stays minimal.
    pub(crate) fn ridge(&self) -> Unknowns {
        let across = -self.hessian.column(CURVATURE);
        let mut along = solve(&self.holding(CURVATURE).hessian, &across).unwrap_or_default();
        along[CURVATURE] = 1.0;
        along
    }

    /// Adds the prior of the fit parameter with the index `unknown` to the sums. `off` is the difference between the
    /// parameter and the prior's mean, and `std` the prior's standard deviation.
    fn add_prior(&mut self, unknown: usize, off: f64, std: f64) {
        self.chi_squared += (off / std) * (off / std);
        self.gradient[unknown] += off / (std * std);
        self.hessian[(unknown, unknown)] += 1.0 / (std * std);
    }

    /// Adds one reading to the gradient and the Hessian. `residual` is its residual in standard deviations, `weight`
    /// its weight in the fit, and `slopes` contains the derivatives of the predicted reading with respect to the fit
    /// parameters.
    #[inline]
    pub(crate) fn add(&mut self, residual: f64, weight: f64, slopes: &Unknowns) {
        for row in 0..UNKNOWNS {
            let weighted = weight * slopes[row];
            self.gradient[row] -= weighted * residual;
            for column in 0..=row {
                self.hessian[(row, column)] += weighted * slopes[column];
            }
        }
    }

    /// Completes the Hessian by symmetry, and removes the derivatives with respect to parameters that are not fitted.
    pub(crate) fn only(&mut self, sought: &[bool; UNKNOWNS]) {
        for row in 0..UNKNOWNS {
            for column in 0..row {
                if !(sought[row] && sought[column]) {
                    self.hessian[(row, column)] = 0.0;
                }
                self.hessian[(column, row)] = self.hessian[(row, column)];
            }
            if !sought[row] {
                self.gradient[row] = 0.0;
                self.hessian[(row, row)] = 1.0;
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) log_curvature: f64,
    pub(crate) place: Place,
    pub(crate) indentation: f64,
    /// The two fit parameters that depend on the kind of fit. In a fit of displacements, they are the baseline (offset)
    /// and the gain. In a fit of images, they are the two components of the object's sideways shift.
    pub(crate) others: [f64; 2],
}

impl State {
    pub(crate) fn new(
        relative_curvature: f64,
        place: Place,
        indentation: f64,
        others: [f64; 2],
    ) -> Self {
        Self {
            log_curvature: libm::log(relative_curvature),
            place,
            indentation,
            others,
        }
    }

    pub(crate) fn contact<'b>(
        &self,
        skin: &Skin,
        body: &'b Body,
    ) -> Result<Contact<'b>, PressError> {
        skin.press(body, libm::exp(self.log_curvature), self.indentation)
    }

    /// The fit parameters after the step `step`. `place_at` converts a direction from the centre of the sensor to a
    /// place on its skin.
    pub(crate) fn stepped(
        &self,
        skin: &Skin,
        step: &Unknowns,
        place_at: impl Fn(&Vector3<f64>) -> Place,
    ) -> Self {
        let place = if step[ALONG] == 0.0 && step[ACROSS] == 0.0 {
            self.place
        } else {
            place_at(&skin.beyond(&self.place, step[ALONG], step[ACROSS]))
        };
        Self {
            log_curvature: self.log_curvature + step[CURVATURE],
            place,
            indentation: self.indentation + step[INDENTATION],
            others: [0, 1].map(|other| self.others[other] + step[OTHERS + other]),
        }
    }
}
