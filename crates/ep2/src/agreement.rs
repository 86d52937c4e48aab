//! Tests of a fit against contacts that contradict it.
//!
//! The surface is a quadric plus a process of a known covariance, the contacts' errors are those of positions and normals to
//! first order. Where the noise outweighs the process, what is left of the contacts in standard deviations is distributed as
//! chi-squared, whatever the surface is where the process outweighs the noise. Rao's score test asks how much would be
//! explained if a pattern were fitted too, with quadric and process as nuisance.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector3};
use palpate_chance::{Explained, GoodnessOfFit, LEFT, least_likely};

use crate::chebyshev::{count, products, values};
use crate::doubt::Agreement;
use crate::patch::Sample;
use crate::square::Square;
use crate::{Doubt, Ep2Error, Fit, Jet, Noise, Patch};

/// Number of unknowns of a quadric, whose products come first.
const UNKNOWNS: usize = count(2);
/// Observations of a contact: its height, and both slopes.
const OBSERVED: usize = 3;
/// Patterns of normals: turns about both tangents, and linear maps of the slopes.
const OF_NORMALS: usize = 6;
/// Most contacts that are tested: of more, as many are taken evenly, which takes no longer than a fit.
const MOST_CONTACTS: usize = 2000;
/// Most fingers that are tested one by one.
const MOST_FINGERS: usize = 64;
/// Noise of positions that is found below which it may be rounding, or what the series does not follow, in the patch's unit.
const ROUNDING: f64 = 1e-4;
/// Least share of the noise of normals that is found that is not from positions.
const OWN: f64 = 0.1;

/// Fit whose agreement with its contacts is asked for.
pub(crate) struct Model<'a> {
    pub(crate) patch: &'a Patch,
    pub(crate) square: Square,
    pub(crate) fit: &'a Fit,
    /// Noise that is stated.
    pub(crate) told: &'a Noise,
    /// Degree of the series that the surface is.
    pub(crate) degree: usize,
    /// The series' coefficients behind the quadrics, a column for each independent factor of unit variance.
    pub(crate) process: DMatrix<f64>,
}

/// Variances of positions and normals, in the patch's unit.
#[derive(Clone, Copy)]
struct Variances {
    position: f64,
    normal: f64,
}

/// Observations of a contact in standard deviations.
struct Weighted {
    /// Deviation from the first surface.
    values: DVector<f64>,
    /// Slopes by the factors of quadric and process.
    slopes: DMatrix<f64>,
    root: DMatrix<f64>,
}

/// Sums over contacts of products.
struct Sums {
    information: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    equations: usize,
}

