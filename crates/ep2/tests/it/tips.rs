//! Contacts computed from the centres or the lowest points of round fingertips.

use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Ep2Error, Method, Patch, Penalised, RoundTip, TipPoint};

const POINTS: [TipPoint; 2] = [TipPoint::Lowest, TipPoint::Centre];

/// Unit normals at the contacts of three fingers on a ball. On a ball of radius 1, they are also the contact points.
fn normals() -> impl Iterator<Item = (usize, Vector3<f64>)> {
    (0..30).map(|index| {
        let (finger, step) = (index / 10, index % 10);
        let (x, y) = (step as f64 / 15.0 - 0.3, 0.3 * finger as f64 - 0.3);
        (finger, Vector3::new(x, y, (1.0 - x * x - y * y).sqrt()))
    })
}

/// Positions that a fingertip reports on a ball of radius 5 or, if `concave`, in a dish of radius 5.
fn readings(tip: &RoundTip, concave: bool, with_normals: bool) -> Vec<Contact> {
    let (radius, side) = if concave { (5.0, -1.0) } else { (5.0, 1.0) };
    let readings = normals().map(|(finger, out)| {
        // The outward normal of a dish points from the surface to the centre of the dish's sphere.
        let normal = Vector3::new(side * out.x, side * out.y, out.z);
        let contact = Vector3::new(radius * out.x, radius * out.y, side * radius * out.z);
        let centre = contact + normal * tip.radius;
        let point = match tip.point {
            TipPoint::Centre => centre,
            TipPoint::Lowest => centre - Vector3::z() * tip.radius,
        };
        Contact::new(
            finger,
            Point3::from(point),
            with_normals.then_some(normal * 3.0),
        )
    });
    readings.collect()
}

#[test]
fn contacts_from_tips_with_normals_lie_on_the_object() {
    for point in POINTS {
        for concave in [false, true] {
            for radius in [0.0, 1e-6, 0.5, 2.0] {
                let tip = RoundTip { radius, point };
                let readings = readings(&tip, concave, true);
                let contacts =
                    tip.contacts(&readings, &(Vector3::z() * 7.0), &Penalised::default());
                for contact in contacts.unwrap() {
                    let distance = contact.position.coords.norm();
                    assert!(
                        (distance - 5.0).abs() < 1e-12,
                        "{tip:?} {concave}: {distance}"
                    );
                }
            }
        }
    }
}

#[test]
fn tips_without_normals_determine_the_object() {
    for point in POINTS {
        for (concave, mean) in [(false, 0.2), (true, -0.2)] {
            let tip = RoundTip { radius: 1.0, point };
            let readings = readings(&tip, concave, false);
            let method = Penalised::default();
            let contacts = tip.contacts(&readings, &Vector3::z(), &method).unwrap();
            assert!(contacts.iter().all(|contact| contact.normal.is_none()));
            let patch = Patch::new(&contacts, &Vector3::z()).unwrap();
            let centre = method.fit(&patch).unwrap().centre().unwrap();
            let found = centre.curvature;
            assert!((found.mean - mean).abs() < 0.004, "{found:?}");
            // The centre of the tip moves on a ball of radius 6 or in a dish of radius 4. If the estimator ignores the
            // tip's radius, it estimates these radii.
            let taken = Patch::new(&readings, &Vector3::z()).unwrap();
            let taken = method.fit(&taken).unwrap().centre().unwrap().curvature;
            assert!((taken.mean - mean).abs() > 0.02, "{taken:?}");
        }
    }
}

#[test]
fn invalid_tips_are_refused_and_a_tip_of_radius_0_changes_nothing() {
    let method = Penalised::default();
    let tip = |radius| RoundTip {
        radius,
        point: TipPoint::Lowest,
    };
    let all = readings(&tip(1.0), false, true);
    for radius in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
        let error = tip(radius)
            .contacts(&all, &Vector3::z(), &method)
            .unwrap_err();
        assert!(error.to_string().contains("tip_radius"), "{error}");
    }
    for outward in [Vector3::zeros(), Vector3::new(0.0, f64::NAN, 1.0)] {
        let error = tip(1.0).contacts(&all, &outward, &method).unwrap_err();
        assert!(error.to_string().contains("outward"), "{error}");
    }
    assert_eq!(
        tip(0.0).contacts(&all, &Vector3::z(), &method).unwrap(),
        all
    );
    assert_eq!(
        tip(1.0).contacts(&[], &Vector3::z(), &method).err(),
        Patch::new(&[], &Vector3::z()).err()
    );
    // `Patch::new` must reject a contact whose normal has the length 0.
    let mut broken = all.clone();
    broken[4].normal = Some(Vector3::zeros());
    let contacts = tip(1.0).contacts(&broken, &Vector3::z(), &method).unwrap();
    let error = Patch::new(&contacts, &Vector3::z()).unwrap_err();
    assert!(
        matches!(error, Ep2Error::BadNormal { contact: 4, .. }),
        "{error}"
    );
}

#[test]
fn a_tip_larger_than_the_curvature_radius_of_its_centres_is_rejected() {
    for point in POINTS {
        for with_normals in [false, true] {
            // On a ball of radius 5, the centre of a tip of radius 2 moves on a ball of radius 7.
            let tip = RoundTip { radius: 2.0, point };
            let readings = readings(&tip, false, with_normals);
            for radius in [1.0, 6.9, 7.1, 100.0, 1e9] {
                let tip = RoundTip { radius, ..tip };
                let contacts = tip.contacts(&readings, &Vector3::z(), &Penalised::default());
                match contacts {
                    Ok(_) => assert!(radius < 7.0, "{radius}"),
                    Err(Ep2Error::TipTooLarge { tip_radius, turns }) => {
                        assert!(radius > 7.0 && tip_radius == radius, "{radius}");
                        assert!((turns - 7.0).abs() < 0.01, "{radius}: {turns}");
                    }
                    Err(error) => panic!("{radius}: {error}"),
                }
            }
        }
    }
}

#[test]
fn a_tip_of_any_size_can_turn_on_an_edge() {
    // If a tip of radius r turns about an edge, its centre moves on a cylinder of radius r. Because of the noise of the
    // normals, half of the estimated curvatures exceed 1/r. This must not be an error.
    let mut state = 1_u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for _ in 0..200 {
        let readings: Vec<Contact> = (0..30)
            .map(|index| {
                let (finger, step) = (index / 10, index % 10);
                let angle = step as f64 / 10.0 - 0.45;
                let normal = Vector3::new(libm::sin(angle), 0.0, libm::cos(angle));
                let centre = normal * 3.0 + Vector3::y() * finger as f64;
                let tilted = normal + Vector3::new(noise(), noise(), noise()) * 0.2;
                Contact::new(finger, Point3::from(centre), Some(tilted))
            })
            .collect();
        let tip = RoundTip {
            radius: 3.0,
            point: TipPoint::Centre,
        };
        let contacts = tip.contacts(&readings, &Vector3::z(), &Penalised::default());
        assert!(contacts.is_ok(), "{contacts:?}");
    }
}
