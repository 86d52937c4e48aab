//! Fits shapes to random contacts, and tests the fitted sizes, their intervals and the choice of the shape. If an
//! assertion fails, its message contains the measured shares of successful cases.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Noise, Shape, ShapeError, ShapeFit, ShapeSettings};

use super::drawn_shapes::{Random, Surface, ball_log, inside, noisy, placed};

pub(super) fn fit(shape: Option<Shape>, contacts: &[Contact]) -> Result<ShapeFit, ShapeError> {
    let settings = ShapeSettings {
        shape,
        ..ShapeSettings::default()
    };
    settings.fit(contacts)
}

pub(super) fn sphere(contacts: &[Contact]) -> ShapeFit {
    fit(Some(Shape::Sphere), contacts).unwrap()
}

pub(super) fn holds(fit: &ShapeFit, radius: f64) -> bool {
    let [low, high] = fit.radius.interval95;
    low.is_none_or(|low| low <= radius) && high.is_none_or(|high| high >= radius)
}

pub(super) fn half_width(fit: &ShapeFit) -> f64 {
    let [low, high] = fit
        .radius
        .interval95
        .map(|end| end.unwrap_or(f64::INFINITY));
    0.5 * (high - low)
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Fits shapes to contacts on random caps. Returns the share of fits whose interval contains the true radius, and the
/// share of fits in which the radius is determined. `ratios` contains the smallest and the largest value of s √n /
/// noise, where s is the sagitta of the cap and n the number of contacts. Cases are skipped if the noise exceeds
/// `max_noise` times the extent of the contacts.
fn coverage(shape: Shape, with_normals: bool, ratios: [f64; 2], max_noise: f64) -> [f64; 2] {
    let [mut held, mut resolved, mut count] = [0.0; 3];
    for case in 0..120 {
        let mut random = Random::new(10_000 + case);
        let radius = random.scale(5.0, 200.0);
        let angle = random.between(5.0, 60.0_f64).to_radians();
        let (extent, sagitta) = (radius * angle, radius * (1.0 - libm::cos(angle)));
        let contacts = random.scale(20.0, 3000.0) as usize;
        let ratio = random.scale(ratios[0], ratios[1]);
        let noise = sagitta * (contacts as f64).sqrt() / ratio;
        let normal_std = with_normals.then(|| random.scale(0.002, 0.05));
        if noise > max_noise * extent {
            continue;
        }
        let surface = match shape {
            Shape::Sphere => Surface::Sphere(radius),
            _ => Surface::Cylinder(radius),
        };
        let exact = surface.disc(&mut random, extent, contacts);
        let mut log = noisy(&mut random, &exact, 0, noise, normal_std);
        if with_normals && case % 2 == 0 {
            log = inside(&log);
        }
        let fit = fit(Some(shape), &placed(&mut random, &log, 3.0 * radius)).unwrap();
        count += 1.0;
        held += f64::from(holds(&fit, radius));
        resolved += f64::from(fit.radius.value.is_some());
    }
    let [held, resolved] = [held / count, resolved / count];
    [held, resolved]
}

#[test]
fn intervals_hold_the_radius() {
    let mut worst: f64 = 1.0;
    for shape in [Shape::Sphere, Shape::Cylinder] {
        for with_normals in [false, true] {
            let [held, resolved] = coverage(shape, with_normals, [20.0, 3000.0], 0.03);
            worst = worst.min(held).min(resolved);
        }
        let [held, _] = coverage(shape, false, [20.0, 3000.0], 0.2);
        worst = worst.min(held);
        let [held, resolved] = coverage(shape, false, [1.0, 10.0], 0.5);
        worst = worst.min(held).min(1.0 - 0.4 * resolved);
    }
    assert!(worst > 0.88, "{worst}");
}

#[test]
fn gauge_balls_and_cups_have_their_radius() {
    for case in 0..20 {
        let mut random = Random::new(30_000 + case);
        let extent = 40.0 * 20.0_f64.to_radians();
        let exact = Surface::Sphere(40.0).disc(&mut random, extent, 300);
        let fit = sphere(&inside(&noisy(&mut random, &exact, 0, 0.05, Some(0.01))));
        assert!(fit.curvature.value.unwrap() < 0.0);
        assert!((fit.radius.value.unwrap() / 40.0 - 1.0).abs() < 0.01);
    }
    // A dense scan of the inside of a cup with a radius of 9.5.
    let extent = 9.5 * 45.0_f64.to_radians();
    let exact = Surface::Sphere(9.5).disc(&mut Random::new(30_000), extent, 25_000);
    let scan = noisy(&mut Random::new(30_001), &exact, 0, 0.05, Some(0.01));
    let dense = sphere(&inside(&scan));
    let off = dense.radius.value.unwrap() / 9.5 - 1.0;
    assert!(off.abs() < 0.01 && holds(&dense, 9.5), "{off}");
    // The recording of a gauge ball contains neither normals nor an order of the contacts.
    let text = include_str!("glide-scan-of-a-ball9.5.csv");
    let contacts = text.lines().skip(1).map(|line| {
        let mut xyz = line.split(',').map(|word| word.parse().unwrap());
        let place = Point3::from([(); 3].map(|()| xyz.next().unwrap()));
        Contact::new(0, place, None)
    });
    let fit = fit(None, &contacts.collect::<Vec<_>>()).unwrap();
    assert!(fit.shape == Shape::Sphere && (fit.radius.value.unwrap() / 9.5 - 1.0).abs() < 0.003);
}

#[test]
fn the_right_shape_is_chosen() {
    let mut confusion = [[0_u32; 4]; 6];
    for case in 0..6 * 40 {
        let kind = case as usize % 6;
        let mut random = Random::new(40_000 + case);
        let extent = random.scale(3.0, 50.0);
        let radius = extent / random.between(15.0, 60.0_f64).to_radians();
        let surface = match kind {
            0 => Surface::Plane,
            1 => Surface::Sphere(radius),
            2 => Surface::Cylinder(radius),
            3 => Surface::Saddle(radius, random.between(0.4, 1.0)),
            4 => Surface::Torus(radius, radius * random.between(1.0, 3.0)),
            _ => {
                let length = extent * random.between(1.0, 3.0);
                Surface::Wave(
                    extent * random.between(0.05, 0.15),
                    length,
                    random.between(0.0, 6.3),
                )
            }
        };
        let (fingers, each) = (3 + case as usize % 5, random.scale(15.0, 100.0) as usize);
        let exact = match random.uniform() < 0.5 {
            true => surface.strokes(0.8 * extent, fingers, each),
            false => surface.disc(&mut random, extent, fingers * each),
        };
        let noise = extent * random.scale(0.001, 0.006);
        let normal_std = (random.uniform() < 0.5).then_some(0.01);
        let contacts = noisy(&mut random, &exact, each, noise, normal_std);
        // In every second case, the noise is stated.
        let stated = Noise {
            position_std: Some(noise),
            normal_std_rad: normal_std,
        };
        let settings = ShapeSettings {
            noise: [Noise::default(), stated][case as usize / 6 % 2],
            ..ShapeSettings::default()
        };
        let contacts = placed(&mut random, &contacts, 2.0 * extent);
        let fit = settings.fit(&contacts).unwrap();
        confusion[kind][if fit.is_none_of_these() {
            3
        } else {
            fit.shape as usize
        }] += 1;
    }
    let right: u32 = (0..3).map(|kind| confusion[kind][kind]).sum();
    let wrong: u32 = confusion[3..].iter().flat_map(|row| &row[..3]).sum();
    assert!(f64::from(right) > 0.97 * 120.0, "{confusion:?}");
    assert!(f64::from(wrong) < 0.05 * 120.0, "{confusion:?}");
}

/// The distances of exact contacts from the right shape are rounding errors. They must not count as a misfit, also if
/// the printed heights have few decimals.
#[test]
fn exact_planes_and_cylinders_are_chosen() {
    for (shape, decimals) in [
        (Shape::Plane, 1e16),
        (Shape::Cylinder, 1e16),
        (Shape::Plane, 1e4),
        (Shape::Cylinder, 1e4),
    ] {
        let height = |x: f64, y: f64| match shape {
            Shape::Plane => 0.23717 * x + 0.119305 * y,
            _ => (900.0 - y * y).sqrt(),
        };
        let contacts = (0..400).map(|row| {
            let [x, y] = [row % 20, row / 20].map(|line| f64::from(line) - 9.5);
            let height = (height(x, y) * decimals).round() / decimals;
            Contact::new(row as usize / 20, Point3::new(x, y, height), None)
        });
        let fit = fit(None, &contacts.collect::<Vec<_>>()).unwrap();
        assert!(fit.shape == shape && !fit.is_none_of_these(), "{fit:?}");
    }
}

/// The waves are shorter than the patch, and along each stroke they look like correlated noise. They must not be
/// accepted as noise.
#[test]
fn short_waves_are_no_correlated_noise() {
    for case in 0..24 {
        let random = &mut Random::new(45_000 + case);
        let normals = (case % 2 == 0).then_some(0.017);
        let each = if case % 4 < 2 { 30 } else { 12 };
        let [height, length] = [random.between(0.3, 1.0), random.between(8.0, 16.0)];
        let wave = Surface::Wave(height, length, random.between(0.0, TAU));
        let contacts = noisy(random, &wave.strokes(10.0, 5, each), each, 0.05, normals);
        assert!(fit(None, &contacts).unwrap().is_none_of_these(), "{case}");
    }
}

/// Scans of a ball. The measured heights are rounded to steps that are much larger than the noise.
#[test]
fn intervals_of_rounded_heights_hold_the_radius() {
    let held = (0..40).filter(|case| {
        let random = &mut Random::new(46_000 + case);
        let [step, side] = [random.between(0.4, 1.0), random.between(10.0, 16.0)];
        let phase = random.uniform();
        let places = (-25..=25).flat_map(|x| (-25..=25).map(move |y| [x, y].map(f64::from)));
        let scan = places.enumerate().map(|(row, place)| {
            let [x, y] = place.map(|one| one / 25.0 * side);
            let height = (20.0_f64.powi(2) - x * x - y * y).max(0.0).sqrt();
            let rounded = (height / step + phase).round() * step;
            (x.hypot(y) < side).then(|| Contact::new(row, Point3::new(x, y, rounded), None))
        });
        let scan: Vec<Contact> = scan.flatten().collect();
        holds(&sphere(&scan), 20.0)
    });
    let held = held.count();
    assert!(held >= 36, "{held}");
}

/// Strokes along a pipe, with coordinates that are rounded to steps larger than the noise. All contacts of a stroke may
/// have the same rounding error, so the residuals do not show these errors.
#[test]
fn intervals_of_rounded_strokes_along_a_pipe_hold_the_radius() {
    let held = (0..60).filter(|case| {
        let random = &mut Random::new(48_000 + case);
        let (radius, width) = (random.between(20.0, 50.0), random.between(0.5, 0.8));
        let [step, noise] = [
            [0.1, 0.25, 0.5][*case as usize % 3],
            random.between(0.0, 0.3),
        ];
        let phase = random.vector();
        let contacts = (0..180).map(|row| {
            let [x, y] = [row % 60, row / 60].map(f64::from);
            let y = (y - 1.0) * 0.5 * width * radius;
            let place = Vector3::new(0.5 * x, y, (radius * radius - y * y).sqrt());
            let place = place + (phase + random.vector() * noise) * step;
            let rounded = place.map(|one| (one / step).round() * step);
            Contact::new(row as usize / 60, Point3::from(rounded), None)
        });
        let fit = fit(None, &contacts.collect::<Vec<_>>()).unwrap();
        assert_eq!((fit.shape, fit.outliers.len()), (Shape::Cylinder, 0));
        holds(&fit, radius)
    });
    let held = held.count();
    assert!(held >= 55, "{held}");
}

/// Rasters along and across a pipe without noise. Each coordinate is rounded. All contacts on a line along the pipe have
/// the same error.
#[test]
fn rounded_rasters_on_a_pipe_have_few_errors() {
    let held = (0..40).filter(|case| {
        let random = &mut Random::new(49_000 + case);
        let (radius, share) = (random.between(15.0, 80.0), random.between(0.2, 0.5));
        let step = [1e-1, 1e-3, 1e-6][*case as usize % 3];
        let contacts = (0..441).map(|row| {
            let [x, y] = [row % 21, row / 21].map(|line| f64::from(line - 10) / 10.0 * share);
            let place = Vector3::new(x, y, (1.0 - x * x).sqrt()) * radius;
            let rounded = place.map(|one| (one / step).round() * step);
            Contact::new(row as usize / 21, Point3::from(rounded), None)
        });
        let fit = fit(None, &contacts.collect::<Vec<_>>()).unwrap();
        assert!(!fit.is_none_of_these(), "{case}");
        holds(&fit, radius)
    });
    // Contacts along a ridge of a wave also have equal distances from the fitted shape, but these are larger than the
    // rounding errors.
    let wave = (0..441).map(|row| {
        let [x, y] = [row % 21, row / 21].map(|line| f64::from(line - 10));
        let height = ((x / 3.0).sin() * 1e6).round() / 1e6;
        Contact::new(row as usize / 21, Point3::new(x, y, height), None)
    });
    let wave = fit(None, &wave.collect::<Vec<_>>()).unwrap();
    assert!(wave.is_none_of_these(), "{wave:?}");
    let held = held.count();
    assert!(held >= 35, "{held}");
}

/// An error tangential to a ball moves a contact away from the ball's centre, whatever the direction of the error. A
/// fit to many contacts must correct this bias of the radius.
#[test]
fn noise_along_a_ball_does_not_enlarge_it() {
    for normal_std in [None, Some(0.1)] {
        let held = (0..10).filter(|case| {
            let random = &mut Random::new(47_000 + case);
            let contacts = (0..20_000).map(|row| {
                let out = random.vector().normalize();
                let place = out * 20.0 + random.vector() * 0.8;
                let normal = normal_std.map(|std| out + random.vector() * std);
                Contact::new(row, Point3::from(place), normal)
            });
            holds(&sphere(&contacts.collect::<Vec<_>>()), 20.0)
        });
        let held = held.count();
        assert!(held >= 8, "{held}, {normal_std:?}");
    }
}

#[test]
fn bad_logs_are_errors() {
    let at = |x: f64, y: f64, z: f64| Contact::new(0, Point3::new(x, y, z), None);
    let shapes = [
        None,
        Some(Shape::Plane),
        Some(Shape::Sphere),
        Some(Shape::Cylinder),
    ];
    let line = (0..50).map(|i| at(f64::from(i), 0.0, 0.0)).collect();
    let two = (0..50)
        .map(|i| at(f64::from(i % 2), 0.0, 1e-9 * f64::from(i)))
        .collect();
    let exact = (0..6)
        .map(|i| at(f64::from(i % 3), f64::from(i / 3), 0.0))
        .collect();
    let large = (0..50)
        .map(|i| at(1e149 * f64::from(i), f64::from(i * i), 0.0))
        .collect();
    let logs: [(Vec<Contact>, Option<&str>); 8] = [
        (Vec::new(), Some("too-few-contacts")),
        (vec![at(1.0, 2.0, 3.0)], Some("too-few-contacts")),
        (vec![at(1.0, 2.0, 3.0); 50], Some("too-few-contacts")),
        (vec![at(f64::NAN, 2.0, 3.0); 50], Some("not-finite")),
        (line, None),
        (two, None),
        (exact, None),
        (large, None),
    ];
    for (log, expected) in &logs {
        for shape in shapes {
            match fit(shape, log) {
                Ok(fit) => {
                    let numbers = [fit.curvature.value, fit.radius.value, Some(fit.rms_misfit)];
                    assert!(numbers.into_iter().flatten().all(f64::is_finite), "{fit:?}");
                    assert!(expected.is_none());
                }
                Err(error) => {
                    assert!(expected.is_none_or(|expected| expected == <&str>::from(&error)))
                }
            }
        }
    }
    // A third of the contacts lie on another object, so the fit must return an error that lists them. The second log
    // has 24,000 contacts, because the fit computes the limits for outliers from at most 20,000 contacts.
    for each in [50, 8000] {
        let mut log = ball_log(&mut Random::new(7), each);
        for contact in &mut log[2 * each..] {
            contact.position.z += 8.0;
        }
        let error = fit(Some(Shape::Sphere), &log).unwrap_err();
        let ShapeError::TooManyOutliers { outliers, .. } = error else {
            panic!("{error}");
        };
        let own = outliers.iter().filter(|&&row| row >= 2 * each).count();
        assert!(own == each, "{own}");
        assert!(outliers.len() <= each + each / 50, "{}", outliers.len());
    }
}

/// If positions err only along the normals, exact normals deviate less than errors of positions in all directions would
/// cause. This is no reason to reject the fit.
#[test]
fn exact_normals_agree_with_positions_that_err_along_them() {
    let mut random = Random::new(22);
    for _ in 0..10 {
        let exact = Surface::Sphere(25.0).strokes(10.0, 3, 10);
        let contacts = exact.iter().enumerate().map(|(index, (place, normal))| {
            let position = place + normal * (0.02 * random.normal());
            Contact::new(index / 10, Point3::from(position), Some(*normal))
        });
        let fit = sphere(&contacts.collect::<Vec<_>>());
        let is_held = holds(&fit, 25.0) && fit.radius.value.is_some();
        assert!(is_held && fit.p_value > 1e-3, "{fit:?}");
    }
}

/// On a curved surface, a position error along the surface changes the expected normal. Here this change (0.6/25 =
/// 0.024 rad) is much larger than the noise of the normals (0.003 rad). The correct shape must still be chosen, and
/// the interval must hold: on a cylinder, the change lies across the axis, so the normals scatter more there.
#[test]
fn normals_that_are_far_more_exact_than_positions_agree_with_the_shape() {
    let shapes = [
        (Shape::Sphere, Surface::Sphere(25.0)),
        (Shape::Cylinder, Surface::Cylinder(25.0)),
    ];
    let (mut right, mut held) = (0, 0);
    for case in 0..200 {
        let random = &mut Random::new(98_000 + case);
        let (shape, surface) = shapes[case as usize % 2];
        let exact = surface.strokes(15.0, 4, 100);
        let fit = fit(None, &noisy(random, &exact, 100, 0.6, Some(0.003))).unwrap();
        right += u32::from(fit.shape == shape && !fit.is_none_of_these());
        held += u32::from(shape == Shape::Cylinder && holds(&fit, 25.0));
    }
    assert!(right >= 174 && held >= 91, "{right} {held}");
}

#[test]
fn objects_are_fitted_on_all_sides_and_below_a_tip() {
    let mut random = Random::new(97_000);
    let ball: Vec<_> = (0..400)
        .map(|_| random.vector().normalize())
        .map(|normal| (normal * 8.0, normal))
        .collect();
    let pipe: Vec<_> = (0..400)
        .map(|_| {
            let turn = random.between(0.0, TAU);
            let normal = Vector3::new(libm::cos(turn), libm::sin(turn), 0.0);
            (
                normal * 12.0 + Vector3::z() * random.between(-40.0, 40.0),
                normal,
            )
        })
        .collect();
    for (shape, exact, radius) in [(Shape::Sphere, ball, 8.0), (Shape::Cylinder, pipe, 12.0)] {
        for normals in [None, Some(0.02)] {
            let contacts = noisy(&mut random, &exact, 0, 0.05, normals);
            let contacts = placed(&mut random, &contacts, 100.0);
            let fit = fit(None, &contacts).unwrap();
            let error = (fit.radius.value.unwrap() - radius).abs();
            assert!(error < 4.0 * fit.radius.std.unwrap(), "{fit:?}");
            let probability = fit.probabilities.unwrap()[shape as usize];
            assert!(probability > 0.8, "{fit:?}");
            assert!(half_width(&fit) < 0.01 * radius, "{fit:?}");
            assert!(fit.curvature.value.unwrap() > 0.0, "{fit:?}");
        }
    }
    let exact = Surface::Sphere(30.0).disc(&mut random, 15.0, 500);
    // All points of the map must lie on the ball, and the map must reach the edge of the area of the contacts.
    let contacts = noisy(&mut random, &exact, 0, 0.01, None);
    let map = sphere(&contacts).map(&contacts, 11);
    let places = || map.iter().map(|point| point.position);
    let radius = |place: Point3<f64>| (place - Point3::new(0.0, 0.0, -30.0)).norm();
    assert!(places().all(|place| (radius(place) - 30.0).abs() < 0.05));
    assert!(places().any(|place| place.x.hypot(place.y) > 14.0));
    let centres = noisy(&mut random, &exact, 0, 0.02, None);
    for (outward, radius) in [(1.0, 25.0), (-1.0, 35.0)] {
        let settings = ShapeSettings {
            shape: Some(Shape::Sphere),
            tip_radius: 5.0,
            outward: Vector3::z() * outward,
            ..ShapeSettings::default()
        };
        let fit = settings.fit(&centres).unwrap();
        assert!((fit.radius.value.unwrap() - radius).abs() < 0.2, "{fit:?}");
    }
}

#[test]
fn strokes_and_rings_do_not_choose_between_ball_and_cylinder() {
    let (mut probable, mut undecided) = (0, 0);
    for case in 0..40 {
        let mut random = Random::new(96_000 + case);
        let exact = Surface::Sphere(25.0).strokes(10.0, 1, 21);
        let log = noisy(&mut random, &exact, 0, 0.01, Some(0.0));
        let [_, ball, pipe, _] = fit(None, &log).unwrap().probabilities.unwrap();
        assert!(ball == pipe, "{ball} {pipe}");
        probable += u32::from(ball > 0.45);
        // Without normals, a ring of contacts is on a plane, on spheres of many radii, and on a cylinder. Two rings are
        // on a sphere and on a cylinder.
        let ring = |step: u32| {
            let (sin, cos) = libm::sincos(TAU * f64::from(step) / 60.0);
            let y = 15.0 * f64::from(step / 60);
            (Vector3::new(20.0 * sin, y, 20.0 * cos), Vector3::z())
        };
        let rings: Vec<_> = (0..120).map(ring).collect();
        let rings = noisy(&mut random, &rings, 60, 0.05, None);
        assert!(sphere(&rings[..60]).radius.value.is_none(), "{case}");
        for contacts in [&rings[..60], &rings] {
            let probabilities = fit(None, contacts).unwrap().probabilities.unwrap();
            undecided += u32::from(probabilities.iter().all(|one| *one < 0.55));
        }
    }
    assert!(probable >= 36 && undecided >= 74, "{probable} {undecided}");
}
