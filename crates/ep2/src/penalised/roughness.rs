//! The penalty on third derivatives.

use nalgebra::DMatrix;

use crate::Knots;

/// Nodes and weights of Gauss's rule with four nodes on [−1, 1], exact to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// The matrix P with cᵀPc = ∬ w_aaa² + 3 w_aab² + 3 w_abb² + w_bbb² over the square, for a spline
/// of coefficients c. The integral does not change as the axes turn.
pub(super) fn of(knots: &[Knots; 2]) -> DMatrix<f64> {
    let grams: [[DMatrix<f64>; 4]; 2] = knots
        .each_ref()
        .map(|knots| std::array::from_fn(|order| gram(knots, order)));
    let coefficients = knots[0].functions() * knots[1].functions();
    let mut penalty = DMatrix::zeros(coefficients, coefficients);
    for (order, count) in [(3, 1.0), (2, 3.0), (1, 3.0), (0, 1.0)] {
        penalty += grams[0][order].kronecker(&grams[1][3 - order]) * count;
    }
    penalty
}

/// ∫ B_i⁽ᵐ⁾ B_j⁽ᵐ⁾ for derivatives of one order of the B-splines.
fn gram(knots: &Knots, order: usize) -> DMatrix<f64> {
    let mut result = DMatrix::zeros(knots.functions(), knots.functions());
    let mut ends = vec![knots.domain().0];
    ends.extend_from_slice(knots.interior());
    ends.push(knots.domain().1);
    for (first, pair) in ends.windows(2).enumerate() {
        let half = 0.5 * (pair[1] - pair[0]);
        for (node, weight) in GAUSS {
            let x = pair[0] + half * (1.0 + node);
            let basis = knots.derivatives::<4>(first, x)[order];
            for (i, one) in basis[..=knots.degree()].iter().enumerate() {
                for (j, other) in basis[..=knots.degree()].iter().enumerate() {
                    result[(first + i, first + j)] += half * weight * one * other;
                }
            }
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::DVector;

    #[test]
    fn third_derivatives_are_penalised_and_quadrics_are_not() {
        let knots = [3, 5].map(|intervals| Knots::uniform(3, -1.0, 1.0, intervals));
        // Blossoms: mean products of one, two and three different inner knots.
        let powers = |knots: &Knots, function: usize| {
            let t = &knots.as_slice()[function + 1..function + 4];
            [
                1.0,
                (t[0] + t[1] + t[2]) / 3.0,
                (t[0] * t[1] + t[0] * t[2] + t[1] * t[2]) / 3.0,
                t[0] * t[1] * t[2],
            ]
        };
        let penalty = |power_a: usize, power_b: usize| {
            let [a, b] = &knots;
            let width = b.functions();
            let coefficients = DVector::from_fn(a.functions() * width, |index, _| {
                powers(a, index / width)[power_a] * powers(b, index % width)[power_b]
            });
            coefficients.dot(&(of(&knots) * &coefficients))
        };
        for (power_a, power_b) in [(0, 0), (1, 0), (0, 2), (1, 1), (2, 0)] {
            assert_relative_eq!(penalty(power_a, power_b), 0.0, epsilon = 1e-10);
        }
        // a³: 6² over an area of 4. a²b: 3 · 2² · 4.
        assert_relative_eq!(penalty(3, 0), 144.0, max_relative = 1e-12);
        assert_relative_eq!(penalty(2, 1), 48.0, max_relative = 1e-12);
        assert_relative_eq!(penalty(1, 2), 48.0, max_relative = 1e-12);
    }
}
