//! Measured coverage: how often 95 % intervals contained the true value in random scenes, and which of these families of
//! scenes a scene belongs to.

mod glide_families;
mod press_families;
mod roll_families;

use std::sync::OnceLock;

use palpate_statistics::Number;
use palpate_study::Rows;
use palpate_study::config::{LengthUnit, SceneConfig};

/// Families with their measured coverage. `cargo xtask tested` writes this table.
const TABLE: &str = include_str!("coverage/families.csv");

/// Random scenes of one kind, and how often their intervals contained the true value.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Kind of scene: `roll`, `glide`, `press`.
    pub scene: String,
    /// Name, as in the table of its harness.
    pub name: String,
    /// Number of scenes.
    pub scenes: usize,
    /// Share of all trials whose 95 % interval contained the true value. A trial without an interval is a miss.
    pub coverage95: f64,
    /// The lowest share of a scene.
    pub lowest: f64,
}

impl Family {
    /// Range of shares in which the intervals count as 95 % intervals.
    pub const HOLDS: [f64; 2] = [0.92, 0.98];

    /// Whether the share is near 95 %.
    pub fn holds(&self) -> bool {
        (Self::HOLDS[0]..=Self::HOLDS[1]).contains(&self.coverage95)
    }
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
    let family = match scene {
        SceneConfig::Press(press) if press.estimator.name() == "image" => {
            press_families::image_family(press, unit)
        }
        SceneConfig::Press(press) => press_families::family(press, unit),
        SceneConfig::Glide(glide) => glide_families::family(glide, unit),
        SceneConfig::Roll(roll) => roll_families::family(roll, unit),
        SceneConfig::Fingertip(_) => Err("nothing is estimated".to_owned()),
    };
    let (name, outside) = match family {
        Ok(family) => family,
        Err(why) => return Coverage::NotMeasured(why),
    };
    let has_name = |family: &&Family| family.scene == scene.kind() && family.name == name;
    match families().iter().find(has_name) {
        Some(family) if outside.is_empty() => Coverage::Measured(family),
        Some(family) => Coverage::Outside(family, outside.join("; ")),
        None => Coverage::NotMeasured(format!("no random scenes of `{name}`")),
    }
}

/// Families of random scenes.
fn families() -> &'static [Family] {
    static FAMILIES: OnceLock<Vec<Family>> = OnceLock::new();
    FAMILIES.get_or_init(|| {
        let mut rows = Rows::new(TABLE.as_bytes());
        let mut families = Vec::new();
        while let Ok(Some((_, row))) = rows.next_row() {
            families.extend(family(row));
        }
        families
    })
}

/// Family of a row of the table.
fn family(row: &csv::StringRecord) -> Option<Family> {
    Some(Family {
        scene: row.get(0)?.to_owned(),
        name: row.get(1)?.to_owned(),
        scenes: row.get(2)?.parse().ok()?,
        coverage95: row.get(3)?.parse().ok()?,
        lowest: row.get(4)?.parse().ok()?,
    })
}

/// Name of the family of a scene, and the numbers of the scene that are outside the family's ranges, in words; or the
/// reason why it belongs to no family.
type FamilyMatch = Result<(String, Vec<String>), String>;

/// Comparison of the numbers of a scene with the ranges of random scenes.
struct Limits {
    unit: &'static str,
    /// Numbers outside their ranges, in words.
    outside: Vec<String>,
}

impl Limits {
    /// Comparison for a scene whose lengths are in this unit.
    fn new(unit: LengthUnit) -> Self {
        Self {
            unit: unit.as_str(),
            outside: Vec::new(),
        }
    }

    /// Compares a number with a range.
    fn within(&mut self, what: &str, number: f64, [low, high]: [f64; 2], unit: &str) {
        // Rounding of a computed limit must not exclude a number that equals it.
        let slack = 1e-9 * low.abs().max(high.abs());
        if !(low - slack..=high + slack).contains(&number) {
            let number = Number::rounded(number);
            let [least, most] = [low, high].map(limit_text);
            let drawn = match low == high {
                true => least,
                false => format!("{least} to {most}"),
            };
            self.outside.push(format!(
                "{what} of {number}{unit} (they have {drawn}{unit})"
            ));
        }
    }

    /// Compares a length with a range.
    fn length_within(&mut self, what: &str, length: f64, between: [f64; 2]) {
        let unit = format!(" {}", self.unit);
        self.within(what, length, between, &unit);
    }

    /// Compares a curvature with a range.
    fn curvature_within(&mut self, curvature: f64, between: [f64; 2]) {
        let unit = format!(" per {}", self.unit);
        self.within("curvature", curvature, between, &unit);
    }

    /// The family with this name, and the numbers outside its ranges.
    fn family(self, name: String) -> FamilyMatch {
        Ok((name, self.outside))
    }
}

/// Text of a limit, rounded to few digits.
fn limit_text(limit: f64) -> String {
    match limit >= 100.0 {
        true => Number(limit.round()).to_string(),
        false => Number::rounded(limit).to_string(),
    }
}

/// Error if a condition of a family does not hold.
fn unless(is_so: bool, else_words: &str) -> Result<(), String> {
    match is_so {
        true => Ok(()),
        false => Err(else_words.to_owned()),
    }
}

/// Two shares of a radius as lengths.
fn scaled(shares: [f64; 2], radius: f64) -> [f64; 2] {
    shares.map(|share| share * radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_is_a_family() {
        assert_eq!(families().len() + 1, TABLE.lines().count());
        for family in families() {
            let shares = [family.coverage95, family.lowest];
            assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
            assert!(
                family.lowest <= family.coverage95 && family.scenes > 0,
                "{family:?}"
            );
        }
    }
}
