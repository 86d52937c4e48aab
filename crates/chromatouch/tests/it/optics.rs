//! Tests the features of markers in the image that are computed without pixels.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector3;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, Departure, DiscDepths, DiscMotion, Discs, Layout, Lens,
    MarkerArray, MarkerMotion, Optics, OpticsError, Pose, SeenMarker,
};

/// Colours for which a magenta disc absorbs only green light, and a yellow disc only blue light.
pub(crate) const PURE: Colours = Colours {
    white: [1.0; 3],
    magenta: [1.0, 0.0, 1.0],
    yellow: [1.0, 1.0, 0.0],
    seam: [1.0; 3],
    outside: [1.0; 3],
};

pub(crate) const DISCS: Discs = discs(2.0, 2.0);

pub(crate) const fn discs(magenta: f64, yellow: f64) -> Discs {
    Discs { magenta, yellow }
}

pub(crate) fn depths(magenta: f64, yellow: f64) -> DiscDepths {
    DiscDepths { magenta, yellow }
}

pub(crate) fn optics(
    places: &[[f64; 2]],
    depths: DiscDepths,
    lens: Lens,
    colours: Colours,
) -> Optics {
    let array = MarkerArray::new(20.0, places, DISCS, depths).unwrap();
    let camera = Camera::new(lens, 640, 70.0).unwrap();
    Optics::new(array, camera, colours, Blemishes::default()).unwrap()
}

pub(crate) fn moved(magenta: DiscMotion, yellow: DiscMotion) -> Option<MarkerMotion> {
    Some(MarkerMotion { magenta, yellow })
}

pub(crate) fn inward(normal: f64) -> DiscMotion {
    DiscMotion {
        normal,
        ..DiscMotion::default()
    }
}

pub(crate) fn along(tangential: [f64; 2]) -> DiscMotion {
    DiscMotion {
        tangential,
        ..DiscMotion::default()
    }
}

/// Features of the only marker of a sensor.
fn seen(optics: &Optics, motion: Option<MarkerMotion>) -> SeenMarker {
    optics.project(&[motion]).unwrap()[0].unwrap()
}

/// Skin coordinates of the point at the polar angle `polar_deg` and the azimuth `azimuth_deg`, on a skin of radius 20.
pub(crate) fn at(polar_deg: f64, azimuth_deg: f64) -> [f64; 2] {
    let (sine, cosine) = libm::sincos(azimuth_deg.to_radians());
    [cosine, sine].map(|share| 20.0 * polar_deg.to_radians() * share)
}

/// Image area, divided by the squared focal length, of a cap of directions that does not contain the axis: ∫ θ 2Δφ dθ.
/// The circle of directions with the polar angle θ crosses the edge of the cap at the azimuths ±Δφ. The integral is
/// computed by the midpoint rule in t, with θ = θ₀ − α cos t.
fn fisheye_area(radius: f64, polar: f64) -> f64 {
    let steps = 20_000;
    let step = PI / f64::from(steps);
    let slice = |number: u32| {
        let (sine, cosine) = libm::sincos((f64::from(number) + 0.5) * step);
        let angle = polar - radius * cosine;
        let across = (libm::cos(radius) - libm::cos(angle) * libm::cos(polar))
            / (libm::sin(angle) * libm::sin(polar));
        2.0 * libm::acos(across.clamp(-1.0, 1.0)) * angle * radius * sine * step
    };
    (0..steps).map(slice).sum()
}

