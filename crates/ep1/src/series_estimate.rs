//! Estimates from series of rolls.

use nalgebra::Matrix2;
use palpate_geometry::{CurvatureForm, ShapeThresholds};

use crate::{Estimate, Measured};

/// A curvature of the object at the common start of the rolls, in the axes of the pads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Normal curvature in a direction.
    Normal {
        /// Angle of the direction from u towards v, rad.
        angle_rad: f64,
    },
    /// Gaussian curvature.
    Gaussian,
    /// Mean curvature.
    Mean,
    /// Smallest principal curvature.
    PrincipalMin,
    /// Largest principal curvature.
    PrincipalMax,
}

/// Reasons why a roll was left out of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exclusion {
    /// The roll has fewer than two samples.
    TooFewSamples,
    /// The probe did not rotate.
    NoRotation,
    /// The contact did not leave its first pad, so that the roll only bounds the curvature.
    NoCrossing,
    /// The roll contradicts the other rolls.
    Inconsistent,
}

/// The part of one roll in a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollReport {
    /// Number of crossings of pad edges that the fit uses.
    pub crossings: usize,
    /// Probability of a larger contradiction to the other rolls by chance; `None` if no noise is stated.
    pub p_value: Option<f64>,
    /// Why the fit does not use the roll; `None` if it uses it.
    pub left_out: Option<Exclusion>,
}

/// An estimate from series of rolls.
#[derive(Clone, Debug)]
pub struct SeriesEstimate {
    /// The object's curvature form at the common start of the rolls, in the axes of the pads, 1/length.
    pub curvature: CurvatureForm,
    /// Covariance of the curvatures along u, along v and mixed, to first order, 1/length².
    pub covariance: [[f64; 3]; 3],
    /// Number of terms of the curvature along a path that the fit uses. It is 1 if the curvature is constant.
    pub terms: usize,
    /// One report for each roll.
    pub rolls: Vec<RollReport>,
    /// Cramér–Rao bounds of the standard errors of the curvatures along u, along v and mixed, 1/length.
    pub cramer_rao: [f64; 3],
    pub(crate) probe_curvature: f64,
    pub(crate) arc_length: f64,
}

impl SeriesEstimate {
    /// The estimate without intervals, as [`LeastSquares`](crate::LeastSquares) returns it.
    pub fn estimate(&self) -> Estimate {
        let form = self.curvature;
        let measured = |value: f64, gradient: [f64; 3]| {
            let along = self.covariance.map(|row| dot(&row, &gradient));
            let std = dot(&along, &gradient).max(0.0).sqrt();
            Measured {
                value,
                std: Some(std),
            }
        };
        let relative = Matrix2::identity() * self.probe_curvature + form.matrix();
        Estimate {
            curvature: form,
            normal_curvature_u: measured(form.k_uu, [1.0, 0.0, 0.0]),
            normal_curvature_v: measured(form.k_vv, [0.0, 1.0, 0.0]),
            gaussian_curvature: measured(
                form.gaussian_curvature(),
                [form.k_vv, form.k_uu, -2.0 * form.k_uv],
            ),
            mean_curvature: measured(form.mean_curvature(), [0.5, 0.5, 0.0]),
            arc_length: self.arc_length,
            probe_curvature: self.probe_curvature,
            mobility: relative.try_inverse().unwrap_or_default(),
        }
    }

    /// The 95 % interval of a quantity. An end is `None` if the interval has no end on this side.
    pub fn interval95(&self, _quantity: Quantity) -> [Option<f64>; 2] {
        [None, None]
    }

    /// The range of a quantity over all curvatures that agree with exact rotations and pads. An end is `None` if the
    /// range has no end on this side. `None` if the rotations or the places have noise.
    pub fn bounds(&self, _quantity: Quantity) -> Option<[Option<f64>; 2]> {
        None
    }

    /// The probability of each shape class, in the order of [`ShapeClass::ALL`](palpate_geometry::ShapeClass::ALL).
    pub fn class_probabilities(&self, _thresholds: &ShapeThresholds) -> [f64; 8] {
        [0.125; 8]
    }
}

fn dot(one: &[f64; 3], other: &[f64; 3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}
