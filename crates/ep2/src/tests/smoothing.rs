//! Tests smoothing splines with valid and invalid points.

use palpate_statistics::BadSetting;

use crate::smoothing::{Smoothed, SmoothingSpline, WeightedPoint};
use crate::{Ep2Error, Status};

fn point(u: f64, v: f64, w: f64) -> WeightedPoint {
    WeightedPoint {
        u,
        v,
        w,
        weight: 1.0,
    }
}

fn grid(height: fn(f64, f64) -> f64) -> Vec<WeightedPoint> {
    let places = |index: usize| (index as f64 - 3.0) / 3.0;
    (0..49)
        .map(|index| (places(index / 7), places(index % 7)))
        .map(|(u, v)| point(u, v, height(u, v)))
        .collect()
}

fn fit(degree: usize, smoothing: f64, points: &[WeightedPoint]) -> Result<Smoothed, Ep2Error> {
    SmoothingSpline::new(degree, smoothing).fit(points)
}

#[test]
fn polynomials_are_interpolated() {
    let points = grid(|u, v| 3.0 - u * u * v + v * v);
    let smoothed = fit(2, 0.0, &points).unwrap();
    assert_eq!(smoothed.status, Status::Interpolating);
    assert!((smoothed.spline.value(0.1, 0.2) - 3.038).abs() < 1e-13);
    // The spline passes through all points. Therefore its values must not change if the coordinates u and v are scaled,
    // or if one point has another weight.
    for (size, weight) in [(1e-100, 1.0), (1e100, 1.0), (1.0, 1e-300), (1.0, 1e6)] {
        let mut points: Vec<_> = points
            .iter()
            .map(|one| point(one.u * size, one.v * size, one.w))
            .collect();
        points[7].weight = weight;
        for smoothing in [0.0, 1e-3] {
            let smoothed = fit(2, smoothing, &points).unwrap();
            let value = smoothed.spline.value(0.1 * size, 0.2 * size);
            assert!(
                (value - 3.038).abs() < 1e-11,
                "{size:e}, {weight:e}: {value}"
            );
        }
    }
    // The weight 1e150 of one point is so large that the other points are lost in rounding errors. Therefore only check
    // that the result is finite.
    let mut points = points;
    points[7].weight = 1e150;
    let spline = fit(2, 1e-3, &points).unwrap().spline;
    assert!(spline.coefficients.iter().all(|one| one.is_finite()));
    let level = fit(3, 0.0, &grid(|_, _| 0.0)).unwrap();
    assert_eq!(level.status, Status::Interpolating);
    assert!(level.spline.value(0.3, 0.4).abs() == 0.0);
}

#[test]
fn a_huge_sum_returns_the_polynomial() {
    let points = grid(|u, v| libm::sin(9.0 * u * v));
    for smoothing in [1e9, f64::MAX, f64::INFINITY] {
        let smoothed = fit(2, smoothing, &points).unwrap();
        assert_eq!(smoothed.status, Status::Polynomial);
        assert_eq!(smoothed.spline.coefficients.len(), 9);
        assert_eq!(smoothed.effective_unknowns, 9.0);
    }
}

#[test]
fn the_residual_sum_equals_the_requested_sum() {
    let points = grid(|u, v| libm::sin(4.0 * u) + libm::cos(3.0 * v));
    let mut before = 49.0;
    for smoothing in [0.01, 0.1, 1.0] {
        let smoothed = fit(3, smoothing, &points).unwrap();
        assert_eq!(smoothed.status, Status::Smoothing);
        assert!((smoothed.residual_sum / smoothing - 1.0).abs() <= 1e-3);
        let sum: f64 = points
            .iter()
            .map(|point| (point.w - smoothed.spline.value(point.u, point.v)).powi(2))
            .sum();
        assert!((sum / smoothed.residual_sum - 1.0).abs() < 1e-9);
        assert!(smoothed.effective_unknowns < before && smoothed.effective_unknowns > 16.0);
        before = smoothed.effective_unknowns;
    }
}

