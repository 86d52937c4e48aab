//! Tests calibrations from data of the 2020 paper, and points for which a calibration is impossible.

use approx::assert_abs_diff_eq;
use palpate_tracking::{
    Calibration, CalibrationError, Change, LateralCalibration, LateralPoint, Line,
    NormalCalibration, NormalFrom, NormalPoint,
};

/// Data of Fig. 6b of the 2020 paper. Columns: object, normal displacement (mm), hue (turns).
const HUE: [(u8, f64, f64); 39] = [
    (0, 0.0929, 0.00342),
    (0, 0.1905, 0.00504),
    (0, 0.2880, 0.00582),
    (0, 0.3856, 0.01022),
    (0, 0.4832, 0.01430),
    (0, 0.5808, 0.01773),
    (0, 0.6784, 0.01609),
    (0, 0.7760, 0.02414),
    (0, 0.8736, 0.02544),
    (0, 0.9712, 0.02886),
    (0, 1.0688, 0.03387),
    (0, 1.1664, 0.03694),
    (0, 1.2640, 0.03656),
    (1, 0.0929, 0.00418),
    (1, 0.1905, 0.00616),
    (1, 0.2880, 0.00741),
    (1, 0.3856, 0.00828),
    (1, 0.4832, 0.00907),
    (1, 0.5808, 0.01229),
    (1, 0.6784, 0.01547),
    (1, 0.7760, 0.01694),
    (1, 0.8736, 0.02075),
    (1, 0.9712, 0.02472),
    (1, 1.0688, 0.02589),
    (1, 1.1664, 0.02885),
    (1, 1.2640, 0.03353),
    (2, 0.0929, 0.00390),
    (2, 0.1905, 0.00470),
    (2, 0.2880, 0.00550),
    (2, 0.3856, 0.00504),
    (2, 0.4832, 0.00735),
    (2, 0.5808, 0.00681),
    (2, 0.6784, 0.00719),
    (2, 0.7760, 0.01158),
    (2, 0.8736, 0.01494),
    (2, 0.9712, 0.01868),
    (2, 1.0688, 0.02118),
    (2, 1.1664, 0.02643),
    (2, 1.2640, 0.02859),
];

/// Data of Fig. 6c of the 2020 paper. Columns: tangential displacement (mm), shift of the centroid (px).
const SHIFT: [[f64; 2]; 21] = [
    [0.0001, 0.0001],
    [0.1001, 1.6218],
    [0.2001, 2.2795],
    [0.3001, 2.9784],
    [0.4001, 3.5450],
    [0.5000, 4.3539],
    [0.6001, 5.2669],
    [0.7000, 5.9049],
    [0.8000, 6.0898],
    [0.9000, 7.4788],
    [1.0000, 7.8549],
    [1.1000, 8.8098],
    [1.1999, 9.2073],
    [1.2999, 10.0514],
    [1.3999, 10.7208],
    [1.4999, 11.2233],
    [1.5999, 12.2318],
    [1.6999, 12.6530],
    [1.7998, 13.3637],
    [1.8998, 13.8282],
    [1.9998, 14.2978],
];

fn hue_points(series: impl Fn(u8) -> bool) -> Vec<NormalPoint> {
    let of_series = HUE.into_iter().filter(|point| series(point.0));
    of_series
        .map(|(_, normal, hue_turns)| NormalPoint {
            marker: None,
            normal,
            hue_turns,
            growth: 0.0,
        })
        .collect()
}

fn shift_points() -> Vec<LateralPoint> {
    let points = SHIFT.into_iter();
    points
        .map(|[tangential, shift]| LateralPoint {
            tangential: [tangential, 0.0],
            shift_px: [shift, 0.0],
            normal: None,
        })
        .collect()
}

/// Checks three numbers of a fitted line: slope, R², and rms residual. The expected numbers are rounded to multiples of
/// the numbers in `units`, so differences of half a unit are accepted.
#[track_caller]
fn assert_line(line: &Line, expected: [f64; 3], units: [f64; 3]) {
    let found = [line.slope, line.r_squared, line.residual_rms];
    for ((found, expected), unit) in found.into_iter().zip(expected).zip(units) {
        assert_abs_diff_eq!(found, expected, epsilon = 0.51 * unit);
    }
}

