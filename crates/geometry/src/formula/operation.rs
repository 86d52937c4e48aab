//! The operations of a formula, each with its first two derivatives.

use std::f64::consts::LN_10;

use super::jet::{Jet, Number};

/// An operation on one operand a. Operations with two operands also belong here if one of them is a constant c, which
/// the variant stores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unary {
    Negate,
    Offset(f64),
    Scale(f64),
    DivideBy(f64),
    Power(f64),
    /// The power |a|^c with a constant c >= 2. It is twice differentiable even at a = 0, although |a| is not.
    AbsPower(f64),
    /// The power c^a of a constant c > 0.
    Exponential(f64),
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Log10,
    Sqrt,
    Cbrt,
    Abs,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Atan2,
    Hypot,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Function {
    Unary(Unary),
    Binary(Binary),
}

/// All functions that a formula may call, by name.
pub(super) const FUNCTIONS: [(&str, Function); 17] = [
    ("sin", Function::Unary(Unary::Sin)),
    ("cos", Function::Unary(Unary::Cos)),
    ("tan", Function::Unary(Unary::Tan)),
    ("asin", Function::Unary(Unary::Asin)),
    ("acos", Function::Unary(Unary::Acos)),
    ("atan", Function::Unary(Unary::Atan)),
    ("sinh", Function::Unary(Unary::Sinh)),
    ("cosh", Function::Unary(Unary::Cosh)),
    ("tanh", Function::Unary(Unary::Tanh)),
    ("exp", Function::Unary(Unary::Exp)),
    ("ln", Function::Unary(Unary::Ln)),
    ("log10", Function::Unary(Unary::Log10)),
    ("sqrt", Function::Unary(Unary::Sqrt)),
    ("cbrt", Function::Unary(Unary::Cbrt)),
    ("abs", Function::Unary(Unary::Abs)),
    ("atan2", Function::Binary(Binary::Atan2)),
    ("hypot", Function::Binary(Binary::Hypot)),
];

impl Function {
    pub(super) fn named(name: &str) -> Option<Self> {
        FUNCTIONS
            .iter()
            .find(|(known, _)| *known == name)
            .map(|&(_, function)| function)
    }
}

impl Unary {
    #[inline(always)]
    pub(super) fn apply<N: Number>(self, a: N) -> N {
        match self {
            Self::Negate => -a,
            Self::Offset(c) => a + c,
            Self::Scale(c) => a * c,
            Self::DivideBy(c) => a / c,
            Self::Power(n) => a.compose(|v| power(v, n)),
            Self::AbsPower(n) => a.compose(|v| {
                let [value, first, second] = power(v.abs(), n);
                [value, first * v.signum(), second]
            }),
            Self::Exponential(base) => a.compose(|v| {
                let (f, ln) = (libm::pow(base, v), libm::log(base));
                [f, f * ln, f * ln * ln]
            }),
            Self::Sin => a.compose(|v| {
                let (sin, cos) = libm::sincos(v);
                [sin, cos, -sin]
            }),
            Self::Cos => a.compose(|v| {
                let (sin, cos) = libm::sincos(v);
                [cos, -sin, -cos]
            }),
            Self::Tan => a.compose(|v| {
                let tan = libm::tan(v);
                let first = 1.0 + tan * tan;
                [tan, first, 2.0 * tan * first]
            }),
            Self::Asin => a.compose(|v| {
                let [first, second] = asin_derivatives(v);
                [libm::asin(v), first, second]
            }),
            Self::Acos => a.compose(|v| {
                let [first, second] = asin_derivatives(v);
                [libm::acos(v), -first, -second]
            }),
            Self::Atan => a.compose(|v| {
                let first = 1.0 / (1.0 + v * v);
                [libm::atan(v), first, -2.0 * v * first * first]
            }),
            Self::Sinh => a.compose(|v| {
                let (sinh, cosh) = (libm::sinh(v), libm::cosh(v));
                [sinh, cosh, sinh]
            }),
            Self::Cosh => a.compose(|v| {
                let (sinh, cosh) = (libm::sinh(v), libm::cosh(v));
                [cosh, sinh, cosh]
            }),
            Self::Tanh => a.compose(|v| {
                let (tanh, sech) = (libm::tanh(v), libm::cosh(v).recip());
                [tanh, sech * sech, -2.0 * tanh * sech * sech]
            }),
            Self::Exp => a.compose(|v| [libm::exp(v); 3]),
            Self::Ln => a.compose(|v| [libm::log(v), 1.0 / v, -1.0 / v / v]),
            Self::Log10 => {
                a.compose(|v| [libm::log10(v), 1.0 / (LN_10 * v), -1.0 / (LN_10 * v) / v])
            }
            Self::Sqrt => a.compose(|v| {
                let root = v.sqrt();
                [root, 0.5 / root, -0.25 / root / v]
            }),
            Self::Cbrt => a.compose(|v| {
                let root = libm::cbrt(v);
                let first = 1.0 / (3.0 * root * root);
                [root, first, -2.0 / 3.0 * first / v]
            }),
            Self::Abs => a.compose(|v| match v {
                0.0 => [0.0, f64::NAN, f64::NAN],
                _ => [v.abs(), v.signum(), 0.0],
            }),
        }
    }
}

