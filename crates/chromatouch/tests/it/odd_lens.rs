//! Fisheye lenses with odd terms.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector3;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, Departure, Layout, Lens, MarkerArray, MarkerMotion, OddTerms,
    Optics, SeenMarker,
};

use crate::optics::{DISCS, depths};

const FIELD: f64 = 65.0;
/// Odd terms of five lenses: an equisolid lens, a stereographic lens, two lenses with terms of opposite signs, and a
/// lens whose image is almost folded at the rim.
const TERMS: [[f64; 2]; 5] = [
    [-1.0 / 24.0, 1.0 / 1920.0],
    [1.0 / 12.0, 1.0 / 120.0],
    [0.05, -0.03],
    [-0.2, 0.02],
    [-0.25, 0.0],
];

fn camera([k3, k5]: [f64; 2]) -> Camera {
    Camera::new(Lens::from(OddTerms { k3, k5 }), 640, FIELD).unwrap()
}

fn optics(camera: Camera) -> Optics {
    let places = Layout::published().places(20.0).unwrap();
    let array = MarkerArray::new(20.0, &places, DISCS, depths(3.0, 1.0)).unwrap();
    Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap()
}

fn at_rest(optics: &Optics) -> Vec<Option<SeenMarker>> {
    let motions = vec![Some(MarkerMotion::default()); optics.array().places().len()];
    optics.project(&motions).unwrap()
}

#[test]
fn angles_are_seen_where_the_polynomial_has_them() {
    for [k3, k5] in TERMS {
        let camera = camera([k3, k5]);
        let map = |angle: f64| angle + k3 * angle.powi(3) + k5 * angle.powi(5);
        // The edge of the field of view is on the rim of the image, for all odd terms.
        assert_relative_eq!(
            camera.px_per_rad() * map(FIELD.to_radians()),
            320.0,
            max_relative = 1e-14
        );
        for step in 0..=130 {
            let (polar, azimuth) = (0.5 * f64::from(step), 0.1 * f64::from(step));
            let (sine, cosine) = libm::sincos(polar.to_radians());
            let (up, along) = libm::sincos(azimuth);
            let direction = Vector3::new(sine * along, sine * up, cosine);
            let place = camera.image(&direction).unwrap();
            let radius = libm::hypot(place[0] - 319.5, place[1] - 319.5);
            assert_relative_eq!(
                radius,
                camera.px_per_rad() * map(polar.to_radians()),
                epsilon = 1e-10
            );
        }
    }
}

#[test]
fn an_equisolid_lens_shows_all_directions_alike() {
    // The odd terms of this lens are the series of 2 sin(θ/2), without the terms from the seventh power on. At 0.5 rad,
    // the omitted terms change the image area per solid angle by less than 1e-6.
    let camera = camera(TERMS[0]);
    let square = camera.px_per_rad().powi(2);
    for polar in [0.0, 0.03, 0.1, 0.3, 0.5] {
        let area = camera.disc_area(0.02, polar).unwrap();
        let solid = 2.0 * PI * (1.0 - libm::cos(0.02));
        assert_relative_eq!(area, square * solid, max_relative = 2e-6);
    }
}

#[test]
fn pictures_follow_a_change_of_the_terms_as_they_follow_a_new_lens() {
    let known = optics(camera([0.0; 2]));
    for [k3, k5] in TERMS {
        let departed = known.departed(&Departure {
            odd_terms: [k3, k5],
            ..Departure::default()
        });
        let Ok(departed) = departed else {
            // Only the last lens of `TERMS` may be rejected. Its odd terms fold the image: the image radius stops
            // growing with the angle before the rim of the image circle.
            assert_eq!([k3, k5], TERMS[4]);
            continue;
        };
        // The departure changes only the odd terms. The image circle and the pixels per radian stay the same, so the
        // angle between the rim and the axis changes.
        let other = departed.camera();
        assert_relative_eq!(other.px_per_rad(), known.camera().px_per_rad());
        let (sine, cosine) = libm::sincos(0.9_f64);
        let [column, _] = other.image(&Vector3::new(sine, 0.0, cosine)).unwrap();
        let map = 0.9 + k3 * 0.9_f64.powi(3) + k5 * 0.9_f64.powi(5);
        assert_relative_eq!(
            column - 319.5,
            other.px_per_rad() * map,
            max_relative = 1e-12
        );
        for (marker, (seen, place)) in at_rest(&departed)
            .iter()
            .zip(known.array().places())
            .enumerate()
        {
            let Some(seen) = seen else { continue };
            let angle = libm::hypot(place[0], place[1]) / 20.0;
            let map = angle + k3 * angle.powi(3) + k5 * angle.powi(5);
            let radius = libm::hypot(seen.centroid_px[0] - 319.5, seen.centroid_px[1] - 319.5);
            // The tolerance is needed because the centroid of a disc of finite size is not exactly the image of its
            // centre.
            let error = radius - other.px_per_rad() * map;
            assert!(error.abs() < 0.5, "marker {marker}: {error}");
        }
    }
    assert_eq!(
        known
            .departed(&Departure::default())
            .unwrap()
            .camera()
            .odd_terms(),
        Some(OddTerms::default())
    );
}

#[test]
fn lenses_that_cannot_be_are_refused_with_what_would_be_right() {
    let made = |k3, k5, field| Camera::new(Lens::from(OddTerms { k3, k5 }), 640, field);
    let refused = made(-0.5, 0.0, 65.0).unwrap_err();
    assert_eq!(refused.setting(), Some("k3"));
    let said = refused.to_string();
    // The derivative 1 − 1.5 θ² of the image radius r/f with respect to the angle θ decreases to 0.01 at 46.55°. For a
    // field that ends at θ = 65°, the smallest possible k3 is −0.99 / (3 θ²).
    for word in ["k3 = -0.5", "up to 46.54", "ends at 65", "at least -0.2564"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    made(-0.2563, 0.0, 65.0).unwrap();
    let departed = |lens, field, k3| {
        let departure = Departure {
            odd_terms: [k3, 0.0],
            ..Departure::default()
        };
        optics(Camera::new(lens, 640, field).unwrap()).departed(&departure)
    };
    assert!(departed(Lens::Pinhole, 65.0, 0.1).is_err());
    // With k3 = −0.2, the distance from the image's centre stops growing with the angle before the rim is reached.
    assert!(departed(Lens::Fisheye, 120.0, -0.2).is_err());
}
