//! Fits the sensor's parameters to the image of the markers at rest.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Dyn, Matrix2, Matrix4, OMatrix, U2, Vector2, Vector4};

use super::ImageFit;
use super::departure_prior::FreePrior;
use super::view::{
    MAX_MISALIGNMENT, NUMBERS, PictureSlopes, Seen, Sensor, SensorState, difference,
};
use crate::{MarkerDisplacement, PressError};

/// The sensor's parameters, fitted to the frame at rest: misalignments of the markers, and sensor deviations that are
/// common to all markers.
#[derive(Clone, Debug)]
pub struct Rest {
    /// The most likely deviations of the sensor from its nominal parameters, common to all markers.
    pub common: Vec<f64>,
    /// The most likely misalignment (rad) of each marker's two discs, as angles at the sensor's centre.
    pub misalignments: Vec<[f64; 2]>,
    /// Whether each marker has a reading in the frame at rest.
    pub seen: Vec<bool>,
    /// Chi-squared of the fit at rest, including the priors. If the sensor model is correct, the expected value of
    /// chi-squared is `freedom`.
    pub chi_squared: f64,
    /// Number of degrees of freedom of `chi_squared`.
    pub freedom: usize,
    /// Information matrix (inverse covariance) of the uncertain deviations in `common`, from the frame at rest and the
    /// priors.
    pub(super) information: DMatrix<f64>,
    /// Uncertainty of each marker's misalignment: its linear dependence on the uncertain sensor parameters, and its
    /// covariance if these parameters were exact. `None` for a marker without a reading.
    pub(super) local: Vec<Option<Local>>,
    /// Predicted images of the markers at rest, and their derivatives. They belong to the sensor parameters at which
    /// the model was linearised.
    pub(super) slopes: Arc<PictureSlopes>,
    pub(super) frame: Arc<RestFrame>,
}

impl Rest {
    pub(super) fn sensor(&self) -> Sensor {
        Sensor {
            common: self.common.clone(),
            misalignments: self.misalignments.clone(),
        }
    }

    /// Covariance of the uncertain deviations of the sensor's parameters in [`Self::common`]. Each deviation is in
    /// units of the standard deviation of its prior. The result is `None` if the covariance cannot be computed.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let factor = self.information.clone().cholesky()?;
        Some(factor.inverse())
    }
}

/// Uncertainty of the misalignment of one marker after the fit of the frame at rest.
#[derive(Clone, Debug)]
pub(super) struct Local {
    pub(super) follows: OMatrix<f64, U2, Dyn>,
    pub(super) spread: Matrix2<f64>,
}

impl ImageFit {
    /// Fits the sensor to its markers at rest. `seen` contains one reading per marker; `None` for markers that are not
    /// visible.
    ///
    /// # Errors
    /// [`PressError::BadSetting`], [`PressError::NotFinite`] for invalid settings and readings;
    /// [`PressError::TooFewMarkers`] if no marker is visible; [`PressError::HiddenMarker`] if a marker has a reading
    /// but is not visible in the model; [`PressError::OutOfRange`] if no sensor fits.
    pub fn at_rest(&self, seen: &[Option<Seen>]) -> Result<Rest, PressError> {
        self.validate()?;
        let frame = RestFrame {
            weights: self.weights(seen)?,
            seen: seen.to_vec(),
        };
        if frame.markers() == 0 {
            return Err(PressError::TooFewMarkers {
                markers: 0,
                equations: 0,
                needed: 1,
            });
        }
        self.resting(frame.into())?.rest()
    }

    /// For each marker, the inverse covariance of its reading; `None` for markers without a reading.
    fn weights(&self, seen: &[Option<Seen>]) -> Result<Vec<Option<Matrix4<f64>>>, PressError> {
        let good = seen.len() == self.markers.places().len();
        PressError::unless_good("readings", seen.len() as f64, good, "one for each marker")?;
        let weight = |(marker, seen): (usize, &Option<Seen>)| {
            let Some(seen) = seen else { return Ok(None) };
            seen.check(marker)?;
            let factor = seen.errors().cholesky();
            let factor = factor.ok_or(PressError::NotFinite { marker })?;
            Ok(Some(factor.inverse()))
        };
        seen.iter().enumerate().map(weight).collect()
    }

