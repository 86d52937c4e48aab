//! Tests configs that are created and changed by code.

use palpate_study::config::{of_json, parse, with_axes, with_fields};
use serde_json::{Value, json};

fn config() -> Value {
    json!({
        "name": "roll-on-a-ball",
        "scene": {
            "kind": "roll",
            "probe": { "kind": "sphere", "radius": 1.0 },
            "object": { "kind": "sphere", "radius": 4.0 },
            "motion": { "rate_rad_per_s": 0.1, "duration_s": 1.0 },
        },
    })
}

fn set(path: &str, value: Value) -> [(String, Value); 1] {
    [(path.to_owned(), value)]
}

#[test]
fn a_json_table_equals_the_same_config_as_text() {
    let text = of_json("made", &config()).unwrap();
    let written = r#"
        name = "roll-on-a-ball"
        [scene]
        kind = "roll"
        probe = { kind = "sphere", radius = 1.0 }
        object = { kind = "sphere", radius = 4.0 }
        motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
    "#;
    assert_eq!(
        parse("made", &text).unwrap().config,
        parse("made", written).unwrap().config
    );
}

#[test]
fn fields_are_set_added_and_removed() {
    let text = of_json("made", &config()).unwrap();
    let with = |path: &str, value: Value| with_fields("made", &text, &set(path, value));
    let radius = |text: &str| {
        let study = parse("made", text).unwrap();
        serde_json::to_value(&study.config).unwrap()["scene"]["object"]["radius"].clone()
    };
    assert_eq!(
        radius(&with("scene.object.radius", json!(7.5)).unwrap()),
        7.5
    );
    let pads = json!({ "kind": "pads", "pitch": 0.25 });
    let text_with_pads = with("scene.sensor", pads).unwrap();
    assert!(text_with_pads.contains("pitch = 0.25"));
    let without = with_fields("made", &text_with_pads, &set("scene.sensor", Value::Null));
    assert_eq!(
        parse("made", &without.unwrap()).unwrap().config,
        parse("made", &text).unwrap().config
    );
    // `name` is not a table, so it has no field `first`.
    let error = with("name.first", json!(1)).unwrap_err();
    assert_eq!(error.path, "name.first");
    let error = with_fields("made", "name = [", &set("name", json!("x"))).unwrap_err();
    assert!(error.to_string().starts_with("made"), "{error}");
}

#[test]
fn axes_multiply_and_need_lists() {
    let text = of_json("made", &config()).unwrap();
    let two = with_axes(
        "made",
        &text,
        &set("scene.object.radius", json!([2.0, 4.0])),
    )
    .unwrap();
    let six = with_axes("made", &two, &set("seed", json!([1, 2, 3]))).unwrap();
    assert_eq!(parse("made", &six).unwrap().cell_count(), 6);
    let error = with_axes("made", &text, &set("seed", json!(1))).unwrap_err();
    assert_eq!(error.path, "seed");
    assert!(error.to_string().contains("list of values"), "{error}");
}

#[test]
fn values_without_a_toml_form_are_rejected() {
    for (config, path) in [
        (json!([1]), ""),
        (json!("name"), ""),
        (json!({ "seed": u64::MAX }), "seed"),
    ] {
        let error = of_json("made", &config).unwrap_err();
        assert_eq!(error.path, path);
    }
}