#[test]
fn a_disc_has_the_image_area_that_integration_gives() {
    let fisheye = Camera::new(Lens::Fisheye, 640, 80.0).unwrap();
    let square = fisheye.px_per_rad().powi(2);
    for (radius, bound) in [(0.05, 1e-5), (0.1, 1e-4)] {
        for polar_deg in [10.0_f64, 30.0, 60.0, 70.0] {
            let polar = polar_deg.to_radians();
            let area = fisheye.disc_area(radius, polar).unwrap();
            let expected = square * fisheye_area(radius, polar);
            assert_relative_eq!(area, expected, max_relative = bound);
        }
        // At the apex, the image of a disc is a circle of radius f α, with the focal length f and the angular radius α.
        let area = fisheye.disc_area(radius, 0.0).unwrap();
        assert_relative_eq!(area, PI * square * radius * radius, max_relative = 2e-6);
    }
    // A pinhole images a disc as an ellipse, because the rays to the edge of the disc form a cone.
    let pinhole = Camera::new(Lens::Pinhole, 640, 70.0).unwrap();
    let square = pinhole.px_per_rad().powi(2);
    for polar_deg in [0.0_f64, 30.0, 60.0] {
        let (radius, polar) = (0.05_f64, polar_deg.to_radians());
        let (sine, cosine) = libm::sincos(radius);
        let power = libm::cos(polar).powi(2) - sine * sine;
        let expected = PI * square * sine * sine * cosine / libm::pow(power, 1.5);
        let area = pinhole.disc_area(radius, polar).unwrap();
        assert_relative_eq!(area, expected, max_relative = 1e-12);
    }
}

#[test]
fn series_at_the_axis_and_closed_forms_off_it_meet() {
    // At a polar angle of 0.05 rad, the code switches from a series to an exact formula. The area must not jump at this
    // angle.
    let camera = Camera::new(Lens::Fisheye, 640, 80.0).unwrap();
    let area = |polar| camera.disc_area(0.05, polar).unwrap();
    let step = 1e-6;
    let rise = area(0.05 + step) - area(0.05 - step);
    assert!((rise / area(0.05)).abs() < 1e-6, "{rise}");
}

#[test]
fn concentric_discs_of_pure_colours_count_with_both_areas() {
    for (lens, image) in [
        (Lens::Fisheye, (|angle| angle) as fn(f64) -> f64),
        (Lens::Pinhole, libm::tan),
    ] {
        let optics = optics(&[[0.0, 0.0]], depths(3.0, 1.0), lens, PURE);
        let focal = optics.camera().px_per_rad();
        let area = |distance: f64| PI * (focal * image(libm::atan(1.0 / distance))).powi(2);
        let marker = seen(&optics, Some(MarkerMotion::default()));
        assert_relative_eq!(
            marker.size_px2,
            area(17.0) + area(19.0),
            max_relative = 1e-5
        );
        assert_relative_eq!(marker.centroid_px[0], 319.5, epsilon = 1e-9);
        assert_relative_eq!(marker.centroid_px[1], 319.5, epsilon = 1e-9);
        // The middle of the marker is red, because both discs overlap there. The ring around the middle is magenta.
        // Both parts contribute red light, but only the ring contributes blue light.
        let ring = area(17.0) - area(19.0);
        let turns = 1.0 - ring / area(17.0) / 6.0;
        assert_relative_eq!(marker.hue_turns, turns, epsilon = 1e-5);
        // If only the magenta disc moves inward, only the image area of this disc grows.
        let near = seen(&optics, moved(inward(0.5), inward(0.0))).size_px2;
        assert_relative_eq!(near, area(16.5) + area(19.0), max_relative = 1e-5);
    }
}

#[test]
fn a_pinhole_shows_the_middle_of_the_ellipse() {
    let optics = optics(&[at(50.0, 0.0)], depths(2.0, 2.0), Lens::Pinhole, PURE);
    let marker = seen(&optics, Some(MarkerMotion::default()));
    let (polar, radius) = (50.0_f64.to_radians(), libm::atan(1.0_f64 / 18.0));
    let middle = 0.5 * (libm::tan(polar + radius) + libm::tan(polar - radius));
    let expected = 319.5 + optics.camera().px_per_rad() * middle;
    assert_relative_eq!(marker.centroid_px[0], expected, epsilon = 1e-9);
    assert_relative_eq!(marker.centroid_px[1], 319.5, epsilon = 1e-9);
}

