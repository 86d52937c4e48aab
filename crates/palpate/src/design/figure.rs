//! Figure of a design's answer.

use palpate_report::{AnswerCurve, CurveLine, CurvePoint, Figure, ReportError, Stretch};
use palpate_study::{Label, number};
use palpate_sweep::Side;

use super::answer::{Answer, LookedAt, Sample};

/// Most cells that have a line each; of more, only the worst is drawn.
const MOST_LINES: usize = 7;

impl Answer {
    /// Figure of the target's statistic over the field: the limit as a line, and the values that meet it shaded. `name` is
    /// that of its files.
    ///
    /// # Errors
    /// [`ReportError`] where it cannot be drawn.
    pub fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
        let y = self.label();
        let lines = match self.cells.len() {
            cells if cells > MOST_LINES => vec![CurveLine {
                label: "the worst cell".to_owned(),
                points: self.points(|looked| looked.decisive(self.target.bound, self.max_failures)),
            }],
            cells => {
                let line = |cell: usize| CurveLine {
                    label: match cells {
                        1 => String::new(),
                        _ => self.cell_in_words(cell),
                    },
                    points: self.points(|looked| looked.searched.get(cell)),
                };
                (0..cells).map(line).collect()
            }
        };
        let stretch = |run: &palpate_sweep::Run| Stretch {
            from: run.from,
            to: run.to,
            meets: run.side == Side::Meets,
        };
        let names = match self.field.is_listed() {
            true => self
                .looked
                .iter()
                .map(|looked| self.field.text(looked.value))
                .collect(),
            false => Vec::new(),
        };
        let mut notes = vec![self.sentence()];
        let failing = lines.iter().flat_map(|line| &line.points);
        if failing.clone().any(|point| point.is_of_survivors) {
            let share = number::rounded(100.0 * self.max_failures);
            notes.push(format!(
                "Circled: points of which more than {share} % of the trials failed."
            ));
        }
        palpate_report::answer_figure(&AnswerCurve {
            name: name.to_owned(),
            title: title.to_owned(),
            subtitle: format!("Target: {}.", self.target_in_words()),
            notes,
            x: self.field.label.clone(),
            is_log: self.field.span.is_log && names.is_empty(),
            names,
            limit: self.target.limit,
            limit_label: y.value(&number::exact(self.target.limit)),
            y,
            lines,
            runs: self.runs.iter().map(stretch).collect(),
        })
    }

    fn points<'a>(&'a self, of: impl Fn(&'a LookedAt) -> Option<&'a Sample>) -> Vec<CurvePoint> {
        let point = |looked: &'a LookedAt| {
            let sample = of(looked)?;
            let (y, std) = sample.statistic?;
            Some(CurvePoint {
                x: looked.value,
                y,
                std,
                is_of_survivors: sample.failing() > self.max_failures,
            })
        };
        self.looked.iter().filter_map(point).collect()
    }

    fn cell_in_words(&self, cell: usize) -> String {
        let pairs = self
            .columns
            .iter()
            .zip(self.cells.get(cell).into_iter().flatten());
        let words = pairs.map(|(column, text)| {
            let label = Label::of_field(column);
            format!("{} {}", label.words, label.value(text))
        });
        words.collect::<Vec<_>>().join(", ")
    }
}
