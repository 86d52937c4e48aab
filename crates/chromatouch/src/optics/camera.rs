//! The camera in the sensor's centre, which points to the apex.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use super::lens::{Lens, Local, cap};
use super::sines::sinc_and_cosine;
use super::{OddTerms, OpticsError};

const LARGEST_FRAME: u32 = 8192;

/// A camera in the sensor's centre that points to the apex and has a square image.
///
/// Image coordinates are (column, row), px, with (0, 0) in the middle of the first pixel. Columns count to the right,
/// along the sensor's x axis. Rows count downward, against the sensor's y axis.
///
/// ```
/// use nalgebra::Vector3;
/// use palpate_chromatouch::{Camera, Lens};
///
/// // The rim, 320 px from the image's centre, is 70° from the apex. With r = f θ, 35° is half-way to the rim.
/// let camera = Camera::new(Lens::Fisheye, 640, 70.0)?;
/// let (sine, cosine) = libm::sincos(35.0_f64.to_radians());
/// let place = camera.image(&Vector3::new(sine, 0.0, cosine)).ok_or("outside the image circle")?;
/// assert!((place[0] - (319.5 + 160.0)).abs() < 1e-9);
/// assert!((place[1] - 319.5).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub(super) lens: Lens,
    size_px: u32,
    pub(super) rim_rad: f64,
    pub(super) rim_cosine: f64,
    pub(super) px_per_rad: f64,
    /// Offset (px) of the image circle's centre from the middle of the frame: columns to the right, and rows down.
    offset_px: [f64; 2],
}

/// Direction from which the light of a pixel comes. For a pixel at (x, y) px from the image's centre, with y up, this
/// direction is the unit vector (x · `lateral_rad`, y · `lateral_rad`, `cosine`).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ray {
    /// Angle (rad) that the pixel covers in the azimuthal direction. It is an arc on the unit sphere, not a difference
    /// of azimuths.
    pub(super) lateral_rad: f64,
    pub(super) cosine: f64,
}

impl Camera {
    /// A camera with a square image of `size_px` pixels a side. The image circle is the largest circle in the square.
    /// `field_deg` is the polar angle, measured from the apex, of the directions on the rim of this circle.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] if one of these settings is out of its range: `size_px` from 1 to 8192; `field_deg`
    /// from 1e-6 to 180 (for a pinhole, to 89.9999); `k3` and `k5` from -100 to 100. [`OpticsError::FoldedLens`] if the
    /// distance from the image's centre does not grow with the angle over the whole field.
    pub fn new(lens: Lens, size_px: u32, field_deg: f64) -> Result<Self, OpticsError> {
        let good = (1..=LARGEST_FRAME).contains(&size_px);
        OpticsError::unless(good, "size_px", f64::from(size_px), "from 1 to 8192")?;
        let (good, expected) = match lens {
            Lens::Fisheye | Lens::Odd(_) => (field_deg <= 180.0, "from 1e-6 to 180"),
            Lens::Pinhole => (field_deg <= 89.9999, "from 1e-6 to 89.9999"),
        };
        OpticsError::unless(good && field_deg >= 1e-6, "field_deg", field_deg, expected)?;
        let rim_rad = field_deg.to_radians();
        let rim = match lens {
            Lens::Fisheye => rim_rad,
            Lens::Odd(terms) => terms.checked(rim_rad)?.map(rim_rad),
            Lens::Pinhole => libm::tan(rim_rad),
        };
        Ok(Self {
            lens,
            size_px,
            rim_rad,
            rim_cosine: libm::cos(rim_rad),
            px_per_rad: 0.5 * f64::from(size_px) / rim,
            offset_px: [0.0; 2],
        })
    }

    /// Returns this camera with another centre of the image circle and another focal length `px_per_rad`. The centre is
    /// at the distance `offset_px` (columns to the right, rows down) from the middle of the frame. The radius of the
    /// circle in pixels does not change, so the rim is at another polar angle.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `centre_px` if the shifted centre lies outside of the frame.
    /// [`OpticsError::BadSetting`] for `px_per_rad` if the focal length is not positive and finite, or if the rim of
    /// the image circle would be more than 180° from the axis.
    pub fn adjusted(self, offset_px: [f64; 2], px_per_rad: f64) -> Result<Self, OpticsError> {
        for offset in offset_px {
            let good = offset.abs() <= self.rim_px();
            OpticsError::unless(good, "centre_px", offset, "within the frame")?;
        }
        let rim = self.rim_px() / px_per_rad;
        let rim_rad = match self.lens {
            Lens::Fisheye => rim,
            Lens::Odd(terms) => {
                let reach = terms.checked(0.0)?.reach();
                let is_seen = rim <= terms.map(reach);
                let good = px_per_rad.is_finite() && is_seen;
                OpticsError::unless(
                    good,
                    "px_per_rad",
                    px_per_rad,
                    "such that the image grows up to its rim with these k3 and k5",
                )?;
                terms.angle(rim, reach)
            }
            Lens::Pinhole => libm::atan(rim),
        };
        let good = px_per_rad.is_finite() && rim_rad > 0.0 && rim_rad <= PI;
        OpticsError::unless(
            good,
            "px_per_rad",
            px_per_rad,
            "such that the rim is from 0 to 180 degrees away",
        )?;
        Ok(Self {
            rim_rad,
            rim_cosine: libm::cos(rim_rad),
            px_per_rad,
            offset_px,
            ..self
        })
    }

