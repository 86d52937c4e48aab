mod derivatives;
mod errors;
mod grammar;
mod values;

use std::collections::BTreeMap;

use super::*;

fn parameters(pairs: &[(&str, f64)]) -> BTreeMap<String, f64> {
    pairs
        .iter()
        .map(|&(name, value)| (name.into(), value))
        .collect()
}

fn formula(text: &str) -> Formula {
    Formula::parse(text, &BTreeMap::new()).unwrap_or_else(|error| panic!("{error}"))
}

fn value(text: &str) -> f64 {
    formula(text).value(f64::NAN, f64::NAN)
}

fn jet(value: f64, gradient: [f64; 2], hessian: [f64; 3]) -> Jet {
    Jet {
        value,
        gradient,
        hessian,
    }
}

fn components(jet: &Jet) -> [f64; 6] {
    let ([x, y], [xx, xy, yy]) = (jet.gradient, jet.hessian);
    [jet.value, x, y, xx, xy, yy]
}

#[track_caller]
fn assert_close(found: &Jet, expected: &Jet, tolerance: f64, what: &str) {
    for (a, b) in components(found).into_iter().zip(components(expected)) {
        let within = (a - b).abs() <= tolerance * (1.0 + b.abs());
        assert!(within, "{what}: {found:?} is not {expected:?}");
    }
}
