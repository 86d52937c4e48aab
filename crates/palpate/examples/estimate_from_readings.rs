//! Estimates the curvature of an object from readings of three rolls, and prints it as JSON.
#![allow(clippy::print_stdout)]

use std::error::Error;

use palpate::recorded::{RollOptions, RollRecording, estimate_roll};

const HEADER: [&str; 5] = [
    "probe",
    "rotation_x_rad",
    "rotation_y_rad",
    "shift_u_mm",
    "shift_v_mm",
];

fn main() -> Result<(), Box<dyn Error>> {
    // A probe of radius 10 mm is turned by 0.3 rad in three directions; its contact shifts by about 2 mm.
    let rolls = [
        [0.0, 0.0, -0.3, 2.0, 0.0],
        [1.0, 0.3, 0.0, 0.0, 2.1],
        [2.0, 0.0, 0.3, -2.0, 0.0],
    ];
    let readings = RollRecording::try_from(palpate::readings("rolls", HEADER, &rolls))?;
    let options = RollOptions {
        noise: RollOptions::noise_of_pads(10.0, 0.1)?,
        ..RollOptions::new(10.0)
    };
    let estimate = estimate_roll(readings, &options)?;
    println!("{}", serde_json::to_string_pretty(&estimate)?);
    Ok(())
}
