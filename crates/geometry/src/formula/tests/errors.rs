use std::ops::Range;

use super::*;

fn error(text: &str) -> FormulaError {
    let all = parameters(&[("A", 0.15), ("k", 0.7)]);
    Formula::parse(text, &all).expect_err(text)
}

#[track_caller]
fn assert_shown(text: &str, expected: &[&str]) {
    assert_eq!(error(text).to_string(), expected.join("\n"));
}

/// Checks the error message for the formula `text`. `marked` is the range of columns that the message marks.
#[track_caller]
fn assert_marked(text: &str, message: &str, marked: Range<usize>) {
    let marks = " ".repeat(marked.start) + &"^".repeat(marked.len());
    let shown = [text.trim_end(), &marks].map(|line| format!("  {line}"));
    assert_shown(text, &[message, &shown[0], &shown[1]]);
}

#[test]
fn unknown_names() {
    for (text, unknown, marked) in [
        ("A*sin(kk*x)", "name `kk` (did you mean `k`?)", 6..8),
        ("X+1", "name `X` (did you mean `x`?)", 0..1),
        ("q+1", "name `q`", 0..1),
        ("x^e", "name `e` (did you mean `exp(1)`?)", 2..3),
        ("1 + sine(x)", "function `sine` (did you mean `sin`?)", 4..8),
        (
            "arctan(x)",
            "function `arctan` (did you mean `atan`?)",
            0..6,
        ),
        ("log(x)", "function `log` (did you mean `ln`?)", 0..3),
        ("f(x)", "function `f`", 0..1),
    ] {
        assert_marked(text, &format!("unknown {unknown}"), marked);
    }
}

#[test]
fn marks_stand_under_their_place_after_wide_letters() {
    assert_shown(
        "0*x + λλ*√",
        &["unknown name `λλ`", "  0*x + λλ*√", "        ^^"],
    );
    assert_shown(
        "x + √2",
        &["unexpected character `√`", "  x + √2", "      ^"],
    );
    let error = Formula::parse("λ*x + é$", &parameters(&[("λ", 1.0), ("é", 1.0)]));
    let error = error.unwrap_err();
    assert_eq!(error.span, Some(9..10));
    assert_eq!(
        error.to_string(),
        "unexpected character `$`\n  λ*x + é$\n         ^"
    );
    assert_shown(
        "x\n\t+ §",
        &["unexpected character `§`", "  x  + §", "       ^"],
    );
    assert_shown("x²", &["unexpected character `²`", "  x²", "   ^"]);
    assert_shown("x\u{7}", &["unexpected character `\\u{7}`", "  x", "   ^"]);
}

#[test]
fn numbers() {
    for (text, message, marked) in [
        ("x+1.2.3", "`1.2.3` is not a number", 2..7),
        ("1e+ + x", "`1e+` is not a number", 0..3),
        ("2e", "`2e` is not a number", 0..2),
        (".", "`.` is not a number", 0..1),
        ("x+1e999", "this part is inf, not finite", 2..7),
        ("x+2/(1-1)", "this part is inf, not finite", 2..9),
        ("x*sqrt( -1 )", "this part is NaN, not finite", 2..12),
    ] {
        assert_marked(text, message, marked);
    }
}

#[test]
fn multiplication_without_a_sign() {
    for (text, product, marked) in [
        ("2x", "2*x", 1..2),
        ("x y", "x*y", 2..3),
        ("x (1)", "x*(", 2..3),
        ("(x)pi", ")*pi", 3..5),
        ("x 2", "x*2", 2..3),
        ("2exp(x)", "2*exp", 1..4),
    ] {
        let message = format!("multiplication needs a sign: write `{product}`");
        assert_marked(text, &message, marked);
    }
}

#[test]
fn missing_operands() {
    let end = "the formula ends where a number, a name or `(` should follow";
    for (text, marked) in [("x +", 3..4), ("x +  ", 3..4), ("-", 1..2), ("(", 1..2)] {
        assert_marked(text, end, marked);
    }
    for (text, found, marked) in [
        ("*x", '*', 0..1),
        ("x/*2", '*', 2..3),
        ("()", ')', 1..2),
        ("hypot(x,)", ')', 8..9),
    ] {
        let message = format!("expected a number, a name or `(`, found `{found}`");
        assert_marked(text, &message, marked);
    }
    assert_marked("x**2", "write `^` for a power, not `**`", 1..3);
}

#[test]
fn parentheses_commas_and_functions() {
    let comma = "a comma belongs only between the arguments of a function";
    for (text, message, marked) in [
        ("2*(x+(1)", "this `(` has no matching `)`", 2..3),
        ("sin(x", "this `(` has no matching `)`", 3..4),
        ("x+1)", "this `)` has no matching `(`", 3..4),
        ("x, y", comma, 1..2),
        ("(x, y)", comma, 2..3),
        ("sin x", "`sin` is a function: write `sin(...)`", 0..3),
        ("x*sin", "`sin` is a function: write `sin(...)`", 2..5),
        ("1+sin()", "`sin` takes 1 argument, not 0", 2..7),
        ("sin(x, y)", "`sin` takes 1 argument, not 2", 0..9),
        ("atan2(x)", "`atan2` takes 2 arguments, not 1", 0..8),
        ("hypot(x,y,1)", "`hypot` takes 2 arguments, not 3", 0..12),
    ] {
        assert_marked(text, message, marked);
    }
}

#[test]
fn of_no_one_place() {
    assert_shown("", &["the formula is empty"]);
    assert_shown(" \t\n ", &["the formula is empty"]);
    assert_shown("A*x", &["parameter `k` does not occur in the formula"]);
    assert_shown(
        &"x".repeat(10_001),
        &["the formula has 10001 characters; at most 10000 are allowed"],
    );
    let of = |name, value| {
        Formula::parse("x", &parameters(&[(name, value)]))
            .unwrap_err()
            .to_string()
    };
    for name in ["x", "y", "pi", "sin", "hypot"] {
        let message = "is reserved in formulas and cannot name a parameter";
        assert_eq!(of(name, 1.0), format!("`{name}` {message}"));
    }
    assert_eq!(of("k", f64::NAN), "parameter `k` is NaN; it must be finite");
    assert_eq!(
        of("k", f64::NEG_INFINITY),
        "parameter `k` is -inf; it must be finite"
    );
    assert_eq!(
        of("two words", 1.0),
        "parameter `two words` does not occur in the formula"
    );
}

#[test]
fn nesting() {
    for deep in ["(", "-", "sin(", "2^", "1+(", "x*-("] {
        let text = deep.repeat(10_000 / deep.len());
        assert_eq!(
            error(&text).message,
            FormulaErrorKind::TooDeep.to_string(),
            "{deep}"
        );
    }
}

#[test]
fn the_end_is_marked_at_any_length() {
    for length in 1..200 {
        let shown = error(&"-".repeat(length).replace("--", "x+")).to_string();
        assert!(shown.ends_with(" ^"), "{shown}");
    }
}

#[test]
fn a_long_formula_is_shown_around_the_place() {
    let text = format!("{}$ + {}", "x + ".repeat(50), vec!["y"; 50].join(" + "));
    let shown = error(&text).to_string();
    assert_eq!(
        shown.lines().collect::<Vec<_>>(),
        [
            "unexpected character `$`",
            "  …x + x + x + x + x + x + x + x + x + $ + y + y + y + y + y + y + y + y +…",
            "                                       ^",
        ]
    );
}
