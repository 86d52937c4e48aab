//! Bonded layers, from contacts much narrower than they are thick to the widest that are solved.

use palpate_press::{Body, BondedLayer, PressError};

use crate::extremes::{Answer, Case};

/// Thicknesses, length.
const THICKNESSES: [f64; 5] = [1e-40, 1e-6, 1.0, 1e6, 1e40];
/// Radii of the contact, in thicknesses.
const RADII: [f64; 12] = [
    1e-12, 1e-6, 1e-3, 0.1, 0.5, 1.0, 3.0, 7.0, 11.9, 13.0, 29.0, 50.0,
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for ratio in RADII {
        cases.push(Case::value(
            "press::LayerContact::field",
            format!(
                "surface of the contact, {ratio:e} thicknesses wide, thicknesses 1e-40 to 1e40"
            ),
            move || under_the_object(ratio),
        ));
        cases.push(Case::value(
            "press::BondedLayer::contact_radius",
            format!("of the indentation of a contact {ratio:e} thicknesses wide"),
            move || round_trip(ratio),
        ));
        cases.push(Case::value(
            "press::BondedLayer::contact",
            format!("displacement at the base, contact {ratio:e} thicknesses wide: 0"),
            move || at_the_base(ratio),
        ));
    }
    for thickness in THICKNESSES {
        cases.push(Case::value(
            "press::BondedLayer::indentation_of",
            format!("thickness {thickness:e}, contact 1e-9 of it: a half-space's a²"),
            move || narrow(thickness),
        ));
        cases.push(Case::value(
            "press::BondedLayer::indentation_of",
            format!("thickness {thickness:e}, contact 50 times as wide: a²/4 and a share of t/a"),
            move || wide(thickness),
        ));
        cases.push(Case::value(
            "press::LayerContact::field",
            format!("thickness {thickness:e}, contact and depth 1e-7 of it: that of a half-space"),
            move || shallow(thickness),
        ));
    }
    cases.extend(refusals());
    cases
}

fn refusals() -> Vec<Case> {
    let mut cases = Vec::new();
    for (thickness, depth) in [
        (f64::NAN, 0.0),
        (f64::INFINITY, 0.0),
        (0.0, 0.0),
        (-1.0, 0.0),
        (f64::from_bits(1), 0.0),
        (1.0, -1e-300),
        (1.0, 1.0 + f64::EPSILON),
        (1.0, f64::NAN),
    ] {
        cases.push(Case::refusal(
            "press::BondedLayer::new",
            format!("thickness {thickness:e}, depth {depth:e}"),
            move || BondedLayer::new(thickness, depth),
        ));
    }
    for a in [f64::NAN, f64::INFINITY, 0.0, -1.0, 50.0 * (1.0 + 1e-9)] {
        cases.push(Case::refusal(
            "press::BondedLayer::contact",
            format!("thickness 1, radius {a:e}"),
            move || BondedLayer::new(1.0, 0.5)?.contact(a),
        ));
        cases.push(Case::refusal(
            "press::BondedLayer::contact_radius",
            format!("thickness 1, indentation over curvature {:e}", a * a.abs()),
            move || BondedLayer::new(1.0, 0.5)?.contact_radius(a * a.abs()),
        ));
    }
    for a in [f64::MIN_POSITIVE, f64::from_bits(1), 1e-200] {
        cases.push(Case::new(
            "press::BondedLayer::contact",
            format!("thickness 1, radius {a:e}"),
            move || extremely_narrow(a).into(),
        ));
    }
    cases.push(Case::refusal(
        "press::Body::press",
        "layer of thickness 1e-6, indentation as much",
        || Body::bonded_layer(1e-6, 0.0)?.press(1.0, 1e-6).map(drop),
    ));
    cases.push(Case::refusal(
        "press::Body::press",
        "layer of thickness 1e-6, relative curvature 1e-9, indentation 1e-9",
        || Body::bonded_layer(1e-6, 0.0)?.press(1e-9, 1e-9).map(drop),
    ));
    cases
}

/// Under the object the surface follows it: D − r²/2.
fn under_the_object(ratio: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for thickness in THICKNESSES {
        let layer = BondedLayer::new(thickness, 0.0)?;
        let a = ratio * thickness;
        let contact = layer.contact(a)?;
        let [indentation, _] = contact.indentation();
        for share in [0.0, 1e-9, 0.3, 0.8, 0.99] {
            let r = share * a;
            let truth = indentation - 0.5 * r * r;
            pairs.push((contact.field(r).normal / indentation, truth / indentation));
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-7))
}

fn round_trip(ratio: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for thickness in THICKNESSES {
        let layer = BondedLayer::new(thickness, 0.0)?;
        let a = ratio * thickness;
        let [indentation, slope] = layer.indentation_of(a)?;
        pairs.push((layer.contact_radius(indentation)?, a));
        assert!(slope > 0.0, "D grows with a");
    }
    Ok(Answer::all_near(pairs).within(1e-12))
}

fn at_the_base(ratio: f64) -> Result<Answer, PressError> {
    let layer = BondedLayer::new(1.0, 1.0)?;
    let contact = layer.contact(ratio)?;
    let moved = [0.0, 0.5, 1.0, 2.0].map(|share| contact.field(share * ratio));
    let pairs = moved.map(|field| (libm::hypot(field.normal, field.radial), 0.0));
    Ok(Answer::all_at_scale(pairs, ratio * ratio))
}

/// The first correction to a half-space is of the order of a/t.
fn narrow(thickness: f64) -> Result<Answer, PressError> {
    let a = 1e-9 * thickness;
    let [indentation, slope] = BondedLayer::new(thickness, 0.0)?.indentation_of(a)?;
    Ok(Answer::all_near([(indentation, a * a), (slope, 2.0 * a)]).within(2e-9))
}

fn wide(thickness: f64) -> Result<Answer, PressError> {
    let a = 50.0 * thickness;
    let [indentation, _] = BondedLayer::new(thickness, 0.0)?.indentation_of(a)?;
    Ok(Answer::near(indentation, 0.25 * a * a).within(3.0 / 50.0))
}

fn shallow(thickness: f64) -> Result<Answer, PressError> {
    let a = 1e-7 * thickness;
    let contact = BondedLayer::new(thickness, a)?.contact(a)?;
    let half_space = Body::half_space(0.5, a)?;
    let mut pairs = Vec::new();
    for share in [0.0, 0.5, 1.0, 3.0] {
        let field = contact.field(share * a);
        let truth = half_space.press(1.0 / a, a)?.displacement(share * a);
        pairs.push((field.normal / a / a, truth.normal / a));
        pairs.push((field.radial / a / a, truth.radial / a));
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(2e-7))
}

fn extremely_narrow(a: f64) -> Result<Answer, PressError> {
    let contact = BondedLayer::new(1.0, 0.5)?.contact(a)?;
    let field = contact.field(1.0);
    let [indentation, slope] = contact.indentation();
    let stated = [contact.force(), contact.peak_pressure(), field.radial];
    Ok(Answer::at_scale(indentation, 0.0, 1.0)
        .also(stated)
        .also([slope, field.normal, field.normal_per_a, field.normal_per_r])
        .within(1e-300))
}
