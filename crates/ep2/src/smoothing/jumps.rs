//! Jumps of the highest derivative of a spline at its knots.

use crate::Knots;
use crate::knots::MAX_DEGREE;

/// Jumps of the `degree + 2` B-splines that a knot cuts; the rest is 0.
pub(super) type Jumps = [f64; MAX_DEGREE + 2];

/// Per interior knot the jumps of the derivative of order `degree`, of the B-splines from the
/// knot's own index.
///
/// A B-spline is a divided difference of a truncated power, so at its knot `t` it jumps by a fixed
/// multiple of `(t_last − t_first) / Π (t − t_other)`. Lengths are counted in mean intervals,
/// which leaves the numbers without units.
pub(super) fn of(knots: &Knots) -> Vec<Jumps> {
    let degree = knots.degree();
    let (start, end) = knots.domain();
    let intervals = knots.interior().len() + 1;
    let mean_interval = (end - start) / intervals as f64;
    let all = knots.as_slice();
    let jumps_at = |interior: usize| {
        let place = interior + degree + 1;
        let mut jumps = [0.0; MAX_DEGREE + 2];
        for (offset, jump) in jumps[..degree + 2].iter_mut().enumerate() {
            let first = interior + offset;
            let own = &all[first..=first + degree + 1];
            let product: f64 = (first..)
                .zip(own)
                .filter(|(index, _)| *index != place)
                .map(|(_, other)| (all[place] - other) / mean_interval)
                .product();
            *jump = (own[degree + 1] - own[0]) / mean_interval / product;
        }
        jumps
    };
    (0..intervals - 1).map(jumps_at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// One multiple for all B-splines and knots, against derivatives on both sides.
    #[test]
    fn jumps_are_differences_of_derivatives() {
        let knots = Knots::new(3, 0.0, 4.0, &[0.9, 2.0, 3.2]);
        let third = |x: f64, function: usize| {
            let first = knots.first_function(x);
            let derivatives = knots.derivatives::<4>(first, x)[3];
            let place = function.wrapping_sub(first);
            if place < 4 { derivatives[place] } else { 0.0 }
        };
        // 3! and the mean interval of 1; the sign is that of a B-spline's divided difference.
        for (interior, jumps) in of(&knots).iter().enumerate() {
            let knot = knots.interior()[interior];
            for (offset, jump) in jumps[..5].iter().enumerate() {
                let function = interior + offset;
                let difference = third(knot + 1e-9, function) - third(knot - 1e-9, function);
                assert_relative_eq!(difference, 6.0 * jump, epsilon = 1e-9);
            }
        }
    }
}
