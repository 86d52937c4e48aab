//! Tests how numbers are written as texts.

use palpate_statistics::Number;
use palpate_study::number::{finite, grouped, rounded, significant};

#[test]
fn numbers_are_short_and_exact_enough() {
    for (value, text) in [
        (0.0, "0"),
        (0.07 * 100.0, "7"),
        (500.0, "500"),
        (0.001, "0.001"),
        (-2.5, "−2.5"),
        (1e-9, "1 × 10⁻⁹"),
        (123456.7, "123457"),
        (999999.9, "1 × 10⁶"),
        (2.5e10, "2.5 × 10¹⁰"),
    ] {
        assert_eq!(rounded(value), text);
    }
    for (value, text) in [(11.8765, "11.9"), (584.4, "584"), (58_440.0, "58440")] {
        assert_eq!(significant(value, 3), text);
    }
    for (value, text) in [
        (0.0, "0"),
        (7.0, "7"),
        (1.0 / 3.0, "0.3333333333333333"),
        (-1e16, "-1e16"),
        (1e300, "1e300"),
        (5e-324, "5e-324"),
        (0.0001, "0.0001"),
    ] {
        assert_eq!(Number(value).to_string(), text);
    }
    assert_eq!(grouped(1_234_567), "1,234,567");
    assert_eq!(grouped(999), "999");
    assert_eq!(
        (finite(" 2 "), finite("inf"), finite("")),
        (Some(2.0), None, None)
    );
}