#[test]
fn knots_can_be_limited() {
    let spline = SmoothingSpline {
        most_knots: [1, 2],
        ..SmoothingSpline::new(2, 1e-6)
    };
    let smoothed = spline
        .fit(&grid(|u, v| libm::sin(4.0 * u) + libm::cos(5.0 * v)))
        .unwrap();
    assert_eq!(smoothed.status, Status::KnotsExhausted);
    assert_eq!(smoothed.spline.u.interior().len(), 1);
    assert_eq!(smoothed.spline.v.interior().len(), 2);
}

#[test]
fn weights_and_heights_in_other_units_have_the_same_spline() {
    let points = grid(|u, v| libm::sin(4.0 * u) + libm::cos(3.0 * v));
    let expected = fit(2, 1.0, &points).unwrap();
    for (height, weight) in [(-330, 0), (0, -300), (250, -100)] {
        let [height, weight] = [height, weight].map(|power| 2.0_f64.powi(power));
        let scaled: Vec<_> = points
            .iter()
            .map(|point| WeightedPoint {
                w: point.w * height,
                weight,
                ..*point
            })
            .collect();
        let smoothing = (height * weight).powi(2);
        let smoothed = fit(2, smoothing, &scaled).unwrap();
        assert_eq!(smoothed.status, expected.status);
        assert_eq!(
            smoothed.spline.value(0.3, 0.1) / height,
            expected.spline.value(0.3, 0.1)
        );
    }
}

/// Points on an inclined line determine only 5 of 9 coefficients, but the value on the line is correct.
#[test]
fn points_on_a_slanted_line_determine_a_polynomial_of_lower_rank() {
    let points: Vec<_> = (0..40)
        .map(|index| index as f64 / 39.0)
        .map(|t| point(t, 2.0 * t, t * t))
        .collect();
    let smoothed = fit(2, 1e-9, &points).unwrap();
    assert_eq!(smoothed.status, Status::Polynomial);
    assert_eq!(smoothed.rank, 5);
    assert!((smoothed.spline.value(0.5, 1.0) - 0.25).abs() < 1e-9);
}

#[test]
fn invalid_points_and_settings_are_refused() {
    let sound = grid(|u, v| u * v);
    let with = |change: fn(&mut WeightedPoint)| {
        let mut points = sound.clone();
        change(&mut points[5]);
        fit(2, 1.0, &points).unwrap_err()
    };
    assert_eq!(
        with(|one| one.w = f64::NAN),
        Ep2Error::NotFinite { contact: 5 }
    );
    assert_eq!(
        with(|one| one.u = f64::INFINITY),
        Ep2Error::NotFinite { contact: 5 }
    );
    assert_eq!(
        with(|one| one.weight = f64::NAN),
        Ep2Error::NotFinite { contact: 5 }
    );
    for weight in [0.0, -2.0] {
        let mut points = sound.clone();
        points[5].weight = weight;
        let expected = Ep2Error::BadWeight { contact: 5, weight };
        assert_eq!(fit(2, 1.0, &points), Err(expected));
    }
    let few = fit(3, 1.0, &sound[..15]).unwrap_err();
    assert!(matches!(
        few,
        Ep2Error::TooFewContacts {
            contacts: 15,
            needed: 16,
            ..
        }
    ));
    for (degree, smoothing, expected) in [
        (0, 1.0, "degree"),
        (6, 1.0, "degree"),
        (2, f64::NEG_INFINITY, "smoothing"),
        (2, f64::NAN, "smoothing"),
    ] {
        let error = fit(degree, smoothing, &sound).unwrap_err();
        assert!(
            matches!(error, Ep2Error::BadSetting(BadSetting { setting, .. }) if setting == expected)
        );
    }
    let line: Vec<_> = (0..20).map(|index| point(index as f64, 1.0, 0.0)).collect();
    assert!(matches!(
        fit(2, 1.0, &line),
        Err(Ep2Error::Collinear { .. })
    ));
}
