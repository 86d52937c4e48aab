//! Lenses, and the Taylor expansion of a lens's map to second order about one direction.

use std::f64::consts::TAU;

use super::odd_terms::OddTerms;

/// Relation between the angle θ from the lens's axis and the distance r from the image's centre; f is the focal length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Equidistant fisheye: r = f θ.
    Fisheye,
    /// Fisheye with further odd terms: r = f (θ + k3 θ³ + k5 θ⁵).
    Odd(OddTerms),
    /// Pinhole: r = f tan θ.
    Pinhole,
}

/// Taylor expansion of a lens's map at one polar angle θ, the angle from the lens's axis. The lens maps θ to the
/// distance r(θ) from the image's centre. All derivatives are with respect to θ.
///
/// The scale in the azimuthal direction is g = r / sin θ. The image of a solid angle dΩ has the area J dΩ, where J = r′
/// g.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    /// Distance r from the image's centre, px.
    pub(super) radius: f64,
    pub(super) radial: f64,
    pub(super) radial_slope: f64,
    /// Scale g = r / sin θ in the azimuthal direction: px per radian of arc on the unit sphere.
    pub(super) lateral: f64,
    pub(super) lateral_slope: f64,
    /// The expression r′ cot θ − r / sin² θ, where r is the distance from the image's centre and r′ its derivative. It
    /// is the second derivative of the radial image coordinate in the azimuthal direction.
    pub(super) bend: f64,
    /// Image area per solid angle: J = r′ g, px²/sr, with the azimuthal scale g.
    pub(super) area: f64,
    pub(super) area_slope: f64,
    pub(super) area_curve: f64,
    /// The expression J′ cot θ, where J is the image area per solid angle and J′ its derivative. It is the second
    /// derivative of J in the azimuthal direction.
    pub(super) area_bend: f64,
}

/// A region of the image: its area, px², and the first moment of the area, px³. The moment is about the image point at
/// which the lens's map was expanded. Its first component is along the direction away from the image's centre, its
/// second component along the direction of increasing azimuth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) area: f64,
    pub(super) moment: [f64; 2],
}

/// A fisheye with the odd terms `terms`. If both terms are 0, it is an equidistant fisheye.
impl From<OddTerms> for Lens {
    fn from(terms: OddTerms) -> Self {
        if terms == OddTerms::default() {
            Self::Fisheye
        } else {
            Self::Odd(terms)
        }
    }
}

impl Lens {
    /// Odd terms of a fisheye; `None` for a pinhole.
    pub(crate) fn odd_terms(self) -> Option<OddTerms> {
        match self {
            Self::Fisheye => Some(OddTerms::default()),
            Self::Odd(terms) => Some(terms),
            Self::Pinhole => None,
        }
    }
}

struct Stretch {
    value: f64,
    slope: f64,
    curve: f64,
    slope_bend: f64,
    bend: f64,
}

impl Stretch {
    #[inline]
    fn new(polar: f64, sine: f64, cosine: f64) -> Self {
        if polar < 0.05 {
            // Near the axis, use power series in θ², where θ is the polar angle. The terms that are left out are below
            // 1e-13.
            let square = polar * polar;
            let per_angle = 1.0 / 3.0 + square * (7.0 / 90.0 + square * (31.0 / 2520.0));
            let value =
                1.0 + square * (1.0 / 6.0 + square * (7.0 / 360.0 + square * (31.0 / 15120.0)));
            return Self {
                value,
                slope: polar * per_angle,
                curve: 1.0 / 3.0 + square * (7.0 / 30.0 + square * (31.0 / 504.0)),
                slope_bend: per_angle * cosine * value,
                bend: -polar * (2.0 / 3.0 + square * (4.0 / 45.0 + square * (4.0 / 315.0))),
            };
        }
        let (per_sine, cotangent) = (1.0 / sine, cosine / sine);
        let value = polar * per_sine;
        let slope = (1.0 - value * cosine) * per_sine;
        Self {
            value,
            slope,
            curve: value * (1.0 + 2.0 * cotangent * cotangent) - 2.0 * cotangent * per_sine,
            slope_bend: slope * cotangent,
            bend: (cosine - value) * per_sine,
        }
    }
}

impl Local {
    /// Taylor expansion of a lens's map at the polar angle `polar` (rad). `sine` and `cosine` are the sine and cosine
    /// of `polar`. `focal` is the focal length, px.
    #[inline]
    pub(super) fn new(lens: Lens, focal: f64, polar: f64, (sine, cosine): (f64, f64)) -> Self {
        match lens {
            Lens::Fisheye => Self::fisheye(focal, polar, &Stretch::new(polar, sine, cosine)),
            Lens::Odd(terms) => {
                let stretch = Stretch::new(polar, sine, cosine);
                Self::odd(focal, polar, cosine, &stretch, terms)
            }
            Lens::Pinhole => Self::pinhole(focal, sine, cosine),
        }
    }

    #[inline]
    fn fisheye(focal: f64, polar: f64, stretch: &Stretch) -> Self {
        let area = focal * focal;
        Self {
            radius: focal * polar,
            radial: focal,
            radial_slope: 0.0,
            lateral: focal * stretch.value,
            lateral_slope: focal * stretch.slope,
            bend: focal * stretch.bend,
            area: area * stretch.value,
            area_slope: area * stretch.slope,
            area_curve: area * stretch.curve,
            area_bend: area * stretch.slope_bend,
        }
    }

