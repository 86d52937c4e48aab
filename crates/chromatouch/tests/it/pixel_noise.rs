//! Tests the noise of pixels: the distribution of the noise, and its independence in different pixels and frames.

use image::RgbImage;
use palpate_chromatouch::{Blemishes, Camera, Colours, Lens, MarkerArray, Optics};

use crate::optics::{DISCS, depths};

/// A uniformly lit frame without markers. `levels` are the levels of red, green and blue before noise.
fn frame(size_px: u32, levels: [f64; 3], pixel_std: f64, [seed, trial]: [u64; 2]) -> RgbImage {
    let array = MarkerArray::new(20.0, &[], DISCS, depths(3.0, 1.0)).unwrap();
    let camera = Camera::new(Lens::Fisheye, size_px, 70.0).unwrap();
    let light = levels.map(|level| level / 255.0);
    let colours = Colours {
        white: light,
        outside: light,
        ..Colours::default()
    };
    let blemishes = Blemishes {
        pixel_std,
        ..Blemishes::default()
    };
    let optics = Optics::new(array, camera, colours, blemishes).unwrap();
    optics.render(&[], Some((seed, trial))).unwrap()
}

fn inside(size_px: u32, row: u32) -> impl Iterator<Item = u32> {
    let middle = 0.5 * (f64::from(size_px) - 1.0);
    let reach = 0.5 * f64::from(size_px);
    (0..size_px).filter(move |&column| {
        let [x, y] = [column, row].map(|place| f64::from(place) - middle);
        libm::hypot(x, y) <= reach
    })
}

/// Probability that a standard normal number is below `limit`.
fn below(limit: f64) -> f64 {
    0.5 * libm::erfc(-limit * std::f64::consts::FRAC_1_SQRT_2)
}

#[test]
fn bytes_are_levels_with_a_normal_error_rounded_and_clipped() {
    const SIZE: u32 = 801;
    let levels = [100.3, 253.6, 1.2];
    for std in [0.3, 2.0, 60.0] {
        let frame = frame(SIZE, levels, std, [1, 0]);
        let mut counts = [[0_u32; 256]; 3];
        for (row, column) in (0..SIZE).flat_map(|row| inside(SIZE, row).map(move |at| (row, at))) {
            for (counts, byte) in counts.iter_mut().zip(frame.get_pixel(column, row).0) {
                counts[usize::from(byte)] += 1;
            }
        }
        for (counts, level) in counts.iter().zip(levels) {
            let pixels = f64::from(counts.iter().sum::<u32>());
            assert!(pixels > 500_000.0);
            let up_to = |byte: usize| match byte {
                255 => 1.0,
                byte => below((byte as f64 + 0.5 - level) / std),
            };
            // Combine pixel levels whose expected count is small, because the chi-squared test needs large counts.
            let (mut square, mut freedom) = (0.0, -1.0);
            let (mut seldom, mut expected_seldom) = (0.0, 0.0);
            let mut compare = |count: f64, expected: f64| {
                square += (count - expected).powi(2) / expected;
                freedom += 1.0;
            };
            let mut before = 0.0;
            for (byte, &count) in counts.iter().enumerate() {
                let expected = pixels * (up_to(byte) - before);
                before = up_to(byte);
                match expected >= 20.0 {
                    true => compare(f64::from(count), expected),
                    false => {
                        seldom += f64::from(count);
                        expected_seldom += expected;
                    }
                }
            }
            if expected_seldom >= 20.0 {
                compare(seldom, expected_seldom);
            } else {
                assert!(seldom <= expected_seldom + 4.0 * expected_seldom.sqrt() + 3.0);
            }
            let score = (square - freedom) / (2.0 * freedom).sqrt();
            assert!(
                freedom >= 1.0 && score.abs() < 4.0,
                "{level}, {std}: {square} of {freedom}"
            );
        }
    }
}

#[test]
fn pixels_outside_the_circle_have_no_noise() {
    const SIZE: u32 = 301;
    let noisy = frame(SIZE, [128.0; 3], 20.0, [1, 0]);
    let mut changed = 0;
    for row in 0..SIZE {
        let inside: Vec<u32> = inside(SIZE, row).collect();
        for column in 0..SIZE {
            let is_changed = noisy.get_pixel(column, row).0 != [128; 3];
            changed += u32::from(is_changed);
            assert!(inside.contains(&column) || !is_changed, "{column}, {row}");
        }
    }
    // Noise of 20 levels changes nearly every pixel. A pixel is unchanged only if the errors of all three channels are
    // rounded to 0.
    assert!(f64::from(changed) > 0.999 * 71_000.0, "{changed}");
}

/// Errors of the pixel levels in a square inside of the image circle, divided by the standard deviation of noise and
/// rounding. Each row of the result belongs to a row of pixels, and contains three errors per pixel, one per colour.
fn errors(frame: &RgbImage) -> Vec<Vec<f64>> {
    let size = frame.width();
    let square = size * 3 / 20..size * 17 / 20;
    let deviation = (8.0 * 8.0 + 1.0 / 12.0_f64).sqrt();
    let row = |row: u32| {
        let levels = square
            .clone()
            .flat_map(|column| frame.get_pixel(column, row).0);
        levels
            .map(|level| (f64::from(level) - 128.0) / deviation)
            .collect()
    };
    square.clone().map(row).collect()
}

/// Two scores for the correlation between the errors of two frames. Each error of the frame `one` is multiplied by the
/// error of the frame `other` that is `down` rows lower and `on` entries further along the row. The first score uses
/// the errors, and the second score their squares, because errors can be dependent without being correlated. If the
/// errors are independent, both scores have a standard normal distribution.
fn common(one: &[Vec<f64>], other: &[Vec<f64>], down: usize, on: usize) -> [f64; 2] {
    let (mut count, mut product, mut squares) = (0.0_f64, 0.0, 0.0);
    for (row, below) in one.iter().zip(&other[down..]) {
        for (one, other) in row.iter().zip(&below[on..]) {
            count += 1.0;
            product += one * other;
            squares += (one * one - 1.0) * (other * other - 1.0) / 2.0;
        }
    }
    assert!(count > 200_000.0);
    [product, squares].map(|sum| sum / count.sqrt())
}

#[test]
fn errors_of_pixels_are_independent() {
    let noise = |key| errors(&frame(401, [128.0; 3], 8.0, key));
    let own = noise([1, 0]);
    let mut scores = Vec::new();
    // First compare errors in the same row: channels of the same pixel, of its neighbours and of more distant pixels.
    // Then compare each row with the rows below.
    scores.extend((1..=64).map(|on| common(&own, &own, 0, on)));
    scores.extend(
        (1..=3)
            .flat_map(|down| (0..6).map(move |on| (down, on)))
            .map(|(down, on)| common(&own, &own, down, on)),
    );
    // Compare the frame with frames of another trial and of another seed.
    for other in [[1, 1], [2, 0]].map(noise) {
        scores.extend((0..6).map(|on| common(&own, &other, 0, on)));
    }
    // Each score is a normalised sum of products of two errors. If the errors are independent and normal, all 188
    // scores are within ±4.6 with a probability of 0.999.
    let independent = |scores: &[f64; 2]| scores.iter().all(|score| score.abs() < 4.6);
    assert!(scores.iter().all(independent), "{scores:?}");
    assert!(common(&own, &own, 0, 0).iter().all(|score| *score > 100.0));
}
