//! Draws camera frames with markers, and returns the true features of these markers. Tests, benchmarks and measurements
//! of the tracker use such frames. The drawing method differs from the renderer of `palpate-chromatouch`, so the frames
//! are an independent reference.
//!
//! ```
//! let (frame, truth) = palpate_testkit::dark(200, 1);
//! assert_eq!((frame.width(), truth.len()), (200, 77));
//! let [x, y] = truth[38].centroid_px;
//! assert!((x - 100.0).abs() < 5.0 && (y - 100.0).abs() < 5.0);
//! ```

use image::RgbImage;

/// True features of a marker in a frame. A marker consists of one disc or of a pair of discs.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// True centroid of the marker, px.
    pub centroid_px: [f64; 2],
    /// True hue of the marker, turns.
    pub hue_turns: f64,
    /// True size of the marker in a frame with a bright background, px²: the sum over its pixels of the absorbed shares
    /// of green and blue light. In a frame with a dark background, the size is 0.
    pub size_px2: f64,
}

/// A generator of random numbers (SplitMix64; Steele, Lea and Flood 2014). To set the seed, create it as
/// `Random(seed)`.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A uniformly distributed number from `low` to `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// An approximately normally distributed random number with mean 0 and standard deviation 1: the sum of twelve
    /// uniform random numbers from -0.5 to 0.5.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform(-0.5, 0.5)).sum()
    }
}

/// Hue (HSV) of a colour, in turns.
pub fn hue(light: [f64; 3]) -> f64 {
    let least = light.into_iter().fold(f64::INFINITY, f64::min);
    let [red, green, blue] = light.map(|one| one - least);
    let sixths = if blue == 0.0 {
        // Blue is the weakest of the three colours, so the hue lies between red and green, through yellow.
        if red >= green {
            green / red
        } else {
            2.0 - red / green
        }
    } else if red == 0.0 {
        if green >= blue {
            2.0 + blue / green
        } else {
            4.0 - green / blue
        }
    } else if blue >= red {
        4.0 + red / blue
    } else {
        6.0 - blue / red
    };
    sixths / 6.0
}

fn colour(hue: f64) -> [f64; 3] {
    [0.0, 4.0, 2.0].map(|shift| {
        let ramp = ((6.0 * hue + shift).rem_euclid(6.0) - 3.0).abs() - 1.0;
        1.0 - 0.8 * (1.0 - ramp.clamp(0.0, 1.0))
    })
}

/// The pixels near a disc, each as (column, row, share). The share is the part of the pixel's area that the disc
/// covers, from 0 to 1, estimated with 8 × 8 sample points.
fn covered(disc: [f64; 2], radius: f64, size: usize) -> Vec<(usize, usize, f64)> {
    let bounds = |at: f64| {
        let first = (at - radius - 2.0).max(0.0) as usize;
        first..((at + radius + 3.0) as usize).min(size)
    };
    let mut pixels = Vec::new();
    for y in bounds(disc[1]) {
        for x in bounds(disc[0]) {
            let hit = (0..64).filter(|at| {
                let [dx, dy] = [at % 8, at / 8].map(|at| (f64::from(at) + 0.5) / 8.0 - 0.5);
                (x as f64 + dx - disc[0]).powi(2) + (y as f64 + dy - disc[1]).powi(2)
                    <= radius * radius
            });
            pixels.push((x, y, hit.count() as f64 / 64.0));
        }
    }
    pixels
}

/// Converts an image to bytes, and adds normally distributed noise with the standard deviation `noise` (in grey levels
/// from 0 to 255).
fn bytes(plane: &[[f64; 3]], size: usize, noise: f64, random: &mut Random) -> RgbImage {
    let mut frame = RgbImage::new(size as u32, size as u32);
    for (pixel, colour) in frame.pixels_mut().zip(plane) {
        pixel.0 =
            colour.map(|value| (value + noise * random.normal()).round().clamp(0.0, 255.0) as u8);
    }
    frame
}

/// A frame of 77 discs of random hues on a dark background with uneven illumination. The noise has a standard deviation
/// of 3 of the 255 grey levels. The discs are within a circle of radius 0.48 × `size` around the middle of the frame.
/// Outside this circle, the frame contains random clutter.
pub fn dark(size: usize, seed: u64) -> (RgbImage, Vec<Truth>) {
    let mut random = Random(seed);
    let n = size as f64;
    let lamp = |x: f64, y: f64| {
        0.75 + 0.25 * libm::cos((x - 0.45 * n) / n * 1.6) * libm::cos((y - 0.55 * n) / n * 1.6)
    };
    let place = |at: usize| [(at % size) as f64, (at / size) as f64];
    let mut plane: Vec<[f64; 3]> = (0..size * size)
        .map(|at| [38.0 * lamp(place(at)[0], place(at)[1]); 3])
        .collect();
    let mut truth = Vec::new();
    for at in 0..77 {
        let mut along = |step: i32, pitch: f64| {
            n * (0.5 + f64::from(step) * pitch + random.uniform(-0.008, 0.008))
        };
        let centroid_px = [along(at / 7 - 5, 0.066), along(at % 7 - 3, 0.09)];
        let light = colour(random.uniform(0.0, 1.0));
        for (x, y, share) in covered(centroid_px, 0.0125 * n, size) {
            let lit = lamp(x as f64, y as f64);
            for (value, light) in plane[y * size + x].iter_mut().zip(light) {
                *value += share * (200.0 * light * lit - *value);
            }
        }
        truth.push(Truth {
            centroid_px,
            hue_turns: hue(light),
            size_px2: 0.0,
        });
    }
    for (at, value) in plane.iter_mut().enumerate() {
        let [x, y] = place(at).map(|at| at - 0.5 * n);
        if libm::hypot(x, y) > 0.48 * n {
            *value = [0; 3].map(|_| 90.0 + 20.0 * random.normal());
        }
    }
    (bytes(&plane, size, 3.0, &mut random), truth)
}

