//! Numbers from elsewhere in a plot: reference lines, and points.

use super::scale::Spacing;
use super::series::{Mark, OPEN_MARKER, PointSet};
use super::style::{FRAME, Style};
use crate::group::distinct;
use crate::table::same;
use palpate_study::{config, number};
use plotters::style::Color;

/// Axis of a plot, on which numbers of the table are shown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Along {
    pub(crate) name: char,
    pub(crate) spacing: Spacing,
    /// Factor from the numbers in the table to those shown.
    pub(crate) factor: f64,
}

impl Along {
    /// Number shown for `value`; an error says why the `what` at it cannot be drawn.
    fn place(self, value: f64, what: &str) -> Result<f64, String> {
        let place = value * self.factor;
        let refused = |why| {
            format!(
                "the {what} at {} = {} is {why}",
                self.name,
                number::exact(value)
            )
        };
        self.spacing
            .refusal(place)
            .map_or(Ok(place), |why| Err(refused(why)))
    }
}

/// Reference lines in their places, or what is wrong with one.
pub(crate) fn marks(marks: &[config::Mark], [x, y]: [Along; 2]) -> Result<Vec<Mark>, String> {
    let place = |mark: &config::Mark| {
        let on_x = mark.axis == config::MarkAxis::X;
        let along = if on_x { x } else { y };
        Ok(Mark {
            on_x,
            at: along.place(mark.value, "mark")?,
            label: mark.label.clone(),
            style: FRAME.stroke_width(4),
        })
    };
    marks.iter().map(place).collect()
}

/// Points with their look, each with the panel they belong to.
#[derive(Debug, Default)]
pub(crate) struct Points {
    sets: Vec<(Option<String>, PointSet)>,
}

impl Points {
    /// Gives points their places and looks; `series` is the look of a series, or what is wrong with its name, and
    /// `panels` the values of the panels that are shown. The error says what is wrong.
    pub(crate) fn of(
        points: &[config::Points],
        [x, y]: [Along; 2],
        panels: &[&str],
        series: impl Fn(&str) -> Result<Style, String>,
    ) -> Result<Self, String> {
        let labels = distinct(points.iter().map(|set| &set.label));
        let mut sets = Vec::new();
        for set in points {
            let label = &set.label;
            if let Some(panel) = &set.panel
                && !panels.iter().any(|shown| same(shown, panel))
            {
                let shown = panels.join(", ");
                return Err(format!(
                    "the points {label:?} are of the panel {panel:?}; shown: {shown}"
                ));
            }
            let shape = labels.iter().position(|known| *known == label);
            let look = Style::open(shape.unwrap_or(0));
            let of_series = set.series.as_deref().map(&series).transpose();
            let of_series = of_series.map_err(|why| format!("the points {label:?}: {why}"))?;
            let place = |(a, b): (&f64, &f64)| Ok((x.place(*a, "point")?, y.place(*b, "point")?));
            let placed = PointSet {
                label: label.clone(),
                style: Style {
                    colour: of_series.unwrap_or(look).colour,
                    ..look
                },
                size: OPEN_MARKER,
                at: set
                    .x
                    .iter()
                    .zip(&set.y)
                    .map(place)
                    .collect::<Result<_, String>>()?,
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
