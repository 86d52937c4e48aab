//! Score tests of the contacts against a quadric plus a process.

use nalgebra::{DMatrix, DVector};
use palpate_statistics::{Explained, GoodnessOfFit, LEFT};

use crate::Ep2Error;
use crate::square_quadric::UNKNOWNS;

/// A process that is added to a quadric: its coefficients after those of the quadrics, with a column for each independent
/// factor of unit variance.
pub(crate) type Process = DMatrix<f64>;

/// Sums over contacts of products of patterns.
pub(crate) struct Products {
    /// Products with each other.
    pub(crate) by_patterns: DMatrix<f64>,
    /// Products with the derivatives with respect to the series' coefficients, a column for each pattern.
    pub(crate) by_slopes: DMatrix<f64>,
    /// Products with the deviations from the quadric.
    pub(crate) by_values: DVector<f64>,
}

/// Sums over contacts of products.
pub(crate) struct Sums {
    pub(crate) information: DMatrix<f64>,
    pub(crate) right: DVector<f64>,
    pub(crate) square: f64,
    pub(crate) equations: usize,
}

impl Products {
    /// Sums of one pattern.
    pub(crate) fn one(&self, place: usize) -> Self {
        Self {
            by_patterns: DMatrix::from_element(1, 1, self.by_patterns[(place, place)]),
            by_slopes: self.by_slopes.columns(place, 1).into_owned(),
            by_values: DVector::from_element(1, self.by_values[place]),
        }
    }
}

/// Observations of a contact, in standard deviations.
pub(crate) struct Weighted {
    /// Deviation from the quadric.
    pub(crate) values: DVector<f64>,
    /// Derivatives with respect to the series' coefficients.
    pub(crate) slopes: DMatrix<f64>,
    /// Cholesky factor of the covariance of the observations.
    pub(crate) root: DMatrix<f64>,
}

/// Residuals of observations of one kind: heights or slopes.
#[derive(Clone, Copy, Default)]
pub(crate) struct KindResidual {
    /// Sum of squares, in standard deviations.
    square: f64,
    /// Degrees of freedom.
    left: f64,
    /// Number of observations that the fit does not reproduce in any case.
    count: usize,
}

impl KindResidual {
    pub(crate) fn add(&mut self, other: Self) {
        self.square += other.square;
        self.left += other.left;
        self.count += other.count;
    }

    pub(crate) const fn is_observed(&self) -> bool {
        self.count > 0
    }

    /// P-value relative to all residuals of this kind, which include this one.
    pub(crate) fn p_value_among(&self, all: &Self) -> f64 {
        let explained = Explained {
            fall: self.square,
            freedom: self.count,
        };
        explained.p_value_beside(all.square, all.left.round() as usize)
    }
}

/// Residuals of a contact.
pub(crate) struct ContactResidual {
    pub(crate) all: Explained,
    /// Residuals of its height and of its slopes.
    pub(crate) by_kind: [KindResidual; 2],
}

/// A fit of quadric and process, with the data for its tests.
pub(crate) struct Test<'p> {
    process: &'p Process,
    covariance: DMatrix<f64>,
    /// The most probable factors.
    factors: DVector<f64>,
    pub(crate) goodness: GoodnessOfFit,
    /// Residuals of all contacts, after the process has explained as much as it can, and their degrees of freedom.
    chi_squared: f64,
    freedom: usize,
    /// Whether the noise is stated and explains the residuals.
    pub(crate) is_noise_trusted: bool,
}

