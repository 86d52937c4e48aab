//! Estimates the curvature of an object from two frames of a camera sensor, by a fit to the markers' pictures.

mod camera_prior;
mod error_scaling;
mod image_options;

pub use image_options::PictureOptions;

use palpate_press::{Body, MarkerDisplacement, Measured, Misfit, PressError};
use palpate_study::Table;
use palpate_tracking::{Displaced, MarkerErrors, Track};

use self::camera_prior::CameraPrior;
use self::error_scaling::ScaledFit;
use super::camera_calibration::{NominalSensor, SeenAtRest, camera_of, usable};
use super::camera_reading::{CameraReading, TrackedPress};
use super::consistency::{self, FORMAT_VERSION};
use super::error::{RecordedError, explained};
use super::frame_pair::{Frame, FramePair};
use super::press_estimate::{GIVE_INDENTATION, force_and_pressure, too_large};
use super::press_report::{Described, PressReport, Row};
use palpate_estimators::{ImageFitSetup, MarkerImages, pressed_images};
use palpate_study::FieldError;
use palpate_study::Warning;

/// The press estimated from two frames, and the displacements of its markers.
#[derive(Clone, Debug)]
pub struct ImageEstimate {
    sensed: CameraReading,
    press: TrackedPress,
}

impl ImageEstimate {
    /// One row per tracked marker: its place in the layout, and its displacement, which is that of the estimated
    /// press plus a correction from its own picture.
    pub fn readings(&self) -> Table {
        self.sensed.readings()
    }

    /// The field on a grid, as [`CameraReading::field`].
    ///
    /// # Errors
    /// Errors of [`CameraReading::field`].
    pub fn field(&self, grid: usize, filter_std: f64) -> Result<Table, RecordedError> {
        self.sensed.field(grid, filter_std)
    }

    /// The estimate.
    pub const fn press(&self) -> &TrackedPress {
        &self.press
    }
}

/// Text of the warning that light and blur of the pictures may cause other warnings.
const BLEMISHED: &str = "the effects of `light_at_rim` and `blur_px` are corrected as for markers at rest; they change as markers move, which may cause other warnings";

/// Estimates the curvature of an object from a frame at rest and a pressed frame. The markers at rest are matched
/// with the layout. A press is fitted to the centroid, hue and size of each tracked marker, with the errors that the
/// tracker states. `tracked` is the tracking result of these frames. `file` names the readings in messages; `None` if
/// they are no file.
///
/// If markers scatter more than these errors explain, uncertainties are widened by the same factor, with a warning.
/// Misfits, p-value and reduced χ² of a press use the errors that explain the scatter at rest.
///
/// # Errors
/// [`RecordedError::Readings`] for frames of another size, under-exposed or saturated, of another layout or in other
/// colours, for a camera that the frame at rest contradicts, and for frames that determine no press.
pub fn estimate_images(
    [rest, press]: [&Frame; 2],
    tracked: &FramePair,
    options: &PictureOptions,
    file: Option<String>,
) -> Result<ImageEstimate, RecordedError> {
    let at_rest = |message: String| failure(rest, message);
    let of_study = |error: FieldError| at_rest(format!("{}: {}", error.path, error.message));
    let camera = camera_of(&options.press).map_err(of_study)?;
    usable(rest, camera).map_err(at_rest)?;
    usable(press, camera).map_err(|message| failure(press, message))?;
    let meant =
        NominalSensor::of(&options.press, camera).and_then(NominalSensor::through_blemishes);
    let meant = meant.map_err(of_study)?;
    let seen = SeenAtRest::of(&meant, &tracked.found[0], options.unit()).map_err(at_rest)?;
    let known = CameraPrior::of(&meant, options, rest)?;
    let doubt = known.doubt(&seen.camera, rest)?;
    let plan = ImageFitSetup {
        estimator: &options.press.estimator,
        model: &options.press.model,
        sphere: &meant.sphere,
        markers: &meant.markers,
        optics: &meant.seen_from(&known.stand).map_err(of_study)?,
        stds: known.stds,
        departure_prior: known.departure_prior.clone(),
        layers: &Body::bonded_layers,
    };
    let fit = plan.fit().map_err(of_study)?;
    let fit = fit.ok_or_else(|| at_rest("the estimator takes no pictures".to_owned()))?;
    let matched = Matched::of(&seen, tracked);
    let scene = Scene {
        frames: [rest, press],
        options,
        meant: &meant,
        matched: &matched,
    };
    let measured = scene.indentation();
    let indentation = measured.as_ref().map(|(indentation, _)| *indentation);
    let refused = |error: PressError| scene.refused(&error);
    let widened = ScaledFit::of(
        fit,
        &seen.seen,
        matched.pressed(tracked, &meant),
        indentation,
    );
    let mut widened =
        widened.map_err(
            |(error, at_rest)| match error_scaling::reason(rest, at_rest) {
                Some(reason) => {
                    failure(press, explained(format!("{error}; {reason}"), error.name()))
                }
                None => refused(error),
            },
        )?;
    if widened.misfits.is_empty() {
        widened.estimate.within_object().map_err(refused)?;
    }
    let moved = scene.moved(&widened).map_err(refused)?;
    let sensed = scene.sensed(tracked, &moved, file)?;
    let (contradiction, unchecked) = match widened.check_indentation(indentation) {
        Ok(contradiction) => (contradiction, None),
        Err(error) => (None, Some(consistency::unchecked_indentation(error))),
    };
    widened.misfits.extend(contradiction);
    let blemished = meant.is_blemished() && !widened.misfits.is_empty();
    let warnings = (seen.missing.into_iter())
        .chain(Warning::of("other-camera", doubt))
        .chain(Warning::of("ignored-layer", options.other_body()))
        .chain(Warning::of(
            "uneven-pictures",
            blemished.then_some(BLEMISHED),
        ))
        .chain(widened.warnings(scene.frames))
        .chain(unchecked)
        .chain(measured.and_then(|(_, warning)| warning))
        .collect();
    let object = scene.object(&widened, &moved, warnings, &sensed)?;
    Ok(ImageEstimate {
        press: sensed.pressed_by(object),
        sensed,
    })
}

