//! Tests of a fit against contacts that contradict it.
//!
//! The surface is a quadric plus a process of a known covariance, the contacts' errors are those of positions and normals to
//! first order. Where the noise outweighs the process, what is left of the contacts in standard deviations is distributed as
//! chi-squared, whatever the surface is where the process outweighs the noise. Rao's score test asks how much would be
//! explained if a pattern were fitted too, with quadric and process as nuisance.

mod score_test;

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector3};
use palpate_statistics::least_likely;

use crate::chebyshev::{count, products, values};
use crate::doubt::Agreement;
use crate::patch::Sample;
use crate::square::Square;
use crate::square_quadric::SquareQuadric;
use crate::{Doubt, Ep2Error, Fit, Jet, Noise, Patch};
pub(crate) use score_test::Process;
use score_test::{ContactRest, Products, Rest, Sums, Test, Weighted};

/// Observations of a contact: its height, and both slopes.
const OBSERVED: usize = 3;
/// Patterns of normals: of their slopes, turns about both tangents and linear maps; of heights, quadrics, which are the same turns
/// and some of these maps where noise leaves more of heights than of slopes.
const OF_NORMALS: usize = 11;
/// Share of the doubts about normals that the roughness of the positions alone may make by chance, of which they tell less.
const SHARE_APART: f64 = 0.1;
/// Fewest contacts that tell noise from patterns.
const FEWEST: usize = 10;
/// Most contacts that are tested: of more, as many are taken evenly, which takes no longer than a fit.
const MOST_CONTACTS: usize = 2000;
/// Most fingers that are tested one by one.
const MOST_FINGERS: usize = 64;
/// Most fingers for each of which the roughness is found anew: those that seem displaced most.
const MOST_APART: usize = 8;
/// Noise of positions that is found below which it may be rounding, or what the series does not follow, in the patch's unit.
const ROUNDING: f64 = 1e-4;
/// Least share of the noise of normals that is found that is not from positions.
const OWN: f64 = 0.1;

/// Fit whose agreement with its contacts is asked for.
pub(crate) struct Model<'a> {
    pub(crate) patch: &'a Patch,
    pub(crate) square: Square,
    pub(crate) fit: &'a Fit,
    /// Quadric that is as good a part of the fit as any: what is beside it keeps more digits.
    pub(crate) quadric: &'a SquareQuadric,
    /// Noise that is stated.
    pub(crate) told: &'a Noise,
    /// Degree of the series that the surface is.
    pub(crate) degree: usize,
}

