//! Writes configs together with their defaults, in the form that is saved with the results.

use super::schema::{SCHEMA, variant};
use super::study::{SceneConfig, StudyConfig};
use super::sweep::SweepConfig;
use super::{tree, validate};
use toml::Value;

/// The config as TOML text, including all defaults. Parsing the text returns the same config.
///
/// The text omits the default of `directions_deg` if the config states `rolls` instead. If a sweep varies the `kind` of
/// a table, the text omits the default values of this table, because other kinds may not have these keys.
///
/// ```
/// use palpate_study::config::{parse, to_toml};
///
/// let text = r#"
///     name = "roll-on-a-ball"
///     scene.kind = "roll"
///     scene.probe = { kind = "sphere", radius = 1.0 }
///     scene.object = { kind = "sphere", radius = 4.0 }
///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let study = parse("study.toml", text)?;
/// let resolved = to_toml(&study.config);
/// assert!(resolved.contains("seed = 0"));
/// assert_eq!(parse("run.toml", &resolved)?.config, study.config);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_toml(config: &StudyConfig) -> String {
    // Convert the config to a TOML table before the text is written. Without this step, the program would contain
    // several copies of the code that writes a config, one for each nesting depth of the text.
    let table = toml::Table::try_from(config)
        .expect("strings, numbers, arrays and tables all have a TOML form");
    let paths = config.sweep.iter().flat_map(SweepConfig::targets);
    let swept: Vec<&str> = paths
        .filter_map(|path| path.strip_suffix(".kind"))
        .collect();
    let has_rolls = matches!(&config.scene, SceneConfig::Roll(roll) if roll.motion.rolls.is_some());
    let mut config = Value::Table(table);
    let motion = tree::at_mut(&mut config, "scene.motion").and_then(Value::as_table_mut);
    if let Some(motion) = motion.filter(|_| has_rolls) {
        motion.remove("directions_deg");
    }
    for path in swept {
        drop_defaults(&mut config, path);
    }
    config
        .as_table()
        .map_or_else(String::new, toml::Table::to_string)
}

/// Removes all keys that have their default values from the table at a path.
fn drop_defaults(config: &mut Value, path: &str) {
    let schema = validate::at(&SCHEMA, config, path);
    let table = tree::at_mut(config, path).and_then(Value::as_table_mut);
    let Some((schema, table)) = schema.zip(table) else {
        return;
    };
    let Some(variant) = variant(schema, table.get("kind").and_then(Value::as_str)) else {
        return;
    };
    table.retain(|key, value| {
        let default = variant["properties"][key].get("default");
        default.is_none() || serde_json::to_value(&*value).ok().as_ref() != default
    });
}
