//! The ground's light over a frame: a polynomial of degree four in either colour, fitted where no marker is.

use nalgebra::{SMatrix, SVector};

use crate::binned::Binned;
use crate::image_circle::Mask;

/// Powers of x and y up to the fourth degree together.
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
/// Side of the squares over which the ground is averaged before it is fitted.
const PATCH: usize = 8;
/// Weight that holds the polynomial back where there is no ground, as a share of the patches.
const HOLD: f64 = 1e-7;
/// Standard deviations a patch may stray from the light.
const STRAY: f64 = 3.0;

type Terms = SVector<f64, 15>;

/// The ground's colours, in 0 to 255, as a function of the place in the frame.
#[derive(Clone, Debug)]
pub(crate) struct Lighting {
    centre: [f64; 2],
    radius: f64,
    /// Coefficients of the polynomial of each colour (red, green, blue), in the order of [`POWERS`].
    terms: [Terms; 3],
    /// Standard deviation of a pixel's colour, 0 to 255, from one pixel to the next.
    pub(crate) noise: f64,
}

/// Value, slopes and second derivatives of a colour of the ground about a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    value: f64,
    slope: [f64; 2],
    /// Second derivatives by xx, xy and yy, the first and last halved.
    bend: [f64; 3],
}

impl Local {
    /// The polynomial in x along the row `dy` below the place: its constant, linear and quadratic term.
    pub(crate) fn row(&self, dy: f64) -> [f32; 3] {
        [
            (self.value + dy * (self.slope[1] + dy * self.bend[2])) as f32,
            (self.slope[0] + dy * self.bend[1]) as f32,
            self.bend[0] as f32,
        ]
    }
}

/// Averages of the ground over one square.
struct Patch {
    count: f64,
    terms: Terms,
    colour: [f64; 3],
}

impl Lighting {
    /// Fits the squares of a frame for which `ground` is true.
    pub(crate) fn fit(binned: &Binned, ground: &[bool], mask: &Mask) -> Self {
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
        let strays: Vec<f64> = patches.iter().map(|patch| lighting.stray(patch)).collect();
        let mut sorted = strays.clone();
        sorted.sort_by(f64::total_cmp);
        let typical = sorted
            .get(sorted.len() / 2)
            .copied()
            .unwrap_or(0.0)
            .max(1e-3);
        let kept: Vec<bool> = strays
            .iter()
            .map(|&stray| stray <= STRAY * 1.5 * typical)
            .collect();
        lighting.solve(&patches, &kept);
        lighting
    }

    /// The ground about a place of the frame.
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

    fn patches(&self, binned: &Binned, ground: &[bool]) -> Vec<Patch> {
        let across = binned.width.div_ceil(PATCH);
        let mut sums = vec![[0u32; 6]; across];
        let mut patches = Vec::with_capacity(across * binned.height.div_ceil(PATCH));
        let rows = binned
            .sums
            .chunks_exact(binned.width)
            .zip(ground.chunks_exact(binned.width));
        // Every other row tells enough.
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

    fn solve(&mut self, patches: &[Patch], kept: &[bool]) {
        let mut normal = SMatrix::<f64, 15, 15>::zeros();
        let mut right = [Terms::zeros(); 3];
        let mut count = 0.0;
        for (patch, _) in patches.iter().zip(kept).filter(|(_, kept)| **kept) {
            count += patch.count;
            normal.syger(patch.count, &patch.terms, &patch.terms, 1.0);
            for (right, &colour) in right.iter_mut().zip(&patch.colour) {
                *right += patch.terms * (patch.count * colour);
            }
        }
        for at in 0..15 {
            let hold = if at == 0 { 0.0 } else { HOLD };
            normal[(at, at)] += hold * count;
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

    /// How far a patch lies from the light, in standard deviations of its mean if it were all ground.
    fn stray(&self, patch: &Patch) -> f64 {
        let square: f64 = [0, 1, 2]
            .map(|colour| (self.terms[colour].dot(&patch.terms) - patch.colour[colour]).powi(2))
            .iter()
            .sum();
        (square * patch.count / (PATCH * PATCH) as f64).sqrt()
    }
}

/// The standard deviation of a pixel from the differences of ground squares side by side: their median size, which for
/// three independent normal colours is 1.5382 √2 of one's standard deviation.
fn noise(binned: &Binned, ground: &[bool]) -> f64 {
    let mut differences: Vec<i32> = Vec::new();
    let rows = binned
        .sums
        .chunks_exact(binned.width)
        .zip(ground.chunks_exact(binned.width));
    for (colours, ground) in rows.step_by(4) {
        for (pair, _) in colours
            .as_chunks::<2>()
            .0
            .iter()
            .zip(ground.as_chunks::<2>().0)
            .step_by(2)
            .filter(|(_, ground)| ground[0] && ground[1])
        {
            differences.push(
                (0..3)
                    .map(|at| (i32::from(pair[0][at]) - i32::from(pair[1][at])).pow(2))
                    .sum(),
            );
        }
    }
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let (_, &mut median, _) = differences.select_nth_unstable(middle);
    f64::from(median).sqrt() / (1.5382 * std::f64::consts::SQRT_2 * binned.bin as f64)
}
