//! The pixels that a marker covers, and the covered share of each pixel.

use std::ops::Range;

use super::super::Camera;
use super::super::array::{MarkerSight, Sight};
use super::super::camera::Ray;

/// Half the diagonal of a pixel, px. The edge of a disc that crosses a pixel is at most this far from the pixel's
/// centre.
const HALF_DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Number of neighbouring pixels in a row that are computed together, so that the compiler can use vector instructions.
const RUN: usize = 8;

pub(super) struct MarkerRaster {
    pub(super) rows: Range<usize>,
    pub(super) columns: Range<usize>,
    magenta: DiscRaster,
    yellow: DiscRaster,
}

struct DiscRaster {
    direction: [f64; 3],
    cosine: f64,
    per_sine: f64,
    /// Upper bound of |v·n − cos α| for pixels that the edge of the disc crosses. Here v is the direction of the pixel,
    /// n the direction of the disc's middle, and α the angular radius of the disc.
    band: f64,
    /// Factor on the share of light that the disc absorbs. It is below 1 for a disc that is smaller than a pixel, so
    /// that the disc is drawn fainter.
    opacity: f64,
    /// Whether the disc is so small that its edge cannot be approximated by a straight line within a pixel.
    is_small: bool,
}

pub(super) struct Cover {
    pub(super) magenta: f64,
    pub(super) yellow: f64,
    pub(super) both: f64,
}

/// Share of a pixel that a disc covers. If the edge of the disc crosses the pixel, `toward` is an image vector from the
/// pixel towards the disc; only its direction has a meaning. Its first component is radial (outward from the image's
/// centre), and its second component is azimuthal.
struct DiscCover {
    share: f64,
    toward: Option<[f64; 2]>,
}

/// Columns and rows of a rectangle of pixels that contains the image of a disc.
fn pixels(camera: &Camera, disc: &Sight) -> Option<[Range<usize>; 2]> {
    let direction = &disc.direction;
    let polar = libm::atan2(libm::hypot(direction.x, direction.y), direction.z);
    let radius = libm::atan2(disc.sine, disc.cosine);
    let rim = camera.rim_rad;
    if polar - radius > rim * (1.0 + 1e-9) {
        return None;
    }
    let size = f64::from(camera.size_px());
    // The rectangle's centre is the image of a point C. C is the disc's middle or, if the middle is outside of the
    // field of view, the nearest point of the rim. A path inside the field of view connects C with each visible point
    // of the disc, and is at most `reach` long. `reach` times the largest image scale bounds the distance in the image.
    // If the rim cuts the disc, the shortest path on the sphere is at most 2 radii long, but may leave the field of
    // view. A detour along the rim is at most π/2 times as long as the part that it replaces, so the path is shorter
    // than 4 radii.
    let crosses = polar + radius > rim;
    let reach = if crosses { 4.0 * radius } else { radius };
    let farthest = (polar + radius).min(rim);
    let half = reach * camera.most_px_per_rad(farthest) + 1.5;
    let [column, row] = camera.centre_px();
    let from_centre = camera.radius(polar.min(rim));
    let across = libm::hypot(direction.x, direction.y);
    let along = |component: f64| {
        if across > 0.0 {
            from_centre * (component / across)
        } else {
            from_centre
        }
    };
    let range = |middle: f64| {
        let clamped = |edge: f64| edge.clamp(0.0, size) as usize;
        clamped((middle - half).ceil())..clamped((middle + half).floor() + 1.0)
    };
    Some([
        range(column + along(direction.x)),
        range(row - along(direction.y)),
    ])
}

impl DiscRaster {
    fn new(camera: &Camera, disc: &Sight) -> Self {
        // `radius` is the radius, in px, of a circle with the same area as the disc's image.
        let radius = camera.local(&disc.direction).area.sqrt() * disc.sine;
        Self {
            direction: disc.direction.into(),
            cosine: disc.cosine,
            per_sine: 1.0 / disc.sine,
            band: HALF_DIAGONAL * disc.sine / camera.least_px_per_rad(),
            opacity: if radius < 1.0 {
                4.0 * radius / ((1.0 + radius) * (1.0 + radius))
            } else {
                1.0
            },
            is_small: radius < 2.0 * HALF_DIAGONAL,
        }
    }

    /// Position v·n − cos α of a direction v relative to the edge of the disc. Here n is the direction of the disc's
    /// middle, and α is the disc's angular radius. The value is positive inside the disc.
    #[inline]
    fn inside(&self, ray: &Ray, [x, y]: [f64; 2]) -> f64 {
        let [n_x, n_y, n_z] = self.direction;
        (n_x * x + n_y * y) * ray.lateral_rad + (n_z * ray.cosine - self.cosine)
    }

