//! Images of the markers in a camera at or near the centre of the sensor. The module computes the features of each
//! marker, or renders frames of pixels.

mod array;
mod camera;
mod colours;
mod departure;
mod error;
mod lens;
mod odd_terms;
mod overlap;
mod pose;
mod projection;
mod rendering;
mod sight_slopes;
mod sines;
mod slopes;

pub use array::{DiscDepths, DiscMotion, MarkerArray, MarkerMotion};
pub use camera::Camera;
pub use colours::Colours;
pub use departure::Departure;
pub use error::OpticsError;
pub use lens::Lens;
pub use odd_terms::OddTerms;
pub use pose::Pose;
pub use rendering::{Blemishes, Seams};
pub use slopes::MarkerSlopes;

use array::MarkerSight;
use colours::Contrasts;

/// The markers of a sensor and the camera that observes them.
///
/// ```
/// use palpate_chromatouch::{
///     Blemishes, Camera, Colours, DiscDepths, Discs, Layout, Lens, MarkerArray, MarkerMotion, Optics,
/// };
///
/// let places = Layout::published().places(20.0)?;
/// let discs = Discs { magenta: 2.0, yellow: 2.0 };
/// let depths = DiscDepths { magenta: 3.0, yellow: 1.0 };
/// let array = MarkerArray::new(20.0, &places, discs, depths)?;
/// let camera = Camera::new(Lens::Fisheye, 640, 70.0)?;
/// let optics = Optics::new(array, camera, Colours::default(), Blemishes::default())?;
/// // At rest the first marker, at the apex, is in the centre of the image.
/// let markers = optics.project(&[Some(MarkerMotion::default()); 77])?;
/// let apex = markers[0].ok_or("outside the image circle")?;
/// assert!(apex.centroid_px.iter().all(|place| (*place - 319.5).abs() < 1e-9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Optics {
    array: MarkerArray,
    camera: Camera,
    colours: Colours,
    blemishes: Blemishes,
    contrasts: Contrasts,
    /// Pose of the camera; `None` if the camera is exactly in the sensor's centre and its axis passes through the apex.
    pose: Option<Pose>,
}

/// The features (centroid, hues and size) of a marker in an ideal image, without blur, uneven light, seams or noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenMarker {
    /// Centroid of the marker's image, px. Each point of the image has the same weight as in `size_px2`: the share of
    /// green light that the marker absorbs there, plus the share of blue light.
    pub centroid_px: [f64; 2],
    /// HSV hue of the marker's total light, in turns, from 0 (red) to below 1. The total light is the sum over all
    /// points of the marker's image. The hue is 0 if the total light has no colour (red, green and blue are equal).
    pub hue_turns: f64,
    /// Mean of the HSV hue over the area of the marker's image, in turns. The mean is arithmetic, not cyclic, although
    /// the hues 0 and 1 are both red. Pale regions, whose saturation is at most 1/4, do not count. If all regions are
    /// pale, the value is `hue_turns`.
    pub mean_hue_turns: f64,
    /// Size of the marker's image, px². Each point of the image counts with a weight: the share of green light that the
    /// marker absorbs there, plus the share of blue light. Both shares are relative to the light of the white layer.
    /// The size is the integral of the weight over the image. For example, a disc that absorbs all green light and no
    /// blue light contributes its area.
    pub size_px2: f64,
}

impl Optics {
    /// A sensor with the markers `array`, the camera, the colours of the sensor's parts, and the imperfections
    /// `blemishes` of the image.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] if a colour, `light_at_rim`, `blur_px`, `gores`, `seam_width` or `pixel_std` is out
    /// of its range. The range of colours is from 0 to 1.
    pub fn new(
        array: MarkerArray,
        camera: Camera,
        colours: Colours,
        blemishes: Blemishes,
    ) -> Result<Self, OpticsError> {
        Ok(Self {
            array,
            camera,
            colours: colours.checked()?,
            blemishes: blemishes.checked()?,
            contrasts: colours.contrasts(),
            pose: None,
        })
    }

    /// Returns these optics with the camera in the pose `pose`. The camera need not be in the sensor's centre. The
    /// image of a disc is approximated by the image of a circular cap with the same solid angle. This approximation is
    /// correct to first order in the solid angle. The seams of the skin and the uneven light of the image are computed
    /// as if the camera were at the sensor's centre.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `place` if the camera is too far from the centre of the sensor. The limit is 0.9
    /// times the distance of the nearest disc from the centre. [`OpticsError::BadSetting`] for `turn_rad` unless each
    /// component of the rotation vector is from -1 to 1.
    pub fn seen_from(mut self, pose: Pose) -> Result<Self, OpticsError> {
        self.pose = pose.checked(0.9 * self.array.nearest())?;
        Ok(self)
    }

    /// Pose of the camera relative to the sensor's centre.
    pub fn pose(&self) -> Pose {
        self.pose.unwrap_or_default()
    }

    /// The camera of these optics.
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The markers of the sensor.
    pub const fn array(&self) -> &MarkerArray {
        &self.array
    }

    /// For each marker after its motion, the direction and the angular radius of both discs, as viewed from the camera;
    /// `None` for a missing marker.
    fn sights<'a>(
        &'a self,
        motions: &'a [Option<MarkerMotion>],
    ) -> Result<impl Iterator<Item = Result<Option<MarkerSight>, OpticsError>> + 'a, OpticsError>
    {
        if motions.len() != self.array.places().len() {
            return Err(OpticsError::WrongCount {
                motions: motions.len(),
                markers: self.array.places().len(),
            });
        }
        let motions = motions.iter().enumerate();
        Ok(motions.map(|(marker, motion)| {
            let pose = self.pose.as_ref();
            let sight = motion.map(|motion| self.array.sight(marker, &motion, pose));
            sight.transpose()
        }))
    }
}
