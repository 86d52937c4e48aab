//! A `[[plot]]` table of the config.

use super::points::{self, Points};
use crate::{ReportError, Study, study, words};
use toml::Value;

/// How the axes are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Logs {
    pub(crate) x: bool,
    pub(crate) y: bool,
}

/// A reference line at a value of the table (fractions are not yet in percent).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mark {
    pub(crate) on_x: bool,
    pub(crate) value: f64,
    pub(crate) label: String,
}

/// One `[[plot]]`, by its `kind`: names as written, not yet held against the tables.
#[derive(Debug, Clone)]
pub(crate) enum Plot {
    /// Statistics of `cells.csv` as lines.
    Lines(Spec),
    /// The classes of `map.csv`, cell by cell.
    ClassMap(MapSpec),
    /// The contacts of `trace.csv` in space.
    Contacts(Heading),
    /// The displacements of `map.csv` along a radius, cell by cell.
    Profile(ProfileSpec),
}

/// Name and title of a plot.
#[derive(Debug, Clone, Default)]
pub(crate) struct Heading {
    /// File stem.
    pub(crate) name: String,
    pub(crate) title: Option<String>,
}

/// A class map.
#[derive(Debug, Clone)]
pub(crate) struct MapSpec {
    pub(crate) heading: Heading,
    /// Only cells whose value at the path is one of these.
    pub(crate) filters: Vec<(String, Vec<String>)>,
}

/// Profiles of a displacement.
#[derive(Debug, Clone)]
pub(crate) struct ProfileSpec {
    pub(crate) heading: Heading,
    pub(crate) component: Component,
    pub(crate) panels: Option<String>,
    /// Only cells whose value at the path is one of these.
    pub(crate) filters: Vec<(String, Vec<String>)>,
    pub(crate) marks: Vec<Mark>,
    pub(crate) points: Vec<Points>,
}

/// Which way a displacement goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Component {
    /// Inward.
    Normal,
    /// Along the skin, away from the contact.
    Radial,
}

/// Lines through statistics.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spec {
    pub(crate) name: String,
    pub(crate) title: Option<String>,
    pub(crate) x: String,
    pub(crate) y: String,
    pub(crate) quantity: Option<String>,
    pub(crate) series: Option<String>,
    pub(crate) panels: Option<String>,
    /// Only rows whose value at the path is one of these.
    pub(crate) filters: Vec<(String, Vec<String>)>,
    pub(crate) logs: Logs,
    pub(crate) compare: Option<String>,
    pub(crate) marks: Vec<Mark>,
    pub(crate) points: Vec<Points>,
}

/// The kinds, and the keys that each knows. `scale` may be written out everywhere.
const KINDS: [(&str, &[&str]); 4] = [
    (
        "lines",
        &[
            "name", "title", "kind", "x", "y", "quantity", "series", "panels", "where", "scale",
            "compare", "marks", "points",
        ],
    ),
    ("class-map", &["name", "title", "kind", "where", "scale"]),
    ("contacts", &["name", "title", "kind", "scale"]),
    (
        "profile",
        &[
            "name",
            "title",
            "kind",
            "component",
            "panels",
            "where",
            "scale",
            "marks",
            "points",
        ],
    ),
];
const SCALES: [(&str, Logs); 4] = [
    ("linear", Logs { x: false, y: false }),
    ("log-x", Logs { x: true, y: false }),
    ("log-y", Logs { x: false, y: true }),
    ("log-log", Logs { x: true, y: true }),
];

