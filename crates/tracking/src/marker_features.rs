//! Centroid, hue and size of a marker, and their standard errors. These values are computed from sums over the window
//! of pixels around the marker.

use crate::measure::Sums;
use crate::{Ground, Marker};
use palpate_statistics::hue_turns;

/// Range of hues of markers on a bright background, in turns: from magenta over red to yellow.
const MAGENTA_TO_YELLOW: [f64; 2] = [0.75, 0.22];
/// Smallest accepted chroma of markers on a bright background, relative to the absorbed green and blue light. Shapes
/// with a lower relative chroma may be grey dust. The relative chroma is 1 for pure magenta and pure yellow, and 1/2
/// where magenta and yellow overlap.
const MIN_CHROMA: f64 = 0.2;
/// Error of a pixel on a marker's edge. This number, divided by the marker's radius (px), is the standard deviation of
/// the pixel's light relative to the marker's mean light. The error has two causes: the edge crosses the pixel grid
/// differently at every place, and the light of a pixel is assigned to the middle of the pixel. The value was measured
/// on discs with radii of 8 to 26 px, with pixels that integrate the light over their area.
const EDGE_PX: f64 = 0.067;
/// The error of a pixel on a marker's edge has two parts: one is equal in all colours, and one is independent in each
/// colour. This number is the variance of the equal part, divided by the total variance.
const COMMON_SHARE: f64 = 0.5;

/// Computes the features of a marker from `sums`, the sums over its pixels. `None` if the hue is not the hue of a
/// marker, or if a number is out of range.
pub(crate) fn marker(sums: &Sums, ground: Ground, pixels: usize) -> Option<Marker> {
    let weights = weights(sums, ground);
    let light = dot(weights, sums.light);
    let size_px2 = match ground {
        Ground::Bright => light,
        Ground::Dark => sums.light.iter().copied().fold(0.0, f64::max),
    };
    let centroid_px = [0, 1].map(|axis| {
        sums.middle[axis] + dot(weights, sums.moment.map(|moment| moment[axis])) / light
    });
    let (hue_turns, chroma) = hue(sums.hue_light, ground);
    let coloured = chroma >= MIN_CHROMA * light;
    let [first, last] = MAGENTA_TO_YELLOW;
    let has_hue = ground == Ground::Dark || coloured && (hue_turns >= first || hue_turns <= last);
    let finite =
        centroid_px.iter().all(|at| at.is_finite()) && hue_turns.is_finite() && size_px2 > 0.0;
    (has_hue && finite && size_px2.is_finite()).then_some(Marker {
        centroid_px,
        hue_turns,
        mean_hue_turns: sums.mean_hue.unwrap_or(hue_turns),
        size_px2,
        pixels: u32::try_from(pixels).unwrap_or(u32::MAX),
    })
}

pub(crate) fn weights(sums: &Sums, ground: Ground) -> [f64; 3] {
    match ground {
        Ground::Bright => [0.0, 1.0, 1.0],
        // On a dark background, the noise is the same in all colours. Therefore weights proportional to the light of
        // each colour minimise the error of the centroid.
        Ground::Dark => sums.light.map(|light| light.max(0.0)),
    }
}

/// The HSV hue (turns) and the chroma of a marker. `light` is the summed light that the marker absorbs from a bright
/// background or adds to a dark background.
pub(crate) fn hue(light: [f64; 3], ground: Ground) -> (f64, f64) {
    let sign = match ground {
        Ground::Bright => -1.0,
        Ground::Dark => 1.0,
    };
    let [red, green, blue] = light.map(|light| sign * light);
    let (along, across) = (red - 0.5 * (green + blue), green - blue);
    let length = libm::hypot(along, 0.75_f64.sqrt() * across);
    (hue_turns([red, green, blue]), length)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Errors of a marker's centroid, hue and size in a frame. They have four causes: the noise of the pixels, the rounding
/// of pixels to whole levels, the error of the background's fitted light, and the pixel grid at the marker's edge. The
/// noise of the pixels is estimated from the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerErrors {
    /// Covariance of the errors of four numbers: both coordinates of the centroid (px), hue of the summed light
    /// (turns), and natural logarithm of the size.
    pub covariance: [[f64; 4]; 4],
}

