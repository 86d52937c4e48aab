//! Computes the features of the markers in the image without rendering pixels.

use nalgebra::Vector3;

use palpate_statistics::hue_turns;

use super::array::{MarkerSight, Sight};
use super::colours::Contrasts;
use super::lens::{Local, Region, cap};
use super::overlap::{HalfAngle, Overlap, overlap};
use super::sines::small_angle;
use super::{Camera, MarkerMotion, Optics, OpticsError, SeenMarker};

impl Optics {
    /// Features (centroid, hues and size) of each marker in the image, in the order of the markers. They equal the
    /// features in a frame with very small pixels and without blur, uneven light, seams or noise. The features are
    /// `None` in three cases: the marker is missing (its motion is `None`), it is not completely in the image circle,
    /// or it absorbs no light.
    ///
    /// The image of each disc has the accuracy of [`Camera::disc_area`]. The overlap of two discs is computed to second
    /// order in their angular radius α. The error of the size is of the order of α⁴ relative to the size. The error of
    /// the centroid is of the order of α⁴ relative to the focal length. For the markers of the 2020 paper up to 60°
    /// from the apex, the errors are small: less than 0.004 px for the centroid in a frame of 2048 px, 2e-5 turns for
    /// the hue, and 2e-4 for the relative size. For a pinhole, the errors are larger.
    ///
    /// # Errors
    /// [`OpticsError::WrongCount`] unless there is one motion per marker. [`OpticsError::ImpossibleMotion`] for a
    /// motion that is at least as long as the distance of its disc from the centre.
    pub fn project(
        &self,
        motions: &[Option<MarkerMotion>],
    ) -> Result<Vec<Option<SeenMarker>>, OpticsError> {
        palpate_statistics::work::projected(motions.len() as u64);
        let mut all = Vec::with_capacity(motions.len());
        for sight in self.sights(motions)? {
            let features = |sight| {
                MarkerProjection::new(&self.camera, &sight)?.features(&self.camera, &self.contrasts)
            };
            all.push(sight?.and_then(features));
        }
        Ok(all)
    }
}

/// A direction in the polar coordinates of the camera, and the Taylor expansion of the lens's map at this direction.
#[derive(Clone, Copy)]
pub(super) struct Aim {
    polar: f64,
    sine: f64,
    cosine: f64,
    azimuth: [f64; 2],
    local: Local,
}

impl Aim {
    #[inline]
    fn new(camera: &Camera, direction: &Vector3<f64>) -> Self {
        Self::at(camera, direction, libm::atan2)
    }

    /// Computes the same as [`Self::new`] for `direction`. This function is faster than `new` if `direction` is near
    /// the direction of `self`, because it starts from `self`.
    #[inline]
    fn beside(&self, camera: &Camera, direction: &Vector3<f64>) -> Self {
        Self::at(camera, direction, |sine, cosine| {
            // `step` is the sine of the difference between the polar angles of `direction` and of `self`. Both polar
            // angles are between 0 and half a turn.
            let step = sine * self.cosine - cosine * self.sine;
            let near = step.abs() < 0.1 && sine * self.sine + cosine * self.cosine > 0.0;
            if near {
                self.polar + small_angle(step)
            } else {
                libm::atan2(sine, cosine)
            }
        })
    }

    #[inline]
    fn at(camera: &Camera, direction: &Vector3<f64>, polar: impl FnOnce(f64, f64) -> f64) -> Self {
        let sine = (direction.x * direction.x + direction.y * direction.y).sqrt();
        let cosine = direction.z;
        let polar = polar(sine, cosine).max(0.0);
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
            local: camera.local_at(polar, (sine, cosine)),
        }
    }

    /// Components of `tangent`, a tangent vector of the sphere of directions. The first component is away from the
    /// camera's axis, the second in the azimuthal direction.
    #[inline]
    fn components(&self, tangent: &Vector3<f64>) -> [f64; 2] {
        let [x, y] = self.azimuth;
        [
            (tangent.x * x + tangent.y * y) * self.cosine - tangent.z * self.sine,
            tangent.y * x - tangent.x * y,
        ]
    }

    /// Whether a disc whose middle is in the direction of `self` is completely in the image circle.
    #[inline]
    fn holds(&self, camera: &Camera, disc: &Sight) -> bool {
        if self.polar > camera.rim_rad {
            return false;
        }
        // The far edge of the disc is at the polar angle of the disc's middle plus its angular radius. This sum must be
        // at most half a turn, and at most the polar angle of the rim.
        let (edge_sine, edge_cosine) = (
            self.sine * disc.cosine + self.cosine * disc.sine,
            self.cosine * disc.cosine - self.sine * disc.sine,
        );
        edge_sine > 0.0 && edge_cosine >= camera.rim_cosine
    }
}

