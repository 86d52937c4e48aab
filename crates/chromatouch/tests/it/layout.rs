//! Tests layouts of markers: the layout of the 2020 paper, lattices, lines and radii.

use std::f64::consts::{PI, TAU};

use approx::assert_relative_eq;
use palpate_chromatouch::Layout;

#[test]
fn the_published_sensor_has_77_markers_in_rows() {
    let places = Layout::published().places(20.0).unwrap();
    assert_eq!((places.len(), places[0]), (77, [0.0, 0.0]));
    // On a sphere of radius 20 mm, 11.9° correspond to 4.15 mm along the skin.
    let distances: Vec<f64> = places.iter().map(|[x, y]| libm::hypot(*x, *y)).collect();
    for (row, markers) in [(1, 1..5), (2, 5..17), (3, 17..29), (4, 29..49), (5, 49..77)] {
        for marker in markers {
            assert_relative_eq!(
                distances[marker],
                4.153_883 * f64::from(row),
                max_relative = 1e-6
            );
        }
    }
    // The first row of each gore (piece of the skin) has one marker, in the middle of the gore. The last row has seven
    // markers, which are 90/7 degrees apart.
    let azimuth = |marker: usize| libm::atan2(places[marker][1], places[marker][0]).to_degrees();
    assert_relative_eq!(azimuth(1), 45.0, max_relative = 1e-12);
    assert_relative_eq!(azimuth(2), 135.0, max_relative = 1e-12);
    assert_relative_eq!(azimuth(49), 45.0 / 7.0, max_relative = 1e-12);
    assert_relative_eq!(azimuth(50) - azimuth(49), 90.0 / 7.0, max_relative = 1e-12);
}

#[test]
fn a_lattice_is_as_dense_as_asked_everywhere() {
    let (radius, pitch) = (20.0, 1.0);
    let layout = |cap_deg| Layout::Lattice { pitch, cap_deg };
    let places = layout(60.0).places(radius).unwrap();
    // There is one marker per area of pitch². A cap with its rim at the polar angle θ has the area 2πR²(1 − cos θ),
    // with the sphere's radius R.
    for cap_deg in [15.0_f64, 30.0, 45.0, 60.0] {
        let angle = cap_deg.to_radians();
        let within = places
            .iter()
            .filter(|[x, y]| libm::hypot(*x, *y) <= radius * angle)
            .count();
        let expected = TAU * radius * radius * (1.0 - libm::cos(angle)) / (pitch * pitch);
        assert!(
            (within as f64 - expected).abs() < 2.0,
            "{cap_deg}: {within}, {expected}"
        );
    }
    // The distance between neighbouring markers is never below 0.7 times the pitch.
    let nearest = places.iter().enumerate().map(|(one, [x, y])| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != one);
        others
            .map(|(_, [u, v])| libm::hypot(x - u, y - v))
            .fold(f64::INFINITY, f64::min)
    });
    assert!(nearest.fold(f64::INFINITY, f64::min) > 0.7 * pitch);
    // A cap with a rim at 180° is the whole sphere.
    let all = layout(180.0).places(radius).unwrap();
    assert_relative_eq!(
        all.len() as f64,
        4.0 * PI * radius * radius,
        max_relative = 1e-3
    );
}

#[test]
fn lines_and_radii_have_equal_steps() {
    let line = Layout::Line {
        markers: 5,
        length: 20.0,
    };
    assert_eq!(
        line.places(20.0).unwrap(),
        [-10.0, -5.0, 0.0, 5.0, 10.0].map(|x| [x, 0.0])
    );
    let radius = Layout::Radius {
        markers: 4,
        length: 9.0,
    };
    assert_eq!(
        radius.places(20.0).unwrap(),
        [0.0, 3.0, 6.0, 9.0].map(|x| [x, 0.0])
    );
}

#[test]
fn impossible_layouts_are_named() {
    let gores = |gores, rows: &[u32], row_spacing_deg| Layout::Gores {
        gores,
        rows: rows.to_vec(),
        row_spacing_deg,
    };
    let lattice = |pitch, cap_deg| Layout::Lattice { pitch, cap_deg };
    let line = |markers, length| Layout::Line { markers, length };
    let radius = |markers, length| Layout::Radius { markers, length };
    let (around, spacing) = ("around-the-sphere", Some("row_spacing_deg"));
    for (layout, name, setting) in [
        (gores(0, &[1], 10.0), "bad-setting", Some("gores")),
        (gores(4, &[1], 0.0), "bad-setting", Some("row_spacing_deg")),
        (gores(4, &[1, 1], 90.0), around, spacing),
        (gores(u32::MAX, &[u32::MAX], 1.0), "too-many-markers", None),
        (lattice(0.0, 60.0), "bad-setting", Some("pitch")),
        (lattice(1e3, 60.0), "bad-setting", Some("pitch")),
        (lattice(1e-9, 60.0), "too-many-markers", None),
        (lattice(1.0, 0.0), "bad-setting", Some("cap_deg")),
        (lattice(1.0, 181.0), "bad-setting", Some("cap_deg")),
        (lattice(1.0, 0.1), "no-marker", Some("pitch")),
        (line(1, 1.0), "bad-setting", Some("markers")),
        (line(100_001, 1.0), "too-many-markers", None),
        (line(5, -1.0), "bad-setting", Some("length")),
        (line(5, 126.0), "around-the-sphere", Some("length")),
        (radius(5, 63.0), "around-the-sphere", Some("length")),
    ] {
        let error = layout.places(20.0).unwrap_err();
        assert_eq!(
            (<&str>::from(&error), error.setting()),
            (name, setting),
            "{error}"
        );
    }
    for sensor_radius in [0.0, -1.0, f64::NAN] {
        let error = Layout::published().places(sensor_radius).unwrap_err();
        assert_eq!(error.setting(), Some("radius"));
    }
}

#[test]
fn small_and_large_sensors_have_the_same_markers() {
    for layout in [
        Layout::published(),
        Layout::Lattice {
            pitch: 0.1,
            cap_deg: 70.0,
        },
    ] {
        let scaled = |scale: f64| match &layout {
            Layout::Lattice { pitch, cap_deg } => Layout::Lattice {
                pitch: pitch * scale,
                cap_deg: *cap_deg,
            },
            other => other.clone(),
        };
        let unit = layout.places(1.0).unwrap();
        for scale in [1e-9, 1e9] {
            let places = scaled(scale).places(scale).unwrap();
            assert_eq!(places.len(), unit.len());
            for (place, unit) in places.iter().zip(&unit) {
                for axis in 0..2 {
                    assert!((place[axis] / scale - unit[axis]).abs() < 1e-12);
                }
            }
        }
    }
}
