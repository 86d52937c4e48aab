use proptest::prelude::*;

use super::*;

#[derive(Clone, Debug)]
enum Tree {
    Leaf(&'static str),
    Sign(Box<Tree>),
    Operator(char, Box<Tree>, Box<Tree>),
}

impl Tree {
    /// Value of an expression without `^`. The operations are the same as in the formula, so the rounding errors are
    /// equal.
    fn value(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Leaf("x") => x,
            Self::Leaf("y") => y,
            Self::Leaf(number) => number.parse().unwrap(),
            Self::Sign(a) => -a.value(x, y),
            Self::Operator(operator, a, b) => {
                let (a, b) = (a.value(x, y), b.value(x, y));
                match operator {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => panic!("the rounding of {operator} depends on the platform"),
                }
            }
        }
    }

    /// The expression as text, with parentheses around every part.
    fn explicit(&self) -> String {
        match self {
            Self::Leaf(text) => (*text).into(),
            Self::Sign(a) => format!("(-{})", a.explicit()),
            Self::Operator(operator, a, b) => {
                format!("({}{operator}{})", a.explicit(), b.explicit())
            }
        }
    }

    /// The expression as text with only the parentheses that it needs.
    fn sparse(&self) -> String {
        let at = |tree: &Self, level| match tree.sparse() {
            text if tree.level() < level => format!("({text})"),
            text => text,
        };
        match self {
            Self::Leaf(text) => (*text).into(),
            Self::Sign(a) => format!("-{}", at(a, 3)),
            Self::Operator('^', a, b) => format!("{}^{}", at(a, 5), at(b, 3)),
            Self::Operator(operator, a, b) => {
                let level = self.level();
                format!("{} {operator} {}", at(a, level), at(b, level + 1))
            }
        }
    }

    /// Precedence of the operator that is applied last in the expression.
    fn level(&self) -> u8 {
        match self {
            Self::Operator('+' | '-', ..) => 1,
            Self::Operator('*' | '/', ..) => 2,
            Self::Sign(_) => 3,
            Self::Operator(..) => 4,
            Self::Leaf(_) => 5,
        }
    }
}

fn tree(operators: &'static [char]) -> impl Strategy<Value = Tree> {
    let leaf = prop::sample::select(&["x", "y", "2", "0.5"][..]).prop_map(Tree::Leaf);
    leaf.prop_recursive(8, 60, 2, move |inner| {
        let operator = prop::sample::select(operators);
        prop_oneof![
            1 => inner.clone().prop_map(|a| Tree::Sign(a.into())),
            4 => (operator, inner.clone(), inner)
                .prop_map(|(operator, a, b)| Tree::Operator(operator, a.into(), b.into())),
        ]
    })
}

proptest! {
    #[test]
    fn parentheses_may_be_left_out(tree in tree(&['+', '-', '*', '/', '^'])) {
        let parse = |text: &str| Formula::parse(text, &BTreeMap::new()).map_err(|error| {
            assert!(error.message.ends_with("not finite"), "{error}");
        });
        prop_assert_eq!(parse(&tree.sparse()), parse(&tree.explicit()));
    }

    #[test]
    fn values_are_exact(tree in tree(&['+', '-', '*', '/']), x in -2.0..2.0_f64, y in -2.0..2.0_f64) {
        let expected = tree.value(x, y);
        let Ok(formula) = Formula::parse(&tree.explicit(), &BTreeMap::new()) else {
            return Ok(()); // a constant part of the expression is not finite, as in 1/(2 - 2)
        };
        let found = formula.value(x, y);
        prop_assert!(found == expected || !(found.is_finite() || expected.is_finite()));
        let jet = formula.jet(x, y);
        prop_assert!(jet.value == found || (jet.value.is_nan() && found.is_nan()));
    }

    #[test]
    fn never_panics(text in any::<String>()) {
        survives(&text);
    }

    #[test]
    fn never_panics_on_near_formulas(words in prop::collection::vec(
        prop::sample::select(vec![
            "x", "y", "pi", "k", "kk", "sin", "atan2", "hypot", "abs", "(", ")", "(", ")", ",",
            "+", "-", "*", "/", "^", "1", ".5", "1e", "1e-3", ".", " ", "é", "√", "\t", "_",
        ]),
        0..40,
    )) {
        survives(&words.concat());
    }
}

fn survives(text: &str) {
    match Formula::parse(text, &parameters(&[("k", 2.0)])) {
        Ok(formula) => {
            formula.jet(0.3, -0.7);
        }
        Err(error) => {
            let shown = error.to_string();
            let lines: Vec<&str> = shown.split('\n').collect();
            match error.span {
                None => assert_eq!(lines.len(), 1, "{shown}"),
                Some(span) => {
                    assert!(text.get(span).is_some());
                    assert_eq!(lines.len(), 3, "{shown}");
                    let marks = lines[2].trim_start();
                    assert!(
                        !marks.is_empty() && marks.chars().all(|c| c == '^'),
                        "{shown}"
                    );
                    let [width, marks] = [lines[1], lines[2]].map(|line| line.chars().count());
                    assert!(marks <= width + 1, "{shown}");
                }
            }
        }
    }
}