fn failure(frame: &Frame, message: String) -> RecordedError {
    RecordedError::Readings {
        file: frame.file.clone(),
        message,
    }
}

/// Markers of a layout, matched with the tracked markers.
struct Matched {
    /// Index of the track of each marker of the layout.
    tracks: Vec<Option<usize>>,
    /// Markers of the layout that were found again in the pressed frame, in the order of their tracks.
    rows: Vec<usize>,
}

impl Matched {
    fn of(at_rest: &SeenAtRest, tracked: &FramePair) -> Self {
        // The tracks begin with those of the markers at rest, in their order.
        let tracks = at_rest.found.clone();
        let again = |marker: &usize| {
            let track = tracks[*marker].and_then(|track| tracked.tracks.get(track));
            track.is_some_and(|track| track.change().is_some())
        };
        let mut rows: Vec<usize> = (0..tracks.len()).filter(again).collect();
        rows.sort_by_key(|&marker| tracks[marker]);
        Self { tracks, rows }
    }

    /// Images of the markers in the pressed frame.
    fn pressed(&self, tracked: &FramePair, meant: &NominalSensor<'_>) -> MarkerImages {
        let of_layout = self.tracks.iter();
        let tracks: Vec<Option<Track>> = of_layout
            .map(|track| tracked.tracks.get((*track)?).copied())
            .collect();
        let errors: Vec<Option<MarkerErrors>> = tracks
            .iter()
            .map(|track| tracked.found[1].errors_of(&(*track)?.pressed?))
            .collect();
        let seen = pressed_images(&tracks, &errors).into_iter().enumerate();
        MarkerImages {
            own_rest: None,
            pressed: seen
                .map(|(marker, seen)| Some(meant.clear(marker, seen?)))
                .collect(),
        }
    }
}

/// The two frames of a press, with the stated sensor and the matched markers.
struct Scene<'a> {
    frames: [&'a Frame; 2],
    options: &'a PictureOptions,
    meant: &'a NominalSensor<'a>,
    matched: &'a Matched,
}