/// The plots of a study, in order; none if it asks for none.
pub(crate) fn plots(study: &Study) -> Result<Vec<Plot>, ReportError> {
    let Some(value) = study.config().get("plot") else {
        return Ok(Vec::new());
    };
    let bad = |key: String, problem: String| ReportError::BadKey {
        path: study.run_toml(),
        key,
        problem,
    };
    let list = value
        .as_array()
        .ok_or_else(|| bad("plot".to_owned(), "must be [[plot]] tables".to_owned()))?;
    let mut plots: Vec<Plot> = Vec::new();
    for (at, value) in list.iter().enumerate() {
        let here = format!("plot[{at}]");
        let table = value
            .as_table()
            .ok_or_else(|| bad(here.clone(), format!("must be a table, is {value}")))?;
        let plot =
            parse(table, at).map_err(|(key, problem)| bad(format!("{here}.{key}"), problem))?;
        if plots.iter().any(|other| other.name() == plot.name()) {
            return Err(bad(
                format!("{here}.name"),
                format!("{:?} is the name of another plot", plot.name()),
            ));
        }
        plots.push(plot);
    }
    Ok(plots)
}

impl Plot {
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Lines(spec) => &spec.name,
            Self::ClassMap(spec) => &spec.heading.name,
            Self::Contacts(heading) => &heading.name,
            Self::Profile(spec) => &spec.heading.name,
        }
    }

    /// The name of its kind and the kind of the scenes it is drawn from, where it is not drawn from all.
    pub(crate) fn needs(&self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Lines(_) => None,
            Self::ClassMap(_) => Some(("class-map", "glide")),
            Self::Contacts(_) => Some(("contacts", "glide")),
            Self::Profile(_) => Some(("profile", "press")),
        }
    }
}

/// A key and what is wrong with it.
pub(crate) type Problem = (String, String);

fn parse(table: &toml::Table, at: usize) -> Result<Plot, Problem> {
    let text = |key: &str| match table.get(key) {
        None => Ok(None),
        Some(Value::String(text)) if !text.is_empty() => Ok(Some(text.clone())),
        Some(other) => Err((
            key.to_owned(),
            format!("must be a non-empty string, is {other}"),
        )),
    };
    let needed = |key: &str| text(key)?.ok_or_else(|| (key.to_owned(), "is missing".to_owned()));

    let kind = text("kind")?.unwrap_or_else(|| "lines".to_owned());
    let Some((kind, keys)) = KINDS.into_iter().find(|(name, _)| *name == kind) else {
        let known = KINDS.map(|(name, _)| name).join(", ");
        return Err((
            "kind".to_owned(),
            format!("{kind:?} is unknown; known: {known}"),
        ));
    };
    for key in table.keys() {
        if !keys.contains(&key.as_str()) {
            let known = nearest(key, keys.iter().copied()).join(", ");
            return Err((
                key.clone(),
                format!("unknown for kind {kind:?}; known: {known}"),
            ));
        }
    }
    let name = text("name")?.unwrap_or_else(|| format!("plot-{}", at + 1));
    if name.starts_with('.') || name.contains(['/', '\\', ':', '\0']) {
        return Err(("name".to_owned(), format!("{name:?} is not a file name")));
    }
    let logs = match text("scale")? {
        None => Logs::default(),
        Some(scale) => SCALES
            .iter()
            .find(|(name, _)| *name == scale)
            .map(|(_, logs)| *logs)
            .ok_or_else(|| {
                let known = SCALES.map(|(name, _)| name).join(", ");
                (
                    "scale".to_owned(),
                    format!("{scale:?} is unknown; known: {known}"),
                )
            })?,
    };
    let title = text("title")?;
    if kind != "lines" && logs != Logs::default() {
        return Err((
            "scale".to_owned(),
            format!("must be linear for kind {kind:?}"),
        ));
    }
    match kind {
        "class-map" => {
            let heading = Heading { name, title };
            let filters = filters(table.get("where"))?;
            return Ok(Plot::ClassMap(MapSpec { heading, filters }));
        }
        "contacts" => return Ok(Plot::Contacts(Heading { name, title })),
        "profile" => {
            return Ok(Plot::Profile(ProfileSpec {
                heading: Heading { name, title },
                component: component(text("component")?)?,
                panels: text("panels")?,
                filters: filters(table.get("where"))?,
                marks: marks(table.get("marks"))?,
                points: points::parse(table.get("points"))?,
            }));
        }
        _ => {}
    }
    Ok(Plot::Lines(Spec {
        name,
        title,
        x: needed("x")?,
        y: needed("y")?,
        quantity: text("quantity")?,
        series: text("series")?,
        panels: text("panels")?,
        filters: filters(table.get("where"))?,
        logs,
        compare: text("compare")?,
        marks: marks(table.get("marks"))?,
        points: points::parse(table.get("points"))?,
    }))
}

