//! Unknowns of a press behind pictures, and sums over the pictures by them.

use nalgebra::{DVector, MatrixXx6, SMatrix, SVector};

/// Unknowns, in this order: the logarithm of the relative curvature; steps of the contact's place along the axes there;
/// indentation; both components of the shift.
pub(super) const UNKNOWNS: usize = 6;
pub(super) const CURVATURE: usize = 0;
pub(super) const ALONG: usize = 1;
pub(super) const ACROSS: usize = 2;
pub(super) const INDENTATION: usize = 3;
pub(super) const SHIFT: usize = 4;

pub(super) type Unknowns = SVector<f64, UNKNOWNS>;
pub(super) type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Residuals, whitened, of the markers that count.
pub(super) type Residuals = DVector<f64>;
/// Slopes of the whitened pictures by the unknowns.
pub(super) type Jacobian = MatrixXx6<f64>;

/// Slopes with what sums over the pictures need of them.
#[derive(Clone, Debug)]
pub(super) struct Slopes {
    pub(super) jacobian: Jacobian,
    /// Components that what is common to all markers may account for.
    pub(super) shared: Jacobian,
    /// Products of the slopes by two unknowns, without these.
    pub(super) square: Square,
}

/// Chi-squared and half its gradient and Hessian.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    pub(super) chi_squared: f64,
    pub(super) gradient: Unknowns,
    pub(super) hessian: Square,
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
