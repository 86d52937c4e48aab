//! Tests the arguments of `--set` and `--vary`: short names of fields, units, tables that are missing in the config,
//! and labels.

use palpate_study::config::{SceneConfig, Study, Varied, Vary, parse};

use super::{edited, study};

fn resolved(study: &Study, argument: &str) -> String {
    let vary: Vary = argument.parse().unwrap();
    match study.resolve(&vary) {
        Ok(Vary { path, values }) => match values {
            Varied::Range { from, to } => format!("{path} {from}..{to}"),
            Varied::Listed(values) => {
                let values: Vec<String> = values.iter().map(ToString::to_string).collect();
                format!("{path} {}", values.join(" "))
            }
        },
        Err(error) => error.to_string(),
    }
}

/// Checks to which field and values each argument of a table is resolved. Each row of the table is `argument | path and
/// values`, or `argument | error`.
fn resolves(study: &Study, table: &str) {
    for row in table.trim().lines() {
        let (argument, expected) = row.split_once(" | ").unwrap();
        assert_eq!(resolved(study, argument), expected, "{argument}");
    }
}

const NAMES: &str = r#"
duration_s=1..2 | scene.motion.duration_s 1..2
object.radius=5 | scene.object.radius 5
scene.object.radius=5 | scene.object.radius 5
seed=3 | seed 3
rotation.std_deg=0.1 | scene.noise.rotation.std_deg 0.1
pitch=0.1 | scene.sensor.pitch 0.1
radius=5 | study.toml: radius: may be `scene.object.radius` or `scene.probe.radius`; write one of them
std=5 | scene.sensor.std 5
radios=5 | study.toml: radios: no field has this name; did you mean
weather=5 | study.toml: weather: no field has this name; `scene` has estimator, kind, model, motion, noise, object, object_contact, principal_curvatures, probe, sensor
scene.object.radios=5 | study.toml: scene.object.radios: `scene.object` has no `radios`; did you mean `radius`? (known: kind, radius)
noise.rotatoin.std_deg=5 | study.toml: noise.rotatoin: `scene.noise` has no `rotatoin`; did you mean `rotation`? (known: angular_velocity, encoder, rotation)
scene.noise.x=5 | study.toml: scene.noise.x: `scene.noise` has no `x`; known: angular_velocity, encoder, rotation
scene.object.radius.x=5 | study.toml: scene.object.radius.x: `scene.object.radius` is no table
"#;

/// Tests that the last keys of a path suffice to name a field. The table contains only the beginning of long error
/// messages.
#[test]
fn the_last_keys_of_a_path_name_a_field() {
    let study = study("");
    for row in NAMES.trim().lines() {
        let (argument, expected) = row.split_once(" | ").unwrap();
        let found = resolved(&study, argument);
        assert!(found.starts_with(expected), "{argument}: {found}");
    }
}

#[test]
fn values_are_converted_to_the_unit_of_their_field() {
    let study = study("");
    resolves(
        &study,
        r#"
object.radius=8mm | scene.object.radius 0.8
object.radius=3mm,2cm,5 | scene.object.radius 0.3 2.0 5
object.radius=3mm..0.02m | scene.object.radius 0.3..2
object.radius=500 um..1 | scene.object.radius 0.05..1
object.radius=500µm | scene.object.radius 0.05
encoder.step_deg=0.5deg,0.5° | scene.noise.encoder.step_deg 0.5 0.5
encoder.step_rad=180deg | scene.noise.encoder.step_rad 3.14159265359
object.c=0.1/mm,10/m,1 1/cm | scene.object.c 1.0 0.1 1.0
duration_s=500ms,2 min | scene.motion.duration_s 0.5 120.0
rate_rad_per_s=180deg/s | scene.motion.rate_rad_per_s 3.14159265359
angular_velocity.fraction=5 % | scene.noise.angular_velocity.fraction 0.05
object_contact=["1mm", "2mm"] | scene.object_contact [0.1, 0.2]
object.kind=plane | scene.object.kind "plane"
object.formula="2x" | scene.object.formula "2x"
object.radius=two | scene.object.radius "two"
object.radius=2s | study.toml: scene.object.radius: "2s" has the unit "s"; its unit may be m, cm, mm, um, nm, in
duration_s=2mm | study.toml: scene.motion.duration_s: "2mm" has the unit "mm"; its unit may be s, ms, us, ns, min
object.c=2s | study.toml: scene.object.c: "2s" has the unit "s"; its unit may be /m, /cm, /mm, /um, /nm, /in
object.radius=1in | scene.object.radius 2.54
object.radius=2cm..1mm | study.toml: scene.object.radius: the range 2cm..1mm runs downwards; write 1mm..2cm
"#,
    );
    let without_unit = parse("study.toml", &edited("length_unit = \"cm\"\n", "")).unwrap();
    let error = resolved(&without_unit, "object.radius=2cm");
    let expected =
        "\"2cm\" has the unit \"cm\"; the config states no `length_unit`; leave the unit out";
    assert!(error.ends_with(expected), "{error}");
}

