//! Converts the fields of a scene to a comparable form. All lengths are divided by one length of the scene: the radius
//! of the probe, or for glides the distance between the outermost fingers. Each quantity has only one name. Therefore
//! equal scenes have equal fields, even if their configs describe them differently.

use std::collections::BTreeMap;

use palpate_study::config::{SceneConfig, in_unit};
use serde_json::{Value as Json, json};

/// Values of the fields of a scene, by path. Values that are 0, false or absent are omitted. Numbers are rounded to ten
/// digits.
pub(super) type Fields = BTreeMap<String, Json>;

/// Beginnings of the paths of fields that are not compared. These fields do not affect readings and estimates, or the
/// random scenes cover all values of these fields.
const IGNORED: [&str; 8] = [
    "scene.model.tolerance",
    "scene.evaluate",
    "scene.principal_curvatures",
    "scene.object_contact",
    "scene.motion.inter_finger_distance",
    "scene.motion.rate_rad_per_s",
    "scene.noise.angular_velocity.instants",
    "scene.noise.angular_velocity.side",
];

/// The length by which all lengths of a scene are divided for a comparison.
pub(super) fn unit_length(scene: &SceneConfig) -> f64 {
    let json = json!(scene);
    let fingers = json["motion"]["finger_positions"].as_array();
    let positions = fingers.into_iter().flatten().filter_map(Json::as_f64);
    let reach = |start: f64, pick: fn(f64, f64) -> f64| positions.clone().fold(start, pick);
    match scene {
        SceneConfig::Glide(_) => reach(f64::MIN, f64::max) - reach(f64::MAX, f64::min),
        _ => json["probe"]["radius"].as_f64().unwrap_or(1.0),
    }
}

/// Fields of a scene in comparable form: all lengths are divided by [`unit_length`] and multiplied by `factor`.
pub(super) fn comparable_fields(scene: &SceneConfig, factor: f64) -> Fields {
    let mut json = json!(in_unit(scene, factor / unit_length(scene)));
    match scene {
        SceneConfig::Roll(_) => name_roll(&mut json),
        SceneConfig::Glide(_) => name_glide(&mut json),
        SceneConfig::Press(press) => {
            name_press(&mut json, press.model.poisson());
        }
        SceneConfig::Fingertip(_) => {}
    }
    let mut fields = Fields::new();
    insert(&mut fields, "scene".to_owned(), json);
    fields.retain(|field, _| !IGNORED.iter().any(|ignored| field.starts_with(ignored)));
    fields
}

/// Inserts every value of a JSON tree into `fields`, with its path as key.
fn insert(fields: &mut Fields, path: String, value: Json) {
    match value {
        Json::Object(table) => {
            for (key, value) in table {
                insert(fields, format!("{path}.{key}"), value);
            }
        }
        Json::Array(items) => {
            for (index, value) in items.into_iter().enumerate() {
                insert(fields, format!("{path}.{index}"), value);
            }
        }
        Json::Null | Json::Bool(false) => {}
        value => {
            let rounded = value.as_f64().map(|number| format!("{number:.9e}"));
            let rounded: Option<f64> = rounded.and_then(|text| text.parse().ok());
            if rounded != Some(0.0) {
                fields.insert(path, rounded.map_or(value, |number| json!(number)));
            }
        }
    }
}

fn number(table: &Json, key: &str) -> f64 {
    table[key].as_f64().unwrap_or(0.0)
}

/// Curvature of an object at its apex; negative for a dish. `None` for an object that is not described by one
/// curvature.
fn curvature(object: &Json) -> Option<f64> {
    match object["kind"].as_str()? {
        "plane" => Some(0.0),
        "sphere" | "cylinder" => Some(number(object, "radius").recip()),
        "dish" => Some(-number(object, "radius").recip()),
        "paraboloid" => Some(2.0 * number(object, "c")),
        "saddle" => Some(2.0 * number(object, "a")),
        _ => None,
    }
}

/// Makes the fields of a roll comparable: the number of directions replaces the directions, and the angle of the roll
/// replaces its arc length or duration.
fn name_roll(roll: &mut Json) {
    let object = curvature(&roll["object"]);
    let motion = &mut roll["motion"];
    // Convert an arc length to a roll angle. Per radian of rotation, a contact moves by 1/(1/R₁ + 1/R₂), where R₁ and
    // R₂ are the radii of probe and object. Here, R₁ is 1, because it is the unit of length.
    let by_arc = object.map_or(0.0, |curvature| {
        (1.0 + curvature) * number(motion, "arc_length")
    });
    let by_rate = number(motion, "rate_rad_per_s") * number(motion, "duration_s");
    let angle = (by_arc.max(by_rate)).to_degrees();
    if angle > 0.0 {
        for key in ["arc_length", "duration_s"] {
            motion[key] = Json::Null;
        }
        motion["angle_deg"] = json!(angle);
    }
    let listed = motion["directions_deg"].as_array().map_or(0, Vec::len);
    let directions = motion["rolls"].as_u64().unwrap_or(listed as u64);
    motion["rolls"] = Json::Null;
    motion["directions_deg"] = json!(format!("{directions} directions"));
    roll["model"] = Json::Null;
}