/// Tests the published line of the hue. The expected values for the line with an intercept were read off Fig. 6b
/// independently: a slope of 0.0258 turns/mm, R² of 0.85, and a residual of 0.15 mm. The residual is the rms residual
/// divided by the slope.
#[test]
fn the_published_hue() {
    let fitted = NormalCalibration::fit(&hue_points(|_| true), NormalFrom::Hue).unwrap();
    let line = fitted.with_intercept.unwrap();
    assert_line(&line, [0.0258, 0.85, 0.154], [1e-4, 0.01, 0.001]);
    assert_eq!((line.count, fitted.range), (39, [0.0929, 1.264]));
    // These expected standard errors were computed with another program.
    assert_abs_diff_eq!(line.slope_std.unwrap(), 0.00179, epsilon = 1e-5);
    assert_abs_diff_eq!(line.intercept.unwrap(), -0.00127, epsilon = 1e-5);
    assert_abs_diff_eq!(line.residual_std.unwrap(), 0.1579, epsilon = 1e-4);
    assert_line(&fitted.line, [0.02438, 0.8458, 0.1649], [1e-5, 1e-4, 1e-4]);
}

#[test]
fn the_published_hue_of_each_object() {
    let expected = [
        [0.03125, 0.9805, 0.0514],
        [0.02482, 0.9711, 0.0629],
        [0.02142, 0.8836, 0.1326],
    ];
    for (series, expected) in (0..).zip(expected) {
        let points = hue_points(|one| one == series);
        let fitted = NormalCalibration::fit(&points, NormalFrom::Hue).unwrap();
        assert_line(
            &fitted.with_intercept.unwrap(),
            expected,
            [1e-5, 1e-4, 1e-4],
        );
    }
}

/// Tests the published line of the shift. The expected slope, 7.0 px/mm, was read off Fig. 6c independently. The
/// expected R² of 0.99 is stated in the paper.
#[test]
fn the_published_shift() {
    let fitted = LateralCalibration::fit(&shift_points()).unwrap();
    let line = fitted.with_intercept.unwrap();
    assert_line(&line, [6.982, 0.996, 0.039], [1e-3, 1e-3, 1e-3]);
    assert_abs_diff_eq!(line.intercept.unwrap(), 0.816, epsilon = 1e-3);
    assert_line(&fitted.line, [7.579, 0.986, 0.066], [1e-3, 1e-3, 1e-3]);
    assert_eq!(fitted.px_per_length, fitted.line.slope);
}

#[test]
fn calibrated_changes_give_their_displacements() {
    let normals = || (1..5).map(|step| 0.3 * f64::from(step));
    let normal: Vec<NormalPoint> = normals()
        .map(|normal| NormalPoint {
            marker: Some(3),
            normal,
            hue_turns: -0.02 * normal,
            growth: 0.0,
        })
        .collect();
    let lateral: Vec<LateralPoint> = normals()
        .map(|normal| {
            let tangential = [0.1 * normal, 0.2];
            LateralPoint {
                tangential,
                shift_px: tangential.map(|one| (7.0 + normal) * one),
                normal: Some(normal),
            }
        })
        .collect();
    let normal = NormalCalibration::fit(&normal, NormalFrom::Hue).unwrap();
    let lateral = LateralCalibration::fit(&lateral).unwrap();
    let fitted = Calibration::new(Some(normal), Some(lateral), Some(77)).unwrap();
    assert_eq!(fitted.lateral_part.as_ref(), Some(&lateral));
    let change = Change {
        hue_turns: -0.012,
        ..Change::default()
    };
    assert_abs_diff_eq!(fitted.normal(0, &change).unwrap(), 0.6, epsilon = 1e-12);
    let read = fitted.tangential([0.76, -1.52], 0.6).unwrap();
    assert_abs_diff_eq!(read[0], 0.1, epsilon = 1e-9);
    assert_abs_diff_eq!(read[1], -0.2, epsilon = 1e-9);
    assert_eq!(fitted.normal(0, &Change::default()), Some(0.0));
    assert_eq!(fitted.fits(77), Ok(()));
    assert_eq!(fitted.fits(70), Ok(()));
    let error = CalibrationError::AnotherLayout {
        calibrated: 77,
        found: 69,
    };
    assert_eq!(fitted.fits(69), Err(error));
    let by_number = fitted.normal_part.as_ref().unwrap().clone().per_marker();
    let fitted = Calibration::new(Some(by_number), None, Some(77)).unwrap();
    assert!(fitted.fits(77).is_ok() && fitted.fits(76).is_err());
}

fn name_of(error: CalibrationError) -> &'static str {
    error.into()
}

fn point(normal: f64, hue_turns: f64) -> NormalPoint {
    NormalPoint {
        marker: Some(0),
        normal,
        hue_turns,
        growth: hue_turns,
    }
}

