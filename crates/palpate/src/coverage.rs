//! Measured coverage: how often 95 % intervals contained the true value in random scenes, and which family of random
//! scenes a scene belongs to.
//!
//! `cargo xtask intervals` measures the families. A row of its tables is a family: the fields of its scenes, many of them as
//! ranges, and the measured shares.

mod comparable_scene;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use palpate_statistics::Number;
use palpate_study::Rows;
use palpate_study::config::{ConfigError, LengthUnit, SceneConfig, parse, with_fields};
use serde_json::{Value as Json, json};

use comparable_scene::{Fields, comparable_fields, unit_length};

/// Field of the tables: the curvature of a ball or, if negative, of a dish.
const CURVATURE: &str = "scene.object.curvature";

/// Names and texts of the tables of families.
pub const FAMILY_TABLES: [(&str, &str); 4] = [
    ("roll", include_str!("coverage/roll.csv")),
    ("glide", include_str!("coverage/glide.csv")),
    ("press", include_str!("coverage/press.csv")),
    ("image", include_str!("coverage/image.csv")),
];

/// Random scenes of one kind, and how often their intervals contained the true value.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Kind of scene: `roll`, `glide`, `press`.
    pub scene: &'static str,
    /// Name, as in the table.
    pub name: String,
    /// Number of scenes.
    pub scenes: usize,
    /// Share of all trials whose 95 % interval contained the true value. A trial without an interval is a miss.
    pub coverage95: f64,
    /// The lowest share of a scene.
    pub lowest: f64,
    /// Fields of one of the scenes.
    fields: Fields,
    /// Ranges of the scenes' numbers, by field.
    ranges: BTreeMap<String, [f64; 2]>,
}

/// Measured coverage of scenes like one.
#[derive(Clone, Debug, PartialEq)]
pub enum Coverage {
    /// Random scenes of this family were measured.
    Measured(&'static Family),
    /// Random scenes of this family were measured, but some numbers of the scene are outside their ranges, which the text
    /// names.
    Outside(&'static Family, String),
    /// No such scenes were measured, for this reason.
    NotMeasured(String),
}

/// Measured coverage of scenes like this one, whose lengths are in `unit`.
///
/// ```
/// use palpate::{Coverage, coverage};
///
/// let text = r#"
/// name = "a-press"
/// length_unit = "mm"
/// [scene]
/// kind = "press"
/// probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { indentation = 1.0 }
/// noise = { normal_displacement = { kind = "gaussian", std = 0.05 } }
/// sensor = { kind = "direct", tangential = false }
/// estimator = { kind = "half-space", indentation = "fitted" }
/// "#;
/// let study = palpate::parse("a-press.toml", text)?;
/// let config = study.cell(0)?.config;
/// let Coverage::Measured(family) = coverage(&config.scene, config.length_unit) else {
///     panic!("the coverage of such presses was measured");
/// };
/// assert!(family.name.starts_with("half-space, indentation fitted"));
/// assert!(family.holds());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn coverage(scene: &SceneConfig, unit: LengthUnit) -> Coverage {
    let fields = comparable_fields(scene, 1.0);
    let of_kind = families().iter().filter(|one| one.scene == scene.kind());
    let nearest = of_kind
        .map(|family| (family, family.differences(&fields)))
        .min_by_key(|(_, differences)| differences.each_ref().map(Vec::len));
    let Some((family, [others, outside])) = nearest else {
        return Coverage::NotMeasured("no random scenes of this kind".to_owned());
    };
    let words = |fields: &[&String]| {
        let words = fields
            .iter()
            .map(|field| family.in_words(scene, unit, field));
        words.collect::<Vec<_>>().join("; ")
    };
    match (others.is_empty(), outside.is_empty()) {
        (true, true) => Coverage::Measured(family),
        (true, false) => Coverage::Outside(family, words(&outside)),
        _ => Coverage::NotMeasured(format!("random scenes have no {}", words(&others))),
    }
}

/// Config of a scene of a family. `cells` are the columns and cells of its row; those of other columns than fields of a scene
/// are ignored. A cell is a value, a range `low..high`, of which `draw` chooses a number, or `factor * field`, a multiple of
/// the number of an earlier column.
///
/// # Errors
/// [`ConfigError`] of [`with_fields`].
pub fn family_scene<'a>(
    cells: impl Iterator<Item = (&'a str, &'a str)>,
    mut draw: impl FnMut(&str, [f64; 2]) -> f64,
) -> Result<String, ConfigError> {
    let mut fields: Vec<(String, Json)> = vec![("name".to_owned(), json!("family"))];
    for (field, cell) in cells {
        if !field.starts_with("scene.") || cell.is_empty() {
            continue;
        }
        let value = match (range(cell), multiple(cell)) {
            (Some(range), _) => json!(draw(field, range)),
            (None, Some((factor, other))) => {
                let other = fields.iter().find(|(field, _)| field == other);
                json!(factor * other.and_then(|one| one.1.as_f64()).unwrap_or(0.0))
            }
            _ => serde_json::from_str(cell).unwrap_or_else(|_| json!(cell)),
        };
        fields.push(match (field, value.as_f64()) {
            (CURVATURE, Some(curvature)) => {
                let radius = curvature.abs().recip();
                let object = match curvature {
                    0.0 => json!({ "kind": "plane" }),
                    _ if curvature < 0.0 => json!({ "kind": "dish", "radius": radius }),
                    _ => json!({ "kind": "sphere", "radius": radius }),
                };
                ("scene.object".to_owned(), object)
            }
            // Counts are integers.
            (_, Some(number)) if number.fract() == 0.0 => (field.to_owned(), json!(number as i64)),
            _ => (field.to_owned(), value),
        });
    }
    with_fields("family", "", &fields)
}

