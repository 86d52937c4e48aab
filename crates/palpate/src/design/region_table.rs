//! Answer of a design as tables and as JSON.

use palpate_study::config::Study;
use palpate_study::{Table, number};
use palpate_sweep::Side;
use serde_json::{Map, Value, json};

use super::feasible_region::{DesignPoint, Region, RegionColumn, Sample};
use super::field::Field;

impl Region {
    /// Table of all trials: one row per combination of the grid, value, cell and sample (trials of the search, and fresh
    /// trials that verify), with the target's statistic, its standard error, and the side of the target.
    pub fn table(&self) -> Table {
        let grid = self.grid.iter().map(|field| &field.column);
        let fields = grid.chain([&self.searched.column]).cloned();
        let statistics = [
            "quantity",
            "unit",
            "sample",
            "trials",
            "failures",
            self.target.statistic.name(),
            "std_error",
            "verdict",
        ];
        let fields = fields.chain(["cell".to_owned()]);
        let fields = fields.chain(self.cell_columns.iter().cloned());
        let mut table = Table::new(fields.chain(statistics.map(str::to_owned)));
        let quantity = self.target.quantity.map_or("", |quantity| quantity.name);
        let mut push = |column: &RegionColumn, point: &DesignPoint, name: &str, sample: &Sample| {
            let text = |number: Option<f64>| number.map_or(String::new(), number::shortest);
            let value = [self.searched.text(point.value), sample.cell.to_string()];
            let coordinates = self.cells.get(sample.cell).into_iter().flatten().cloned();
            let statistics = [
                quantity.to_owned(),
                self.unit.to_owned(),
                name.to_owned(),
                sample.trials.to_string(),
                sample.failed.to_string(),
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

    /// Table of the runs: one row per run of values of the searched field that meet the target, or miss it, after the
    /// values of the grid. Values between runs are undecided.
    pub fn runs(&self) -> Table {
        let field = &self.searched;
        let fields = self.grid.iter().map(|field| field.column.clone());
        let ends = ["from", "to"].map(|end| format!("{}.{end}", field.column));
        let mut table = Table::new(fields.chain(ends).chain(["verdict".to_owned()]));
        for column in &self.columns {
            for run in &column.runs {
                let ends = [run.from, run.to].map(|value| field.text(value));
                let row = self.grid_texts(column).chain(ends);
                let row = row.chain([verdict(Some(run.side)).to_owned()]);
                table.rows.push(row.collect());
            }
        }
        table
    }

    /// Values of the grid at a column, as the tables show them.
    fn grid_texts(&self, column: &RegionColumn) -> impl Iterator<Item = String> {
        let pairs = self.grid.iter().zip(&column.at);
        pairs.map(|(field, value)| field.text(*value))
    }

    /// The answer as JSON: its sentence, the runs of values that meet the target and that miss it at each combination of
    /// the grid, and the best value.
    pub fn to_json(&self, study: &Study) -> Value {
        let mut value = json!({
            "format_version": 1,
            "study": study.config.name,
            "answer": self.sentence(),
            "target": self.target.to_string(),
            "max_failures": self.max_failures,
            "path": self.searched.path,
            "unit": self.searched.label.unit,
            "confidence": self.confidence,
        });
        let Some(fields) = value.as_object_mut() else {
            return value;
        };
        if self.is_curve() {
            fields.extend(self.column_json(&self.columns[0]));
            return value;
        }
        let columns = self.columns.iter().map(|column| {
            let at = self.grid_json(column).collect();
            let mut value = Map::from_iter([("at".to_owned(), Value::Object(at))]);
            value.extend(self.column_json(column));
            Value::Object(value)
        });
        let best = self.best().map(|best| {
            let searched = (
                self.searched.path.clone(),
                json_of(&self.searched, best.searched),
            );
            Value::Object(self.grid_json(best.column).chain([searched]).collect())
        });
        let grid = self.grid.iter();
        let grid = grid.map(|field| json!({ "path": field.path, "unit": field.label.unit }));
        let sought = self.sought.as_ref().map(|sought| &sought.path);
        fields.insert("grid".to_owned(), grid.collect());
        fields.insert("sought".to_owned(), json!(sought));
        fields.insert("best_that_meets".to_owned(), json!(best));
        fields.insert("columns".to_owned(), columns.collect());
        value
    }

    /// Values of the grid at a column, by their paths.
    fn grid_json(&self, column: &RegionColumn) -> impl Iterator<Item = (String, Value)> {
        let pairs = self.grid.iter().zip(&column.at);
        pairs.map(|(field, value)| (field.path.clone(), json_of(field, *value)))
    }

    /// Results of a column.
    fn column_json(&self, column: &RegionColumn) -> Map<String, Value> {
        let value = |value: f64| json_of(&self.searched, value);
        let runs = |side: Side| -> Value {
            let runs = column.on(side);
            runs.map(|run| json!({ "from": value(run.from), "to": value(run.to) }))
                .collect()
        };
        let best = self.nearest_in(column).map(|(point, sample)| {
            json!({
                "value": value(point.value),
                "statistic": sample.statistic.map(|(value, _)| value),
                "std_error": sample.statistic.map(|(_, std)| std),
                "failing": sample.failure_rate(),
            })
        });
        Map::from_iter([
            ("meets".to_owned(), runs(Side::Meets)),
            ("misses".to_owned(), runs(Side::Misses)),
            ("best".to_owned(), json!(best)),
            ("narrowed".to_owned(), json!(column.narrowed)),
            (
                "ended".to_owned(),
                json!(format!("{:?}", column.ended).to_lowercase()),
            ),
        ])
    }
}

/// Value of a field: a number, or the text of a listed value.
fn json_of(field: &Field, value: f64) -> Value {
    match field.is_listed() {
        true => json!(field.text(value)),
        false => json!(value),
    }
}

/// Side of the target as a word.
fn verdict(side: Option<Side>) -> &'static str {
    match side {
        Some(Side::Meets) => "meets",
        Some(Side::Misses) => "misses",
        None => "undecided",
    }
}