pub(crate) fn errors(sums: &Sums, ground: Ground, marker: &Marker) -> MarkerErrors {
    let (pixel, radius_px) = (sums.errors.pixel, sums.errors.radius_px);
    let [count, x, y, xx, xy, yy] = sums.errors.window;
    let weights = weights(sums, ground);
    let light = dot(weights, sums.light);
    let strongest = (0..3).fold(0, |best, colour| {
        if sums.light[colour] > sums.light[best] {
            colour
        } else {
            best
        }
    });
    let [cx, cy] = [0, 1].map(|axis| marker.centroid_px[axis] - sums.middle[axis]);
    // `first` contains the sums, over the pixels of the window, of the offsets x and y from the centroid. `second`
    // contains the sums of x², xy and y².
    let first = [x - count * cx, y - count * cy];
    let second = [
        xx - 2.0 * cx * x + count * cx * cx,
        xy - cx * y - cy * x + count * cx * cy,
        yy - 2.0 * cy * y + count * cy * cy,
    ];
    let edge_px = std::f64::consts::TAU * radius_px;
    // `edge_slopes` are the changes of centroid, hue and size if the light of an edge pixel changes by its standard
    // deviation in all colours. The change of the centroid is per px of the pixel's offset from the centroid.
    let mut edge_slopes = [0.0; 3];
    let mut covariance = [[0.0; 4]; 4];
    for colour in 0..3 {
        // `place`, `turn` and `size` are the derivatives of centroid, hue and size with respect to a pixel's share of
        // light in this colour. For the centroid, the derivative is `place` times the pixel's offset from the centroid
        // (px).
        let place = weights[colour] / light;
        let turn = hue_slope(sums.hue_light, ground, colour);
        let size = match ground {
            Ground::Bright => place,
            Ground::Dark if colour == strongest => sums.light[colour].recip(),
            Ground::Dark => 0.0,
        };
        let edge = EDGE_PX / radius_px.max(1.0) * share(sums.light[colour], radius_px);
        let rim = (1.0 - COMMON_SHARE) * edge_px * edge * edge;
        for (sum, slope) in edge_slopes.iter_mut().zip([place, turn, size]) {
            *sum += edge * slope;
        }
        let (one, around) = (
            pixel[colour] * count + rim,
            0.5 * rim * radius_px * radius_px,
        );
        let numbers = [place * first[0], place * first[1], turn, size];
        let mut add = |row: usize, column: usize, value: f64| covariance[row][column] += value;
        add(0, 0, place * place * (pixel[colour] * second[0] + around));
        add(1, 1, place * place * (pixel[colour] * second[2] + around));
        add(0, 1, place * place * pixel[colour] * second[1]);
        for (axis, first) in first.into_iter().enumerate() {
            add(axis, 2, place * turn * pixel[colour] * first);
            add(axis, 3, place * size * pixel[colour] * first);
        }
        add(2, 2, turn * turn * one);
        add(2, 3, turn * size * one);
        add(3, 3, size * size * one);
        // `all` contains the derivatives of centroid, hue and size with respect to an error that is the same in all
        // pixels of the window.
        let all = [numbers[0], numbers[1], turn * count, size * count];
        for row in 0..4 {
            for column in row..4 {
                add(
                    row,
                    column,
                    sums.errors.common[colour] * all[row] * all[column],
                );
            }
        }
    }
    let [place, turn, size] = edge_slopes;
    let count = COMMON_SHARE * edge_px;
    let of_centroid = 0.5 * count * (place * radius_px).powi(2);
    covariance[0][0] += of_centroid;
    covariance[1][1] += of_centroid;
    covariance[2][2] += count * turn * turn;
    covariance[2][3] += count * turn * size;
    covariance[3][3] += count * size * size;
    let upper = covariance;
    let covariance = std::array::from_fn(|row| {
        std::array::from_fn(|column| upper[row.min(column)][row.max(column)])
    });
    MarkerErrors { covariance }
}

/// Mean share of light that a pixel of a marker absorbs or adds, from −1 to 1. `light` is the sum of the pixels'
/// shares, and `radius_px` is the radius of the marker.
fn share(light: f64, radius_px: f64) -> f64 {
    (light / (std::f64::consts::PI * radius_px * radius_px)).clamp(-1.0, 1.0)
}

fn hue_slope(light: [f64; 3], ground: Ground, colour: usize) -> f64 {
    let step = 1e-6 * light.iter().fold(0.0, |most: f64, one| most.max(one.abs()));
    let mut there = light;
    there[colour] += step;
    let turn = hue(there, ground).0 - hue(light, ground).0;
    let slope = (turn - (turn + 0.5).floor()) / step;
    if slope.is_finite() { slope } else { 0.0 }
}
