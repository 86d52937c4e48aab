//! The light of the background as a function of the position in the frame. For each colour, it is a polynomial of
//! degree four that is fitted to the area between the markers.

use nalgebra::{SMatrix, SVector};

use crate::binning::BinnedFrame;
use crate::image_circle::Mask;

/// Exponents of x and y in the terms of the polynomial, up to a total degree of four.
const POWERS: [(i32, i32); 15] = [
    (0, 0),
    (1, 0),
    (0, 1),
    (2, 0),
    (1, 1),
    (0, 2),
    (3, 0),
    (2, 1),
    (1, 2),
    (0, 3),
    (4, 0),
    (3, 1),
    (2, 2),
    (1, 3),
    (0, 4),
];
/// Side (in bins) of the square patches into which the frame is divided. The mean colour of the background in each
/// patch is used in the fit of the polynomial.
const PATCH: usize = 8;
/// Weight of the regularisation in the fit of the polynomial, relative to the weight of all patches of background. The
/// regularisation keeps the polynomial small in areas where no background is visible.
const REGULARISATION: f64 = 1e-7;
/// Largest accepted deviation of the mean colour of a patch (a square part of the frame) from the fitted light, in
/// standard deviations. The standard deviation is estimated as 1.5 times the median deviation of all patches. Patches
/// with a larger deviation are not used in the fit.
const MAX_DEVIATION: f64 = 3.0;

type Terms = SVector<f64, 15>;

/// The colour of the background as a function of the position in the frame. Colours are in levels (0 to 255).
#[derive(Clone, Debug)]
pub(crate) struct Lighting {
    centre: [f64; 2],
    radius: f64,
    terms: [Terms; 3],
    /// Standard deviation of the noise of each colour of a pixel, in levels (0 to 255).
    pub(crate) noise: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    value: f64,
    slope: [f64; 2],
    /// Second-order coefficients of the Taylor expansion of the background's colour: half the derivative ∂²/∂x², the
    /// mixed derivative ∂²/∂x∂y, and half the derivative ∂²/∂y².
    bend: [f64; 3],
}

impl Local {
    /// The brightness of the background along a row of pixels, as a polynomial in x: its constant, linear and quadratic
    /// coefficient. The row is `dy` rows below the point about which the light was expanded as a Taylor series.
    pub(crate) fn row(&self, dy: f64) -> [f32; 3] {
        [
            (self.value + dy * (self.slope[1] + dy * self.bend[2])) as f32,
            (self.slope[0] + dy * self.bend[1]) as f32,
            self.bend[0] as f32,
        ]
    }
}

struct Patch {
    count: f64,
    terms: Terms,
    colour: [f64; 3],
}

impl Lighting {
    /// Fits the polynomial of the light to the bins for which `ground` is true, that is, which show only the
    /// background.
    pub(crate) fn fit(binned: &BinnedFrame, ground: &[bool], mask: &Mask) -> Self {
        let mut lighting = Self {
            centre: mask.centre_px,
            radius: mask
                .radius_px
                .min((binned.width + binned.height) as f64 * binned.bin as f64),
            terms: [Terms::zeros(); 3],
            noise: noise(binned, ground),
        };
        let patches = lighting.patches(binned, ground);
        let everywhere = vec![true; patches.len()];
        lighting.solve(&patches, &everywhere);
        let deviations = patches.iter().map(|patch| lighting.deviation(patch));
        let deviations: Vec<f64> = deviations.collect();
        let mut sorted = deviations.clone();
        sorted.sort_by(f64::total_cmp);
        let typical = sorted
            .get(sorted.len() / 2)
            .copied()
            .unwrap_or(0.0)
            .max(1e-3);
        let limit = MAX_DEVIATION * 1.5 * typical;
        let used: Vec<bool> = deviations.iter().map(|&one| one <= limit).collect();
        lighting.solve(&patches, &used);
        lighting
    }

    pub(crate) fn about(&self, place: [f64; 2], colour: usize) -> Local {
        let [x, y] = [0, 1].map(|axis| (place[axis] - self.centre[axis]) / self.radius);
        let power = |base: f64, power: i32| match power {
            ..0 => 0.0,
            _ => (0..power).fold(1.0, |product, _| product * base),
        };
        let (mut value, mut slope, mut bend) = (0.0, [0.0; 2], [0.0; 3]);
        for (&(i, j), &term) in POWERS.iter().zip(&self.terms[colour]) {
            let (m, n) = (f64::from(i), f64::from(j));
            value += term * power(x, i) * power(y, j);
            slope[0] += term * m * power(x, i - 1) * power(y, j);
            slope[1] += term * n * power(x, i) * power(y, j - 1);
            bend[0] += 0.5 * term * m * (m - 1.0) * power(x, i - 2) * power(y, j);
            bend[1] += term * m * n * power(x, i - 1) * power(y, j - 1);
            bend[2] += 0.5 * term * n * (n - 1.0) * power(x, i) * power(y, j - 2);
        }
        Local {
            value,
            slope: slope.map(|slope| slope / self.radius),
            bend: bend.map(|bend| bend / (self.radius * self.radius)),
        }
    }