    /// Taylor expansion of the map of a lens with odd terms. Two polynomials in u = θ² are used: m = r / (f θ) and n =
    /// m r′ / f. With q = θ / sin θ, the azimuthal scale is g = f q m, and the image area per solid angle is J = f² q
    /// n.
    fn odd(focal: f64, polar: f64, cosine: f64, stretch: &Stretch, terms: OddTerms) -> Self {
        let OddTerms { k3, k5 } = terms;
        let square = polar * polar;
        let even = terms.stretch(square);
        // Compute dm/du (`per_square`), and n with its derivatives with respect to u. Here m = r / (f θ), n = m r′ / f
        // and u = θ². At the angle θ, r is the distance from the image's centre, and r′ is its derivative with respect
        // to θ.
        let per_square = k3 + 2.0 * k5 * square;
        let [once, twice, thrice, fourth] = [
            4.0 * k3,
            6.0 * k5 + 3.0 * k3 * k3,
            8.0 * k3 * k5,
            5.0 * k5 * k5,
        ];
        let n = 1.0 + square * (once + square * (twice + square * (thrice + square * fourth)));
        let n_per_square =
            once + square * (2.0 * twice + square * (3.0 * thrice + square * (4.0 * fourth)));
        let n_curve = 2.0 * twice + square * (6.0 * thrice + square * (12.0 * fourth));
        let (n_slope, n_second) = (
            2.0 * polar * n_per_square,
            2.0 * n_per_square + 4.0 * square * n_curve,
        );
        // `cotangent` is the product θ cot θ, with the polar angle θ.
        let cotangent = stretch.value * cosine;
        let area = focal * focal;
        Self {
            radius: focal * terms.map(polar),
            radial: focal * terms.slope(square),
            radial_slope: focal * polar * (6.0 * k3 + 20.0 * k5 * square),
            lateral: focal * stretch.value * even,
            lateral_slope: focal
                * (stretch.slope * even + stretch.value * 2.0 * polar * per_square),
            bend: focal * (stretch.bend * even + 2.0 * polar * per_square * cotangent),
            area: area * stretch.value * n,
            area_slope: area * (stretch.slope * n + stretch.value * n_slope),
            area_curve: area
                * (stretch.curve * n + 2.0 * stretch.slope * n_slope + stretch.value * n_second),
            area_bend: area
                * (stretch.slope_bend * n + stretch.value * 2.0 * n_per_square * cotangent),
        }
    }

    fn pinhole(focal: f64, sine: f64, cosine: f64) -> Self {
        let secant = 1.0 / cosine;
        let tangent = sine * secant;
        let square = secant * secant;
        let area = focal * focal * square * secant;
        Self {
            radius: focal * tangent,
            radial: focal * square,
            radial_slope: 2.0 * focal * square * tangent,
            lateral: focal * secant,
            lateral_slope: focal * secant * tangent,
            bend: 0.0,
            area,
            area_slope: 3.0 * area * tangent,
            area_curve: 3.0 * area * (1.0 + 4.0 * tangent * tangent),
            area_bend: 3.0 * area,
        }
    }
}

/// Image of a cap, that is, of all directions within an angle α of the direction at which `local` is expanded. `sine`
/// and `cosine` are the sine and cosine of α.
#[inline]
pub(super) fn cap(lens: Lens, local: &Local, sine: f64, cosine: f64) -> Region {
    match lens {
        Lens::Fisheye | Lens::Odd(_) => fisheye_cap(local, sine, cosine),
        Lens::Pinhole => pinhole_cap(local, sine, cosine),
    }
}

/// The image of a cap (see [`cap`]) through a fisheye, to second order in the cap's angular radius α. Let h = 1 − cos α
/// be the height of the cap. The mean of a function over the cap is the function's value in the middle plus h/4 times
/// the function's Laplacian in the middle.
#[inline]
fn fisheye_cap(local: &Local, sine: f64, cosine: f64) -> Region {
    let height = sine * sine / (1.0 + cosine);
    let solid = TAU * height;
    let outward =
        2.0 * local.area_slope * local.radial + local.area * (local.radial_slope + local.bend);
    Region {
        area: solid * (local.area + 0.25 * height * (local.area_curve + local.area_bend)),
        moment: [0.25 * solid * height * outward, 0.0],
    }
}

/// The image of a cap through a pinhole, which is exactly an ellipse. The angular radius of the cap is α, and the polar
/// angle of its middle is θ. With k = sin² α / cos² θ, the area of the ellipse is π f² sin² α cos α / (cos² θ (1 −
/// k))^(3/2). The middle of the ellipse is at the distance f tan θ / (1 − k) from the image's centre.
#[inline]
fn pinhole_cap(local: &Local, sine: f64, cosine: f64) -> Region {
    // `secant` is 1 / cos θ with the polar angle θ. It is the ratio of two scales of the pinhole lens: radial f / cos²
    // θ, and lateral f / cos θ, with the focal length f.
    let secant = local.radial / local.lateral;
    let share = sine * sine * secant * secant;
    let rest = 1.0 - share;
    let area = 0.5 * TAU * local.area * sine * sine * cosine / (rest * rest.sqrt());
    Region {
        area,
        moment: [area * local.radius * share / rest, 0.0],
    }
}
