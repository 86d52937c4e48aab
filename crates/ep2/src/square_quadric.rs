//! The square [−1, 1]² of a patch, and the quadric over this square that fits heights and slopes best.

use nalgebra::{SMatrix, SVector, SymmetricEigen};

use crate::knots::Knots;
use crate::noise::{Kinds, Noise, NoiseEstimate, Variances};
use crate::spline::Jet;
use crate::{Ep2Error, Patch, Sample};

/// Number of coefficients of a quadric: of 1, a, b, a², ab and b².
pub(crate) const UNKNOWNS: usize = 6;
/// Eigenvalues of the normal equations count as rounding errors if their ratio to the largest eigenvalue is below this
/// value.
const RANK_TOLERANCE: f64 = 1e-13;
/// The height of the implicit quadric z = Q(a, b) + m z²/2 contains the root √(1 − 2mQ). This root must be at least
/// this value, because the surface is vertical where the root is 0.
const MIN_ROOT: f64 = 0.2;
/// Standard deviation of the prior of the coefficient m, relative to the root mean square curvature of the surface.
const SQUARE_TERM_STD: f64 = 1.0;
/// Number of iterations of the fit. Each iteration computes the weights again from the noise and the slopes.
const ITERATIONS: usize = 4;

type Row = SVector<f64, UNKNOWNS>;
type Gram = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// The map between the rectangle of a patch and the square [−1, 1]². Fits in the square are well conditioned for any
/// ratio of the patch's length to its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Square {
    centre: [f64; 2],
    half: [f64; 2],
}

impl Square {
    pub(crate) fn of(patch: &Patch) -> Self {
        Self {
            centre: patch.domain.map(|[low, high]| 0.5 * low + 0.5 * high),
            half: patch.domain.map(|[low, high]| 0.5 * high - 0.5 * low),
        }
    }

    pub(crate) const fn centre(&self) -> [f64; 2] {
        self.centre
    }

    pub(crate) const fn half(&self) -> [f64; 2] {
        self.half
    }

    pub(crate) fn knots(&self, axis: usize, square: &Knots) -> Knots {
        let place = |knot: f64| self.centre[axis] + self.half[axis] * knot;
        let (start, end) = square.domain();
        let interior: Vec<f64> = square.interior().iter().map(|&knot| place(knot)).collect();
        Knots::new(square.degree(), place(start), place(end), &interior)
    }

    #[inline]
    pub(crate) fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let ([u0, v0], [half_u, half_v]) = (self.centre, self.half);
        [(u - u0) / half_u, (v - v0) / half_v]
    }
}

/// Matrix that converts the coefficients of 1, a, b, a², ab, b² to the coefficients of products of Chebyshev
/// polynomials.
#[rustfmt::skip]
pub(crate) const SERIES: Gram = Gram::new(
    1.0, 0.0, 0.0, 0.5, 0.0, 0.5,
    0.0, 1.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.5, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 1.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.5,
);

/// Root mean square, over all directions in the (a, b) plane, of a quadric's second derivative in a direction. `series`
/// contains the quadric as a series of Chebyshev polynomials.
pub(crate) fn rms_second_derivative(series: &[f64; UNKNOWNS]) -> f64 {
    let [aa, ab, bb] = [4.0 * series[3], series[4], 4.0 * series[5]];
    (0.5 * (aa * aa + 2.0 * ab * ab + bb * bb)).sqrt()
}

/// A quadric over the square, and the noise of the contacts, estimated from the contacts' distances to the quadric. In
/// general, the surface is the graph of an implicit quadric z = Q(a, b) + m z²/2, such as a sphere, an ellipsoid or a
/// cylinder.
#[derive(Clone, Debug)]
pub(crate) struct SquareQuadric {
    unknowns: Row,
    /// The coefficient m of the implicit quadric z = Q + m z²/2, in the patch's unit of length. It is 0 if the surface
    /// is the ordinary quadric z = Q.
    pub(crate) square_term: f64,
    /// Addition to the deviance (−2 ln of the likelihood), because m is unknown and has a prior; 0 for an ordinary quadric.
    pub(crate) square_term_deviance: f64,
    pub(crate) covariance: Gram,
    pub(crate) variances: Variances,
    pub(crate) noise: Option<NoiseEstimate>,
}

