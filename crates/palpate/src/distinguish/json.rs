//! Objects told apart, as JSON.

use palpate_study::config::Study;
use palpate_sweep::Repeats;
use serde_json::{Value, json};

use super::found::ToldApart;

impl ToldApart {
    /// Objects told apart, as JSON: every two of each group with the probability, its 95 % interval and the trials
    /// that are enough, and the sentences.
    pub fn to_json(&self, study: &Study) -> Value {
        let groups = self.groups.iter().map(|group| {
            let pairs = group.pairs.iter().map(|pair| {
                let [first, second] = [pair.first, pair.second]
                    .map(|place| self.object_in_words(&group.objects[place]));
                let repeats = match pair.repeats {
                    Some(Repeats::Found(count) | Repeats::About(count)) => json!(count),
                    _ => Value::Null,
                };
                json!({
                    "first": first,
                    "second": second,
                    "told_apart": pair.order.map(|order| order.probability),
                    "low95": pair.order.map(|order| order.low),
                    "high95": pair.order.map(|order| order.high),
                    "repeats": repeats,
                })
            });
            json!({
                "settings": self.settings_in_words(group),
                "pairs": pairs.collect::<Vec<_>>(),
            })
        });
        json!({
            "format_version": 1,
            "study": study.config.name,
            "quantity": self.quantity.name,
            "confidence": self.confidence,
            "groups": groups.collect::<Vec<_>>(),
            "answer": self.sentences(),
        })
    }
}
