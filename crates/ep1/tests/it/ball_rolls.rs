//! Time series of rolls on a ball, from the closed form for a ball on a ball.

use nalgebra::{Rotation3, Vector2, Vector3};
use palpate_ep1::{
    PadCell, Places, RollSample, RollSeries, SeriesError, SeriesEstimate, SeriesMethod,
    SeriesNoise, estimate_series,
};

use crate::draws::Draws;

pub(crate) const RADIUS: f64 = 10.0;
pub(crate) const EXACT: SeriesNoise = SeriesNoise {
    rotation_std_rad: 0.0,
    relative_rotation_std: 0.0,
    relative_sample_std: 0.0,
};

pub(crate) const SQUARE: PadCell = PadCell {
    pitch: 1.0,
    is_hexagonal: false,
};

/// The estimate from the centres of the pads [`SQUARE`].
pub(crate) fn on_squares(
    method: SeriesMethod,
    noise: &SeriesNoise,
    rolls: &[RollSeries],
) -> Result<SeriesEstimate, SeriesError> {
    estimate_series(method, RADIUS, &Places::Pads(SQUARE), noise, rolls)
}

/// Centre of the pad that contains `place`.
pub(crate) fn pad(cell: &PadCell, place: &Vector2<f64>) -> Vector2<f64> {
    let period = match cell.is_hexagonal {
        false => Vector2::new(1.0, 1.0),
        true => Vector2::new(1.0, 3.0_f64.sqrt()),
    } * cell.pitch;
    let nearest = |corner: Vector2<f64>| {
        let steps = (place - corner).component_div(&period).map(f64::round);
        corner + steps.component_mul(&period)
    };
    let centres = [nearest(Vector2::zeros()), nearest(0.5 * period)];
    let inside = |centre: &&Vector2<f64>| cell.contains(&(place - **centre));
    *centres.iter().find(inside).unwrap_or(&centres[0])
}

/// Position of the contact on the probe, in the coordinates of the probe's exponential map. The contact starts at
/// `start` and moves by `path`.
pub(crate) fn chart(start: &Vector2<f64>, path: &Vector2<f64>) -> Vector2<f64> {
    let turned = |place: &Vector2<f64>| {
        Rotation3::from_scaled_axis(Vector3::new(-place.y, place.x, 0.0) / RADIUS)
    };
    let direction = turned(start) * turned(path) * Vector3::z();
    let across = direction.xy();
    across * (RADIUS * libm::atan2(across.norm(), direction.z) / across.norm().max(1e-300))
}

/// Eight rolls by half a radian on a ball, at 1 kHz. The directions are an eighth of a turn apart, and the first is at
/// the angle `turn` (rad) from the u axis of the pads.
pub(crate) fn rolls(object: f64, cell: &PadCell, turn: f64, draws: &mut Draws) -> Vec<RollSeries> {
    let one = |number: usize| {
        let (sin, cos) = libm::sincos(turn + number as f64 * std::f64::consts::FRAC_PI_4);
        let direction = Vector2::new(cos, sin);
        let start = loop {
            let mut within = || (draws.uniform() - 0.5) * 1.2 * cell.pitch;
            let start = Vector2::new(within(), within());
            if cell.contains(&start) {
                break start;
            }
        };
        let sample = |index: u32| {
            let time_s = f64::from(index) * 1e-3;
            let drive = direction * (0.5 * time_s);
            let path = drive / (1.0 / RADIUS + 1.0 / object);
            RollSample {
                time_s,
                rotation: Vector3::new(drive.y, -drive.x, 0.0),
                place: pad(cell, &chart(&start, &path)),
            }
        };
        RollSeries {
            start: Some(start),
            has_spin: true,
            samples: (0..=1000).map(sample).collect(),
        }
    };
    (0..8).map(one).collect()
}

pub(crate) fn without_starts(rolls: &[RollSeries]) -> Vec<RollSeries> {
    let without = |roll: &RollSeries| RollSeries {
        start: None,
        ..roll.clone()
    };
    rolls.iter().map(without).collect()
}