/// Makes the fields of a glide comparable. The number of fingers replaces their positions, and standard deviations
/// replace the other descriptions of noise. If the estimator assumes exactly the simulated noise, the word `stated`
/// replaces its noise settings.
fn name_glide(glide: &mut Json) {
    let motion = &mut glide["motion"];
    let fingers = motion["finger_positions"].as_array().map_or(0, Vec::len);
    let distance = number(motion, "inter_finger_distance");
    motion["finger_positions"] = json!(format!("{fingers} fingers"));
    glide["model"] = Json::Null;
    if glide["object"]["kind"] != "sphere"
        && let Some(curvature) = curvature(&glide["object"])
    {
        glide["object"] = json!({ "kind": "quadric", "curvature": curvature.abs() });
    }
    if glide["sensor"]["reports"] == "contact" {
        glide["probe"] = Json::Null;
    }
    if glide["sensor"]["normals"] != true {
        glide["noise"]["normal"] = Json::Null;
    }
    let noise = &mut glide["noise"]["position"];
    let size = |key| number(noise, key);
    let std = size("std") + size("bound") / f64::sqrt(3.0);
    let per_std = if noise["kind"] == "uniform" { 3.0 } else { 1.0 };
    let std = std + size("fraction_of_ifd") * distance / f64::sqrt(per_std);
    if !noise.is_null() {
        *noise = json!({ "std": std, "axis": noise["axis"] });
    }
    let tilt = number(&glide["noise"]["normal"], "std_deg");
    let estimator = &mut glide["estimator"];
    let stated = number(estimator, "position_std")
        + number(estimator, "position_fraction_of_ifd") * distance;
    if stated > 0.0 && agrees(stated, std) && agrees(number(estimator, "normal_std_deg"), tilt) {
        for key in ["position_std", "position_fraction_of_ifd", "normal_std_deg"] {
            estimator[key] = Json::Null;
        }
        estimator["noise"] = json!("stated");
    }
}

/// Makes the fields of a press comparable. A ball of the same curvature replaces a sphere, a dish or a plane. The noise
/// of the mean of several frames replaces the noise of one frame and the number of frames. Settings of the estimator
/// that equal the simulated soft body are removed.
fn name_press(press: &mut Json, poisson: f64) {
    // Replace only round objects by a ball of the same curvature. A cylinder or an ellipsoid has no single curvature.
    if !["cylinder", "ellipsoid"]
        .map(Json::from)
        .contains(&press["object"]["kind"])
    {
        press["object"] = json!({ "kind": "ball", "curvature": curvature(&press["object"]) });
    }
    press["motion"]["contact_deg"][1] = Json::Null;
    if press["sensor"]["kind"] == "direct" {
        let averaged = number(&press["sensor"], "frames").sqrt();
        for noise in ["normal_displacement", "tangential_displacement"] {
            let noise = &mut press["noise"][noise];
            noise["std"] = json!(number(noise, "std") / averaged);
        }
        press["sensor"]["frames"] = Json::Null;
    }
    if press["sensor"]["tangential"] != true {
        press["noise"]["tangential_displacement"] = Json::Null;
    }
    let thickness = press["model"]["thickness"].clone();
    if press["model"]["kind"] != "hertz" {
        let kind = if thickness.is_null() {
            "half-space"
        } else {
            "layer"
        };
        press["model"] = json!({ "kind": kind, "thickness": thickness, "poisson": poisson });
    }
    let std = number(&press["noise"]["indentation"], "std");
    let estimator = &mut press["estimator"];
    for (key, of_model) in [("thickness", thickness), ("poisson", json!(poisson))] {
        if estimator[key] == of_model {
            estimator[key] = Json::Null;
        }
    }
    if estimator["indentation"] == "fitted" {
        press["noise"]["indentation"] = Json::Null;
    } else if agrees(number(estimator, "indentation_std"), std) {
        estimator["indentation_std"] = Json::Null;
    }
}

/// Whether a number that the config states to the estimator equals the true number, except for rounding.
fn agrees(stated: f64, truth: f64) -> bool {
    (stated - truth).abs() <= 1e-9 * truth
}