impl Model<'_> {
    /// Goodness of fit and doubts.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] where the numbers leave the range of doubles.
    pub(crate) fn agreement(&self) -> Result<Agreement, Ep2Error> {
        let Some(variances) = self.variances() else {
            return Ok(Agreement::default());
        };
        let sums = self.sums(variances)?;
        let test = Test::new(self, variances, &sums).ok_or(Ep2Error::OutOfRange)?;
        let goodness = self.is_noise_told().then_some(test.goodness);
        let (finger, displaced) = test.displaced()?;
        let doubts = [
            Doubt::LargeResiduals {
                p_value: goodness.map_or(1.0, |goodness| goodness.p_value),
            },
            Doubt::ContradictingNormals {
                p_value: test.of_normals()?,
            },
            Doubt::DisplacedFinger {
                finger,
                p_value: displaced,
            },
        ];
        let is_doubted = |doubt: &Doubt| doubt.p_value() < Doubt::LEVEL;
        Ok(Agreement {
            goodness,
            doubts: doubts.into_iter().filter(is_doubted).collect(),
        })
    }

    /// Variances of the contacts; `None` where nothing tells them apart from rounding.
    fn variances(&self) -> Option<Variances> {
        let noise = self.fit.noise?;
        let square = |std: f64| std * std;
        let told = self.told.normal_std_rad.map(square);
        let position = self.told.position_std.unwrap_or(noise.position_std);
        let position = position / self.fit.frame.scale();
        if !self.is_noise_told() && position <= ROUNDING {
            return None;
        }
        let position = square(position);
        let found = noise.normal_std_rad.map_or(0.0, square);
        // The noise of normals as the fit has it holds what an error of the place makes of it.
        let jets = self.samples().map(|sample| self.jet(sample));
        let bend = |jet: Jet| 0.5 * (jet.uu * jet.uu + 2.0 * jet.uv * jet.uv + jet.vv * jet.vv);
        let bending = jets.map(bend).sum::<f64>() / self.samples().count() as f64;
        Some(Variances {
            position,
            normal: told.unwrap_or((found - bending * position).max(OWN * found)),
        })
    }

    /// Whether all noise is stated.
    fn is_noise_told(&self) -> bool {
        self.told.is_all_of(self.patch)
    }

    /// Contacts that are tested.
    fn samples(&self) -> impl Iterator<Item = &Sample> {
        let samples = &self.patch.samples;
        samples
            .iter()
            .step_by(samples.len().div_ceil(MOST_CONTACTS).max(1))
    }

    fn jet(&self, sample: &Sample) -> Jet {
        self.fit.spline.jet(sample.u, sample.v)
    }

    /// Number of factors of quadric and process.
    fn size(&self) -> usize {
        UNKNOWNS + self.process.ncols()
    }

    /// Observations of a contact in standard deviations of its noise.
    fn weighted(&self, sample: &Sample, variances: Variances) -> Result<Weighted, Ep2Error> {
        let jet = self.jet(sample);
        let root = self
            .root(sample, &jet, variances)
            .ok_or(Ep2Error::OutOfRange)?;
        let rows = root.nrows();
        let read = match sample.slopes {
            Some([along_u, along_v]) => vec![sample.w, along_u, along_v],
            None => vec![sample.w],
        };
        let series = series(self.square, self.degree, sample);
        let mut slopes = DMatrix::zeros(rows, self.size());
        slopes
            .columns_mut(0, UNKNOWNS)
            .copy_from(&series.view((0, 0), (rows, UNKNOWNS)));
        let rough = series.view((0, UNKNOWNS), (rows, series.ncols() - UNKNOWNS));
        if self.process.ncols() > 0 {
            slopes
                .columns_mut(UNKNOWNS, self.process.ncols())
                .copy_from(&(rough * &self.process));
        }
        let values = DVector::from_vec(read);
        Ok(Weighted {
            values: root
                .solve_lower_triangular(&values)
                .ok_or(Ep2Error::OutOfRange)?,
            slopes: root
                .solve_lower_triangular(&slopes)
                .ok_or(Ep2Error::OutOfRange)?,
            root,
        })
    }

    /// Root of the covariance of a contact's height and slopes: an error of the place is one of both.
    fn root(&self, sample: &Sample, jet: &Jet, variances: Variances) -> Option<DMatrix<f64>> {
        let (p, q) = (jet.u, jet.v);
        let moved = Matrix3::from_rows(&[
            Vector3::new(-p, -q, 1.0).transpose(),
            Vector3::new(-jet.uu, -jet.uv, 0.0).transpose(),
            Vector3::new(-jet.uv, -jet.vv, 0.0).transpose(),
        ]);
        let mut covariance = moved * moved.transpose() * variances.position;
        let steepness = 1.0 + p * p + q * q;
        let tilted = Matrix2::new(1.0 + p * p, p * q, p * q, 1.0 + q * q);
        let mut of_slopes = covariance.fixed_view_mut::<2, 2>(1, 1);
        of_slopes += tilted * (steepness * variances.normal);
        covariance /= sample.weight;
        let rows = if sample.slopes.is_some() { OBSERVED } else { 1 };
        let covariance = DMatrix::from_fn(rows, rows, |row, column| covariance[(row, column)]);
        Some(covariance.cholesky()?.l())
    }

    fn sums(&self, variances: Variances) -> Result<Sums, Ep2Error> {
        let size = self.size();
        let mut sums = Sums {
            information: DMatrix::zeros(size, size),
            right: DVector::zeros(size),
            square: 0.0,
            equations: 0,
        };
        for sample in self.samples() {
            let weighted = self.weighted(sample, variances)?;
            sums.information += weighted.slopes.tr_mul(&weighted.slopes);
            sums.right += weighted.slopes.tr_mul(&weighted.values);
            sums.square += weighted.values.norm_squared();
            sums.equations += weighted.values.len();
        }
        let all = sums.square + sums.right.sum() + sums.information.sum();
        match all.is_finite() {
            true => Ok(sums),
            false => Err(Ep2Error::OutOfRange),
        }
    }
}

