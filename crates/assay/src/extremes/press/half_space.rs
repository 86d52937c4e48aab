//! Half-spaces: Hertz's contact at the surface and below, against the closed form in 57 digits.

use palpate_press::{Body, PressError};

use crate::extremes::Precise;
use crate::extremes::{Answer, Case};

/// Error that the documentation of `Contact::displacement` allows, relative to the length of the displacement.
const BOUND: f64 = 1e-11;
const POISSON: [f64; 3] = [0.0, 0.3, 0.5];
/// Radii of the contact, length.
const RADII: [f64; 5] = [1e-40, 1e-9, 1.0, 1e9, 1e40];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for depth in [0.0, 1e-12, 1e-6, 0.1, 1.0, 11.9, 1e6, 1e12] {
        for r in [0.0, 1e-9, 0.5, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 11.9, 1e6] {
            cases.push(Case::value(
                "press::Contact::displacement",
                format!(
                    "half-space, depth {depth:e} and distance {r:e} radii, radii 1e-40 to 1e40"
                ),
                move || displacements(depth, r),
            ));
        }
    }
    for (curvature, indentation) in [
        (1e-9, 1e-9),
        (1e-9, 1e9),
        (1e9, 1e-9),
        (1e9, 1e9),
        (1e-40, 1e-40),
        (1e40, 1e-40),
        (1e-12, 1e12),
        (f64::MIN_POSITIVE, 1e-250),
    ] {
        cases.push(Case::value(
            "press::Body::press",
            format!("half-space, relative curvature {curvature:e}, indentation {indentation:e}"),
            move || contact(curvature, indentation),
        ));
    }
    cases.extend(refusals());
    cases
}

fn refusals() -> Vec<Case> {
    let mut cases = Vec::new();
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
        let mut refused = |what: &str, press: fn(f64) -> Result<(), PressError>| {
            let input = format!("{what} {number}");
            cases.push(Case::refusal("press::Body", input, move || press(number)));
        };
        refused("hertz, poisson", |number| Body::hertz(number).map(drop));
        refused("half-space, depth", |number| {
            Body::half_space(0.3, number).map(drop)
        });
        refused("gaussian, c", |number| Body::gaussian(number).map(drop));
        refused("half-space, relative curvature", |number| {
            Body::hertz(0.3)?.press(number, 1.0).map(drop)
        });
        refused("half-space, indentation", |number| {
            Body::hertz(0.3)?.press(1.0, number).map(drop)
        });
    }
    for (curvature, indentation) in [(0.0, 1.0), (-0.0, 1.0), (1.0, 0.0), (1.0, -0.0)] {
        cases.push(Case::refusal(
            "press::Body::press",
            format!("half-space, relative curvature {curvature:?}, indentation {indentation:?}"),
            move || Body::hertz(0.3)?.press(curvature, indentation).map(drop),
        ));
    }
    for (curvature, indentation) in [
        (f64::from_bits(1), 1.0),
        (1.0, f64::from_bits(1)),
        (f64::MAX, f64::from_bits(1)),
        (f64::from_bits(1), f64::MAX),
    ] {
        cases.push(Case::new(
            "press::Body::press",
            format!("half-space, relative curvature {curvature:e}, indentation {indentation:e}"),
            move || contact(curvature, indentation).into(),
        ));
    }
    for r in [f64::NAN, f64::INFINITY, f64::MAX, -1.0, f64::from_bits(1)] {
        for body in ["half-space", "layer", "gaussian"] {
            cases.push(Case::value(
                "press::Contact::displacement",
                format!("{body}, distance {r:e}: as at distance 1 or 0, or nothing moves"),
                move || anywhere(body, r),
            ));
        }
    }
    cases
}

