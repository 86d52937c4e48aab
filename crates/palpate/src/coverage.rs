//! Measured coverage: the share of 95 % intervals that contained the true value in random scenes. The random scenes
//! are grouped into families; this module finds the family that matches a given scene.
//!
//! `cargo xtask intervals` measures the families. It writes tables in which each row is one family. The row contains
//! the fields of the family's scenes, many of them as ranges, and the measured coverage.

mod comparable_scene;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display, Formatter};
use std::sync::OnceLock;

use palpate_statistics::Number;
use palpate_study::Rows;
use palpate_study::config::{ConfigError, LengthUnit, SceneConfig, parse, with_fields};
use serde_json::{Value as Json, json};

use comparable_scene::{Fields, comparable_fields, unit_length};

/// Field that replaces the radius of a ball or a dish in the tables of families, which are groups of random scenes. Its
/// value is the curvature of the object, which is negative for a dish.
const CURVATURE: &str = "scene.object.curvature";

/// Tables of families, each as the name of the table and its CSV text. A row of a table describes one family: a group
/// of random scenes with similar fields, and the coverage that was measured in these scenes.
pub const FAMILY_TABLES: [(&str, &str); 4] = [
    ("roll", include_str!("coverage/roll.csv")),
    ("glide", include_str!("coverage/glide.csv")),
    ("press", include_str!("coverage/press.csv")),
    ("image", include_str!("coverage/image.csv")),
];

/// A family of random scenes with similar fields, and the coverage of 95 % intervals that was measured in these scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Kind of the scenes: `roll`, `glide` or `press`.
    pub scene: &'static str,
    /// Name of the family, as in one of the [`FAMILY_TABLES`].
    pub name: String,
    /// Number of random scenes that were drawn for this family.
    pub scenes: usize,
    /// Share of all trials of these scenes whose 95 % interval contained the true value. A trial without an interval
    /// counts as a miss.
    pub coverage95: f64,
    /// Lowest coverage of the 95 % intervals in a single scene of this family.
    pub lowest: f64,
    /// Fields of the family's scenes with their values. For a field that varies within the family, this is the lowest
    /// value.
    fields: Fields,
    /// Smallest and largest value of each field that varies within the family.
    ranges: BTreeMap<String, [f64; 2]>,
}

/// Measured coverage of a scene's 95 % intervals, or the reason why it was not measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Coverage {
    /// The scene belongs to this family, whose coverage was measured.
    Measured(&'static Family),
    /// The scene belongs to no family, because some of its numbers are outside the ranges of every family. The variant
    /// contains the most similar family, and a text that lists the numbers outside its ranges.
    Outside(&'static Family, String),
    /// No similar scenes were measured. The text states the reason.
    NotMeasured(String),
}

/// Finds the measured coverage of scenes that are similar to `scene`. The lengths of `scene` are in `unit`.
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
/// assert!(family.coverage95 > 0.92);
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

/// Config of one random scene of a family. `cells` is the family's row of the table: a pair of column name and text for
/// each column. Columns that are not fields of a scene are ignored.
///
/// Each text is a value, a range `low..high`, or `factor * field`. `draw` chooses a number from a range. `factor *
/// field` is a multiple of the number in the earlier column `field`.
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
            // A number without fractional part becomes an integer, because the config requires integers for counts.
            (_, Some(number)) if number.fract() == 0.0 => (field.to_owned(), json!(number as i64)),
            _ => (field.to_owned(), value),
        });
    }
    with_fields("family", "", &fields)
}

fn range(cell: &str) -> Option<[f64; 2]> {
    let (low, high) = cell.split_once("..")?;
    Some([low.parse().ok()?, high.parse().ok()?])
}

/// Parses `factor * field` in a cell of the table: a multiple of another field's number.
fn multiple(cell: &str) -> Option<(f64, &str)> {
    let (factor, field) = cell.split_once(" * ")?;
    Some((factor.parse().ok()?, field))
}

/// Smallest and largest measured coverage at which the intervals count as valid 95 % intervals.
const HOLDS: [f64; 2] = [0.92, 0.98];

/// The measured coverage of the family, as text.
impl Display for Family {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let only = if self.coverage95 < HOLDS[0] {
            "only "
        } else {
            ""
        };
        let [share, lowest] = [self.coverage95, self.lowest].map(|share| 100.0 * share);
        write!(
            f,
            "in {} random scenes they contained the true value in {only}{share:.1} % of trials, in the worst scene in {lowest:.0} % ({})",
            self.scenes, self.name
        )
    }
}

impl Family {
    pub(crate) fn holds(&self) -> bool {
        (HOLDS[0]..=HOLDS[1]).contains(&self.coverage95)
    }

    /// The family in a row of a table. `None` if the row has no measured coverage, or if the readings of the family
    /// contain a deliberate flaw.
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

    /// Fields in which a scene differs from the scenes of the family, in two lists. The first list contains fields that
    /// have one fixed value in the family; the scene has another value. The second list contains fields that have a
    /// range in the family; the scene's number is outside of this range.
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

    /// Text with the value of a field in the scene `scene`, and the values of this field in the random scenes of the
    /// family. Lengths are in the scene's unit.
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

fn number(scene: &Fields, field: &str) -> f64 {
    scene.get(field).and_then(Json::as_f64).unwrap_or(0.0)
}

/// All families whose coverage was measured, except families whose readings contain a deliberate flaw.
fn families() -> &'static [Family] {
    static FAMILIES: OnceLock<Vec<Family>> = OnceLock::new();
    FAMILIES.get_or_init(|| {
        let mut families = Vec::new();
        for (_, table) in FAMILY_TABLES {
            let mut rows = Rows::new(table.as_bytes(), true);
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
