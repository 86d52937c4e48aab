use std::f64::consts::PI;

use proptest::prelude::*;

use super::*;

#[test]
fn powers_are_right_at_zero_and_below() {
    let at = |text, x| components(&formula(text).jet(x, 0.0));
    let flat = |value, first, second| [value, first, 0.0, second, 0.0, 0.0];
    assert_eq!(at("x^0", 0.0), flat(1.0, 0.0, 0.0));
    assert_eq!(at("x^1", 0.0), flat(0.0, 1.0, 0.0));
    assert_eq!(at("x^2", 0.0), flat(0.0, 0.0, 2.0));
    assert_eq!(at("x^3", 0.0), flat(0.0, 0.0, 0.0));
    assert_eq!(at("x^2.5", 0.0), flat(0.0, 0.0, 0.0));
    assert_eq!(at("x^40", 0.0), flat(0.0, 0.0, 0.0));
    assert_eq!(at("x^2", -3.0), flat(9.0, -6.0, 2.0));
    assert_eq!(at("x^3", -2.0), flat(-8.0, 12.0, -12.0));
    assert_eq!(at("x^17", -1.0), flat(-1.0, 17.0, -272.0));
    assert_eq!(at("x^-1", -2.0), flat(-0.5, -0.25, -0.25));
    assert_eq!(at("x^-2", -2.0), flat(0.25, 0.25, 0.375));
    assert_eq!(at("x^0.5", 4.0), flat(2.0, 0.25, -0.03125));
    assert_eq!(at("2^x", 0.0)[..2], [1.0, libm::log(2_f64)]);
}

#[test]
fn are_not_finite_exactly_where_they_do_not_exist() {
    let singular = [
        "sqrt(x)",
        "cbrt(x)",
        "abs(x)",
        "ln(x)",
        "log10(x)",
        "x^0.5",
        "x^1.5",
        "x^-1",
        "1/x",
        "x^y",
        "hypot(x, y)",
        "atan2(x, y)",
        "asin(1+x)",
        "acos(x-1)",
        "ln(x-1)",
        "sqrt(x-1)",
        "asin(x+2)",
        "(x-1)^0.5",
        "exp(1000+x)",
        "(-1)^x",
        "0^x",
    ];
    for text in singular {
        assert!(!formula(text).jet(0.0, 0.0).is_finite(), "{text}");
    }
    let regular = [
        ("atan2(x+1, y)", jet(PI / 2.0, [0.0, -1.0], [0.0, 1.0, 0.0])),
        ("hypot(x, y+2)", jet(2.0, [0.0, 1.0], [0.5, 0.0, 0.0])),
        ("hypot(x, 2)", jet(2.0, [0.0, 0.0], [0.5, 0.0, 0.0])),
        ("tanh(x+1000)", jet(1.0, [0.0; 2], [0.0; 3])),
        ("abs(x-1)", jet(1.0, [-1.0, 0.0], [0.0; 3])),
        ("abs(x/2)^2.5", jet(0.0, [0.0; 2], [0.0; 3])),
        ("abs(x/2)^2", jet(0.0, [0.0; 2], [0.5, 0.0, 0.0])),
        ("abs(x-1)^3", jet(1.0, [-3.0, 0.0], [6.0, 0.0, 0.0])),
    ];
    for (text, expected) in regular {
        assert_close(&formula(text).jet(0.0, 0.0), &expected, 1e-14, text);
    }
}

/// The value and derivatives of a formula. The gradient is computed from values by central differences, and the second
/// derivatives from exact gradients.
fn by_differences(formula: &Formula, x: f64, y: f64) -> Jet {
    let h = 1e-5;
    let (e, w) = (formula.jet(x + h, y), formula.jet(x - h, y));
    let (n, s) = (formula.jet(x, y + h), formula.jet(x, y - h));
    let slope = |a: f64, b: f64| (a - b) / (2.0 * h);
    let xy = slope(e.gradient[1], w.gradient[1]);
    let yx = slope(n.gradient[0], s.gradient[0]);
    assert!(
        (xy - yx).abs() <= 1e-7 * (1.0 + xy.abs()),
        "{formula:?}: {xy} is not {yx}"
    );
    jet(
        formula.value(x, y),
        [
            slope(formula.value(x + h, y), formula.value(x - h, y)),
            slope(formula.value(x, y + h), formula.value(x, y - h)),
        ],
        [
            slope(e.gradient[0], w.gradient[0]),
            xy,
            slope(n.gradient[1], s.gradient[1]),
        ],
    )
}

proptest! {
    #[test]
    fn agree_with_differences(x in -0.9..0.9_f64, y in -0.9..0.9_f64) {
        // `inner` has linear, mixed and square terms. For all x and y of this test, its values are in the range where
        // every function of `table` is regular.
        let inner = "(0.4*x+0.3*y+0.2*x*y-0.1*x^2)";
        let positive = format!("(1.5+{inner})");
        let table = [
            ("sin", inner), ("cos", inner), ("tan", inner), ("asin", inner), ("acos", inner),
            ("atan", inner), ("sinh", inner), ("cosh", inner), ("tanh", inner), ("exp", inner),
            ("ln", &positive), ("log10", &positive), ("sqrt", &positive), ("cbrt", &positive),
            ("abs", &positive), ("-", inner), ("3-", inner), ("2*", inner), ("2/", &positive),
            ("1.7^", inner), ("x^2-y*", inner), ("(x-y)/", &positive),
        ];
        let two = [
            format!("atan2({inner}, 2-x*y)"), format!("atan2(2-x*y, {inner})"),
            format!("hypot({inner}, 2-x*y)"), format!("hypot(3, {inner})"),
            format!("{positive}^(x+y*y)"), format!("{positive}^2.7"), format!("{positive}^-1.3"),
            format!("{inner}^5"), format!("{positive}^-3"), format!("{positive}^23"),
            format!("{inner}/7"), format!("x-(y/(3+x*{inner}))"), format!("abs({inner}-2)"),
            format!("cbrt({inner}-2)"),
        ];
        let one = table.iter().map(|(function, inner)| format!("{function}{inner}"));
        for text in one.chain(two) {
            let formula = formula(&text);
            let jet = formula.jet(x, y);
            prop_assert_eq!(jet.value, formula.value(x, y), "{}", text);
            assert_close(&jet, &by_differences(&formula, x, y), 1e-6, &text);
        }
    }
}
