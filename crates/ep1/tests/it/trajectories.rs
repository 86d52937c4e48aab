//! Tests of rolls along which the curvature changes, and of the intervals of the method `trajectory`.

use approx::assert_relative_eq;
use nalgebra::{UnitQuaternion, Vector2, Vector3};
use palpate_ep1::{
    PadCell, Places, Quantity, RollSample, RollSeries, SeriesError, SeriesMethod, SeriesNoise,
    estimate_series,
};
use palpate_geometry::{Ellipsoid, Graph, Shape, Sphere, Surface};
use palpate_rolling::{Chart, Model, Motion, Roller, Rolls};

use crate::ball_rolls::{EXACT, RADIUS, SQUARE, chart, on_squares, pad, rolls, without_starts};
use crate::draws::Draws;

/// Rolls of a probe of radius 1 on `shape`, with contact points in `samples` samples. The rolling equations are
/// integrated. `turn` contains the rotation in the direction of rolling and about the contact normal.
pub(crate) fn integrated(
    shape: &Shape,
    first: (f64, f64),
    turn: [f64; 2],
    samples: u32,
) -> (Vec<RollSeries>, Roller) {
    let motions = |direction: f64| {
        let mut motion = Motion::rolling(direction, turn[0], 1.0);
        motion.angular_velocity.z = turn[1];
        vec![motion]
    };
    let model = Model::Dop853 {
        tolerance: 1e-10,
        chart: Chart::Free,
    };
    let all: Vec<_> = (0..8)
        .map(|roll| motions(0.2 + 0.785 * f64::from(roll)))
        .collect();
    let probe = Sphere::new(1.0).unwrap();
    let roller = Roller::new(probe, shape.clone(), first, model, Rolls::exact(&all)).unwrap();
    let from = *roller.first_contact();
    let series = all.iter().map(|motion| {
        let sample = |index: u32| {
            let time_s = f64::from(index) / f64::from(samples);
            let contact = roller
                .roll(&[Motion {
                    duration_s: time_s,
                    ..motion[0]
                }])
                .unwrap();
            let turn = from.object_from_probe().inverse() * contact.object_from_probe();
            let body_from_contact = from.body_from_contact;
            let in_contact = body_from_contact.inverse()
                * UnitQuaternion::from_rotation_matrix(&turn)
                * body_from_contact;
            RollSample {
                time_s,
                rotation: in_contact.scaled_axis(),
                place: contact.shift_from(&from, 1.0).displacement,
            }
        };
        RollSeries {
            start: None,
            has_spin: true,
            samples: (0..=samples).map(sample).collect(),
        }
    });
    (series.collect(), roller)
}

#[test]
fn trajectories_find_the_curvature_at_the_start_of_long_rolls() {
    let paraboloid = |c| Shape::Paraboloid(Graph::paraboloid(c).unwrap());
    let ellipsoid = Shape::Ellipsoid(Ellipsoid::new([3.0, 2.0, 1.5]).unwrap());
    let gain = SeriesNoise {
        relative_rotation_std: 0.01,
        ..EXACT
    };
    let (without, with) = (
        [(true, EXACT), (false, EXACT)],
        [(true, EXACT), (true, gain)],
    );
    for (shape, first, spin, cases) in [
        (paraboloid(5.0), (0.0, 0.0), 0.0, without),
        (paraboloid(0.5), (0.0, 0.0), 0.0, without),
        (ellipsoid.clone(), (0.0, 0.0), 0.0, without),
        (ellipsoid.clone(), (0.8, 0.5), 0.0, without),
        (ellipsoid.clone(), (0.8, 0.5), 1.5, with),
        (ellipsoid, (0.8, 0.5), 3.0, with),
    ] {
        let (rolls, roller) = integrated(&shape, first, [0.5, spin], 30);
        let from = roller.first_contact();
        let (_, truth) = shape
            .curvature_along(&from.on_object, &from.x_axis)
            .unwrap();
        let truth = truth.principal();
        let places = Places::Contacts { std: 0.0 };
        for (has_spin, noise) in cases {
            let mut rolls = rolls.clone();
            for roll in rolls.iter_mut().filter(|_| !has_spin) {
                roll.has_spin = false;
                roll.samples.iter_mut().for_each(|one| one.rotation.z = 0.0);
            }
            let found =
                estimate_series(SeriesMethod::Trajectory, 1.0, &places, &noise, &rolls).unwrap();
            assert!(found.terms > 1);
            let found = found.curvature.principal();
            assert_relative_eq!(found.k_min, truth.k_min, max_relative = 0.01);
            assert_relative_eq!(found.k_max, truth.k_max, max_relative = 0.01);
        }
    }
}