/// Products of Chebyshev polynomials at a contact, a column each, and their slopes along u and v in the rows below.
fn series(square: Square, degree: usize, sample: &Sample) -> DMatrix<f64> {
    let [a, b] = square.place([sample.u, sample.v]);
    let [half_u, half_v] = square.half();
    let both = |x: f64| -> Vec<[f64; 2]> {
        let all: Vec<f64> = values(x, degree).collect();
        let mut slopes = vec![0.0; degree + 1];
        for order in 1..=degree {
            // T_n' = 2 T_(n−1) + 2x T_(n−1)' − T_(n−2)', where T_1' = 1.
            slopes[order] = match order {
                1 => 1.0,
                _ => 2.0 * all[order - 1] + 2.0 * x * slopes[order - 1] - slopes[order - 2],
            };
        }
        all.into_iter()
            .zip(slopes)
            .map(|(value, slope)| [value, slope])
            .collect()
    };
    let (along_a, along_b) = (both(a), both(b));
    let mut rows = DMatrix::zeros(OBSERVED, count(degree));
    for (column, [i, j]) in products(degree).enumerate() {
        let ([of_a, slope_a], [of_b, slope_b]) = (along_a[i], along_b[j]);
        rows[(0, column)] = of_a * of_b;
        rows[(1, column)] = slope_a * of_b / half_u;
        rows[(2, column)] = of_a * slope_b / half_v;
    }
    rows
}

/// A fit with all that its tests ask for.
struct Test<'m, 'a> {
    model: &'m Model<'a>,
    variances: Variances,
    covariance: DMatrix<f64>,
    /// The most likely factors.
    factors: DVector<f64>,
    goodness: GoodnessOfFit,
    /// Rest of all contacts, of which the process explains as much as it may, and its degrees of freedom.
    chi_squared: f64,
    freedom: usize,
}

