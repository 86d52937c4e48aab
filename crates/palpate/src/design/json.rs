//! The answer of a design as JSON.

use palpate_study::config::Study;
use palpate_sweep::Side;
use serde_json::{Map, Value, json};

use super::answer::Answer;
use super::field::Field;

impl Answer {
    /// The answer as JSON: its sentence, the runs of values that meet the target and that miss it, and the best value.
    pub fn to_json(&self, study: &Study) -> Value {
        let mut value = json!({
            "format_version": 1,
            "study": study.config.name,
            "answer": self.sentence(),
            "target": self.target.to_string(),
            "max_failures": self.max_failures,
            "path": self.field.path,
            "unit": self.field.label.unit,
            "confidence": self.confidence,
        });
        if let Some(value) = value.as_object_mut() {
            value.extend(found(self));
        }
        value
    }
}

/// Value of a field: a number, or the text of one that is listed.
pub(crate) fn shown(field: &Field, value: f64) -> Value {
    match field.is_listed() {
        true => json!(field.text(value)),
        false => json!(value),
    }
}

/// Findings along a field.
pub(crate) fn found(answer: &Answer) -> Map<String, Value> {
    let text = |value: f64| shown(&answer.field, value);
    let runs = |side: Side| -> Value {
        let runs = answer.on(side);
        runs.map(|run| json!({ "from": text(run.from), "to": text(run.to) }))
            .collect()
    };
    let best = answer.best().map(|(looked, sample)| {
        json!({
            "value": text(looked.value),
            "statistic": sample.statistic.map(|(value, _)| value),
            "std_error": sample.statistic.map(|(_, std)| std),
            "failing": sample.failing(),
        })
    });
    Map::from_iter([
        ("meets".to_owned(), runs(Side::Meets)),
        ("misses".to_owned(), runs(Side::Misses)),
        ("best".to_owned(), best.unwrap_or(Value::Null)),
        ("narrowed".to_owned(), json!(answer.narrowed)),
        (
            "ended".to_owned(),
            json!(format!("{:?}", answer.ended).to_lowercase()),
        ),
    ])
}
