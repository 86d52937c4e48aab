//! The law of a marker's picture, as a fit of pictures takes it: the camera's optics.

use nalgebra::Matrix4;
use palpate_chromatouch::{Departure, DiscMotion, MarkerMotion, Optics, SeenMarker};
use palpate_press::{MarkerDisplacement, Seen, SensorState, View};
use palpate_tracking::{Marker, MarkerErrors};

use super::camera::Spotted;

/// Pictures by optics that depart from what is known of them.
#[derive(Clone, Debug)]
pub(crate) struct PictureLaw {
    /// The sensor as it is meant to be.
    pub(crate) optics: Optics,
}

impl View for PictureLaw {
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>> {
        let motion = |moved: &MarkerDisplacement| DiscMotion {
            normal: moved.normal,
            tangential: moved.tangential,
            ..DiscMotion::default()
        };
        let motions: Vec<Option<MarkerMotion>> = moved
            .iter()
            .map(|[magenta, yellow]| {
                Some(MarkerMotion {
                    magenta: motion(magenta),
                    yellow: motion(yellow),
                })
            })
            .collect();
        let numbers: [f64; Departure::NUMBERS] = sensor.common.try_into().ok()?;
        let optics = self.optics.misaligned(sensor.misalignments).ok()?;
        let optics = optics.departed(&Departure::of(numbers)).ok()?;
        let seen = optics.projected(&motions).ok()?;
        Some(
            seen.iter()
                .map(|seen| Some(picture(seen.as_ref()?)))
                .collect(),
        )
    }
}

fn picture(seen: &SeenMarker) -> [f64; 4] {
    let [x, y] = seen.centroid_px;
    [x, y, seen.hue_turns, libm::log(seen.size_px2)]
}

/// A marker as it was seen, as a fit of pictures takes it.
pub(super) fn seen(spotted: &Spotted) -> Seen {
    seen_of(&spotted.marker, &spotted.errors)
}

/// A marker with its errors, as a fit of pictures takes it.
pub(crate) fn seen_of(marker: &Marker, errors: &MarkerErrors) -> Seen {
    let [x, y] = marker.centroid_px;
    Seen {
        picture: [x, y, marker.hue_turns, libm::log(marker.size_px2)],
        covariance: Matrix4::from_fn(|row, column| errors.covariance[row][column]),
    }
}
