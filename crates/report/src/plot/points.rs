//! Numbers from elsewhere in a plot: as the config gives them, and as they stand in a figure.

use super::along::Along;
use super::figure::PointSet;
use super::select::same;
use super::spec::Problem;
use super::style::Style;
use crate::study;
use toml::Value;

/// One `[[plot.points]]`: at least one pair, in the units of the table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Points {
    label: String,
    at: Vec<(f64, f64)>,
    /// The series whose colour they take.
    series: Option<String>,
    /// The only panel that shows them.
    panel: Option<String>,
}

/// Reads the `points` of a plot.
pub(crate) fn parse(value: Option<&Value>) -> Result<Vec<Points>, Problem> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    let tables = value
        .as_array()
        .and_then(|list| list.iter().map(Value::as_table).collect::<Option<Vec<_>>>());
    let Some(tables) = tables else {
        let problem = format!("must be [[plot.points]] tables, is {value}");
        return wrong("points", problem);
    };
    let sets = tables.into_iter().enumerate().map(|(at, table)| {
        set(table).map_err(|(key, problem)| (format!("points[{at}].{key}"), problem))
    });
    sets.collect()
}

fn wrong<T>(key: &str, problem: String) -> Result<T, Problem> {
    Err((key.to_owned(), problem))
}

fn set(table: &toml::Table) -> Result<Points, Problem> {
    const KEYS: [&str; 5] = ["label", "x", "y", "series", "panel"];
    if let Some(key) = table.keys().find(|key| !KEYS.contains(&key.as_str())) {
        return wrong(key, format!("unknown; known: {}", KEYS.join(", ")));
    }
    let text = |key: &str| match table.get(key) {
        None => Ok(None),
        Some(Value::String(text)) => Ok(Some(text.clone())),
        Some(other) => wrong(key, format!("must be a string, is {other}")),
    };
    let numbers = |key: &str| {
        let list = table.get(key).and_then(Value::as_array);
        let numbers: Option<Vec<f64>> =
            list.and_then(|list| list.iter().map(study::number).collect());
        match numbers {
            Some(numbers) if !numbers.is_empty() => Ok(numbers),
            _ => wrong(key, "must be a list of finite numbers".to_owned()),
        }
    };
    let (x, y) = (numbers("x")?, numbers("y")?);
    if x.len() != y.len() {
        let problem = format!("has {} numbers, and x has {}", y.len(), x.len());
        return wrong("y", problem);
    }
    Ok(Points {
        label: text("label")?.unwrap_or_default(),
        at: x.into_iter().zip(y).collect(),
        series: text("series")?,
        panel: text("panel")?,
    })
}

/// Points with their look, each with the panel they belong to.
#[derive(Debug, Default)]
pub(crate) struct Placed {
    sets: Vec<(Option<String>, PointSet)>,
}

impl Placed {
    /// Gives points their places and looks; `series` is the look of a series, or what is wrong with its name, and
    /// `panels` the values of the panels that are shown. The error says what is wrong.
    pub(crate) fn of(
        points: &[Points],
        [x, y]: [Along; 2],
        panels: &[&str],
        series: impl Fn(&str) -> Result<Style, String>,
    ) -> Result<Self, String> {
        let mut labels: Vec<&str> = Vec::new();
        let mut sets = Vec::new();
        for set in points {
            if !labels.contains(&set.label.as_str()) {
                labels.push(&set.label);
            }
            if let Some(panel) = &set.panel
                && !panels.iter().any(|shown| same(shown, panel))
            {
                return Err(format!(
                    "the points {:?} are of the panel {panel:?}; shown: {}",
                    set.label,
                    panels.join(", ")
                ));
            }
            let shape = labels.iter().position(|label| *label == set.label);
            let look = Style::open(shape.unwrap_or(0));
            let colour = match &set.series {
                None => look.colour,
                Some(name) => {
                    series(name)
                        .map_err(|why| format!("the points {:?}: {why}", set.label))?
                        .colour
                }
            };
            let place = |(a, b): &(f64, f64)| Ok((x.place(*a, "point")?, y.place(*b, "point")?));
            let placed = PointSet {
                label: set.label.clone(),
                style: Style { colour, ..look },
                at: set.at.iter().map(place).collect::<Result<_, String>>()?,
            };
            sets.push((set.panel.clone(), placed));
        }
        Ok(Self { sets })
    }

    /// Sets of points in the panel of this value, with those that are in every panel.
    pub(crate) fn of_panel(&self, value: Option<&str>) -> Vec<PointSet> {
        let here = |panel: &Option<String>| match (panel, value) {
            (Some(panel), Some(value)) => same(panel, value),
            (Some(_), None) => false,
            (None, _) => true,
        };
        let sets = self.sets.iter().filter(|(panel, _)| here(panel));
        sets.map(|(_, set)| set.clone()).collect()
    }

    /// A sample of each label: neutral where its points differ in colour.
    pub(crate) fn legend(&self) -> Vec<(String, Style)> {
        let mut entries: Vec<(String, Style)> = Vec::new();
        for (_, set) in &self.sets {
            match entries.iter_mut().find(|(label, _)| *label == set.label) {
                Some((_, style)) if style.colour != set.style.colour => {
                    style.colour = Style::open(0).colour;
                }
                Some(_) => {}
                None => entries.push((set.label.clone(), set.style)),
            }
        }
        entries
    }
}
