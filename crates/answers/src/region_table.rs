//! The answer of `palpate design` (a region of values that meet the target) as tables and JSON.

use palpate_study::config::Study;
use palpate_study::{Table, number};
use serde_json::{Map, Value, json};

use crate::field::Field;
use crate::region::{DesignPoint, Region, RegionColumn, Sample};
use crate::search::Side;

impl Region {
    /// The answer as JSON: the sentence, the best value, and the ranges of values that meet or miss the target at each
    /// combination of values of the fields in [`Region::grid`]. If only one field is varied, there is only one
    /// combination, and its results also appear at the top level of the JSON object.
    pub(crate) fn region_json(&self, study: &Study) -> Value {
        let columns = self.columns.iter().map(|column| {
            let at: Map<_, _> = self.grid_json(column).collect();
            let fields = [("at".to_owned(), Value::Object(at))];
            fields
                .into_iter()
                .chain(self.column_json(column))
                .collect::<Value>()
        });
        let best = self.best().map(|best| {
            let field = &self.searched;
            let searched = (field.path.clone(), json_of(field, best.searched));
            let all = self.grid_json(best.column).chain([searched]);
            all.collect::<Value>()
        });
        let grid = self.grid.iter();
        let grid = grid.map(|field| json!({ "path": field.path, "unit": field.label.unit }));
        let question = &self.question;
        let mut value = json!({
            "format_version": 1,
            "study": study.config.name,
            "answer": self.sentence(),
            "target": question.target.to_string(),
            "max_failures": question.max_failures,
            "path": self.searched.path,
            "unit": self.searched.label.unit,
            "confidence": question.confidence,
            "grid": grid.collect::<Value>(),
            "sought": question.sought.as_ref().map(|sought| &sought.path),
            "best_that_meets": best,
            "columns": columns.collect::<Value>(),
        });
        if let (true, [only], Some(fields)) = (
            self.grid.is_empty(),
            &self.columns[..],
            value.as_object_mut(),
        ) {
            fields.extend(self.column_json(only));
        }
        value
    }

    /// Table of the results of all trials. It has one row for each combination of values of the fields in
    /// [`Region::grid`], each tested value of the searched field, each cell, and each kind of trials. The kinds are
    /// trials of the search, and fresh trials that verify the answer. A row contains the statistic that is compared
    /// with the target, its standard error, and whether the tested value meets the target.
    pub(crate) fn results_table(&self) -> Table {
        let grid = self.grid.iter().map(|field| &field.column);
        let fields = grid.chain([&self.searched.column]).cloned();
        let target = &self.question.target;
        let statistics = [
            "quantity",
            "unit",
            "sample",
            "trials",
            "failures",
            "main_failure",
            target.statistic.name(),
            "std_error",
            "verdict",
        ];
        let fields = fields.chain(["cell".to_owned()]);
        let fields = fields.chain(self.cell_columns.iter().cloned());
        let mut table = Table::new(fields.chain(statistics.map(str::to_owned)));
        let quantity = target.quantity.map_or("", |quantity| quantity.name);
        let mut push = |column: &RegionColumn, point: &DesignPoint, name: &str, sample: &Sample| {
            let text = |number: Option<f64>| number.map_or(String::new(), number::shortest);
            let value = [self.searched.text(point.value), sample.cell.to_string()];
            let coordinates = self.cells.get(sample.cell).into_iter().flatten().cloned();
            let counts = &sample.counts;
            let statistics = [
                quantity.to_owned(),
                self.unit.to_owned(),
                name.to_owned(),
                counts.trials.to_string(),
                counts.failed.to_string(),
                counts.main_failure.map_or("", |(kind, _)| kind).to_owned(),
                text(sample.statistic.map(|(value, _)| value)),
                text(sample.statistic.map(|(_, std)| std)),
                verdict(point.side).to_owned(),
            ];
            let row = self.grid_texts(column).chain(value).chain(coordinates);
            table.rows.push(row.chain(statistics).collect());
        };
        for column in &self.columns {
            for point in &column.points {
                for (name, samples) in [("search", &point.searched), ("fresh", &point.fresh)] {
                    for sample in samples {
                        push(column, point, name, sample);
                    }
                }
            }
        }
        table
    }

    /// Table of the ranges of values of the searched field that meet or miss the target, with one row per range. The
    /// first columns are the values of the fields in [`Region::grid`]. It is undecided whether values between two
    /// ranges meet the target.
    pub fn runs(&self) -> Table {
        let field = &self.searched;
        let fields = self.grid.iter().map(|field| field.column.clone());
        let ends = ["from", "to"].map(|end| format!("{}.{end}", field.column));
        let mut table = Table::new(fields.chain(ends).chain(["verdict".to_owned()]));
        for column in &self.columns {
            for run in &column.runs {
                let ends = [run.from, run.to].map(|value| field.text(value));
                let row = self.grid_texts(column).chain(ends);
                let row = row.chain([verdict(Some(run.into())).to_owned()]);
                table.rows.push(row.collect());
            }
        }
        table
    }

    fn grid_texts(&self, column: &RegionColumn) -> impl Iterator<Item = String> {
        let pairs = self.grid.iter().zip(&column.at);
        pairs.map(|(field, value)| field.text(*value))
    }

    fn grid_json(&self, column: &RegionColumn) -> impl Iterator<Item = (String, Value)> {
        let pairs = self.grid.iter().zip(&column.at);
        pairs.map(|(field, value)| (field.path.clone(), json_of(field, *value)))
    }

    /// The results at one combination of the grid's values, as entries of a JSON object.
    fn column_json(&self, column: &RegionColumn) -> Map<String, Value> {
        let value = |value: f64| json_of(&self.searched, value);
        let runs = |side: Side| -> Value {
            let runs = column.on(side);
            runs.map(|run| json!({ "from": value(run.from), "to": value(run.to) }))
                .collect()
        };
        let result = |(point, sample): (&DesignPoint, &Sample)| {
            json!({
                "value": value(point.value),
                "statistic": sample.statistic.map(|(value, _)| value),
                "std_error": sample.statistic.map(|(_, std)| std),
                "failing": sample.counts.failure_rate(),
                "main_failure": sample.counts.main_failure.map(|(kind, _)| kind),
            })
        };
        let best = self.nearest([column]);
        let results = json!({
            "meets": runs(Side::Meets),
            "misses": runs(Side::Misses),
            "best": best.map(|(_, point, sample)| result((point, sample))),
            "failing_end": self.failing_end(column).map(result),
            "narrowed": column.narrowed,
            "ended": format!("{:?}", column.ended).to_lowercase(),
        });
        match results {
            Value::Object(results) => results,
            _ => Map::new(),
        }
    }
}

/// A field's value as JSON: a text if the user listed the field's values (`PATH=A,B,C`), a number if the user stated a
/// range.
fn json_of(field: &Field, value: f64) -> Value {
    match field.is_listed() {
        true => json!(field.text(value)),
        false => json!(value),
    }
}

fn verdict(side: Option<Side>) -> &'static str {
    match side {
        Some(Side::Meets) => "meets",
        Some(Side::Misses) => "misses",
        None => "undecided",
    }
}
