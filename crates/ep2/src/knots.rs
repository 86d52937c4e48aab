//! B-splines of one variable, and their knots.

pub(crate) const MAX_DEGREE: usize = 5;

/// Values of the `degree + 1` B-splines that are not zero at a place. The remaining entries of the array are 0.
pub(crate) type Basis = [f64; MAX_DEGREE + 1];

/// The knots of a spline on an interval. Each end of the interval is repeated `degree + 1` times.
///
/// Outside of the interval, the spline continues with its first or its last polynomial.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Knots {
    degree: usize,
    knots: Vec<f64>,
}

impl Knots {
    /// Knots of a spline of degree `degree` (at most [`MAX_DEGREE`]) on the interval `[start, end]`. The interior knots
    /// must be strictly inside the interval and in ascending order.
    pub(crate) fn new(degree: usize, start: f64, end: f64, interior: &[f64]) -> Self {
        assert!((1..=MAX_DEGREE).contains(&degree) && start < end);
        let mut knots = vec![start; degree + 1];
        knots.extend_from_slice(interior);
        knots.resize(knots.len() + degree + 1, end);
        assert!(knots.is_sorted());
        Self { degree, knots }
    }

    pub(crate) fn uniform(degree: usize, start: f64, end: f64, intervals: usize) -> Self {
        let step = (end - start) / intervals as f64;
        let interior: Vec<f64> = (1..intervals)
            .map(|knot| start + step * knot as f64)
            .collect();
        Self::new(degree, start, end, &interior)
    }

    pub(crate) const fn degree(&self) -> usize {
        self.degree
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.knots
    }

    pub(crate) fn interior(&self) -> &[f64] {
        &self.knots[self.degree + 1..self.knots.len() - self.degree - 1]
    }

    pub(crate) fn functions(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    pub(crate) fn domain(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
    }

    /// Index of the first B-spline that is not zero on the knot interval around `x`. If `x` is outside of all
    /// intervals, the nearest interval is used.
    #[inline]
    pub(crate) fn first_function(&self, x: f64) -> usize {
        let interior = self.interior();
        if interior.len() < 8 {
            interior.iter().map(|&knot| usize::from(knot <= x)).sum()
        } else {
            interior.partition_point(|&knot| knot <= x)
        }
    }

    /// Values at `x` of the B-splines that are not zero there. `first` is the index of the first of them (see
    /// [`Knots::first_function`]).
    #[inline]
    pub(crate) fn values(&self, first: usize, x: f64) -> Basis {
        self.derivatives::<1>(first, x)[0]
    }

    /// Values and derivatives up to order `ORDERS − 1`, at `x`, of the B-splines that are not zero there. `first` is
    /// the index of the first of these B-splines.
    ///
    /// The values for degrees 0, 1, … are computed by the recurrence of Cox and de Boor. A derivative of order m is an
    /// m-fold difference of the values for degree `degree − m`.
    #[inline]
    pub(crate) fn derivatives<const ORDERS: usize>(&self, first: usize, x: f64) -> [Basis; ORDERS] {
        match self.degree {
            // Pass the usual degrees as constants, so that the compiler can unroll the loops.
            2 => self.derivatives_of(2, first, x),
            3 => self.derivatives_of(3, first, x),
            degree => self.derivatives_of(degree, first, x),
        }
    }

    #[inline(always)]
    fn derivatives_of<const ORDERS: usize>(
        &self,
        degree: usize,
        first: usize,
        x: f64,
    ) -> [Basis; ORDERS] {
        let left = first + degree;
        let knots = &self.knots[..=left + degree];
        let mut result = [[0.0; MAX_DEGREE + 1]; ORDERS];
        let mut values: Basis = [0.0; MAX_DEGREE + 1];
        values[0] = 1.0;
        for lower in 0..degree {
            // At this point, `values` are the values of the B-splines of degree `lower`. The derivative of order
            // `order` is computed from them.
            let order = degree - lower;
            if order < ORDERS {
                result[order] = differences(knots, degree, left, lower, values);
            }
            let mut carried = 0.0;
            for place in 0..=lower {
                let (below, above) = (knots[left + place - lower], knots[left + place + 1]);
                let share = values[place] / (above - below);
                values[place] = carried + (above - x) * share;
                carried = (x - below) * share;
            }
            values[lower + 1] = carried;
        }
        result[0] = values;
        result
    }
}

/// Derivatives of order `degree − lower` of the B-splines of the full degree. These derivatives are computed from the
/// values of the B-splines of degree `lower`.
#[inline(always)]
fn differences(
    knots: &[f64],
    degree: usize,
    left: usize,
    lower: usize,
    mut values: Basis,
) -> Basis {
    for higher in lower + 1..=degree {
        let mut carried = 0.0;
        for (place, value) in values[..higher].iter_mut().enumerate() {
            let width = knots[left + place + 1] - knots[left + place + 1 - higher];
            let share = higher as f64 * *value / width;
            *value = carried - share;
            carried = share;
        }
        values[higher] = carried;
    }
    values
}
