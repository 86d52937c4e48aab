//! Tests sensors with arbitrary arguments, including infinities and NaN: they return finite readings or errors with a
//! name.

use nalgebra::{Point3, Vector2, Vector3};
use palpate_sensing::{
    AngularVelocityError, Channel, Distribution, Encoder, GaussianError, NormalError, PadLayout,
    PadOffset, Pads, PositionAxes, PositionError, Stream, UniformLattice, Wrist, direction_at,
    displacement_between,
};
use palpate_statistics::BadSetting;
use proptest::prelude::*;

/// Any double-precision number, a number of ordinary size, or a limit of a setting.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -2.0..2.0_f64,
        (-12.0..3.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        proptest::sample::select(&LIMITS[..]),
    ]
}

const LIMITS: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    -1.0,
    0.0,
    -0.0,
    5e-324,
    1e-16,
    1e-8,
    1.0 + f64::EPSILON,
    3.0,
    3.15,
    f64::MAX,
];

fn is_tame(value: f64) -> bool {
    value.abs() <= 1e150
}

fn is_lattice(pitch_rad: f64) -> bool {
    let pads = (4.0 * std::f64::consts::PI / (pitch_rad * pitch_rad)).round();
    pitch_rad > 0.0 && (2.0..=1e15).contains(&pads)
}

