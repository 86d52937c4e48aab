//! Prepares the reference lines and reference points of a `[[plot]]` for drawing.

use super::scale::Spacing;
use super::series::{Mark, OPEN_MARKER, PointSet};
use super::style::{FRAME, Style};
use crate::records::distinct;
use crate::table::same;
use palpate_statistics::Number;
use palpate_study::config;
use plotters::style::Color;

/// An axis of a plot. It converts numbers in the config to the numbers that the axis displays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AxisScale {
    pub(crate) name: char,
    pub(crate) spacing: Spacing,
    /// Factor from a number in the config to the number that the axis displays.
    pub(crate) factor: f64,
}

impl AxisScale {
    /// Converts `value` to the number that the axis displays. If this number cannot be drawn on the axis, the error
    /// states the reason. `what` is the name of the value in the error message.
    fn place(self, value: f64, what: &str) -> Result<f64, String> {
        let place = value * self.factor;
        let refused = |why| format!("the {what} at {} = {} is {why}", self.name, Number(value));
        self.spacing
            .refusal(place)
            .map_or(Ok(place), |why| Err(refused(why)))
    }
}

/// Converts the reference lines of a plot. The error states why a line cannot be drawn.
pub(crate) fn marks(marks: &[config::Mark], [x, y]: [AxisScale; 2]) -> Result<Vec<Mark>, String> {
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

/// Sets of reference points. Each set belongs to one panel, or to all panels (`None`).
#[derive(Debug, Default)]
pub(crate) struct Points {
    sets: Vec<(Option<String>, PointSet)>,
}

impl Points {
    /// Converts the reference points of a plot. `series` returns the style of the series with a given name. `panels`
    /// contains the swept value of each panel. The error states why a set of points cannot be drawn.
    pub(crate) fn of(
        points: &[config::Points],
        [x, y]: [AxisScale; 2],
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
                    "the points {label:?} belong to the panel {panel:?}, which the plot does not have; panels: {shown}"
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

    pub(crate) fn of_panel(&self, value: Option<&str>) -> Vec<PointSet> {
        let here = |panel: &Option<String>| match (panel, value) {
            (Some(panel), Some(value)) => same(panel, value),
            (Some(_), None) => false,
            (None, _) => true,
        };
        let sets = self.sets.iter().filter(|(panel, _)| here(panel));
        sets.map(|(_, set)| set.clone()).collect()
    }

    /// Label and style of each set of points, for the legend. If several sets have the same label but different
    /// colours, the legend shows one neutral colour for them.
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