fn component(name: Option<String>) -> Result<Component, Problem> {
    match name.as_deref() {
        None | Some("normal") => Ok(Component::Normal),
        Some("radial") => Ok(Component::Radial),
        Some(other) => Err((
            "component".to_owned(),
            format!("{other:?} is unknown; known: normal, radial"),
        )),
    }
}

fn filters(value: Option<&Value>) -> Result<Vec<(String, Vec<String>)>, Problem> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    let mut found = Vec::new();
    let table = value
        .as_table()
        .ok_or_else(|| ("where".to_owned(), format!("must be a table, is {value}")))?;
    flatten("", table, &mut found)?;
    Ok(found)
}

/// `where = { scene.sensor.pitch = 0.1 }` (nested, as TOML reads bare dotted keys) and
/// `where = { "scene.sensor.pitch" = 0.1 }` mean the same.
fn flatten(
    prefix: &str,
    table: &toml::Table,
    found: &mut Vec<(String, Vec<String>)>,
) -> Result<(), Problem> {
    for (key, value) in table {
        let path = if prefix.is_empty() {
            key.clone()
        } else {
            format!("{prefix}.{key}")
        };
        let one = |value: &Value| match value {
            Value::String(text) => Ok(text.clone()),
            Value::Boolean(flag) => Ok(flag.to_string()),
            other => study::number(other).map(words::exact).ok_or_else(|| {
                (
                    format!("where.{path}"),
                    format!("must hold numbers or strings, has {other}"),
                )
            }),
        };
        match value {
            Value::Table(inner) => flatten(&path, inner, found)?,
            Value::Array(list) => {
                let values = list.iter().map(one).collect::<Result<_, _>>()?;
                found.push((path, values));
            }
            single => {
                let value = one(single)?;
                found.push((path, vec![value]));
            }
        }
    }
    Ok(())
}

fn marks(value: Option<&Value>) -> Result<Vec<Mark>, Problem> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    let wrong = |problem: String| ("marks".to_owned(), problem);
    let list = value
        .as_array()
        .ok_or_else(|| wrong(format!("must be a list of tables, is {value}")))?;
    list.iter()
        .map(|value| {
            let table = value
                .as_table()
                .ok_or_else(|| wrong(format!("must be a list of tables, has {value}")))?;
            if let Some(key) = table
                .keys()
                .find(|key| !["axis", "value", "label"].contains(&key.as_str()))
            {
                return Err(wrong(format!(
                    "key {key:?} is unknown; known: axis, value, label"
                )));
            }
            let on_x = match table.get("axis").and_then(Value::as_str) {
                Some("x") => true,
                Some("y") => false,
                _ => return Err(wrong(format!("axis must be \"x\" or \"y\" in {value}"))),
            };
            let at = table
                .get("value")
                .and_then(study::number)
                .ok_or_else(|| wrong(format!("value must be a finite number in {value}")))?;
            let label = match table.get("label") {
                None => String::new(),
                Some(Value::String(label)) => label.clone(),
                Some(other) => return Err(wrong(format!("label must be a string, is {other}"))),
            };
            Ok(Mark {
                on_x,
                value: at,
                label,
            })
        })
        .collect()
}

/// `names`, the most similar to `wanted` first.
pub(crate) fn nearest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<&str> = names.collect();
    names.sort_by(|a, b| {
        strsim::jaro_winkler(wanted, b).total_cmp(&strsim::jaro_winkler(wanted, a))
    });
    names.into_iter().map(str::to_owned).collect()
}
