//! Half-spaces: Hertz's contact at the surface and below, against the closed form in 57 digits.

use palpate_press::{Body, PressError};
use palpate_verdict::{Answer, NOT_FINITE, Precise, rows};

use super::fit::BODIES;

const BODY: &str = "press::Body";
const PRESS: &str = "press::Body::press";
const DISPLACEMENT: &str = "press::Contact::displacement";
/// Radii of the contact, length.
const RADII: [f64; 5] = [1e-40, 1e-9, 1.0, 1e9, 1e40];
/// Least number above 0.
const LEAST: f64 = f64::from_bits(1);

rows! {
    DISPLACEMENT, "half-space, depth {depth:e} and distance {r:e} radii, radii 1e-40 to 1e40" =>
        displacements(depth, r),
        for depth in [0.0, 1e-12, 1e-6, 0.1, 1.0, 11.9, 1e6, 1e12],
        for r in [0.0, 1e-9, 0.5, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 11.9, 1e6];
    DISPLACEMENT, "{name}, distance {r:e}: as at distance 1 or 0, or nothing moves" => anywhere(body(10.0), r),
        for r in [f64::NAN, f64::INFINITY, f64::MAX, -1.0, LEAST], for (name, body) in BODIES;
    PRESS, "half-space, relative curvature {curvature:e}, indentation {depth:e}" => contact(curvature, depth),
        for curvature in [1e-9, 1e9], for depth in [1e-9, 1e9];
    PRESS, "half-space, relative curvature {curvature:e}, indentation {depth:e}" => contact(curvature, depth),
        for (curvature, depth) in [(1e-40, 1e-40), (1e40, 1e-40), (1e-12, 1e12), (f64::MIN_POSITIVE, 1e-250)];
    PRESS, "half-space, relative curvature {curvature:e}, indentation {depth:e}", "out-of-range" =>
        contact(curvature, depth),
        for (curvature, depth) in [(LEAST, 1.0), (1.0, LEAST), (f64::MAX, LEAST), (LEAST, f64::MAX)];
    PRESS, "half-space, relative curvature {zero:?}, indentation 1.0", "conforming" => contact(zero, 1.0),
        for zero in [0.0, -0.0];
    PRESS, "half-space, relative curvature 1.0, indentation {zero:?}", "no-indentation" => contact(1.0, zero),
        for zero in [0.0, -0.0];
    BODY, "hertz, poisson {bad}", "bad-setting" => Body::hertz(bad), for bad in below_0();
    BODY, "half-space, depth {bad}", "bad-setting" => Body::half_space(0.3, bad), for bad in below_0();
    BODY, "gaussian, c {bad}", "bad-setting" => Body::gaussian(bad), for bad in below_0();
    BODY, "half-space, relative curvature {bad}", "out-of-range" => contact(bad, 1.0), for bad in NOT_FINITE;
    BODY, "half-space, indentation {bad}", "out-of-range" => contact(1.0, bad), for bad in NOT_FINITE;
    BODY, "half-space, relative curvature -1", "edge-contact" => contact(-1.0, 1.0);
    BODY, "half-space, indentation -1", "no-indentation" => contact(1.0, -1.0);
}

fn below_0() -> impl Iterator<Item = f64> {
    NOT_FINITE.into_iter().chain([-1.0])
}

fn anywhere(body: Body, r: f64) -> Result<Answer, PressError> {
    let contact = body.press(0.1, 1.0)?;
    let parts = |r| {
        let moved = contact.displacement(r);
        [moved.normal, moved.radial.abs()]
    };
    let as_near = (r.abs() <= 1.0).then(|| parts(r.abs().round()));
    let pairs = parts(r).into_iter().zip(as_near.unwrap_or_default());
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-15))
}

/// The contact's radius, and what else is stated of a contact.
fn contact(curvature: f64, indentation: f64) -> Result<Answer, PressError> {
    let body = Body::hertz(0.5).unwrap();
    let contact = body.press(curvature, indentation)?;
    let [curvature, depth] = [curvature, indentation].map(Precise::new);
    let radius = (depth / &curvature).sqrt();
    let force = curvature * &radius * &radius * &radius * 16.0 / 9.0;
    let [found, peak] = [contact.force(1.0), contact.peak_pressure(1.0)].map(Option::unwrap);
    let pairs = [(contact.radius, radius.to_f64()), (found, force.to_f64())];
    Ok(Answer::all_near(pairs)
        .also([peak])
        .within(4.0 * f64::EPSILON))
}

fn displacements(depth: f64, r: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for poisson in [0.0, 0.3, 0.5] {
        for radius in RADII {
            let deep = (depth * radius).min(1e50);
            let body = Body::half_space(poisson, deep)?;
            let contact = body.press(radius.recip(), radius)?;
            let at = r * contact.radius;
            let moved = contact.displacement(at);
            let ratio = |length: f64| Precise::new(length) / contact.radius;
            let truth = field(poisson, &ratio(deep), &ratio(at));
            let unit = Precise::new(contact.relative_curvature) * contact.radius * contact.radius;
            let [normal, radial] = truth.map(|part| (part * &unit).to_f64());
            let size = libm::hypot(normal, radial);
            pairs.push((moved.normal / size, normal / size));
            pairs.push((moved.radial / size, radial / size));
        }
    }
    // Error that the documentation of `Contact::displacement` allows, relative to the length of the displacement.
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-11))
}

/// Normal and radial displacement under a contact of radius 1, per unit of relative curvature: Huber (1904), in the
/// complex distance √(r² + (z + i)²) = X + iY.
fn field(poisson: f64, z: &Precise, r: &Precise) -> [Precise; 2] {
    let difference = r.squared() - 1.0 + z.squared();
    let size = (((r - 1.0).squared() + z.squared()) * ((r + 1.0).squared() + z.squared())).sqrt();
    // XY = z tells the lesser one without cancellation.
    let (x, y) = if difference.is_negative() {
        let y = ((size - difference) * 0.5).sqrt();
        (z / &y, y)
    } else {
        let x = ((size + difference) * 0.5).sqrt();
        let at_the_edge = x.to_f64() == 0.0;
        let y = if at_the_edge { x.clone() } else { z / &x };
        (x, y)
    };
    let theta = Precise::pi() * 0.5 - x.atan();
    let l2 = x.squared() + 1.0;
    let even_3 = (z.squared() * 2.0 + 2.0 - r.squared()) * &theta;
    let even_3 = (even_3 + (1.0 - y.squared() * 3.0) * &x) * 0.25;
    let even_2 = &y - z * &theta;
    let odd_3 = (y.squared() + &y + 1.0) / (&l2 * 3.0 * (&y + 1.0));
    let odd_3 = r * (odd_3 + x.squared() * &y / (&l2 * 2.0) - z * &theta * 0.5);
    let odd_2 = r * (theta - x / l2) * 0.5;
    let normal = (1.0 - Precise::new(poisson)) * 2.0;
    let radial = 1.0 - Precise::new(poisson) * 2.0;
    let scale = 4.0 / (Precise::pi() * &normal);
    [
        &scale * (normal * even_3 + z * even_2),
        -(scale * (radial * odd_3 - z * odd_2)),
    ]
}