#[test]
fn a_marker_moved_inward_grows_with_its_nearness() {
    let optics = optics(&[[0.0, 0.0]], depths(2.0, 2.0), Lens::Fisheye, PURE);
    let rest = seen(&optics, Some(MarkerMotion::default())).size_px2;
    for normal in [-0.5_f64, 0.01, 0.5, 1.5] {
        let size = seen(&optics, moved(inward(normal), inward(normal))).size_px2;
        let growth = 0.5 * libm::log(size / rest);
        let exact = libm::log(libm::atan(1.0 / (18.0 - normal)) / libm::atan(1.0_f64 / 18.0));
        assert_relative_eq!(growth, exact, epsilon = 1e-6);
        // The logarithm of a small disc's diameter increases by −ln(1 − u/ρ). Here u is the displacement inward, and ρ
        // is the distance of the disc from the camera.
        assert_relative_eq!(growth, -libm::log(1.0 - normal / 18.0), max_relative = 3e-3);
    }
}

#[test]
fn markers_move_along_the_carried_axes() {
    // The axes x and y of a marker are transported along the skin from the apex. For a marker at the azimuth 90°, y
    // points away from the apex, and x points around the apex. Arc lengths are measured on the sphere of the discs.
    let optics = optics(&[at(30.0, 90.0)], depths(2.0, 2.0), Lens::Fisheye, PURE);
    let focal = optics.camera().px_per_rad();
    let rest = seen(&optics, Some(MarkerMotion::default())).centroid_px;
    // The y axis points up, but rows are counted downward. So a larger y gives a smaller row.
    assert!(rest[1] < 319.5 - 0.5 * focal * 30.0_f64.to_radians());
    let outward = seen(&optics, moved(along([0.0, 1.0]), along([0.0, 1.0]))).centroid_px;
    assert_relative_eq!(outward[0], rest[0], epsilon = 1e-9);
    assert_relative_eq!(rest[1] - outward[1], focal / 18.0, max_relative = 1e-3);
    let around = seen(&optics, moved(along([0.1, 0.0]), along([0.1, 0.0]))).centroid_px;
    let stretch = 30.0_f64.to_radians() / 0.5;
    assert_relative_eq!(
        around[0] - rest[0],
        stretch * focal * 0.1 / 18.0,
        max_relative = 1e-3
    );
}

#[test]
fn a_camera_shows_only_directions_in_its_field() {
    let camera = Camera::new(Lens::Fisheye, 101, 70.0).unwrap();
    assert_eq!((camera.size_px(), camera.centre_px()), (101, [50.0, 50.0]));
    let turn = 50.5 / 70.0_f64.to_radians();
    assert_relative_eq!(camera.px_per_rad(), turn, max_relative = 1e-15);
    // The x axis points to the right, and the y axis points up. The length of a direction vector does not matter.
    let place = camera.image(&Vector3::new(0.1, 0.2, 1.0)).unwrap();
    assert!(place[0] > 50.0 && place[1] < 50.0);
    let same = camera.image(&Vector3::new(0.7, 1.4, 7.0)).unwrap();
    assert_relative_eq!(place[..], same[..], epsilon = 1e-9);
    for direction in [
        Vector3::zeros(),
        -Vector3::z(),
        Vector3::x(),
        Vector3::new(f64::NAN, 0.0, 1.0),
        Vector3::new(f64::INFINITY, 0.0, 1.0),
    ] {
        assert_eq!(camera.image(&direction), None);
    }
    for (radius, polar) in [
        (0.0, 0.1),
        (0.1, 1.2),
        (f64::NAN, 0.1),
        (0.1, f64::NAN),
        (0.1, -1.0),
    ] {
        assert_eq!(camera.disc_area(radius, polar), None, "{radius} {polar}");
    }
}