/// Returns the sensor, or `None` if its parameters are invalid. Panics if valid parameters (`is_good`) are rejected, or
/// if invalid parameters are accepted.
fn made_if<T: std::fmt::Debug>(is_good: bool, made: Result<T, BadSetting<String>>) -> Option<T> {
    assert_eq!(made.is_ok(), is_good, "{made:?}");
    made.ok()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..Default::default() })]

    #[test]
    fn pads_read_numbers_or_errors(
        made in [number(), number(), number()],
        moved in [number(), number()],
        trial in any::<u64>(),
    ) {
        let [radius, share, cap] = made;
        for layout in [PadLayout::Square, PadLayout::Uniform] {
            for offset in [PadOffset::Centred, PadOffset::Random] {
                let pitch = share * radius;
                let is_good = radius > 0.0 && (radius * std::f64::consts::TAU).is_finite() && pitch > 0.0 && pitch <= radius
                    && pitch / radius >= 1e-15 && cap > 0.0 && cap <= std::f64::consts::PI
                    && (layout == PadLayout::Square || is_lattice(pitch / radius));
                let Some(pads) = made_if(is_good, Pads::new(radius, pitch, layout, offset, cap)) else { continue };
                let placement = pads.place(&mut Stream::new(1, trial, Channel::PadOffset));
                let displacement = Vector2::from(moved) * radius;
                if let Ok(read) = pads.read(&placement, &displacement) {
                    prop_assert!(read.iter().all(|length| length.is_finite()), "{pads:?}: {read}");
                }
            }
        }
    }

    #[test]
    fn a_lattice_finds_a_pad_for_any_direction(
        pitch in number(),
        towards in [number(), number(), number()],
    ) {
        if let Some(lattice) = made_if(is_lattice(pitch), UniformLattice::with_pitch(pitch)) {
            let pad = lattice.nearest(&Vector3::from(towards));
            prop_assert!(pad < lattice.pads());
            prop_assert!((lattice.direction(pad).norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_of_any_size_is_finite(
        size in number(),
        radius in number(),
        place in [number(), number(), number()],
        trial in any::<u64>(),
    ) {
        let mut stream = Stream::new(2, trial, Channel::Position);
        let is_size = (0.0..=1e150).contains(&size);
        let is_wrist = (0.0..f64::INFINITY).contains(&size) && radius > 0.0 && radius <= 1e300 && size / radius <= 1e150;
        prop_assume!(place.iter().all(|&x| is_tame(x)));
        for distribution in [Distribution::Uniform, Distribution::Gaussian] {
            if let Some(error) = made_if(is_size, AngularVelocityError::new(distribution, size)) {
                let drawn = error.draw(&mut stream, place[0]);
                prop_assert!(drawn.iter().all(|rate| rate.is_finite()), "{error:?}: {drawn}");
                prop_assert!(error.relative_std().is_finite());
            }
            if let Some(error) = made_if(is_size, PositionError::new(distribution, size, PositionAxes::Xyz)) {
                let read = error.read(&mut stream, &Point3::from(place));
                prop_assert!(read.iter().all(|x| x.is_finite()), "{error:?}: {read}");
            }
        }
        if let Some(error) = made_if(is_size, GaussianError::new(size)) {
            prop_assert!(error.draw(&mut stream).is_finite());
            prop_assert!(error.averaged(3).std().is_finite());
        }
        if let Some(error) = made_if((0.0..=std::f64::consts::PI).contains(&size), NormalError::new(size, 0.0)) {
            let read = error.read(&mut stream, &Vector3::x());
            prop_assert!((read.norm() - 1.0).abs() < 1e-14);
        }
        if let Some(wrist) = made_if(is_wrist, Wrist::new(size, radius)) {
            let far = Vector2::new(place[0], place[1]) * radius;
            if far.iter().all(|x| is_tame(x / radius)) {
                let read = wrist.read(&mut stream, &far);
                let angle = (read / radius).norm();
                prop_assert!(angle <= 3.15 || radius < 1e-300, "{wrist:?}: {read}");
            }
        }
        if let Some(encoder) = made_if(size > 0.0 && size.is_finite(), Encoder::new(size)) {
            let turned = Vector2::new(place[0], place[1]);
            let read = encoder.read(&mut stream, &turned);
            for (read, angle) in read.iter().zip(&turned) {
                // The test allows an error of one step plus rounding errors. If the step is smaller than the rounding
                // error of the angle, the reading is equal to the angle.
                let bound = size + 2.0 * f64::EPSILON * angle.abs();
                prop_assert!((read - angle).abs() <= bound, "{encoder:?}: {read:e}, not {angle:e}");
            }
        }
    }

    #[test]
    fn the_maps_of_the_sphere_undo_each_other(
        angle in (-12.0..0.49_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        azimuth in -3.2..3.2_f64,
        far in [number(), number()],
    ) {
        let (sin, cos) = libm::sincos(azimuth);
        let displacement = Vector2::new(cos, sin) * angle;
        let due = Vector3::new(cos * libm::sin(angle), sin * libm::sin(angle), libm::cos(angle));
        prop_assert!((direction_at(&displacement) - due).amax() <= 3e-15);
        let back = displacement_between(&Vector3::z(), &direction_at(&displacement));
        // Near −z, the point opposite the start of the displacement, a small error of the direction causes a large
        // error of the displacement. Therefore the bound is larger there.
        let bound = 1e-15 * angle * (1.0 + angle / libm::sin(angle));
        prop_assert!((back - displacement).norm() <= bound.max(4e-16 * angle), "{back}");
        if far.iter().all(|&x| is_tame(x)) {
            prop_assert!((direction_at(&Vector2::from(far)).norm() - 1.0).abs() < 1e-14);
        }
    }
}

#[test]
fn displacements_too_small_to_be_squared_are_on_the_cap_and_large_ones_are_not() {
    for radius in [1e-200, 1.0, 1e200] {
        let pads = Pads::new(
            radius,
            0.1 * radius,
            PadLayout::Square,
            PadOffset::Centred,
            1.0,
        );
        let pads = pads.unwrap();
        let placement = pads.place(&mut Stream::new(1, 0, Channel::PadOffset));
        let read = |share: f64| pads.read(&placement, &(Vector2::new(share, 0.0) * radius));
        assert!(read(0.5).is_ok() && read(1e-100).is_ok());
        assert_eq!(read(1.1).unwrap_err().angle_rad, 1.1);
        assert!(read(f64::NAN).is_err());
    }
}

#[test]
fn rates_err_by_the_stated_share() {
    for (distribution, std) in [
        (Distribution::Gaussian, 0.02),
        (Distribution::Uniform, 0.02 / 3f64.sqrt()),
    ] {
        let error = AngularVelocityError::new(distribution, 0.02).unwrap();
        let mut stream = Stream::new(7, 0, Channel::Position);
        let squares: f64 = (0..10_000)
            .map(|_| error.draw(&mut stream, 5.0).norm_squared())
            .sum();
        // For 20,000 Gaussian draws, the root mean square has a relative standard error of 0.5 %. The limit is five
        // standard errors.
        let share = (squares / 20_000.0).sqrt() / (5.0 * std);
        assert!((share - 1.0).abs() < 0.025, "{distribution:?}: {share}");
        assert!((error.relative_std() - std).abs() < 1e-15);
    }
}
