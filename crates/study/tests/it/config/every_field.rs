//! Tests that every number of a scene can be swept and varied. If a number cannot be varied, a message must state the
//! reason.

use palpate_study::config::{Takes, parse, schema, to_toml};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;

/// A valid scene of each kind, with few optional tables.
const SCENES: [&str; 6] = [
    r#"{ "kind": "roll", "probe": { "kind": "sphere", "radius": 2 }, "object": { "kind": "sphere", "radius": 5 },
        "motion": { "rate_rad_per_s": 0.1, "angle_deg": 10 } }"#,
    r#"{ "kind": "glide", "probe": { "kind": "sphere", "radius": 2 }, "object": { "kind": "sphere", "radius": 5 },
        "motion": { "finger_positions": [-1, 0, 1], "inter_finger_distance": 1, "patch_length": 2,
        "contacts_per_finger": 5 },
        "evaluate": { "half_width": 1, "gaussian_threshold": 1, "mean_threshold": 0.1 } }"#,
    r#"{ "kind": "press", "probe": { "kind": "marker-sphere", "radius": 20, "marker_depth": 0.5,
        "discs": { "magenta_diameter": 1, "yellow_diameter": 1, "separation": 0.5 } },
        "object": { "kind": "sphere", "radius": 30 }, "motion": { "indentation": 1 } }"#,
    r#"{ "kind": "press", "probe": { "kind": "marker-sphere", "radius": 20, "marker_depth": 0.5,
        "discs": { "magenta_diameter": 1, "yellow_diameter": 1, "separation": 0.5 } },
        "object": { "kind": "sphere", "radius": 30 }, "motion": { "indentation": 1 },
        "model": { "kind": "bonded-layer", "thickness": 4 }, "sensor": { "kind": "projected" } }"#,
    r#"{ "kind": "press", "probe": { "kind": "marker-sphere", "radius": 20, "marker_depth": 0.5,
        "discs": { "magenta_diameter": 1, "yellow_diameter": 1, "separation": 0.5 } },
        "object": { "kind": "sphere", "radius": 30 }, "motion": { "indentation": 1 },
        "sensor": { "kind": "rendered" } }"#,
    r#"{ "kind": "fingertip", "probe": { "kind": "marker-sphere", "radius": 20, "marker_depth": 0.5 } }"#,
];

/// Fields that the schema accepts in these scenes, but the parser rejects, because a projected sensor has no pixels.
const REFUSED: [&str; 3] = [
    "press: sensor.blur_px sensor=projected",
    "press: sensor.light_at_rim sensor=projected",
    "press: sensor.seam_width sensor=projected",
];

/// A number in the schema: its path, and the kind of each table on its path.
#[derive(Clone, Debug, Default)]
struct Field {
    path: Vec<String>,
    kinds: Vec<(String, String)>,
    schema: Json,
}

fn kind_of(variant: &Json) -> Option<&str> {
    variant["properties"]["kind"]["const"].as_str()
}

fn numbers(schema: &Json, at: &Field, visit: &mut impl FnMut(Field)) {
    let under = |key: &str| {
        let mut field = at.clone();
        field.path.push(key.to_owned());
        field
    };
    match schema["type"].as_str() {
        Some("number" | "integer") => visit(Field {
            schema: schema.clone(),
            ..at.clone()
        }),
        Some("array") => numbers(&schema["items"], &under("0"), visit),
        _ => {}
    }
    for (key, property) in schema["properties"].as_object().into_iter().flatten() {
        numbers(property, &under(key), visit);
    }
    if schema["additionalProperties"].is_object() {
        numbers(&schema["additionalProperties"], &under("A"), visit);
    }
    for variant in schema["oneOf"].as_array().into_iter().flatten() {
        let mut field = at.clone();
        if let Some(kind) = kind_of(variant) {
            field.kinds.push((at.path.join("."), kind.to_owned()));
        }
        numbers(variant, &field, visit);
    }
}

