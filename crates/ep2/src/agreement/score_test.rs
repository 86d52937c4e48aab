//! Test of contacts by a quadric and a process beside it.

use nalgebra::{DMatrix, DVector};
use palpate_statistics::{Explained, GoodnessOfFit, LEFT};

use crate::Ep2Error;
use crate::square_quadric::UNKNOWNS;

/// Process beside quadrics: the series' coefficients behind the quadrics, a column for each independent factor of unit variance.
pub(crate) type Process = DMatrix<f64>;

/// Sums over contacts of products of patterns.
pub(super) struct Products {
    /// Products with each other.
    pub(super) by_patterns: DMatrix<f64>,
    /// Products with slopes by the coefficients of the series, a column for each pattern.
    pub(super) by_slopes: DMatrix<f64>,
    /// Products with the deviations from the quadric.
    pub(super) by_values: DVector<f64>,
}

/// Sums over contacts of products.
pub(super) struct Sums {
    pub(super) information: DMatrix<f64>,
    pub(super) right: DVector<f64>,
    pub(super) square: f64,
    pub(super) equations: usize,
}

impl Products {
    /// Sums of one pattern alone.
    pub(super) fn of(&self, place: usize) -> Self {
        Self {
            by_patterns: DMatrix::from_element(1, 1, self.by_patterns[(place, place)]),
            by_slopes: self.by_slopes.columns(place, 1).into_owned(),
            by_values: DVector::from_element(1, self.by_values[place]),
        }
    }
}

/// Observations of a contact in standard deviations.
pub(super) struct Weighted {
    /// Deviation from the quadric.
    pub(super) values: DVector<f64>,
    /// Slopes by the coefficients of the series.
    pub(super) slopes: DMatrix<f64>,
    pub(super) root: DMatrix<f64>,
}

/// Rest that a fit leaves of observations of one kind.
#[derive(Clone, Copy, Default)]
pub(super) struct Rest {
    /// Squares in standard deviations of what is left.
    square: f64,
    /// Number of observations that are left.
    left: f64,
    /// Number of observations.
    count: usize,
}

impl Rest {
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            square: self.square + other.square,
            left: self.left + other.left,
            count: self.count + other.count,
        }
    }

    /// Whether something of this kind was observed that a fit does not follow whatever it is.
    pub(super) const fn is_there(&self) -> bool {
        self.count > 0
    }

    /// Probability by chance of as much beside all of this kind, of which this is a part.
    pub(super) fn chance_beside(&self, all: &Self) -> f64 {
        let explained = Explained {
            fall: self.square,
            freedom: self.count,
        };
        explained.p_value_beside(all.square, all.left.round() as usize)
    }
}

/// Rest that a fit leaves of a contact.
pub(super) struct ContactRest {
    pub(super) all: Explained,
    /// Rest of its height and of its slopes.
    pub(super) by_kind: [Rest; 2],
}

/// A fit of quadric and process with all that its tests ask for.
pub(super) struct Test<'p> {
    process: &'p Process,
    covariance: DMatrix<f64>,
    /// The most likely factors.
    factors: DVector<f64>,
    pub(super) goodness: GoodnessOfFit,
    /// Rest of all contacts, of which the process explains as much as it may, and its degrees of freedom.
    chi_squared: f64,
    freedom: usize,
    /// Whether the noise is told, and explains the residuals.
    pub(super) is_noise_trusted: bool,
}

impl<'p> Test<'p> {
    /// The tests of a model by a process.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] where the equations do not determine the quadric.
    pub(super) fn new(
        process: &'p Process,
        sums: &Sums,
        is_noise_told: bool,
    ) -> Result<Self, Ep2Error> {
        Self::of(process, sums, is_noise_told).ok_or(Ep2Error::OutOfRange)
    }

