//! The sum of squares that a fit of pictures makes least.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector, Matrix4, Matrix4x2, SMatrix, SVector, Vector4};

use super::law::State;
use super::rest::Rest;
use super::settings::ImageFit;
use super::view::{NUMBERS, Seen, Sensor, View, difference};
use crate::{MarkerDisplacement, Measured, PressError};

/// Unknowns, in this order: the logarithm of the relative curvature; steps of the contact's place along the axes there;
/// indentation; both components of the shift.
pub(super) const UNKNOWNS: usize = 6;
pub(super) const CURVATURE: usize = 0;
pub(super) const ALONG: usize = 1;
pub(super) const ACROSS: usize = 2;
pub(super) const INDENTATION: usize = 3;
const SHIFT: usize = 4;

pub(super) type Unknowns = SVector<f64, UNKNOWNS>;
pub(super) type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Steps by which slopes are found, as shares of the unknowns' scales.
const STEP: f64 = 1e-5;

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
    /// How the pictures of the sensor at rest, as far as slopes tell, differ from those of `sensor`, whitened.
    from_rest: Vec<Vector4<f64>>,
    /// Effect of common departures, whitened: as many rows as equations, and a column for each departure.
    pub(super) common: DMatrix<f64>,
    /// Inverse root of the information on the departures in both frames, times `common` transposed.
    pub(super) shared: DMatrix<f64>,
}

/// Residuals, whitened, of the markers that count.
pub(super) type Residuals = DVector<f64>;
/// Slopes of the whitened pictures by the unknowns.
pub(super) type Jacobian = DMatrix<f64>;

