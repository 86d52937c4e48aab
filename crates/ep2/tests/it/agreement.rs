//! Goodness of fit and doubts against contacts of surfaces in closed form.

use nalgebra::{Point3, Rotation3, Vector3};
use palpate_ep2::{Agreement, Contact, Doubt, Method, Noise, Patch, Penalised, Quadric, TwoPass};

use palpate_sensing::{Channel, Stream};

use crate::samples::{QUADRIC_LIKE, Surface, Sweep};

/// Seven contacts of each of five fingers, which err by a fiftieth of their distance and by a degree.
const SWEEP: Sweep = Sweep {
    fingers: 5,
    contacts_per_finger: 7,
    position_std: 0.02,
    normal_std_rad: 0.02,
};

fn told(sweep: &Sweep) -> Noise {
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

fn agreement(method: &dyn Method, contacts: &[Contact]) -> Agreement {
    let patch = Patch::new(contacts, &Vector3::z()).unwrap();
    method.agreement(&patch).unwrap()
}

/// A saddle, which is a quadric.
const SADDLE: &Surface = &QUADRIC_LIKE[3];

/// Largest distance of the distribution of numbers from the uniform one (Kolmogorov), times the root of their number.
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

/// Kolmogorov's distance that uniform numbers exceed once in a hundred.
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
                noise: told(&SWEEP),
            },
            SWEEP,
        ),
        (
            &Quadric {
                noise: told(&exact),
            },
            exact,
        ),
        (&penalised(told(&SWEEP)), SWEEP),
    ];
    for (method, sweep) in methods {
        let (mut p_values, mut doubted) = (Vec::new(), 0);
        for trial in 0..200 {
            let found = agreement(method, &sweep.contacts(SADDLE, trial));
            let goodness = found.goodness.unwrap();
            assert!(
                goodness.freedom > 50 && goodness.freedom < 105,
                "{goodness:?}"
            );
            p_values.push(goodness.p_value);
            doubted += usize::from(!found.doubts.is_empty());
        }
        let off = kolmogorov(p_values);
        assert!(off < ONE_IN_100, "{off}");
        assert!(doubted < 10, "{doubted}");
    }
}

#[test]
fn a_quadric_is_not_fitted_to_waves_without_a_word() {
    for noise in [told(&SWEEP), Noise::default()] {
        let method = Quadric { noise };
        let is_doubted = |contacts: &[Contact]| {
            let doubts = agreement(&method, contacts).doubts;
            doubts.iter().any(|doubt| doubt.name() == "not-a-quadric")
        };
        let (mut waves, mut saddles) = (0, 0);
        for trial in 0..100 {
            let mut contacts = SWEEP.contacts(SADDLE, trial);
            saddles += usize::from(is_doubted(&contacts));
            for contact in &mut contacts {
                let along = 1.5 * contact.position.x + 1.0;
                contact.position.z += 0.1 * libm::sin(along);
                if let Some(normal) = &mut contact.normal {
                    *normal -= Vector3::x() * (0.15 * libm::cos(along) * normal.z);
                }
            }
            waves += usize::from(is_doubted(&contacts));
        }
        assert!(waves > 95 && saddles < 4, "{waves} {saddles}");
    }
}

/// Change of contacts, and the doubt that is due.
type Flaw<'f> = (&'f dyn Fn(&mut [Contact]), &'static str);

#[test]
fn each_flaw_is_named() {
    let displaced = |contacts: &mut [Contact]| {
        let those = contacts.iter_mut().filter(|one| one.finger == 3);
        those.for_each(|one| one.position.z += 8.0 * SWEEP.position_std);
    };
    let turned = |contacts: &mut [Contact]| {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.3);
        let normals = contacts.iter_mut().filter_map(|one| one.normal.as_mut());
        normals.for_each(|normal| *normal = turn * *normal);
    };
    let flaws: [Flaw<'_>; 2] = [
        (&displaced, "displaced-finger"),
        (&turned, "contradicting-normals"),
    ];
    for (flaw, name) in flaws {
        let methods: [&dyn Method; 3] = [
            &penalised(told(&SWEEP)),
            &Penalised::default(),
            &TwoPass::default(),
        ];
        for method in methods {
            let named = (0..10).filter(|&trial| {
                let mut contacts = SWEEP.contacts(SADDLE, trial);
                flaw(&mut contacts);
                let doubts = agreement(method, &contacts).doubts;
                doubts.iter().any(|doubt| doubt.name() == name)
            });
            assert!(named.count() >= 9, "{name}");
        }
    }
}