#[test]
fn intervals_include_the_change_of_curvature_that_noise_hides() {
    let (places, mut draws) = (Places::Contacts { std: 1e-3 }, Draws(14));
    let paraboloid = Shape::Paraboloid(Graph::paraboloid(0.2).unwrap());
    let (exact, _) = integrated(&paraboloid, (0.0, 0.0), [0.5, 0.0], 30);
    let one = |_: &u32| {
        let mut rolls = exact.clone();
        for sample in rolls.iter_mut().flat_map(|roll| &mut roll.samples) {
            sample.place += Vector2::from_fn(|_, _| draws.normal()) * 1e-3;
        }
        let found = estimate_series(SeriesMethod::Trajectory, 1.0, &places, &EXACT, &rolls);
        let interval = found.unwrap().interval95(Quantity::Mean);
        let [low, high] = interval.map(Option::unwrap);
        assert!(high - low < 0.02, "{low} {high}");
        low < 0.4 && 0.4 < high
    };
    let held = (0..100).filter(one).count();
    assert!(held >= 86, "{held}");
}

#[test]
fn intervals_from_exact_pads_hold_if_the_curvature_changes() {
    let saddle = Shape::Saddle(Graph::saddle(0.2).unwrap());
    let (exact, _) = integrated(&saddle, (0.0, 0.0), [0.5, 0.0], 500);
    let cell = PadCell {
        pitch: 0.05,
        ..SQUARE
    };
    let (mut draws, mut held, mut width) = (Draws(16), 0, 0.0);
    for _ in 0..40 {
        let mut rolls = exact.clone();
        for roll in &mut rolls {
            // The pads lie on one lattice for all rolls, but the rolls start at different places.
            let start = Vector2::from_fn(|_, _| draws.uniform() - 0.5) * cell.pitch;
            for sample in &mut roll.samples {
                let path = chart(&(start * RADIUS), &(sample.place * RADIUS)) / RADIUS;
                sample.place = path.map(|at| (at / cell.pitch).round() * cell.pitch);
            }
        }
        let places = Places::Pads(cell);
        let found = estimate_series(SeriesMethod::Trajectory, 1.0, &places, &EXACT, &rolls);
        let found = found.unwrap();
        for (angle_rad, truth) in [(0.0, -0.4), (0.5 * std::f64::consts::PI, 0.4)] {
            let interval = found.interval95(Quantity::Normal { angle_rad });
            let [low, high] = interval.map(Option::unwrap);
            width += (high - low) / 80.0;
            held += u32::from(low < truth && truth < high);
        }
    }
    assert!(held >= 70 && width < 0.008, "{held} of 80, {width}");
}

#[test]
fn trajectories_have_no_other_bias_than_pad_edges() {
    let (mut draws, mut apart) = (Draws(15), 0.0);
    let noise = SeriesNoise {
        relative_rotation_std: 0.1,
        ..EXACT
    };
    for trial in 0..10 {
        let turn = 0.1 * f64::from(trial);
        let mut rolls = without_starts(&rolls(50.0, &SQUARE, turn, &mut draws));
        for roll in &mut rolls {
            let gain = Vector3::from_fn(|_, _| draws.normal()) * noise.relative_rotation_std;
            let samples = roll.samples.iter_mut();
            samples.for_each(|one| one.rotation += gain * one.rotation.norm());
        }
        let [one, other] = [SeriesMethod::Trajectory, SeriesMethod::PadEdge].map(|method| {
            let found = on_squares(method, &noise, &rolls).unwrap();
            found.curvature.mean_curvature()
        });
        apart += (one - other) * 5.0;
    }
    // Without the correction for errors of rotations, the difference would exceed 3 %.
    assert!(apart.abs() < 0.02, "{apart}");
}

