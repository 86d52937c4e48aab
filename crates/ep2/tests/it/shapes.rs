//! Fits shapes to random contacts, and tests the fitted sizes, their intervals and the choice of the shape. If an
//! assertion fails, its message contains the measured shares of successful cases.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};
use palpate_ep2::{
    Contact, IndependentFit, Penalised, Shape, ShapeError, ShapeFit, ShapeSettings, SoundContacts,
};

use super::drawn_shapes::{Random, Surface, inside, noisy, placed};

fn fit(shape: Option<Shape>, contacts: &[Contact]) -> Result<ShapeFit, ShapeError> {
    let settings = ShapeSettings {
        shape,
        ..ShapeSettings::default()
    };
    settings.fit(contacts)
}

fn sphere(contacts: &[Contact]) -> ShapeFit {
    fit(Some(Shape::Sphere), contacts).unwrap()
}

fn holds(fit: &ShapeFit, radius: f64) -> bool {
    let [low, high] = fit.radius.interval95;
    low.is_none_or(|low| low <= radius) && high.is_none_or(|high| high >= radius)
}

fn half_width(fit: &ShapeFit) -> f64 {
    let [low, high] = fit
        .radius
        .interval95
        .map(|end| end.unwrap_or(f64::INFINITY));
    0.5 * (high - low)
}

