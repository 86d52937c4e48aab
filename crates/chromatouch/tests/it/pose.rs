//! Compares the features of markers with exact formulas. Some cameras are not in the sensor's centre, and some sensors
//! have parameters that differ from their nominal values.

use nalgebra::Vector3;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, Departure, Lens, MarkerArray, MarkerMotion, Optics, OpticsError,
    Pose, SeenMarker,
};

use crate::optics::{depths, discs};

const RADIUS: f64 = 20.0;
const DEPTH: f64 = 2.0;

/// Optics of markers at `places`. All discs have the diameter `diameter` and the same depth, and the two discs of each
/// marker are aligned.
fn optics(places: &[[f64; 2]], diameter: f64) -> Optics {
    let discs = discs(diameter, diameter);
    let array = MarkerArray::new(RADIUS, places, discs, depths(DEPTH, DEPTH)).unwrap();
    let camera = Camera::new(Lens::Fisheye, 700, 80.0).unwrap();
    Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap()
}

fn seen(optics: &Optics) -> Vec<SeenMarker> {
    let still = vec![Some(MarkerMotion::default()); optics.array().places().len()];
    let seen = optics.project(&still).unwrap();
    seen.into_iter().flatten().collect()
}

const PLACES: [[f64; 2]; 4] = [[0.0, 0.0], [8.0, 0.0], [-5.0, 9.0], [2.0, -12.0]];

fn place([x, y]: [f64; 2]) -> Vector3<f64> {
    let angle = libm::hypot(x, y) / RADIUS;
    let (sine, cosine) = libm::sincos(angle);
    let along = if angle > 0.0 {
        sine / (angle * RADIUS)
    } else {
        0.0
    };
    Vector3::new(x * along, y * along, cosine) * (RADIUS - DEPTH)
}

#[test]
fn a_camera_in_the_centre_is_the_default() {
    let central = optics(&PLACES, 2.0);
    let set = central.clone().seen_from(Pose::default()).unwrap();
    assert_eq!(seen(&set), seen(&central));
    assert_eq!(central.departed(&Departure::default()).unwrap(), central);
}

/// Small markers appear in the direction of the rays from the camera to the markers. The size of a marker's image
/// follows from the marker's distance and inclination.
#[test]
fn markers_are_seen_along_the_rays_from_the_camera() {
    let at = [1.5, -0.5, 4.0];
    let [central, beside] = [Pose::default(), Pose::new(at, [0.0; 3])]
        .map(|pose| seen(&optics(&PLACES, 0.02).seen_from(pose).unwrap()));
    let camera = Camera::new(Lens::Fisheye, 700, 80.0).unwrap();
    for (index, chart) in PLACES.into_iter().enumerate() {
        let marker = place(chart);
        let ray = marker - Vector3::from(at);
        let expected = camera.image(&ray).unwrap();
        for axis in 0..2 {
            let found = beside[index].centroid_px[axis];
            assert!(
                (found - expected[axis]).abs() < 1e-4,
                "{found} {expected:?}"
            );
        }
        // The solid angle is proportional to the cosine of the inclination, and to the inverse square of the distance.
        // The lens multiplies the solid angle by θ/sin θ, where θ is the angle from its axis.
        let stretch = |ray: &Vector3<f64>| {
            let angle = libm::atan2(libm::hypot(ray.x, ray.y), ray.z);
            if angle > 0.0 {
                angle / libm::sin(angle)
            } else {
                1.0
            }
        };
        let facing = ray.dot(&marker) / (ray.norm() * marker.norm());
        let ratio =
            facing * (marker.norm() / ray.norm()).powi(2) * stretch(&ray) / stretch(&marker);
        let found = beside[index].size_px2 / central[index].size_px2;
        assert!((found / ratio - 1.0).abs() < 1e-5, "{found} {ratio}");
    }
}

#[test]
fn a_turned_camera_sees_markers_turned() {
    let turn = 0.2;
    let pose = Pose::new([0.0; 3], [0.0, 0.0, turn]);
    let [central, turned] =
        [Pose::default(), pose].map(|pose| seen(&optics(&PLACES, 2.0).seen_from(pose).unwrap()));
    let (sine, cosine) = libm::sincos(turn);
    for (before, after) in central.iter().zip(&turned) {
        // If the camera turns about its axis, the image turns in the opposite direction. Because rows are counted
        // downward, the image turns by a positive angle in pixel coordinates.
        let [x, y] = before.centroid_px.map(|place| place - 349.5);
        let [found_x, found_y] = after.centroid_px.map(|place| place - 349.5);
        assert!((found_x - (x * cosine - y * sine)).abs() < 1e-9);
        assert!((found_y - (x * sine + y * cosine)).abs() < 1e-9);
        assert!((after.size_px2 - before.size_px2).abs() < 1e-9);
    }
    // A rotation of the camera about x shifts the image of the apex along y.
    let pose = Pose::new([0.0; 3], [0.1, 0.0, 0.0]);
    let tilted = seen(&optics(&[[0.0; 2]], 0.02).seen_from(pose).unwrap());
    let focal = Camera::new(Lens::Fisheye, 700, 80.0).unwrap().px_per_rad();
    assert!((tilted[0].centroid_px[1] - (349.5 - 0.1 * focal)).abs() < 1e-4);
}

#[test]
fn discs_that_depart_are_discs_made_so() {
    let known = optics(&PLACES, 2.0);
    let departed = |departure: Departure| seen(&known.departed(&departure).unwrap());
    // If the discs' depths and diameters differ from their nominal values, the images equal those of an array that was
    // made with the changed depths and diameters.
    let remade = departed(Departure {
        depths: [0.1; 2],
        diameters: [0.02; 2],
        ..Departure::default()
    });
    let discs = discs(2.04, 2.04);
    let array = MarkerArray::new(RADIUS, &PLACES, discs, depths(2.1, 2.1)).unwrap();
    let made = Optics::new(
        array,
        *known.camera(),
        Colours::default(),
        Blemishes::default(),
    );
    for (one, other) in remade.iter().zip(seen(&made.unwrap())) {
        assert!((one.size_px2 / other.size_px2 - 1.0).abs() < 1e-12);
    }
}

#[test]
fn cameras_that_cannot_be_are_refused() {
    let known = optics(&PLACES, 2.0);
    for place in [[0.0, 0.0, 17.0], [f64::NAN, 0.0, 0.0], [1e300; 3]] {
        let refused = known.clone().seen_from(Pose::new(place, [0.0; 3]));
        assert!(
            matches!(refused, Err(OpticsError::BadSetting(_))),
            "{place:?}"
        );
    }
    for turn in [f64::INFINITY, f64::NAN, 2.0] {
        let refused = known
            .clone()
            .seen_from(Pose::new([0.0; 3], [0.0, turn, 0.0]));
        assert!(matches!(refused, Err(OpticsError::BadSetting(_))), "{turn}");
    }
    let departures = [
        Departure {
            depths: [20.0, 0.0],
            ..Departure::default()
        },
        Departure {
            px_per_rad: f64::NAN,
            ..Departure::default()
        },
        Departure {
            centre_px: [1e9, 0.0],
            ..Departure::default()
        },
        Departure {
            diameters: [-1.0, 0.0],
            ..Departure::default()
        },
    ];
    for departure in departures {
        assert!(known.departed(&departure).is_err(), "{departure:?}");
    }
}
