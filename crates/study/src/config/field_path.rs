//! Paths of the fields of a config, and short forms of these paths.

use super::error::ConfigError;
use super::load::Study;
use super::schema::{SCHEMA, fields_at, variants};
use super::tree::{quoted, suggest};
use super::validate::{self, kind_of};
use serde_json::Value as Json;
use toml::Value;

impl Study {
    /// Path of the field to which `name` refers. The name is the whole path, or the last keys of the path if no other
    /// path ends with these keys.
    ///
    /// ```
    /// use palpate_study::config::parse;
    ///
    /// let text = r#"
    ///     name = "roll-on-a-ball"
    ///     scene.kind = "roll"
    ///     scene.probe = { kind = "sphere", radius = 1.0 }
    ///     scene.object = { kind = "sphere", radius = 4.0 }
    ///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
    /// "#;
    /// let study = parse("study.toml", text)?;
    /// assert_eq!(study.path_of("duration_s")?, "scene.motion.duration_s");
    /// assert_eq!(study.path_of("object.radius")?, "scene.object.radius");
    /// let error = study.path_of("radius").expect_err("two bodies have a radius");
    /// assert_eq!(
    ///     error.to_string(),
    ///     "study.toml: radius: may be `scene.object.radius` or `scene.probe.radius`; write one of them"
    /// );
    /// # Ok::<(), palpate_study::config::ConfigError>(())
    /// ```
    ///
    /// # Errors
    /// [`ConfigError`] if no field ends with the name, or if several do.
    pub fn path_of(&self, name: &str) -> Result<String, ConfigError> {
        let tree = self.first_tree();
        let is_path = validate::at(&SCHEMA, &tree, name).is_some();
        let keys: Vec<&str> = name.split('.').collect();
        if is_path || !fields_at(&SCHEMA, &keys).is_empty() {
            return Ok(name.to_owned());
        }
        let refuse = |message| Err(ConfigError::of_field(self.file(), name, message));
        let ending = format!(".{name}");
        // First search only the kinds of tables that occur in this config. If no field of these kinds has the name,
        // search all kinds.
        for in_any_kind in [false, true] {
            let mut paths = paths(&tree, in_any_kind);
            paths.retain(|path| path.ends_with(&ending));
            match paths.as_slice() {
                [] => {}
                [path] => return Ok(path.clone()),
                several => {
                    let several = quoted(several.iter().map(String::as_str));
                    return refuse(format!("may be {several}; write one of them"));
                }
            }
        }
        match name.rsplit_once('.') {
            None => refuse(unknown_name(&tree, name)),
            Some((parent, key)) => {
                let parent = self.path_of(parent)?;
                refuse(unknown_key(&tree, &parent, key))
            }
        }
    }
}

/// Paths of all fields that a scene can have. The key `kind` of a table decides which fields the table has. If
/// `in_any_kind` is true, the list contains the fields of all kinds of each table. Otherwise, it contains the fields of
/// the kind that the config tree `tree` states. For a table that is missing in `tree`, it contains the fields of all
/// kinds.
fn paths(tree: &Value, in_any_kind: bool) -> Vec<String> {
    fn visit(schema: &Json, node: Option<&Value>, path: &str, any: bool, found: &mut Vec<String>) {
        let kind = node.and_then(|node| node.get("kind")?.as_str());
        let is_of_kind = |variant: &&Json| any || kind.is_none() || kind_of(variant) == kind;
        for variant in variants(schema).iter().filter(is_of_kind) {
            let properties = variant["properties"].as_object().into_iter().flatten();
            for (key, property) in properties {
                let path = format!("{path}.{key}");
                if !found.contains(&path) {
                    found.push(path.clone());
                }
                visit(
                    property,
                    node.and_then(|node| node.get(key)),
                    &path,
                    any,
                    found,
                );
            }
            if variant["additionalProperties"].is_object() {
                let table = node.and_then(Value::as_table).into_iter().flatten();
                found.extend(table.map(|(key, _)| format!("{path}.{key}")));
            }
            let items = variant["maxItems"].as_u64().unwrap_or(0);
            found.extend((0..items).map(|index| format!("{path}.{index}")));
        }
    }
    let mut found = Vec::new();
    let scene = &SCHEMA["properties"]["scene"];
    // `in_any_kind` does not apply to the table `scene` itself: if `tree` states a known `scene.kind`, list only the
    // fields of that kind of scene.
    let kind = tree
        .get("scene")
        .and_then(|scene| scene.get("kind")?.as_str());
    let of_kind = variants(scene)
        .iter()
        .find(|variant| kind_of(variant) == kind);
    visit(
        of_kind.unwrap_or(scene),
        tree.get("scene"),
        "scene",
        in_any_kind,
        &mut found,
    );
    found
}

fn keys_of(tree: &Value, table: &str) -> Vec<String> {
    let all = paths(tree, false);
    let under = format!("{table}.");
    let keys = all.iter().filter_map(|path| path.strip_prefix(&under));
    let keys = keys.filter(|key| !key.contains('.'));
    keys.map(str::to_owned).collect()
}

fn unknown_key(tree: &Value, table: &str, key: &str) -> String {
    let keys = keys_of(tree, table);
    match keys.as_slice() {
        [] => format!("`{table}` is no table"),
        keys => format!(
            "`{table}` has no `{key}`; {}",
            suggest(key, keys.iter().map(String::as_str))
        ),
    }
}

/// Message for a path that does not lead to a field. It states the first key of the path that does not exist, and the
/// keys that exist at this place. `None` if the path leads to a field.
pub(super) fn unknown_path(tree: &Value, path: &str) -> Option<String> {
    let exists = |path: &str| {
        let keys: Vec<&str> = path.split('.').collect();
        validate::at(&SCHEMA, tree, path).is_some() || !fields_at(&SCHEMA, &keys).is_empty()
    };
    let ends = path.match_indices('.').map(|(end, _)| end);
    let mut ends = ends.chain([path.len()]);
    let end = ends.find(|&end| !exists(&path[..end]))?;
    let (table, key) = path[..end].rsplit_once('.')?;
    let keys = keys_of(tree, table);
    (!keys.is_empty()).then(|| unknown_key(tree, table, key))
}

/// Message for a key that no field has. It lists the fields with the most similar keys or, if no key is similar, the
/// tables of the scene.
fn unknown_name(tree: &Value, name: &str) -> String {
    const MAX_SIMILAR: usize = 5;
    const MIN_SIMILARITY: f64 = 0.8;
    let paths = paths(tree, true);
    let similarity = |path: &String| {
        let key = path.rsplit('.').next().unwrap_or_default();
        strsim::jaro_winkler(name, key)
    };
    let mut near: Vec<(f64, &str)> = paths
        .iter()
        .map(|path| (similarity(path), path.as_str()))
        .collect();
    near.retain(|(similarity, _)| *similarity >= MIN_SIMILARITY);
    near.sort_by(|one, other| other.0.total_cmp(&one.0));
    near.truncate(MAX_SIMILAR);
    match near.is_empty() {
        false => format!(
            "no field has this name; did you mean {}?",
            quoted(near.iter().map(|(_, path)| *path))
        ),
        true => format!(
            "no field has this name; `scene` has {}",
            keys_of(tree, "scene").join(", ")
        ),
    }
}
