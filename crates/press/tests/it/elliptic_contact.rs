//! Compares elliptic contacts with golden values and with the formula of a round contact.

use palpate_press::{Body, EllipticContact};

/// Columns: half of the relative curvatures along x and along y, indentation, Poisson's ratio, semi-axes, peak pressure
/// divided by E*, depth, x, y, and displacements inward, along x and along y. The values were computed by quadrature of
/// Boussinesq's point forces.
const GOLDEN: &str = include_str!("elliptic-half-space.csv");

#[test]
fn golden_contacts() {
    let rows = GOLDEN.lines().skip(1).map(|row| {
        let numbers = row.split(',').map(|number| number.parse().unwrap());
        <[f64; 13]>::try_from(numbers.collect::<Vec<f64>>()).unwrap()
    });
    assert_eq!(rows.clone().count(), 35);
    for row in rows {
        let [gap_x, gap_y, indentation, poisson, .., z, x, y, _, _, _] = row;
        let contact =
            EllipticContact::new(poisson, [2.0 * gap_x, 2.0 * gap_y], indentation).unwrap();
        let moved = contact.displacement(x, y, z);
        let [long, short] = contact.semi_axes;
        let found = [
            long,
            short,
            contact.peak_pressure,
            moved.normal,
            moved.tangential[0],
            moved.tangential[1],
        ];
        let golden = [row[4], row[5], row[6], row[10], row[11], row[12]];
        for (found, golden) in found.into_iter().zip(golden) {
            let error = (found - golden).abs();
            assert!(
                error <= 1e-9,
                "at ({x}, {y}, {z}): {found} for {golden}, off by {error:e}"
            );
        }
    }
}

#[test]
fn the_round_limit_is_the_closed_form() {
    for poisson in [0.0, 0.3, 0.5] {
        for (curvature, indentation) in [(0.1, 1.0), (1e-6, 1e-3), (20.0, 0.01)] {
            let contact = EllipticContact::new(poisson, [curvature; 2], indentation).unwrap();
            let a = contact.semi_axes[0];
            for (z, r) in [
                (0.0, 0.3),
                (0.0, 1.7),
                (0.4, 0.0),
                (0.4, 1.0),
                (2.0, 0.5),
                (1e-3, 1.0),
                (1e-9, 1.3),
                (5.0, 40.0),
            ] {
                let body = Body::half_space(poisson, z * a).unwrap();
                let round = body
                    .press(curvature, indentation)
                    .unwrap()
                    .displacement(r * a);
                let (sine, cosine) = libm::sincos(0.7);
                let moved = contact.displacement(r * a * cosine, r * a * sine, z * a);
                let radial = moved.tangential[0] * cosine + moved.tangential[1] * sine;
                let error = (moved.normal - round.normal)
                    .abs()
                    .max((radial - round.radial).abs());
                assert!(
                    error <= 1e-10 * indentation,
                    "ν {poisson}, C {curvature}, z {z}, r {r}: off by {error:e} of {round:?}"
                );
            }
        }
    }
}

#[test]
fn the_skin_follows_the_object_within_the_contact() {
    for ratio in [1.0, 3.0, 100.0, 1e5] {
        let contact = EllipticContact::new(0.3, [0.1, 0.1 * ratio], 1.0).unwrap();
        let [a, b] = contact.semi_axes;
        for (u, v) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.9), (0.6, 0.6)] {
            let moved = contact.displacement(u * a, v * b, 0.0).normal;
            let gap = 1.0 - 0.05 * (u * a) * (u * a) - 0.05 * ratio * (v * b) * (v * b);
            assert!(
                (moved - gap).abs() <= 1e-11,
                "ratio {ratio}: {moved} for {gap}"
            );
        }
    }
}
