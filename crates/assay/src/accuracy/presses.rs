//! The field of a press, and what the estimators make of it.

use anyhow::Result;
use palpate_press::Body;

use super::figure::{Figure, rms};
use crate::hot::presses::{AT, INDENTATION, OBJECT, SKIN, Told, fit, markers};
use crate::pressed::{self, Pressed};

const PRESSES: u64 = 20;
/// Thickness of the layer, mm.
const THICKNESS: f64 = 5.0;
/// Depth of the markers in the layer, mm.
const DEPTH: f64 = 2.0;

pub(super) fn figures() -> Result<Vec<Figure>> {
    let mut figures = vec![
        Figure::new("press, half-space at its surface", at_the_surface()?),
        Figure::new("press, half-space at depth, on the axis", on_the_axis()?),
        Figure::new(
            "press, layer from its table",
            of_a_layer(Body::bonded_layer(THICKNESS, DEPTH)?)?,
        ),
        Figure::new(
            "press, layer, solved",
            of_a_layer(Body::solved_layer(THICKNESS, DEPTH)?)?,
        ),
    ];
    let bodies = [
        ("half-space", Body::half_space(0.5, 2.0)?),
        ("layer", Body::bonded_layer(THICKNESS, DEPTH)?),
    ];
    for (name, body) in bodies {
        let name = format!("press, {name} fit, object curvature");
        figures.push(Figure::new(name, estimated(body)?));
    }
    Ok(figures)
}

/// Hertz's profile δ − r²/(2R) in the contact.
fn at_the_surface() -> Result<f64> {
    let body = Body::hertz(0.3)?;
    let contact = body.press(1.0 / SKIN, INDENTATION)?;
    let off = |share: f64| {
        let r = share * contact.radius;
        let expected = INDENTATION - 0.5 * r * r / SKIN;
        (contact.displacement(r).normal / expected - 1.0).abs()
    };
    Ok((0..10)
        .map(|tenth| off(0.1 * f64::from(tenth)))
        .fold(0.0, f64::max))
}

/// Under the middle of the contact at depth z, by integrating Boussinesq's solution for a force over Hertz's pressure.
fn on_the_axis() -> Result<f64> {
    let (poisson, depth) = (0.5, 2.0);
    let body = Body::half_space(poisson, depth)?;
    let contact = body.press(1.0 / SKIN, INDENTATION)?;
    let peak = contact.peak_pressure(1.0).unwrap_or(f64::NAN);
    let a = contact.radius;
    // r = a sin t makes the integrand smooth: Simpson's rule.
    let integrand = |t: f64| {
        let (r, pressure) = (a * libm::sin(t), peak * libm::cos(t));
        let rho = libm::hypot(r, depth);
        let kernel = depth * depth / rho.powi(3) + 2.0 * (1.0 - poisson) / rho;
        (1.0 + poisson) * kernel * pressure * r * a * libm::cos(t)
    };
    let steps = 2000;
    let step = std::f64::consts::FRAC_PI_2 / f64::from(steps);
    let weight = |index: i32| match index {
        0 => 1.0,
        _ if index == steps => 1.0,
        _ if index % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = (0..=steps)
        .map(|index| weight(index) * integrand(f64::from(index) * step))
        .sum();
    let expected = sum * step / 3.0;
    Ok((contact.displacement(0.0).normal / expected - 1.0).abs())
}

/// Against a quadrature over wavenumbers, of the largest displacement; from tables, and solved for itself.
fn of_a_layer(body: Body) -> Result<f64> {
    let layer = pressed::Body::Layer {
        thickness: THICKNESS,
    };
    let distances: Vec<f64> = (0..77).map(|marker| 0.25 * f64::from(marker)).collect();
    let truth = Pressed::new(layer, 1.0 / SKIN, INDENTATION)?;
    let truth = truth.displacements(DEPTH, &distances)?;
    let contact = body.press(1.0 / SKIN, INDENTATION)?;
    let off = distances.iter().zip(&truth).map(|(r, [normal, radial])| {
        let found = contact.displacement(*r);
        (found.normal - normal)
            .abs()
            .max((found.radial - radial).abs())
    });
    let largest = truth.iter().map(|[normal, _]| normal.abs());
    Ok(off.fold(0.0, f64::max) / largest.fold(0.0, f64::max))
}

/// Rms error of the object's fitted curvature, relative to the sum of the curvatures of skin and object.
fn estimated(body: Body) -> Result<f64> {
    let markers = markers()?;
    let contact = markers.skin().contact(&body, OBJECT, INDENTATION)?;
    let moved = markers.displacements(&contact, AT);
    let fit = fit(body.clone());
    let mut errors = Vec::new();
    for press in 0..PRESSES {
        let told = Told::new(&moved, press);
        let estimate = fit.estimate(&told.reading(&markers))?;
        errors.push((estimate.object_curvature().value - OBJECT) / (OBJECT + 1.0 / SKIN));
    }
    Ok(rms(errors))
}