    fn terms_at(&self, place: [f64; 2]) -> Terms {
        let [x, y] = [0, 1].map(|axis| (place[axis] - self.centre[axis]) / self.radius);
        let (x2, y2) = (x * x, y * y);
        Terms::from([
            1.0,
            x,
            y,
            x2,
            x * y,
            y2,
            x2 * x,
            x2 * y,
            x * y2,
            y2 * y,
            x2 * x2,
            x2 * x * y,
            x2 * y2,
            x * y * y2,
            y2 * y2,
        ])
    }

    fn patches(&self, binned: &BinnedFrame, ground: &[bool]) -> Vec<Patch> {
        let across = binned.width.div_ceil(PATCH);
        let mut sums = vec![[0u32; 6]; across];
        let mut patches = Vec::with_capacity(across * binned.height.div_ceil(PATCH));
        let rows = binned
            .sums
            .chunks_exact(binned.width)
            .zip(ground.chunks_exact(binned.width));
        // Use only every second row of bins, because half of the rows is enough for the fit.
        for (y, (colours, ground)) in rows.enumerate().skip(1).step_by(2) {
            let stripes = colours
                .chunks(PATCH)
                .zip(ground.chunks(PATCH))
                .zip(&mut sums);
            for ((colours, ground), sums) in stripes {
                for (x, (colour, _)) in (0..)
                    .zip(colours.iter().zip(ground))
                    .filter(|(_, (_, ground))| **ground)
                {
                    sums[0] += 1;
                    sums[1] += x;
                    sums[2] += (y % PATCH) as u32;
                    for (sum, &colour) in sums[3..].iter_mut().zip(colour) {
                        *sum += u32::from(colour);
                    }
                }
            }
            if y % PATCH == PATCH - 1 || y + 2 >= binned.height {
                for (column, sums) in sums.iter_mut().enumerate().filter(|(_, sums)| sums[0] > 0) {
                    let count = f64::from(sums[0]);
                    let place = [
                        (column * PATCH) as f64 + f64::from(sums[1]) / count,
                        (y - y % PATCH) as f64 + f64::from(sums[2]) / count,
                    ];
                    let bin = binned.bin as f64;
                    patches.push(Patch {
                        count,
                        terms: self.terms_at(place.map(|at| at * bin + 0.5 * (bin - 1.0))),
                        colour: [3, 4, 5]
                            .map(|at| f64::from(sums[at]) / (count * binned.pixels() as f64)),
                    });
                    *sums = [0; 6];
                }
            }
        }
        patches
    }

    fn solve(&mut self, patches: &[Patch], used: &[bool]) {
        let mut normal = SMatrix::<f64, 15, 15>::zeros();
        let mut right = [Terms::zeros(); 3];
        let mut count = 0.0;
        for (patch, _) in patches.iter().zip(used).filter(|(_, used)| **used) {
            count += patch.count;
            normal.syger(patch.count, &patch.terms, &patch.terms, 1.0);
            for (right, &colour) in right.iter_mut().zip(&patch.colour) {
                *right += patch.terms * (patch.count * colour);
            }
        }
        for at in 0..15 {
            let weight = if at == 0 { 0.0 } else { REGULARISATION };
            normal[(at, at)] += weight * count;
        }
        normal.fill_upper_triangle_with_lower_triangle();
        if let Some(factor) = normal.cholesky() {
            self.terms = right.map(|right| factor.solve(&right));
        } else if count > 0.0 {
            self.terms = [0, 1, 2].map(|colour| {
                let mut flat = Terms::zeros();
                flat[0] = right[colour][0] / count;
                flat
            });
        }
    }

    /// Deviation of a patch's mean colour from the fitted light, multiplied by the square root of the share of the
    /// patch that shows the background. With this factor, patches with little background count less, because their mean
    /// colour is an average of fewer bins (blocks of pixels) and has more noise.
    fn deviation(&self, patch: &Patch) -> f64 {
        let square: f64 = [0, 1, 2]
            .map(|colour| (self.terms[colour].dot(&patch.terms) - patch.colour[colour]).powi(2))
            .iter()
            .sum();
        (square * patch.count / (PATCH * PATCH) as f64).sqrt()
    }
}

/// Standard deviation of the noise of a pixel in one colour, in levels (0 to 255). It is computed from the median
/// colour difference between neighbouring background bins; a colour difference is the root of the summed squared
/// differences of red, green and blue. If the noise of the three colours is independent and normally distributed, this
/// median is 1.5382 √2 times the standard deviation of one colour of a bin.
fn noise(binned: &BinnedFrame, ground: &[bool]) -> f64 {
    let mut differences: Vec<i32> = Vec::new();
    let rows = binned
        .sums
        .chunks_exact(binned.width)
        .zip(ground.chunks_exact(binned.width));
    for (colours, ground) in rows.step_by(4) {
        let pairs = colours.as_chunks::<2>().0.iter();
        let pairs = pairs.zip(ground.as_chunks::<2>().0).step_by(2);
        differences.extend(pairs.filter(|(_, ground)| **ground == [true; 2]).map(
            |([one, other], _)| {
                let difference = |at: usize| i32::from(one[at]) - i32::from(other[at]);
                (0..3).map(|at| difference(at).pow(2)).sum::<i32>()
            },
        ));
    }
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let (_, &mut median, _) = differences.select_nth_unstable(middle);
    f64::from(median).sqrt() / (1.5382 * std::f64::consts::SQRT_2 * binned.bin as f64)
}
