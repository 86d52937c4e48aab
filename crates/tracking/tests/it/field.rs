//! Interpolation between markers that are difficult to triangulate.

use std::f64::consts::TAU;

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

/// Positions around the point (x, y). Their distances from it range from less than the rounding error to clearly larger
/// values.
fn around([x, y]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    let steps = [0.0, 1e-17, 1e-13, 1e-9, 1e-4];
    steps.into_iter().flat_map(move |step| {
        (0..8).map(move |eighth| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(eighth) / 8.0);
            [x + step * cosine, y + step * sine]
        })
    })
}

/// Checks that interpolated displacements do not exceed the displacements of the markers, because interpolated
/// displacements are means of the markers' displacements. The tested points are at, between and near the markers.
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
    // The triangulation of markers on a circle is not unique: rounding decides which markers form triangles. The field
    // must nevertheless consist of means of the displacements.
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

/// Natural-neighbour interpolation is exact for linear fields.
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
