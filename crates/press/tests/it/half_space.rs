//! Compares displacements of the half-space with an independent quadrature, and with values that were computed from a
//! formula with 60 digits.

use palpate_press::{Body, Markers, Skin, skin_widening};

/// Columns: effective radius, indentation, Poisson's ratio, radial position, depth, normal and radial displacement.
const GOLDEN: [[f64; 7]; 45] = [
    [20.0, 1.0, 0.5, 0.0, 0.5, 0.9886803868, 0.0],
    [20.0, 1.0, 0.5, 1.0, 0.5, 0.9637417431, 0.02138160348],
    [20.0, 1.0, 0.5, 2.5, 0.5, 0.8329781343, 0.05193917997],
    [20.0, 1.0, 0.5, 5.0, 0.5, 0.4288966744, 0.05128315598],
    [20.0, 1.0, 0.5, 10.0, 0.5, 0.1941558848, 0.01008033724],
    [20.0, 1.0, 0.5, 0.0, 2.0, 0.8705286391, 0.0],
    [20.0, 1.0, 0.5, 1.0, 2.0, 0.8483736409, 0.04866434035],
    [20.0, 1.0, 0.5, 2.5, 2.0, 0.7363089854, 0.1094591039],
    [20.0, 1.0, 0.5, 5.0, 2.0, 0.4422775994, 0.1182833428],
    [20.0, 1.0, 0.5, 10.0, 2.0, 0.1979517689, 0.03756562539],
    [20.0, 1.0, 0.5, 0.0, 4.0, 0.6764982239, 0.0],
    [20.0, 1.0, 0.5, 1.0, 4.0, 0.6623967363, 0.04284799912],
    [20.0, 1.0, 0.5, 2.5, 4.0, 0.5937909819, 0.09476920353],
    [20.0, 1.0, 0.5, 5.0, 4.0, 0.4190061762, 0.1190364081],
    [20.0, 1.0, 0.5, 10.0, 4.0, 0.2054423416, 0.06155068143],
    [16.0, 0.3, 0.5, 0.0, 0.5, 0.2873408058, 0.0],
    [16.0, 0.3, 0.5, 1.0, 0.5, 0.2568163112, 0.02153818769],
    [16.0, 0.3, 0.5, 2.5, 0.5, 0.1275723946, 0.02517644967],
    [16.0, 0.3, 0.5, 5.0, 0.5, 0.05726115142, 0.005825179392],
    [16.0, 0.3, 0.5, 10.0, 0.5, 0.02806751316, 0.001409770211],
    [16.0, 0.3, 0.5, 0.0, 2.0, 0.2007943684, 0.0],
    [16.0, 0.3, 0.5, 1.0, 2.0, 0.1842076098, 0.02409381825],
    [16.0, 0.3, 0.5, 2.5, 2.0, 0.1231867369, 0.03532802194],
    [16.0, 0.3, 0.5, 5.0, 2.0, 0.06032738754, 0.01808557575],
    [16.0, 0.3, 0.5, 10.0, 2.0, 0.02856095176, 0.005320022878],
    [16.0, 0.3, 0.5, 0.0, 4.0, 0.1253870059, 0.0],
    [16.0, 0.3, 0.5, 1.0, 4.0, 0.1201399827, 0.01197905377],
    [16.0, 0.3, 0.5, 2.5, 4.0, 0.09831412456, 0.02248465726],
    [16.0, 0.3, 0.5, 5.0, 4.0, 0.06104501175, 0.02048406185],
    [16.0, 0.3, 0.5, 10.0, 4.0, 0.02963974627, 0.00896410413],
    [26.6667, 1.4, 0.3, 0.0, 0.5, 1.354676622, 0.0],
    [26.6667, 1.4, 0.3, 1.0, 0.5, 1.336498735, -0.0243363514],
    [26.6667, 1.4, 0.3, 2.5, 0.5, 1.241212849, -0.05738781501],
    [26.6667, 1.4, 0.3, 5.0, 0.5, 0.904503458, -0.08846166819],
    [26.6667, 1.4, 0.3, 10.0, 0.5, 0.3788752651, -0.08311107562],
    [26.6667, 1.4, 0.3, 0.0, 2.0, 1.191751094, 0.0],
    [26.6667, 1.4, 0.3, 1.0, 2.0, 1.175779978, 0.008141237394],
    [26.6667, 1.4, 0.3, 2.5, 2.0, 1.092936315, 0.02018019366],
    [26.6667, 1.4, 0.3, 5.0, 2.0, 0.8197681224, 0.03050890847],
    [26.6667, 1.4, 0.3, 10.0, 2.0, 0.3821629068, -0.0271761527],
    [26.6667, 1.4, 0.3, 0.0, 4.0, 0.9711908293, 0.0],
    [26.6667, 1.4, 0.3, 1.0, 4.0, 0.9594165914, 0.02143953068],
    [26.6667, 1.4, 0.3, 2.5, 4.0, 0.8995475419, 0.04988105012],
    [26.6667, 1.4, 0.3, 5.0, 4.0, 0.7161295424, 0.07201156437],
    [26.6667, 1.4, 0.3, 10.0, 4.0, 0.3849483797, 0.022810288],
];

