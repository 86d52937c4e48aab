//! Intervals that were held against the truth on random scenes, and which of these a scene is like.

mod camera;
mod glide;
mod limits;
mod press;
mod roll;

use std::sync::OnceLock;

use palpate_study::Rows;
use palpate_study::config::{LengthUnit, SceneConfig};

/// Families with what was measured of them: `cargo xtask tested` writes it from the tables of the harnesses.
const TABLE: &str = include_str!("tested/table.csv");

/// Random scenes of one kind, and how often the intervals of their estimates held the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Kind of scene: `roll`, `glide`, `press`.
    pub scene: String,
    /// Name, as the table of its harness has it.
    pub name: String,
    /// Number of scenes.
    pub scenes: usize,
    /// Share of all trials in which the interval of 95 % held the truth; one that gave no interval is a miss.
    pub coverage95: f64,
    /// Share in the scene where it is lowest.
    pub lowest: f64,
}

impl Family {
    /// Shares between which intervals count as those of 95 %.
    pub const HOLDS: [f64; 2] = [0.92, 0.98];

    /// Whether intervals of 95 % held the truth about as often as they say.
    pub fn holds(&self) -> bool {
        (Self::HOLDS[0]..=Self::HOLDS[1]).contains(&self.coverage95)
    }
}

/// Whether intervals of scenes like one were held against the truth.
#[derive(Clone, Debug, PartialEq)]
pub enum Tested {
    /// On random scenes of this family.
    On(&'static Family),
    /// On random scenes of this family, whose draws do not reach what is named, with the draws.
    Beyond(&'static Family, String),
    /// On none, for this reason.
    Not(String),
}

/// Verdict of random scenes on the intervals of a scene, whose lengths are in this unit.
///
/// ```
/// use palpate::{Tested, tested};
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
/// let Tested::On(family) = tested(&config.scene, config.length_unit) else {
///     panic!("such presses are among those that were tested");
/// };
/// assert!(family.name.starts_with("half-space, indentation fitted"));
/// assert!(family.holds());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn tested(scene: &SceneConfig, unit: LengthUnit) -> Tested {
    let likeness = match scene {
        SceneConfig::Press(press) if press.estimator.name() == "image" => {
            camera::family(press, unit)
        }
        SceneConfig::Press(press) => press::family(press, unit),
        SceneConfig::Glide(glide) => glide::family(glide, unit),
        SceneConfig::Roll(roll) => roll::family(roll, unit),
        SceneConfig::Fingertip(_) => Err("nothing is estimated".to_owned()),
    };
    let (name, beyond) = match likeness {
        Ok(likeness) => likeness,
        Err(why) => return Tested::Not(why),
    };
    let of_name = |family: &&Family| family.scene == scene.kind() && family.name == name;
    match families().iter().find(of_name) {
        Some(family) if beyond.is_empty() => Tested::On(family),
        Some(family) => Tested::Beyond(family, beyond.join("; ")),
        None => Tested::Not(format!("no random scenes of `{name}`")),
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