/// Slopes that the surface follows rather than the positions, since they scatter less.
#[test]
fn normals_of_another_size_of_slopes_are_told() {
    for share in [0.0, 0.5] {
        for noise in [told(&SWEEP), Noise::default()] {
            let named = (0..10).filter(|&trial| {
                let mut contacts = SWEEP.contacts(SADDLE, trial);
                for normal in contacts.iter_mut().filter_map(|one| one.normal.as_mut()) {
                    (normal.x, normal.y) = (share * normal.x, share * normal.y);
                }
                let doubts = agreement(&penalised(noise), &contacts).doubts;
                doubts
                    .iter()
                    .any(|doubt| doubt.name() == "contradicting-normals")
            });
            assert!(named.count() >= 9, "{share} with {noise:?}");
        }
    }
}

/// A surface that is taken for so rough that it follows positions and normals alike.
#[test]
fn normals_of_a_turned_frame_are_no_roughness() {
    let sweep = Sweep {
        fingers: 3,
        contacts_per_finger: 10,
        ..SWEEP
    };
    let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.17);
    let named = (0..10).filter(|&trial| {
        let mut contacts = sweep.contacts(&QUADRIC_LIKE[0], trial);
        for normal in contacts.iter_mut().filter_map(|one| one.normal.as_mut()) {
            *normal = turn * *normal;
        }
        let doubts = agreement(&penalised(told(&sweep)), &contacts).doubts;
        doubts
            .iter()
            .any(|doubt| doubt.name() == "contradicting-normals")
    });
    assert_eq!(named.count(), 10);
}

/// Few contacts leave little noise beside the process, which is no sign of a stray one.
#[test]
fn few_sound_contacts_are_seldom_doubted() {
    for (fingers, contacts_per_finger) in [(3, 2), (3, 3), (3, 4), (4, 4)] {
        let sweep = Sweep {
            fingers,
            contacts_per_finger,
            ..SWEEP
        };
        for has_normals in [false, true] {
            let doubted = (0..100).filter(|&trial| {
                let mut contacts = sweep.contacts(&QUADRIC_LIKE[0], trial);
                if !has_normals {
                    contacts.iter_mut().for_each(|one| one.normal = None);
                }
                let patch = Patch::new(&contacts, &Vector3::z()).unwrap();
                let found = Penalised::default().agreement(&patch).unwrap();
                !found.doubts.is_empty()
            });
            let doubted = doubted.count();
            assert!(
                doubted <= 5,
                "{doubted} of {fingers} x {contacts_per_finger}"
            );
        }
    }
}

#[test]
fn the_finger_that_is_displaced_is_told() {
    let mut contacts = SWEEP.contacts(SADDLE, 1);
    let those = contacts.iter_mut().filter(|one| one.finger == 1);
    those.for_each(|one| one.position.z -= 0.3);
    let doubts = agreement(&penalised(told(&SWEEP)), &contacts).doubts;
    let finger = doubts.iter().find_map(|doubt| match doubt {
        Doubt::DisplacedFinger { finger, .. } => Some(*finger),
        _ => None,
    });
    assert_eq!(finger, Some(1));
}

#[test]
fn a_finger_of_three_is_told_from_the_roughness_that_it_looks_like() {
    let sweep = Sweep {
        fingers: 3,
        ..SWEEP
    };
    let is_named = |trial, by: f64| {
        let mut contacts = sweep.contacts(SADDLE, trial);
        let those = contacts.iter_mut().filter(|one| one.finger == 1);
        those.for_each(|one| one.position.z += by * sweep.position_std);
        let doubts = agreement(&penalised(told(&sweep)), &contacts).doubts;
        doubts
            .iter()
            .any(|doubt| doubt.name() == "displaced-finger")
    };
    let named = |by| (0..100).filter(|trial| is_named(*trial, by)).count();
    let [none, far] = [0.0, 12.0].map(named);
    assert!(none < 5 && far > 90, "{none} {far}");
}

/// Numbers from 0 to 1 that no rule relates.
fn scattered(number: u64) -> f64 {
    let wide = 43_758.5 * libm::sin(12.9 * number as f64 + 0.7);
    wide - wide.floor()
}

