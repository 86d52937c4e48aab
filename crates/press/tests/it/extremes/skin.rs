//! The skin: objects that nearly conform to it, places at its poles, and markers anywhere.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;
use palpate_press::{Body, ContactRegime, Markers, PressError, Skin};
use palpate_verdict::{Answer, NO_LENGTHS, Precise, rows};

const CONTACT: &str = "press::Skin::contact";
const CHART: &str = "press::Skin::chart";
const MARKERS: &str = "press::Markers::new";
const DISPLACEMENTS: &str = "press::Markers::displacements";
/// Radii of the sensor, length.
const RADII: [f64; 5] = [1e-40, 1e-9, 1.0, 1e9, 1e40];
/// Numbers n, with the place on a skin of radius 1 in the direction (n, 1, n): the apex where that is none.
const ODD: [(f64, [f64; 2]); 5] = [
    (f64::NAN, [0.0; 2]),
    (f64::INFINITY, [0.0; 2]),
    (-f64::MAX, [-0.75 * PI, 0.0]),
    (f64::from_bits(1), [0.0, FRAC_PI_2]),
    (-0.0, [0.0, FRAC_PI_2]),
];
/// Curvatures of the object, in the sensor's.
const REGIMES: [(f64, ContactRegime); 6] = [
    (-1.0, ContactRegime::Conforming),
    (-1.0 + 1e-11, ContactRegime::Concave),
    (-1.0 - 1e-11, ContactRegime::Edge),
    (-0.0, ContactRegime::Flat),
    (f64::from_bits(1), ContactRegime::Convex),
    (f64::MAX, ContactRegime::Convex),
];

rows! {
    CONTACT, "dish whose curvature is {gap:e} short of the sensor's" => dish(gap),
        for gap in [0.5, 1e-3, 1e-6, 1e-9, 1e-11];
    CONTACT, "dish whose curvature is {gap:e} short of the sensor's", "conforming" =>
        press(20.0, -(1.0 - gap) / 20.0, 1e-12), for gap in [1e-13, 0.0, -1e-13];
    CONTACT, "dish whose curvature is {gap:e} short of the sensor's", "edge-contact" =>
        press(20.0, -(1.0 - gap) / 20.0, 1e-12), for gap in [-1e-6, -0.5];
    CONTACT, "plane, indentation {share:e} of the sensor's radius, radii 1e-40 to 1e40" => plane(share),
        for share in [1e-15, 1e-9, 1e-3, 0.5, 0.999_999, 1.0 - 1e-12];
    CONTACT, "plane, indentation 1e-200 of the sensor's radius, which is {radius:e}", "out-of-range" =>
        press(radius, 0.0, 1e-200 * radius), for radius in RADII;
    CONTACT, "plane, indentation {share:e} of the sensor's radius", "too-deep" => press(1.0, 0.0, share),
        for share in [1.0, 1.0 + f64::EPSILON, 1e300, f64::INFINITY];
    CONTACT, "plane, indentation {zero:e} of the sensor's radius", "no-indentation" => press(1.0, 0.0, zero),
        for zero in [0.0, -0.0];
    CONTACT, "plane, indentation NaN of the sensor's radius", "out-of-range" => press(1.0, 0.0, f64::NAN);
    CONTACT, "object of curvature {object:e}", "out-of-range" => press(1.0, object, 0.1),
        for object in [f64::NAN, f64::INFINITY];
    CONTACT, "object of curvature {object:e}", "edge-contact" => press(1.0, object, 0.1),
        for object in [f64::NEG_INFINITY, -f64::MAX];
    "press::Skin::new", "radius {bad:e}", "bad-setting" => Skin::new(bad),
        for bad in NO_LENGTHS.into_iter().chain([1e51]);
    CHART, "of the place {angle:e} radians from the apex, radii 1e-40 to 1e40" => there_and_back(angle),
        for angle in [1e-200, 1e-12, 1e-6, 1.0, 3.0, 3.1, PI - 1e-12];
    CHART, "of direction ({odd:e}, 1, {odd:e}): the apex where it is none" => charted(odd, place),
        for (odd, place) in ODD;
    "press::Skin::place", "at ({odd:e}, 1e300); finite: the apex where there is no place" => nowhere(odd),
        for (odd, _) in ODD;
    DISPLACEMENTS, "contact at ({odd:e}, {odd:e}): as at the apex where it is no place" => displaced_from(odd),
        for (odd, _) in ODD;
    DISPLACEMENTS, "5000 markers in one place: all move alike" => crowd();
    MARKERS, "place ({x:e}, 0): its distance from (0.5, 0)" => distance(x), for x in [f64::from_bits(1), -0.0];
    MARKERS, "place ({bad:e}, 0)", "not-finite" => distance(bad), for bad in [f64::NAN, f64::INFINITY, -f64::MAX];
    "press::ContactRegime::of", "object {object:e} of the sensor's curvature: 1 where it is {regime:?}" =>
        Answer::holds(ContactRegime::of(1.0, object) == regime), for (object, regime) in REGIMES;
}

