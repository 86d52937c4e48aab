//! Chi-squared of the images of a press, and its derivatives with respect to the fit parameters.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::allocator::Allocator;
use nalgebra::{
    DMatrix, DVector, DefaultAllocator, Dim, Dyn, Matrix, Matrix4, Matrix4x2, MatrixXx6, OMatrix,
    Storage, Vector4,
};

use super::ImageFit;
use super::disc_displacements::{DiscSlopes, Moving};
use super::fit_state::FitState;
use super::rest::{Rest, products};
use super::view::{NUMBERS, PictureSlopes, Seen, Sensor, difference};
use crate::least_squares::LeastSquares;
use crate::unknowns::{Fitted, OTHERS, Square, State, Sums, UNKNOWNS};
use crate::{MarkerDisplacement, Measured, PressError};

/// Index of the first component of the object's sideways shift among the fit parameters.
const SHIFT: usize = OTHERS;

/// Whitened residuals of the used markers. Whitening transforms residuals such that their errors are independent and
/// have unit variance.
pub(super) type Residuals = DVector<f64>;
/// Derivatives of the whitened images with respect to the fit parameters. A whitened image is the four numbers of a
/// marker's image, transformed such that their errors are independent and have unit variance.
pub(super) type Jacobian = MatrixXx6<f64>;

/// Derivatives of the whitened images, with the matrix products from which the derivatives of chi-squared are computed.
#[derive(Clone, Debug)]
pub(super) struct Slopes {
    pub(super) jacobian: Jacobian,
    /// The part of `jacobian` that a change of the sensor's parameters could also cause, as coordinates. There is one
    /// row per sensor parameter and one column per fit parameter.
    pub(super) shared: Jacobian,
    /// Scalar products of the columns of `jacobian`, with one row and one column per fit parameter. They do not contain
    /// the part of `jacobian` that a change of the sensor's parameters could also cause.
    pub(super) square: Square,
}

/// The least-squares problem of an image fit: the readings, the fitted parameters, and the weights of the readings. The
/// weights change only in [`Problem::weigh`] and [`Problem::weigh_at_rest`].
#[derive(Clone)]
pub(super) struct Problem<'a> {
    pub(super) fit: &'a ImageFit,
    pub(super) rest: Cow<'a, Rest>,
    pub(super) sensor: Sensor,
    pub(super) seen: &'a [Option<Seen>],
    pub(super) indentation: Option<Measured>,
    pub(super) fitted: Fitted,
    /// Indices of the used markers, which are visible at rest and in the press and are not outliers.
    pub(super) counting: Vec<usize>,
    /// For each used marker, the square root of its weight in the robust fit.
    pub(super) trust: Vec<f64>,
    /// Corrections of the disc displacements for the difference between the fitted and the nominal depths of the discs.
    /// The corrections are computed together with the weights of the readings.
    by_depth: Vec<[MarkerDisplacement; 2]>,
    /// Whitening matrix of each used marker. It transforms the errors of the reading to independent errors of unit
    /// variance.
    pub(super) whiten: Vec<Matrix4<f64>>,
    /// Derivatives of the whitened images of the used markers with respect to the misalignments of these markers.
    pub(super) by_local: Vec<Matrix4x2<f64>>,
    /// For each marker, the whitened image for the sensor parameters that were fitted at rest, minus the whitened image
    /// for the parameters in `sensor`, to first order.
    from_rest: Vec<Vector4<f64>>,
    /// Derivatives of the whitened images with respect to the uncertain sensor parameters that are common to all
    /// markers. There is one row per equation and one column per parameter.
    pub(super) common: DMatrix<f64>,
    /// Lower Cholesky factor of the information matrix (inverse covariance) of the uncertain sensor parameters. The
    /// matrix is the sum of the information from the frame at rest and from the pressed frame.
    pub(super) root: DMatrix<f64>,
}