#[test]
fn intervals_without_stated_noise_include_the_scatter_between_rolls() {
    let mut draws = Draws(12);
    // In the last case, wrong rotations about the contact normal bend the expected paths. The estimated noise is then of
    // another kind than assumed.
    for (error, longer) in [(0.0, 1.0), (0.003, 1.0), (0.03, 1.0), (0.1, 2.4)] {
        let (mut held, mut width, mut misfits, trials) = (0, 0.0, 0, 20);
        for trial in 0..trials {
            let turn = 0.1 * f64::from(trial);
            let mut rolls = without_starts(&rolls(25.0, &SQUARE, turn, &mut draws));
            for roll in &mut rolls {
                let gain = Vector3::from_fn(|_, _| draws.normal()) * error;
                roll.samples = roll.samples.iter().step_by(40).copied().collect();
                for sample in &mut roll.samples {
                    sample.rotation *= longer;
                    let drive = Vector2::new(-sample.rotation.y, sample.rotation.x);
                    let noise = Vector2::from_fn(|_, _| draws.normal()) * 0.005;
                    let path = drive / (1.0 / RADIUS + 1.0 / 25.0);
                    sample.place = chart(&Vector2::zeros(), &path) + noise;
                    sample.rotation += gain * sample.rotation.norm();
                    sample.rotation.z *= f64::from(longer > 1.0);
                }
            }
            let places = Places::Contacts { std: 0.0 };
            let found = estimate_series(SeriesMethod::Trajectory, RADIUS, &places, &EXACT, &rolls);
            let found = found.unwrap();
            assert!(found.rolls.iter().all(|roll| roll.left_out.is_none()));
            let [low, high] = found.interval95(Quantity::Mean).map(Option::unwrap);
            misfits += u32::from(found.goodness.is_some_and(|one| one.p_value < 0.005));
            width += (high - low) * 25.0 / f64::from(trials);
            held += u32::from(low < 0.04 && 0.04 < high);
        }
        assert!(held >= 17, "{error}: {held} of {trials}");
        // The interval must be only a little wider than for stated noise. With stated noise, the relative standard
        // error is `error` · (1 + 25 / 10) / 4, plus the error due to the contact points.
        assert!(width < 0.012 + 6.0 * error, "{error}: {width}");
        assert_eq!(misfits > trials / 2, longer > 1.0, "{error}: {misfits}");
    }
}

#[test]
fn trajectories_are_found_from_exact_pads() {
    let (mut draws, mut held) = (Draws(13), 0);
    for trial in 0..100 {
        let turn = 6.3 * draws.uniform();
        let object = 12.0 + 180.0 * draws.uniform();
        let rolls = without_starts(&rolls(object, &SQUARE, turn, &mut draws));
        let found = on_squares(SeriesMethod::Trajectory, &EXACT, &rolls).unwrap();
        let relative = |curvature: f64| (curvature * RADIUS + 1.0) * object / (object + RADIUS);
        let ends = found.interval95(Quantity::Mean);
        let [low, high] = ends.map(|end| relative(end.unwrap()));
        assert!(0.98 < low && high < 1.02, "{trial}: {low} {high}");
        held += u32::from(low < 1.0 && 1.0 < high);
    }
    assert!(held >= 90, "{held}");
}

