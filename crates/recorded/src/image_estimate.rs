//! Estimates the curvature of an object from two frames of a camera sensor, by a fit to the images of the markers.

use palpate_estimators::{ImageEstimator, ImageFitSetup, MarkerImages, pressed_images};
use palpate_press::{
    Body, ImageFit, MarkerDisplacement, Measured, Misfit, PressError, PressEstimate, Seen,
};
use palpate_statistics::Number;
use palpate_study::{FieldError, Warning};
use palpate_tracking::{Displaced, MarkerErrors, Track};

use super::camera_calibration::{MarkersAtRest, usable};
use super::camera_prior::CameraPrior;
use super::camera_reading::{CameraReading, TrackedPress};
use super::error::{RecordedError, explained};
use super::frame_pair::{Frame, FramePair};
use super::layout_matching::{CONTRADICTION, scatter};
use super::nominal_sensor::NominalSensor;
use super::press_estimate::{GIVE_INDENTATION, force_and_pressure};
use super::press_options::PictureOptions;
use super::press_report::{PressReport, Row};
use super::press_warnings::{indentation_check, large_contact, left_out, stated_indentation};

const BLEMISHED: &str = "the effects of `light_at_rim` and `blur_px` are corrected for markers at rest; they change when markers move, which may cause other warnings";

/// Factor by which all uncertainties of estimates from JPEG frames are multiplied. The compression changes all markers
/// in a similar way, so its errors do not average out. The factor was found by experiments. With a factor of 2, 19 of
/// 20 intervals from frames of quality 92 and 95 contained the true curvature. However, of 12 intervals from frames
/// with subsampled colours, only 6 contained the curvature. With a factor of 3, all intervals contained it.
const JPEG_FACTOR: f64 = 3.0;
const OF_JPEG: &str = "the frames are compressed as JPEG, which changes all markers in a similar way, so all uncertainties are tripled; a format without loss, such as PNG, avoids this";

/// Estimates the curvature of an object from a frame at rest and a pressed frame, and computes the displacements of the
/// markers. The markers at rest are matched with the layout, and a press is fitted to the centroid, hue and size of
/// each tracked marker. The tracker states the errors of these features. `tracked` is the tracking result of the two
/// frames. `file` is the name of the readings in messages; `None` if the readings are not in a file.
///
/// If the residuals of the markers are larger than these errors explain, all uncertainties are multiplied by the same
/// factor, and a warning states this. Misfits, p-value and reduced χ² of a press are computed with errors that are only
/// as large as the residuals at rest require.
///
/// # Errors
/// [`RecordedError::Readings`] if the frames have another size, layout or colours than the study, are under-exposed or
/// saturated, or do not determine the press. The same error if the frame at rest contradicts the camera.
pub(super) fn estimate_images(
    [rest, press]: [&Frame; 2],
    tracked: &FramePair,
    options: &PictureOptions,
    file: Option<String>,
) -> Result<(CameraReading, TrackedPress), RecordedError> {
    let at_rest = |message: String| RecordedError::readings(&rest.file, message);
    let of_study = |error: FieldError| at_rest(error.to_string());
    let nominal = NominalSensor::of(&options.press).map_err(of_study)?;
    usable(rest, nominal.camera).map_err(at_rest)?;
    let of_press = |message| RecordedError::readings(&press.file, message);
    usable(press, nominal.camera).map_err(of_press)?;
    let nominal = nominal.through_blemishes().map_err(of_study)?;
    let markers = MarkersAtRest::of(&nominal, &tracked.found[0], options.unit).map_err(at_rest)?;
    let prior = CameraPrior::of(&nominal, options, rest)?;
    let other_camera = prior.other_camera(&markers.camera, rest)?;
    let setup = ImageFitSetup {
        estimator: &options.press.estimator,
        model: &options.press.model,
        sphere: &nominal.sphere,
        markers: &nominal.markers,
        optics: &nominal.optics_of(&prior.geometry).map_err(of_study)?,
        stds: prior.stds,
        departure_prior: prior.departure_prior.clone(),
        layers: &Body::bonded_layers,
    };
    let fit = setup.fit().map_err(of_study)?;
    let fit = fit.ok_or_else(|| at_rest("the estimator does not use images".to_owned()))?;
    let scene = Scene {
        frames: [rest, press],
        options,
        nominal: &nominal,
        tracked,
        matched: Matched::of(markers.found, tracked),
    };
    let std = options.press.estimator.priors().indentation_std;
    let unit = options.unit.as_str();
    let stated = options.indentation;
    let stated = stated.map(|value| stated_indentation(value, std, unit));
    let (indentation, assumed) = stated.unzip();
    let images = scene.images();
    let is_jpeg = [rest, press].map(|frame| frame.compression.is_some()) != [false; 2];
    let of_jpeg = if is_jpeg { JPEG_FACTOR } else { 1.0 };
    let scaled = ScaledFit::of(fit, &markers.pictures, images, indentation, of_jpeg);
    let mut scaled = scaled.map_err(|(error, scatter)| scene.refused(&error, scatter))?;
    let refused = |error: PressError| scene.refused(&error, 1.0);
    if scaled.misfits.is_empty() {
        scaled.estimate.within_object().map_err(refused)?;
    }
    let moved = scene.displacements(&scaled).map_err(refused)?;
    let reading = scene.reading(&moved, file)?;
    let (contradiction, unchecked) = indentation_check(scaled.check_indentation(indentation));
    scaled.misfits.extend(contradiction);
    let blemished = nominal.is_blemished() && !scaled.misfits.is_empty();
    let mut report = scene.report(&scaled, &moved, &reading)?;
    let of_frames = (markers.missing.into_iter())
        .chain(Warning::of("other-camera", other_camera))
        .chain(Warning::of("ignored-layer", options.other_body()))
        .chain(Warning::of("jpeg-frames", is_jpeg.then_some(OF_JPEG)))
        .chain(Warning::of(
            "uneven-pictures",
            blemished.then_some(BLEMISHED),
        ))
        .chain(scaled.warnings(scene.frames))
        .chain(unchecked)
        .chain(assumed.flatten());
    report.warnings.splice(..0, of_frames);
    let press = reading.tracked_press(report);
    Ok((reading, press))
}