/// Range in a cell: `low..high`.
fn range(cell: &str) -> Option<[f64; 2]> {
    let (low, high) = cell.split_once("..")?;
    Some([low.parse().ok()?, high.parse().ok()?])
}

/// Multiple of another field's number in a cell: `factor * field`.
fn multiple(cell: &str) -> Option<(f64, &str)> {
    let (factor, field) = cell.split_once(" * ")?;
    Some((factor.parse().ok()?, field))
}

impl Family {
    /// Range of shares in which the intervals count as 95 % intervals.
    pub const HOLDS: [f64; 2] = [0.92, 0.98];

    /// Whether the share is near 95 %.
    pub(crate) fn holds(&self) -> bool {
        (Self::HOLDS[0]..=Self::HOLDS[1]).contains(&self.coverage95)
    }

    /// Family in a row of a table; `None` if the row has no measured coverage, or if its readings contradict
    /// the estimator's model.
    fn of_row(cells: &[(&str, &str)]) -> Option<Self> {
        let cell = |name| {
            cells
                .iter()
                .find(|(column, _)| *column == name)
                .map(|one| one.1)
        };
        if !cell("flaw")?.is_empty() {
            return None;
        }
        let mut ranges = BTreeMap::new();
        let config = family_scene(cells.iter().copied(), |field, range| {
            ranges.insert(field.to_owned(), range);
            range[0]
        });
        let study = parse("family", &config.ok()?).ok()?;
        let scene = study.cell(0).ok()?.config.scene;
        Some(Self {
            scene: scene.kind(),
            name: cell("family")?.to_owned(),
            scenes: cell("scenes")?.parse().ok()?,
            coverage95: cell("coverage95")?.parse().ok()?,
            lowest: cell("lowest")?.parse().ok()?,
            fields: comparable_fields(&scene, 1.0),
            ranges,
        })
    }

    /// Fields that differ from those of a scene: those without a range, and those whose numbers are outside their ranges.
    fn differences<'a>(&'a self, scene: &'a Fields) -> [Vec<&'a String>; 2] {
        let keys = self.fields.keys().chain(self.ranges.keys());
        let all: BTreeSet<&String> = keys.chain(scene.keys()).collect();
        let differs = all
            .into_iter()
            .filter(|field| match self.ranges.get(*field) {
                Some([low, high]) => !(low..=high).contains(&&number(scene, field)),
                None => scene.get(*field) != self.fields.get(*field),
            });
        let (outside, others) = differs.partition(|field| self.ranges.contains_key(*field));
        [others, outside]
    }

    /// A field of a scene, and what the random scenes have instead, in the scene's unit of length.
    fn in_words(&self, scene: &SceneConfig, unit: LengthUnit, field: &str) -> String {
        let [fields, doubled] = [1.0, 2.0].map(|factor| comparable_fields(scene, factor));
        let (length, name) = (unit_length(scene), unit.as_str());
        let (scale, unit) = match number(&doubled, field) / number(&fields, field) {
            2.0 => (length, format!(" {name}")),
            0.5 => (length.recip(), format!(" per {name}")),
            _ => (1.0, String::new()),
        };
        let in_unit = |number: f64| match scale * number {
            large if large >= 100.0 => Number(large.round()).to_string(),
            number => Number::rounded(number).to_string(),
        };
        let text = |value: Option<&Json>| match value.map(|value| (value, value.as_f64())) {
            None => "none".to_owned(),
            Some((_, Some(number))) => format!("{}{unit}", in_unit(number)),
            Some((value, None)) => value.to_string(),
        };
        let here = text(fields.get(field));
        let there = match self.ranges.get(field) {
            Some(_) if here == "none" => "some".to_owned(),
            Some([low, high]) if low < high => {
                format!("{} to {}{unit}", in_unit(*low), in_unit(*high))
            }
            _ => text(self.fields.get(field)),
        };
        format!("{field} of {here} (they have {there})")
    }
}

/// A number of a scene; a field that it does not have counts as 0.
fn number(scene: &Fields, field: &str) -> f64 {
    scene.get(field).and_then(Json::as_f64).unwrap_or(0.0)
}

/// Families of random scenes whose readings have no flaw.
fn families() -> &'static [Family] {
    static FAMILIES: OnceLock<Vec<Family>> = OnceLock::new();
    FAMILIES.get_or_init(|| {
        let mut families = Vec::new();
        for (_, table) in FAMILY_TABLES {
            let mut rows = Rows::new(table.as_bytes());
            let header = rows.header().unwrap_or_default();
            while let Ok(Some((_, row))) = rows.next_row() {
                let cells = header.iter().map(String::as_str).zip(row);
                families.extend(Family::of_row(&cells.collect::<Vec<_>>()));
            }
        }
        families
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_without_a_flaw_is_a_family() {
        let rows = |table: &str| table.lines().filter(|row| row.contains("\",,")).count();
        let sound: usize = FAMILY_TABLES.iter().map(|(_, table)| rows(table)).sum();
        assert_eq!(families().len(), sound);
        for family in families() {
            assert!(
                (0.0..=family.coverage95).contains(&family.lowest),
                "{family:?}"
            );
            assert!(family.coverage95 <= 1.0 && family.scenes > 0, "{family:?}");
        }
    }
}
