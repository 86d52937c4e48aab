//! Sets of readings that are estimated together: each set has the estimate that it has alone.

use approx::assert_relative_eq;
use nalgebra::Vector2;
use palpate_ep1::{Ep1Error, LeastSquares, PadStart, ProbeReading, ReadingNoise, SetRow, Sets};
use palpate_geometry::CurvatureForm;

use crate::{eight, readings};

const RADIUS: f64 = 2.0;
const COUNT: usize = 75;
const PROBES: usize = 8;

/// Rotations and shifts of sets on different objects, with residuals.
fn noisy() -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let mut all = (Vec::new(), Vec::new());
    for set in 0..COUNT {
        let along = set as f64 / COUNT as f64;
        let form = CurvatureForm {
            k_uu: along - 0.3,
            k_uv: 0.1 - 0.2 * along,
            k_vv: 0.4 * along,
        };
        for (probe, reading) in readings(RADIUS, &form, &eight(0.1)).iter().enumerate() {
            let wave = libm::sin(1.7 * set as f64 + 2.3 * probe as f64);
            all.0
                .push([reading.rotation.x + 1e-3 * wave, reading.rotation.y]);
            all.1.push([reading.shift.x, reading.shift.y - 2e-3 * wave]);
        }
    }
    all
}

fn rows(noise: ReadingNoise, rotations: &[[f64; 2]], shifts: &[[f64; 2]]) -> Vec<SetRow> {
    let mut rows = vec![[0.0; 11]; COUNT];
    sets(noise, rotations, shifts)
        .estimate(0, &mut rows)
        .unwrap();
    rows
}

fn sets<'a>(noise: ReadingNoise, rotations: &'a [[f64; 2]], shifts: &'a [[f64; 2]]) -> Sets<'a> {
    Sets {
        radius: RADIUS,
        noise,
        probes: PROBES,
        rotations,
        shifts,
    }
}

/// Readings of one set; the sets may share their rotations or shifts.
fn alone(rotations: &[[f64; 2]], shifts: &[[f64; 2]], set: usize) -> Vec<ProbeReading> {
    let of = |all: &[[f64; 2]], probe: usize| -> Vector2<f64> {
        let first = if all.len() == PROBES { 0 } else { set * PROBES };
        all[first + probe].into()
    };
    let reading = |probe| ProbeReading {
        rotation: of(rotations, probe),
        shift: of(shifts, probe),
    };
    (0..PROBES).map(reading).collect()
}

const NOISES: [ReadingNoise; 3] = [
    ReadingNoise {
        shift_std: 0.01,
        relative_rotation_std: 0.0,
        rotation_std_rad: 0.0,
        shift_resolution: 0.0,
        pad_start: PadStart::PerRoll,
    },
    ReadingNoise {
        shift_std: 0.01,
        relative_rotation_std: 0.02,
        rotation_std_rad: 1e-3,
        shift_resolution: 0.0,
        pad_start: PadStart::PerRoll,
    },
    ReadingNoise {
        shift_std: 0.0,
        relative_rotation_std: 0.0,
        rotation_std_rad: 0.0,
        shift_resolution: 0.0,
        pad_start: PadStart::PerRoll,
    },
];

#[test]
fn each_set_has_the_estimate_of_the_set_alone() {
    let (rotations, shifts) = noisy();
    let pairs = [
        (&rotations[..], &shifts[..]),
        (&rotations[..PROBES], &shifts[..]),
        (&rotations[..], &shifts[..PROBES]),
    ];
    for noise in NOISES {
        for (rotations, shifts) in pairs {
            for (set, row) in rows(noise, rotations, shifts).iter().enumerate() {
                let readings = alone(rotations, shifts, set);
                let estimate = LeastSquares::of(RADIUS, noise, &readings).unwrap();
                let (residual, _) = estimate.residual(&readings);
                let stated = match noise.shift_std > 0.0 {
                    true => estimate,
                    // The noise is estimated from the residuals.
                    false => {
                        let found = ReadingNoise {
                            shift_std: residual,
                            ..noise
                        };
                        LeastSquares::of(RADIUS, found, &readings).unwrap()
                    }
                };
                let measured = [
                    stated.normal_curvature_u,
                    stated.normal_curvature_v,
                    stated.gaussian_curvature,
                    stated.mean_curvature,
                ];
                let [u, v, gaussian, mean] = measured.map(|one| one.value);
                let [std_u, std_v, of_gaussian, of_mean] = measured.map(|one| one.std.unwrap());
                let expected: SetRow = [
                    u,
                    v,
                    stated.curvature.k_uv,
                    gaussian,
                    mean,
                    std_u,
                    std_v,
                    of_gaussian,
                    of_mean,
                    stated.arc_length,
                    residual,
                ];
                assert_eq!(*row, expected, "set {set}");
            }
        }
    }
}