/// The prior of the coefficient m of an implicit quadric z = Q + m z²/2: a normal distribution.
///
/// Let k₁ and k₂ be the principal curvatures. The mean is (k₁³ + k₂³)/(k₁² + k₂²), which is the curvature of a sphere or
/// a cylinder. There, m equals this curvature. m is 0 for paraboloids, and the curvature times (a/c)² for an ellipsoid
/// with the semi-axes a along the surface and c perpendicular to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SquareTermPrior {
    pub(crate) mean: f64,
    pub(crate) std: f64,
}

/// The equations of a contact in the coordinates of the square: one for its height and, if it has a normal, one for
/// each slope along a and b. The weights are relative to the inverse variances of heights and slopes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observation {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) height: f64,
    pub(crate) height_weight: f64,
    pub(crate) slopes: [f64; 2],
    pub(crate) slope_weights: [f64; 2],
}

/// Normal equations for the coefficients of the quadric. The equations of heights and of slopes are stored separately,
/// and are for observations with variance 1.
#[derive(Default)]
struct NormalEquations {
    grams: Kinds<Gram>,
    right_sides: Kinds<Row>,
    squares: Kinds<f64>,
    of_square_term: SquareTerm,
}

/// The part of the normal equations that belongs to the coefficient m of the implicit quadric z = Q + m z²/2: the
/// products of the column of m with the other columns, its sum of squares, and its right side.
#[derive(Default)]
struct SquareTerm {
    products: Kinds<Row>,
    squares: Kinds<f64>,
    right_sides: Kinds<f64>,
}

impl SquareQuadric {
    /// The quadric that fits the patch best. `known` is the stated noise of the contacts.
    pub(crate) fn of(patch: &Patch, square: &Square, known: &Noise) -> Result<Self, Ep2Error> {
        if patch.equations() < UNKNOWNS {
            return Err(Ep2Error::TooFewContacts {
                contacts: patch.samples.len(),
                equations: patch.equations(),
                needed: UNKNOWNS,
            });
        }
        let mut quadric = Self {
            unknowns: Row::zeros(),
            square_term: 0.0,
            square_term_deviance: 0.0,
            covariance: Gram::zeros(),
            variances: Variances::START,
            noise: None,
        };
        let iterations = if patch.has_normals() { ITERATIONS } else { 2 };
        for _ in 0..iterations {
            let equations = NormalEquations::around(&quadric, patch, square, false);
            quadric.improve(&equations, None, patch, square, known)?;
        }
        Ok(quadric)
    }

    /// The implicit quadric z = Q + m z²/2 that fits the patch best, and the prior of m. The search starts at `self`.
    /// `None` if the surface is flat, or if the implicit quadric has no height z at some point of the patch.
    pub(crate) fn with_square_term(
        mut self,
        patch: &Patch,
        square: &Square,
        known: &Noise,
    ) -> Option<(Self, SquareTermPrior)> {
        let prior = self.square_term_prior(square);
        if !(prior.std * prior.std).is_normal() {
            return None;
        }
        for _ in 0..ITERATIONS {
            let equations = NormalEquations::around(&self, patch, square, true);
            self.improve(&equations, Some(prior), patch, square, known)
                .ok()?;
            let sides = || (-2..=2).map(|step| 0.5 * f64::from(step));
            let mut places = sides().flat_map(|a| sides().map(move |b| (a, b)));
            let is_graph = places.all(|(a, b)| self.shape(a, b).1 > MIN_ROOT);
            if !is_graph {
                return None;
            }
        }
        Some((self, prior))
    }

    fn square_term_prior(&self, square: &Square) -> SquareTermPrior {
        let [uu, uv, vv] = self.second_derivatives(square);
        let (sum, product) = (uu + vv, uu * vv - uv * uv);
        let squares = sum * sum - 2.0 * product;
        SquareTermPrior {
            mean: sum * (sum * sum - 3.0 * product) / squares,
            std: SQUARE_TERM_STD * (0.5 * squares).sqrt(),
        }
    }