/// Part of the contacts that contradicts the rest, and is no sign of roughness then.
#[derive(Clone, Copy)]
pub(crate) enum Apart {
    /// The finger of this number, of which the distance from the others is not known.
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
    /// Goodness of fit and doubts, by the process that is likeliest, and by that which is where something stands `apart`.
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] where the numbers leave the range of doubles.
    pub(crate) fn agreement(
        &self,
        processes: &[(f64, Process)],
        apart: impl Fn(Apart) -> Result<Vec<(f64, Process)>, Ep2Error>,
    ) -> Result<Agreement, Ep2Error> {
        let (Some(variances), Some((_, process))) = (self.variances(), processes.first()) else {
            return Ok(Agreement::default());
        };
        let sums = self.sums(variances)?;
        let test = Test::new(process, &sums, self.is_noise_told())?;
        let goodness = self.is_noise_told().then_some(test.goodness);
        let (finger, displaced) = self.displaced(&test, variances, &sums, &apart)?;
        let (contact, stray) = self.stray(&test, variances)?;
        let doubts = [
            Doubt::LargeResiduals {
                p_value: goodness.map_or(1.0, |goodness| goodness.p_value),
            },
            Doubt::ContradictingNormals {
                p_value: self.of_normals(&test, variances, &sums, &apart)?,
            },
            Doubt::NotAQuadric {
                p_value: self.of_powers(&test, variances)?,
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

    /// Probability by chance that the normals differ as much from the slopes that the positions tell: those of the quadric
    /// through the positions, since a fit follows normals too, whatever they are.
    fn of_normals(
        &self,
        test: &Test<'_>,
        variances: Variances,
        sums: &Sums,
        apart: impl Fn(Apart) -> Result<Vec<(f64, Process)>, Ep2Error>,
    ) -> Result<f64, Ep2Error> {
        if !self.patch.has_normals() {
            return Ok(1.0);
        }
        let positions = self.patch.of_positions();
        let known = self.told.in_patch(&self.patch.frame)?;
        let quadric = SquareQuadric::of(&positions, &self.square, &known).ok();
        let patterns = |sample: &Sample, jet: &Jet| {
            let of_quadric = |quadric: &SquareQuadric| quadric.at(&self.square, sample);
            let [_, p, q] = quadric.as_ref().map_or([jet.w, jet.u, jet.v], of_quadric);
            let (u, v) = (sample.u, sample.v);
            DMatrix::from_row_slice(
                OBSERVED,
                OF_NORMALS,
                &[
                    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, u, v, u * u, u * v, v * v],
                    [1.0, 0.0, p, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                    [0.0, 1.0, 0.0, 0.0, p, q, 0.0, 0.0, 0.0, 0.0, 0.0],
                ]
                .concat(),
            )
        };
        let products = self.products(variances, OF_NORMALS, &patterns)?;
        let chance = test.chance_of(&products);
        match apart(Apart::Normals) {
            Ok(processes) => {
                let apart = self.chance_by(&processes, sums, &products)?;
                Ok((chance / (1.0 - SHARE_APART))
                    .min(apart / SHARE_APART)
                    .min(1.0))
            }
            Err(_) => Ok(chance),
        }
    }

    /// Probability by chance of as much of third and fourth powers of the place as the contacts have beside a quadric; 1 of other
    /// surfaces, which follow them.
    fn of_powers(&self, test: &Test<'_>, variances: Variances) -> Result<f64, Ep2Error> {
        if self.degree > 2 {
            return Ok(1.0);
        }
        let (quadrics, powers) = (count(2), count(4) - count(2));
        let patterns = |sample: &Sample, _: &Jet| {
            let rows = if sample.slopes.is_some() { OBSERVED } else { 1 };
            let all = series(self.square, 4, sample);
            all.view((0, quadrics), (rows, powers)).into_owned()
        };
        Ok(test.chance_of(&self.products(variances, powers, &patterns)?))
    }

    /// The finger that is displaced most, and the probability that chance displaces one of all as far. A finger that is displaced
    /// makes the surface seem rougher than it is, so that it is judged by the roughness that the others tell.
    fn displaced(
        &self,
        test: &Test<'_>,
        variances: Variances,
        sums: &Sums,
        apart: impl Fn(Apart) -> Result<Vec<(f64, Process)>, Ep2Error>,
    ) -> Result<(usize, f64), Ep2Error> {
        let fingers: BTreeSet<usize> = self.samples().map(|sample| sample.finger).collect();
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
        let products = self.products(variances, fingers.len(), &patterns)?;
        let ones = fingers.iter().enumerate();
        let mut chances: Vec<(usize, f64, Products)> = ones
            .map(|(place, &finger)| {
                let one = products.of(place);
                (finger, test.chance_of(&one), one)
            })
            .collect();
        chances.sort_by(|(_, one, _), (_, other, _)| one.total_cmp(other));
        for (finger, chance, one) in chances.iter_mut().take(MOST_APART) {
            if let Ok(processes) = apart(Apart::Finger(*finger)) {
                *chance = self.chance_by(&processes, sums, one)?;
            }
        }
        let chances = chances.iter().map(|(finger, chance, _)| (*finger, *chance));
        Ok(least_likely(chances))
    }

    /// Probability by chance of as much of patterns, in the mean over processes by their probabilities.
    fn chance_by(
        &self,
        processes: &[(f64, Process)],
        sums: &Sums,
        products: &Products,
    ) -> Result<f64, Ep2Error> {
        let mut chance = 0.0;
        for (share, process) in processes {
            let test = Test::new(process, sums, self.is_noise_told())?;
            chance += share * test.chance_of(products);
        }
        Ok(chance.min(1.0))
    }

    /// The contact that contradicts the others most, and the probability that chance makes one of all do as much. Where noise is
    /// found, a contact that is far off spoils that of positions and with it that of normals, and makes the surface seem rough:
    /// heights count beside heights then, and slopes beside slopes, each by as much as the fit leaves of it.
    fn stray(&self, test: &Test<'_>, variances: Variances) -> Result<(usize, f64), Ep2Error> {
        let mut far = Vec::new();
        for (place, sample) in self.samples().enumerate() {
            far.push((place, test.rest(&self.weighted(sample, variances)?)));
        }
        let sums = far
            .iter()
            .fold([Rest::default(); 2], |[heights, slopes], (_, rest)| {
                let [height, slope] = rest.by_kind;
                [heights.plus(height), slopes.plus(slope)]
            });
        let chance = |(place, rest): &(usize, ContactRest)| {
            let chance = match test.is_noise_trusted {
                true => rest.all.p_value(),
                false => {
                    let kinds = rest.by_kind.iter().zip(&sums);
                    let kinds = kinds.filter(|(own, _)| own.is_there());
                    least_likely(kinds.map(|(own, all)| (*place, own.chance_beside(all)))).1
                }
            };
            (place * self.step(), chance)
        };
        Ok(least_likely(far.iter().map(chance)))
    }

    /// Variances of the contacts; `None` where they are found and nothing tells them from rounding, or of too few contacts.
    fn variances(&self) -> Option<Variances> {
        let noise = self.fit.noise?;
        let square = |std: f64| std * std;
        let told = self.told.normal_std_rad.map(square);
        let position = self.told.position_std.unwrap_or(noise.position_std);
        let position = position / self.fit.frame.scale();
        let is_told = position > ROUNDING && self.patch.samples.len() >= FEWEST;
        if !(self.is_noise_told() || is_told) {
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
        self.patch.samples.iter().step_by(self.step())
    }

    /// Number of contacts of which one is tested.
    fn step(&self) -> usize {
        self.patch.samples.len().div_ceil(MOST_CONTACTS).max(1)
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

    /// Sums over the contacts of products of patterns, each of an observation with the jet there.
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
