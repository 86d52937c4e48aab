//! Bonded layers, from contacts much narrower than they are thick to the widest that are solved.

use palpate_press::{Body, BondedLayer, PressError};
use palpate_verdict::{Answer, NO_LENGTHS, rows};

const NEW: &str = "press::BondedLayer::new";
const CONTACT: &str = "press::BondedLayer::contact";
const RADIUS: &str = "press::BondedLayer::contact_radius";
const INDENTATION: &str = "press::BondedLayer::indentation_of";
const FIELD: &str = "press::LayerContact::field";
const PRESS: &str = "press::Body::press";
const AT_DEPTHS: &str = "press::BondedLayer::at_depths";
const LAYERS: &str = "press::Body::bonded_layers";
/// Depths that are made together, in thicknesses.
const DEPTHS: [f64; 3] = [0.0, 0.4, 1.0];
/// Thicknesses, length.
const THICKNESSES: [f64; 5] = [1e-40, 1e-6, 1.0, 1e6, 1e40];
/// Radii of the contact, in thicknesses.
const RADII: [f64; 12] = [
    1e-12, 1e-6, 1e-3, 0.1, 0.5, 1.0, 3.0, 7.0, 11.9, 13.0, 29.0, 50.0,
];
/// Radius just beyond the widest that is solved, in thicknesses.
const TOO_WIDE: f64 = 50.0 * (1.0 + 1e-9);
const NO_LAYERS: [(f64, f64); 8] = [
    (f64::NAN, 0.0),
    (f64::INFINITY, 0.0),
    (0.0, 0.0),
    (-1.0, 0.0),
    (f64::from_bits(1), 0.0),
    (1.0, -1e-300),
    (1.0, 1.0 + f64::EPSILON),
    (1.0, f64::NAN),
];

rows! {
    FIELD, "surface of the contact, {ratio:e} thicknesses wide, thicknesses 1e-40 to 1e40" => under_the_object(ratio),
        for ratio in RADII;
    RADIUS, "of the indentation of a contact {ratio:e} thicknesses wide" => round_trip(ratio), for ratio in RADII;
    CONTACT, "displacement at the base, contact {ratio:e} thicknesses wide: 0" => at_the_base(ratio),
        for ratio in RADII;
    INDENTATION, "thickness {thickness:e}, contact 1e-9 of it: a half-space's a²" => narrow(thickness),
        for thickness in THICKNESSES;
    INDENTATION, "thickness {thickness:e}, contact 50 times as wide: a²/4 and a share of t/a" => wide(thickness),
        for thickness in THICKNESSES;
    FIELD, "thickness {thickness:e}, contact and depth 1e-7 of it: that of a half-space" => shallow(thickness),
        for thickness in THICKNESSES;
    CONTACT, "thickness 1, radius {a:e}" => extremely_narrow(a),
        for a in [f64::MIN_POSITIVE, f64::from_bits(1), 1e-200];
    NEW, "thickness {thickness:e}, depth {depth:e}", "bad-setting" => BondedLayer::new(thickness, depth),
        for (thickness, depth) in NO_LAYERS;
    CONTACT, "thickness 1, radius {a:e}", "out-of-range" => layer(1.0).contact(a), for a in [f64::NAN, 0.0, -1.0];
    CONTACT, "thickness 1, radius {a:e}", "layer-too-thin" => layer(1.0).contact(a), for a in [f64::INFINITY, TOO_WIDE];
    RADIUS, "thickness 1, indentation over curvature {over:e}", "no-indentation" => layer(1.0).contact_radius(over),
        for over in [f64::NAN, 0.0, -1.0];
    RADIUS, "thickness 1, indentation over curvature {over:e}", "layer-too-thin" => layer(1.0).contact_radius(over),
        for over in [f64::INFINITY, TOO_WIDE * TOO_WIDE];
    PRESS, "layer of thickness 1e-6, indentation as much", "too-deep" => pressed(1.0, 1e-6);
    PRESS, "layer of thickness 1e-6, relative curvature 1e-9, indentation 1e-9", "layer-too-thin" =>
        pressed(1e-9, 1e-9);
    AT_DEPTHS, "thickness {thickness:e}, depths 0 to all of it: as each alone" => together(thickness),
        for thickness in [1e-40, 1e40];
    LAYERS, "thickness {thickness:e}, depths 0 to all of it: as each alone" => bodies_together(thickness),
        for thickness in [1e-40, 1e40];
    AT_DEPTHS, "thickness {thickness:e}, no depths: no layers" =>
        BondedLayer::at_depths(thickness, &[]).map(|layers| Answer::holds(layers.is_empty())),
        for thickness in THICKNESSES;
    AT_DEPTHS, "thickness {thickness:e}, depths 0 and {depth:e}", "bad-setting" =>
        BondedLayer::at_depths(thickness, &[0.0, depth]), for (thickness, depth) in NO_LAYERS;
    LAYERS, "thickness {thickness:e}, depths 0 and {depth:e}", "bad-setting" =>
        Body::bonded_layers(thickness, &[0.0, depth]), for (thickness, depth) in NO_LAYERS;
    LAYERS, "thickness {thickness:e}, no depths", "bad-setting" => Body::bonded_layers(thickness, &[]),
        for thickness in NO_LENGTHS;
}

