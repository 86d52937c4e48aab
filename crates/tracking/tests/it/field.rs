//! Tests displacement fields: interpolation between markers that are difficult to triangulate, and smoothing filters.

use std::f64::consts::TAU;

use approx::assert_relative_eq;
use palpate_tracking::{Displaced, Field, FieldError};

fn field(places: impl IntoIterator<Item = [f64; 2]>) -> Field {
    let markers = places.into_iter().enumerate().map(|(index, place)| {
        let phase = index as f64;
        Displaced {
            place,
            tangential: [libm::cos(phase), libm::cos(2.0 * phase)],
            normal: libm::sin(phase),
        }
    });
    Field::new(&markers.collect::<Vec<_>>()).unwrap()
}

/// Positions at several distances from the point (x, y). The distances range from less than the rounding error of the
/// coordinates to clearly more.
fn around([x, y]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    let steps = [0.0, 1e-17, 1e-13, 1e-9, 1e-4];
    steps.into_iter().flat_map(move |step| {
        (0..8).map(move |eighth| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(eighth) / 8.0);
            [x + step * cosine, y + step * sine]
        })
    })
}

/// Checks points at, between and near the markers. An interpolated displacement is a weighted mean of the markers'
/// displacements, so it must lie between the smallest and the largest of them.
fn assert_means(field: &Field) {
    let markers = field.markers();
    for one in markers {
        for other in markers {
            for share in [0.0, 0.5, 1.0] {
                let between =
                    [0, 1].map(|axis| one.place[axis] * (1.0 - share) + other.place[axis] * share);
                for place in around(between) {
                    let Some(found) = field.at(place) else {
                        continue;
                    };
                    let parts = [found.normal, found.tangential[0], found.tangential[1]];
                    assert!(
                        parts.iter().all(|part| part.abs() < 1.0 + 1e-4),
                        "{place:?} {found:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn rings_and_nets() {
    let ring = |count: u32, radius: f64| {
        (0..count).map(move |index| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(index) / f64::from(count));
            [radius * cosine, radius * sine]
        })
    };
    // The triangulation of markers on a circle is not unique: it depends on rounding errors. For every triangulation,
    // interpolated displacements must be means of the markers' displacements.
    assert_means(&field(ring(12, 0.3).chain([[0.0, 0.0]])));
    assert_means(&field(ring(7, 0.2).chain(ring(14, 0.4))));
    let net = |step: f64| (0..16).map(move |k| [f64::from(k % 4) * step, f64::from(k / 4) * step]);
    assert_means(&field(net(0.1)));
    assert_means(&field(net(1e-9)));
}

#[test]
fn slivers() {
    for thin in [1e-3, 1e-9, 1e-15, 1e-29, 0.0] {
        let arc = (0..8).map(|k| f64::from(k) * 0.1 - 0.35);
        assert_means(&field(arc.clone().map(|x| [x, thin * x * x])));
        assert_means(&field(arc.map(|x| [x, thin * libm::sin(10.0 * x)])));
    }
}

/// Tests that natural-neighbour interpolation is exact for linear fields.
#[test]
fn linear_fields_of_any_size() {
    let value = |[x, y]: [f64; 2]| 1.0 + 2.0 * x - 0.5 * y;
    for size in [1e-25, 1e-9, 1.0] {
        let places = (0..25).map(|at| [at % 5, at / 5].map(|step| 0.5 * f64::from(step) - 1.0));
        let markers: Vec<Displaced> = places
            .map(|place| Displaced {
                place: place.map(|along| along * size),
                tangential: [0.0; 2],
                normal: value(place),
            })
            .collect();
        let field = Field::new(&markers).unwrap();
        for place in [[0.1, 0.2], [-0.77, 0.3], [0.999, -0.999], [0.5, 0.5]] {
            let found = field.at(place.map(|along| along * size)).unwrap().normal;
            assert!((found - value(place)).abs() < 1e-9, "{size:e}: {found}");
        }
        let grid = field.grid(9);
        assert_eq!(grid.len(), 81);
        for one in grid {
            let expected = value(one.place.map(|along| along / size));
            assert!((one.normal - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn impossible_fields_have_named_errors() {
    let at = |x: f64, normal: f64| Displaced {
        place: [x, 0.0],
        tangential: [0.0; 2],
        normal,
    };
    for (markers, expected) in [
        (vec![], FieldError::NoMarkers),
        (vec![at(0.1, 1.0); 2], FieldError::Coincident { marker: 1 }),
        (
            vec![at(1e-40, 1.0), at(0.0, 1.0)],
            FieldError::Coincident { marker: 1 },
        ),
        (vec![at(3.2, 1.0)], FieldError::OutOfRange { marker: 0 }),
        (
            vec![at(0.0, f64::NAN)],
            FieldError::OutOfRange { marker: 0 },
        ),
    ] {
        assert_eq!(Field::new(&markers).unwrap_err(), expected, "{markers:?}");
    }
    let one = Field::new(&[at(0.0, 1.0)]).unwrap();
    let error = FieldError::BadFilter { value: -1.0 };
    assert_eq!(one.smoothed(-1.0).unwrap_err(), error);
}

fn still() -> Vec<Displaced> {
    let place = |index: i32| [index % 5, index / 5].map(|step| f64::from(step) * 0.1 - 0.2);
    (0..25)
        .map(|index| Displaced {
            place: place(index),
            tangential: [0.1, -0.2],
            normal: 0.3,
        })
        .collect()
}

#[test]
fn a_filter_takes_noise_and_leaves_a_constant() {
    let still = still();
    let smooth = Field::new(&still).and_then(|field| field.smoothed(0.1));
    for marker in smooth.expect("sound markers").markers() {
        assert_relative_eq!(marker.normal, 0.3, epsilon = 1e-15);
        assert_relative_eq!(marker.tangential[1], -0.2, epsilon = 1e-15);
    }
    // Only the marker in the middle is displaced, and the filter spreads its displacement. The weights are 1 for the
    // marker itself, e^-1/2 for the four nearest neighbours, e^-1 for the next four, and so on.
    let mut spike = still;
    spike.iter_mut().for_each(|marker| marker.normal = 0.0);
    spike[12].normal = 1.0;
    let field = Field::new(&spike).expect("sound markers");
    let smooth = field.smoothed(0.1).expect("a width");
    let row: f64 = (-2..=2).map(|k| libm::exp(-0.5 * f64::from(k * k))).sum();
    assert_relative_eq!(
        smooth.markers()[12].normal,
        1.0 / (row * row),
        max_relative = 0.02
    );
    assert_eq!(
        field.smoothed(0.0).expect("none").markers(),
        field.markers()
    );
    assert!(field.smoothed(f64::NAN).is_err());
}

#[test]
fn outward_is_away_from_the_contact() {
    let [east, north] = [[0.1, 0.0], [0.0, 0.1]];
    let marker = |place, tangential, normal| Displaced {
        place,
        tangential,
        normal,
    };
    let field = Field::new(&[
        marker(east, [0.2, 5.0], 0.5),
        marker([0.0, 0.0], [9.0, 9.0], 1.0),
        marker(north, [0.0, -0.1], 0.25),
        marker([0.3, 0.0], [1.0, 0.0], -0.1),
    ]);
    let mean = field.expect("sound markers").outward();
    let mean = mean.expect("others were displaced");
    assert_relative_eq!(mean, (0.5 * 0.2 - 0.25 * 0.1) / 0.75, max_relative = 1e-12);
}

/// Tests fields of few markers, of markers on a line, and of markers that are almost at the same place. The convex hull
/// of such markers has a small area.
#[test]
fn thin_fields() {
    let of = |x: f64, y: f64| Displaced {
        place: [x, y],
        tangential: [x, 1e100],
        normal: 1e100,
    };
    for markers in [
        vec![of(0.1, 0.0)],
        vec![of(0.1, 0.0), of(0.2, 0.0)],
        vec![of(0.1, 0.1), of(0.2, 0.2), of(0.4, 0.4)],
        vec![
            of(0.0, 0.0),
            of(1e-320, 1.0),
            of(1.0, 1e-9),
            of(1.0, 1.000_000_001e-9),
        ],
    ] {
        let field = Field::new(&markers).expect("sound markers");
        let smooth = field.smoothed(1e-300).expect("a width");
        for count in [0, 1, 2, 7] {
            assert!(smooth.grid(count).len() <= count * count);
        }
        assert!(field.outward().is_none_or(f64::is_finite));
        assert!(field.at(markers[0].place).is_some());
    }
}