/// A region of the image: its area, px², and its first moment about the image's centre, px³. The components of the
/// moment are along the columns (to the right) and along the rows (down).
#[derive(Clone, Copy, Default)]
struct Image {
    area: f64,
    moment: [f64; 2],
}

impl Image {
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

pub(super) struct MarkerProjection {
    aims: [Aim; 2],
    discs: [Image; 2],
    shared: Image,
    angles: Option<[HalfAngle; 2]>,
}

impl MarkerProjection {
    /// Images of the discs of a marker; `None` if a part of the marker is outside of the image circle.
    #[inline(always)]
    pub(super) fn new(camera: &Camera, sight: &MarkerSight) -> Option<Self> {
        let MarkerSight { magenta, yellow } = sight;
        let aim = Aim::new(camera, &magenta.direction);
        let beside = aim.beside(camera, &yellow.direction);
        let in_image = aim.holds(camera, magenta) && beside.holds(camera, yellow);
        if !in_image {
            return None;
        }
        let discs =
            [(&aim, magenta), (&beside, yellow)].map(|(aim, disc)| image(camera, aim, disc));
        let (shared, angles) = shared(camera, &aim, discs, sight, None);
        Some(Self {
            aims: [aim, beside],
            discs,
            shared,
            angles,
        })
    }

    /// Projects the marker `sight`, starting from this projection of a nearly equal marker. The two markers differ by a
    /// small change of the disc `disc`: 0 is the magenta disc, 1 the yellow disc.
    #[inline]
    pub(super) fn beside(&self, camera: &Camera, sight: &MarkerSight, disc: usize) -> Self {
        let changed = [&sight.magenta, &sight.yellow][disc];
        let (mut aims, mut discs) = (self.aims, self.discs);
        aims[disc] = aims[disc].beside(camera, &changed.direction);
        discs[disc] = image(camera, &aims[disc], changed);
        let (shared, angles) = shared(camera, &aims[0], discs, sight, self.angles.as_ref());
        Self {
            aims,
            discs,
            shared,
            angles,
        }
    }

    #[inline(always)]
    pub(super) fn features(&self, camera: &Camera, contrasts: &Contrasts) -> Option<SeenMarker> {
        features(camera, contrasts, self.discs, self.shared)
    }
}

#[inline(always)]
fn image(camera: &Camera, aim: &Aim, disc: &Sight) -> Image {
    Image::of(aim, &cap(camera.lens, &aim.local, disc.sine, disc.cosine))
}

/// Image of the overlap of a marker's discs, and the half-angles of the overlap's two segments. The half-angles are
/// `None` unless the edges of the discs cross. `aim` is a direction near the overlap, and `near` contains the
/// half-angles of a similar overlap.
#[inline(always)]
fn shared(
    camera: &Camera,
    aim: &Aim,
    discs: [Image; 2],
    sight: &MarkerSight,
    near: Option<&[HalfAngle; 2]>,
) -> (Image, Option<[HalfAngle; 2]>) {
    match overlap(&sight.magenta, &sight.yellow, near) {
        Overlap::None => (Image::default(), None),
        Overlap::AllOfMagenta => (discs[0], None),
        Overlap::AllOfYellow => (discs[1], None),
        Overlap::Part(part) => {
            let between = aim.beside(camera, &part.direction);
            let axis = between.components(&part.axis);
            let image = Image::of(&between, &part.seen(&between.local, axis));
            (image, Some(part.angles))
        }
    }
}

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
    let (mut hued_area, mut hue_sum) = (0.0, 0.0);
    for (contrast, image, without) in regions {
        let area = image.area + without * shared.area;
        size += contrast.absorbed * area;
        if let Some(hue) = contrast.hue_turns {
            hued_area += area;
            hue_sum += hue * area;
        }
        for axis in 0..2 {
            moment[axis] +=
                contrast.absorbed * (image.moment[axis] + without * shared.moment[axis]);
            chroma[axis] += contrast.chroma[axis] * area;
        }
    }
    let is_seen = size > 0.0;
    if !is_seen {
        return None;
    }
    let centre = camera.centre_px();
    let hue_turns = hue(chroma);
    Some(SeenMarker {
        centroid_px: [0, 1].map(|axis| centre[axis] + moment[axis] / size),
        hue_turns,
        mean_hue_turns: if hued_area > 0.0 {
            hue_sum / hued_area
        } else {
            hue_turns
        },
        size_px2: size,
    })
}

/// HSV hue of a colour, in turns, from its chroma `[R - (G + B)/2, √3/2 (G - B)]`. The HSV hue follows a hexagon, so it
/// is not the angle of the chroma vector.
fn hue([along, across]: [f64; 2]) -> f64 {
    let half_difference = across / 3.0_f64.sqrt();
    let (red, grey) = (along / 1.5, -along / 3.0);
    let (green, blue) = (grey + half_difference, grey - half_difference);
    hue_turns([red, green, blue])
}
