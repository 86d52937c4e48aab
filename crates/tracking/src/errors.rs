//! Errors of a marker's centroid, hue and size, from those of the pixels that they are sums of.

use crate::measure::{PixelErrors, Sums};
use crate::sight::{hue, weights};
use crate::{Ground, Marker};

/// Standard deviation of a pixel on a marker's edge, as a share of the light that the marker takes or adds there, times the
/// marker's radius in px: the pixels' grid crosses the edge another way in every place, and a pixel's light counts in its
/// middle wherever in it the light falls. As discs of 8 to 26 px radius show it whose pixels gather the light of their
/// squares.
const EDGE_PX: f64 = 0.067;
/// Share of that variance that is common to all colours.
const ALIKE: f64 = 0.5;

/// Errors of a marker as a frame shows it: those that follow from the noise of its pixels, which the ground shows, from
/// the rounding to whole levels, from the ground's light, and from the way in which the pixels' grid crosses its edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerErrors {
    /// Covariance of both coordinates of the centroid, px, the mean hue, turns, and the natural logarithm of the size.
    pub covariance: [[f64; 4]; 4],
}

impl MarkerErrors {
    /// Errors of the mean of several frames with errors like these.
    pub fn averaged(&self, frames: u32) -> Self {
        let share = f64::from(frames.max(1)).recip();
        Self {
            covariance: self.covariance.map(|row| row.map(|entry| share * entry)),
        }
    }
}

pub(crate) fn errors(sums: &Sums, ground: Ground, marker: &Marker) -> MarkerErrors {
    let PixelErrors {
        window,
        pixel,
        common,
        radius_px,
    } = sums.errors;
    let [count, x, y, xx, xy, yy] = window;
    let weights = weights(sums, ground);
    let light: f64 = weights.iter().zip(sums.light).map(|(a, b)| a * b).sum();
    let strongest = (0..3).fold(0, |best, colour| {
        if sums.light[colour] > sums.light[best] {
            colour
        } else {
            best
        }
    });
    let [cx, cy] = [0, 1].map(|axis| marker.centroid_px[axis] - sums.middle[axis]);
    // Sums over the window of the pixels' places from the centroid, and of their squares.
    let first = [x - count * cx, y - count * cy];
    let second = [
        xx - 2.0 * cx * x + count * cx * cx,
        xy - cx * y - cy * x + count * cx * cy,
        yy - 2.0 * cy * y + count * cy * cy,
    ];
    let edge_px = std::f64::consts::TAU * radius_px;
    // Slopes by what all colours of an edge's pixel err by alike.
    let mut alike = [0.0; 3];
    let mut covariance = [[0.0; 4]; 4];
    for colour in 0..3 {
        // Slopes of centroid, hue and size by a pixel's share of this colour, those of the centroid per px of place.
        let place = weights[colour] / light;
        let turn = hue_slope(sums.hue_light, ground, colour);
        let size = match ground {
            Ground::Bright => place,
            Ground::Dark if colour == strongest => sums.light[colour].recip(),
            Ground::Dark => 0.0,
        };
        let edge = EDGE_PX / radius_px.max(1.0) * share(sums.light[colour], radius_px);
        let rim = (1.0 - ALIKE) * edge_px * edge * edge;
        for (sum, slope) in alike.iter_mut().zip([place, turn, size]) {
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
        // What all pixels err by alike.
        let all = [numbers[0], numbers[1], turn * count, size * count];
        for row in 0..4 {
            for column in row..4 {
                add(row, column, common[colour] * all[row] * all[column]);
            }
        }
    }
    let [place, turn, size] = alike;
    let count = ALIKE * edge_px;
    let of_place = 0.5 * count * (place * radius_px).powi(2);
    covariance[0][0] += of_place;
    covariance[1][1] += of_place;
    covariance[2][2] += count * turn * turn;
    covariance[2][3] += count * turn * size;
    covariance[3][3] += count * size * size;
    let upper = covariance;
    let covariance = std::array::from_fn(|row| {
        std::array::from_fn(|column| upper[row.min(column)][row.max(column)])
    });
    MarkerErrors { covariance }
}

/// Share of the light that a marker of this radius takes or adds over its area.
fn share(light: f64, radius_px: f64) -> f64 {
    (light / (std::f64::consts::PI * radius_px * radius_px)).clamp(-1.0, 1.0)
}

/// Slope of the hue by the summed light of one colour, turns.
fn hue_slope(light: [f64; 3], ground: Ground, colour: usize) -> f64 {
    let step = 1e-6 * light.iter().fold(0.0, |most: f64, one| most.max(one.abs()));
    let mut there = light;
    there[colour] += step;
    let turn = hue(there, ground).0 - hue(light, ground).0;
    let slope = (turn - (turn + 0.5).floor()) / step;
    if slope.is_finite() { slope } else { 0.0 }
}
