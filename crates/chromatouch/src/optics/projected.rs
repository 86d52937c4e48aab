//! Markers in the image, without pixels.

use nalgebra::Vector3;

use palpate_statistics::hue_turns;

use super::array::{MarkerSight, Sight};
use super::colours::Contrasts;
use super::lens::{Local, Region, cap};
use super::overlap::{HalfAngle, Overlap, overlap};
use super::sines::small_angle;
use super::{Camera, MarkerMotion, Optics, OpticsError, SeenMarker};

impl Optics {
    /// Each marker as its picture has it, in the order of the markers: the limit of what a frame without blemishes
    /// shows as its pixels get smaller. `None` for markers that have no motion (they are not there), that are not all in
    /// the image circle, or whose discs take no light.
    ///
    /// The image of each disc is known as [`Camera::disc_area`] tells, that of what two discs share to second order in
    /// their angular radius α: what is left out is of the order of α⁴ of the size, and of the focal length in the
    /// centroid. Of the published markers, at most 60° from the apex, it is less than 0.004 px of 2048, 2e-5 turns and
    /// 2e-4 of the size; a pinhole magnifies it.
    ///
    /// # Errors
    /// [`OpticsError::WrongCount`] unless there is one motion per marker; [`OpticsError::ImpossibleMotion`] for one
    /// that is not shorter than its disc's distance from the centre.
    pub fn projected(
        &self,
        motions: &[Option<MarkerMotion>],
    ) -> Result<Vec<Option<SeenMarker>>, OpticsError> {
        palpate_statistics::work::projected(motions.len() as u64);
        let mut all = Vec::with_capacity(motions.len());
        for sight in self.sights(motions)? {
            let seen = |sight| seen(&self.camera, &self.contrasts, &sight);
            all.push(sight?.and_then(seen));
        }
        Ok(all)
    }
}

/// A direction in the camera's polar coordinates, and the lens there.
#[derive(Clone, Copy)]
pub(super) struct Aim {
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
        Self::at(camera, direction, libm::atan2)
    }

    /// Aim at another direction, which is likely near to this one.
    #[inline]
    fn beside(&self, camera: &Camera, direction: &Vector3<f64>) -> Self {
        Self::at(camera, direction, |sine, cosine| {
            // Sine of the difference of the polar angles, which are at most half a turn.
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
        edge_sine > 0.0 && edge_cosine >= camera.rim_cosine
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
    Glimpse::new(camera, sight)?.features(camera, contrasts)
}

/// Images of both discs of a marker and of what they share.
pub(super) struct Glimpse {
    aims: [Aim; 2],
    discs: [Image; 2],
    shared: Image,
    /// Half-angles of what they share, where they share a part.
    angles: Option<[HalfAngle; 2]>,
}

impl Glimpse {
    /// A marker that is looked at; `None` unless it is all in the image circle.
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

    /// The marker with one disc seen a little otherwise, the magenta one (0) or the yellow one (1).
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

    /// Size, centroid and hue of the marker in these colours.
    #[inline(always)]
    pub(super) fn features(&self, camera: &Camera, contrasts: &Contrasts) -> Option<SeenMarker> {
        features(camera, contrasts, self.discs, self.shared)
    }
}

#[inline(always)]
fn image(camera: &Camera, aim: &Aim, disc: &Sight) -> Image {
    Image::of(aim, &cap(camera.lens, &aim.local, disc.sine, disc.cosine))
}

/// Image of what the discs of a marker share, near which `aim` looks, and its half-angles where it is a part of either; `near`
/// are those of a marker that is likely near.
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

/// Size, centroid and hue of a marker, from the images of both discs and of their overlap.
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
    Some(SeenMarker {
        centroid_px: [0, 1].map(|axis| centre[axis] + moment[axis] / size),
        hue_turns: hue(chroma),
        size_px2: size,
    })
}

/// The hue of a chroma `[R - (G + B)/2, √3/2 (G - B)]`, in turns as HSV has it: hexagonal, not an angle.
fn hue([along, across]: [f64; 2]) -> f64 {
    let half_difference = across / 3.0_f64.sqrt();
    let (red, grey) = (along / 1.5, -along / 3.0);
    let (green, blue) = (grey + half_difference, grey - half_difference);
    hue_turns([red, green, blue])
}