#[test]
fn points_without_a_slope_are_refused() {
    let refusals = [
        (vec![], "too-few-points"),
        (vec![point(1.0, 0.02)], "too-few-points"),
        (vec![point(1.0, 0.02); 5], "one-displacement"),
        (vec![point(0.0, 0.0), point(0.0, 0.1)], "one-displacement"),
        (vec![point(0.0, 0.02), point(1.0, 0.02)], "no-slope"),
        (vec![point(0.0, 0.0), point(1.0, 0.0)], "no-slope"),
        (vec![point(0.0, 0.0), point(1.0, f64::NAN)], "not-finite"),
        (
            vec![point(f64::INFINITY, 0.0), point(1.0, 0.1)],
            "not-finite",
        ),
        (vec![point(1e200, 0.0), point(1.0, 0.1)], "not-finite"),
    ];
    for (points, name) in refusals {
        for from in NormalFrom::ALL {
            let error = NormalCalibration::fit(&points, from).unwrap_err();
            assert_eq!(name_of(error), name, "{points:?} from {from:?}");
        }
    }
    let flat = [point(0.0, 0.0), point(1.0, 0.0)];
    let error = NormalCalibration::fit(&flat, NormalFrom::Both).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the weighted sum of hue and size does not change with the displacement: there is no slope to calibrate"
    );
    // The error names the first invalid point.
    let points = [point(0.0, 0.0), point(1.0, f64::NAN)];
    let error = NormalCalibration::fit(&points, NormalFrom::Hue).unwrap_err();
    assert_eq!(error, CalibrationError::NotFinite { point: 1 });
}

#[test]
fn a_centroid_that_shifts_backward_at_some_depth_is_refused() {
    let points =
        [(0.1, 0.0), (0.2, 0.0), (0.1, 1.0), (0.2, 1.0)].map(|(tangential, normal)| LateralPoint {
            tangential: [tangential, 0.0],
            shift_px: [(7.0 - 9.0 * normal) * tangential, 0.0],
            normal: Some(normal),
        });
    let error = LateralCalibration::fit(&points).unwrap_err();
    assert_eq!(
        error,
        CalibrationError::NoSlope {
            what: "the centroid"
        }
    );
}

#[test]
fn lines_of_any_size_have_their_slope() {
    let of = |x: f64, y: f64| {
        let points = [0.2, 0.4, 0.6, 0.8, 1.0].map(|share| point(share * x, share * y));
        NormalCalibration::fit(&points, NormalFrom::Hue)
    };
    for (x, y) in [(1e-100, 1e100), (1e100, 1e100), (5e-324, 5e-324)] {
        let found = of(x, y).unwrap();
        for line in [found.line, found.with_intercept.unwrap()] {
            let slope = line.slope;
            assert!((slope / (y / x) - 1.0).abs() < 1e-12, "{slope:e}");
        }
    }
    for (x, y) in [(1e-320, 1.0), (1e100, 1e-300)] {
        assert_eq!(name_of(of(x, y).unwrap_err()), "out-of-range");
    }
}

/// Tests changes of any size with a simple calibration. Its displacement is 10 times the hue change in turns, or 5
/// times the nearness 1 − exp(−growth). The nearness is at most 1.
#[test]
fn changes_of_any_size_give_a_displacement_or_none() {
    let points: Vec<NormalPoint> = (0..9)
        .map(|step| {
            let share = f64::from(step) / 8.0;
            NormalPoint {
                marker: Some(step as usize % 2),
                normal: share,
                hue_turns: 0.1 * share,
                growth: -libm::log(1.0 - 0.2 * share),
            }
        })
        .collect();
    for (from, change, expected) in [
        (NormalFrom::Hue, -1e300, Some(-1e301)),
        (NormalFrom::Hue, f64::INFINITY, None),
        (NormalFrom::Size, f64::INFINITY, Some(5.0)),
        (NormalFrom::Size, -1e300, None),
        (NormalFrom::Both, 1e300, Some(5e300)),
        (NormalFrom::Both, -1e300, None),
        (NormalFrom::Both, f64::NAN, None),
    ] {
        let fitted = NormalCalibration::fit(&points, from).unwrap();
        let calibration = Calibration::new(Some(fitted), None, None).unwrap();
        let change = Change {
            hue_turns: change,
            growth: change,
            ..Change::default()
        };
        for marker in [0, usize::MAX] {
            let found = calibration.normal(marker, &change);
            assert_eq!(found.is_some(), expected.is_some(), "{from:?} {change:?}");
            if let (Some(found), Some(expected)) = (found, expected) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{found:e}");
            }
        }
    }
    for slope in [0.0, f64::NAN, 5e-324] {
        let mut fitted = NormalCalibration::fit(&points, NormalFrom::Hue).unwrap();
        fitted.line.slope = slope;
        let error = Calibration::new(Some(fitted), None, None).unwrap_err();
        assert_eq!(name_of(error), "out-of-range");
    }
}
