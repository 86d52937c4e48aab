//! Tests the errors of measured surface normals.

use approx::assert_relative_eq;
use nalgebra::Vector3;
use palpate_sensing::{Channel, NormalError, Stream};

fn normals() -> [Vector3<f64>; 5] {
    [
        Vector3::z(),
        -Vector3::z(),
        Vector3::y(),
        Vector3::x(),
        Vector3::new(0.36, -0.48, 0.8),
    ]
}

#[test]
fn tilts_have_the_stated_size_and_no_direction() {
    let sensor = NormalError::new(0.05, 0.0).unwrap();
    for normal in normals() {
        let mut stream = Stream::new(12, 0, Channel::Normal);
        let count = 40_000;
        let (mut sum, mut square, mut tilts) = (Vector3::zeros(), nalgebra::Matrix3::zeros(), 0.0);
        for _ in 0..count {
            let read = sensor.read(&mut stream, &normal);
            assert!((read.norm() - 1.0).abs() < 1e-15);
            let across = read - normal * normal.dot(&read);
            sum += across;
            square += across * across.transpose();
            tilts += libm::atan2(normal.cross(&read).norm(), normal.dot(&read)).powi(2);
        }
        let count = f64::from(count);
        assert!(sum.norm() / count < 0.05 * 3.0 / count.sqrt() * 1.5);
        assert_relative_eq!(
            (tilts / count).sqrt(),
            0.05 * 2.0_f64.sqrt(),
            max_relative = 0.02
        );
        // For a small standard deviation σ of the tilt, measurements of the normal n have the covariance σ² (I − n nᵀ).
        // Terms of higher order in σ are neglected.
        let expected = nalgebra::Matrix3::identity() - normal * normal.transpose();
        assert!((square / count / 0.0025 - expected).amax() < 0.03);
    }
}

#[test]
fn a_bias_turns_all_normals_alike() {
    let sensor = NormalError::new(0.0, 0.1).unwrap();
    let mut stream = Stream::new(12, 0, Channel::Normal);
    let read = sensor.read(&mut stream, &Vector3::z());
    assert_relative_eq!(read, Vector3::new(0.1_f64.sin(), 0.0, 0.1_f64.cos()));
    assert!(NormalError::new(0.0, 4.0).is_err());
}

#[test]
fn tilts_beyond_a_half_turn_stay_unit_vectors() {
    let sensor = NormalError::new(3.0, 0.0).unwrap();
    let mut stream = Stream::new(12, 1, Channel::Normal);
    let mut mean = Vector3::zeros();
    for _ in 0..10_000 {
        let read = sensor.read(&mut stream, &Vector3::x());
        assert!((read.norm() - 1.0).abs() < 1e-15);
        mean += read / 1e4;
    }
    // The tilt angle has a Rayleigh distribution with σ = 3. The mean cosine of this angle is 1 − √2 σ D(σ/√2), with
    // Dawson's integral D.
    let expected = Vector3::x() * -0.1795;
    assert!((mean - expected).norm() < 0.03, "{mean}");
}
