//! Formulas and configs.

use std::collections::BTreeMap;
use std::hint::black_box;

use anyhow::Result;
use palpate_geometry::formula::Formula;
use palpate_study::config;

use crate::measured::Evaluation;

/// Heights of a formula with their derivatives.
///
/// # Errors
/// None: the formula is sound.
pub fn evaluated(name: &str, points: u32) -> Result<Evaluation> {
    let parameters = BTreeMap::from([("a".to_owned(), 0.2)]);
    let formula = Formula::parse("a * sin(2 * x) * cos(2 * y) + x^2 / 8", &parameters)?;
    Ok(Evaluation::new(name, move || {
        (0..points).for_each(|point| {
            black_box(formula.jet(0.01 * f64::from(point), black_box(0.3)));
        });
    }))
}

/// A config with two sweeps and two plots.
///
/// # Errors
/// None: the config is sound.
pub fn parsed(name: &str) -> Result<Evaluation> {
    let text = include_str!("../../../../examples/press-a-ball.toml");
    config::parse("press-a-ball.toml", text)?;
    Ok(Evaluation::new(name, move || {
        config::parse("press-a-ball.toml", black_box(text))
    }))
}
