//! The penalised normal equations in the modes that diagonalise both of their matrices.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::equations::Equations;
use crate::Ep2Error;
use crate::matrix::add_symmetric;
use crate::noise::Kinds;
use crate::square_quadric::UNKNOWNS;

/// Share of the penalty that is added to the normal equations, relative to their traces, so that they determine all
/// coefficients.
const PENALTY_SHARE: f64 = 1e-7;

/// Modes U with UᵀAU = diag(fidelity) and UᵀPU = diag(roughness), where A are the weighted normal equations and P the
/// penalty. With the smoothing weight λ, the coefficients are U diag(1/(fidelity + λ roughness)) Uᵀ (right side). So
/// everything that depends on λ is a sum over modes.
pub(super) struct Spectrum {
    modes: DMatrix<f64>,
    /// Fidelity of each mode, in [0, 1]; 1 for the quadrics, which come first.
    pub(super) fidelity: Vec<f64>,
    /// Roughness of each mode, ascending; 0 for the quadrics.
    pub(super) roughness: Vec<f64>,
    /// The right side in the modes.
    pub(super) right: Vec<f64>,
    /// Weighted sum of squares of all observations.
    pub(super) square: f64,
    /// Number of observations.
    pub(super) equations: f64,
}

impl Spectrum {
    pub(super) fn of(
        equations: &Equations,
        penalty: &DMatrix<f64>,
        variances: &Kinds<f64>,
    ) -> Result<Self, Ep2Error> {
        let (per_height, per_slope) = (1.0 / variances.heights, 1.0 / variances.slopes);
        let mut sum = &equations.grams.heights * per_height;
        let mut right = &equations.right_sides.heights * per_height;
        let mut square = equations.squares.heights * per_height;
        if equations.has_slopes() {
            sum += &equations.grams.slopes * per_slope;
            right += &equations.right_sides.slopes * per_slope;
            square += equations.squares.slopes * per_slope;
        }
        let shift = PENALTY_SHARE * sum.trace() / penalty.trace();
        sum += penalty * shift;
        // With C Cᵀ the sum, the modes are C⁻ᵀ times the eigenvectors of C⁻¹ P C⁻ᵀ.
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
        Ok(Self {
            fidelity: roughness
                .iter()
                .map(|roughness| (1.0 - shift * roughness).max(0.0))
                .collect(),
            roughness,
            right: modes.tr_mul(&right).iter().copied().collect(),
            modes,
            square,
            equations: (equations.count.heights + equations.count.slopes) as f64,
        })
    }

    /// 1/(fidelity + λ roughness) of each mode.
    pub(super) fn filters(&self, log_weight: f64) -> Vec<f64> {
        let weight = libm::exp(log_weight);
        let pairs = self.fidelity.iter().zip(&self.roughness);
        let filters = pairs.map(|(fidelity, roughness)| 1.0 / (fidelity + weight * roughness));
        filters.collect()
    }

    /// The spline's coefficients.
    pub(super) fn coefficients(&self, filters: &[f64]) -> DVector<f64> {
        let in_modes = filters.iter().zip(&self.right).map(|(f, right)| f * right);
        &self.modes * DVector::from_iterator(self.right.len(), in_modes)
    }

    /// Inverse of A + λP, from the modes' [`Spectrum::filters`].
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
