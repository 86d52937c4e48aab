//! The sum of squares that a fit of pictures makes least.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::allocator::Allocator;
use nalgebra::{
    DMatrix, DefaultAllocator, Dim, Dyn, Matrix, Matrix4, Matrix4x2, OMatrix, Storage, Vector4,
};

use super::fitted::Fitted;
use super::law::{DiscSlopes, Moving, State};
use super::rest::{Rest, products};
use super::settings::ImageFit;
use super::unknowns::{
    INDENTATION, Jacobian, Residuals, SHIFT, Slopes, Square, Sums, UNKNOWNS, Unknowns,
};
use super::view::{NUMBERS, PictureSlopes, Seen, Sensor, View, difference};
use crate::{MarkerDisplacement, Measured, PressError};

/// The least-squares problem: the pictures, their weights at some state, and the unknowns that are sought.
#[derive(Clone)]
pub(super) struct Problem<'a, V> {
    pub(super) fit: &'a ImageFit<V>,
    pub(super) rest: Cow<'a, Rest>,
    /// The sensor about which its departures are taken to first order.
    pub(super) sensor: Sensor,
    pub(super) seen: &'a [Option<Seen>],
    pub(super) indentation: Option<Measured>,
    /// Whether each unknown is sought.
    pub(super) sought: [bool; UNKNOWNS],
    /// Markers that count: seen at rest and pressed, and not wrong.
    pub(super) counting: Vec<usize>,
    /// Root of the weight that each of them has among the others.
    pub(super) trust: Vec<f64>,
    /// Displacements that come of the depths at which the discs lie, by the frame at rest, beyond those that they are
    /// meant to lie at; as they are where weights were given.
    by_depth: Vec<[MarkerDisplacement; 2]>,
    /// Whitening of each of them.
    pub(super) whiten: Vec<Matrix4<f64>>,
    /// Slopes of their pictures by their misalignments, whitened.
    pub(super) by_local: Vec<Matrix4x2<f64>>,
    /// Difference of the pictures of the sensor at rest, as far as slopes tell, from those of `sensor`, whitened.
    from_rest: Vec<Vector4<f64>>,
    /// Effect of common departures, whitened: as many rows as equations, and a column for each departure.
    pub(super) common: DMatrix<f64>,
    /// Root of the information on the departures in both frames, a lower triangle.
    pub(super) root: DMatrix<f64>,
}

/// A state that is tried, with what is needed to go on from it.
pub(super) struct Tried {
    pub(super) state: State,
    pub(super) residuals: Residuals,
    pub(super) cost: f64,
    moving: Moving,
}

