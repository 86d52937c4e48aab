//! Markers in the image, without pixels.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::array::{MarkerSight, Sight};
use super::camera::{Local, Region, cap};
use super::colours::Contrasts;
use super::overlap::{Overlap, overlap};
use super::{Camera, MarkerMotion, Optics, OpticsError, SeenMarker};

impl Optics {
    /// Each marker as its picture has it, in the order of the markers: the limit of what a frame without blemishes
    /// shows as its pixels get smaller. `None` for markers that have no motion (they are not there), that are not all in
    /// the image circle, or whose discs take no light.
    ///
    /// The image of each disc, and of what two discs share, is known to second order in the angular radius α of a disc;
    /// what is left out is a share of the order of α⁴ of size and hue, and α⁴ of the radius of the centroid.
    ///
    /// # Errors
    /// [`OpticsError::WrongCount`] unless there is one motion per marker; [`OpticsError::ImpossibleMotion`] for one
    /// that is not shorter than its disc's distance from the centre.
    pub fn projected(
        &self,
        motions: &[Option<MarkerMotion>],
    ) -> Result<Vec<Option<SeenMarker>>, OpticsError> {
        let seen = self.sights(motions)?.map(|sight| {
            let seen = |sight| seen(&self.camera, &self.contrasts, &sight);
            sight.map(|sight| sight.and_then(seen))
        });
        seen.collect()
    }
}

/// A direction in the camera's polar coordinates, and the lens there.
struct Aim {
    polar: f64,
    sine: f64,
    cosine: f64,
    /// Cosine and sine of the azimuth.
    azimuth: [f64; 2],
    local: Local,
}

impl Aim {
    #[inline]
    fn new(camera: &Camera, direction: &Vector3<f64>) -> Self {
        let sine = (direction.x * direction.x + direction.y * direction.y).sqrt();
        let cosine = direction.z;
        let polar = sine.atan2(cosine);
        let azimuth = if sine > 0.0 {
            [direction.x / sine, direction.y / sine]
        } else {
            [1.0, 0.0]
        };
        Self {
            polar,
            sine,
            cosine,
            azimuth,
            local: Local::new(camera, polar, (sine, cosine)),
        }
    }

    /// Components of a tangent vector: away from the axis, and around it.
    #[inline]
    fn components(&self, tangent: &Vector3<f64>) -> [f64; 2] {
        let [x, y] = self.azimuth;
        [
            (tangent.x * x + tangent.y * y) * self.cosine - tangent.z * self.sine,
            tangent.y * x - tangent.x * y,
        ]
    }

    /// Whether all of a disc that is looked at is in the image circle.
    #[inline]
    fn holds(&self, camera: &Camera, disc: &Sight) -> bool {
        if self.polar > camera.rim_rad {
            return false;
        }
        // The disc's far edge, at the sum of the angles, is neither beyond the rim nor beyond half a turn.
        let (edge_sine, edge_cosine) = (
            self.sine * disc.cosine + self.cosine * disc.sine,
            self.cosine * disc.cosine - self.sine * disc.sine,
        );
        edge_sine > 0.0 && edge_cosine >= camera.rim_rad.cos()
    }
}

/// Area, px², and first moment about the image's centre, px³, x to the right and y down.
#[derive(Clone, Copy, Default)]
struct Image {
    area: f64,
    moment: [f64; 2],
}

impl Image {
    /// A region that was looked at.
    #[inline]
    fn of(aim: &Aim, region: &Region) -> Self {
        let [x, y] = aim.azimuth;
        let outward = region.area * aim.local.radius + region.moment[0];
        let around = region.moment[1];
        Self {
            area: region.area,
            moment: [outward * x - around * y, -outward * y - around * x],
        }
    }
}

#[inline]
fn seen(camera: &Camera, contrasts: &Contrasts, sight: &MarkerSight) -> Option<SeenMarker> {
    let MarkerSight { magenta, yellow } = sight;
    let aims = [magenta, yellow].map(|disc| Aim::new(camera, &disc.direction));
    let in_image = aims[0].holds(camera, magenta) && aims[1].holds(camera, yellow);
    if !in_image {
        return None;
    }
    let caps = [(&aims[0], magenta), (&aims[1], yellow)]
        .map(|(aim, disc)| Image::of(aim, &cap(&aim.local, disc.sine, disc.cosine)));
    let shared = match overlap(magenta, yellow) {
        Overlap::None => Image::default(),
        Overlap::AllOfMagenta => caps[0],
        Overlap::AllOfYellow => caps[1],
        Overlap::Part(part) => {
            let aim = Aim::new(camera, &part.direction);
            let axis = aim.components(&part.axis);
            Image::of(&aim, &part.seen(&aim.local, axis))
        }
    };
    features(camera, contrasts, caps, shared)
}

/// From the images of both discs and of what they share to what is seen.
#[inline]
fn features(
    camera: &Camera,
    contrasts: &Contrasts,
    [magenta, yellow]: [Image; 2],
    shared: Image,
) -> Option<SeenMarker> {
    let regions = [
        (&contrasts.magenta, magenta, -1.0),
        (&contrasts.yellow, yellow, -1.0),
        (&contrasts.overlap, shared, 0.0),
    ];
    let (mut size, mut moment, mut chroma) = (0.0, [0.0; 2], [0.0; 2]);
    for (contrast, image, without) in regions {
        let area = image.area + without * shared.area;
        size += contrast.taken * area;
        for axis in 0..2 {
            moment[axis] += contrast.taken * (image.moment[axis] + without * shared.moment[axis]);
            chroma[axis] += contrast.chroma[axis] * area;
        }
    }
    let is_seen = size > 0.0;
    if !is_seen {
        return None;
    }
    let centre = camera.centre_px();
    let turns = chroma[1].atan2(chroma[0]) / TAU;
    Some(SeenMarker {
        centroid_px: [0, 1].map(|axis| centre[axis] + moment[axis] / size),
        hue_turns: if turns < 0.0 {
            (turns + 1.0).min(BELOW_ONE)
        } else {
            turns
        },
        size_px2: size,
    })
}

/// The largest number of turns that is not a whole one.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
