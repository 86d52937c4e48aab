//! Fit of pictures with errors widened to the scatter of the markers, and its warnings.

use palpate_press::{
    ImageFit, MarkerDisplacement, Measured, Misfit, PressError, PressEstimate, Seen,
};
use palpate_statistics::Number;

use super::super::camera_calibration::{CONTRADICTED, SIGNIFICANCE_LEVEL};
use super::super::frame_pair::Frame;
use palpate_estimators::{ImageEstimator, ImageModel, MarkerImages};
use palpate_study::Warning;

/// An estimate with its method and its pictures.
pub(super) struct ScaledFit {
    method: ImageEstimator,
    pictures: MarkerImages,
    /// The estimate; its goodness of fit uses errors widened by the scatter at rest only.
    pub(super) estimate: PressEstimate,
    /// Contradictions between the pictures and the model, with the same errors.
    pub(super) misfits: Vec<Misfit>,
    /// Scatter of the markers at rest and pressed, relative to the stated errors; 1 if these explain it.
    scatter: [f64; 2],
}

impl ScaledFit {
    /// The estimate from markers at rest and pressed, with errors widened to explain their scatter.
    ///
    /// # Errors
    /// Errors of the fit, with the scatter at rest.
    pub(super) fn of(
        fit: ImageFit<ImageModel>,
        rest: &[Option<Seen>],
        mut pictures: MarkerImages,
        indentation: Option<Measured>,
    ) -> Result<Self, (PressError, f64)> {
        let mut method = ImageEstimator::new(fit.clone(), rest.to_vec());
        let at_rest = method.rest().map_err(|error| (error, 1.0))?;
        let at_rest = scatter(at_rest.chi_squared / at_rest.freedom.max(1) as f64);
        if at_rest > 1.0 {
            let mut rest = rest.to_vec();
            widen(&mut rest, at_rest);
            widen(&mut pictures.pressed, at_rest);
            method = ImageEstimator::new(fit, rest);
        }
        Self::pressed(method, pictures, indentation, at_rest).map_err(|error| (error, at_rest))
    }

    fn pressed(
        method: ImageEstimator,
        mut pictures: MarkerImages,
        indentation: Option<Measured>,
        at_rest: f64,
    ) -> Result<Self, PressError> {
        let stated = method.estimate(&pictures, indentation)?;
        let misfits = method.misfits(&pictures, indentation, &stated)?;
        let is_large = |misfit: &Misfit| matches!(misfit, Misfit::PoorFit { .. });
        let (mut estimate, mut pressed) = (stated.clone(), 1.0);
        if misfits.iter().any(is_large) {
            pressed = stated.reduced_chi_squared.sqrt();
            widen(&mut pictures.pressed, pressed);
            estimate = PressEstimate {
                goodness: stated.goodness,
                reduced_chi_squared: stated.reduced_chi_squared,
                ..method.estimate(&pictures, indentation)?
            };
        }
        Ok(Self {
            method,
            pictures,
            estimate,
            misfits,
            scatter: [at_rest, at_rest * pressed],
        })
    }

    /// Compares a stated indentation with the one that the same pictures alone give.
    pub(super) fn check_indentation(
        &self,
        indentation: Option<Measured>,
    ) -> Result<Option<Misfit>, PressError> {
        self.method.check_indentation(&self.pictures, indentation)
    }

    /// Displacements of the markers beyond those of the press, from their pictures.
    pub(super) fn beyond(&self) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        self.method.beyond(&self.pictures, &self.estimate)
    }

    /// Warnings if the stated errors were widened.
    pub(super) fn warnings(&self, frames: [&Frame; 2]) -> Vec<Warning> {
        let [at_rest, pressed] = self.scatter;
        let warning = |code, scatter: f64, frame: &Frame, cause: &str| {
            (scatter > 1.0).then(|| {
                let reliability = match scatter * scatter > CONTRADICTED {
                    true => ", and the curvature is not reliable",
                    false => "",
                };
                let scattered = scattered(frame, scatter);
                let text =
                    format!("{scattered}; uncertainties are as much wider{reliability}: {cause}");
                Warning::new(code, text, [("ratio", scatter)])
            })
        };
        let [rest, press] = frames;
        let of_rest = warning("scatter-at-rest", at_rest, rest, OF_REST);
        let mut of_press = warning(
            "poor-fit",
            if pressed > at_rest { pressed } else { 1.0 },
            press,
            "are the body and the indentation those of the sensor?",
        );
        if let Some((warning, goodness)) = of_press.as_mut().zip(self.estimate.goodness) {
            warning.numbers.insert("p_value".into(), goodness.p_value);
        }
        of_rest.into_iter().chain(of_press).collect()
    }
}

/// Question about markers that scatter at rest.
const OF_REST: &str = "are the camera and the discs those of the sensor?";

/// Possible cause of a failed fit: the markers scatter at rest. `None` if noise explains the scatter.
pub(super) fn reason(rest: &Frame, scatter: f64) -> Option<String> {
    (scatter > 1.0).then(|| format!("{}: {OF_REST}", scattered(rest, scatter)))
}

fn scattered(frame: &Frame, scatter: f64) -> String {
    format!(
        "the markers of {} scatter {} times as much as the frame's noise explains",
        frame.file,
        Number::rounded(scatter)
    )
}

/// Root of a reduced chi-squared above `SIGNIFICANCE_LEVEL`; otherwise 1.
fn scatter(reduced: f64) -> f64 {
    if reduced > SIGNIFICANCE_LEVEL {
        reduced.sqrt()
    } else {
        1.0
    }
}

fn widen(seen: &mut [Option<Seen>], scatter: f64) {
    for seen in seen.iter_mut().flatten() {
        seen.covariance *= scatter * scatter;
    }
}