/// Contacts without normals tell the length of waves badly: fingers count by all lengths that may be.
#[test]
fn fingers_in_place_are_seldom_displaced_over_waves() {
    const STD: f64 = 0.005;
    let method = penalised(Noise {
        position_std: Some(STD),
        normal_std_rad: None,
    });
    let mut displaced = 0;
    for trial in 0..150 {
        let between =
            |number: u64, low: f64, high: f64| low + (high - low) * scattered(20 * trial + number);
        let [a, b, c] = [0, 1, 2].map(|number| between(number, -0.12, 0.12));
        let waves = [4, 8].map(|first| {
            let number = between(first, 0.4, 1.6);
            let size = between(first + 1, 0.02, 0.25) / (number * number);
            let (sine, cosine) = libm::sincos(between(first + 2, 0.0, std::f64::consts::TAU));
            (
                size,
                number * cosine,
                number * sine,
                between(first + 3, 0.0, std::f64::consts::TAU),
            )
        });
        let mut noise = Stream::new(1919, trial, Channel::Position);
        let mut error = || STD * noise.standard_normal();
        let contacts: Vec<Contact> = (0..50)
            .map(|number| {
                let x = f64::from(number % 10) / 3.0 - 1.5;
                let y = f64::from(number / 10) - 2.0;
                let wave = |(size, along_x, along_y, phase): (f64, f64, f64, f64)| {
                    size * libm::sin(along_x * x + along_y * y + phase)
                };
                let z = a * x * x + b * x * y + c * y * y + waves.map(wave).iter().sum::<f64>();
                let position = Point3::new(x + error(), y + error(), z + error());
                Contact::new(number as usize / 10, position, None)
            })
            .collect();
        let doubts = agreement(&method, &contacts).doubts;
        displaced += usize::from(
            doubts
                .iter()
                .any(|doubt| doubt.name() == "displaced-finger"),
        );
    }
    assert!(displaced <= 5, "{displaced}");
}

#[test]
fn a_contact_that_strays_is_told() {
    // One that is far off is no roughness either.
    let cases = [
        (told(&SWEEP), 0.2),
        (Noise::default(), 0.2),
        (Noise::default(), 3.0),
    ];
    for (noise, off) in cases {
        let named = (0..20).filter(|&trial| {
            let mut contacts = SWEEP.contacts(SADDLE, trial);
            contacts[16].position.z += off;
            let doubts = agreement(&penalised(noise), &contacts).doubts;
            let told = doubts.iter().find_map(|doubt| match doubt {
                Doubt::StrayContact { contact, .. } => Some(*contact),
                _ => None,
            });
            told == Some(16)
        });
        let count = named.count();
        assert!(count >= 18, "{count} with {noise:?}");
    }
}

#[test]
fn noise_that_is_told_too_small_is_named() {
    let half = Noise {
        position_std: Some(0.5 * SWEEP.position_std),
        normal_std_rad: Some(0.5 * SWEEP.normal_std_rad),
    };
    for trial in 0..5 {
        let found = agreement(&penalised(half), &SWEEP.contacts(SADDLE, trial));
        let names: Vec<_> = found.doubts.iter().map(|doubt| doubt.name()).collect();
        assert!(names.contains(&"large-residuals"), "{names:?}");
    }
}

#[test]
fn what_states_no_noise_has_no_goodness() {
    let contacts = SWEEP.contacts(SADDLE, 0);
    assert_eq!(agreement(&Penalised::default(), &contacts).goodness, None);
    assert_eq!(agreement(&TwoPass::default(), &contacts).goodness, None);
    // Exact contacts leave nothing to be tested.
    let exact = Sweep {
        position_std: 0.0,
        normal_std_rad: 0.0,
        ..SWEEP
    };
    let found = agreement(&Penalised::default(), &exact.contacts(SADDLE, 0));
    assert_eq!(found, Agreement::default());
}

#[test]
fn of_many_contacts_some_are_tested() {
    let many = Sweep {
        contacts_per_finger: 900,
        ..SWEEP
    };
    let found = agreement(&Quadric { noise: told(&many) }, &many.contacts(SADDLE, 3));
    let goodness = found.goodness.unwrap();
    // Every third of 4,500, less the quadric.
    assert_eq!(goodness.freedom, 3 * 1500 - 6);
    assert!(
        goodness.p_value > 1e-3 && found.doubts.is_empty(),
        "{found:?}"
    );
}