fn layer(thickness: f64) -> BondedLayer {
    BondedLayer::new(thickness, 0.0).unwrap()
}

fn pressed(curvature: f64, indentation: f64) -> Result<(), PressError> {
    let body = Body::bonded_layer(1e-6, 0.0).unwrap();
    body.press(curvature, indentation).map(drop)
}

/// Under the object the surface follows it: D − r²/2.
fn under_the_object(ratio: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for thickness in THICKNESSES {
        let a = ratio * thickness;
        let contact = layer(thickness).contact(a)?;
        let [indentation, _] = contact.indentation();
        for r in [0.0, 1e-9, 0.3, 0.8, 0.99].map(|share| share * a) {
            let truth = indentation - 0.5 * r * r;
            pairs.push((contact.field(r).normal / indentation, truth / indentation));
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-7))
}

fn round_trip(ratio: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for thickness in THICKNESSES {
        let a = ratio * thickness;
        let [indentation, slope] = layer(thickness).indentation_of(a)?;
        pairs.push((layer(thickness).contact_radius(indentation)?, a));
        assert!(slope > 0.0, "D grows with a");
    }
    Ok(Answer::all_near(pairs).within(1e-12))
}

fn at_the_base(ratio: f64) -> Result<Answer, PressError> {
    let contact = BondedLayer::new(1.0, 1.0)?.contact(ratio)?;
    let moved = [0.0, 0.5, 1.0, 2.0].map(|share| contact.field(share * ratio));
    let pairs = moved.map(|field| (libm::hypot(field.normal, field.radial), 0.0));
    Ok(Answer::all_at_scale(pairs, ratio * ratio))
}

/// The first correction to a half-space is of the order of a/t.
fn narrow(thickness: f64) -> Result<Answer, PressError> {
    let a = 1e-9 * thickness;
    let [indentation, slope] = layer(thickness).indentation_of(a)?;
    Ok(Answer::all_near([(indentation, a * a), (slope, 2.0 * a)]).within(2e-9))
}

fn wide(thickness: f64) -> Result<Answer, PressError> {
    let a = 50.0 * thickness;
    let [indentation, _] = layer(thickness).indentation_of(a)?;
    Ok(Answer::near(indentation, 0.25 * a * a).within(3.0 / 50.0))
}

fn shallow(thickness: f64) -> Result<Answer, PressError> {
    let a = 1e-7 * thickness;
    let contact = BondedLayer::new(thickness, a)?.contact(a)?;
    let half_space = Body::half_space(0.5, a)?;
    let pressed = half_space.press(1.0 / a, a)?;
    let pairs = [0.0, 0.5, 1.0, 3.0].map(|share| {
        let (field, truth) = (contact.field(share * a), pressed.displacement(share * a));
        let normals = (field.normal / a / a, truth.normal / a);
        [normals, (field.radial / a / a, truth.radial / a)]
    });
    Ok(Answer::all_at_scale(pairs.into_iter().flatten(), 1.0).within(2e-7))
}

fn extremely_narrow(a: f64) -> Result<Answer, PressError> {
    let contact = BondedLayer::new(1.0, 0.5)?.contact(a)?;
    let field = contact.field(1.0);
    let [indentation, slope] = contact.indentation();
    Ok(Answer::at_scale(indentation, 0.0, 1.0)
        .also([contact.force(), contact.peak_pressure(), field.radial])
        .also([slope, field.normal, field.normal_per_a, field.normal_per_r])
        .within(1e-300))
}

/// Displacements under layers that are made together, with those under each made alone, over a²: of contacts half and
/// thirteen times as wide as the layer is thick.
fn together(thickness: f64) -> Result<Answer, PressError> {
    let depths = DEPTHS.map(|share| share * thickness);
    let mut pairs = Vec::new();
    for (one, depth) in BondedLayer::at_depths(thickness, &depths)?
        .iter()
        .zip(depths)
    {
        let alone = BondedLayer::new(thickness, depth)?;
        for a in [0.5, 13.0].map(|ratio| ratio * thickness) {
            let [one, alone] = [one.contact(a)?, alone.contact(a)?];
            for r in [0.0, 0.5, 1.0, 2.0].map(|share| share * a) {
                let [one, alone] = [one.field(r), alone.field(r)];
                pairs.push((one.normal / a / a, alone.normal / a / a));
                pairs.push((one.radial / a / a, alone.radial / a / a));
            }
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0))
}

/// Displacements of bodies made together, with those of each made alone, in thicknesses.
fn bodies_together(thickness: f64) -> Result<Answer, PressError> {
    let depths = DEPTHS.map(|share| share * thickness);
    let mut pairs = Vec::new();
    for (one, depth) in Body::bonded_layers(thickness, &depths)?.iter().zip(depths) {
        let alone = Body::bonded_layer(thickness, depth)?;
        let (curvature, indentation) = (0.1 / thickness, 0.05 * thickness);
        let one = one.press(curvature, indentation)?;
        let alone = alone.press(curvature, indentation)?;
        for r in [0.0, 0.5, 1.0, 2.0].map(|share| share * thickness) {
            let [one, alone] = [one.displacement(r), alone.displacement(r)];
            pairs.push((one.normal / thickness, alone.normal / thickness));
            pairs.push((one.radial / thickness, alone.radial / thickness));
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0))
}
