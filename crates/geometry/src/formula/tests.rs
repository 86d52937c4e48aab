mod derivatives;
mod errors;
mod grammar;

use std::collections::BTreeMap;
use std::f64::consts::{E, PI};

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

fn assert_values(table: &[(&str, f64)]) {
    for (text, expected) in table {
        let ulps = (value(text) - expected).abs() / (f64::EPSILON * expected);
        assert!(ulps <= 1.0, "{text}: {ulps} ulp");
    }
}

#[test]
fn operators_group_as_in_mathematics() {
    let table = [
        ("2*3^2", 18.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-1", 0.5),
        ("2^-2^2", 0.0625),
        ("2^-1*4", 2.0),
        ("+3", 3.0),
        ("2--3", 5.0),
        ("((((7))))", 7.0),
        (" 1\t+\n2 ", 3.0),
    ];
    assert_values(&table);
}

#[test]
fn numbers() {
    let table = [
        ("1", 1.0),
        (".5", 0.5),
        ("2.", 2.0),
        ("1e-3", 1e-3),
        ("1e3-1", 999.0),
        ("2.5E+4", 2.5e4),
        ("1E2", 100.0),
        ("pi", PI),
        ("exp(1)", E),
    ];
    assert_values(&table);
}

#[test]
fn parameters_are_constants() {
    let given = parameters(&[("A", 0.15), ("k", 0.7), ("exponent_2", 3.0), ("λ", 2.0)]);
    let formula = Formula::parse("A*sin(k*x)^exponent_2 + λ", &given).unwrap();
    assert_eq!(
        formula.value(1.0, 0.0),
        0.15 * libm::sin(0.7_f64).powi(3) + 2.0
    );
    let given = parameters(&[("e1", 4.0)]);
    assert_eq!(Formula::parse("x*e1", &given).unwrap().value(2.0, 0.0), 8.0);
}

#[test]
fn any_length_is_evaluated_on_the_small_stack() {
    let ones = vec!["x"; 5000].join("+");
    assert_eq!(formula(&ones).value(1.0, 0.0), 5000.0);
    let horner = format!("{}x{}", "x*(1+".repeat(30), ")".repeat(30));
    assert_eq!(formula(&horner).value(1.0, 0.0), 31.0);
    fn balanced(depth: usize) -> String {
        match depth {
            0 => "x".into(),
            _ => format!(
                "({}-{})",
                balanced(depth - 1),
                balanced(depth - 1).replace('x', "y")
            ),
        }
    }
    let deep = balanced(11);
    assert!(deep.len() > 8000);
    assert_eq!(formula(&deep).value(3.0, 1.0), 2.0);
    let deepest = format!("{}x{}", "(".repeat(99), ")".repeat(99));
    assert_eq!(formula(&deepest).value(3.0, 0.0), 3.0);
}