#[test]
fn exact_readings_determine_the_curvature_without_residual() {
    let form = CurvatureForm {
        k_uu: 0.4,
        k_uv: 0.3,
        k_vv: 1.2,
    };
    let of_set = readings(RADIUS, &form, &eight(0.1));
    let rotations: Vec<[f64; 2]> = of_set.iter().map(|one| one.rotation.into()).collect();
    let shifts: Vec<[f64; 2]> = of_set.iter().map(|one| one.shift.into()).collect();
    let (gaussian, mean) = (0.4 * 1.2 - 0.3 * 0.3, 0.8);
    for all in [1, COUNT] {
        let rotations = rotations.repeat(all);
        let shifts = shifts.repeat(COUNT);
        for row in rows(NOISES[0], &rotations, &shifts) {
            for (found, expected) in row.iter().zip([0.4, 1.2, 0.3, gaussian, mean]) {
                assert_relative_eq!(*found, expected, max_relative = 1e-13);
            }
            assert!(row[10] < 1e-15, "{}", row[10]);
        }
    }
}

#[test]
fn undetermined_sets_do_not_change_their_neighbours() {
    let (rotations, mut shifts) = noisy();
    let usual = rows(NOISES[0], &rotations, &shifts);
    let undetermined = [0, 33, COUNT - 1];
    for (set, factor) in undetermined.into_iter().zip([0.0, -1.0, 1e3]) {
        for shift in &mut shifts[set * PROBES..][..PROBES] {
            *shift = shift.map(|along| factor * along);
        }
    }
    for (set, row) in rows(NOISES[0], &rotations, &shifts).iter().enumerate() {
        match undetermined.contains(&set) {
            true => assert!(row.iter().all(|number| number.is_nan()), "{set}: {row:?}"),
            false => assert_eq!(row, &usual[set], "{set}"),
        }
    }
}

#[test]
fn a_non_finite_number_is_named() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (mut rotations, mut shifts) = noisy();
        shifts[40 * PROBES + 3][1] = bad;
        let mut rows = vec![[0.0; 11]; COUNT];
        let error = sets(NOISES[0], &rotations, &shifts).estimate(0, &mut rows);
        assert_eq!(error, Err((40, Ep1Error::NotFinite { probe: 3 })));
        // The number of the set is counted from the first set of all.
        let error = sets(NOISES[0], &rotations, &shifts).estimate(30, &mut rows[..20]);
        assert_eq!(error, Err((40, Ep1Error::NotFinite { probe: 3 })));
        rotations[7][0] = bad;
        let error = sets(NOISES[0], &rotations, &shifts).estimate(0, &mut rows);
        assert_eq!(error, Err((0, Ep1Error::NotFinite { probe: 7 })));
    }
}

#[test]
fn no_sets_and_no_probes_are_accepted() {
    assert_eq!(sets(NOISES[0], &[], &[]).estimate(0, &mut []), Ok(()));
    let none = Sets {
        probes: 0,
        ..sets(NOISES[2], &[], &[])
    };
    let mut rows = vec![[0.0; 11]; 40];
    assert_eq!(none.estimate(0, &mut rows), Ok(()));
    assert!(rows.iter().flatten().all(|number| number.is_nan()));
}

#[test]
fn exact_readings_of_two_probes_have_no_residual() {
    // Four equations for three unknowns: one degree of freedom. These shifts follow the model without residual.
    let sets = Sets {
        radius: 1.0,
        noise: ReadingNoise::default(),
        probes: 2,
        rotations: &[[0.0, -0.1], [0.1, 0.0]],
        shifts: &[[0.075, 0.0], [0.0, 0.075]],
    };
    let mut rows = vec![[0.0; 11]; 64];
    sets.estimate(0, &mut rows).unwrap();
    for row in rows {
        assert_relative_eq!(row[4], 1.0 / 3.0, max_relative = 1e-13);
        // Only rounding errors: no standard error, or one of the size of rounding.
        assert!(
            row[10] < 1e-16 && (row[8].is_nan() || row[8] <= 1e-13),
            "{row:?}"
        );
    }
}

#[test]
fn sets_of_many_probes_have_the_estimate_of_the_set_alone() {
    const MANY: usize = 25;
    let (rotations, shifts) = noisy();
    let mut rows = vec![[0.0; 11]; rotations.len() / MANY];
    let sets = Sets {
        probes: MANY,
        ..sets(NOISES[0], &rotations, &shifts)
    };
    sets.estimate(0, &mut rows).unwrap();
    for (set, row) in rows.iter().enumerate() {
        let readings: Vec<ProbeReading> = (set * MANY..(set + 1) * MANY)
            .map(|probe| ProbeReading {
                rotation: rotations[probe].into(),
                shift: shifts[probe].into(),
            })
            .collect();
        let estimate = LeastSquares::of(RADIUS, NOISES[0], &readings).unwrap();
        let (residual, _) = estimate.residual(&readings);
        assert_eq!(row[4].to_bits(), estimate.mean_curvature.value.to_bits());
        assert_eq!(row[10].to_bits(), residual.to_bits());
    }
}