    fn resting(&self, frame: Arc<RestFrame>) -> Result<Resting<'_>, PressError> {
        Ok(Resting {
            fit: self,
            free: self.free(),
            known: self.known()?.map(Arc::new),
            frame,
        })
    }

    /// The same fit as `rest`, but with the model linearised at the sensor parameters `sensor`; `None` if these
    /// parameters are impossible.
    pub(super) fn rest_about(&self, rest: &Rest, sensor: &Sensor) -> Option<Rest> {
        let resting = self.resting(Arc::clone(&rest.frame)).ok()?;
        let free = resting.free.iter();
        let common = free.map(|&number| sensor.common[number] / self.common_stds[number]);
        let state = State {
            common: DVector::from_iterator(resting.free.len(), common),
            misalignments: sensor.misalignments.clone(),
        };
        let slopes = resting.slopes(&state)?;
        let equations = resting.equations(&state, &slopes, 0.0)?;
        let likeliest = resting.stepped(&state, &equations)?;
        Some(resting.result(likeliest, equations, slopes, rest.chi_squared))
    }
}

#[derive(Clone, Debug)]
pub(super) struct RestFrame {
    seen: Vec<Option<Seen>>,
    pub(super) weights: Vec<Option<Matrix4<f64>>>,
}

impl RestFrame {
    fn markers(&self) -> usize {
        self.weights.iter().flatten().count()
    }

    pub(super) fn residual(
        &self,
        marker: usize,
        pictures: &[Option<[f64; NUMBERS]>],
    ) -> Option<Vector4<f64>> {
        let (seen, picture) = (self.seen[marker]?, pictures[marker]?);
        Some(Vector4::from(difference(&seen.picture, &picture)))
    }
}

pub(super) struct Resting<'a> {
    pub(super) fit: &'a ImageFit,
    pub(super) free: Vec<usize>,
    pub(super) known: Option<Arc<FreePrior>>,
    pub(super) frame: Arc<RestFrame>,
}

/// Values of the fitted parameters: the uncertain deviations of the sensor from its nominal parameters (in standard
/// deviations of their priors) and the markers' misalignments (rad).
#[derive(Clone)]
pub(super) struct State {
    pub(super) common: DVector<f64>,
    pub(super) misalignments: Vec<[f64; 2]>,
}

/// The image of each marker, as four numbers (centroid, hue, logarithm of the size); `None` for markers that are not
/// visible.
pub(super) type Pictures = Vec<Option<[f64; NUMBERS]>>;

/// Linear equations for a step of the sensor parameters that are common to all markers. The markers' misalignments were
/// eliminated from these equations.
pub(super) struct Equations {
    information: DMatrix<f64>,
    right: DVector<f64>,
    local: Vec<Option<Own>>,
}

/// Equations for a step of the misalignment of one marker.
#[derive(Clone)]
struct Own {
    square: Matrix2<f64>,
    /// Inverse of the matrix `square`. It is 0 if the discs are exactly aligned, because the misalignment is then not
    /// fitted.
    inverse: Matrix2<f64>,
    across: OMatrix<f64, U2, Dyn>,
    right: Vector2<f64>,
}

impl Own {
    fn new(count: usize) -> Self {
        Self {
            square: Matrix2::zeros(),
            inverse: Matrix2::zeros(),
            across: OMatrix::<f64, U2, Dyn>::zeros(count),
            right: Vector2::zeros(),
        }
    }

    /// Adds the prior of the misalignment to the equations and inverts their matrix; `None` if the equations cannot be
    /// solved.
    fn solve(&mut self, misalignment: &[f64; 2], std: f64, damping: f64) -> Option<()> {
        if std > 0.0 {
            let per_square = std.powi(-2);
            self.right -= Vector2::from(*misalignment) * per_square;
            for axis in 0..2 {
                self.square[(axis, axis)] += (1.0 + damping) * per_square;
            }
            self.inverse = self.square.try_inverse()?;
        }
        Some(())
    }
}

/// The product `one`ᵀ · `other`. It must be symmetric, because only one triangle is computed.
pub(super) fn products(one: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
    let count = one.ncols();
    let mut products = DMatrix::zeros(count, count);
    for row in 0..count {
        for column in row..count {
            let product = one.column(row).dot(&other.column(column));
            products[(row, column)] = product;
            products[(column, row)] = product;
        }
    }
    products
}

