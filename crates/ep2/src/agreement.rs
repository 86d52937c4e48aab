//! Tests of a fit: do the contacts contradict its model?
//!
//! The surface is a quadric plus a Gaussian process of known covariance. The errors of the contacts follow to first order from
//! those of positions and normals. In the modes in which the noise is larger than the process, the squared residuals follow
//! a chi-squared distribution for any surface. Rao's score test computes how much a pattern would explain if it were
//! fitted too; quadric and process are its nuisance parameters.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector3};
use palpate_statistics::least_likely;

use crate::chebyshev::{count, products, values};
use crate::doubt::Agreement;
use crate::patch::Sample;
use crate::score_test::{ContactResidual, KindResidual, Process, Products, Sums, Test, Weighted};
use crate::square_quadric::{Square, SquareQuadric};
use crate::{Doubt, Ep2Error, Fit, Jet, Noise, Patch};

/// Number of observations of a contact: its height and both slopes.
const OBSERVATIONS: usize = 3;
/// Number of patterns for normals. For slopes these are turns about both tangents and linear maps. For heights they are
/// quadrics, which match the same turns and some of the maps if heights are less noisy than slopes.
const NORMAL_PATTERNS: usize = 11;
/// Share of the false alarms about normals that the test with the roughness from the positions alone may cause. The
/// positions alone determine the roughness less well.
const POSITION_TEST_SHARE: f64 = 0.1;
/// Smallest number of contacts for which estimated noise and patterns can be separated.
const MIN_CONTACTS: usize = 10;
/// Largest number of tested contacts. From more contacts an even selection is tested, so the test takes no longer than a fit.
const MAX_CONTACTS: usize = 2000;
/// Largest number of fingers that are tested one by one.
const MAX_FINGERS: usize = 64;
/// Largest number of fingers for which the roughness is estimated again without them: those that seem displaced most.
const MAX_EXCLUDED_FINGERS: usize = 8;
/// Smallest estimated noise of positions that is tested, in the patch's unit. A smaller value may come from rounding errors,
/// or from the series' approximation error.
const MIN_POSITION_STD: f64 = 1e-4;
/// Smallest share of the estimated noise of normals that is not caused by position errors.
const MIN_NORMAL_SHARE: f64 = 0.1;

/// The fit to test, with the data that the tests need.
pub(crate) struct Model<'a> {
    pub(crate) patch: &'a Patch,
    pub(crate) square: Square,
    pub(crate) fit: &'a Fit,
    /// A quadric near the fit. Deviations from it keep more digits than heights.
    pub(crate) quadric: &'a SquareQuadric,
    /// Stated noise.
    pub(crate) noise: &'a Noise,
    /// Degree of the surface as a series.
    pub(crate) degree: usize,
}

/// Observations that are excluded when the roughness is estimated, because they may contradict the others.
#[derive(Clone, Copy)]
pub(crate) enum Exclusion {
    /// The mean height of the finger of this number.
    Finger(usize),
    /// The normals.
    Normals,
}

/// Variances of positions and normals, in the patch's unit.
#[derive(Clone, Copy)]
struct Variances {
    position: f64,
    normal: f64,
}