fn press(radius: f64, object: f64, indentation: f64) -> Result<[f64; 2], PressError> {
    let body = Body::hertz(0.5).unwrap();
    let skin = Skin::new(radius).unwrap();
    let contact = skin.contact(&body, object, indentation)?;
    Ok([contact.relative_curvature, contact.radius])
}

/// The relative curvature loses as many digits as the curvatures cancel.
fn dish(gap: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let object = -(1.0 - gap) / radius;
        let indentation = 1e-3 * gap * radius;
        let relative = 1.0 / Precise::new(radius) + object;
        let truth = [relative.to_f64(), (indentation / relative).sqrt().to_f64()];
        pairs.extend(press(radius, object, indentation)?.into_iter().zip(truth));
    }
    Ok(Answer::all_near(pairs).within(1e-15).conditioned(1.0 / gap))
}

fn plane(share: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let indentation = share * radius;
        let [_, found] = press(radius, 0.0, indentation)?;
        let truth = (Precise::new(indentation) * radius).sqrt();
        pairs.push((found, truth.to_f64()));
    }
    Ok(Answer::all_near(pairs).within(4.0 * f64::EPSILON))
}

/// Near the other pole the direction's rounding is seen in the chart.
fn there_and_back(angle: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let skin = Skin::new(radius)?;
        let scale = angle * radius;
        for (sine, cosine) in [0.0_f64, 0.7, 2.0, -3.0].map(libm::sincos) {
            let place = [scale * cosine, scale * sine];
            let chart = skin.chart(skin.place(place).direction.as_ref());
            pairs.extend([0, 1].map(|axis| (chart[axis] / scale, place[axis] / scale)));
        }
    }
    let answer = Answer::all_at_scale(pairs, 1.0).within(4.0 * f64::EPSILON);
    Ok(answer.conditioned(1.0 / (PI - angle).min(1.0)))
}

fn charted(odd: f64, place: [f64; 2]) -> Result<Answer, PressError> {
    let found = Skin::new(1.0)?.chart(&Vector3::new(odd, 1.0, odd));
    Ok(Answer::all_at_scale(found.into_iter().zip(place), 1.0).within(1e-15))
}

fn nowhere(odd: f64) -> Result<Answer, PressError> {
    let mut numbers = Vec::new();
    for radius in [1e-50, 1.0, 1e50] {
        let place = Skin::new(radius)?.place([odd, 1e300]);
        numbers.push(place.direction.norm());
        numbers.extend(place.x_axis.iter().chain(&place.y_axis));
    }
    Ok(Answer::near(numbers[0], 1.0).within(1e-15).also(numbers))
}

fn displaced_from(odd: f64) -> Result<Answer, PressError> {
    let skin = Skin::new(20.0)?;
    let markers = Markers::new(skin, &[[0.0, 0.0], [3.0, 4.0]])?;
    let body = Body::half_space(0.5, 2.0)?;
    let contact = skin.contact(&body, 0.0, 1.0)?;
    let moved = markers.displacements(&contact, [odd; 2]);
    let truths = [0.0, 5.0].map(|distance| contact.displacement(distance).normal);
    let pairs = moved.iter().map(|one| one.normal).zip(truths);
    // A place that many turns away has no digit left.
    let turns = Some(odd.abs() / 20.0).filter(|turns| turns.is_finite());
    Ok(Answer::all_near(pairs)
        .within(1e-14)
        .also(moved.iter().flat_map(|one| one.tangential))
        .also(markers.distances([odd; 2]))
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

fn distance(x: f64) -> Result<Answer, PressError> {
    let markers = Markers::new(Skin::new(1.0)?, &[[x, 0.0]])?;
    Ok(Answer::near(markers.distances([0.5, 0.0])[0], 0.5).within(1e-15))
}
