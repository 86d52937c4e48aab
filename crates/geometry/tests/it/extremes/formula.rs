//! Formulas where their values are tiny, huge, or nearly lost.

use palpate_geometry::formula::{Formula, FormulaErrorKind, Jet};
use palpate_verdict::{Answer, Precise, rows};

const JET: &str = "geometry::Formula::jet";
const PARSE: &str = "geometry::Formula::parse";

rows! {
    JET, "sqrt(x) at x = {x:e}" => known("sqrt(x)", x, |x| x.sqrt(), |x| 0.5 / x.sqrt()),
        for x in [1e-100, 1e-9, 1.0, 1e9, 1e100];
    JET, "atan(x) at x = {x:e}" => known("atan(x)", x, |x| x.atan(), |x| 1.0 / (x.squared() + 1.0)),
        for x in [1e-300, 1e-100, 1e-9, 1.0, 1e9, 1e100];
    JET, "ln(x) at x = {x:e}" => known("ln(x)", x, |x| x.ln(), |x| 1.0 / x), for x in [1e-100, 0.7, 1e9, 1e300];
    JET, "1/(1 + x^2) at x = {x:e}" =>
        known("1/(1 + x^2)", x, |x| 1.0 / (x.squared() + 1.0), |x| &x * -2.0 / (x.squared() + 1.0).squared()),
        for x in [1e-100, 1e-9, 1.0, 1e9, 1e70];
    JET, "tanh(x) at x = {x:e}" =>
        known("tanh(x)", x, |x| 1.0 - 2.0 / (e2(&x) + 1.0), |x| 4.0 * e2(&x) / (e2(&x) + 1.0).squared()),
        for x in [1e-3, 0.3, 5.0, 300.0];
    JET, "x^0.3 at x = {x:e}" =>
        known("x^0.3", x, |x| x.powf(&Precise::new(0.3)), |x| x.powf(&Precise::new(0.3)) / x * 0.3),
        for x in [1e-9, 1.0, 1e9, 1e300];
    JET, "hypot(x, 3e200) at x = {x:e}" => known("hypot(x, 3e200)", x, hypot, |x| &x / hypot(x.clone())),
        for x in [1e180, 4e200, 1e300];
    JET, "x^3/1e200 at x = {x:e}" => known("x^3/1e200", x, |x| &x * &x * &x / 1e200, |x| x.squared() * 3.0 / 1e200),
        for x in [1e-20, 1.0, 1e100];
    // Its second derivative leaves the range of numbers.
    JET, "{text} at x = {x:e}", "jet-not-finite" => told(&read(text).jet(x, 0.3)),
        for (text, x) in [("sqrt(x)", 1e-300), ("ln(x)", f64::MIN_POSITIVE), ("x^0.3", 1e-300)];
    JET, "sin(3*x) at x = {x:e}" => wave(x), for x in [1e-300, 1e-9, 1.0, 1e6, 1e12];
    JET, "sqrt(1 - x^2 - y^2), {short:e} from the rim" => rim(short), for short in [1e-3, 1e-8, 1e-14];
    PARSE, "nothing", "empty" => parse("", &[]);
    PARSE, "20001 characters", "too-long" => parse(&("x+".repeat(10_000) + "x"), &[]);
    PARSE, "nested 1000 deep", "too-deep" => parse(&("(".repeat(1000) + "x" + &")".repeat(1000)), &[]);
    PARSE, "{sign} 1000 times", "too-deep" => parse(&(sign.repeat(1000) + "x"), &[]), for sign in ["-", "x^"];
    PARSE, "{text}", "not-finite" => parse(text, &[]), for text in ["1e999*x", "x + 1/0", "0/0"];
    PARSE, "a null", "unexpected-character" => parse("x\0y", &[]);
    PARSE, "a parameter of {bad:e}", "parameter-not-finite" => parse("k*x", &[("k", bad)]),
        for bad in [f64::NAN, f64::INFINITY];
}

/// `exp(2x)`.
fn e2(x: &Precise) -> Precise {
    (x * 2.0).exp()
}

fn hypot(x: Precise) -> Precise {
    (x.squared() + Precise::new(3e200).squared()).sqrt()
}

/// Value and slope of a formula of x, which are as well known as x.
fn known(
    text: &str,
    x: f64,
    value: impl Fn(Precise) -> Precise,
    slope: impl Fn(Precise) -> Precise,
) -> Result<Answer, &'static str> {
    let jet = read(text).jet(x, 0.3);
    told(&jet)?;
    let pairs = [
        (jet.value, value(x.into()).to_f64()),
        (jet.gradient[0], slope(x.into()).to_f64()),
    ];
    Ok(all(&jet, Answer::all_near(pairs).within(1e-15)))
}

/// The sine of x is as well known as x is: condition x.
fn wave(x: f64) -> Result<Answer, &'static str> {
    let answer = known(
        "sin(3*x)",
        x,
        |x| (x * 3.0).sin(),
        |x| 3.0 * (x * 3.0).cos(),
    )?;
    Ok(answer.conditioned(3.0 * x.max(1.0)))
}

/// Near the rim of a dome the height is a root of a small difference: condition 1/(1 − r²).
fn rim(short: f64) -> Answer {
    let (x, y) = ((1.0 - short) * 0.6, (1.0 - short) * 0.8);
    let jet = read("sqrt(1 - x^2 - y^2)").jet(x, y);
    let rest = 1.0 - Precise::new(x).squared() - Precise::new(y).squared();
    let height = rest.sqrt();
    let pairs = [
        (jet.value, height.to_f64()),
        (jet.gradient[0], (-x / height).to_f64()),
    ];
    let answer = all(&jet, Answer::all_near(pairs).within(1e-15));
    answer.conditioned(1.0 / rest.to_f64()).or_no_digits()
}

fn parse(text: &str, parameters: &[(&str, f64)]) -> Result<Formula, FormulaErrorKind> {
    let named = (parameters.iter()).map(|&(name, value)| (name.to_owned(), value));
    Formula::parse(text, &named.collect()).map_err(|error| error.kind)
}

fn read(text: &str) -> Formula {
    parse(text, &[]).unwrap()
}

/// A jet whose derivatives leave the range of numbers says so.
fn told(jet: &Jet) -> Result<(), &'static str> {
    jet.is_finite().then_some(()).ok_or("jet-not-finite")
}

fn all(jet: &Jet, answer: Answer) -> Answer {
    answer.also(jet.hessian).also(jet.gradient)
}