#[test]
fn golden_displacements() {
    for [radius, indentation, poisson, r, depth, normal, radial] in GOLDEN {
        let body = Body::half_space(poisson, depth).unwrap();
        let moved = body
            .press(1.0 / radius, indentation)
            .unwrap()
            .displacement(r);
        let error = (moved.normal - normal)
            .abs()
            .max((moved.radial - radial).abs());
        assert!(
            error <= 1e-8,
            "at r = {r}, z = {depth}, ν = {poisson}: off by {error:e}"
        );
    }
}

/// Columns: Poisson's ratio, depth, radial position, normal and radial displacement under a contact of radius 1, per
/// unit of relative curvature. The values were computed from Huber's formulas (1904), by mpmath with 60 digits.
const EDGES: [[f64; 5]; 11] = [
    [0.3, 0.0, 0.0, 1.0, 0.0],
    [0.3, 0.0, 0.5, 0.875, -0.08499927649571],
    [0.3, 0.0, 1.0, 0.5, -0.1212609090224],
    [0.3, 0.0, 1.000000000001, 0.499999999999, -0.1212609090223],
    [0.0, 1e-12, 0.999999999999, 0.500000000001, -0.2122065907884],
    [0.5, 1e-6, 1.0, 0.5000000004234, 9.987267609858e-7],
    [0.5, 1.0, 0.001, 0.6366195223676, 0.0001816900342387],
    [0.3, 11.9, 11.9, 0.03422599178282, 0.006011677096362],
    [0.3, 1e6, 0.5, 7.275654541339e-7, 1.212609090222e-13],
    [0.5, 1e12, 1e6, 8.488263631559e-13, 4.244131815778e-19],
    [0.0, 0.0, 1e6, 4.244131815784e-7, -2.122065907892e-7],
];

#[test]
fn displacements_are_accurate_at_edges_depths_and_distances_of_any_size() {
    for [poisson, depth, r, normal, radial] in EDGES {
        for size in [1e-30, 1.0, 1e30] {
            let body = Body::half_space(poisson, depth * size).unwrap();
            let contact = body.press(1.0 / size, size).unwrap();
            let moved = contact.displacement(r * size);
            let off = libm::hypot(moved.normal / size - normal, moved.radial / size - radial);
            let bound = 1e-11 * libm::hypot(normal, radial);
            assert!(off <= bound, "z = {depth:e}, r = {r:e}: off by {off:e}");
        }
    }
}

#[test]
fn contacts_of_any_curvature_have_the_radius_and_force_of_hertz() {
    let body = Body::half_space(0.5, 0.0).unwrap();
    for (curvature, indentation) in [(1e-40, 1e-40), (1e40, 1e-40), (f64::MIN_POSITIVE, 1e-250)] {
        let contact = body.press(curvature, indentation).unwrap();
        let radius = indentation.sqrt() / curvature.sqrt();
        assert!((contact.radius / radius - 1.0).abs() < 1e-15);
        let force = 16.0 / 9.0 * curvature * radius * radius * radius;
        assert!((contact.force(1.0).unwrap() / force - 1.0).abs() < 3e-15);
    }
}

#[test]
fn an_incompressible_skin_widens_as_it_is_squeezed() {
    let places = [0.05, 1.0, 2.0, 3.5, 6.0];
    let skin = Skin::new(20.0).unwrap();
    let displaced = |depth: f64, places: [f64; 5]| {
        let body = Body::half_space(0.5, depth).unwrap();
        let contact = skin.contact(&body, 0.0, 1.0).unwrap();
        let markers = Markers::new(skin, &places.map(|x| [x, 0.0])).unwrap();
        markers.displacements(&contact, [0.0; 2])
    };
    for depth in [1.0, 3.0] {
        let [above, below] = [-0.05, 0.05].map(|deeper| displaced(depth + deeper, places));
        let widening = skin_widening(&above, &below, 0.1);
        // Half of the area strain, (r u_r)′ / (2r), by a finite difference. Here r is the distance from the contact's
        // centre, and u_r the radial displacement.
        let [far, near] = [1e-3, -1e-3].map(|more| {
            let places = places.map(|x| x + more);
            let moved = displaced(depth, places).into_iter().zip(places);
            moved
                .map(|(moved, x)| x * moved.tangential[0])
                .collect::<Vec<_>>()
        });
        for (place, x) in places.into_iter().enumerate() {
            let expected = (far[place] - near[place]) / (4.0 * 1e-3 * x);
            let difference = (widening[place] - expected).abs();
            assert!(difference < 1e-3, "{depth}, {x}: {difference}");
        }
        assert!(widening[0] > 0.02, "{widening:?}");
    }
}