/// Chi-squared and half its gradient and Hessian.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    pub(super) chi_squared: f64,
    pub(super) gradient: Unknowns,
    pub(super) hessian: Square,
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
        let shifts = fit.shift_std > 0.0 && fit.bodies[0].sideways().is_some();
        sought[SHIFT] = shifts;
        sought[SHIFT + 1] = shifts;
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
            shared: DMatrix::zeros(0, 0),
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
            .view
            .pictures(&self.sensor.state(), moved)
            .ok_or(PressError::OutOfRange)
    }

    /// Gives every reading the weight that it has at a state: by its own noise, by what is left unknown of its
    /// marker's misalignment, and by what is left unknown of the sensor, which is common to all.
    pub(super) fn weigh(&mut self, state: &State) -> Result<(), PressError> {
        let moved = self.fit.moved(state)?;
        let per_depth = self.fit.per_depth(state, &moved)?;
        self.by_depth = per_depth.clone().unwrap_or_default();
        for moved in &mut self.by_depth {
            for (disc, deeper) in moved.iter_mut().zip(&self.sensor.common) {
                disc.normal *= deeper;
                disc.tangential = disc.tangential.map(|along| along * deeper);
            }
        }
        let moved = self.deeper(moved);
        self.weigh_at(&moved, per_depth.as_deref())
    }

    /// Weighs the equations by the errors of markers that are at rest.
    pub(super) fn weigh_at_rest(&mut self) -> Result<(), PressError> {
        self.weigh_at(&self.still(), None)
    }

    fn still(&self) -> Vec<[MarkerDisplacement; 2]> {
        vec![[MarkerDisplacement::default(); 2]; self.seen.len()]
    }

    /// Pictures at rest, by the law.
    pub(super) fn pictures_at_rest(&self) -> Result<Vec<Option<[f64; NUMBERS]>>, PressError> {
        self.pictures(&self.still())
    }

    fn weigh_at(
        &mut self,
        moved: &[[MarkerDisplacement; 2]],
        per_depth: Option<&[[MarkerDisplacement; 2]]>,
    ) -> Result<(), PressError> {
        let pictures = self.pictures(moved)?;
        let Rest {
            local, information, ..
        } = &*self.rest;
        let Sensor {
            common,
            misalignments,
        } = &self.sensor;
        let slopes = self
            .fit
            .slopes(common, misalignments, moved, per_depth, &pictures)
            .ok_or(PressError::OutOfRange)?;
        let to_rest = self.to_rest();
        let departures = information.nrows();
        self.whiten.clear();
        self.by_local.clear();
        self.from_rest.clear();
        self.common = DMatrix::zeros(self.equations(), departures);
        for (at, &marker) in self.counting.iter().enumerate() {
            let parts = (
                &self.seen[marker],
                &local[marker],
                &slopes.common[marker],
                &slopes.local[marker],
            );
            let (Some(seen), Some(local), Some(by_common), Some(by_local)) = parts else {
                return Err(PressError::OutOfRange);
            };
            let covariance = seen.covariance + by_local * local.spread * by_local.transpose();
            let factor = covariance
                .cholesky()
                .ok_or(PressError::NotFinite { marker })?;
            let whiten = factor
                .l()
                .try_inverse()
                .ok_or(PressError::NotFinite { marker })?
                * self.trust[at];
            let aside = by_common * &to_rest + by_local * self.to_rest_of(marker);
            let slopes = whiten * (by_common + by_local * &local.follows);
            self.by_local.push(whiten * by_local);
            self.from_rest.push(whiten * aside);
            self.common
                .rows_mut(NUMBERS * at, NUMBERS)
                .copy_from(&slopes);
            self.whiten.push(whiten);
        }
        let both = information + self.common.transpose() * &self.common;
        let factor = both.cholesky().ok_or(PressError::OutOfRange)?;
        self.shared = factor
            .l()
            .solve_lower_triangular(&self.common.transpose())
            .ok_or(PressError::OutOfRange)?;
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

    /// Whitened residuals at a state.
    pub(super) fn residuals(&self, state: &State) -> Result<Residuals, PressError> {
        let moved = self.displaced(state)?;
        let pictures = self.pictures(&moved)?;
        self.whitened(|marker| pictures[marker])
    }

    /// Whitened residuals where nothing moves.
    pub(super) fn residuals_at_rest(&self) -> Result<Residuals, PressError> {
        let pictures = self.pictures_at_rest()?;
        self.whitened(|marker| pictures[marker])
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

    /// Slopes by the unknowns at a state, with its residuals.
    pub(super) fn jacobian(
        &self,
        state: &State,
        residuals: &Residuals,
    ) -> Result<Jacobian, PressError> {
        let mut jacobian = Jacobian::zeros(residuals.len(), UNKNOWNS);
        for unknown in (0..UNKNOWNS).filter(|&unknown| self.sought[unknown]) {
            jacobian.set_column(unknown, &self.slopes_by(unknown, state, residuals)?);
        }
        Ok(jacobian)
    }

    /// Slopes of the whitened pictures by one unknown, sought or not.
    pub(super) fn slopes_by(
        &self,
        unknown: usize,
        state: &State,
        residuals: &Residuals,
    ) -> Result<Residuals, PressError> {
        let scale = match unknown {
            CURVATURE => 1.0,
            ALONG | ACROSS => self.fit.markers.skin().radius(),
            INDENTATION => state.indentation,
            _ => self.fit.shift_std,
        };
        let mut step = Unknowns::zeros();
        step[unknown] = STEP * scale;
        let there = self.residuals(&self.stepped(state, &step))?;
        Ok((residuals - there) / (STEP * scale))
    }

    /// Residuals without what departures of the sensor account for.
    pub(super) fn own(&self, residuals: &Residuals) -> Result<Residuals, PressError> {
        Ok(residuals - &self.common * self.departures(residuals)?)
    }

    /// Part of a sum of squared residuals that what is common to all markers may account for.
    pub(super) fn shared_part(&self, residuals: &Residuals) -> f64 {
        (&self.shared * residuals).norm_squared()
    }

    /// Standard deviation of the normal displacement of a marker, of both discs alike, that its own picture tells: the
    /// median of those that count.
    pub(super) fn normal_std(&self, state: &State) -> Result<f64, PressError> {
        let step = 1e-6 * self.fit.markers.skin().radius();
        let mut moved = self.displaced(state)?;
        let at = self.pictures(&moved)?;
        for disc in moved.iter_mut().flatten() {
            disc.normal += step;
        }
        let there = self.pictures(&moved)?;
        let mut stds: Vec<f64> = Vec::new();
        for (&marker, whiten) in self.counting.iter().zip(&self.whiten) {
            if let (Some(at), Some(there)) = (&at[marker], &there[marker]) {
                let slope = whiten * Vector4::from(difference(there, at)) / step;
                stds.push(slope.norm().recip());
            }
        }
        stds.sort_by(f64::total_cmp);
        Ok(stds.get(stds.len() / 2).copied().unwrap_or(f64::INFINITY))
    }

    pub(super) fn cost(&self, state: &State, residuals: &Residuals) -> Result<f64, PressError> {
        let cost = residuals.norm_squared() - self.shared_part(residuals) + self.priors(state).0;
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
        jacobian: &Jacobian,
    ) -> Result<Sums, PressError> {
        let chi_squared = self.cost(state, residuals)?;
        let shared = &self.shared * jacobian;
        let common = &self.shared * residuals;
        let (_, gradient, hessian) = self.priors(state);
        let square = jacobian.transpose() * jacobian - shared.transpose() * &shared;
        let slope = jacobian.transpose() * residuals - shared.transpose() * common;
        let mut sums = Sums {
            chi_squared,
            gradient: gradient - Unknowns::from_fn(|row, _| slope[row]),
            hessian: hessian + Square::from_fn(|row, column| square[(row, column)]),
        };
        for unknown in (0..UNKNOWNS).filter(|&unknown| !self.sought[unknown]) {
            sums.hold(unknown);
        }
        Ok(sums)
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
        let skin = self.fit.markers.skin();
        let place = if step[ALONG] == 0.0 && step[ACROSS] == 0.0 {
            state.place
        } else {
            skin.place_at(&skin.beyond(&state.place, step[ALONG], step[ACROSS]))
        };
        State {
            log_curvature: state.log_curvature + step[CURVATURE],
            place,
            indentation: state.indentation + step[INDENTATION],
            shift: [0, 1].map(|axis| state.shift[axis] + step[SHIFT + axis]),
        }
    }
}

impl Sums {
    /// Holds an unknown where it is.
    pub(super) fn hold(&mut self, held: usize) {
        self.gradient[held] = 0.0;
        self.hessian.row_mut(held).fill(0.0);
        self.hessian.column_mut(held).fill(0.0);
        self.hessian[(held, held)] = 1.0;
    }
}
