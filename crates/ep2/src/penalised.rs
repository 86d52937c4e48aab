//! One penalised spline through heights and slopes, with a smoothing weight from the data.

mod equations;
mod roughness;
mod spectrum;
mod weight;

pub use weight::Criterion;

use nalgebra::{DMatrix, DVector};

use crate::noise::{Noise, Variances};
use crate::quadric::SquareQuadric;
use crate::square::{Kinds, Square};
use crate::{Ep2Error, Fit, Knots, Method, Patch, TensorSpline};
use equations::Equations;
use spectrum::Spectrum;

/// Degree of the spline.
const DEGREE: usize = 3;
/// Most intervals per side: beyond, the dense algebra of the coefficients takes seconds.
const MOST_INTERVALS: usize = 24;
/// Most intervals per side unless told otherwise.
const MOST_BY_DEFAULT: usize = 8;
/// How often the noise is found anew from the fit.
const ROUNDS: usize = 1;

/// One bicubic tensor-product spline, fitted by weighted least squares to the heights and, where
/// there are normals, to both slopes, with a penalty on its third derivatives.
///
/// Quadrics cost no penalty. The weight of the penalty is chosen by a [`Criterion`]. The stated
/// covariance is that of the posterior of a Gaussian process, averaged over what the data leave
/// open of that weight (so that the bias of smoothing and the choice of the weight are in it).
///
/// The cost grows linearly with the contacts, and with the sixth power of the intervals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Penalised {
    /// Intervals of the spline along each side, 1 to 24; `None` takes as many as the contacts
    /// bear.
    pub intervals: Option<usize>,
    /// How the smoothing weight is chosen.
    pub criterion: Criterion,
    /// What is known of the noise.
    pub noise: Noise,
}

impl Method for Penalised {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        let intervals = self.intervals(patch)?;
        self.criterion.check()?;
        let known = self.noise.in_patch(&patch.frame)?;
        let square = Square::of(patch);
        let quadric = SquareQuadric::of(patch, &square, &known)?;
        let knots = Knots::uniform(DEGREE, -1.0, 1.0, intervals);
        let equations = Equations::around(&quadric, patch, &square, &knots);
        let roughness = roughness::of(&knots);

        let mut variances = quadric.variances;
        let mut smoothed = self.smoothed(&equations, &roughness, &variances, &known)?;
        let mut told = true;
        for _ in 0..ROUNDS {
            let residuals = equations.residuals(&smoothed.deviation);
            let taken = equations.taken(&smoothed, &variances);
            let bending = quadric.bending(&square);
            told = variances.update(&known, bending, patch, &residuals, &taken);
            smoothed = self.smoothed(&equations, &roughness, &variances, &known)?;
        }
        let coefficients = quadric
            .spline_coefficients(&knots, &knots)
            .iter()
            .zip(&smoothed.deviation)
            .map(|(quadric, deviation)| quadric + deviation)
            .collect();
        let scale = Variances {
            heights: variances.heights * smoothed.scale,
            slopes: variances.slopes * smoothed.scale,
        };
        Ok(Fit {
            frame: patch.frame,
            domain: patch.domain,
            spline: TensorSpline {
                u: square.knots(0, &knots),
                v: square.knots(1, &knots),
                coefficients,
            },
            covariance: told.then(|| smoothed.spectrum.covariance(&smoothed.open)),
            noise: told.then(|| scale.estimate(patch)),
            effective_unknowns: smoothed.effective_unknowns,
        })
    }
}

/// A fit with a chosen smoothing weight.
struct Smoothed {
    spectrum: Spectrum,
    /// Deviation from the quadric.
    deviation: DVector<f64>,
    /// Shares of the modes that the chosen weight leaves.
    kept: Vec<f64>,
    /// Factor of the assumed variances that explains the residuals.
    scale: f64,
    effective_unknowns: f64,
    /// Covariance in the modes of the spectrum.
    open: DMatrix<f64>,
}

impl Penalised {
    fn intervals(&self, patch: &Patch) -> Result<usize, Ep2Error> {
        match self.intervals {
            Some(intervals) if (1..=MOST_INTERVALS).contains(&intervals) => Ok(intervals),
            Some(intervals) => Err(Ep2Error::BadSetting {
                setting: "intervals",
                value: intervals as f64,
                expected: "1 to 24",
            }),
            None => {
                // Two and a half contacts per interval along each side.
                let bearable = (0.4 * (patch.samples.len() as f64).sqrt()) as usize;
                Ok(bearable.clamp(1, MOST_BY_DEFAULT))
            }
        }
    }

    fn smoothed(
        &self,
        equations: &Equations,
        roughness: &DMatrix<f64>,
        variances: &Kinds<f64>,
        known: &Noise,
    ) -> Result<Smoothed, Ep2Error> {
        let spectrum = Spectrum::of(equations, roughness, variances)?;
        let is_known = known.position_std.is_some()
            && (known.normal_std_rad.is_some() || !equations.has_slopes());
        let choice = weight::choose(&spectrum, self.criterion, is_known);
        let kept = spectrum.kept(choice.log_weight);
        let deviation = spectrum.deviation(&kept);
        if deviation.iter().all(|coefficient| coefficient.is_finite()) {
            Ok(Smoothed {
                deviation,
                kept,
                scale: choice.scale,
                effective_unknowns: choice.effective_unknowns,
                open: choice.open,
                spectrum,
            })
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }
}