struct Matched {
    /// Index of the track of each marker of the layout; `None` if the marker has no track.
    tracks: Vec<Option<usize>>,
    /// Indices, in the layout, of the markers that were found in both frames. The indices are in the order of the
    /// tracks.
    rows: Vec<usize>,
}

impl Matched {
    /// The first tracks belong to the markers at rest, in the same order. So the index of a marker at rest is also the
    /// index of its track.
    fn of(tracks: Vec<Option<usize>>, tracked: &FramePair) -> Self {
        let is_tracked = |marker: &usize| {
            let track = tracks[*marker].and_then(|track| tracked.tracks.get(track));
            track.is_some_and(|track| track.change().is_some())
        };
        let mut rows: Vec<usize> = (0..tracks.len()).filter(is_tracked).collect();
        rows.sort_by_key(|&marker| tracks[marker]);
        Self { tracks, rows }
    }
}

struct Scene<'a> {
    frames: [&'a Frame; 2],
    options: &'a PictureOptions,
    nominal: &'a NominalSensor<'a>,
    tracked: &'a FramePair,
    matched: Matched,
}

impl Scene<'_> {
    fn images(&self) -> MarkerImages {
        let tracks = self.matched.tracks.iter();
        let tracks: Vec<Option<Track>> = tracks
            .map(|track| self.tracked.tracks.get((*track)?).copied())
            .collect();
        let errors = |track: &Option<Track>| self.tracked.found[1].errors_of(&(*track)?.pressed?);
        let errors: Vec<Option<MarkerErrors>> = tracks.iter().map(errors).collect();
        let images = pressed_images(&tracks, &errors).into_iter().enumerate();
        let clear =
            |(marker, image): (usize, Option<Seen>)| Some(self.nominal.clear(marker, image?));
        MarkerImages {
            own_rest: None,
            pressed: images.map(clear).collect(),
        }
    }

    /// Converts an error of a fit to an error about the pressed frame. `scatter` is the factor by which the stated
    /// errors must be multiplied to explain the residuals at rest. If it is above 1, the message names the frame at
    /// rest as a possible cause.
    fn refused(&self, error: &PressError, scatter: f64) -> RecordedError {
        let [rest, pressed] = self.frames;
        let message = match error {
            _ if scatter > 1.0 => format!("{error}; {}: {OF_REST}", scattered(rest, scatter)),
            PressError::NoContact { .. } if rest.image == pressed.image => {
                format!("{error}: all pixels are those of {}", rest.file)
            }
            PressError::Undetermined { .. } if self.options.indentation.is_none() => {
                format!("{error}; {GIVE_INDENTATION}")
            }
            _ => error.to_string(),
        };
        RecordedError::readings(&pressed.file, explained(message, error.into()))
    }

    /// Displacement of each marker, midway between its two discs. It is the displacement in the fitted press, plus a
    /// residual displacement that is computed from the image of this marker alone.
    fn displacements(
        &self,
        scaled: &ScaledFit,
    ) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        let estimate = &scaled.estimate;
        let body = self.body()?;
        let contact = body.press(estimate.most_likely_curvature, estimate.indentation.value)?;
        let of_press = self
            .nominal
            .markers
            .displacements(&contact, estimate.contact);
        let residuals = scaled.method.beyond(&scaled.pictures, estimate)?;
        let sum = |(of_press, residual): (&MarkerDisplacement, Option<MarkerDisplacement>)| {
            let residual = residual?;
            let along = |axis: usize| of_press.tangential[axis] + residual.tangential[axis];
            Some(MarkerDisplacement {
                normal: of_press.normal + residual.normal,
                tangential: [0, 1].map(along),
            })
        };
        Ok(of_press.iter().zip(residuals).map(sum).collect())
    }

    fn reading(
        &self,
        moved: &[Option<MarkerDisplacement>],
        file: Option<String>,
    ) -> Result<CameraReading, RecordedError> {
        let radius = self.nominal.sphere.radius;
        let displaced = |&marker: &usize| {
            let moved = moved[marker]?;
            Some(Displaced {
                place: self.nominal.places[marker].map(|along| along / radius),
                tangential: moved.tangential,
                normal: moved.normal,
            })
        };
        let displaced: Vec<Displaced> = self.matched.rows.iter().filter_map(displaced).collect();
        CameraReading::of(self.tracked, &displaced, (radius, self.options.unit), file)
    }

    fn report(
        &self,
        scaled: &ScaledFit,
        moved: &[Option<MarkerDisplacement>],
        reading: &CameraReading,
    ) -> Result<PressReport, RecordedError> {
        let (estimate, options, unit) = (&scaled.estimate, self.options, self.options.unit);
        let rows = self.matched.rows.iter().copied();
        let rows: Vec<usize> = rows.filter(|&marker| moved[marker].is_some()).collect();
        let row = |marker: &usize| rows.iter().position(|one| one == marker);
        let wrong: Vec<usize> = estimate.wrong_markers.iter().filter_map(row).collect();
        let wrong_markers: Vec<Row> = wrong.iter().map(|&row| reading.row(row)).collect();
        let wrong: Vec<_> = wrong.into_iter().zip(&wrong_markers).collect();
        let distances = self
            .nominal
            .markers
            .subset(&rows)
            .distances(estimate.contact);
        let radius = estimate.contact_radius.value;
        let left_out = left_out(&wrong, &distances, radius, options.indentation.is_some());
        let is_layer = options.thickness().is_some();
        let large = large_contact(estimate, self.nominal.sphere.radius, is_layer);
        let in_row = |misfit: &Misfit| match *misfit {
            // Omit the warning about a poor fit, because a separate warning reports the scatter of the markers.
            Misfit::PoorFit { .. } => None,
            Misfit::Outlier { reading, p_value } => Some(Misfit::Outlier {
                reading: row(&reading)?,
                p_value,
            }),
            misfit => Some(misfit),
        };
        let misfits = scaled.misfits.iter().filter_map(in_row);
        let misfits = misfits.map(|misfit| reading.warning(&misfit));
        let stresses = self.body();
        let stresses =
            stresses.and_then(|body| force_and_pressure(&body, estimate, options.young, unit));
        let [force, peak_pressure] = stresses.map_err(|error| self.refused(&error, 1.0))?;
        Ok(PressReport {
            markers: rows.len(),
            force,
            peak_pressure,
            warnings: left_out.into_iter().chain(large).chain(misfits).collect(),
            wrong_markers,
            ..PressReport::of(estimate, (&options.press.estimator).into(), unit)
        })
    }

    fn body(&self) -> Result<Body, PressError> {
        let depth = self.nominal.sphere.marker_depth;
        match self.options.thickness() {
            Some(thickness) => Body::solved_layer(thickness, depth),
            None => Body::half_space(self.options.poisson(), depth),
        }
    }
}

