//! Figure of a design's answer.

use palpate_report::{
    AnswerCurve, CurveLine, CurvePoint, Figure, RegionAxis, RegionMap, RegionPanel, RegionStrip,
    ReportError, Stretch, answer_figure, region_figure,
};
use palpate_study::number;
use palpate_sweep::Side;

use super::feasible_region::{DesignPoint, Region, RegionColumn, Sample};
use super::field::Field;
use super::region_text::settings_in_words;

/// Largest number of cells with a line each. If there are more, only the worst cell is drawn.
const MAX_LINES: usize = 7;

impl Region {
    /// Figure of the region: the searched field over the last field of the grid, in a panel for each combination of the
    /// others. Without a grid: the target's statistic over the searched field. `name` is the name of its files.
    ///
    /// # Errors
    /// [`ReportError`] if it cannot be drawn.
    pub fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
        let Some((last, further)) = self.grid.split_last() else {
            return self.curve_figure(&self.columns[0], name, title);
        };
        let mut panels: Vec<(&[f64], Vec<&RegionColumn>)> = Vec::new();
        for column in &self.columns {
            let key = &column.at[..further.len()];
            match panels.iter_mut().find(|(known, _)| *known == key) {
                Some((_, columns)) => columns.push(column),
                None => panels.push((key, vec![column])),
            }
        }
        // A combination that was only tried near the best value gets no panel.
        if panels.iter().any(|(_, columns)| columns.len() > 1) {
            panels.retain(|(_, columns)| columns.len() > 1);
        }
        let best = self.best().map(|best| (best.column, best.searched));
        let panel = |(key, columns): &(&[f64], Vec<&RegionColumn>)| {
            let pairs = further.iter().zip(*key);
            let words = pairs
                .map(|(field, value)| format!("{} {}", field.label.words, field.value(*value)));
            let here = best.filter(|(best, _)| columns.iter().any(|column| column.at == best.at));
            let strip = |column: &&RegionColumn| RegionStrip {
                x: column.at[further.len()],
                runs: stretches(column),
            };
            RegionPanel {
                title: words.collect::<Vec<_>>().join(", "),
                columns: columns.iter().map(strip).collect(),
                best: here.map(|(column, y)| (column.at[further.len()], y)),
            }
        };
        let panels: Vec<RegionPanel> = panels.iter().map(panel).collect();
        let words = self.sought.as_ref().map(|sought| {
            let (field, _) = self.sought_field(sought);
            format!("{} {}", sought.extreme.word(), field.label.words)
        });
        let is_marked = panels.iter().any(|panel| panel.best.is_some());
        region_figure(&RegionMap {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!("Target: {}.", self.target_in_words()),
            notes: vec![self.sentence()],
            x: axis(last),
            y: axis(&self.searched),
            panels,
            best: words.filter(|_| is_marked),
        })
    }

    /// Figure of a region without a grid: the limit is a line, and the values that meet it are shaded.
    fn curve_figure(
        &self,
        column: &RegionColumn,
        name: &str,
        title: &str,
    ) -> Result<Figure, ReportError> {
        let y = self.label();
        let lines = match self.cells.len() {
            cells if cells > MAX_LINES => {
                let worst = |point: &'_ DesignPoint| {
                    point
                        .decisive(self.target.bound, self.max_failures)
                        .copied()
                };
                vec![CurveLine {
                    label: "the worst cell".to_owned(),
                    points: self.curve_points(column, worst),
                }]
            }
            cells => {
                let line = |cell: usize| CurveLine {
                    label: match cells {
                        1 => String::new(),
                        _ => settings_in_words(&self.cell_columns, &self.cells[cell])
                            .collect::<Vec<_>>()
                            .join(", "),
                    },
                    points: self.curve_points(column, |point| point.searched.get(cell).copied()),
                };
                (0..cells).map(line).collect()
            }
        };
        let points = column.points.iter();
        let names: Vec<String> = points
            .filter(|_| self.searched.is_listed())
            .map(|point| self.searched.text(point.value))
            .collect();
        let mut notes = vec![self.curve_sentence()];
        let mut points = lines.iter().flat_map(|line| &line.points);
        if points.any(|point| point.is_of_survivors) {
            let share = number::rounded(100.0 * self.max_failures);
            notes.push(format!(
                "Circled: points of which more than {share} % of the trials failed."
            ));
        }
        answer_figure(&AnswerCurve {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!("Target: {}.", self.target_in_words()),
            notes,
            x: self.searched.label.clone(),
            is_log: self.searched.span.is_log && names.is_empty(),
            names,
            limit: self.target.limit,
            limit_label: y.value(&number::exact(self.target.limit)),
            y,
            lines,
            runs: stretches(column),
        })
    }

    /// Points of a line, each from a sample at a tried value.
    fn curve_points(
        &self,
        column: &RegionColumn,
        sample_of: impl Fn(&DesignPoint) -> Option<Sample>,
    ) -> Vec<CurvePoint> {
        let points = column.points.iter().filter_map(|point| {
            let sample = sample_of(point)?;
            let (y, std) = sample.statistic?;
            Some(CurvePoint {
                x: point.value,
                y,
                std,
                is_of_survivors: sample.failure_rate() > self.max_failures,
            })
        });
        points.collect()
    }
}

fn stretches(column: &RegionColumn) -> Vec<Stretch> {
    let runs = column.runs.iter().map(|run| Stretch {
        from: run.from,
        to: run.to,
        meets: run.side == Side::Meets,
    });
    runs.collect()
}

fn axis(field: &Field) -> RegionAxis {
    let names = 0..field.listed.len();
    RegionAxis {
        label: field.label.clone(),
        is_log: field.span.is_log,
        ends: (field.span.from, field.span.to),
        names: names.map(|place| field.text(place as f64)).collect(),
    }
}