/// Fit parameters that the search tries, with their residuals and the disc displacements from which derivatives can be
/// computed.
pub(super) struct Tried {
    pub(super) state: State,
    pub(super) residuals: Residuals,
    pub(super) cost: f64,
    moving: Moving,
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        fit: &'a ImageFit,
        rest: &'a Rest,
        seen: &'a [Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<Self, PressError> {
        let counting: Vec<usize> = (0..seen.len())
            .filter(|&marker| seen[marker].is_some() && rest.seen[marker])
            .collect();
        let shift = Measured {
            value: 0.0,
            std: fit.shift_std,
        };
        let mut fitted = Fitted::new(indentation, [Some(shift); 2]);
        fitted.sought[SHIFT..].fill(fit.shifts());
        Ok(Self {
            fit,
            sensor: rest.sensor(),
            rest: Cow::Borrowed(rest),
            seen,
            indentation,
            fitted,
            trust: vec![1.0; counting.len()],
            by_depth: Vec::new(),
            whiten: Vec::new(),
            by_local: Vec::new(),
            from_rest: Vec::new(),
            common: DMatrix::zeros(0, 0),
            root: DMatrix::zeros(0, 0),
            counting,
        })
    }

    pub(super) fn leave_out(&mut self, wrong: &[usize]) {
        self.counting.retain(|marker| !wrong.contains(marker));
        self.trust = vec![1.0; self.counting.len()];
    }

    pub(super) fn pictures(
        &self,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Result<Vec<Option<[f64; NUMBERS]>>, PressError> {
        self.fit
            .pictures(&self.sensor.state(), moved)
            .ok_or(PressError::OutOfRange)
    }

    /// Computes the weights of all readings for the fit parameters `state`. A weight includes the noise of the reading,
    /// the uncertainty of the marker's misalignment, and the uncertainty of the sensor's parameters.
    pub(super) fn weigh(&mut self, state: &State) -> Result<FitState, PressError> {
        let moving = self.fit.moving(state)?;
        let per_depth = self.fit.per_depth(state, &moving.moved)?;
        self.by_depth = per_depth.clone().unwrap_or_default();
        for moved in &mut self.by_depth {
            for (disc, deeper) in moved.iter_mut().zip(&self.sensor.common) {
                disc.normal *= deeper;
                disc.tangential = disc.tangential.map(|along| along * deeper);
            }
        }
        let moved = self.deeper(moving.moved);
        let slopes = self
            .fit
            .slopes(&self.sensor.state(), &moved, per_depth.as_deref())
            .ok_or(PressError::OutOfRange)?;
        self.weigh_by(&slopes)?;
        let residuals = self.whitened(|marker| slopes.pictures[marker])?;
        self.fitted(*state, residuals, &slopes, &moving.slopes)
    }

    pub(super) fn weigh_at_rest(&mut self) -> Result<(), PressError> {
        let slopes = Arc::clone(&self.rest.slopes);
        self.weigh_by(&slopes)
    }

    fn weigh_by(&mut self, slopes: &PictureSlopes) -> Result<(), PressError> {
        let Rest {
            local, information, ..
        } = &*self.rest;
        let to_rest = self.to_rest();
        let aside_by_common = &slopes.common * &to_rest;
        self.whiten.clear();
        self.by_local.clear();
        self.from_rest.clear();
        self.common = DMatrix::zeros(self.equations(), information.nrows());
        for (at, &marker) in self.counting.iter().enumerate() {
            let parts = (&self.seen[marker], &local[marker], &slopes.pictures[marker]);
            let (Some(seen), Some(local), Some(_)) = parts else {
                return Err(PressError::OutOfRange);
            };
            let by_local = &slopes.misalignments[marker];
            let covariance = seen.errors() + by_local * local.spread * by_local.transpose();
            let factor = covariance
                .cholesky()
                .ok_or(PressError::NotFinite { marker })?;
            let whiten = factor
                .l()
                .try_inverse()
                .ok_or(PressError::NotFinite { marker })?
                * self.trust[at];
            let first = NUMBERS * marker;
            let aside =
                aside_by_common.fixed_rows::<NUMBERS>(first) + by_local * self.to_rest_of(marker);
            self.from_rest.push(whiten * aside);
            for column in 0..self.common.ncols() {
                let by_common = slopes.common.fixed_view::<NUMBERS, 1>(first, column)
                    + by_local * local.follows.fixed_view::<2, 1>(0, column);
                self.common
                    .fixed_view_mut::<NUMBERS, 1>(NUMBERS * at, column)
                    .copy_from(&(whiten * by_common));
            }
            self.by_local.push(whiten * by_local);
            self.whiten.push(whiten);
        }
        let both = information + products(&self.common, &self.common);
        self.root = both.cholesky().ok_or(PressError::OutOfRange)?.unpack();
        Ok(())
    }

    /// Corrects the displacements `moved` of the discs from the nominal depths to the depths that were fitted at rest.
    fn deeper(&self, mut moved: Vec<[MarkerDisplacement; 2]>) -> Vec<[MarkerDisplacement; 2]> {
        for (moved, more) in moved
            .iter_mut()
            .flatten()
            .zip(self.by_depth.iter().flatten())
        {
            moved.normal += more.normal;
            for axis in 0..2 {
                moved.tangential[axis] += more.tangential[axis];
            }
        }
        moved
    }

    /// Displacements of the discs for the fit parameters `state`, at the depths that were fitted at rest.
    pub(super) fn displaced(
        &self,
        state: &State,
    ) -> Result<Vec<[MarkerDisplacement; 2]>, PressError> {
        Ok(self.deeper(self.fit.moved(state)?))
    }

    pub(super) fn tried(&self, state: State) -> Result<Tried, PressError> {
        let mut moving = self.fit.moving(&state)?;
        moving.moved = self.deeper(moving.moved);
        let pictures = self.pictures(&moving.moved)?;
        let residuals = self.whitened(|marker| pictures[marker])?;
        Ok(Tried {
            cost: self.cost(&state, &residuals)?,
            state,
            residuals,
            moving,
        })
    }

    pub(super) fn reached(&self, tried: Tried) -> Result<FitState, PressError> {
        let Moving { moved, slopes } = &tried.moving;
        let pictures = self.by_displacements(moved)?;
        self.fitted(tried.state, tried.residuals, &pictures, slopes)
    }

    pub(super) fn by_displacements(
        &self,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Result<PictureSlopes, PressError> {
        let slopes = self.fit.slopes_by(&[], &self.sensor.state(), moved);
        slopes.ok_or(PressError::OutOfRange)
    }

    /// Computes the derivatives of the images with respect to the fit parameters by the chain rule. `pictures` contains
    /// the derivatives of images with respect to displacements, and `moving` the derivatives of displacements with
    /// respect to the fit parameters.
    fn fitted(
        &self,
        state: State,
        residuals: Residuals,
        pictures: &PictureSlopes,
        moving: &[[DiscSlopes; 2]],
    ) -> Result<FitState, PressError> {
        let mut jacobian = Jacobian::zeros(residuals.len());
        let mut normal_slopes = Vec::with_capacity(self.counting.len());
        for ((at, &marker), whiten) in self.counting.iter().enumerate().zip(&self.whiten) {
            let [magenta, yellow] = &pictures.displacements[marker];
            let [by_magenta, by_yellow] = &moving[marker];
            let slopes = whiten * (magenta * by_magenta + yellow * by_yellow);
            jacobian
                .fixed_rows_mut::<NUMBERS>(NUMBERS * at)
                .copy_from(&slopes);
            let normal = whiten * (magenta.column(0) + yellow.column(0));
            normal_slopes.push(normal.norm());
        }
        for unknown in (0..UNKNOWNS).filter(|&unknown| !self.fitted.sought[unknown]) {
            jacobian.column_mut(unknown).fill(0.0);
        }
        let slopes = self.slopes(jacobian)?;
        Ok(FitState {
            sums: self.sums(&state, &residuals, &slopes)?,
            state,
            residuals,
            slopes,
            normal_slopes,
            keeps_slopes: false,
        })
    }

    pub(super) fn residuals(&self, state: &State) -> Result<Residuals, PressError> {
        let moved = self.displaced(state)?;
        let pictures = self.pictures(&moved)?;
        self.whitened(|marker| pictures[marker])
    }

    pub(super) fn residuals_at_rest(&self) -> Result<Residuals, PressError> {
        self.whitened(|marker| self.rest.slopes.pictures[marker])
    }

    fn whitened(
        &self,
        picture: impl Fn(usize) -> Option<[f64; NUMBERS]>,
    ) -> Result<Residuals, PressError> {
        let mut residuals = Residuals::zeros(self.equations());
        let weighted = self.whiten.iter().zip(&self.from_rest);
        for ((at, &marker), (whiten, aside)) in self.counting.iter().enumerate().zip(weighted) {
            let (Some(seen), Some(picture)) = (&self.seen[marker], picture(marker)) else {
                return Err(PressError::OutOfRange);
            };
            let residual = whiten * Vector4::from(difference(&seen.picture, &picture)) - aside;
            residuals
                .rows_mut(NUMBERS * at, NUMBERS)
                .copy_from(&residual);
        }
        Ok(residuals)
    }

    /// The residuals without the part that the best change of the sensor's parameters explains.
    pub(super) fn own(&self, residuals: &Residuals) -> Result<Residuals, PressError> {
        Ok(residuals - &self.common * self.departures(residuals)?)
    }

    /// The part of `columns` that a change of the sensor's parameters could also cause, as coordinates. `columns`
    /// contains whitened derivatives or residuals. The result has one row per sensor parameter.
    pub(super) fn shared<C: Dim, S: Storage<f64, Dyn, C>>(
        &self,
        columns: &Matrix<f64, Dyn, C, S>,
    ) -> Result<OMatrix<f64, Dyn, C>, PressError>
    where
        DefaultAllocator: Allocator<Dyn, C>,
    {
        let mut shared = self.common.tr_mul(columns);
        let is_solved = self.root.solve_lower_triangular_mut(&mut shared);
        is_solved.then_some(shared).ok_or(PressError::OutOfRange)
    }

    pub(super) fn own_squares(&self, residuals: &Residuals) -> Result<f64, PressError> {
        Ok(residuals.norm_squared() - self.shared(residuals)?.norm_squared())
    }

    pub(super) fn cost(&self, state: &State, residuals: &Residuals) -> Result<f64, PressError> {
        let cost = self.own_squares(residuals)? + self.fitted.prior_sums(state).chi_squared;
        if cost.is_finite() {
            Ok(cost)
        } else {
            Err(PressError::OutOfRange)
        }
    }

    pub(super) fn sums(
        &self,
        state: &State,
        residuals: &Residuals,
        slopes: &Slopes,
    ) -> Result<Sums, PressError> {
        let common = self.shared(residuals)?;
        let priors = self.fitted.prior_sums(state);
        let chi_squared = residuals.norm_squared() - common.norm_squared() + priors.chi_squared;
        if !chi_squared.is_finite() {
            return Err(PressError::OutOfRange);
        }
        let slope = slopes.jacobian.tr_mul(residuals) - slopes.shared.tr_mul(&common);
        let mut sums = Sums {
            chi_squared,
            gradient: priors.gradient - slope,
            hessian: priors.hessian + slopes.square,
        };
        for unknown in (0..UNKNOWNS).filter(|&unknown| !self.fitted.sought[unknown]) {
            sums = sums.holding(unknown);
        }
        Ok(sums)
    }

    /// The derivatives `jacobian` and the scalar products of their columns. The products do not contain the part of the
    /// derivatives that a change of the sensor's parameters could also cause.
    fn slopes(&self, jacobian: Jacobian) -> Result<Slopes, PressError> {
        let shared = self.shared(&jacobian)?;
        Ok(Slopes {
            square: jacobian.tr_mul(&jacobian) - shared.tr_mul(&shared),
            jacobian,
            shared,
        })
    }
}
