//! Tests the readings of pad arrays.

use nalgebra::Vector2;
use palpate_sensing::{Channel, PadLayout, PadOffset, Pads, Stream};
use proptest::prelude::*;

const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;

fn pads(pitch: f64, layout: PadLayout, offset: PadOffset) -> Pads {
    Pads::new(10.0, pitch, layout, offset, HALF_PI).unwrap()
}

fn read(pads: &Pads, trial: u64, displacement: Vector2<f64>) -> Vector2<f64> {
    let placement = pads.place(&mut Stream::new(1, trial, Channel::PadOffset));
    pads.read(&placement, &displacement).unwrap()
}

#[test]
fn the_papers_reading_of_a_fifty_millimetre_sphere() {
    // A probe of radius 10 mm rolls by 0.1 rad on a ball of radius 50 mm, so the contact moves by 0.833 mm. The nearest
    // whole number of pitches is 1 mm, both for pads of 0.5 mm and for pads of 1 mm.
    let moved = 0.1 / (1.0 / 10.0 + 1.0 / 50.0);
    for pitch in [0.5, 1.0] {
        let pads = pads(pitch, PadLayout::Square, PadOffset::Centred);
        assert_eq!(
            read(&pads, 0, Vector2::new(moved, 0.0)),
            Vector2::new(1.0, 0.0)
        );
        assert_eq!(
            read(&pads, 0, Vector2::new(0.0, -moved)),
            Vector2::new(0.0, -1.0)
        );
    }
}

#[test]
fn hexagonal_pads_read_the_nearest_centre() {
    let pads = pads(0.5, PadLayout::Hexagonal, PadOffset::Centred);
    let centres: Vec<Vector2<f64>> = (-30..=30)
        .flat_map(|row| (-30..=30).map(move |column| (f64::from(row), f64::from(column))))
        .map(|(row, column)| {
            let x = column + 0.5 * row.rem_euclid(2.0);
            Vector2::new(0.5 * x, 0.25 * 3.0_f64.sqrt() * row)
        })
        .collect();
    let mut stream = Stream::new(43, 0, Channel::Position);
    let (count, mut square) = (20_000, 0.0);
    for _ in 0..count {
        let place = Vector2::new(stream.symmetric_uniform(), stream.symmetric_uniform()) * 4.0;
        let found = read(&pads, 0, place);
        square += (found - place).norm_squared();
        if square < 40.0 {
            let distances = centres.iter().map(|centre| (centre - place).norm());
            let nearest = distances.fold(f64::INFINITY, f64::min);
            assert!(((found - place).norm() - nearest).abs() < 1e-12, "{place}");
            assert!(centres.iter().any(|centre| (centre - found).norm() < 1e-12));
        }
    }
    // The mean squared error per axis is the variance of a uniform distribution over a hexagon, 5/72 pitch².
    let per_axis = square / f64::from(2 * count);
    assert!(
        (per_axis / (0.25 * 5.0 / 72.0) - 1.0).abs() < 0.02,
        "{per_axis}"
    );
    let [std, largest] = pads.rounding();
    assert!((std * std / 12.0 - 5.0 / 72.0).abs() < 1e-15);
    assert!((0.5 * largest - 1.0 / 3.0_f64.sqrt()).abs() < 1e-15);
}

#[test]
fn beyond_the_cap_is_an_error() {
    for layout in [PadLayout::Square, PadLayout::Hexagonal, PadLayout::Uniform] {
        let pads = Pads::new(10.0, 0.5, layout, PadOffset::Centred, 0.5).unwrap();
        let placement = pads.place(&mut Stream::new(1, 0, Channel::PadOffset));
        assert!(pads.read(&placement, &Vector2::new(4.9, 0.0)).is_ok());
        let error = pads.read(&placement, &Vector2::new(4.0, 4.0)).unwrap_err();
        assert_eq!(<&str>::from(error), "beyond-pads");
        assert!((error.angle_rad - 0.32_f64.sqrt()).abs() < 1e-12);
    }
}

#[test]
fn centred_pads_draw_nothing() {
    for layout in [PadLayout::Square, PadLayout::Hexagonal, PadLayout::Uniform] {
        let mut stream = Stream::new(1, 0, Channel::PadOffset);
        let first = stream.clone().symmetric_uniform();
        pads(0.5, layout, PadOffset::Centred).place(&mut stream);
        assert_eq!(stream.symmetric_uniform(), first);
    }
}

#[test]
fn quantisation_error_is_that_of_two_ends() {
    // A shift is the difference of two contact positions. Each position is read as the centre of its pad, so its error
    // is uniformly distributed over a pad. In a square grid, the errors of the two positions are dependent. If the
    // shift is a whole number of pads plus the fraction f of a pad, the mean square error of the shift is f (1 − f) in
    // squared pad pitches.
    for (layout, expected) in [
        (PadLayout::Square, 0.5 * (0.24 + 0.16)),
        (PadLayout::Uniform, 1.0 / 6.0),
    ] {
        let pads = pads(0.5, layout, PadOffset::Random);
        let count = 20_000_u64;
        let displacement = Vector2::new(2.3, 1.1);
        let mean_square = (0..count)
            .map(|trial| (read(&pads, trial, displacement) - displacement).norm_squared())
            .sum::<f64>()
            / (2.0 * count as f64);
        let ratio = mean_square / (0.25 * expected);
        assert!((0.95..1.3).contains(&ratio), "{layout:?}: {ratio}");
    }
}

proptest! {
    #[test]
    fn a_reading_is_within_a_pad_of_the_contact(
        exponent in -5.0..0.3_f64,
        angle in 0.0..1.5_f64,
        azimuth in -3.2..3.2_f64,
        trial in 0..1000_u64,
    ) {
        let pitch = libm::pow(10.0_f64, exponent);
        let displacement = Vector2::new(libm::cos(azimuth), libm::sin(azimuth)) * (10.0 * angle);
        // In the coordinates of the logarithm map, errors perpendicular to the displacement appear larger by the factor
        // `stretch`.
        let stretch = angle / libm::sin(angle).max(1e-300);
        for (layout, offset, bound) in [
            (PadLayout::Square, PadOffset::Centred, 0.5),
            (PadLayout::Square, PadOffset::Random, 1.0),
            (PadLayout::Hexagonal, PadOffset::Centred, 0.578),
            (PadLayout::Hexagonal, PadOffset::Random, 1.156),
            (PadLayout::Uniform, PadOffset::Centred, 1.05 * stretch.max(1.0)),
            (PadLayout::Uniform, PadOffset::Random, 2.1 * stretch.max(1.0)),
        ] {
            let pads = pads(pitch, layout, offset);
            let error = read(&pads, trial, displacement) - displacement;
            let off = if layout == PadLayout::Square { error.amax() } else { error.norm() };
            prop_assert!(off <= bound * pitch + 1e-14, "{layout:?} {offset:?}: {}", off / pitch);
        }
    }
}
