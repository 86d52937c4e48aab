//! The skin: objects that nearly conform to it, places at its poles, and markers anywhere.

use std::f64::consts::PI;

use nalgebra::Vector3;
use palpate_press::{Body, ContactRegime, Markers, PressError, Skin};

use crate::extremes::Precise;
use crate::extremes::{Answer, Case};

/// Radii of the sensor, length.
const RADII: [f64; 5] = [1e-40, 1e-9, 1.0, 1e9, 1e40];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for gap in [0.5, 1e-3, 1e-6, 1e-9, 1e-11] {
        cases.push(Case::value(
            "press::Skin::contact",
            format!("dish whose curvature is {gap:e} short of the sensor's"),
            move || dish(gap),
        ));
    }
    for (gap, sign) in [
        (1e-13, 1.0),
        (0.0, 1.0),
        (1e-13, -1.0),
        (1e-6, -1.0),
        (0.5, -1.0),
    ] {
        cases.push(Case::refusal(
            "press::Skin::contact",
            format!(
                "dish whose curvature is {:e} short of the sensor's",
                sign * gap
            ),
            move || {
                let skin = Skin::new(20.0)?;
                let object = -(1.0 - sign * gap) / 20.0;
                skin.contact(&Body::hertz(0.5)?, object, 1e-12).map(drop)
            },
        ));
    }
    for share in [1e-200, 1e-15, 1e-9, 1e-3, 0.5, 0.999_999, 1.0 - 1e-12] {
        cases.push(Case::value(
            "press::Skin::contact",
            format!("plane, indentation {share:e} of the sensor's radius, radii 1e-40 to 1e40"),
            move || plane(share),
        ));
    }
    for indentation in [
        1.0,
        1.0 + f64::EPSILON,
        1e300,
        f64::NAN,
        f64::INFINITY,
        0.0,
        -0.0,
    ] {
        cases.push(Case::refusal(
            "press::Skin::contact",
            format!("plane, indentation {indentation:e} of the sensor's radius"),
            move || {
                Skin::new(1.0)?
                    .contact(&Body::hertz(0.5)?, 0.0, indentation)
                    .map(drop)
            },
        ));
    }
    for object in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -f64::MAX] {
        cases.push(Case::refusal(
            "press::Skin::contact",
            format!("object of curvature {object:e}"),
            move || {
                Skin::new(1.0)?
                    .contact(&Body::hertz(0.5)?, object, 0.1)
                    .map(drop)
            },
        ));
    }
    for radius in [f64::NAN, f64::INFINITY, 0.0, -1.0, f64::from_bits(1), 1e51] {
        cases.push(Case::refusal(
            "press::Skin::new",
            format!("radius {radius:e}"),
            move || Skin::new(radius),
        ));
    }
    for angle in [1e-200, 1e-12, 1e-6, 1.0, 3.0, 3.1, PI - 1e-12] {
        cases.push(Case::value(
            "press::Skin::chart",
            format!("of the place {angle:e} radians from the apex, radii 1e-40 to 1e40"),
            move || there_and_back(angle),
        ));
    }
    for number in [f64::NAN, f64::INFINITY, -f64::MAX, f64::from_bits(1), -0.0] {
        cases.push(Case::value(
            "press::Skin::place",
            format!("at ({number:e}, 1e300); finite: the apex where there is no place"),
            move || nowhere(number),
        ));
        cases.push(Case::value(
            "press::Skin::chart",
            format!("of direction ({number:e}, 1, {number:e}): the apex where it is none"),
            move || {
                let found = Skin::new(1.0)?.chart(&Vector3::new(number, 1.0, number));
                let truth = match number {
                    number if !number.is_finite() => [0.0; 2],
                    number if number < -1.0 => [-0.75 * PI, 0.0],
                    _ => [0.0, 0.5 * PI],
                };
                let pairs = found.into_iter().zip(truth);
                Ok::<_, PressError>(Answer::all_at_scale(pairs, 1.0).within(1e-15))
            },
        ));
        cases.push(Case::value(
            "press::Markers::displacements",
            format!("contact at ({number:e}, {number:e}): as at the apex where it is no place"),
            move || displaced_from(number),
        ));
        cases.push(Case::new(
            "press::Markers::new",
            format!("place ({number:e}, 0): its distance from (0.5, 0)"),
            move || {
                Skin::new(1.0)
                    .and_then(|skin| Markers::new(skin, &[[number, 0.0]]))
                    .map(|markers| markers.distances([0.5, 0.0])[0])
                    .map(|distance| Answer::near(distance, 0.5).within(1e-15))
                    .into()
            },
        ));
    }
    cases.push(Case::value(
        "press::Markers::displacements",
        "5000 markers in one place: all move alike",
        crowd,
    ));
    for (object, name) in [
        (-1.0, ContactRegime::Conforming),
        (-1.0 + 1e-11, ContactRegime::Concave),
        (-1.0 - 1e-11, ContactRegime::Edge),
        (-0.0, ContactRegime::Flat),
        (f64::from_bits(1), ContactRegime::Convex),
        (f64::MAX, ContactRegime::Convex),
    ] {
        cases.push(Case::value(
            "press::ContactRegime::of",
            format!(
                "object {object:e} of the sensor's curvature: 1 where it is {}",
                name.name()
            ),
            move || {
                let is_right = ContactRegime::of(1.0, object) == name;
                Ok::<_, PressError>(Answer::near(f64::from(u8::from(is_right)), 1.0))
            },
        ));
    }
    cases
}