/// If the curvature changes along the rolls, `pad-edge` blames no roll. It names the change, or warns that the object may
/// be a paraboloid. On a sphere, it does neither.
#[test]
fn pad_edges_name_a_change_of_the_curvature() {
    let shape = |shape: Shape, first| integrated(&shape, first, [0.5, 0.0], 400);
    let ellipsoid = || Shape::Ellipsoid(Ellipsoid::new([3.0, 2.0, 1.5]).unwrap());
    let bowl = |c: f64| Shape::Paraboloid(Graph::paraboloid(c).unwrap());
    let objects = [
        (shape(ellipsoid(), (0.4, 0.7)), 0.1, true),
        (shape(ellipsoid(), (1.1, 0.3)), 0.05, true),
        (shape(bowl(1.0), (0.0, 0.0)), 0.1, true),
        (
            shape(Shape::Sphere(Sphere::new(4.7).unwrap()), (0.7, 0.3)),
            0.1,
            false,
        ),
    ];
    let mut draws = Draws(17);
    for (object, ((rolls, _), pitch, expected)) in objects.iter().enumerate() {
        for std in [0.0, 3e-4, 1e-3] {
            let mut rolls = without_starts(rolls);
            let offset = Vector2::new(0.3, 0.2) * *pitch;
            for sample in rolls.iter_mut().flat_map(|roll| &mut roll.samples) {
                let pitches = (sample.place - offset) / *pitch;
                sample.place = pitches.map(f64::round) * *pitch + offset;
                sample.rotation += Vector3::from_fn(|_, _| draws.normal()) * std;
            }
            let places = Places::Pads(PadCell {
                pitch: *pitch,
                is_hexagonal: false,
            });
            let noise = SeriesNoise {
                rotation_std_rad: std,
                ..EXACT
            };
            let found = estimate_series(SeriesMethod::PadEdge, 1.0, &places, &noise, &rolls);
            let named = match &found {
                Err(SeriesError::ChangingCurvature { .. }) => true,
                Err(error) => panic!("{object} {std}: {error}"),
                Ok(found) => found.change.is_some() || found.may_change,
            };
            assert_eq!(named, *expected, "{object} {std}");
        }
    }
}

/// All rolls start at the middle of a pad, and each is repeated five times, so repetitions have the same errors of pad
/// changes.
#[test]
fn repetitions_of_rolls_do_not_narrow_the_interval() {
    let (mut draws, mut held) = (Draws(16), [0, 0, 0]);
    let noise = SeriesNoise {
        rotation_std_rad: 1e-4,
        ..EXACT
    };
    for trial in 0..40 {
        let mut rolls = without_starts(&rolls(47.0, &SQUARE, 0.1 * f64::from(trial), &mut draws));
        for roll in &mut rolls {
            roll.samples = roll.samples.iter().step_by(5).copied().collect();
            for sample in &mut roll.samples {
                let drive = Vector2::new(-sample.rotation.y, sample.rotation.x);
                sample.place = pad(&SQUARE, &(drive / (1.0 / RADIUS + 1.0 / 47.0)));
            }
        }
        let once = on_squares(SeriesMethod::PadEdge, &EXACT, &rolls).unwrap();
        let mut rolls = [(); 5].map(|()| rolls.clone()).concat();
        let repeated = on_squares(SeriesMethod::PadEdge, &EXACT, &rolls).unwrap();
        // Opposite rolls have the same errors too, so an interval of few rolls is easily too narrow.
        let [once, repeated] = [once, repeated].map(|found| {
            let [low, high] = found.interval95(Quantity::Mean).map(Option::unwrap);
            held[2] += u32::from(low < 1.0 / 47.0 && 1.0 / 47.0 < high);
            high - low
        });
        assert_relative_eq!(once, repeated, max_relative = 0.05);
        for sample in rolls.iter_mut().flat_map(|roll| &mut roll.samples) {
            sample.rotation += Vector3::from_fn(|_, _| draws.normal()) * 1e-4;
        }
        for (held, method) in held
            .iter_mut()
            .zip([SeriesMethod::Trajectory, SeriesMethod::PadEdge])
        {
            let found = on_squares(method, &noise, &rolls).unwrap();
            let [low, high] = found.interval95(Quantity::Mean);
            *held += u32::from(low < Some(1.0 / 47.0) && Some(1.0 / 47.0) < high);
        }
    }
    assert!(held.iter().all(|held| *held >= 35), "{held:?}");
    assert!(held[2] >= 74, "{held:?}");
}