/// A valid value for a schema, with as little content as possible: a table has only its required keys and, if it has
/// kinds, the given `kind`.
fn instance(schema: &Json, kind: Option<&str>) -> Json {
    if let Some(variants) = schema["oneOf"].as_array() {
        let of_kind = |variant: &&Json| kind.is_none() || kind_of(variant) == kind;
        return instance(variants.iter().find(of_kind).unwrap(), kind);
    }
    if let Some(word) = schema.get("const") {
        return word.clone();
    }
    match schema["type"].as_str() {
        Some("number" | "integer") => json!(values(schema)[0]),
        Some("array") => {
            let least = schema["minItems"].as_u64().unwrap_or(0).max(1);
            let one = instance(&schema["items"], None);
            Json::Array(vec![one; least as usize])
        }
        Some("string") => json!("0*x"),
        Some("boolean") => json!(true),
        _ => {
            let required = schema["required"].as_array().into_iter().flatten();
            let keys = required.filter_map(Json::as_str);
            let pairs =
                keys.map(|key| (key.to_owned(), instance(&schema["properties"][key], None)));
            let mut table: serde_json::Map<String, Json> = pairs.collect();
            if schema["additionalProperties"].is_object() {
                table.insert("A".to_owned(), json!(1.0));
            }
            Json::Object(table)
        }
    }
}

/// Two values within the limits of a number in the schema. They are integers if the number must be whole.
fn values(schema: &Json) -> Vec<Json> {
    let is_whole = schema["type"] == "integer";
    let limit = |key: &str| schema[key].as_f64();
    let fits = |number: &f64| {
        limit("exclusiveMinimum").is_none_or(|least| *number > least)
            && limit("minimum").is_none_or(|least| *number >= least)
            && limit("maximum").is_none_or(|most| *number <= most)
            && (!is_whole || number.fract() == 0.0)
    };
    let default = schema["default"].as_f64();
    let tried = default.into_iter().chain([1.0, 2.0, 0.5, 0.25, 3.0]);
    let mut found: Vec<f64> = Vec::new();
    for number in tried.filter(fits) {
        if !found.contains(&number) {
            found.push(number);
        }
    }
    assert!(found.len() >= 2, "{schema}");
    let written = |number: &f64| match is_whole {
        true => json!(*number as i64),
        false => json!(number),
    };
    found[..2].iter().map(written).collect()
}

/// The scene `base`, changed so that a config can set `field`. Missing tables on the path of the field are added only
/// if palpate cannot add them itself.
fn scene(base: &Json, root: &Json, field: &Field) -> Json {
    let kind = |depth: usize| {
        let path = field.path[..depth].join(".");
        let mut kinds = field.kinds.iter();
        let found = kinds.find(|(at, _)| *at == path);
        found.map(|(_, kind)| kind.as_str())
    };
    // `scene` gets all missing tables on the path of `field`. `needed` gets only the tables that a config must state:
    // the tables without a suitable default, and the tables that contain them.
    let (mut needed, mut scene) = (base.clone(), base.clone());
    let mut schema = root;
    for depth in 1..field.path.len() {
        if let Some(variants) = schema["oneOf"].as_array() {
            let mut variants = variants.iter();
            schema = variants
                .find(|one| kind_of(one) == kind(depth - 1))
                .unwrap();
        }
        let parent = field.path[..depth - 1].iter();
        let pointer: String = parent.map(|key| format!("/{key}")).collect();
        let node = scene.pointer_mut(&pointer).unwrap();
        let key = &field.path[depth - 1];
        schema = match schema["type"] == "array" {
            true => &schema["items"],
            false => &schema["properties"][key],
        };
        let wanted = kind(depth);
        let written = node.get(key).map(|node| node["kind"].as_str() == wanted);
        let default = schema.get("default").filter(|default| !default.is_string());
        let will_do = default.filter(|default| default["kind"].as_str() == wanted);
        match (written, will_do) {
            (Some(true), _) => continue,
            (None, Some(default)) => node[key] = default.clone(),
            _ => {
                node[key] = instance(schema, wanted);
                needed = scene.clone();
            }
        }
    }
    needed
}

fn config(scene: &Json) -> Json {
    json!({ "name": "a-study", "length_unit": "mm", "scene": scene })
}

fn text(config: &Json) -> String {
    palpate_study::config::of_json("study.toml", config).unwrap()
}