impl Binary {
    pub(super) fn commutes(self) -> bool {
        matches!(self, Self::Add | Self::Multiply | Self::Hypot)
    }

    #[inline(always)]
    pub(super) fn apply<N: Number>(self, a: N, b: N) -> N {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => a.compose2(b, general_power),
            Self::Atan2 => a.compose2(b, atan2),
            Self::Hypot => a.compose2(b, hypot),
        }
    }
}

/// The power v^n and its first two derivatives with respect to v. The results are also correct for v ≤ 0, if they exist
/// there.
fn power(v: f64, n: f64) -> [f64; 3] {
    let raise = |exponent: f64| {
        if exponent.fract() == 0.0 && exponent.abs() <= 16.0 {
            let product = (0..exponent.abs() as u32).fold(1.0, |product, _| product * v);
            if exponent < 0.0 {
                1.0 / product
            } else {
                product
            }
        } else {
            libm::pow(v, exponent)
        }
    };
    if n == 0.0 {
        [1.0, 0.0, 0.0]
    } else if n == 1.0 {
        [v, 1.0, 0.0]
    } else if n >= 2.0 {
        let p = raise(n - 2.0);
        [p * v * v, n * p * v, n * (n - 1.0) * p]
    } else {
        let p = raise(n);
        [p, n * p / v, n * (n - 1.0) * p / v / v]
    }
}

/// The power a^b and its derivatives with respect to a and b. The power is differentiable only for a > 0.
fn general_power(a: f64, b: f64) -> Jet {
    let (f, ln) = (libm::pow(a, b), libm::log(a));
    Jet {
        value: f,
        gradient: [b * f / a, f * ln],
        hessian: [
            b * (b - 1.0) * f / a / a,
            f * (1.0 + b * ln) / a,
            f * ln * ln,
        ],
    }
}

fn asin_derivatives(v: f64) -> [f64; 2] {
    let square = (1.0 - v) * (1.0 + v);
    let first = 1.0 / square.sqrt();
    [first, v * first / square]
}

fn atan2(a: f64, b: f64) -> Jet {
    let r = libm::hypot(a, b);
    let (sin, cos) = (a / r, b / r);
    let second = 2.0 * sin * cos / r / r;
    Jet {
        value: libm::atan2(a, b),
        gradient: [cos / r, -sin / r],
        hessian: [-second, (sin - cos) * (sin + cos) / r / r, second],
    }
}

fn hypot(a: f64, b: f64) -> Jet {
    let r = libm::hypot(a, b);
    let (sin, cos) = (b / r, a / r);
    Jet {
        value: r,
        gradient: [cos, sin],
        hessian: [sin * sin / r, -sin * cos / r, cos * cos / r],
    }
}