#[test]
fn misaligned_discs_lie_uniformly_within_a_disc() {
    let layout = Layout::Lattice {
        pitch: 0.5,
        cap_deg: 50.0,
    };
    let places = layout.places(20.0).unwrap();
    let small = discs(0.1, 0.2);
    let array = MarkerArray::new(20.0, &places, small, depths(1.0, 1.0)).unwrap();
    let misaligned = |seed, trial| array.clone().misaligned(0.5, seed, trial).unwrap();
    let shifts: Vec<[f64; 2]> = (misaligned(1, 0).misalignments().iter())
        .map(|shift| shift.map(|along| 19.0 * along))
        .collect();
    let count = shifts.len() as f64;
    assert!(count > 3000.0);
    // The shifts between the two discs of a marker are uniformly distributed in a circle whose radius is half of the
    // disc diameter of 0.2. Therefore all shifts are at most 0.1, and a quarter of them is below 0.05.
    let within = |radius: f64| {
        shifts
            .iter()
            .filter(|[x, y]| libm::hypot(*x, *y) < radius)
            .count() as f64
    };
    assert_eq!(within(0.1001), count);
    assert_relative_eq!(
        within(0.05) / count,
        0.25,
        epsilon = 4.0 * (0.1875 / count).sqrt()
    );
    for axis in 0..2 {
        let mean = shifts.iter().map(|shift| shift[axis]).sum::<f64>() / count;
        assert!(mean.abs() < 4.0 * 0.05 / count.sqrt(), "{mean}");
    }
    assert_eq!(misaligned(1, 0), misaligned(1, 0));
    assert_ne!(misaligned(1, 0), misaligned(2, 0));
    assert_ne!(misaligned(1, 0), misaligned(1, 1));
    assert_eq!(array.clone().misaligned(0.0, 1, 0).unwrap(), array);
}

#[test]
fn only_what_is_all_in_the_picture_is_seen() {
    let places = [[0.0, 0.0], at(65.0, 10.0), at(68.0, 100.0), at(80.0, 200.0)];
    let optics = optics(&places, depths(3.0, 1.0), Lens::Fisheye, Colours::default());
    let mut motions = [Some(MarkerMotion::default()); 4];
    let visible = |motions: &[Option<MarkerMotion>]| -> Vec<bool> {
        let seen = optics.project(motions).unwrap();
        seen.iter().map(Option::is_some).collect()
    };
    // A disc is visible only if all of it is in the field of 70°. The angular radius of the discs is 3.4°, so the
    // markers at 68° and 80° are not visible.
    assert_eq!(visible(&motions), [true, true, false, false]);
    motions[0] = None;
    assert_eq!(visible(&motions), [false, true, false, false]);
    let clear = Colours {
        magenta: [1.0; 3],
        yellow: [1.0; 3],
        ..PURE
    };
    let nothing = Optics::new(
        optics.array().clone(),
        *optics.camera(),
        clear,
        Blemishes::default(),
    );
    assert!(
        nothing
            .unwrap()
            .project(&motions)
            .unwrap()
            .iter()
            .all(Option::is_none)
    );
}

#[test]
fn discs_that_the_skin_widens_are_seen_as_wider_discs() {
    let made = optics(&[at(30.0, 90.0)], depths(3.0, 1.0), Lens::Fisheye, PURE);
    let [of_magenta, of_yellow] = [0.1, -0.05].map(|stretch| DiscMotion {
        stretch,
        ..inward(0.3)
    });
    let strained = seen(&made, moved(of_magenta, of_yellow));
    let wider = made.departed(&Departure {
        diameters: [0.1, -0.05],
        ..Departure::default()
    });
    let wider = seen(&wider.unwrap(), moved(inward(0.3), inward(0.3)));
    assert_relative_eq!(strained.size_px2, wider.size_px2, max_relative = 1e-13);
    assert_relative_eq!(strained.hue_turns, wider.hue_turns, epsilon = 1e-13);
    // In the image of a camera that is not in the sensor's centre, strained discs must also look larger.
    let beside = |optics: Optics| {
        optics
            .seen_from(Pose::new([1.0, 0.0, 2.0], [0.0; 3]))
            .unwrap()
    };
    let beside_size = seen(&beside(made.clone()), moved(of_magenta, of_yellow)).size_px2;
    let rest = seen(&beside(made.clone()), moved(inward(0.3), inward(0.3))).size_px2;
    assert!(beside_size > 1.05 * rest);
    for stretch in [1.0, -1.0, f64::NAN, f64::INFINITY] {
        let torn = DiscMotion {
            stretch,
            ..DiscMotion::default()
        };
        let refused = made.project(&[moved(torn, torn)]);
        assert!(
            matches!(refused, Err(OpticsError::ImpossibleMotion { .. })),
            "{stretch}"
        );
    }
}