/// A fit of a press to images of the markers. If the residuals are larger than the stated errors explain, the stated
/// errors are multiplied by a factor, which is called the scatter. The frame at rest and the pressed frame each have
/// their own scatter.
struct ScaledFit {
    method: ImageEstimator,
    pictures: MarkerImages,
    /// Estimate of the press. For its goodness of fit, the stated errors are multiplied only by the factor that
    /// explains the residuals at rest (`scatter[0]`). With the factor of the pressed frame (`scatter[1]`), the reduced
    /// χ² of every poor fit would be 1.
    estimate: PressEstimate,
    /// Contradictions between the images and the model. Their tests use the stated errors multiplied by the scatter at
    /// rest, not by the scatter in the press.
    misfits: Vec<Misfit>,
    /// Scatter at rest, and scatter in the press. The scatter is the factor on the stated errors that explains the
    /// residuals; 1 if the stated errors are large enough.
    scatter: [f64; 2],
}

impl ScaledFit {
    /// Fits the press to the images of the markers at rest and in the press. All stated errors are multiplied by
    /// `of_jpeg`, which is above 1 for JPEG frames and otherwise 1.
    ///
    /// # Errors
    /// The error of the fit, together with the scatter of the markers at rest.
    fn of(
        fit: ImageFit,
        rest: &[Option<Seen>],
        mut pictures: MarkerImages,
        indentation: Option<Measured>,
        of_jpeg: f64,
    ) -> Result<Self, (PressError, f64)> {
        let mut method = ImageEstimator::new(fit.clone(), rest.to_vec());
        let at_rest = method.rest().map_err(|error| (error, 1.0))?;
        let at_rest = scatter(at_rest.chi_squared / at_rest.freedom.max(1) as f64);
        let factor = at_rest * of_jpeg;
        if factor > 1.0 {
            let mut rest = rest.to_vec();
            widen(&mut rest, factor);
            widen(&mut pictures.pressed, factor);
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
        let mut estimate = method.estimate(&pictures, indentation)?;
        let misfits = method.misfits(&pictures, indentation, &estimate)?;
        let is_poor = |misfit: &Misfit| matches!(misfit, Misfit::PoorFit { .. });
        let mut pressed = 1.0;
        if misfits.iter().any(is_poor) {
            pressed = estimate.reduced_chi_squared.sqrt();
            widen(&mut pictures.pressed, pressed);
            estimate = PressEstimate {
                goodness: estimate.goodness,
                reduced_chi_squared: estimate.reduced_chi_squared,
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

    fn check_indentation(
        &self,
        indentation: Option<Measured>,
    ) -> Result<Option<Misfit>, PressError> {
        self.method.check_indentation(&self.pictures, indentation)
    }

    fn warnings(&self, [rest, press]: [&Frame; 2]) -> impl Iterator<Item = Warning> {
        let [at_rest, pressed] = self.scatter;
        let warning = |code, scatter: f64, frame: &Frame, cause: &str| {
            let reliability = match scatter * scatter > CONTRADICTION {
                true => ", and the curvature is not reliable",
                false => "",
            };
            let scattered = scattered(frame, scatter);
            let text = format!(
                "{scattered}; all uncertainties are multiplied by this factor{reliability}: {cause}"
            );
            Warning::new(code, text, [("ratio", scatter)])
        };
        let of_rest = (at_rest > 1.0).then(|| warning("scatter-at-rest", at_rest, rest, OF_REST));
        let of_press = (pressed > at_rest).then(|| {
            let cause = "do the body and the indentation match the sensor?";
            let mut warning = warning("poor-fit", pressed, press, cause);
            if let Some(goodness) = self.estimate.goodness {
                warning.numbers.insert("p_value".into(), goodness.p_value);
            }
            warning
        });
        of_rest.into_iter().chain(of_press)
    }
}

const OF_REST: &str = "do the camera and the discs match the sensor?";

fn scattered(frame: &Frame, scatter: f64) -> String {
    format!(
        "the markers of {} scatter {} times as much as the frame's noise explains",
        frame.file,
        Number::rounded(scatter)
    )
}

fn widen(pictures: &mut [Option<Seen>], scatter: f64) {
    for picture in pictures.iter_mut().flatten() {
        picture.covariance *= scatter * scatter;
    }
}