impl<'m, 'a> Test<'m, 'a> {
    fn new(model: &'m Model<'a>, variances: Variances, sums: &Sums) -> Option<Self> {
        let size = model.size();
        let rough = size - UNKNOWNS;
        let quadrics = sums
            .information
            .view((0, 0), (UNKNOWNS, UNKNOWNS))
            .into_owned();
        let cross = sums
            .information
            .view((0, UNKNOWNS), (UNKNOWNS, rough))
            .into_owned();
        let quadrics = quadrics.cholesky()?;
        let own = sums.right.rows(0, UNKNOWNS).into_owned();
        let start = quadrics.solve(&own);
        let replaced = quadrics.solve(&cross);
        let rest =
            sums.information.view((UNKNOWNS, UNKNOWNS), (rough, rough)) - cross.tr_mul(&replaced);
        let right = sums.right.rows(UNKNOWNS, rough) - cross.tr_mul(&start);
        let square = (sums.square - own.dot(&start)).max(0.0);
        let freedom = sums.equations.saturating_sub(UNKNOWNS);
        let (mut noisy, mut all) = (square, square);
        let mut process = 0;
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
                process += 1;
            } else {
                noisy -= explained;
            }
        }
        let mut information = sums.information.clone();
        for factor in UNKNOWNS..size {
            information[(factor, factor)] += 1.0;
        }
        let root = information.cholesky()?;
        Some(Self {
            model,
            variances,
            factors: root.solve(&sums.right),
            covariance: root.inverse(),
            goodness: GoodnessOfFit::new(noisy.max(0.0), freedom.saturating_sub(process)),
            chi_squared: all.max(0.0),
            freedom,
        })
    }

    /// Probability by chance that the normals differ as much from the slopes that the positions tell.
    fn of_normals(&self) -> Result<f64, Ep2Error> {
        if !self.model.patch.has_normals() {
            return Ok(1.0);
        }
        let patterns = |_: &Sample, jet: &Jet| {
            let (p, q) = (jet.u, jet.v);
            DMatrix::from_row_slice(
                OBSERVED,
                OF_NORMALS,
                &[
                    [0.0; OF_NORMALS],
                    [1.0, 0.0, p, q, 0.0, 0.0],
                    [0.0, 1.0, 0.0, 0.0, p, q],
                ]
                .concat(),
            )
        };
        let [squares, left, found] = self.products(OF_NORMALS, &patterns)?;
        let squares: Vec<f64> = squares.diagonal().iter().copied().collect();
        let explained = Explained::by(&squares, &left, &found.column(0).into_owned(), LEFT);
        Ok(self.chance(explained))
    }

    /// The finger that is displaced most, and the probability that chance displaces one of all as far.
    fn displaced(&self) -> Result<(usize, f64), Ep2Error> {
        let samples = self.model.samples();
        let fingers: BTreeSet<usize> = samples.map(|sample| sample.finger).collect();
        let fingers: Vec<usize> = fingers.into_iter().collect();
        if !(2..=MOST_FINGERS).contains(&fingers.len()) {
            return Ok((0, 1.0));
        }
        let patterns = |sample: &Sample, _: &Jet| {
            let rows = if sample.slopes.is_some() { OBSERVED } else { 1 };
            let mut patterns = DMatrix::zeros(rows, fingers.len());
            if let Ok(place) = fingers.binary_search(&sample.finger) {
                patterns[(0, place)] = 1.0;
            }
            patterns
        };
        let [squares, left, found] = self.products(fingers.len(), &patterns)?;
        let chances = fingers.iter().enumerate().map(|(place, &finger)| {
            let own = |all: &DMatrix<f64>| DMatrix::from_element(1, 1, all[(place, place)]);
            let along = DVector::from_element(1, found[(place, 0)]);
            let square = squares[(place, place)];
            let explained = Explained::by(&[square], &own(&left), &along, LEFT);
            (finger, self.chance(explained))
        });
        Ok(least_likely(chances))
    }

    fn chance(&self, explained: Explained) -> f64 {
        match self.model.is_noise_told() && !self.goodness.is_doubted() {
            true => explained.p_value(),
            false => explained.p_value_beside(self.chi_squared, self.freedom),
        }
    }

    /// Products of patterns with each other, the same after factors have taken what they can, and products with what is left.
    fn products(
        &self,
        patterns: usize,
        of: &dyn Fn(&Sample, &Jet) -> DMatrix<f64>,
    ) -> Result<[DMatrix<f64>; 3], Ep2Error> {
        let mut by_patterns = DMatrix::zeros(patterns, patterns);
        let mut by_slopes = DMatrix::zeros(self.model.size(), patterns);
        let mut by_residuals = DMatrix::zeros(patterns, 1);
        for sample in self.model.samples() {
            let weighted = self.model.weighted(sample, self.variances)?;
            let patterns = of(sample, &self.model.jet(sample));
            let patterns = weighted
                .root
                .solve_lower_triangular(&patterns)
                .ok_or(Ep2Error::OutOfRange)?;
            let residual = &weighted.values - &weighted.slopes * &self.factors;
            by_patterns += patterns.tr_mul(&patterns);
            by_slopes += weighted.slopes.tr_mul(&patterns);
            by_residuals += patterns.tr_mul(&residual);
        }
        let taken = by_slopes.tr_mul(&(&self.covariance * &by_slopes));
        let left = &by_patterns - taken;
        Ok([by_patterns, left, by_residuals])
    }
}