impl Scene<'_> {
    fn unit(&self) -> &'static str {
        self.options.unit().as_str()
    }

    /// The stated indentation, with a warning if its standard deviation is assumed.
    fn indentation(&self) -> Option<(Measured, Option<Warning>)> {
        let std = self.options.press.estimator.priors().indentation_std;
        let value = self.options.indentation?;
        Some(consistency::indentation(value, std, self.unit()))
    }

    fn refused(&self, error: &PressError) -> RecordedError {
        let [rest, pressed] = self.frames;
        let message = match error {
            PressError::NoContact { .. } if rest.image == pressed.image => {
                format!("{error}: all pixels are those of {}", rest.file)
            }
            PressError::Undetermined { .. } if self.options.indentation.is_none() => {
                format!("{error}; {GIVE_INDENTATION}")
            }
            _ => error.to_string(),
        };
        failure(pressed, explained(message, error.name()))
    }

    /// Marker displacements midway between the discs: by the fitted press, plus what each picture shows beyond it.
    fn moved(&self, widened: &ScaledFit) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        let estimate = &widened.estimate;
        let body = self.body()?;
        let contact = body.press(estimate.most_likely_curvature, estimate.indentation.value)?;
        let by_press = self.meant.markers.displacements(&contact, estimate.contact);
        let beyond = widened.beyond()?;
        let pairs = by_press.iter().zip(beyond);
        Ok(pairs
            .map(|(by_press, beyond)| {
                let beyond = beyond?;
                Some(MarkerDisplacement {
                    normal: by_press.normal + beyond.normal,
                    tangential: [0, 1]
                        .map(|axis| by_press.tangential[axis] + beyond.tangential[axis]),
                })
            })
            .collect())
    }

    /// Displacements of the markers that were found again.
    fn sensed(
        &self,
        tracked: &FramePair,
        moved: &[Option<MarkerDisplacement>],
        file: Option<String>,
    ) -> Result<CameraReading, RecordedError> {
        let radius = self.meant.sphere.radius;
        let rows = self.matched.rows.iter();
        let displaced: Vec<Displaced> = rows
            .filter_map(|&marker| {
                let moved = moved[marker]?;
                Some(Displaced {
                    place: self.meant.places[marker].map(|along| along / radius),
                    tangential: moved.tangential,
                    normal: moved.normal,
                })
            })
            .collect();
        CameraReading::of(tracked, &displaced, (radius, self.options.unit()), file)
    }

    fn object(
        &self,
        widened: &ScaledFit,
        moved: &[Option<MarkerDisplacement>],
        mut warnings: Vec<Warning>,
        sensed: &CameraReading,
    ) -> Result<PressReport, RecordedError> {
        let ScaledFit {
            estimate, misfits, ..
        } = widened;
        let rows = self.matched.rows.iter().copied();
        let rows: Vec<usize> = rows.filter(|&marker| moved[marker].is_some()).collect();
        let row = |marker: &usize| rows.iter().position(|one| one == marker);
        let wrong_markers: Vec<Row> = estimate
            .wrong_markers
            .iter()
            .filter_map(row)
            .map(|at| sensed.row(at))
            .collect();
        let distances = self.meant.markers.subset(&rows).distances(estimate.contact);
        warnings.extend(consistency::left_out(
            &wrong_markers,
            &distances,
            estimate.contact_radius.value,
            self.options.indentation.is_some(),
        ));
        let press = &self.options.press;
        warnings.extend(too_large(
            estimate,
            self.meant.sphere.radius,
            self.options.thickness().is_some(),
        ));
        let in_row = |misfit: &Misfit| match *misfit {
            // The scatter of the markers has its own warning.
            Misfit::PoorFit { .. } => None,
            Misfit::Outlier { reading, p_value } => Some(Misfit::Outlier {
                reading: row(&reading)?,
                p_value,
            }),
            misfit => Some(misfit),
        };
        let misfits = misfits.iter().filter_map(in_row);
        warnings.extend(misfits.map(|misfit| sensed.warning(&misfit)));
        let body = self.body();
        let stresses = body
            .and_then(|body| {
                let young = self.options.young;
                force_and_pressure(&body, estimate, young, self.options.unit())
            })
            .map_err(|error| self.refused(&error))?;
        Ok(PressReport::of(
            estimate,
            Described {
                format_version: FORMAT_VERSION,
                method: press.estimator.name(),
                c: None,
                markers: rows.len(),
                with_tangential: true,
                unit: self.options.unit(),
                stresses,
                wrong_markers,
                warnings,
            },
        ))
    }

    /// The sensor's soft body, with displacements at the depth of the markers.
    fn body(&self) -> Result<Body, PressError> {
        let depth = self.meant.sphere.marker_depth;
        match self.options.thickness() {
            Some(thickness) => Body::solved_layer(thickness, depth),
            None => Body::half_space(self.options.poisson(), depth),
        }
    }
}
