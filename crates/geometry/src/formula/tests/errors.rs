use super::*;

fn error(text: &str) -> FormulaError {
    let all = parameters(&[("A", 0.15), ("k", 0.7)]);
    Formula::parse(text, &all).expect_err(text)
}

#[track_caller]
fn assert_shown(text: &str, expected: &[&str]) {
    assert_eq!(error(text).to_string(), expected.join("\n"));
}

#[test]
fn unknown_names() {
    assert_shown(
        "A*sin(kk*x)",
        &[
            "unknown name `kk` (did you mean `k`?)",
            "  A*sin(kk*x)",
            "        ^^",
        ],
    );
    assert_shown(
        "X+1",
        &["unknown name `X` (did you mean `x`?)", "  X+1", "  ^"],
    );
    assert_shown("q+1", &["unknown name `q`", "  q+1", "  ^"]);
    assert_shown(
        "x^e",
        &[
            "unknown name `e` (did you mean `exp(1)`?)",
            "  x^e",
            "    ^",
        ],
    );
    assert_shown(
        "1 + sine(x)",
        &[
            "unknown function `sine` (did you mean `sin`?)",
            "  1 + sine(x)",
            "      ^^^^",
        ],
    );
    assert_shown(
        "arctan(x)",
        &[
            "unknown function `arctan` (did you mean `atan`?)",
            "  arctan(x)",
            "  ^^^^^^",
        ],
    );
    assert_shown(
        "log(x)",
        &[
            "unknown function `log` (did you mean `ln`?)",
            "  log(x)",
            "  ^^^",
        ],
    );
    assert_shown("f(x)", &["unknown function `f`", "  f(x)", "  ^"]);
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
    assert_shown(
        "x+1.2.3",
        &["`1.2.3` is not a number", "  x+1.2.3", "    ^^^^^"],
    );
    assert_shown("1e+ + x", &["`1e+` is not a number", "  1e+ + x", "  ^^^"]);
    assert_shown("2e", &["`2e` is not a number", "  2e", "  ^^"]);
    assert_shown(".", &["`.` is not a number", "  .", "  ^"]);
    assert_shown(
        "x+1e999",
        &["this part is inf, not finite", "  x+1e999", "    ^^^^^"],
    );
    assert_shown(
        "x+2/(1-1)",
        &["this part is inf, not finite", "  x+2/(1-1)", "    ^^^^^^^"],
    );
    assert_shown(
        "x*sqrt( -1 )",
        &[
            "this part is NaN, not finite",
            "  x*sqrt( -1 )",
            "    ^^^^^^^^^^",
        ],
    );
}

#[test]
fn multiplication_without_a_sign() {
    assert_shown(
        "2x",
        &["multiplication needs a sign: write `2*x`", "  2x", "   ^"],
    );
    assert_shown(
        "x y",
        &["multiplication needs a sign: write `x*y`", "  x y", "    ^"],
    );
    assert_shown(
        "x (1)",
        &[
            "multiplication needs a sign: write `x*(`",
            "  x (1)",
            "    ^",
        ],
    );
    assert_shown(
        "(x)pi",
        &[
            "multiplication needs a sign: write `)*pi`",
            "  (x)pi",
            "     ^^",
        ],
    );
    assert_shown(
        "x 2",
        &["multiplication needs a sign: write `x*2`", "  x 2", "    ^"],
    );
    assert_shown(
        "2exp(x)",
        &[
            "multiplication needs a sign: write `2*exp`",
            "  2exp(x)",
            "   ^^^",
        ],
    );
}

#[test]
fn missing_operands() {
    let end = "the formula ends where a number, a name or `(` should follow";
    assert_shown("x +", &[end, "  x +", "     ^"]);
    assert_shown("x +  ", &[end, "  x +", "     ^"]);
    assert_shown("-", &[end, "  -", "   ^"]);
    assert_shown("(", &[end, "  (", "   ^"]);
    assert_shown(
        "*x",
        &["expected a number, a name or `(`, found `*`", "  *x", "  ^"],
    );
    assert_shown(
        "x/*2",
        &[
            "expected a number, a name or `(`, found `*`",
            "  x/*2",
            "    ^",
        ],
    );
    assert_shown(
        "()",
        &[
            "expected a number, a name or `(`, found `)`",
            "  ()",
            "   ^",
        ],
    );
    assert_shown(
        "hypot(x,)",
        &[
            "expected a number, a name or `(`, found `)`",
            "  hypot(x,)",
            "          ^",
        ],
    );
    assert_shown(
        "x**2",
        &["write `^` for a power, not `**`", "  x**2", "   ^^"],
    );
}

#[test]
fn parentheses_and_commas() {
    assert_shown(
        "2*(x+(1)",
        &["this `(` has no matching `)`", "  2*(x+(1)", "    ^"],
    );
    assert_shown(
        "sin(x",
        &["this `(` has no matching `)`", "  sin(x", "     ^"],
    );
    assert_shown(
        "x+1)",
        &["this `)` has no matching `(`", "  x+1)", "     ^"],
    );
    let comma = "a comma belongs only between the arguments of a function";
    assert_shown("x, y", &[comma, "  x, y", "   ^"]);
    assert_shown("(x, y)", &[comma, "  (x, y)", "    ^"]);
}

#[test]
fn functions() {
    assert_shown(
        "sin x",
        &["`sin` is a function: write `sin(...)`", "  sin x", "  ^^^"],
    );
    assert_shown(
        "x*sin",
        &[
            "`sin` is a function: write `sin(...)`",
            "  x*sin",
            "    ^^^",
        ],
    );
    assert_shown(
        "1+sin()",
        &["`sin` takes 1 argument, not 0", "  1+sin()", "    ^^^^^"],
    );
    assert_shown(
        "sin(x, y)",
        &[
            "`sin` takes 1 argument, not 2",
            "  sin(x, y)",
            "  ^^^^^^^^^",
        ],
    );
    assert_shown(
        "atan2(x)",
        &[
            "`atan2` takes 2 arguments, not 1",
            "  atan2(x)",
            "  ^^^^^^^^",
        ],
    );
    assert_shown(
        "hypot(x,y,1)",
        &[
            "`hypot` takes 2 arguments, not 3",
            "  hypot(x,y,1)",
            "  ^^^^^^^^^^^^",
        ],
    );
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
        assert_eq!(error(&text).kind, FormulaErrorKind::TooDeep, "{deep}");
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