    /// Adds the solution of the equations to the quadric z = Q + m z²/2, and estimates the noise again. The coefficient
    /// m changes only if its prior is given.
    fn improve(
        &mut self,
        equations: &NormalEquations,
        prior: Option<SquareTermPrior>,
        patch: &Patch,
        square: &Square,
        known: &Noise,
    ) -> Result<(), Ep2Error> {
        let Kinds { heights, slopes } = self.variances;
        let gram = equations.grams.heights / heights + equations.grams.slopes / slopes;
        let right = equations.right_sides.heights / heights + equations.right_sides.slopes / slopes;
        self.covariance = inverse(&gram, patch.samples.len())?;
        let mut change = self.covariance * right;
        let mut of_square_term = 0.0;
        if let Some(SquareTermPrior { mean, std }) = prior {
            let term = &equations.of_square_term;
            let both = |kinds: &Kinds<f64>| kinds.heights / heights + kinds.slopes / slopes;
            let products = term.products.heights / heights + term.products.slopes / slopes;
            let replaced = self.covariance * products;
            let per_prior = (std * std).recip();
            let information = both(&term.squares) - products.dot(&replaced) + per_prior;
            let right = both(&term.right_sides) - replaced.dot(&right);
            of_square_term = (right + (mean - self.square_term) * per_prior) / information;
            let distance = (self.square_term + of_square_term - mean) / std;
            self.square_term_deviance = distance * distance + libm::log(information / per_prior);
            change -= replaced * of_square_term;
        }
        self.unknowns += change;
        self.square_term += of_square_term;
        let residual = |kind: fn(&Kinds<f64>) -> f64, right: &Row, gram: &Gram, products: &Row| {
            let term = &equations.of_square_term;
            let of_term = of_square_term * kind(&term.squares) + 2.0 * products.dot(&change)
                - 2.0 * kind(&term.right_sides);
            let square = kind(&equations.squares) - 2.0 * change.dot(right);
            (square + change.dot(&(gram * change)) + of_square_term * of_term).max(0.0)
        };
        let (right, grams) = (&equations.right_sides, &equations.grams);
        let products = &equations.of_square_term.products;
        let residuals = Kinds {
            heights: residual(
                |k| k.heights,
                &right.heights,
                &grams.heights,
                &products.heights,
            ),
            slopes: residual(|k| k.slopes, &right.slopes, &grams.slopes, &products.slopes),
        };
        let unknowns = Kinds {
            heights: (self.covariance * equations.grams.heights).trace() / heights,
            slopes: (self.covariance * equations.grams.slopes).trace() / slopes,
        };
        let bending = self.mean_square_curvature(square);
        let is_determined = self
            .variances
            .update(known, bending, patch, &residuals, &unknowns);
        self.noise = is_determined.then(|| self.variances.estimate(patch, known));
        let mut numbers = self.unknowns.iter().chain(&self.covariance);
        match numbers.all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(Ep2Error::OutOfRange),
        }
    }

    /// On the surface z = Q + m z²/2: the value of Q and its slopes along a and b, and the root √(1 − 2mQ).
    #[inline]
    fn shape(&self, a: f64, b: f64) -> ([f64; 3], f64) {
        let c = &self.unknowns;
        let quadric = [
            c[0] + a * (c[1] + a * c[3] + b * c[4]) + b * (c[2] + b * c[5]),
            c[1] + 2.0 * a * c[3] + b * c[4],
            c[2] + a * c[4] + 2.0 * b * c[5],
        ];
        let square = 1.0 - 2.0 * self.square_term * quadric[0];
        (quadric, square.max(MIN_ROOT * MIN_ROOT).sqrt())
    }

    #[inline]
    pub(crate) fn value_and_slopes(&self, a: f64, b: f64) -> [f64; 3] {
        let ([value, along_a, along_b], root) = self.shape(a, b);
        [2.0 * value / (1.0 + root), along_a / root, along_b / root]
    }

    pub(crate) fn by_square_term(&self, a: f64, b: f64) -> f64 {
        let ([value, ..], root) = self.shape(a, b);
        let height = 2.0 * value / (1.0 + root);
        height * height / (2.0 * root)
    }

    /// Adds height, slopes and second derivatives of this surface to `jet`, in the patch's unit. `place` is a place in
    /// the rectangle of the patch.
    pub(crate) fn add_to(&self, jet: &mut Jet, square: &Square, place: [f64; 2]) {
        let [a, b] = square.place(place);
        let [half_u, half_v] = square.half();
        let ([value, along_a, along_b], root) = self.shape(a, b);
        let (along_u, along_v) = (along_a / half_u, along_b / half_v);
        let bend = self.square_term / (root * root * root);
        let c = &self.unknowns;
        jet.w += 2.0 * value / (1.0 + root);
        jet.u += along_u / root;
        jet.v += along_v / root;
        jet.uu += 2.0 * c[3] / (half_u * half_u * root) + bend * along_u * along_u;
        jet.uv += c[4] / (half_u * half_v * root) + bend * along_u * along_v;
        jet.vv += 2.0 * c[5] / (half_v * half_v * root) + bend * along_v * along_v;
    }

    /// Height of the quadric at a contact, and its slopes along u and v.
    pub(crate) fn at(&self, square: &Square, sample: &Sample) -> [f64; 3] {
        let [a, b] = square.place([sample.u, sample.v]);
        let [half_u, half_v] = square.half();
        let [height, along_a, along_b] = self.value_and_slopes(a, b);
        [height, along_a / half_u, along_b / half_v]
    }

    /// The deviations of a patch's contacts from this quadric in height and slope, with their weights.
    ///
    /// An error of a contact's position along the normal causes an error of its height that is larger by the factor √D.
    /// Here D = 1 + p² + q², and p and q are the slopes. A tilt of the normal by a small angle changes the slope p
    /// along u by √(D(1 + p²)) times this angle.
    pub(crate) fn observations<'a>(
        &'a self,
        patch: &'a Patch,
        square: &'a Square,
    ) -> impl Iterator<Item = Observation> + 'a {
        let [half_u, half_v] = square.half();
        patch.samples.iter().map(move |sample| {
            let [a, b] = square.place([sample.u, sample.v]);
            let [height, slope_a, slope_b] = self.value_and_slopes(a, b);
            let (p, q) = (slope_a / half_u, slope_b / half_v);
            let steepness = 1.0 + p * p + q * q;
            let height_weight = sample.weight / steepness;
            let (slopes, slope_weights) = match sample.slopes {
                Some([along_u, along_v]) => (
                    [along_u * half_u - slope_a, along_v * half_v - slope_b],
                    [
                        height_weight / (half_u * half_u * (1.0 + p * p)),
                        height_weight / (half_v * half_v * (1.0 + q * q)),
                    ],
                ),
                None => ([0.0; 2], [0.0; 2]),
            };
            Observation {
                a,
                b,
                height: sample.w - height,
                height_weight,
                slopes,
                slope_weights,
            }
        })
    }

    pub(crate) fn series(&self) -> [f64; UNKNOWNS] {
        (SERIES * self.unknowns).into()
    }

    /// Mean square, over all directions in the (u, v) plane of the patch, of the quadric's second derivative in a
    /// direction.
    pub(crate) fn mean_square_curvature(&self, square: &Square) -> f64 {
        let [uu, uv, vv] = self.second_derivatives(square);
        0.5 * (uu * uu + 2.0 * uv * uv + vv * vv)
    }

    /// Second derivatives of Q along u², uv and v², in the patch's unit.
    fn second_derivatives(&self, square: &Square) -> [f64; 3] {
        let [half_u, half_v] = square.half();
        [
            2.0 * self.unknowns[3] / (half_u * half_u),
            self.unknowns[4] / (half_u * half_v),
            2.0 * self.unknowns[5] / (half_v * half_v),
        ]
    }

    pub(crate) fn spline_coefficients(&self, a: &Knots, b: &Knots) -> Vec<f64> {
        (0..a.functions() * b.functions())
            .map(|index| coefficient(&self.unknowns, a, b, index))
            .collect()
    }
}