fn root(base: &Json) -> Json {
    let schema = schema();
    let variants = schema["properties"]["scene"]["oneOf"].as_array().unwrap();
    let of_kind = |one: &&Json| kind_of(one) == base["kind"].as_str();
    variants.iter().find(of_kind).unwrap().clone()
}

/// The scenes, each with its schema and the numbers in it.
fn fields() -> Vec<(Json, Json, Vec<Field>)> {
    let of_scene = |scene: &str| {
        let base = serde_json::from_str(scene).unwrap();
        let (root, mut all) = (root(&base), Vec::new());
        numbers(&root, &Field::default(), &mut |field| all.push(field));
        (base, root, all)
    };
    SCENES.map(of_scene).into()
}

fn name(base: &Json, field: &Field) -> String {
    let kinds = field.kinds.iter().map(|(at, kind)| format!(" {at}={kind}"));
    let scene = base["kind"].as_str().unwrap();
    format!(
        "{scene}: {}{}",
        field.path.join("."),
        kinds.collect::<String>()
    )
}

#[test]
fn every_number_of_a_scene_can_be_swept_and_varied() {
    let mut outcomes: BTreeMap<String, Option<String>> = BTreeMap::new();
    let scenes = fields();
    let all = scenes
        .iter()
        .flat_map(|(base, root, fields)| fields.iter().map(move |field| (base, root, field)));
    for (base, root, field) in all {
        let name = name(base, field);
        if outcomes.get(&name) == Some(&None) {
            continue;
        }
        let path = format!("scene.{}", field.path.join("."));
        let scene = scene(base, root, field);
        let values = values(&field.schema);
        let mut swept = config(&scene);
        swept["sweep"] = json!([{ "path": path, "values": values }]);
        let study = match parse("study.toml", &text(&swept)) {
            Ok(study) => study,
            Err(error) => {
                assert!(!error.message.contains("names nothing"), "{name}: {error}");
                outcomes.entry(name).or_insert(Some(error.to_string()));
                continue;
            }
        };
        let [first, second] = [0, 1].map(|number| study.cell(number).unwrap().config);
        assert_ne!(first, second, "{name}");
        // Do the same as `palpate design`: look up the varied field in a config that states all defaults, and set the
        // field to at least two values.
        let plain = to_toml(&first);
        let plain = parse("study.toml", &plain).unwrap_or_else(|error| panic!("{name}: {error}"));
        let filled = plain.varied(&[]).unwrap();
        let takes = match field.schema["type"] == "integer" {
            true => Takes::Whole,
            false => Takes::Number,
        };
        let is_item = field.path.last().is_some_and(|key| key == "0");
        if !is_item {
            assert_eq!(filled.takes(&path), Some(takes), "{name}");
        }
        let of_toml = |value: &Json| toml::Value::try_from(value).unwrap();
        let varied = plain.varied(&[(path.clone(), values.iter().map(of_toml).collect())]);
        let varied = varied.unwrap_or_else(|error| panic!("{name}: {error}"));
        let varied = varied.cell(1).unwrap().config;
        assert_eq!(varied.scene, second.scene, "{name}");
        outcomes.insert(name, None);
    }
    let refused = outcomes.iter().filter(|(_, error)| error.is_some());
    let refused: Vec<&str> = refused.map(|(name, _)| name.as_str()).collect();
    assert_eq!(refused, REFUSED, "{outcomes:#?}");
    assert!(outcomes.len() > 130, "{}", outcomes.len());
}

#[test]
fn a_field_outside_the_scene_cannot_be_swept() {
    let base: Json = serde_json::from_str(SCENES[0]).unwrap();
    let swept = |path: &str| {
        let mut swept = config(&base);
        swept["sweep"] = json!([{ "path": path, "values": [1, 2] }]);
        parse("study.toml", &text(&swept))
    };
    for path in ["stop.min_trials", "claims.0", "plot.0.x", "length_unit"] {
        let error = swept(path).unwrap_err();
        assert!(error.message.contains("cannot sweep"), "{error}");
    }
    for path in ["seed", "trials"] {
        assert_eq!(swept(path).unwrap().takes(path), Some(Takes::Whole));
    }
}