impl<'p> Test<'p> {
    /// The tests of a model with this process.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if the equations do not determine the quadric.
    pub(crate) fn new(
        process: &'p Process,
        sums: &Sums,
        is_noise_stated: bool,
    ) -> Result<Self, Ep2Error> {
        let half = by_factors(process, &sums.information);
        let mut information = by_factors(process, &half.transpose());
        let rights = DMatrix::from_column_slice(sums.right.len(), 1, sums.right.as_slice());
        let rights = by_factors(process, &rights).column(0).into_owned();
        let size = rights.len();
        let rough = size - UNKNOWNS;
        let quadrics = information.view((0, 0), (UNKNOWNS, UNKNOWNS)).into_owned();
        let cross = information.columns(UNKNOWNS, rough);
        let cross = cross.rows(0, UNKNOWNS).into_owned();
        let quadrics = quadrics.cholesky().ok_or(Ep2Error::OutOfRange)?;
        let own = rights.rows(0, UNKNOWNS).into_owned();
        let start = quadrics.solve(&own);
        let replaced = quadrics.solve(&cross);
        let rest = information.view((UNKNOWNS, UNKNOWNS), (rough, rough)) - cross.tr_mul(&replaced);
        let right = rights.rows(UNKNOWNS, rough) - cross.tr_mul(&start);
        let square = (sums.square - own.dot(&start)).max(0.0);
        let freedom = sums.equations.saturating_sub(UNKNOWNS);
        let (mut noisy, mut all) = (square, square);
        let mut outweighing = 0;
        // A quadric without a process has no modes.
        let eigen = (rough > 0).then(|| rest.symmetric_eigen());
        let modes = eigen.iter().flat_map(|eigen| {
            let vectors = eigen.eigenvectors.column_iter();
            eigen.eigenvalues.iter().zip(vectors)
        });
        for (&weight, mode) in modes {
            let along = mode.dot(&right);
            let explained = along * along / (1.0 + weight.max(0.0));
            all -= explained;
            // If the process is larger than the noise, the mode shows the surface.
            if weight >= 1.0 {
                noisy -= along * along / weight;
                outweighing += 1;
            } else {
                noisy -= explained;
            }
        }
        for factor in UNKNOWNS..size {
            information[(factor, factor)] += 1.0;
        }
        let root = information.cholesky().ok_or(Ep2Error::OutOfRange)?;
        let goodness = GoodnessOfFit::new(noisy.max(0.0), freedom.saturating_sub(outweighing));
        Ok(Self {
            process,
            factors: root.solve(&rights),
            covariance: root.inverse(),
            goodness,
            chi_squared: all.max(0.0),
            freedom,
            is_noise_trusted: is_noise_stated && !goodness.is_doubted(),
        })
    }

    /// Residuals of a contact.
    pub(crate) fn residual(&self, contact: &Weighted) -> ContactResidual {
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
            KindResidual {
                square: fall,
                left,
                count: freedom,
            }
        };
        ContactResidual {
            all: part(0, rows).0,
            by_kind: [of_kind(0, 1), of_kind(1, rows - 1)],
        }
    }

    /// P-value of patterns, after the factors have explained as much as they can.
    pub(crate) fn p_value(&self, products: &Products) -> f64 {
        let by_slopes = by_factors(self.process, &products.by_slopes);
        let explained = by_slopes.tr_mul(&(&self.covariance * &by_slopes));
        let left = &products.by_patterns - explained;
        let found = &products.by_values - by_slopes.tr_mul(&self.factors);
        let squares: Vec<f64> = products.by_patterns.diagonal().iter().copied().collect();
        let explained = Explained::by(&squares, &left, &found, LEFT);
        match self.is_noise_trusted {
            true => explained.p_value(),
            false => explained.p_value_beside(self.chi_squared, self.freedom),
        }
    }
}

/// Transforms rows for the coefficients of a series to rows for the factors of quadric and process.
fn by_factors(process: &Process, rows: &DMatrix<f64>) -> DMatrix<f64> {
    let rough = rows.nrows() - UNKNOWNS;
    let mut all = DMatrix::zeros(UNKNOWNS + process.ncols(), rows.ncols());
    all.rows_mut(0, UNKNOWNS).copy_from(&rows.rows(0, UNKNOWNS));
    if process.ncols() > 0 {
        let rest = process.tr_mul(&rows.rows(UNKNOWNS, rough));
        all.rows_mut(UNKNOWNS, process.ncols()).copy_from(&rest);
    }
    all
}