    fn of(process: &'p Process, sums: &Sums, is_noise_told: bool) -> Option<Self> {
        let half = by_factors(process, &sums.information);
        let information = by_factors(process, &half.transpose());
        let rights = DMatrix::from_column_slice(sums.right.len(), 1, sums.right.as_slice());
        let rights = by_factors(process, &rights).column(0).into_owned();
        let size = rights.len();
        let rough = size - UNKNOWNS;
        let quadrics = information.view((0, 0), (UNKNOWNS, UNKNOWNS)).into_owned();
        let cross = information
            .view((0, UNKNOWNS), (UNKNOWNS, rough))
            .into_owned();
        let quadrics = quadrics.cholesky()?;
        let own = rights.rows(0, UNKNOWNS).into_owned();
        let start = quadrics.solve(&own);
        let replaced = quadrics.solve(&cross);
        let rest = information.view((UNKNOWNS, UNKNOWNS), (rough, rough)) - cross.tr_mul(&replaced);
        let right = rights.rows(UNKNOWNS, rough) - cross.tr_mul(&start);
        let square = (sums.square - own.dot(&start)).max(0.0);
        let freedom = sums.equations.saturating_sub(UNKNOWNS);
        let (mut noisy, mut all) = (square, square);
        let mut outweighing = 0;
        // A quadric alone has no modes.
        let eigen = (rough > 0).then(|| rest.symmetric_eigen());
        let modes = eigen.iter().flat_map(|eigen| {
            let vectors = eigen.eigenvectors.column_iter();
            eigen.eigenvalues.iter().zip(vectors)
        });
        for (&told, mode) in modes {
            let along = mode.dot(&right);
            let explained = along * along / (1.0 + told.max(0.0));
            all -= explained;
            // What the process outweighs is of the surface.
            if told >= 1.0 {
                noisy -= along * along / told;
                outweighing += 1;
            } else {
                noisy -= explained;
            }
        }
        let mut information = information;
        for factor in UNKNOWNS..size {
            information[(factor, factor)] += 1.0;
        }
        let root = information.cholesky()?;
        let goodness = GoodnessOfFit::new(noisy.max(0.0), freedom.saturating_sub(outweighing));
        Some(Self {
            process,
            factors: root.solve(&rights),
            covariance: root.inverse(),
            goodness,
            chi_squared: all.max(0.0),
            freedom,
            is_noise_trusted: is_noise_told && !goodness.is_doubted(),
        })
    }

    /// Rest of a contact.
    pub(super) fn rest(&self, contact: &Weighted) -> ContactRest {
        let slopes = by_factors(self.process, &contact.slopes.transpose());
        let residual = &contact.values - slopes.tr_mul(&self.factors);
        let rows = residual.len();
        let left = DMatrix::identity(rows, rows) - slopes.tr_mul(&(&self.covariance * &slopes));
        let part = |first: usize, rows: usize| {
            let left = left.view((first, first), (rows, rows)).into_owned();
            let residual = residual.rows(first, rows).into_owned();
            let explained = Explained::by(&vec![1.0; rows], &left, &residual, LEFT);
            (explained, left.trace())
        };
        let of_kind = |first: usize, rows: usize| {
            let (Explained { fall, freedom }, left) = part(first, rows);
            Rest {
                square: fall,
                left,
                count: freedom,
            }
        };
        ContactRest {
            all: part(0, rows).0,
            by_kind: [of_kind(0, 1), of_kind(1, rows - 1)],
        }
    }

    /// Probability by chance of as much of patterns as the contacts have, after the factors have taken what they can.
    pub(super) fn chance_of(&self, products: &Products) -> f64 {
        let by_slopes = by_factors(self.process, &products.by_slopes);
        let taken = by_slopes.tr_mul(&(&self.covariance * &by_slopes));
        let left = &products.by_patterns - taken;
        let found = &products.by_values - by_slopes.tr_mul(&self.factors);
        let squares: Vec<f64> = products.by_patterns.diagonal().iter().copied().collect();
        self.chance(Explained::by(&squares, &left, &found, LEFT))
    }

    /// Probability by chance of as much that patterns explain.
    fn chance(&self, explained: Explained) -> f64 {
        match self.is_noise_trusted {
            true => explained.p_value(),
            false => explained.p_value_beside(self.chi_squared, self.freedom),
        }
    }
}

/// Rows of the coefficients of a series as those of the factors of quadric and process.
fn by_factors(process: &Process, rows: &DMatrix<f64>) -> DMatrix<f64> {
    let rough = rows.nrows() - UNKNOWNS;
    let mut all = DMatrix::zeros(UNKNOWNS + process.ncols(), rows.ncols());
    all.rows_mut(0, UNKNOWNS).copy_from(&rows.rows(0, UNKNOWNS));
    if process.ncols() > 0 {
        let rest = rows.rows(UNKNOWNS, rough);
        all.rows_mut(UNKNOWNS, process.ncols())
            .copy_from(&process.tr_mul(&rest));
    }
    all
}
