//! A patch's place, orientation and size do not matter.

use crate::samples::{QUADRIC_LIKE, Sweep, grid};
use nalgebra::{Point3, Rotation3, Vector3};
use palpate_ep2::{Contact, Fit, Method, Patch, Penalised, Quadric, TwoPass};

fn methods() -> [Box<dyn Method>; 3] {
    [
        Box::new(Penalised::default()),
        Box::new(Quadric::default()),
        Box::new(TwoPass::default()),
    ]
}

fn fit(method: &dyn Method, contacts: &[Contact], outward: &Vector3<f64>) -> Fit {
    method.fit(&Patch::new(contacts, outward).unwrap()).unwrap()
}

#[test]
fn rotations_and_shifts_change_nothing() {
    let rotations = [
        Rotation3::from_euler_angles(0.3, -1.1, 2.0),
        Rotation3::from_euler_angles(3.1, 0.2, -0.4),
        Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2),
    ];
    for surface in &QUADRIC_LIKE {
        for with_normals in [true, false] {
            let mut contacts = Sweep::paper(0.05).contacts(surface, 5);
            if !with_normals {
                contacts
                    .iter_mut()
                    .for_each(|contact| contact.normal = None);
            }
            for method in methods() {
                let still = fit(method.as_ref(), &contacts, &Vector3::z());
                for rotation in &rotations {
                    let moved =
                        |point: Point3<f64>| rotation * point + Vector3::new(1.0, -2.0, 0.5);
                    let turned: Vec<Contact> = contacts
                        .iter()
                        .map(|contact| Contact {
                            position: moved(contact.position),
                            normal: contact.normal.map(|normal| rotation * normal),
                            ..*contact
                        })
                        .collect();
                    let turned = fit(method.as_ref(), &turned, &(rotation * Vector3::z()));
                    for (x, y) in grid(5) {
                        let point = (surface.at)(x, y).0;
                        let one = still.curvature_at(&point).unwrap();
                        let other = turned.curvature_at(&moved(point)).unwrap();
                        let close = |one: f64, other: f64, unit: f64| {
                            (one - other).abs() <= 1e-9 * one.abs().max(unit)
                        };
                        let same = close(one.gaussian, other.gaussian, 1e-2)
                            && close(one.mean, other.mean, 1e-1);
                        assert!(same, "{} {with_normals}: {one:?} {other:?}", surface.name);
                    }
                }
            }
        }
    }
}

#[test]
fn tiny_and_huge_patches_are_as_good() {
    let sphere = &QUADRIC_LIKE[0];
    let contacts = Sweep::paper(0.05).contacts(sphere, 2);
    for method in methods() {
        let usual = fit(method.as_ref(), &contacts, &Vector3::z())
            .centre()
            .unwrap();
        for scale in [1e-9, 1e9] {
            let scaled: Vec<Contact> = contacts
                .iter()
                .map(|contact| Contact {
                    position: contact.position * scale,
                    ..*contact
                })
                .collect();
            let centre = fit(method.as_ref(), &scaled, &Vector3::z())
                .centre()
                .unwrap();
            let (mean, gaussian) = (centre.curvature.mean, centre.curvature.gaussian);
            assert!((mean * scale / usual.curvature.mean - 1.0).abs() < 1e-9);
            assert!((gaussian * scale * scale / usual.curvature.gaussian - 1.0).abs() < 1e-9);
        }
    }
}