    /// Share of a pixel that the disc covers. The pixel is (x, y) px from the centre of the image. `inside` is the
    /// position of the pixel relative to the disc's edge, as computed by [`Self::inside`]. The shares of all pixels add
    /// up to the area of the disc, for two reasons: the share minus 1/2 is an odd function of `inside`, and the solid
    /// angle of a cap is a linear function of the cosine of its angular radius.
    #[inline]
    fn cover(&self, camera: &Camera, ray: &Ray, inside: f64, [x, y]: [f64; 2]) -> DiscCover {
        if inside.abs() >= self.band {
            return DiscCover {
                share: if inside > 0.0 { self.opacity } else { 0.0 },
                toward: None,
            };
        }
        let [n_x, n_y, n_z] = self.direction;
        let sine = length([x, y]) * ray.lateral_rad;
        let (outward, around) = if sine > 0.0 {
            let per_radius = ray.lateral_rad / sine;
            (
                (n_x * x + n_y * y) * per_radius * ray.cosine - n_z * sine,
                (n_y * x - n_x * y) * per_radius,
            )
        } else {
            (n_x, n_y)
        };
        let radial_rad = camera.radial_rad(ray);
        let toward = [outward * radial_rad, around * ray.lateral_rad];
        let slope = length([outward, around]);
        let rad_per_px = if slope > 0.0 {
            length(toward) / slope
        } else {
            radial_rad
        };
        let along = if self.is_small {
            [1.0, 0.0]
        } else {
            in_columns_and_rows(toward, [x, y])
        };
        let share = covered(inside * self.per_sine / rad_per_px, along);
        DiscCover {
            share: share * self.opacity,
            toward: Some(toward).filter(|_| share > 0.0 && share < 1.0),
        }
    }
}

impl MarkerRaster {
    pub(super) fn new(camera: &Camera, sight: &MarkerSight) -> Option<Self> {
        let boxes = [&sight.magenta, &sight.yellow].map(|disc| pixels(camera, disc));
        let union = |axis: usize| {
            let ranges = boxes.iter().flatten().map(|ranges| &ranges[axis]);
            let start = ranges.clone().map(|range| range.start).min()?;
            Some(start..ranges.map(|range| range.end).max()?)
        };
        Some(Self {
            rows: union(1)?,
            columns: union(0)?,
            magenta: DiscRaster::new(camera, &sight.magenta),
            yellow: DiscRaster::new(camera, &sight.yellow),
        })
    }

    /// Calls `paint` for each pixel of a row that the discs of the marker cover at least partly. `paint` receives the
    /// column and the covered shares of the pixel. Only pixels in the given range of columns are visited. The row is
    /// `y` px above the centre of the image, and this centre is in the column `middle`.
    pub(super) fn cover(
        &self,
        camera: &Camera,
        y: f64,
        middle: f64,
        within: &Range<usize>,
        mut paint: impl FnMut(usize, &Cover),
    ) {
        let end = self.columns.end.min(within.end);
        let mut start = self.columns.start.max(within.start);
        while start < end {
            let first = start as f64 - middle;
            let rays: [Ray; RUN] = camera.rays(first, y);
            let insides = |disc: &DiscRaster| -> [f64; RUN] {
                std::array::from_fn(|step| disc.inside(&rays[step], [first + step as f64, y]))
            };
            let (magenta, yellow) = (insides(&self.magenta), insides(&self.yellow));
            for step in 0..RUN.min(end - start) {
                let inside = [magenta[step], yellow[step]];
                if inside[0] <= -self.magenta.band && inside[1] <= -self.yellow.band {
                    continue;
                }
                let place = [first + step as f64, y];
                paint(
                    start + step,
                    &self.pixel(camera, &rays[step], inside, place),
                );
            }
            start += RUN;
        }
    }

    #[inline]
    fn pixel(&self, camera: &Camera, ray: &Ray, inside: [f64; 2], place: [f64; 2]) -> Cover {
        let magenta = self.magenta.cover(camera, ray, inside[0], place);
        let yellow = self.yellow.cover(camera, ray, inside[1], place);
        Cover {
            magenta: magenta.share,
            yellow: yellow.share,
            both: shared(&magenta, &yellow),
        }
    }
}

/// Converts a vector at the image point (x, y) to components along columns and rows. `outward` is the vector's
/// component away from the centre of the image, and `around` the azimuthal component. The length of the vector may
/// change.
#[inline]
fn in_columns_and_rows([outward, around]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    if x == 0.0 && y == 0.0 {
        return [outward, around];
    }
    [outward * x - around * y, outward * y + around * x]
}

