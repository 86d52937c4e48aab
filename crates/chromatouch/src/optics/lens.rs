//! A lens, and its map around one direction to second order.

use std::f64::consts::TAU;

/// How a lens maps the angle θ from its axis to the distance r from the image's centre, with the focal length f.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    /// Equidistant: r = f θ.
    Fisheye,
    /// r = f tan θ.
    Pinhole,
}

/// The derivatives of a lens at a polar angle θ: a place θ from the axis is seen r(θ) from the image's centre.
///
/// With g = r / sin θ, the scale around the axis, a solid angle dΩ has the image area J dΩ, J = r′ g.
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
    /// r′ cot θ − r / sin² θ: how the radial coordinate bends around the axis.
    pub(super) bend: f64,
    /// J.
    pub(super) area: f64,
    /// J′.
    pub(super) area_slope: f64,
    /// J″.
    pub(super) area_curve: f64,
    /// J′ cot θ, the second derivative around the axis.
    pub(super) area_bend: f64,
}

/// A region of the image: its area, px², and the first moment of the area about the image of the direction that the
/// region was looked at from, px³, away from the image's centre and around it (toward growing azimuth).
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) area: f64,
    pub(super) moment: [f64; 2],
}

impl Local {
    /// Derivatives of a lens of this focal length, px, at a polar angle, rad, with this sine and cosine.
    #[inline]
    pub(super) fn new(lens: Lens, focal: f64, polar: f64, (sine, cosine): (f64, f64)) -> Self {
        match lens {
            Lens::Fisheye => Self::fisheye(focal, polar, sine, cosine),
            Lens::Pinhole => Self::pinhole(focal, sine, cosine),
        }
    }

    fn fisheye(focal: f64, polar: f64, sine: f64, cosine: f64) -> Self {
        // q = θ / sin θ, q′, q″, q′ cot θ, and cot θ − θ / sin² θ.
        let (stretch, slope, curve, slope_bend, bend);
        if polar < 0.05 {
            // Power series; what is left out is below 1e-13.
            let square = polar * polar;
            let per_angle = 1.0 / 3.0 + square * (7.0 / 90.0 + square * (31.0 / 2520.0));
            stretch =
                1.0 + square * (1.0 / 6.0 + square * (7.0 / 360.0 + square * (31.0 / 15120.0)));
            slope = polar * per_angle;
            curve = 1.0 / 3.0 + square * (7.0 / 30.0 + square * (31.0 / 504.0));
            slope_bend = per_angle * cosine * stretch;
            bend = -polar * (2.0 / 3.0 + square * (4.0 / 45.0 + square * (4.0 / 315.0)));
        } else {
            let (per_sine, cotangent) = (1.0 / sine, cosine / sine);
            stretch = polar * per_sine;
            slope = (1.0 - stretch * cosine) * per_sine;
            curve = stretch * (1.0 + 2.0 * cotangent * cotangent) - 2.0 * cotangent * per_sine;
            slope_bend = slope * cotangent;
            bend = (cosine - stretch) * per_sine;
        }
        let area = focal * focal;
        Self {
            radius: focal * polar,
            radial: focal,
            radial_slope: 0.0,
            lateral: focal * stretch,
            lateral_slope: focal * slope,
            bend: focal * bend,
            area: area * stretch,
            area_slope: area * slope,
            area_curve: area * curve,
            area_bend: area * slope_bend,
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

/// The image of all directions within an angle α of the direction that a lens was looked at in; of the angle, sine and
/// cosine.
#[inline]
pub(super) fn cap(lens: Lens, local: &Local, sine: f64, cosine: f64) -> Region {
    match lens {
        Lens::Fisheye => fisheye_cap(local, sine, cosine),
        Lens::Pinhole => pinhole_cap(local, sine, cosine),
    }
}

/// The mean of a function over a cap of height h = 1 − cos α is the function in its middle plus h/4 times its Laplacian
/// there, to second order in α.
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

/// An ellipse, exactly: with k = sin² α / cos² θ its area is π f² sin² α cos α / (cos² θ (1 − k))^(3/2), and its middle
/// lies f tan θ / (1 − k) from the image's centre.
#[inline]
fn pinhole_cap(local: &Local, sine: f64, cosine: f64) -> Region {
    // f / cos² θ over f / cos θ is 1 / cos θ.
    let secant = local.radial / local.lateral;
    let share = sine * sine * secant * secant;
    let rest = 1.0 - share;
    let area = 0.5 * TAU * local.area * sine * sine * cosine / (rest * rest.sqrt());
    Region {
        area,
        moment: [area * local.radius * share / rest, 0.0],
    }
}
