//! Compares the mean hue of projected markers with golden values.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscMotion, Discs, Lens, MarkerArray, MarkerMotion, Optics,
};

use crate::optics::{PURE, along, depths, discs, inward, moved, optics};

/// Columns: diameters of the yellow and the magenta disc, distance between their centres, mean hue of the marker,
/// circular mean of the marker's hue, and hue of its summed light. The values were computed from the areas of
/// overlapping circles.
const GOLDEN: &str = include_str!("mean-hue.csv");

#[test]
fn golden_hues() {
    let lines = GOLDEN.lines().filter(|line| !line.starts_with('#'));
    let mut rows = 0;
    for line in lines.skip(1) {
        let numbers = line.split(',').map(|number| number.parse().unwrap());
        let row: [f64; 6] = numbers.collect::<Vec<f64>>().try_into().unwrap();
        let [yellow, magenta, offset, mean, _, of_sum] = row;
        // The sphere is so large that discs near the apex are nearly flat.
        let (depths, discs) = (depths(0.0, 0.0), Discs { magenta, yellow });
        let array = MarkerArray::new(2e4, &[[0.0, 0.0]], discs, depths).unwrap();
        let camera = Camera::new(Lens::Fisheye, 640, 70.0).unwrap();
        let optics = Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap();
        let aside = along([0.6 * offset, 0.8 * offset]);
        let seen = optics.project(&[moved(DiscMotion::default(), aside)]);
        let seen = seen.unwrap()[0].unwrap();
        assert!((seen.mean_hue_turns - mean).abs() < 1e-5, "{line} {seen:?}");
        assert!((seen.hue_turns - of_sum).abs() < 1e-5, "{line} {seen:?}");
        rows += 1;
    }
    assert_eq!(rows, 6);
}

#[test]
fn pale_regions_do_not_count() {
    let pale = Colours {
        yellow: [1.0, 1.0, 0.8],
        ..PURE
    };
    let hue = |colours| {
        let optics = optics(&[[0.0, 0.0]], depths(3.0, 1.0), Lens::Fisheye, colours);
        optics
            .project(&[moved(DiscMotion::default(), along([0.5, 0.0]))])
            .unwrap()[0]
            .unwrap()
    };
    // The mean hue is near the hue 5/6 of magenta, because magenta covers most of the area.
    let seen = hue(pale);
    assert!((0.83..0.92).contains(&seen.mean_hue_turns), "{seen:?}");
    // If no region is saturated, the mean hue is the hue of the summed light.
    let seen = hue(Colours {
        magenta: [1.0, 0.85, 1.0],
        yellow: [1.0, 1.0, 0.9],
        ..PURE
    });
    assert_eq!(seen.mean_hue_turns, seen.hue_turns);
}

/// The misalignment between the two discs of a marker grows with the strain of the skin. The test uses both orders of
/// the discs: magenta deeper, and yellow deeper.
#[test]
fn a_misalignment_strains_with_the_skin() {
    let place = [[0.0, 0.0]];
    let discs = discs(2.0, 2.0);
    let yellow_inside = depths(1.0, 3.0);
    let array = MarkerArray::new(20.0, &place, discs, yellow_inside).unwrap();
    let camera = Camera::new(Lens::Fisheye, 640, 70.0).unwrap();
    let optics = Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap();
    let seen = |misalignment: f64, yellow: DiscMotion| {
        let optics = optics.misaligned(&[[misalignment, 0.0]]).unwrap();
        let motion = MarkerMotion {
            magenta: inward(0.2),
            yellow,
        };
        optics.project(&[Some(motion)]).unwrap()[0].unwrap()
    };
    let strained = DiscMotion {
        skin_stretch: 0.1,
        ..inward(0.3)
    };
    let (grown, longer) = (seen(0.03, strained), seen(0.033, inward(0.3)));
    assert!((grown.mean_hue_turns - longer.mean_hue_turns).abs() < 1e-12);
    assert!(grown.mean_hue_turns > seen(0.03, inward(0.3)).mean_hue_turns + 0.005);
}
