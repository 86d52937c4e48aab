//! A quadric that is fitted by weighted least squares. It is the simplest surface that has a curvature.

use nalgebra::DMatrix;

use crate::knots::Knots;
use crate::misfit::{MAX_CONTACTS, Model};
use crate::noise::Noise;
use crate::posterior::Posterior;
use crate::spline::TensorSpline;
use crate::square_quadric::{SERIES, Square, SquareQuadric, UNKNOWNS};
use crate::{Ep2Error, Fit, Method, MisfitTest, Patch};

/// The quadric w = c₀ + c₁a + c₂b + c₃a² + c₄ab + c₅b² that fits heights and slopes best, weighted by their noise.
///
/// Its standard errors include only the noise, not the deviation of the patch from a quadric.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use palpate_ep2::{Contact, Method, Patch, Quadric};
///
/// // Three fingers in the bowl z = (x² + 2 y²)/8, whose curvatures at the bottom are −1/4 and −1/2.
/// let places = (0..15).map(|i| (i / 5, f64::from(i % 5 - 2), f64::from(i / 5 - 1)));
/// let contacts: Vec<Contact> = places
///     .map(|(finger, x, y)| (finger as usize, Point3::new(x, y, (x * x + 2.0 * y * y) / 8.0)))
///     .map(|(finger, position)| Contact::new(finger, position, None))
///     .collect();
/// let fit = Quadric::default().fit(&Patch::new(&contacts, &Vector3::z())?)?;
/// let bottom = fit.curvature_at(&Point3::origin())?;
/// assert!((bottom.gaussian - 0.125).abs() < 1e-9 && (bottom.mean + 0.375).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quadric {
    /// Stated standard deviations of the contacts' errors. Values that are not stated are estimated.
    pub noise: Noise,
}

impl Method for Quadric {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        Ok(self.fit_quadric(patch)?.0)
    }

    fn misfit(&self, patch: &Patch, _fit: Option<&Fit>) -> Result<MisfitTest, Ep2Error> {
        let (patch, step) = patch.thinned(MAX_CONTACTS);
        let (fit, quadric) = self.fit_quadric(&patch)?;
        let Some(found) = fit.noise else {
            return Ok(MisfitTest::default());
        };
        let model = Model {
            patch: &patch,
            step,
            square: Square::of(&patch),
            fit: &fit,
            quadric: &quadric,
            noise: &self.noise,
            found,
            degree: 2,
        };
        model.misfit(&DMatrix::zeros(0, 0))
    }
}

impl Quadric {
    /// Fits a quadric. Returns it in the coordinates of the patch and in the coordinates of the square [−1, 1]².
    fn fit_quadric(&self, patch: &Patch) -> Result<(Fit, SquareQuadric), Ep2Error> {
        let square = Square::of(patch);
        let known = self.noise.in_patch(&patch.frame)?;
        let quadric = SquareQuadric::of(patch, &square, &known)?;
        let knots = Knots::uniform(2, -1.0, 1.0, 1);
        let posterior = quadric.noise.map(|_| {
            let covariance = SERIES * quadric.covariance * SERIES.transpose();
            let covariance = DMatrix::from_column_slice(UNKNOWNS, UNKNOWNS, covariance.as_slice());
            Posterior::new(square, 2, &quadric.series(), &covariance)
        });
        let fit = Fit {
            frame: patch.frame,
            domain: patch.domain,
            spline: TensorSpline {
                u: square.knots(0, &knots),
                v: square.knots(1, &knots),
                coefficients: quadric.spline_coefficients(&knots, &knots),
            },
            mean: None,
            posterior,
            basis: None,
            noise: quadric.noise,
            effective_unknowns: UNKNOWNS as f64,
            status: None,
        };
        Ok((fit, quadric))
    }
}
