//! A lens, and its map around one direction to second order.

use std::f64::consts::TAU;

use super::odd_terms::OddTerms;

/// How a lens maps the angle θ from its axis to the distance r from the image's centre, with the focal length f.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Equidistant: r = f θ.
    Fisheye,
    /// Fisheye with further odd terms: r = f (θ + k3 θ³ + k5 θ⁵).
    Odd(OddTerms),
    /// r = f tan θ.
    Pinhole,
}

/// Derivatives of a lens at a polar angle θ. The lens maps the angle θ from the axis to the distance r(θ) from the
/// image's centre.
///
/// With g = r / sin θ, the scale around the axis, a solid angle dΩ has the image area J dΩ, where J = r′ g.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    /// r, px.
    pub(super) radius: f64,
    /// r′.
    pub(super) radial: f64,
    /// r″.
    pub(super) radial_slope: f64,
    /// g.
    pub(super) lateral: f64,
    /// g′.
    pub(super) lateral_slope: f64,
    /// r′ cot θ − r / sin² θ: second derivative of the radial image coordinate around the axis.
    pub(super) bend: f64,
    /// J.
    pub(super) area: f64,
    /// J′.
    pub(super) area_slope: f64,
    /// J″.
    pub(super) area_curve: f64,
    /// J′ cot θ: second derivative of J around the axis.
    pub(super) area_bend: f64,
}

/// A region of the image: its area, px², and the first moment of the area, px³. The moment is about the image of the
/// direction at which the lens was expanded. Its components point away from the image's centre and around it, toward
/// growing azimuth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) area: f64,
    pub(super) moment: [f64; 2],
}

impl Lens {
    /// Fisheye with these odd terms: the equidistant one if both are 0.
    pub fn fisheye(terms: OddTerms) -> Self {
        if terms == OddTerms::default() {
            Self::Fisheye
        } else {
            Self::Odd(terms)
        }
    }

    /// Odd terms of a fisheye; `None` for another lens.
    pub fn odd_terms(self) -> Option<OddTerms> {
        match self {
            Self::Fisheye => Some(OddTerms::default()),
            Self::Odd(terms) => Some(terms),
            Self::Pinhole => None,
        }
    }
}

/// q = θ / sin θ, the ratio of the scale around the axis to the radial scale of an equidistant lens, and the
/// derivatives of q.
struct Stretch {
    /// q.
    value: f64,
    /// q′.
    slope: f64,
    /// q″.
    curve: f64,
    /// q′ cot θ.
    slope_bend: f64,
    /// cot θ − θ / sin² θ.
    bend: f64,
}

impl Stretch {
    #[inline]
    fn new(polar: f64, sine: f64, cosine: f64) -> Self {
        if polar < 0.05 {
            // Power series; the truncation error is below 1e-13.
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
    /// Derivatives of a lens of the focal length `focal`, px, at a polar angle, rad, with this sine and cosine.
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

    /// Let m = r / (f θ) and n = m r′ / f, which are polynomials in u = θ². Then g = f q m and J = f² q n.
    fn odd(focal: f64, polar: f64, cosine: f64, stretch: &Stretch, terms: OddTerms) -> Self {
        let OddTerms { k3, k5 } = terms;
        let square = polar * polar;
        let even = terms.stretch(square);
        // dm/du, and n with its derivatives by u.
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
        // θ cot θ.
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

/// Image of all directions within an angle α of the direction at which `local` was computed; `sine` and `cosine` are
/// those of α.
#[inline]
pub(super) fn cap(lens: Lens, local: &Local, sine: f64, cosine: f64) -> Region {
    match lens {
        Lens::Fisheye | Lens::Odd(_) => fisheye_cap(local, sine, cosine),
        Lens::Pinhole => pinhole_cap(local, sine, cosine),
    }
}

/// To second order in α, the mean of a function over a cap of height h = 1 − cos α is the function in its middle plus
/// h/4 times its Laplacian there.
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

/// The image is exactly an ellipse. With k = sin² α / cos² θ its area is π f² sin² α cos α / (cos² θ (1 − k))^(3/2),
/// and its middle lies f tan θ / (1 − k) from the image's centre.
#[inline]
fn pinhole_cap(local: &Local, sine: f64, cosine: f64) -> Region {
    // The ratio of f / cos² θ and f / cos θ is 1 / cos θ.
    let secant = local.radial / local.lateral;
    let share = sine * sine * secant * secant;
    let rest = 1.0 - share;
    let area = 0.5 * TAU * local.area * sine * sine * cosine / (rest * rest.sqrt());
    Region {
        area,
        moment: [area * local.radius * share / rest, 0.0],
    }
}
