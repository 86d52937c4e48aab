//! Pictures of the markers by a camera in the sensor's centre or near it: with and without pixels.

mod array;
mod blemishes;
mod camera;
mod colours;
mod departed;
mod departure;
mod error;
mod lens;
mod odd_terms;
mod overlap;
mod pose;
mod projected;
mod rendered;
mod sight_slopes;
mod sines;
mod slopes;

pub use array::{DiscDepths, DiscMotion, MarkerArray, MarkerMotion};
pub use blemishes::{Blemishes, Seams};
pub use camera::{Camera, LARGEST_FRAME};
pub use colours::Colours;
pub use departure::Departure;
pub use error::OpticsError;
pub use lens::Lens;
pub use odd_terms::OddTerms;
pub use pose::Pose;
pub use slopes::MarkerSlopes;

use array::MarkerSight;
use colours::Contrasts;

/// A sensor's markers and the camera that looks at them.
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
/// // At rest the first marker, at the apex, is seen in the image's centre.
/// let seen = optics.projected(&[Some(MarkerMotion::default()); 77])?;
/// let apex = seen[0].ok_or("outside the image circle")?;
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
    /// Stand of the camera; `None` in the very centre, looking at the apex.
    pose: Option<Pose>,
}

/// A marker in the image of a sensor without blemishes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenMarker {
    /// Centroid of the image with the weights of `size_px2`, px.
    pub centroid_px: [f64; 2],
    /// Mean hue in turns, from 0 (red) to below 1: the hue, as HSV has it, of the light of the image summed, so that each
    /// place counts with its chroma. 0 where there is none.
    pub hue_turns: f64,
    /// The shares of the white layer's green and of its blue light that the marker takes, summed over its image, px²:
    /// a disc that takes all of one of them counts with its area.
    pub size_px2: f64,
}

impl Optics {
    /// Optics of these markers before a camera, with the colours of the sensor's parts and the blemishes of the
    /// picture.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for a colour that is not a share, `light_at_rim`, `blur_px`, `gores`, `seam_width`
    /// or `pixel_std`.
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

    /// Optics of these markers before a camera that stands elsewhere or looks elsewhere. Discs are then seen as circular caps
    /// of the solid angle that they fill, to first order in it; seams and the fall of light stay as seen from the centre.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `place` unless the camera stands nearer to the sensor's centre than 0.9 times the
    /// nearest disc, and for `turn_rad` unless each part is from -1 to 1.
    pub fn seen_from(mut self, pose: Pose) -> Result<Self, OpticsError> {
        self.pose = pose.checked(0.9 * self.array.nearest())?;
        Ok(self)
    }

    /// Stand of the camera.
    pub fn pose(&self) -> Pose {
        self.pose.unwrap_or_default()
    }

    /// The camera.
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The blemishes of the picture.
    pub const fn blemishes(&self) -> &Blemishes {
        &self.blemishes
    }

    /// The markers as they were made.
    pub const fn array(&self) -> &MarkerArray {
        &self.array
    }

    /// How each marker is seen from the centre after its motion; `None` for one that is not there.
    fn sights<'a>(
        &'a self,
        motions: &'a [Option<MarkerMotion>],
    ) -> Result<impl Iterator<Item = Result<Option<MarkerSight>, OpticsError>> + 'a, OpticsError>
    {
        if motions.len() != self.array.len() {
            return Err(OpticsError::WrongCount {
                motions: motions.len(),
                markers: self.array.len(),
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