impl Resting<'_> {
    pub(super) fn result(
        &self,
        state: State,
        equations: Equations,
        slopes: PictureSlopes,
        chi_squared: f64,
    ) -> Rest {
        let Equations {
            information, local, ..
        } = equations;
        Rest {
            common: self.common(&state),
            misalignments: state.misalignments,
            seen: self.frame.weights.iter().map(Option::is_some).collect(),
            chi_squared,
            freedom: self.freedom(),
            information,
            local: local
                .into_iter()
                .map(|own| {
                    own.map(|own| Local {
                        follows: -own.inverse * own.across,
                        spread: own.inverse,
                    })
                })
                .collect(),
            slopes: Arc::new(slopes),
            frame: Arc::clone(&self.frame),
        }
    }

    /// Degrees of freedom of chi-squared. They equal the number of readings, because each fitted parameter has a prior.
    pub(super) fn freedom(&self) -> usize {
        NUMBERS * self.frame.markers()
    }

    fn common(&self, state: &State) -> Vec<f64> {
        let mut common = vec![0.0; self.fit.common_stds.len()];
        for (&number, departure) in self.free.iter().zip(state.common.iter()) {
            common[number] = departure * self.fit.common_stds[number];
        }
        common
    }

    pub(super) fn markers(&self) -> usize {
        self.fit.markers.places().len()
    }

    pub(super) fn pictures(&self, state: &State) -> Option<Pictures> {
        let common = self.common(state);
        let sensor = SensorState {
            common: &common,
            misalignments: &state.misalignments,
        };
        self.fit.pictures(&sensor, &self.still())
    }

    pub(super) fn slopes(&self, state: &State) -> Option<PictureSlopes> {
        let common = self.common(state);
        let sensor = SensorState {
            common: &common,
            misalignments: &state.misalignments,
        };
        self.fit.slopes(&sensor, &self.still(), None)
    }

    fn still(&self) -> Vec<[MarkerDisplacement; 2]> {
        vec![[MarkerDisplacement::default(); 2]; self.markers()]
    }

    /// The linear equations for a Levenberg–Marquardt step from the parameters `state`. `damping` is the damping of the
    /// step, relative to the information in the priors.
    pub(super) fn equations(
        &self,
        state: &State,
        slopes: &PictureSlopes,
        damping: f64,
    ) -> Option<Equations> {
        let count = self.free.len();
        let mut information = DMatrix::<f64>::identity(count, count) * (1.0 + damping);
        let mut right = -state.common.clone();
        let mut owns: Vec<Option<Own>> = vec![None; self.markers()];
        let mut weighted = slopes.common.clone();
        let mut residuals = DVector::zeros(weighted.nrows());
        for (marker, own) in owns.iter_mut().enumerate() {
            let first = NUMBERS * marker;
            let residual = self.frame.residual(marker, &slopes.pictures);
            let parts = self.frame.weights[marker].as_ref().zip(residual);
            let Some((weight, residual)) = parts else {
                weighted.rows_mut(first, NUMBERS).fill(0.0);
                continue;
            };
            let own = own.insert(Own::new(count));
            let by_local = &slopes.misalignments[marker];
            let local_weighted = by_local.transpose() * weight;
            residuals
                .fixed_rows_mut::<NUMBERS>(first)
                .copy_from(&residual);
            for column in 0..count {
                let mut rows = weighted.fixed_view_mut::<NUMBERS, 1>(first, column);
                let by_common: Vector4<f64> = rows.clone_owned();
                rows.copy_from(&(weight * by_common));
                let mut across = own.across.fixed_view_mut::<2, 1>(0, column);
                across += local_weighted * by_common;
            }
            own.square += local_weighted * by_local;
            own.right += local_weighted * residual;
        }
        information += products(&slopes.common, &weighted);
        right += weighted.tr_mul(&residuals);
        let mut across = DMatrix::zeros(2 * owns.len(), count);
        let mut taken = across.clone();
        let mut taken_right = DVector::zeros(across.nrows());
        for (marker, own) in owns.iter_mut().enumerate() {
            let Some(own) = own else { continue };
            own.solve(
                &state.misalignments[marker],
                self.fit.misalignment_std,
                damping,
            )?;
            across.rows_mut(2 * marker, 2).copy_from(&own.across);
            taken
                .rows_mut(2 * marker, 2)
                .copy_from(&(own.inverse * &own.across));
            taken_right
                .fixed_rows_mut::<2>(2 * marker)
                .copy_from(&(own.inverse * own.right));
        }
        information -= products(&across, &taken);
        right -= across.tr_mul(&taken_right);
        if let Some(known) = &self.known {
            known.cut(&state.common, &mut information, &mut right)?;
        }
        Some(Equations {
            information,
            right,
            local: owns,
        })
    }

    pub(super) fn stepped(&self, state: &State, equations: &Equations) -> Option<State> {
        let step = equations
            .information
            .clone()
            .cholesky()?
            .solve(&equations.right);
        let mut tried = state.clone();
        tried.common += &step;
        for (misalignment, own) in tried.misalignments.iter_mut().zip(&equations.local) {
            if let Some(own) = own {
                let moved = own.inverse * (own.right - &own.across * &step);
                for axis in 0..2 {
                    misalignment[axis] = (misalignment[axis] + moved[axis])
                        .clamp(-MAX_MISALIGNMENT, MAX_MISALIGNMENT);
                }
            }
        }
        Some(tried)
    }
}
