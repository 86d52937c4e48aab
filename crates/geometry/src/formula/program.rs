//! A formula, compiled to postfix instructions that are evaluated on a small stack.

use super::Formula;
use super::jet::Number;
use super::operation::{Binary, Unary};

/// Largest number of stack slots of a program. Each operator first evaluates the operand that needs more slots.
/// Therefore n slots are enough for 2ⁿ − 1 operands (Sethi and Ullman 1970). A text of m characters has at most (m +
/// 1)/2 operands, so 13 slots are enough for 10,000 characters.
const SLOTS: usize = 13;
const _: () = assert!(Formula::MAX_CHARACTERS.div_ceil(2) < 1 << SLOTS);

/// Coefficients of a polynomial of at most degree two: of 1, x, y, x², xy and y².
pub(super) type Quadratic = [f64; 6];

/// The result of `operation` with the operand `a`; `None` if the result is not a polynomial of at most degree two.
fn changed(operation: Unary, mut a: Quadratic) -> Option<Quadratic> {
    match operation {
        Unary::Negate => Some(a.map(|term| -term)),
        Unary::Scale(factor) => Some(a.map(|term| term * factor)),
        Unary::DivideBy(divisor) => Some(a.map(|term| term / divisor)),
        Unary::Offset(offset) => {
            a[0] += offset;
            Some(a)
        }
        Unary::Power(2.0) | Unary::AbsPower(2.0) => product(a, a),
        _ => None,
    }
}

/// The result of `operation` with the operands `a` and `b`; `None` if the result is not a polynomial of at most degree
/// two.
fn combined(operation: Binary, a: Quadratic, b: Quadratic) -> Option<Quadratic> {
    let terms = |sum: fn(f64, f64) -> f64| std::array::from_fn(|term| sum(a[term], b[term]));
    match operation {
        Binary::Add => Some(terms(|a, b| a + b)),
        Binary::Subtract => Some(terms(|a, b| a - b)),
        Binary::Multiply => product(a, b),
        _ => None,
    }
}

/// The product of two polynomials of at most degree one; `None` for other polynomials.
fn product(a: Quadratic, b: Quadratic) -> Option<Quadratic> {
    let [a0, ax, ay, a_squares @ ..] = a;
    let [b0, bx, by, b_squares @ ..] = b;
    let is_linear = [a_squares, b_squares] == [[0.0; 3]; 2];
    is_linear.then_some([
        a0 * b0,
        a0 * bx + ax * b0,
        a0 * by + ay * b0,
        ax * bx,
        ax * by + ay * bx,
        ay * by,
    ])
}

