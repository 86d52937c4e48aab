//! Fits shapes and surfaces to logs as robots write them: copies of contacts, resting fingers, correlated noise and
//! outliers.

use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Ep2Error, IndependentFit, Penalised, SoundContacts, stroke_curvature};

use super::drawn_shapes::{Random, Surface, ball_log, noisy};
use super::shapes::{fit, half_width, holds, median, sphere};

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

/// In a random order, two consecutive contacts may be near each other by chance. They must not be merged as if the
/// finger rested there, even if a lost reading makes all other steps seem short.
#[test]
fn chance_neighbours_are_no_rests() {
    for case in 0..20 {
        let random = &mut Random::new(84_000 + case);
        let exact = Surface::Sphere(45.0).disc(random, 40.0, 300);
        for (repeated, times) in [(0, 1), (1, 8), (300, 2)] {
            let row = |(row, one)| vec![one; if row < repeated { times } else { 1 }];
            let rows: Vec<_> = exact.iter().copied().enumerate().flat_map(row).collect();
            let mut log = noisy(random, &rows, 0, 0.2, None);
            if case % 2 == 1 {
                log.insert(77, Contact::new(0, Point3::from([9999.0; 3]), None));
            }
            let fit = sphere(&log);
            let outliers = fit.outliers.iter().map(|one| one.contact);
            assert!(outliers.eq((case % 2 == 1).then_some(77)));
            let distinct = fit.readings.distinct;
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

/// A finger slips off its path and continues beside it for 30 to 90 contacts. Exactly these contacts are left out, even
/// if they are most contacts of the finger.
#[test]
fn contacts_after_a_slip_are_left_out() {
    let cases = [
        (Surface::Sphere(25.0), 60..100),
        (Surface::Saddle(30.0, 0.7), 130..160),
        (Surface::Sphere(25.0), 10..100),
    ];
    for (surface, rows) in cases {
        let exact = surface.strokes(9.0, 6, 100);
        let mut log = noisy(&mut Random::new(17), &exact, 100, 0.03, None);
        let moved = log[rows.clone()].iter_mut();
        moved.for_each(|one| one.position += Vector3::new(1.0, 1.0, 3.0));
        let sound = SoundContacts::new(&log).unwrap();
        let sound = sound.without_misfits(&log, &Vector3::z()).unwrap();
        assert!(sound.outliers.iter().map(|one| one.contact).eq(rows));
    }
}

/// In a dense log, outliers are nearer to each other than to the surface.
#[test]
fn scattered_outliers_of_dense_logs_are_left_out() {
    let mut random = Random::new(16);
    let exact = Surface::Sphere(40.0).disc(&mut random, 10.0, 6000);
    let mut log = noisy(&mut random, &exact, 0, 0.03, None);
    let outliers = log.iter_mut().step_by(12);
    outliers.for_each(|one| one.position.z += random.between(0.5, 1.0));
    let sound = SoundContacts::new(&log).unwrap();
    let sound = sound.without_misfits(&log, &Vector3::z()).unwrap();
    assert_eq!(sound.outliers.len(), 500);
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
        fit.widen_by_bias(&up, false).unwrap();
        let centre = fit.fit.centre().unwrap();
        centre.curvature.uncertainty.unwrap().mean_std
    };
    let three = twelve.iter().map(|contact| Contact {
        finger: contact.finger / 4,
        ..*contact
    });
    let lines = twelve.iter().filter(|contact| contact.finger % 5 == 0);
    let all = std(&twelve);
    let of_three = std(&three.collect::<Vec<_>>());
    let of_lines = std(&lines.copied().collect::<Vec<_>>());
    let figures = format!("{all} {of_three} {of_lines}");
    assert!(of_three < 1.3 * all && of_lines > 2.0 * all, "{figures}");
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

/// Many short strokes give the right mean curvature, and so do three strokes whose noise exceeds the spacing of their
/// contacts. Two strokes of one finger give an error, because they do not determine the surface. If the contacts of one
/// finger have random positions, their noise counts as uncorrelated.
#[test]
fn strokes_of_any_kind_give_the_right_curvature_or_an_error() {
    let up = Vector3::z();
    let mean = |log: &[Contact]| {
        let mut fit = IndependentFit::new(|_| Penalised::default(), log, None, &up)?;
        fit.widen_by_bias(&up, false)?;
        Ok::<_, Ep2Error>(fit.fit.centre()?.curvature.mean)
    };
    let mut random = Random::new(31);
    let short: Vec<_> = (0..12_000)
        .map(|row| {
            let x = f64::from(row % 8) * 2.4 - 9.0 + random.uniform();
            Surface::Sphere(25.0).at(x, f64::from(row / 8) * 0.012 - 9.0)
        })
        .collect();
    let short = mean(&noisy(&mut random, &short, 8, 0.01, None)).unwrap();
    assert!((short - 0.04).abs() < 1e-4, "{short}");

    let dense = Surface::Sphere(25.0).strokes(9.0, 3, 1500);
    let dense = mean(&noisy(&mut random, &dense, 1500, 0.05, None)).unwrap();
    assert!((dense - 0.04).abs() < 1e-3, "{dense}");

    // Three strokes along x, whose y coordinates have no noise. `stroke_curvature` must not accept a bent path through
    // all three strokes as a single stroke, and the fitted surface must not rise steeply between the strokes.
    for _ in 0..12 {
        let mut log = Vec::new();
        for finger in 0..3 {
            let y = 7.5 * finger as f64 - 7.5;
            let mut along: Vec<f64> = (0..60).map(|_| random.between(-9.8, 9.8)).collect();
            along.sort_by(f64::total_cmp);
            log.extend(along.into_iter().map(|x| {
                let z = (441.0 - x * x - y * y).sqrt();
                let [x, z] = [x, z].map(|exact| exact + 0.15 * random.normal());
                Contact::new(finger, Point3::new(x, y, z), None)
            }));
        }
        assert_eq!(stroke_curvature(&log, &up), None);
        let raster = mean(&log).unwrap();
        assert!((raster - 1.0 / 21.0).abs() < 0.02, "{raster}");
    }

    let two = Surface::Sphere(25.0).strokes(9.0, 2, 600);
    let error = mean(&noisy(&mut random, &two, 0, 0.1, None)).unwrap_err();
    assert!(matches!(error, Ep2Error::Undetermined { .. }), "{error}");

    let places: Vec<_> = (0..3000)
        .map(|_| Surface::Sphere(400.0).at(random.between(-9.0, 9.0), random.between(-9.0, 9.0)))
        .collect();
    let log = noisy(&mut random, &places, 0, 0.05, None);
    let fit = IndependentFit::new(|_| Penalised::default(), &log, None, &up).unwrap();
    assert_eq!(fit.readings.position_correlation, 1.0);
}