    /// Returns this camera with other coefficients k3 and k5 of its fisheye lens. The radius of the image circle (px)
    /// and the focal length do not change, so the polar angle of the rim changes.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `k3` unless the lens is a fisheye, for `k3` and `k5` unless each is from -100 to
    /// 100, and for `px_per_rad` unless the distance from the image's centre increases with the angle up to the rim.
    pub(super) fn with_odd_terms(self, terms: OddTerms) -> Result<Self, OpticsError> {
        let is_fisheye = self.lens != Lens::Pinhole;
        OpticsError::unless(
            is_fisheye,
            "k3",
            terms.k3,
            "of a fisheye: a pinhole has no odd terms",
        )?;
        let other = Self {
            lens: Lens::from(terms),
            ..self
        };
        other.adjusted(self.offset_px, self.px_per_rad)
    }

    /// Odd terms of the lens: 0 for a fisheye without odd terms, `None` for other lenses.
    pub fn odd_terms(&self) -> Option<OddTerms> {
        self.lens.odd_terms()
    }

    /// Number of pixels along each side of the image.
    pub const fn size_px(&self) -> u32 {
        self.size_px
    }

    /// Focal length, px: the number of pixels per radian at the image's centre. For an equidistant fisheye, the radial
    /// scale is the same everywhere.
    pub const fn px_per_rad(&self) -> f64 {
        self.px_per_rad
    }

    /// Column and row (px) of the image circle's centre, which is on the camera's axis.
    pub fn centre_px(&self) -> [f64; 2] {
        let middle = 0.5 * (f64::from(self.size_px) - 1.0);
        self.offset_px.map(|offset| middle + offset)
    }

    /// Radius of the image circle, px.
    pub(crate) fn rim_px(&self) -> f64 {
        0.5 * f64::from(self.size_px)
    }

    /// Image coordinates (column, row) of a direction from the sensor's centre, px. The result is `None` outside the
    /// image circle. The length of the vector `direction` has no effect.
    pub fn image(&self, direction: &Vector3<f64>) -> Option<[f64; 2]> {
        let across = libm::hypot(direction.x, direction.y);
        let polar = libm::atan2(across, direction.z);
        let is_direction = direction.iter().all(|component| component.is_finite())
            && (across > 0.0 || direction.z != 0.0);
        if !is_direction || polar > self.rim_rad {
            return None;
        }
        let [column, row] = self.centre_px();
        let radius = self.radius(polar);
        let [x, y] = if across > 0.0 {
            [direction.x / across, direction.y / across]
        } else {
            [1.0, 0.0]
        };
        Some([column + radius * x, row - radius * y])
    }

    /// Image area of a disc, px². `angular_radius` is the angular radius of the disc, and `polar` is the polar angle of
    /// the disc's middle, both in rad. The result is `None` unless the whole disc is in the image circle and its
    /// angular radius is less than 90°.
    ///
    /// For a pinhole, the area is exact. For a fisheye, the scale of the lens is expanded to second order in the disc's
    /// angular radius α. The relative error is then of the order of α⁴. For α = 0.05 and up to 70° from the axis, it is
    /// below 1e-5.
    pub fn disc_area(&self, angular_radius: f64, polar: f64) -> Option<f64> {
        let good = angular_radius > 0.0
            && angular_radius < FRAC_PI_2
            && polar >= 0.0
            && polar + angular_radius <= self.rim_rad
            && polar + angular_radius < PI;
        if !good {
            return None;
        }
        let (sine, cosine) = libm::sincos(angular_radius);
        let local = self.local_at(polar, libm::sincos(polar));
        Some(cap(self.lens, &local, sine, cosine).area)
    }

    /// Distance (px) between the image's centre and the image of a direction with the polar angle `polar`.
    pub(super) fn radius(&self, polar: f64) -> f64 {
        match self.lens {
            Lens::Fisheye => self.px_per_rad * polar,
            Lens::Odd(terms) => self.px_per_rad * terms.map(polar),
            Lens::Pinhole => self.px_per_rad * libm::tan(polar),
        }
    }

    /// The lens's scale (px per rad) and the derivatives of this scale at the polar angle `polar` (rad).
    /// `sine_and_cosine` contains the sine and the cosine of `polar`.
    #[inline]
    pub(super) fn local_at(&self, polar: f64, sine_and_cosine: (f64, f64)) -> Local {
        Local::new(self.lens, self.px_per_rad, polar, sine_and_cosine)
    }