impl Model<'_> {
    /// Goodness of fit and contradictions, by the most probable process. `excluding` returns the processes with some observations
    /// excluded.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if the numbers leave the range of doubles.
    pub(crate) fn agreement(
        &self,
        processes: &[(f64, Process)],
        excluding: &impl Fn(Exclusion) -> Result<Vec<(f64, Process)>, Ep2Error>,
    ) -> Result<Agreement, Ep2Error> {
        let (Some(variances), Some((_, process))) = (self.variances(), processes.first()) else {
            return Ok(Agreement::default());
        };
        let sums = self.sums(variances)?;
        let test = Test::new(process, &sums, self.is_noise_stated())?;
        let goodness = self.is_noise_stated().then_some(test.goodness);
        let (finger, displaced) = self.displaced_finger(&test, variances, &sums, excluding)?;
        let (contact, stray) = self.stray_contact(&test, variances)?;
        let doubts = [
            Doubt::LargeResiduals {
                p_value: goodness.map_or(1.0, |goodness| goodness.p_value),
            },
            Doubt::ContradictingNormals {
                p_value: self.normals_p_value(&test, variances, &sums, excluding)?,
            },
            Doubt::NotAQuadric {
                p_value: self.powers_p_value(&test, variances)?,
            },
            Doubt::DisplacedFinger {
                finger,
                p_value: displaced,
            },
            Doubt::StrayContact {
                contact,
                p_value: stray,
            },
        ];
        let is_doubted = |doubt: &Doubt| doubt.p_value() < doubt.level();
        Ok(Agreement {
            goodness,
            doubts: doubts.into_iter().filter(is_doubted).collect(),
        })
    }

    /// P-value of the difference between the normals and the slopes of a quadric through the positions. The fit's own slopes
    /// would follow wrong normals.
    fn normals_p_value(
        &self,
        test: &Test<'_>,
        variances: Variances,
        sums: &Sums,
        excluding: &impl Fn(Exclusion) -> Result<Vec<(f64, Process)>, Ep2Error>,
    ) -> Result<f64, Ep2Error> {
        if !self.patch.has_normals() {
            return Ok(1.0);
        }
        let positions = self.patch.without_normals();
        let known = self.noise.in_patch(&self.patch.frame)?;
        let quadric = SquareQuadric::of(&positions, &self.square, &known).ok();
        let patterns = |sample: &Sample, jet: &Jet| {
            let of_quadric = |quadric: &SquareQuadric| quadric.at(&self.square, sample);
            let [_, p, q] = quadric.as_ref().map_or([jet.w, jet.u, jet.v], of_quadric);
            let (u, v) = (sample.u, sample.v);
            DMatrix::from_row_slice(
                OBSERVATIONS,
                NORMAL_PATTERNS,
                &[
                    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, u, v, u * u, u * v, v * v],
                    [1.0, 0.0, p, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                    [0.0, 1.0, 0.0, 0.0, p, q, 0.0, 0.0, 0.0, 0.0, 0.0],
                ]
                .concat(),
            )
        };
        let products = self.products(variances, NORMAL_PATTERNS, &patterns)?;
        let p_value = test.p_value(&products);
        let Ok(processes) = excluding(Exclusion::Normals) else {
            return Ok(p_value);
        };
        let by_positions = self.mean_p_value(&processes, sums, &products)?;
        Ok((p_value / (1.0 - POSITION_TEST_SHARE))
            .min(by_positions / POSITION_TEST_SHARE)
            .min(1.0))
    }

    /// P-value of third and fourth powers of the place in the residuals of a quadric; 1 for other surfaces, which can follow
    /// these powers.
    fn powers_p_value(&self, test: &Test<'_>, variances: Variances) -> Result<f64, Ep2Error> {
        if self.degree > 2 {
            return Ok(1.0);
        }
        let (quadrics, powers) = (count(2), count(4) - count(2));
        let patterns = |sample: &Sample, _: &Jet| {
            let rows = if sample.slopes.is_some() {
                OBSERVATIONS
            } else {
                1
            };
            let all = series(self.square, 4, sample);
            all.view((0, quadrics), (rows, powers)).into_owned()
        };
        Ok(test.p_value(&self.products(variances, powers, &patterns)?))
    }

    /// The finger that seems displaced most, and the p-value for one of all fingers. A displaced finger makes the surface seem
    /// rougher than it is, so the test uses the roughness from the other fingers.
    fn displaced_finger(
        &self,
        test: &Test<'_>,
        variances: Variances,
        sums: &Sums,
        excluding: &impl Fn(Exclusion) -> Result<Vec<(f64, Process)>, Ep2Error>,
    ) -> Result<(usize, f64), Ep2Error> {
        let fingers: BTreeSet<usize> = self.samples().map(|sample| sample.finger).collect();
        let fingers: Vec<usize> = fingers.into_iter().collect();
        if !(2..=MAX_FINGERS).contains(&fingers.len()) {
            return Ok((0, 1.0));
        }
        let patterns = |sample: &Sample, _: &Jet| {
            let rows = if sample.slopes.is_some() {
                OBSERVATIONS
            } else {
                1
            };
            let mut patterns = DMatrix::zeros(rows, fingers.len());
            if let Ok(place) = fingers.binary_search(&sample.finger) {
                patterns[(0, place)] = 1.0;
            }
            patterns
        };
        let products = self.products(variances, fingers.len(), &patterns)?;
        let ones = fingers.iter().enumerate();
        let mut p_values: Vec<(usize, f64, Products)> = ones
            .map(|(place, &finger)| {
                let one = products.one(place);
                (finger, test.p_value(&one), one)
            })
            .collect();
        p_values.sort_by(|(_, one, _), (_, other, _)| one.total_cmp(other));
        for (finger, p_value, one) in p_values.iter_mut().take(MAX_EXCLUDED_FINGERS) {
            if let Ok(processes) = excluding(Exclusion::Finger(*finger)) {
                *p_value = self.mean_p_value(&processes, sums, one)?;
            }
        }
        let p_values = p_values.iter();
        Ok(least_likely(
            p_values.map(|&(finger, p_value, _)| (finger, p_value)),
        ))
    }

    /// P-value of patterns: the mean over the processes, weighted by their probabilities.
    fn mean_p_value(
        &self,
        processes: &[(f64, Process)],
        sums: &Sums,
        products: &Products,
    ) -> Result<f64, Ep2Error> {
        let mut mean: f64 = 0.0;
        for (share, process) in processes {
            let test = Test::new(process, sums, self.is_noise_stated())?;
            mean += share * test.p_value(products);
        }
        Ok(mean.min(1.0))
    }

    /// The contact that contradicts the others most, and the p-value for one of all contacts. A contact with a large error
    /// distorts estimated noise and makes the surface seem rough. So heights are then compared with heights, and slopes with
    /// slopes, each relative to its degrees of freedom.
    fn stray_contact(
        &self,
        test: &Test<'_>,
        variances: Variances,
    ) -> Result<(usize, f64), Ep2Error> {
        let mut residuals = Vec::new();
        for (place, sample) in self.samples().enumerate() {
            residuals.push((place, test.residual(&self.weighted(sample, variances)?)));
        }
        let mut sums = [KindResidual::default(); 2];
        for (_, residual) in &residuals {
            for (sum, own) in sums.iter_mut().zip(residual.by_kind) {
                sum.add(own);
            }
        }
        let p_value = |(place, residual): &(usize, ContactResidual)| {
            let p_value = match test.is_noise_trusted {
                true => residual.all.p_value(),
                false => {
                    let kinds = residual.by_kind.iter().zip(&sums);
                    let kinds = kinds.filter(|(own, _)| own.is_observed());
                    least_likely(kinds.map(|(own, all)| (*place, own.p_value_among(all)))).1
                }
            };
            (place * self.step(), p_value)
        };
        Ok(least_likely(residuals.iter().map(p_value)))
    }

    /// Variances of the contacts; `None` if they were estimated and may be rounding errors, or from too few contacts.
    fn variances(&self) -> Option<Variances> {
        let noise = self.fit.noise?;
        let square = |std: f64| std * std;
        let stated = self.noise.normal_std_rad.map(square);
        let position = self.noise.position_std.unwrap_or(noise.position_std);
        let position = position / self.fit.frame.scale();
        let is_estimated = position > MIN_POSITION_STD && self.patch.samples.len() >= MIN_CONTACTS;
        if !(self.is_noise_stated() || is_estimated) {
            return None;
        }
        let position = square(position);
        let found = noise.normal_std_rad.map_or(0.0, square);
        // The fit's noise of normals includes the effect of position errors.
        let jets = self.samples().map(|sample| self.jet(sample));
        let bend = |jet: Jet| 0.5 * (jet.uu * jet.uu + 2.0 * jet.uv * jet.uv + jet.vv * jet.vv);
        let bending = jets.map(bend).sum::<f64>() / self.samples().count() as f64;
        Some(Variances {
            position,
            normal: stated.unwrap_or((found - bending * position).max(MIN_NORMAL_SHARE * found)),
        })
    }

    /// Whether all noise is stated.
    fn is_noise_stated(&self) -> bool {
        self.noise.is_complete_for(self.patch)
    }

    /// The tested contacts.
    fn samples(&self) -> impl Iterator<Item = &Sample> {
        self.patch.samples.iter().step_by(self.step())
    }

    /// Every how many contacts one is tested.
    fn step(&self) -> usize {
        self.patch.samples.len().div_ceil(MAX_CONTACTS).max(1)
    }

    fn jet(&self, sample: &Sample) -> Jet {
        self.fit.spline.jet(sample.u, sample.v)
    }

    /// Observations of a contact in standard deviations of its noise.
    fn weighted(&self, sample: &Sample, variances: Variances) -> Result<Weighted, Ep2Error> {
        let jet = self.jet(sample);
        let root = self
            .root(sample, &jet, variances)
            .ok_or(Ep2Error::OutOfRange)?;
        let rows = root.nrows();
        let [height, p, q] = self.quadric.at(&self.square, sample);
        let height = sample.w - height;
        let deviations = match sample.slopes {
            Some([along_u, along_v]) => vec![height, along_u - p, along_v - q],
            None => vec![height],
        };
        let slopes = series(self.square, self.degree, sample)
            .rows(0, rows)
            .into_owned();
        let values = DVector::from_vec(deviations);
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

    /// Cholesky factor of the covariance of a contact's height and slopes. A position error affects both.
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
        let rows = if sample.slopes.is_some() {
            OBSERVATIONS
        } else {
            1
        };
        let covariance = DMatrix::from_fn(rows, rows, |row, column| covariance[(row, column)]);
        Some(covariance.cholesky()?.l())
    }

    /// Sums over the contacts of products of patterns. A pattern is a function of a contact and of the jet there.
    fn products(
        &self,
        variances: Variances,
        patterns: usize,
        of: &dyn Fn(&Sample, &Jet) -> DMatrix<f64>,
    ) -> Result<Products, Ep2Error> {
        let mut products = Products {
            by_patterns: DMatrix::zeros(patterns, patterns),
            by_slopes: DMatrix::zeros(count(self.degree), patterns),
            by_values: DVector::zeros(patterns),
        };
        for sample in self.samples() {
            let weighted = self.weighted(sample, variances)?;
            let patterns = of(sample, &self.jet(sample));
            let patterns = weighted
                .root
                .solve_lower_triangular(&patterns)
                .ok_or(Ep2Error::OutOfRange)?;
            products.by_patterns += patterns.tr_mul(&patterns);
            products.by_slopes += weighted.slopes.tr_mul(&patterns);
            products.by_values += patterns.tr_mul(&weighted.values);
        }
        Ok(products)
    }

    fn sums(&self, variances: Variances) -> Result<Sums, Ep2Error> {
        let size = count(self.degree);
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

/// Products of Chebyshev polynomials at a contact, one in each column. The rows hold their values and their slopes along u
/// and v.
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
    let mut rows = DMatrix::zeros(OBSERVATIONS, count(degree));
    for (column, [i, j]) in products(degree).enumerate() {
        let ([of_a, slope_a], [of_b, slope_b]) = (along_a[i], along_b[j]);
        rows[(0, column)] = of_a * of_b;
        rows[(1, column)] = slope_a * of_b / half_u;
        rows[(2, column)] = of_a * slope_b / half_v;
    }
    rows
}