impl NormalEquations {
    /// Sums the equations for the deviations of a patch's contacts from `quadric`. The equations of the coefficient m
    /// are summed only if `with_term`.
    fn around(quadric: &SquareQuadric, patch: &Patch, square: &Square, with_term: bool) -> Self {
        let mut equations = Self::default();
        let Self {
            grams,
            right_sides,
            squares,
            of_square_term: term,
        } = &mut equations;
        let has_normals = patch.has_normals();
        for one in quadric.observations(patch, square) {
            let (a, b) = (one.a, one.b);
            let ([value, slope_a, slope_b], root) = quadric.shape(a, b);
            let (per_root, cube) = (1.0 / root, root * root * root);
            let of_term = quadric.by_square_term(a, b);
            let height = Row::new(1.0, a, b, a * a, a * b, b * b) * per_root;
            let weighted = height * one.height_weight;
            if with_term {
                term.products.heights += weighted * of_term;
                term.squares.heights += one.height_weight * of_term * of_term;
                term.right_sides.heights += one.height_weight * of_term * one.height;
            }
            grams.heights += weighted * height.transpose();
            right_sides.heights += weighted * one.height;
            squares.heights += one.height_weight * one.height * one.height;
            if has_normals {
                let along_a = Row::new(0.0, 1.0, 0.0, 2.0 * a, b, 0.0);
                let along_b = Row::new(0.0, 0.0, 1.0, 0.0, a, 2.0 * b);
                let slopes = one.slopes.into_iter().zip(one.slope_weights);
                let rows = [(along_a, slope_a), (along_b, slope_b)];
                for ((row, bend), (slope, weight)) in rows.into_iter().zip(slopes) {
                    let bend = bend / cube;
                    let row = row * per_root + height * (root * quadric.square_term * bend);
                    let of_term = value * bend;
                    let weighted = row * weight;
                    if with_term {
                        term.products.slopes += weighted * of_term;
                        term.squares.slopes += weight * of_term * of_term;
                        term.right_sides.slopes += weight * of_term * slope;
                    }
                    grams.slopes += weighted * row.transpose();
                    right_sides.slopes += weighted * slope;
                    squares.slopes += weight * slope * slope;
                }
            }
        }
        equations
    }
}

