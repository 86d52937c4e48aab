//! Tests that impossible marker arrays, colours and motions return errors with the expected names.

use palpate_chromatouch::{
    Blemishes, Colours, DiscMotion, Discs, Layout, Lens, MarkerArray, MarkerMotion, Optics,
    OpticsError,
};

use crate::optics::{DISCS, PURE, along, at, depths, discs, inward, moved, optics};

#[test]
fn impossible_arrays_are_named() {
    let array = |radius, places: &[[f64; 2]], magenta, yellow, depths| {
        MarkerArray::new(radius, places, Discs { magenta, yellow }, depths)
            .map_err(|error| (<&str>::from(&error), error.setting()))
            .unwrap_err()
    };
    let one = [[0.0, 0.0]];
    let good = depths(3.0, 1.0);
    let nan = f64::NAN;
    let bad = |setting| ("bad-setting", Some(setting));
    let deep = ("bad-depth", Some("separation"));
    for (radius, diameters, depths, expected) in [
        (nan, [2.0, 2.0], good, bad("radius")),
        (0.0, [2.0, 2.0], good, bad("radius")),
        (20.0, [0.0, 2.0], good, bad("magenta_diameter")),
        (20.0, [40.0, 2.0], good, bad("magenta_diameter")),
        (20.0, [2.0, nan], good, bad("yellow_diameter")),
        (20.0, [2.0, 1e-300], good, bad("yellow_diameter")),
        (20.0, [2.0, 2.0], depths(20.0, 1.0), deep),
        (20.0, [2.0, 2.0], depths(1.0, 20.0), deep),
        (20.0, [2.0, 2.0], depths(1.0, -0.1), deep),
        (20.0, [2.0, 2.0], depths(nan, nan), deep),
    ] {
        let [magenta, yellow] = diameters;
        assert_eq!(array(radius, &one, magenta, yellow, depths), expected);
    }
    for place in [[63.0, 0.0], [nan, 0.0], [f64::INFINITY, 0.0]] {
        let refused = array(20.0, &[place], 2.0, 2.0, good);
        assert_eq!(refused, ("off-the-skin", None));
    }
    let many = vec![[0.0, 0.0]; 100_001];
    let refused = array(20.0, &many, 2.0, 2.0, good);
    assert_eq!(refused, ("too-many-markers", None));

    let misaligned = MarkerArray::new(20.0, &one, DISCS, good).unwrap();
    for most in [-0.1, 1.1, nan] {
        let error = misaligned.clone().misaligned(most, 1, 0).unwrap_err();
        assert_eq!(error.setting(), Some("misalignment"));
    }
}

#[test]
fn discs_that_cover_each_other_are_found_among_many() {
    let layout = Layout::Lattice {
        pitch: 0.2,
        cap_deg: 120.0,
    };
    let mut places = layout.places(20.0).unwrap();
    assert!(places.len() > 90_000);
    let array = |places: &[[f64; 2]], diameter| {
        let discs = discs(0.5 * diameter, diameter);
        MarkerArray::new(20.0, places, discs, depths(1.0, 1.0))
    };
    assert_eq!(array(&places, 0.1).unwrap().places().len(), places.len());
    let [x, y] = places[70_000];
    places.push([x + 0.05, y]);
    let Err(OpticsError::DiscsOverlap {
        first,
        second,
        distance,
        diameter,
    }) = array(&places, 0.1)
    else {
        panic!("not refused");
    };
    assert_eq!((first, second), (70_000, places.len() - 1));
    assert!(
        distance < 0.05 && (diameter - 0.1).abs() < 1e-15,
        "{distance} {diameter}"
    );
    // Both markers are nearly half a turn from the apex, in opposite directions. Their skin coordinates are far apart,
    // but on the sphere the markers are close to each other.
    let opposite = [at(179.9, 0.0), at(179.9, 180.0)];
    assert_eq!(
        <&str>::from(array(&opposite, 0.2).unwrap_err()),
        "discs-overlap"
    );
    assert!(array(&opposite, 0.05).is_ok());
}

#[test]
fn impossible_colours_are_named() {
    let optics = optics(&[[0.0, 0.0]], depths(3.0, 1.0), Lens::Fisheye, PURE);
    let (array, camera) = (optics.array().clone(), *optics.camera());
    let white = Colours {
        white: [1.1, 1.0, 1.0],
        ..PURE
    };
    let error = Optics::new(array, camera, white, Blemishes::default()).unwrap_err();
    assert_eq!(error.setting(), Some("white"));
}

#[test]
fn impossible_motions_are_named() {
    let places = [[0.0, 0.0], at(30.0, 0.0)];
    let optics = optics(&places, depths(3.0, 1.0), Lens::Fisheye, PURE);
    let rest = Some(MarkerMotion::default());
    let wrong = OpticsError::WrongCount {
        motions: 1,
        markers: 2,
    };
    assert_eq!(optics.project(&[rest]).unwrap_err(), wrong);
    assert_eq!(optics.render(&[rest], None).unwrap_err(), wrong);
    for bad in [17.0, -17.0, 1e300, f64::NAN, f64::NEG_INFINITY] {
        for motion in [inward(bad), along([bad, 0.0]), along([0.0, bad])] {
            let motions = [rest, moved(motion, DiscMotion::default())];
            for error in [
                optics.project(&motions).unwrap_err(),
                optics.render(&motions, None).unwrap_err(),
            ] {
                let OpticsError::ImpossibleMotion { marker, disc, .. } = error else {
                    panic!("{error}");
                };
                assert_eq!((marker, disc), (1, "magenta"));
            }
        }
    }
}