    /// The lens's scale (px per rad) and the derivatives of this scale at `direction` (a unit vector). For a direction
    /// beyond the rim of the image circle, the function returns the values at the rim.
    pub(super) fn local(&self, direction: &Vector3<f64>) -> Local {
        let polar = libm::atan2(libm::hypot(direction.x, direction.y), direction.z);
        let polar = polar.min(self.rim_rad).min(PI - 1e-6);
        self.local_at(polar, libm::sincos(polar))
    }

    /// Upper bound of the image scale (pixels per radian) at polar angles from 0 to `polar`. The bound is valid for the
    /// radial and for the azimuthal scale. All these polar angles must be in the field of view.
    pub(super) fn most_px_per_rad(&self, polar: f64) -> f64 {
        let (sine, cosine) = libm::sincos(polar);
        match self.lens {
            Lens::Fisheye if polar > 0.0 => self.px_per_rad * (polar / sine.max(0.0)),
            Lens::Fisheye => self.px_per_rad,
            Lens::Odd(terms) => {
                let around = if polar > 0.0 {
                    polar / sine.max(0.0)
                } else {
                    1.0
                };
                self.px_per_rad * terms.most_slope(polar) * around
            }
            Lens::Pinhole => self.px_per_rad / (cosine * cosine),
        }
    }

    /// Lower bound of the image scale (pixels per radian) in the field of view. The bound is valid for the radial and
    /// for the azimuthal scale.
    pub(super) fn least_px_per_rad(&self) -> f64 {
        match self.lens {
            Lens::Fisheye | Lens::Pinhole => self.px_per_rad,
            Lens::Odd(terms) => self.px_per_rad * terms.least_slope(self.rim_rad),
        }
    }

    /// Square of the polar angle (rad²) of an image point. `square` is (r/f)², where r is the distance of the point
    /// from the image's centre and f the focal length.
    #[inline]
    pub(super) fn polar_square(&self, square: f64) -> f64 {
        match self.lens {
            Lens::Fisheye => square,
            Lens::Odd(terms) => self.odd_polar_square(terms, square),
            Lens::Pinhole => libm::atan(square.sqrt()).powi(2),
        }
    }

    /// Direction of the light at the image point (x, y). The coordinates are px from the image's centre, with y up. The
    /// function is also valid for points a little beyond the image circle.
    #[inline]
    pub(super) fn ray(&self, x: f64, y: f64) -> Ray {
        let [ray] = self.rays(x, y);
        ray
    }

    /// Directions of the light at `N` neighbouring pixels of a row. The first pixel is at (x, y).
    #[inline]
    pub(super) fn rays<const N: usize>(&self, x: f64, y: f64) -> [Ray; N] {
        let rad_per_px = 1.0 / self.px_per_rad;
        let square = |step: usize| {
            let x = x + step as f64;
            (x * x + y * y) * (rad_per_px * rad_per_px)
        };
        match self.lens {
            Lens::Fisheye => std::array::from_fn(|step| {
                let (sinc, cosine) = sinc_and_cosine(square(step));
                Ray {
                    lateral_rad: sinc * rad_per_px,
                    cosine,
                }
            }),
            Lens::Odd(terms) => self.odd_rays(terms, std::array::from_fn(square)),
            Lens::Pinhole => std::array::from_fn(|step| {
                let cosine = 1.0 / (1.0 + square(step)).sqrt();
                Ray {
                    lateral_rad: cosine * rad_per_px,
                    cosine,
                }
            }),
        }
    }

    // Functions for lenses with odd terms are not inlined, so that the pixel loops of other lenses stay small.

    #[inline(never)]
    fn odd_polar_square(&self, terms: OddTerms, square: f64) -> f64 {
        terms.angle(square.sqrt(), self.rim_rad).powi(2)
    }

    #[inline(never)]
    fn odd_rays<const N: usize>(&self, terms: OddTerms, squares: [f64; N]) -> [Ray; N] {
        let rad_per_px = 1.0 / self.px_per_rad;
        squares.map(|square| {
            let polar_square = self.odd_polar_square(terms, square);
            let (sinc, cosine) = sinc_and_cosine(polar_square);
            Ray {
                lateral_rad: sinc / terms.stretch(polar_square) * rad_per_px,
                cosine,
            }
        })
    }

    #[inline(never)]
    fn odd_radial_rad(&self, terms: OddTerms, ray: &Ray) -> f64 {
        let polar = libm::acos(ray.cosine.clamp(-1.0, 1.0));
        1.0 / (self.px_per_rad * terms.slope(polar.min(self.rim_rad).powi(2)))
    }

    /// Angle (rad) that the pixel of `ray` covers in the radial direction.
    #[inline]
    pub(super) fn radial_rad(&self, ray: &Ray) -> f64 {
        match self.lens {
            Lens::Fisheye => 1.0 / self.px_per_rad,
            Lens::Odd(terms) => self.odd_radial_rad(terms, ray),
            Lens::Pinhole => ray.lateral_rad * ray.cosine,
        }
    }
}
