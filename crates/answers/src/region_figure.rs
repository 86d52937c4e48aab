//! Makes the figure of a [`Region`], which is the answer of `palpate design`.

use palpate_report::{
    AnswerChart, AnswerFigure, CurveLine, CurvePoint, FieldAxis, Figure, MapPanel, ReportError,
    answer_figure,
};
use palpate_statistics::Number;
use palpate_study::number;

use crate::field::Field;
use crate::region::{DesignPoint, Region, RegionColumn, Sample};
use crate::words::settings_in_words;

/// If a study has at most this number of cells, the figure has one line per cell. Otherwise, a single line shows the
/// statistic of the cell that decides whether a value meets the target.
const MAX_LINES: usize = 7;

impl Region {
    /// Figure of the region. If several fields are varied, the searched field is on the vertical axis, and the last
    /// field of [`Region::grid`] on the horizontal axis. There is one panel for each combination of values of the
    /// remaining fields. If one field is varied, it is on the horizontal axis, and the target's statistic on the
    /// vertical axis. `name` is the file name of the figure, without extension.
    pub(crate) fn region_figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
        let mut notes = vec![self.sentence()];
        let chart = match self.grid.split_last() {
            Some((last, further)) => self.map(last, further),
            None => self.curve(&mut notes),
        };
        answer_figure(&AnswerFigure {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!("Target: {}.", self.target_in_words()),
            notes,
            chart,
        })
    }

    fn map(&self, last: &Field, further: &[Field]) -> AnswerChart {
        let is_beside = |one: &RegionColumn, other: &RegionColumn| {
            one.at[..further.len()] == other.at[..further.len()]
        };
        let mut panels: Vec<&[RegionColumn]> = self.columns.chunk_by(is_beside).collect();
        // Draw no panels for combinations that were added to the grid only to refine the best value. A panel needs
        // several neighbouring combinations, and such combinations have no neighbours.
        if panels.iter().any(|columns| columns.len() > 1) {
            panels.retain(|columns| columns.len() > 1);
        }
        let best = self.best().map(|best| (best.column, best.searched));
        let panel = |columns: &&[RegionColumn]| {
            let pairs = further.iter().zip(&columns[0].at);
            let words = pairs.map(|(field, value)| field.named_value(*value));
            let here = best.filter(|(best, _)| columns.iter().any(|column| column.at == best.at));
            let columns = columns.iter();
            MapPanel {
                title: words.collect::<Vec<_>>().join(", "),
                columns: columns
                    .map(|column| (column.at[further.len()], column.runs.clone()))
                    .collect(),
                best: here.map(|(column, value)| (column.at[further.len()], value)),
            }
        };
        let panels: Vec<MapPanel> = panels.iter().map(panel).collect();
        let words = self.question.sought.as_ref().map(|sought| {
            let (field, _) = self.sought_field(sought);
            format!("{} {}", sought.extreme.words()[0], field.label.words)
        });
        let is_marked = panels.iter().any(|panel| panel.best.is_some());
        AnswerChart::Map {
            searched: axis(&self.searched),
            other: axis(last),
            panels,
            best: words.filter(|_| is_marked),
        }
    }

    fn curve(&self, notes: &mut Vec<String>) -> AnswerChart {
        let (column, statistic) = (&self.columns[0], self.label());
        let line = |label: String, sample_of: &dyn Fn(&DesignPoint) -> Option<Sample>| {
            let points = column.points.iter().filter_map(|point| {
                let sample = sample_of(point)?;
                let (y, std) = sample.statistic?;
                Some(CurvePoint {
                    x: point.value,
                    y,
                    std,
                    is_of_survivors: self.is_failing(&sample),
                })
            });
            CurveLine {
                label,
                points: points.collect(),
            }
        };
        let lines = match self.cells.len() {
            cells if cells > MAX_LINES => {
                let worst = |point: &DesignPoint| self.decisive(point).copied();
                vec![line("the worst cell".to_owned(), &worst)]
            }
            _ => {
                let cells = self.cells.iter().enumerate();
                cells
                    .map(|(cell, values)| {
                        line(settings_in_words(&self.cell_columns, values), &|point| {
                            point.searched.get(cell).copied()
                        })
                    })
                    .collect()
            }
        };
        let mut points = lines.iter().flat_map(|line| &line.points);
        if points.any(|point| point.is_of_survivors) {
            let share = number::rounded(100.0 * self.question.max_failures);
            notes.push(format!(
                "Circled: points at which more than {share} % of the trials failed."
            ));
        }
        let limit = self.question.target.limit;
        AnswerChart::Curve {
            searched: axis(&self.searched),
            limit: (limit, statistic.value(&Number(limit).to_string())),
            statistic,
            lines,
            runs: column.runs.clone(),
        }
    }
}

fn axis(field: &Field) -> FieldAxis {
    let names = 0..field.listed.len();
    FieldAxis {
        label: field.label.clone(),
        is_log: field.span.is_log,
        ends: (field.span.from, field.span.to),
        names: names.map(|place| field.text(place as f64)).collect(),
    }
}