/// The relative curvature loses as many digits as the curvatures cancel.
fn dish(gap: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let object = -(1.0 - gap) / radius;
        let indentation = 1e-3 * gap * radius;
        let body = Body::hertz(0.5)?;
        let contact = Skin::new(radius)?.contact(&body, object, indentation)?;
        let relative = Precise::new(1.0) / Precise::new(radius) + Precise::new(object);
        pairs.push((contact.relative_curvature, relative.to_f64()));
        let truth = (Precise::new(indentation) / relative).sqrt().to_f64();
        pairs.push((contact.radius, truth));
    }
    Ok(Answer::all_near(pairs).within(1e-15).conditioned(1.0 / gap))
}

fn plane(share: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let indentation = share * radius;
        let body = Body::hertz(0.5)?;
        let contact = Skin::new(radius)?.contact(&body, 0.0, indentation);
        let truth = (Precise::new(indentation) * Precise::new(radius))
            .sqrt()
            .to_f64();
        match contact {
            Ok(contact) => pairs.push((contact.radius, truth)),
            // The contact's radius leaves the range that can be worked with.
            Err(PressError::OutOfRange) if truth < 1e-50 => pairs.push((1.0, 1.0)),
            Err(error) => return Err(error),
        }
    }
    Ok(Answer::all_near(pairs).within(4.0 * f64::EPSILON))
}

/// Near the other pole the direction's rounding is seen in the chart.
fn there_and_back(angle: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let skin = Skin::new(radius)?;
        for (sine, cosine) in [0.0_f64, 0.7, 2.0, -3.0].map(libm::sincos) {
            let place = [angle * radius * cosine, angle * radius * sine];
            let chart = skin.chart(skin.place(place).direction.as_ref());
            let scale = angle * radius;
            pairs.extend([0, 1].map(|axis| (chart[axis] / scale, place[axis] / scale)));
        }
    }
    let condition = 1.0 / (std::f64::consts::PI - angle).min(1.0);
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(4.0 * f64::EPSILON)
        .conditioned(condition))
}

fn nowhere(number: f64) -> Result<Answer, PressError> {
    let mut numbers = Vec::new();
    for radius in [1e-50, 1.0, 1e50] {
        let place = Skin::new(radius)?.place([number, 1e300]);
        numbers.push(place.direction.norm());
        numbers.extend(place.x_axis.iter().chain(&place.y_axis).copied());
    }
    Ok(Answer::near(numbers[0], 1.0).within(1e-15).also(numbers))
}

fn displaced_from(number: f64) -> Result<Answer, PressError> {
    let skin = Skin::new(20.0)?;
    let markers = Markers::new(skin, &[[0.0, 0.0], [3.0, 4.0]])?;
    let body = Body::half_space(0.5, 2.0)?;
    let contact = skin.contact(&body, 0.0, 1.0)?;
    let moved = markers.displacements(&contact, [number, number]);
    let parts = moved
        .iter()
        .flat_map(|one| [one.normal, one.tangential[0], one.tangential[1]]);
    let truths = [0.0, 5.0].map(|distance| contact.displacement(distance).normal);
    let pairs = moved.iter().map(|one| one.normal).zip(truths);
    // A place that many turns away has no digit left.
    let turns = Some(number.abs() / 20.0).filter(|turns| turns.is_finite());
    Ok(Answer::all_near(pairs)
        .within(1e-14)
        .also(parts)
        .also(markers.distances([number, number]))
        .conditioned(turns.unwrap_or(1.0).max(1.0))
        .or_no_digits())
}

fn crowd() -> Result<Answer, PressError> {
    let skin = Skin::new(20.0)?;
    let markers = Markers::new(skin, &[[3.0, 4.0]; 5000])?;
    let body = Body::half_space(0.5, 2.0)?;
    let contact = skin.contact(&body, 0.0, 1.0)?;
    let moved = markers.displacements(&contact, [0.0; 2]);
    let truth = contact.displacement(5.0).normal;
    Ok(Answer::all_near(moved.iter().map(|one| (one.normal, truth))).within(1e-14))
}
