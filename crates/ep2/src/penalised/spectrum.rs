//! The penalised normal equations, transformed to modes in which both matrices (of the equations and of the penalty)
//! are diagonal.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::equations::Equations;
use crate::Ep2Error;
use crate::matrix::add_symmetric;
use crate::noise::Kinds;
use crate::square_quadric::UNKNOWNS;

/// A multiple of the penalty matrix is added to the matrix of the normal equations, so that all coefficients are
/// determined. This constant is the trace of the added matrix, divided by the trace of the matrix of the normal
/// equations.
const PENALTY_SHARE: f64 = 1e-7;

/// Modes U with UᵀAU = diag(fidelity) and UᵀPU = diag(roughness), where A is the matrix of the weighted normal
/// equations and P the penalty matrix. With the smoothing weight λ, the coefficients are U diag(1/(fidelity + λ
/// roughness)) Uᵀ (right side). Therefore all results that depend on λ are simple sums over the modes.
#[derive(Clone)]
pub(super) struct Spectrum {
    modes: DMatrix<f64>,
    /// Fidelity of each mode: its diagonal entry in UᵀAU, where A is the matrix of the normal equations. It is between
    /// 0 and 1. The modes of quadrics come first and have the fidelity 1.
    pub(super) fidelity: Vec<f64>,
    /// Roughness of each mode, in ascending order: the mode's diagonal entry in UᵀPU, where P is the matrix of the
    /// penalty. The roughness is 0 for the modes of quadrics.
    pub(super) roughness: Vec<f64>,
    /// Right side of the normal equations, transformed to the modes: one value per mode.
    pub(super) right: Vec<f64>,
    pub(super) square: f64,
    pub(super) equations: f64,
}

impl Spectrum {
    pub(super) fn of(
        equations: &Equations,
        penalty: &DMatrix<f64>,
        variances: &Kinds<f64>,
    ) -> Result<Self, Ep2Error> {
        let mut sum = &equations.grams.heights * (1.0 / variances.heights);
        if equations.has_slopes() {
            sum += &equations.grams.slopes * (1.0 / variances.slopes);
        }
        let shift = PENALTY_SHARE * sum.trace() / penalty.trace();
        sum += penalty * shift;
        // Let C Cᵀ be the Cholesky factors of `sum`, and P the penalty. The modes are C⁻ᵀ times the eigenvectors of C⁻¹
        // P C⁻ᵀ.
        let factor = sum.cholesky().ok_or(Ep2Error::OutOfRange)?.unpack();
        let half = solved_lower(&factor, penalty)?;
        let whole = solved_lower(&factor, &half.transpose())?;
        let eigen = SymmetricEigen::new(whole);
        let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let mut modes = eigen.eigenvectors.select_columns(&order);
        if !factor.tr_solve_lower_triangular_mut(&mut modes) {
            return Err(Ep2Error::OutOfRange);
        }
        let roughness: Vec<f64> = order
            .iter()
            .enumerate()
            .map(|(place, &index)| {
                if place < UNKNOWNS {
                    0.0
                } else {
                    eigen.eigenvalues[index].max(0.0)
                }
            })
            .collect();
        let fidelity = roughness
            .iter()
            .map(|roughness| (1.0 - shift * roughness).max(0.0))
            .collect();
        let spectrum = Self {
            fidelity,
            roughness,
            right: Vec::new(),
            modes,
            square: 0.0,
            equations: (equations.count.heights + equations.count.slopes) as f64,
        };
        Ok(spectrum.with_right_side(equations, variances))
    }

    /// Returns the same modes with the right side of `equations`. The matrix of `equations` must be the one from which
    /// the modes were computed.
    pub(super) fn with_right_side(self, equations: &Equations, variances: &Kinds<f64>) -> Self {
        let (per_height, per_slope) = (1.0 / variances.heights, 1.0 / variances.slopes);
        let mut right = &equations.right_sides.heights * per_height;
        let mut square = equations.squares.heights * per_height;
        if equations.has_slopes() {
            right += &equations.right_sides.slopes * per_slope;
            square += equations.squares.slopes * per_slope;
        }
        Self {
            right: self.modes.tr_mul(&right).iter().copied().collect(),
            square,
            ..self
        }
    }

    /// The filter factor 1/(fidelity + λ roughness) of each mode. `log_weight` is ln λ.
    pub(super) fn filters(&self, log_weight: f64) -> Vec<f64> {
        let weight = libm::exp(log_weight);
        let pairs = self.fidelity.iter().zip(&self.roughness);
        let filters = pairs.map(|(fidelity, roughness)| 1.0 / (fidelity + weight * roughness));
        filters.collect()
    }

    pub(super) fn coefficients(&self, filters: &[f64]) -> DVector<f64> {
        let in_modes = filters.iter().zip(&self.right).map(|(f, right)| f * right);
        &self.modes * DVector::from_iterator(self.right.len(), in_modes)
    }

    /// Inverse of A + λP, where A is the matrix of the normal equations and P the penalty matrix. `filters` is the
    /// result of [`Spectrum::filters`].
    pub(super) fn inverse(&self, filters: &[f64]) -> DMatrix<f64> {
        let size = self.modes.nrows();
        let mut scaled = self.modes.clone();
        for (mut column, filter) in scaled.column_iter_mut().zip(filters) {
            column *= *filter;
        }
        let mut inverse = DMatrix::zeros(size, size);
        add_symmetric(&mut inverse, &scaled, &self.modes);
        inverse
    }
}

fn solved_lower(factor: &DMatrix<f64>, right: &DMatrix<f64>) -> Result<DMatrix<f64>, Ep2Error> {
    factor
        .solve_lower_triangular(right)
        .ok_or(Ep2Error::OutOfRange)
}
