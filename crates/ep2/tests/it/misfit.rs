//! Goodness of fit and misfits of contacts on surfaces that are given by formulas.

use nalgebra::Vector3;
use palpate_ep2::{Contact, Method, Misfit, MisfitTest, Noise, Patch, Penalised, Quadric};

use crate::samples::{QUADRIC_LIKE, Surface, Sweep};

/// Five fingers with seven contacts each, on a patch with sides of length 3. Positions have errors of 0.02, and normals
/// have errors of 0.02 rad.
const SWEEP: Sweep = Sweep {
    fingers: 5,
    contacts_per_finger: 7,
    position_std: 0.02,
    normal_std_rad: 0.02,
};

fn stated(sweep: &Sweep) -> Noise {
    Noise {
        position_std: Some(sweep.position_std),
        normal_std_rad: Some(sweep.normal_std_rad),
    }
}

fn penalised(noise: Noise) -> Penalised {
    Penalised {
        noise,
        ..Penalised::default()
    }
}

fn misfit(method: &dyn Method, contacts: &[Contact]) -> MisfitTest {
    let patch = Patch::new(contacts, &Vector3::z()).unwrap();
    method.misfit(&patch, None).unwrap()
}

const SADDLE: &Surface = &QUADRIC_LIKE[3];

/// Kolmogorov statistic of numbers: the largest distance between their distribution and the uniform distribution, times
/// the square root of their count.
fn kolmogorov(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let count = numbers.len() as f64;
    let off = numbers.iter().enumerate().map(|(index, number)| {
        let below = index as f64 / count;
        (number - below)
            .abs()
            .max((number - below - 1.0 / count).abs())
    });
    off.fold(0.0, f64::max) * count.sqrt()
}

/// Kolmogorov statistic that uniform numbers exceed with a probability of 1 %.
const ONE_IN_100: f64 = 1.628;

#[test]
fn p_values_are_uniform_on_a_quadric() {
    let exact = Sweep {
        position_std: 1e-9,
        normal_std_rad: 1e-9,
        ..SWEEP
    };
    let methods: [(&dyn Method, Sweep); 3] = [
        (
            &Quadric {
                noise: stated(&SWEEP),
            },
            SWEEP,
        ),
        (
            &Quadric {
                noise: stated(&exact),
            },
            exact,
        ),
        (&penalised(stated(&SWEEP)), SWEEP),
    ];
    for (method, sweep) in methods {
        let (mut p_values, mut found_misfits) = (Vec::new(), 0);
        for trial in 0..200 {
            let found = misfit(method, &sweep.contacts(SADDLE, trial));
            let goodness = found.goodness.unwrap();
            assert!(
                goodness.freedom > 50 && goodness.freedom < 105,
                "{goodness:?}"
            );
            p_values.push(goodness.p_value);
            found_misfits += usize::from(!found.misfits.is_empty());
        }
        let off = kolmogorov(p_values);
        assert!(off < ONE_IN_100, "{off}");
        assert!(found_misfits < 10, "{found_misfits}");
    }
}

/// If there are few contacts, only a small part of the noise remains in the residuals. The outlier test must not report
/// this remaining noise as an outlier.
#[test]
fn few_sound_contacts_seldom_have_a_misfit() {
    for (fingers, contacts_per_finger) in [(3, 2), (3, 3), (3, 4), (4, 4)] {
        let sweep = Sweep {
            fingers,
            contacts_per_finger,
            ..SWEEP
        };
        for has_normals in [false, true] {
            let warned = (0..100).filter(|&trial| {
                let mut contacts = sweep.contacts(&QUADRIC_LIKE[0], trial);
                if !has_normals {
                    contacts.iter_mut().for_each(|one| one.normal = None);
                }
                let patch = Patch::new(&contacts, &Vector3::z()).unwrap();
                let found = Penalised::default().misfit(&patch, None).unwrap();
                !found.misfits.is_empty()
            });
            let warned = warned.count();
            assert!(warned <= 5, "{warned} of {fingers} x {contacts_per_finger}");
        }
    }
}

#[test]
fn an_outlier_of_eight_standard_deviations_is_named() {
    // A single contact that is far off the surface must be reported as an outlier, and not as roughness of the surface.
    let cases = [
        (stated(&SWEEP), 8.0),
        (Noise::default(), 10.0),
        (Noise::default(), 150.0),
    ];
    for (noise, off) in cases {
        let named = (0..20).filter(|&trial| {
            let mut contacts = SWEEP.contacts(SADDLE, trial);
            contacts[16].position.z += off * SWEEP.position_std;
            let misfits = misfit(&penalised(noise), &contacts).misfits;
            let is_named = |one: &Misfit| matches!(one, Misfit::Outlier { reading: 16, .. });
            misfits.iter().any(is_named)
        });
        let count = named.count();
        assert!(count >= 18, "{count} with {noise:?}");
    }
}

#[test]
fn noise_three_times_the_stated_one_is_a_poor_fit() {
    let third = Noise {
        position_std: Some(SWEEP.position_std / 3.0),
        normal_std_rad: Some(SWEEP.normal_std_rad / 3.0),
    };
    for fingers in [3, 5] {
        let sweep = Sweep { fingers, ..SWEEP };
        for trial in 0..10 {
            let found = misfit(&penalised(third), &sweep.contacts(SADDLE, trial));
            let codes: Vec<_> = found.misfits.iter().map(Misfit::code).collect();
            assert!(codes.contains(&"poor-fit"), "{codes:?}");
        }
    }
}