impl<'a, V: View> Problem<'a, V> {
    pub(super) fn new(
        fit: &'a ImageFit<V>,
        rest: &'a Rest,
        seen: &'a [Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<Self, PressError> {
        let counting: Vec<usize> = (0..seen.len())
            .filter(|&marker| seen[marker].is_some() && rest.seen[marker])
            .collect();
        let mut sought = [true; UNKNOWNS];
        sought[INDENTATION] = indentation.is_none_or(|known| known.std > 1e-10 * known.value);
        sought[SHIFT..].fill(fit.shifts());
        Ok(Self {
            fit,
            sensor: rest.sensor(),
            rest: Cow::Borrowed(rest),
            seen,
            indentation,
            sought,
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

    pub(super) fn unknowns(&self) -> usize {
        self.sought.iter().filter(|sought| **sought).count()
    }

    pub(super) fn equations(&self) -> usize {
        NUMBERS * self.counting.len()
    }

    /// Numbers that are known beforehand of unknowns that are sought.
    pub(super) fn known(&self) -> usize {
        let [along, across] = [SHIFT, SHIFT + 1].map(|shift| self.sought[shift]);
        let indentation = self.indentation.is_some() && self.sought[INDENTATION];
        [along, across, indentation]
            .into_iter()
            .map(usize::from)
            .sum()
    }

    /// Takes markers out of those that count.
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

    /// Gives every reading the weight that it has at a state: by its own noise, by what is left unknown of its
    /// marker's misalignment, and by what is left unknown of the sensor, which is common to all.
    pub(super) fn weigh(&mut self, state: &State) -> Result<Fitted, PressError> {
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

    /// Weighs the equations by the errors of markers that are at rest.
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

    /// Displacements of discs that lie as deep as the frame at rest has them.
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

    /// Displacements of discs at a state, where they lie as deep as the frame at rest has them.
    pub(super) fn displaced(
        &self,
        state: &State,
    ) -> Result<Vec<[MarkerDisplacement; 2]>, PressError> {
        Ok(self.deeper(self.fit.moved(state)?))
    }

    /// A state with its residuals and their sum of squares.
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

    /// A state that was tried, with slopes there.
    pub(super) fn reached(&self, tried: Tried) -> Result<Fitted, PressError> {
        let Tried {
            state,
            residuals,
            moving: Moving { moved, slopes },
            ..
        } = tried;
        let pictures = self.by_displacements(&moved)?;
        self.fitted(state, residuals, &pictures, &slopes)
    }

    /// Pictures with their slopes by displacements alone.
    pub(super) fn by_displacements(
        &self,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Result<PictureSlopes, PressError> {
        let slopes = self.fit.slopes_by(&[], &self.sensor.state(), moved);
        slopes.ok_or(PressError::OutOfRange)
    }

    /// A state with slopes by the unknowns, from those of pictures by displacements and of displacements by the unknowns.
    fn fitted(
        &self,
        state: State,
        residuals: Residuals,
        pictures: &PictureSlopes,
        moving: &[[DiscSlopes; 2]],
    ) -> Result<Fitted, PressError> {
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
        for unknown in (0..UNKNOWNS).filter(|&unknown| !self.sought[unknown]) {
            jacobian.column_mut(unknown).fill(0.0);
        }
        let slopes = self.slopes(jacobian)?;
        Ok(Fitted {
            sums: self.sums(&state, &residuals, &slopes)?,
            state,
            residuals,
            slopes,
            normal_slopes,
        })
    }

    /// Whitened residuals at a state.
    pub(super) fn residuals(&self, state: &State) -> Result<Residuals, PressError> {
        let moved = self.displaced(state)?;
        let pictures = self.pictures(&moved)?;
        self.whitened(|marker| pictures[marker])
    }

    /// Whitened residuals where nothing moves.
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

    /// Residuals without what departures of the sensor account for.
    pub(super) fn own(&self, residuals: &Residuals) -> Result<Residuals, PressError> {
        Ok(residuals - &self.common * self.departures(residuals)?)
    }

    /// Components of whitened columns, one for each departure, that what is common to all markers may account for.
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

    /// Sum of squared residuals without the part that what is common to all markers may account for.
    pub(super) fn own_squares(&self, residuals: &Residuals) -> Result<f64, PressError> {
        Ok(residuals.norm_squared() - self.shared(residuals)?.norm_squared())
    }

    pub(super) fn cost(&self, state: &State, residuals: &Residuals) -> Result<f64, PressError> {
        let cost = self.own_squares(residuals)? + self.priors(state).0;
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
        let (off, gradient, hessian) = self.priors(state);
        let chi_squared = residuals.norm_squared() - common.norm_squared() + off;
        if !chi_squared.is_finite() {
            return Err(PressError::OutOfRange);
        }
        let slope = slopes.jacobian.tr_mul(residuals) - slopes.shared.tr_mul(&common);
        let mut sums = Sums {
            chi_squared,
            gradient: gradient - slope,
            hessian: hessian + slopes.square,
        };
        for unknown in (0..UNKNOWNS).filter(|&unknown| !self.sought[unknown]) {
            sums.hold(unknown);
        }
        Ok(sums)
    }

    /// Slopes with what is common to all markers taken out of their products.
    fn slopes(&self, jacobian: Jacobian) -> Result<Slopes, PressError> {
        let shared = self.shared(&jacobian)?;
        Ok(Slopes {
            square: jacobian.tr_mul(&jacobian) - shared.tr_mul(&shared),
            jacobian,
            shared,
        })
    }

    /// Sum of squares of the deviations from prior knowledge, with half its gradient and half its Hessian.
    fn priors(&self, state: &State) -> (f64, Unknowns, Square) {
        let (mut squared, mut gradient, mut hessian) = (0.0, Unknowns::zeros(), Square::zeros());
        let mut add = |index: usize, off: f64, std: f64| {
            squared += (off / std) * (off / std);
            gradient[index] += off / (std * std);
            hessian[(index, index)] += 1.0 / (std * std);
        };
        if let Some(Measured { value, std }) = self.indentation
            && self.sought[INDENTATION]
        {
            add(INDENTATION, state.indentation - value, std);
        }
        for axis in 0..2 {
            if self.sought[SHIFT + axis] {
                add(SHIFT + axis, state.shift[axis], self.fit.shift_std);
            }
        }
        (squared, gradient, hessian)
    }

    /// The state after a step.
    pub(super) fn stepped(&self, state: &State, step: &Unknowns) -> State {
        state.stepped(self.fit.markers.skin(), step)
    }
}