/// Settings of a simulated frame with markers on a bright background.
#[derive(Clone, Copy, Debug)]
pub struct Bright {
    /// Side length of the frame, px.
    pub size: usize,
    /// Diameter of a disc, px.
    pub disc_px: f64,
    /// Distance between the centres of a marker's magenta and yellow discs, in disc diameters.
    pub apart: f64,
    /// Standard deviation of the blur, px.
    pub blur_px: f64,
    /// Decrease of the light from the middle to the rim of the image, as a share of the light in the middle.
    pub falloff: f64,
    /// Standard deviation of the noise, in grey levels from 0 to 255.
    pub noise: f64,
}

/// Shares of red, green and blue light that a magenta disc transmits.
pub const MAGENTA: [f64; 3] = [0.95, 0.25, 0.85];
/// Shares of red, green and blue light that a yellow disc transmits.
pub const YELLOW: [f64; 3] = [0.98, 0.9, 0.1];

/// A frame of markers at `places` (px) on a white background. Each marker consists of a magenta and a yellow disc. The
/// direction from the magenta to the yellow disc is random.
pub fn bright(how: Bright, places: &[[f64; 2]], seed: u64) -> (RgbImage, Vec<Truth>) {
    let Bright { size, disc_px, .. } = how;
    let mut random = Random(seed);
    let mut plane = vec![[1.0; 3]; size * size];
    let mut truth = Vec::new();
    for place in places {
        let turn = random.uniform(0.0, std::f64::consts::TAU);
        let shift =
            [libm::cos(turn), libm::sin(turn)].map(|along| 0.5 * how.apart * disc_px * along);
        let discs = [-1.0, 1.0].map(|sign| [0, 1].map(|axis| place[axis] + sign * shift[axis]));
        let mut through = std::collections::BTreeMap::new();
        for (disc, dye) in discs.into_iter().zip([MAGENTA, YELLOW]) {
            for (x, y, share) in covered(disc, 0.5 * disc_px, size) {
                let light = through.entry((y, x)).or_insert([1.0; 3]);
                for (light, dye) in light.iter_mut().zip(dye) {
                    *light *= 1.0 - share * (1.0 - dye);
                }
            }
        }
        let (mut sum, mut moment, mut taken) = (0.0, [0.0; 2], [0.0; 3]);
        for (&(y, x), light) in &through {
            let weight = 2.0 - light[1] - light[2];
            sum += weight;
            moment[0] += weight * x as f64;
            moment[1] += weight * y as f64;
            for (taken, light) in taken.iter_mut().zip(light) {
                *taken += light;
            }
            plane[y * size + x] = *light;
        }
        truth.push(Truth {
            centroid_px: moment.map(|moment| moment / sum),
            hue_turns: hue(taken),
            size_px2: sum,
        });
    }
    let blurred = blur(&plane, size, how.blur_px);
    let middle = 0.5 * (size as f64 - 1.0);
    let lit: Vec<[f64; 3]> = blurred
        .iter()
        .enumerate()
        .map(|(at, colour)| {
            let [x, y] = [at % size, at / size].map(|at| (at as f64 - middle) / middle);
            colour.map(|value| 235.0 * value * (1.0 - how.falloff * (x * x + y * y).min(1.0)))
        })
        .collect();
    (bytes(&lit, size, how.noise, &mut random), truth)
}

/// Blurs an image with a Gaussian whose standard deviation is `std` pixels: first along the rows, then along the
/// columns.
fn blur(plane: &[[f64; 3]], size: usize, std: f64) -> Vec<[f64; 3]> {
    if std == 0.0 {
        return plane.to_vec();
    }
    let reach = (4.0 * std).ceil() as usize;
    let mut kernel: Vec<f64> = (0..=2 * reach)
        .map(|at| libm::exp(-0.5 * ((at as f64 - reach as f64) / std).powi(2)))
        .collect();
    let sum: f64 = kernel.iter().sum();
    kernel.iter_mut().for_each(|weight| *weight /= sum);
    let pass =
        |plane: &[[f64; 3]], stride: usize, along: fn(usize, usize) -> usize| -> Vec<[f64; 3]> {
            (0..plane.len())
                .map(|at| {
                    let place = along(at, size);
                    let mut value = [0.0; 3];
                    for (step, weight) in kernel.iter().enumerate() {
                        let to = (place + step).saturating_sub(reach).min(size - 1);
                        let other = plane[at + to * stride - place * stride];
                        for (value, other) in value.iter_mut().zip(other) {
                            *value += weight * other;
                        }
                    }
                    value
                })
                .collect()
        };
    let across = pass(plane, 1, |at, size| at % size);
    pass(&across, size, |at, size| at / size)
}

/// Positions (px) of a sensor's markers in a frame of `size` × `size` px: one marker in the middle, and markers on
/// `rings` rings around it. The rings are `spacing` px apart.
pub fn rings(size: usize, spacing: f64, rings: usize) -> Vec<[f64; 2]> {
    let middle = 0.5 * (size as f64 - 1.0);
    let mut places = vec![[middle + 0.3, middle - 0.2]];
    for ring in 1..=rings {
        let count = 6 * ring;
        for at in 0..count {
            let turn = std::f64::consts::TAU * (at as f64 + 0.37 * ring as f64) / count as f64;
            places.push(
                [libm::cos(turn), libm::sin(turn)]
                    .map(|along| middle + spacing * ring as f64 * along),
            );
        }
    }
    places
}