/// The polynomial of an instruction without operands.
fn polynomial(leaf: Instruction) -> Quadratic {
    match leaf {
        Instruction::X => [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        Instruction::Y => [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        Instruction::Constant(value) => [value, 0.0, 0.0, 0.0, 0.0, 0.0],
        _ => unreachable!("an instruction with operands"),
    }
}

/// A part of a formula that may be a function of x² + y² alone.
enum Radial {
    Polynomial(Quadratic),
    /// A function of x² + y² alone that is not known to be a polynomial of at most degree two.
    Other,
}

impl Radial {
    fn is_revolved(&self) -> bool {
        match self {
            Self::Polynomial([_, x, y, xx, xy, yy]) => [*x, *y, *xy] == [0.0; 3] && xx == yy,
            Self::Other => true,
        }
    }

    fn changed(operation: Unary, a: Self) -> Option<Self> {
        match a {
            Self::Polynomial(terms) => changed(operation, terms).map(Self::Polynomial),
            Self::Other => None,
        }
        .or_else(|| a.is_revolved().then_some(Self::Other))
    }

    fn combined(operation: Binary, a: Self, b: Self) -> Option<Self> {
        match (&a, &b) {
            (Self::Polynomial(a), Self::Polynomial(b)) => {
                combined(operation, *a, *b).map(Self::Polynomial)
            }
            _ => None,
        }
        .or_else(|| (a.is_revolved() && b.is_revolved()).then_some(Self::Other))
    }
}

/// Parity of a part of a formula with respect to one variable. If the sign of the variable changes, an even part keeps
/// its value, and an odd part changes its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Parity {
    Even,
    Odd,
}

impl Parity {
    /// The parity of the result of `operation`; `None` if it is neither even nor odd.
    fn changed(self, operation: Unary) -> Option<Self> {
        use Unary::{
            Abs, AbsPower, Asin, Atan, Cbrt, Cos, Cosh, DivideBy, Negate, Power, Scale, Sin, Sinh,
            Tan, Tanh,
        };
        match (self, operation) {
            (Self::Even, _) | (_, Abs | AbsPower(_) | Cos | Cosh) => Some(Self::Even),
            (_, Power(exponent)) if exponent % 2.0 == 0.0 => Some(Self::Even),
            (_, Power(exponent)) => (exponent % 2.0).abs().eq(&1.0).then_some(Self::Odd),
            (_, Negate | Scale(_) | DivideBy(_) | Sin | Tan | Asin | Atan | Sinh | Tanh | Cbrt) => {
                Some(Self::Odd)
            }
            _ => None,
        }
    }

    fn combined(self, operation: Binary, other: Self) -> Option<Self> {
        match operation {
            Binary::Hypot => Some(Self::Even),
            Binary::Multiply | Binary::Divide if self != other => Some(Self::Odd),
            Binary::Multiply | Binary::Divide => Some(Self::Even),
            Binary::Add | Binary::Subtract => (self == other).then_some(self),
            Binary::Power | Binary::Atan2 => {
                (self == Self::Even && other == Self::Even).then_some(Self::Even)
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Instruction {
    X,
    Y,
    Constant(f64),
    Unary(Unary),
    Binary(Binary),
    Swap,
}

/// Postfix instructions of a formula. After the last one, the stack contains only the value of the formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Program {
    instructions: Vec<Instruction>,
    slots: usize,
}

impl Program {
    fn leaf(instruction: Instruction) -> Self {
        Self {
            instructions: vec![instruction],
            slots: 1,
        }
    }

    fn unary(mut self, operation: Unary) -> Self {
        self.instructions.push(Instruction::Unary(operation));
        self
    }

    fn power(mut self, exponent: f64) -> Self {
        let is_abs = self.instructions.last() == Some(&Instruction::Unary(Unary::Abs));
        if is_abs && exponent >= 2.0 {
            self.instructions.pop();
            return self.unary(Unary::AbsPower(exponent));
        }
        self.unary(Unary::Power(exponent))
    }

    fn binary(self, operation: Binary, right: Self) -> Self {
        let swapped = right.slots > self.slots;
        let (mut first, second) = if swapped {
            (right, self)
        } else {
            (self, right)
        };
        first.slots = first.slots.max(second.slots + 1);
        first.instructions.extend(second.instructions);
        if swapped && !operation.commutes() {
            first.instructions.push(Instruction::Swap);
        }
        first.instructions.push(Instruction::Binary(operation));
        first
    }

    /// The polynomial of at most degree two that the program computes. `None` if any intermediate result has another
    /// form; the final result may still be such a polynomial.
    pub(super) fn quadratic(&self) -> Option<Quadratic> {
        self.walk(polynomial, changed, combined)
    }

    /// Whether the program is recognised as a surface of revolution: x and y occur only in parts that are functions of
    /// x² + y². `false` does not exclude a surface of revolution in another form.
    pub(super) fn is_revolved(&self) -> bool {
        let known = self.walk(
            |leaf| Radial::Polynomial(polynomial(leaf)),
            Radial::changed,
            Radial::combined,
        );
        known.is_some_and(|whole| whole.is_revolved())
    }

    /// Whether the program computes a function that is even in x and even in y, by the parities of its parts.
    pub(super) fn is_even(&self) -> bool {
        let parity = |leaf| match leaf {
            Instruction::X => [Parity::Odd, Parity::Even],
            Instruction::Y => [Parity::Even, Parity::Odd],
            _ => [Parity::Even; 2],
        };
        let known = self.walk(
            parity,
            |operation, [x, y]| Some([x.changed(operation)?, y.changed(operation)?]),
            |operation, [ax, ay], [bx, by]| {
                Some([ax.combined(operation, bx)?, ay.combined(operation, by)?])
            },
        );
        known == Some([Parity::Even; 2])
    }

    /// Computes a property of the whole program, instruction by instruction. `leaf` returns the property of a variable
    /// or constant; `changed` and `combined` compute the property of an operation from the properties of its operands.
    /// `None` if one of them returns `None`.
    fn walk<T>(
        &self,
        leaf: impl Fn(Instruction) -> T,
        changed: impl Fn(Unary, T) -> Option<T>,
        combined: impl Fn(Binary, T, T) -> Option<T>,
    ) -> Option<T> {
        let mut stack: Vec<T> = Vec::new();
        for instruction in &self.instructions {
            let next = match *instruction {
                Instruction::Unary(operation) => changed(operation, stack.pop()?)?,
                Instruction::Binary(operation) => {
                    let right = stack.pop()?;
                    combined(operation, stack.pop()?, right)?
                }
                Instruction::Swap => {
                    let top = stack.pop()?;
                    let below = stack.pop()?;
                    stack.push(top);
                    below
                }
                other => leaf(other),
            };
            stack.push(next);
        }
        stack.pop()
    }

    pub(super) fn run<N: Number>(&self, x: N, y: N) -> N {
        // Most formulas need at most four slots of the stack. They are treated separately, because initialising all
        // slots would take as much time as the arithmetic.
        if self.slots <= 4 {
            self.run_in::<N, 4>(x, y)
        } else {
            self.run_in::<N, SLOTS>(x, y)
        }
    }

    /// Evaluates the program on a stack with `SIZE` slots. The top of the stack is a local variable, so that it can
    /// stay in a register. Therefore the first push stores a dummy value, which is never read.
    fn run_in<N: Number, const SIZE: usize>(&self, x: N, y: N) -> N {
        let mut below = [x; SIZE];
        let mut depth = 0;
        let mut top = x;
        for instruction in &self.instructions {
            match *instruction {
                Instruction::X => {
                    below[depth] = top;
                    depth += 1;
                    top = x;
                }
                Instruction::Y => {
                    below[depth] = top;
                    depth += 1;
                    top = y;
                }
                Instruction::Constant(value) => {
                    below[depth] = top;
                    depth += 1;
                    top = N::constant(value);
                }
                Instruction::Unary(operation) => top = operation.apply(top),
                Instruction::Binary(operation) => {
                    depth -= 1;
                    top = operation.apply(below[depth], top);
                }
                Instruction::Swap => std::mem::swap(&mut below[depth - 1], &mut top),
            }
        }
        top
    }
}

/// A part of a formula during parsing. A part that does not depend on x or y is already evaluated.
#[derive(Debug)]
pub(super) enum Expression {
    Constant(f64),
    Varying(Program),
}

impl Expression {
    pub(super) fn x() -> Self {
        Self::Varying(Program::leaf(Instruction::X))
    }

    pub(super) fn y() -> Self {
        Self::Varying(Program::leaf(Instruction::Y))
    }

    pub(super) fn unary(self, operation: Unary) -> Self {
        match self {
            Self::Constant(a) => Self::Constant(operation.apply(a)),
            Self::Varying(a) => Self::Varying(a.unary(operation)),
        }
    }

    pub(super) fn binary(self, operation: Binary, right: Self) -> Self {
        use Expression::{Constant, Varying};
        match (operation, self, right) {
            (_, Constant(a), Constant(b)) => Constant(operation.apply(a, b)),
            (Binary::Add, Varying(a), Constant(c)) | (Binary::Add, Constant(c), Varying(a)) => {
                Varying(a.unary(Unary::Offset(c)))
            }
            (Binary::Subtract, Varying(a), Constant(c)) => Varying(a.unary(Unary::Offset(-c))),
            (Binary::Subtract, Constant(c), Varying(a)) => {
                Varying(a.unary(Unary::Negate).unary(Unary::Offset(c)))
            }
            (Binary::Multiply, Varying(a), Constant(c))
            | (Binary::Multiply, Constant(c), Varying(a)) => Varying(a.unary(Unary::Scale(c))),
            (Binary::Divide, Varying(a), Constant(c)) => Varying(a.unary(Unary::DivideBy(c))),
            (Binary::Power, Varying(a), Constant(c)) => Varying(a.power(c)),
            (Binary::Power, Constant(c), Varying(a)) if c > 0.0 => {
                Varying(a.unary(Unary::Exponential(c)))
            }
            (_, left, right) => {
                Varying(left.into_program().binary(operation, right.into_program()))
            }
        }
    }

    pub(super) fn into_program(self) -> Program {
        match self {
            Self::Constant(value) => Program::leaf(Instruction::Constant(value)),
            Self::Varying(program) => program,
        }
    }
}