fn median(mut values: Vec<f64>) -> f64 {
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
        resolved += f64::from(fit.is_resolved());
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
    let numbers = text
        .lines()
        .skip(1)
        .flat_map(|line| line.split(',').map(|word| word.parse().unwrap()));
    let numbers: Vec<f64> = numbers.collect();
    let contacts = numbers
        .chunks(3)
        .map(|xyz| Contact::new(0, Point3::new(xyz[0], xyz[1], xyz[2]), None));
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
        let fit = fit(None, &placed(&mut random, &contacts, 2.0 * extent)).unwrap();
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

/// The distances of exact contacts from the right shape are rounding errors. They must not count as a misfit.
#[test]
fn exact_planes_and_cylinders_are_chosen() {
    for shape in [Shape::Plane, Shape::Cylinder] {
        let height = |x: f64, y: f64| match shape {
            Shape::Plane => 0.3 * x + 0.1 * y,
            _ => (900.0 - y * y).sqrt(),
        };
        let contacts = (0..150).map(|row| {
            let [x, y] = [f64::from(row % 30) / 1.5, f64::from(row / 30) * 4.0 - 8.0];
            Contact::new(row as usize / 30, Point3::new(x, y, height(x, y)), None)
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

/// Errors of positions along a ball move the positions outward on average. A fit to many contacts must correct this
/// bias.
#[test]
fn noise_along_a_ball_does_not_enlarge_it() {
    let held = (0..10).filter(|case| {
        let random = &mut Random::new(47_000 + case);
        let contacts = (0..20_000).map(|row| {
            let place = random.vector().normalize() * 20.0 + random.vector() * 0.4;
            Contact::new(row, Point3::from(place), None)
        });
        holds(&sphere(&contacts.collect::<Vec<_>>()), 20.0)
    });
    let held = held.count();
    assert!(held >= 8, "{held}");
}

fn ball_log(random: &mut Random, each: usize) -> Vec<Contact> {
    let exact = Surface::Sphere(25.0).strokes(10.0, 3, each);
    noisy(random, &exact, each, 0.05, Some(0.01))
}

/// Contacts of three strokes. Their noise has the standard deviation `std` and is correlated over `time` successive
/// contacts.
fn correlated(
    random: &mut Random,
    [each, time]: [usize; 2],
    std: f64,
    with_normals: bool,
) -> Vec<Contact> {
    let exact = Surface::Sphere(25.0).strokes(10.0, 3, each);
    let keep = libm::exp(-1.0 / time as f64);
    let mut state = [Vector3::zeros(); 2];
    let rows = exact.iter().enumerate().map(|(row, (place, normal))| {
        for state in &mut state {
            let fresh = random.vector();
            *state = match row % each {
                0 => fresh,
                _ => *state * keep + fresh * (1.0 - keep * keep).sqrt(),
            };
        }
        let tilt = state[1] * 0.01;
        let turned = (normal + tilt - normal * normal.dot(&tilt)).normalize();
        let position = Point3::from(place + state[0] * std);
        Contact::new(row / each, position, with_normals.then_some(turned))
    });
    rows.collect()
}

#[test]
fn correlated_positions_do_not_refute_a_ball() {
    let refuted = (0..2).filter(|case| {
        let random = &mut Random::new(85_000 + case);
        let mut log = correlated(random, [500, 25], 0.1, false);
        let exact = Surface::Sphere(25.0).strokes(10.0, 3, 500);
        let normals = noisy(random, &exact, 500, 0.0, Some(0.01));
        let pairs = log.iter_mut().zip(normals);
        pairs.for_each(|(one, other)| one.normal = other.normal);
        fit(None, &log).unwrap().is_none_of_these() || sphere(&log).p_value < 0.005
    });
    assert_eq!(refuted.count(), 0);
}

/// Returns two logs of contacts, and the smallest accepted coverage of the intervals. In the first log, the readings
/// depend on each other. The second log is similar, but its readings are independent.
fn dependent(kind: usize, random: &mut Random) -> ([Vec<Contact>; 2], f64) {
    if kind < 3 {
        let plain = ball_log(random, 10);
        let times = |row: usize| match kind {
            0 | 1 => 4,
            _ if row.is_multiple_of(10) => 200,
            _ => 1,
        };
        let rows = plain.iter().enumerate();
        let mut log: Vec<Contact> = rows.flat_map(|(row, one)| vec![*one; times(row)]).collect();
        for contact in log.iter_mut().filter(|_| kind > 0) {
            contact.position += random.vector() * 1e-3;
        }
        return ([log, plain], 0.85);
    }
    let (each, time, least) = if kind == 3 {
        (500, 25, 0.85)
    } else {
        (100, 5, 0.75)
    };
    let log = correlated(random, [each, time], 0.05, kind == 3);
    let step = 4 * time;
    let rows = (0..log.len()).filter(|row| row % each % step == step / 2);
    let thinned = rows.map(|row| log[row]).collect();
    ([log, thinned], least)
}

#[test]
fn dependent_readings_count_once() {
    for kind in 0..5 {
        let (mut held, mut widths, mut expected) = (0.0, [Vec::new(), Vec::new()], 0.0);
        for case in 0..60 {
            let (logs, least) = dependent(kind, &mut Random::new(80_000 + case));
            let fits = logs.map(|log| sphere(&log));
            held += f64::from(holds(&fits[0], 25.0)) / 60.0;
            for (widths, fit) in widths.iter_mut().zip(&fits) {
                widths.push(half_width(fit));
            }
            expected = least;
        }
        let [wide, plain] = widths.map(median);
        let figures = format!("log {kind}: {held}, {wide} {plain}");
        assert!(held > expected && wide < 1.35 * plain, "{figures}");
    }
}

/// In a random order, two consecutive contacts may be near each other by chance. They must not be merged as a rest of a
/// finger.
#[test]
fn chance_neighbours_are_no_rests() {
    for case in 0..20 {
        let random = &mut Random::new(84_000 + case);
        let exact = Surface::Sphere(45.0).disc(random, 40.0, 300);
        for (repeated, times) in [(0, 1), (1, 8), (300, 2)] {
            let row = |(row, one)| vec![one; if row < repeated { times } else { 1 }];
            let rows: Vec<_> = exact.iter().copied().enumerate().flat_map(row).collect();
            let log = noisy(random, &rows, 0, 0.2, None);
            let distinct = sphere(&log).readings.distinct;
            let least = if repeated == 300 { 280 } else { 300 };
            assert!((least..=305).contains(&distinct), "{repeated}: {distinct}");
        }
    }
}

/// Returns three results: the share of logs whose interval contains the true mean curvature, the share of logs with
/// reported correlated noise, and the median half-width of the intervals.
fn of_surface(logs: impl Iterator<Item = Vec<Contact>>, truth: f64) -> [f64; 3] {
    let (mut shares, mut widths) = ([0.0; 2], Vec::new());
    let mut count = 0.0;
    for log in logs {
        let fit = IndependentFit::new(|_| Penalised::default(), &log, None, &Vector3::z()).unwrap();
        let found = fit.fit.centre().unwrap().curvature;
        let half = 1.96 * found.uncertainty.unwrap().mean_std;
        shares[0] += f64::from((found.mean - truth).abs() <= half);
        shares[1] += f64::from(fit.readings.position_correlation > 1.5);
        widths.push(half);
        count += 1.0;
    }
    let [held, found] = shares.map(|share| share / count);
    [held, found, median(widths)]
}

#[test]
fn surfaces_are_not_fitted_to_correlated_noise() {
    let random = |case: u64| Random::new(83_000 + case);
    for (time, std, with_normals) in [
        (25, 0.05, true),
        (25, 0.05, false),
        (25, 0.005, false),
        (50, 0.05, false),
    ] {
        let log = |case| correlated(&mut random(case), [500, time], std, with_normals);
        let thinned = |case| log(case).into_iter().skip(50).step_by(100).collect();
        let [held, found, width] = of_surface((0..40).map(log), 0.04);
        let [_, _, plain] = of_surface((0..40).map(thinned), 0.04);
        let figures = format!("{held} {found} {width} {plain}");
        assert!(
            held > 0.85 && found > 0.9 && width < 1.3 * plain,
            "{figures}"
        );
    }
    // A wave on the surface must not be mistaken for correlated noise.
    let wave = Surface::Wave(1.0, 20.0, 0.5 * PI);
    let waves = (0..40).map(|case| {
        noisy(
            &mut random(case),
            &wave.strokes(10.0, 5, 101),
            101,
            0.05,
            Some(0.01),
        )
    });
    let [held, found, _] = of_surface(waves, 0.5 * (0.1 * PI).powi(2));
    assert!(held > 0.85 && found < 0.1, "{held} {found}");
}

/// Moves a tenth of the contacts of a log off the surface, and returns their rows. `kind` selects the new places: one
/// point near the surface, places along the normals, or one point beside the patch.
fn with_outliers(random: &mut Random, log: &mut [Contact], kind: u64) -> Vec<usize> {
    let offset = |random: &mut Random| random.between(1.5, 4.0) * random.normal().signum();
    let middle = log[log.len() / 2];
    let point = match kind {
        0 => middle.position + middle.normal.unwrap() * offset(random),
        _ => middle.position + random.vector().normalize() * 50.0,
    };
    let phase = (random.uniform() * 10.0) as usize;
    let rows: Vec<usize> = (phase..log.len()).step_by(10).collect();
    for &row in &rows {
        let contact = &mut log[row];
        contact.position = match kind {
            1 => contact.position + contact.normal.unwrap() * offset(random),
            _ => point + random.vector() * 0.1,
        };
    }
    rows
}

#[test]
fn outliers_are_left_out_of_any_smooth_surface() {
    let surfaces = [
        Surface::Sphere(25.0),
        Surface::Cylinder(20.0),
        Surface::Saddle(30.0, 0.7),
        Surface::Torus(20.0, 40.0),
        Surface::Wave(0.4, 25.0, 1.0),
    ];
    let left_out = |log: &[Contact]| -> Vec<usize> {
        let sound = SoundContacts::new(log).unwrap();
        let sound = sound.without_misfits(log, &Vector3::z()).unwrap();
        sound.outliers.iter().map(|one| one.contact).collect()
    };
    let [mut clean, mut kept, mut lost, mut count] = [0; 4];
    for case in 0..60 {
        let mut random = Random::new(90_000 + case);
        let exact = surfaces[case as usize % 5].strokes(9.0, 3, 40);
        let mut log = noisy(&mut random, &exact, 40, 0.03, Some(0.01));
        clean += left_out(&log).len();
        let rows = with_outliers(&mut random, &mut log, case % 3);
        let found = left_out(&log);
        kept += rows.iter().filter(|row| !found.contains(row)).count();
        lost += found.iter().filter(|row| !rows.contains(row)).count();
        count += rows.len();
    }
    let figures = format!("{clean} of clean logs, {kept} kept and {lost} lost of {count}");
    assert!(clean <= 36 && 50 * kept <= count && lost <= 36, "{figures}");
}

/// Contacts that a polynomial does not follow, such as whole columns of an exact grid, are not outliers.
#[test]
fn exact_contacts_of_few_strokes_are_kept() {
    for surface in [
        Surface::Cylinder(25.0),
        Surface::Wave(1.0, 25.0, 1.0),
        Surface::Sphere(12.0),
    ] {
        for (fingers, contacts) in [(3, 12), (6, 6), (5, 40)] {
            let exact = surface.strokes(9.0, fingers, contacts);
            let log = noisy(&mut Random::new(0), &exact, contacts, 0.0, None);
            let sound = SoundContacts::new(&log).unwrap();
            let sound = sound.without_misfits(&log, &Vector3::z()).unwrap();
            assert_eq!(sound.outliers, []);
        }
    }
}

/// Three fingers that move to and fro along twelve lines determine the surface as well as twelve fingers do.
#[test]
fn strokes_are_counted_and_not_fingers() {
    let exact = Surface::Sphere(25.0).strokes(9.0, 12, 30);
    let twelve = noisy(&mut Random::new(12), &exact, 30, 0.03, None);
    let std = |log: &[Contact]| {
        let up = Vector3::z();
        let mut fit = IndependentFit::new(|_| Penalised::default(), log, None, &up).unwrap();
        fit.widen_to_shape(&up, false).unwrap();
        fit.fit
            .centre()
            .unwrap()
            .curvature
            .uncertainty
            .unwrap()
            .mean_std
    };
    let three = twelve.iter().map(|contact| Contact {
        finger: contact.finger / 4,
        ..*contact
    });
    let lines = twelve.iter().filter(|contact| contact.finger % 5 == 0);
    let all = std(&twelve);
    let of_three = std(&three.collect::<Vec<_>>());
    let of_lines = std(&lines.copied().collect::<Vec<_>>());
    assert!(
        of_three < 1.3 * all && of_lines > 2.0 * all,
        "{all} {of_three} {of_lines}"
    );
}

/// In the log of seven fingers, the contacts alternate between the fingers. Outliers are found by comparison with a
/// selection of the contacts, which must contain contacts of all fingers.
#[test]
fn no_finger_of_a_large_log_is_an_outlier() {
    let at = |row: u32| {
        let (x, y) = (f64::from(row / 7) / 1000.0 - 5.0, 5.0 * f64::from(row % 7));
        let z = (2500.0 - x * x - y * y).sqrt();
        Contact::new(row as usize % 7, Point3::new(x, y, z), None)
    };
    let log: Vec<Contact> = (0..70_000).map(at).collect();
    assert_eq!(SoundContacts::new(&log).unwrap().outliers, []);
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
                Err(error) => assert!(expected.is_none_or(|expected| expected == error.name())),
            }
        }
    }
    // A third of the contacts lie on another object, so the fit must return an error that lists them.
    let mut log = ball_log(&mut Random::new(7), 50);
    for contact in &mut log[100..] {
        contact.position.z += 8.0;
    }
    let error = fit(Some(Shape::Sphere), &log).unwrap_err();
    assert!(
        matches!(&error, ShapeError::TooManyOutliers { outliers, .. } if outliers.len() == 50),
        "{error}"
    );
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
            assert!(
                fit.shape == shape && error < 4.0 * fit.radius.std.unwrap(),
                "{fit:?}"
            );
            let probability = fit.probabilities.unwrap()[shape as usize];
            assert!(probability > 0.8, "{fit:?}");
            assert!(
                half_width(&fit) < 0.01 * radius && fit.curvature.value.unwrap() > 0.0,
                "{fit:?}"
            );
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
fn one_stroke_does_not_choose_between_ball_and_cylinder() {
    let mut probable = 0;
    for case in 0..40 {
        let mut random = Random::new(96_000 + case);
        let exact = Surface::Sphere(25.0).strokes(10.0, 1, 21);
        let log = noisy(&mut random, &exact, 0, 0.01, Some(0.0));
        let [_, sphere, cylinder, _] = fit(None, &log).unwrap().probabilities.unwrap();
        assert!(sphere == cylinder, "{sphere} {cylinder}");
        probable += u32::from(sphere > 0.45);
    }
    assert!(probable >= 36, "{probable}");
}
