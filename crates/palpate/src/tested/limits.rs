//! Limits of what random scenes have drawn.

use palpate_statistics::Number;
use palpate_study::config::LengthUnit;

/// Name of the family of random scenes that a scene is like, with what of the scene lies beyond their draws, in words; or why
/// there is no such family.
pub(super) type Likeness = Result<(String, Vec<String>), String>;

/// Numbers of a scene that lie beyond what random scenes have drawn.
pub(super) struct Limits {
    unit: &'static str,
    beyond: Vec<String>,
}

impl Limits {
    /// Limits of a scene whose lengths are in this unit.
    pub(super) fn new(unit: LengthUnit) -> Self {
        Self {
            unit: unit.as_str(),
            beyond: Vec::new(),
        }
    }

    /// Asks that a number lie between two.
    pub(super) fn within(&mut self, what: &str, number: f64, [low, high]: [f64; 2], unit: &str) {
        // A limit that was computed from another is met by a number that is written as it.
        let slack = 1e-9 * low.abs().max(high.abs());
        if !(low - slack..=high + slack).contains(&number) {
            let number = Number::rounded(number);
            let [least, most] = [low, high].map(shown);
            let drawn = match low == high {
                true => least,
                false => format!("{least} to {most}"),
            };
            self.beyond.push(format!(
                "{what} of {number}{unit} (they have {drawn}{unit})"
            ));
        }
    }

    /// Asks that a length lie between two.
    pub(super) fn length_within(&mut self, what: &str, length: f64, between: [f64; 2]) {
        let unit = format!(" {}", self.unit);
        self.within(what, length, between, &unit);
    }

    /// Asks that a curvature lie between two.
    pub(super) fn curvature_within(&mut self, curvature: f64, between: [f64; 2]) {
        let unit = format!(" per {}", self.unit);
        self.within("curvature", curvature, between, &unit);
    }

    /// The family's name, with what lies beyond.
    pub(super) fn likeness(self, name: String) -> Likeness {
        Ok((name, self.beyond))
    }
}

/// A limit to as many digits as tell it from others.
fn shown(limit: f64) -> String {
    match limit >= 100.0 {
        true => Number(limit.round()).to_string(),
        false => Number::rounded(limit).to_string(),
    }
}

/// Refuses a family where something is not so.
pub(super) fn unless(is_so: bool, else_words: &str) -> Result<(), String> {
    match is_so {
        true => Ok(()),
        false => Err(else_words.to_owned()),
    }
}

/// Two shares of a radius as lengths.
pub(super) fn scaled(shares: [f64; 2], radius: f64) -> [f64; 2] {
    shares.map(|share| share * radius)
}
