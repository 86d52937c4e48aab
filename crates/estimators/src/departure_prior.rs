//! Prior standard deviations of the parameters of a camera sensor.

use palpate_chromatouch::Departure;
use palpate_study::config::SensorNoise;

/// Standard deviation of each number of a [`Departure`].
pub fn departure_stds(noise: &SensorNoise) -> [f64; Departure::NUMBERS] {
    let SensorNoise {
        centre_px,
        scale,
        place,
        turn_deg,
        disc_depth,
        disc_diameter,
        colour,
    } = *noise;
    let turn = turn_deg.to_radians();
    // The odd terms of the lens are exact.
    let mut stds = [0.0; Departure::NUMBERS];
    stds[13..19].fill(colour);
    stds[..13].copy_from_slice(&[
        disc_depth,
        disc_depth,
        disc_diameter,
        disc_diameter,
        centre_px,
        centre_px,
        scale,
        place,
        place,
        place,
        turn,
        turn,
        turn,
    ]);
    stds
}