/// Share of a pixel that lies on the inner side of a straight edge. `inside` is the distance (px) of the pixel's centre
/// from the edge, positive on the inner side. The vector (x, y) of any length is the normal of the edge along columns
/// and rows. A pixel collects the light of its whole area, which minimises the effect of the pixel grid on sums of
/// light and on first moments.
#[inline]
fn covered(inside: f64, [x, y]: [f64; 2]) -> f64 {
    let (x, y) = (x.abs(), y.abs());
    let per_length = (x * x + y * y).sqrt().recip();
    if !per_length.is_finite() {
        return (0.5 + inside).clamp(0.0, 1.0);
    }
    let (long, short) = (x.max(y) * per_length, x.min(y) * per_length);
    // The pixel is a unit square. `long` and `short` are the larger and the smaller component of the unit vector normal
    // to the edge of the disc. The covered share is the integral of the lengths of the chords, which are lines through
    // the pixel parallel to the edge. Chords within (`long` − `short`)/2 of the pixel's centre have the length 1 /
    // `long`. From there to the corner, the length decreases linearly to 0.
    let depth = inside.abs();
    let beyond = 0.5 * (long + short) - depth;
    let more = if beyond <= 0.0 {
        1.0
    } else if beyond >= short {
        0.5 + depth / long
    } else {
        1.0 - beyond * beyond / (2.0 * long * short)
    };
    if inside < 0.0 { 1.0 - more } else { more }
}

/// Length of a vector. The squared length must neither overflow nor underflow.
#[inline]
fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// Share of a pixel that both discs cover. If both edges cross the pixel, the share depends on the angle between the
/// edges. If both discs lie in the same direction from the pixel, the result is the smaller of their two shares. If the
/// discs lie in opposite directions, the result is the amount by which the sum of the two shares exceeds 1. If the
/// directions are at a right angle, the result is the product of the two shares.
#[inline]
fn shared(one: &DiscCover, other: &DiscCover) -> f64 {
    let product = one.share * other.share;
    let (Some(toward), Some(other_toward)) = (one.toward, other.toward) else {
        return product;
    };
    let dot = toward[0] * other_toward[0] + toward[1] * other_toward[1];
    let lengths = length(toward) * length(other_toward);
    if lengths <= 0.0 {
        return product;
    }
    let alike = dot / lengths;
    let extreme = if alike > 0.0 {
        one.share.min(other.share)
    } else {
        (one.share + other.share - 1.0).max(0.0)
    };
    product + alike.abs() * (extreme - product)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of a pixel that lies on the inner side of a straight edge, estimated by counting the points of a grid.
    /// `inside` is the distance (px) of the pixel's centre from the edge, positive on the inner side. `turn` is the
    /// direction (rad) of the edge's normal.
    fn counted(inside: f64, turn: f64) -> f64 {
        const SIDE: u32 = 400;
        let (sine, cosine) = libm::sincos(turn);
        let at = |step: u32| (f64::from(step) + 0.5) / f64::from(SIDE) - 0.5;
        let all = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (at(column), at(row))));
        let count = all.filter(|(x, y)| inside + x * cosine + y * sine > 0.0);
        count.count() as f64 / f64::from(SIDE * SIDE)
    }

    #[test]
    fn pixels_gather_the_light_of_their_square() {
        for turn in [0.0, 0.3, 0.785, 1.2, 2.0, 3.0, 4.4] {
            let (sine, cosine) = libm::sincos(turn);
            for inside in [-0.8, -0.69, -0.5, -0.2, 0.0, 0.1, 0.45, 0.6, 0.71] {
                let share = covered(inside, [3.0 * cosine, 3.0 * sine]);
                let counted = counted(inside, turn);
                assert!(
                    (share - counted).abs() < 4e-3,
                    "{inside} {turn}: {share} {counted}"
                );
            }
        }
        assert_eq!(covered(0.25, [0.0, 0.0]), 0.75);
    }

    #[test]
    fn directions_turn_with_the_place() {
        // For a point to the left of the centre, outward is towards smaller columns, and increasing azimuth is
        // downward.
        assert_eq!(in_columns_and_rows([1.0, 0.0], [-2.0, 0.0]), [-2.0, 0.0]);
        assert_eq!(in_columns_and_rows([0.0, 1.0], [-2.0, 0.0]), [0.0, -2.0]);
        assert_eq!(in_columns_and_rows([0.5, 0.2], [0.0, 0.0]), [0.5, 0.2]);
    }
}
