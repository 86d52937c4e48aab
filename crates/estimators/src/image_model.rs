//! Model of the camera, for the fit to marker images.

use nalgebra::{DMatrix, Matrix4, Matrix4x2, Matrix4x3};
use palpate_chromatouch::{Departure, DiscMotion, MarkerMotion, Optics, SeenMarker};
use palpate_press::{MarkerDisplacement, PictureSlopes, Seen, SensorState, Steps, View};
use palpate_tracking::{Marker, MarkerErrors};

/// Computes the images of markers in a camera whose parameters differ from their nominal values. An image consists of
/// the centroid (px), the hue (turns) and the logarithm of the size (px²) of a marker. A [`Departure`] contains the
/// differences between the parameters and their nominal values. These are the same for all markers.
#[derive(Clone, Debug)]
pub struct ImageModel {
    /// Camera and markers of the sensor with its nominal parameters.
    pub optics: Optics,
}

impl View for ImageModel {
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>> {
        let optics = self.optics.misaligned(sensor.misalignments).ok()?;
        let optics = optics.departed(&departure(sensor)?).ok()?;
        let seen = optics.project(&motions(moved)).ok()?;
        let pictures = seen.iter().map(|seen| seen.as_ref().map(picture));
        Some(pictures.collect())
    }

    fn slopes(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
        steps: &Steps<'_>,
    ) -> Option<PictureSlopes> {
        let numbers: Vec<usize> = steps.departures.iter().map(|(number, _)| *number).collect();
        let optics = self.optics.misaligned(sensor.misalignments).ok()?;
        let seen = optics
            .slopes(&departure(sensor)?, &motions(moved), &numbers)
            .ok()?;
        let mut slopes = PictureSlopes {
            pictures: vec![None; seen.len()],
            common: DMatrix::zeros(4 * seen.len(), numbers.len()),
            misalignments: vec![Matrix4x2::zeros(); seen.len()],
            displacements: vec![[Matrix4x3::zeros(); 2]; seen.len()],
        };
        for (marker, seen) in seen.iter().enumerate() {
            let Some(seen) = seen else { continue };
            slopes.pictures[marker] = Some(picture(&seen.seen));
            slopes.misalignments[marker] = seen.by_misalignment;
            slopes.displacements[marker] = seen.by_motion;
            let mut rows = slopes.common.rows_mut(4 * marker, 4);
            for (column, &number) in numbers.iter().enumerate() {
                rows.set_column(column, &seen.by_departure.column(number));
            }
        }
        Some(slopes)
    }
}

fn departure(sensor: &SensorState<'_>) -> Option<Departure> {
    let numbers: [f64; Departure::NUMBERS] = sensor.common.try_into().ok()?;
    Some(Departure::from(numbers))
}

fn motions(moved: &[[MarkerDisplacement; 2]]) -> Vec<Option<MarkerMotion>> {
    let motion = |moved: &MarkerDisplacement| DiscMotion {
        normal: moved.normal,
        tangential: moved.tangential,
        ..DiscMotion::default()
    };
    let motions = moved.iter().map(|[magenta, yellow]| {
        Some(MarkerMotion {
            magenta: motion(magenta),
            yellow: motion(yellow),
        })
    });
    motions.collect()
}

fn picture(seen: &SeenMarker) -> [f64; 4] {
    let [x, y] = seen.centroid_px;
    [x, y, seen.hue_turns, libm::log(seen.size_px2)]
}

/// Converts the image of a marker and the covariance of its errors to the type that the fit to marker images reads.
pub fn marker_image(marker: &Marker, errors: &MarkerErrors) -> Seen {
    let [x, y] = marker.centroid_px;
    Seen {
        picture: [x, y, marker.hue_turns, libm::log(marker.size_px2)],
        covariance: Matrix4::from_fn(|row, column| errors.covariance[row][column]),
    }
}
