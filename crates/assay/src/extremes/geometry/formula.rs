//! Formulas where their values are tiny, huge, or nearly lost.

use std::collections::BTreeMap;

use palpate_geometry::formula::{Formula, FormulaError, Jet};

use super::super::precise::Precise;
use super::super::{Answer, Case, Outcome};

/// A function of one variable in higher precision.
type Closed = fn(Precise) -> Precise;

/// A formula of x, its value and first derivative, and the condition number of both, where they do
/// not follow x alone.
struct Known {
    text: &'static str,
    value: Closed,
    slope: Closed,
    places: &'static [f64],
}

const TINY_TO_HUGE: &[f64] = &[1e-300, 1e-100, 1e-9, 1.0, 1e9, 1e100];

const KNOWN: [Known; 8] = [
    Known {
        text: "sqrt(x)",
        value: |x| x.sqrt(),
        slope: |x| Precise::new(0.5) / x.sqrt(),
        places: TINY_TO_HUGE,
    },
    Known {
        text: "atan(x)",
        value: |x| x.atan(),
        slope: |x| Precise::new(1.0) / (x.squared() + 1.0),
        places: TINY_TO_HUGE,
    },
    Known {
        text: "ln(x)",
        value: |x| x.ln(),
        slope: |x| Precise::new(1.0) / x,
        places: &[f64::MIN_POSITIVE, 1e-100, 0.7, 1e9, 1e300],
    },
    Known {
        text: "1/(1 + x^2)",
        value: |x| Precise::new(1.0) / (x.squared() + 1.0),
        slope: |x| &x * -2.0 / (x.squared() + 1.0).squared(),
        places: &[1e-100, 1e-9, 1.0, 1e9, 1e70],
    },
    Known {
        text: "tanh(x)",
        value: |x| {
            let square = (x * 2.0).exp();
            (&square - 1.0) / (square + 1.0)
        },
        slope: |x| {
            let square = (x * 2.0).exp();
            &square * 4.0 / (&square + 1.0).squared()
        },
        places: &[1e-3, 0.3, 5.0, 300.0],
    },
    Known {
        text: "x^0.3",
        value: |x| x.powf(&Precise::new(0.3)),
        slope: |x| x.powf(&Precise::new(0.3)) / x * 0.3,
        places: &[1e-300, 1e-9, 1.0, 1e9, 1e300],
    },
    Known {
        text: "hypot(x, 3e200)",
        value: |x| (x.squared() + Precise::new(3e200).squared()).sqrt(),
        slope: |x| &x / (x.squared() + Precise::new(3e200).squared()).sqrt(),
        places: &[1e180, 4e200, 1e300],
    },
    Known {
        text: "x^3/1e200",
        value: |x| &x * &x * &x / 1e200,
        slope: |x| x.squared() * 3.0 / 1e200,
        places: &[1e-20, 1.0, 1e100],
    },
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for Known {
        text,
        value,
        slope,
        places,
    } in KNOWN
    {
        for &x in places {
            cases.push(Case::new(
                "geometry::Formula::jet",
                format!("{text} at x = {x:e}"),
                move || {
                    let jet = read(text).jet(x, 0.3);
                    let pairs = [
                        (jet.value, value(Precise::new(x)).to_f64()),
                        (jet.gradient[0], slope(Precise::new(x)).to_f64()),
                    ];
                    told(jet, Answer::all_near(pairs).within(1e-15))
                },
            ));
        }
    }
    cases.extend(waves());
    cases.extend(rims());
    cases.extend(refused());
    cases
}

/// The sine of x is as well known as x is: condition x.
fn waves() -> impl Iterator<Item = Case> {
    [1e-300, 1e-9, 1.0, 1e6, 1e12].into_iter().map(|x| {
        let input = format!("sin(3*x) at x = {x:e}");
        Case::new("geometry::Formula::jet", input, move || -> Outcome {
            let jet = read("sin(3*x)").jet(x, 0.0);
            let angle = Precise::new(x) * 3.0;
            let pairs = [
                (jet.value, angle.sin().to_f64()),
                (jet.gradient[0], 3.0 * angle.cos().to_f64()),
            ];
            let answer = Answer::all_near(pairs).within(1e-15);
            told(jet, answer.conditioned(3.0 * x.max(1.0)))
        })
    })
}

/// Near the rim of a dome the height is a root of a small difference: condition 1/(1 − r²).
fn rims() -> impl Iterator<Item = Case> {
    [1e-3, 1e-8, 1e-14].into_iter().map(|short| {
        let input = format!("sqrt(1 - x^2 - y^2), {short:e} from the rim");
        Case::new("geometry::Formula::jet", input, move || -> Outcome {
            let (x, y) = ((1.0 - short) * 0.6, (1.0 - short) * 0.8);
            let jet = read("sqrt(1 - x^2 - y^2)").jet(x, y);
            let rest = Precise::new(1.0) - Precise::new(x).squared() - Precise::new(y).squared();
            let height = rest.sqrt();
            let pairs = [
                (jet.value, height.to_f64()),
                (jet.gradient[0], (Precise::new(-x) / &height).to_f64()),
            ];
            let answer = Answer::all_near(pairs).within(1e-15);
            told(jet, answer.conditioned(1.0 / rest.to_f64()).or_no_digits())
        })
    })
}

/// Texts that are not formulas, or whose value is not finite; each must be refused.
fn refused() -> impl Iterator<Item = Case> {
    let deep = "(".repeat(1000) + "x" + &")".repeat(1000);
    let long = "x+".repeat(10_000) + "x";
    let texts = [
        ("nothing", String::new()),
        ("nested 1000 deep", deep),
        ("20001 characters", long),
        ("1e999", "1e999*x".to_owned()),
        ("1/0", "x + 1/0".to_owned()),
        ("0/0", "0/0".to_owned()),
        ("signs 1000 deep", "-".repeat(1000) + "x"),
        ("powers 1000 deep", "x^".repeat(1000) + "x"),
        ("a null", "x\0y".to_owned()),
    ];
    let parse = |text: &str, parameters: &[(&str, f64)]| {
        let named = parameters
            .iter()
            .map(|&(name, value)| (name.to_owned(), value));
        Formula::parse(text, &named.collect::<BTreeMap<_, _>>()).map_err(|error| error.kind)
    };
    let texts = texts.into_iter().map(move |(input, text)| {
        Case::refusal("geometry::Formula::parse", input, move || parse(&text, &[]))
    });
    let parameters = [f64::NAN, f64::INFINITY].into_iter().map(move |bad| {
        let input = format!("a parameter of {bad:e}");
        Case::refusal("geometry::Formula::parse", input, move || {
            parse("k*x", &[("k", bad)])
        })
    });
    texts.chain(parameters)
}

/// A jet whose derivatives leave the range of numbers says so.
fn told(jet: Jet, answer: Answer) -> Outcome {
    if jet.is_finite() {
        answer.also(jet.hessian).also(jet.gradient).into()
    } else {
        Outcome::Refused("jet-not-finite".to_owned())
    }
}

fn read(text: &str) -> Formula {
    let read: Result<Formula, FormulaError> = Formula::parse(text, &BTreeMap::new());
    read.expect("a formula")
}
