//! Compares the search for the nearest pad of the uniform lattice with a search through all pads.

use nalgebra::Vector3;
use palpate_sensing::UniformLattice;
use proptest::prelude::*;

fn brute_force(lattice: &UniformLattice, direction: &Vector3<f64>) -> f64 {
    (0..lattice.pads())
        .map(|index| (lattice.direction(index) - direction).norm())
        .fold(f64::INFINITY, f64::min)
}

fn direction(z: f64, azimuth: f64) -> Vector3<f64> {
    let sine = (1.0 - z * z).max(0.0).sqrt();
    Vector3::new(sine * libm::cos(azimuth), sine * libm::sin(azimuth), z)
}

/// Heights on the unit sphere. Half of them are near the upper pole, where the lattice is irregular.
fn height() -> impl Strategy<Value = f64> {
    prop_oneof![-1.0..1.0_f64, (0.0..1.0_f64).prop_map(libm::cos)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn nearest_is_nearest(pitch in 0.05..1.0_f64, z in height(), azimuth in -3.15..3.15_f64) {
        let lattice = UniformLattice::with_pitch(pitch).unwrap();
        let at = direction(z, azimuth);
        let found = (lattice.direction(lattice.nearest(&at)) - at).norm();
        prop_assert!(found <= brute_force(&lattice, &at) + 1e-12);
    }

    #[test]
    fn every_pad_is_nearest_to_itself(exponent in 1.0..6.0_f64, fraction in 0.0..1.0_f64) {
        let lattice = UniformLattice::with_pitch(libm::pow(10.0_f64, -exponent)).unwrap();
        let index = (fraction * (lattice.pads() - 1) as f64) as u64;
        prop_assert_eq!(lattice.nearest(&lattice.direction(index)), index);
    }

    #[test]
    fn a_pad_is_never_far(exponent in 0.5..6.0_f64, z in -1.0..1.0_f64, azimuth in -3.15..3.15_f64) {
        let pitch = libm::pow(10.0_f64, -exponent);
        let lattice = UniformLattice::with_pitch(pitch).unwrap();
        let at = direction(z, azimuth);
        let found = (lattice.direction(lattice.nearest(&at)) - at).norm();
        // Far from the poles, the lattice resembles a plane lattice, and every point of the sphere is at most 0.83
        // pitches from its nearest pad. Near a pole, the distance is at most 1 pitch. The test allows a little more.
        prop_assert!(found < 1.05 * pitch, "{found} pitches {}", found / pitch);
    }
}
