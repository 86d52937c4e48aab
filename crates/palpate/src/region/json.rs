//! The answer of several fields as JSON.

use palpate_study::config::Study;
use serde_json::{Map, Value, json};

use super::found::Region;
use crate::design::{Field, found, shown};

impl Region {
    /// The answer as JSON: its sentence, what was found at each combination of the grid, and the best value that meets the
    /// target.
    pub fn to_json(&self, study: &Study) -> Value {
        let field = |field: &Field| json!({ "path": field.path, "unit": field.label.unit });
        let columns = self.columns.iter().map(|column| {
            let at = self.grid.iter().zip(&column.at);
            let at = at.map(|(field, value)| (field.path.clone(), shown(field, *value)));
            let mut value = Map::from_iter([("at".to_owned(), Value::Object(at.collect()))]);
            value.extend(found(&column.answer));
            Value::Object(value)
        });
        let answer = &self.columns[0].answer;
        let best = self.best().map(|best| {
            let pairs = self.grid.iter().zip(&best.column.at);
            let grid = pairs.map(|(field, value)| (field.path.clone(), shown(field, *value)));
            let searched = self.searched();
            let searched = (searched.path.clone(), shown(searched, best.searched));
            Value::Object(grid.chain([searched]).collect())
        });
        json!({
            "format_version": 1,
            "study": study.config.name,
            "answer": self.sentence(),
            "target": answer.target.to_string(),
            "max_failures": answer.max_failures,
            "grid": self.grid.iter().map(field).collect::<Vec<_>>(),
            "path": self.searched().path,
            "unit": self.searched().label.unit,
            "confidence": self.confidence,
            "sought": self.sought.as_ref().map(|sought| &sought.path),
            "best_that_meets": best,
            "columns": columns.collect::<Vec<_>>(),
        })
    }
}