fn with(study: &Study, arguments: &[&str]) -> Result<Study, String> {
    let resolve = |argument: &&str| {
        let vary: Vary = argument.parse().unwrap();
        let Varied::Listed(values) = vary.values else {
            panic!("{argument} is a range")
        };
        study.resolve_values(&vary.path, &values)
    };
    let fields: Result<Vec<_>, _> = arguments.iter().map(resolve).collect();
    let fields = fields.map_err(|error| error.to_string())?;
    study.varied(&fields).map_err(|error| error.to_string())
}

#[test]
fn tables_that_the_config_leaves_out_are_made() {
    let study = study("");
    let noise = |arguments: &[&str]| -> Result<String, String> {
        let study = with(&study, arguments)?;
        match study.cell(0).unwrap().config.scene {
            SceneConfig::Roll(roll) => Ok(toml::Value::try_from(&roll.noise).unwrap().to_string()),
            other => panic!("{other:?}"),
        }
    };
    for (arguments, expected) in [
        (
            &["noise.rotation.std_deg=0.1"][..],
            r#"{ rotation = { kind = "gaussian", std_deg = 0.1 } }"#,
        ),
        (
            &["encoder.step_deg=0.1", "rotation.std_rad=0.1"],
            r#"{ rotation = { kind = "gaussian", std_rad = 0.1 }, encoder = { step_deg = 0.1 } }"#,
        ),
        (
            // An argument may set fields of a kind before a later argument sets this kind.
            &[
                "angular_velocity.fraction=0.1",
                "angular_velocity.kind=uniform",
            ],
            r#"{ angular_velocity = { kind = "uniform", fraction = 0.1, when = "per-probe", side = "motion", instants = 100 } }"#,
        ),
    ] {
        assert_eq!(noise(arguments).unwrap(), expected);
    }
    let error = noise(&["angular_velocity.fraction=0.1"]).unwrap_err();
    let expected = "`scene.noise.angular_velocity` is left out in the config; set `scene.noise.angular_velocity.kind` too: uniform or gaussian";
    assert!(error.contains(expected), "{error}");
    let error = noise(&["angular_velocity.kind=uniform"]).unwrap_err();
    assert!(
        error.contains("scene.noise.angular_velocity.fraction: missing key"),
        "{error}"
    );
}

#[test]
fn tables_need_no_label() {
    let study = study("");
    let coordinates = |argument: &str| {
        let study = with(&study, &[argument]).unwrap();
        let cells = study.cells().map(|cell| cell.coordinates.concat());
        cells.collect::<Vec<_>>()
    };
    assert_eq!(
        coordinates(r#"scene.sensor={ kind = "pads", pitch = 0.1 }"#),
        ["pads"]
    );
    assert_eq!(
        coordinates(
            r#"scene.object={ kind = "plane" },{ kind = "sphere", radius = 3 },{ kind = "sphere", radius = 4 }"#
        ),
        [
            "plane",
            r#"{ kind = "sphere", radius = 3 }"#,
            r#"{ kind = "sphere", radius = 4 }"#
        ]
    );
    assert_eq!(
        coordinates(r#"scene.object={ label = "flat", kind = "plane" }"#),
        ["flat"]
    );
}

#[test]
fn lists_are_toml_or_words() {
    let values = |text: &str| match format!("a.b={text}").parse::<Vary>() {
        Ok(Vary {
            values: Varied::Listed(values),
            ..
        }) => values
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join(" "),
        other => format!("{other:?}"),
    };
    assert_eq!(values("1, 2.5,true"), "1 2.5 true");
    assert_eq!(values("hue,both"), "\"hue\" \"both\"");
    assert_eq!(values("\"a,b\",3"), "\"a,b\" 3");
    assert_eq!(values("[1, 2],[3, 4]"), "[1, 2] [3, 4]");
    assert_eq!(values("\"a..b\""), "\"a..b\"");
    assert!(values("{ label = \"x\", kind = \"plane\" }").contains("plane"));
}

#[test]
fn what_is_no_field_with_values() {
    for (text, said) in [
        ("scene.sensor.pitch", "is not of the form PATH=LO..HI"),
        ("=1..2", "is not of the form PATH"),
        ("scene.sensor.pitch=", "is not of the form PATH"),
        ("a b=1", "is not of the form PATH"),
        ("a=,", "is not of the form PATH"),
        ("a=1..", "\"\" is not a finite number"),
        ("a=1..nan", "\"nan\" is not a finite number"),
        ("a=2..1", "write 1..2"),
    ] {
        let error = text.parse::<Vary>().expect_err(text).to_string();
        assert!(error.contains(said), "{text}: {error}");
    }
}