fn inverse(gram: &Gram, contacts: usize) -> Result<Gram, Ep2Error> {
    let eigen = SymmetricEigen::new(*gram);
    let largest = eigen.eigenvalues.max();
    if !(largest > 0.0 && largest.is_finite()) {
        return Err(Ep2Error::OutOfRange);
    }
    let rank = eigen
        .eigenvalues
        .iter()
        .filter(|&&value| value > RANK_TOLERANCE * largest)
        .count();
    if rank < UNKNOWNS {
        return Err(Ep2Error::Undetermined {
            contacts,
            rank,
            unknowns: UNKNOWNS,
        });
    }
    let vectors = eigen.eigenvectors;
    Ok(vectors * Gram::from_diagonal(&eigen.eigenvalues.map(f64::recip)) * vectors.transpose())
}

/// Coefficient number `index` of the spline that equals a quadric. It is the sum over the quadric's monomials of the
/// spline coefficient of each monomial. The spline coefficient of a monomial is the mean of products of different inner
/// knots of the B-spline (the blossom of the monomial). Each product has as many factors as the degree of the monomial.
fn coefficient(unknowns: &Row, a: &Knots, b: &Knots, index: usize) -> f64 {
    let (a1, a2) = blossoms(a, index / b.functions());
    let (b1, b2) = blossoms(b, index % b.functions());
    unknowns.dot(&Row::new(1.0, a1, b1, a2, a1 * b1, b2))
}

/// The spline coefficients of the functions x and x², for the B-spline with the index `function`.
fn blossoms(knots: &Knots, function: usize) -> (f64, f64) {
    let inner = &knots.as_slice()[function + 1..=function + knots.degree()];
    let count = inner.len() as f64;
    let sum: f64 = inner.iter().sum();
    let squares: f64 = inner.iter().map(|knot| knot * knot).sum();
    (sum / count, (sum * sum - squares) / (count * (count - 1.0)))
}