fn anywhere(body: &str, r: f64) -> Result<Answer, PressError> {
    let body = match body {
        "half-space" => Body::half_space(0.5, 1.0)?,
        "layer" => Body::bonded_layer(5.0, 1.0)?,
        _ => Body::gaussian(1.0)?,
    };
    let contact = body.press(0.1, 1.0)?;
    let moved = contact.displacement(r);
    let as_near = (r.abs() <= 1.0).then(|| contact.displacement(r.abs().round()));
    let truth = as_near.map_or([0.0; 2], |moved| [moved.normal, moved.radial.abs()]);
    let pairs = [moved.normal, moved.radial.abs()].into_iter().zip(truth);
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-15))
}

/// The contact's radius, and what else is stated of a contact.
fn contact(curvature: f64, indentation: f64) -> Result<Answer, PressError> {
    let body = Body::hertz(0.5)?;
    let contact = body.press(curvature, indentation)?;
    let [precise, deep] = [curvature, indentation].map(Precise::new);
    let radius = (&deep / &precise).sqrt();
    let force = precise * &radius * &radius * &radius * 16.0 / Precise::new(9.0);
    let stated = [contact.force(1.0), contact.peak_pressure(1.0)];
    Ok(Answer::all_near([
        (contact.radius, radius.to_f64()),
        (stated[0].unwrap_or(f64::NAN), force.to_f64()),
    ])
    .also(stated.into_iter().flatten())
    .within(4.0 * f64::EPSILON))
}

fn displacements(depth: f64, r: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for poisson in POISSON {
        for radius in RADII {
            let body = Body::half_space(poisson, (depth * radius).min(1e50))?;
            let contact = body.press(radius.recip(), radius)?;
            let at = r * contact.radius;
            let moved = contact.displacement(at);
            let ratio = |length: f64| Precise::new(length) / Precise::new(contact.radius);
            let truth = field(poisson, &ratio((depth * radius).min(1e50)), &ratio(at));
            let unit = Precise::new(contact.relative_curvature) * contact.radius * contact.radius;
            let [normal, radial] = truth.map(|part| (part * &unit).to_f64());
            let size = libm::hypot(normal, radial);
            pairs.push((moved.normal / size, normal / size));
            pairs.push((moved.radial / size, radial / size));
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(BOUND))
}

/// Normal and radial displacement under a contact of radius 1, per unit of relative curvature: Huber (1904), in the
/// complex distance √(r² + (z + i)²) = X + iY.
fn field(poisson: f64, z: &Precise, r: &Precise) -> [Precise; 2] {
    let half = |number: Precise| number * 0.5;
    let (z_squared, r_squared) = (z.squared(), r.squared());
    let difference = &r_squared - &Precise::new(1.0) + &z_squared;
    let size = (((r - 1.0).squared() + &z_squared) * ((r + 1.0).squared() + &z_squared)).sqrt();
    // XY = z tells the lesser one without cancellation.
    let (x, y) = if difference.is_negative() {
        let y = half(&size - &difference).sqrt();
        (z / &y, y)
    } else {
        let x = half(&size + &difference).sqrt();
        let at_the_edge = x.to_f64() == 0.0;
        let y = if at_the_edge { x.clone() } else { z / &x };
        (x, y)
    };
    let theta = Precise::pi() * 0.5 - x.atan();
    let l2 = x.squared() + 1.0;
    let even_3 = ((&z_squared * 2.0 + 2.0 - &r_squared) * &theta
        + (Precise::new(1.0) - y.squared() * 3.0) * &x)
        * 0.25;
    let even_2 = &y - &(z * &theta);
    let odd_3 = r
        * ((y.squared() + &y + 1.0) / (&l2 * 3.0 * (&y + 1.0)) + x.squared() * &y / (&l2 * 2.0)
            - z * &theta * 0.5);
    let odd_2 = r * (&theta - &x / &l2) * 0.5;
    let scale = Precise::new(2.0) / (Precise::pi() * (Precise::new(1.0) - Precise::new(poisson)));
    let (normal, radial) = (
        (Precise::new(1.0) - Precise::new(poisson)) * 2.0,
        Precise::new(1.0) - Precise::new(poisson) * 2.0,
    );
    [
        &scale * (normal * even_3 + z * &even_2),
        -(scale * (radial * odd_3 - z * &odd_2)),
    ]
}
