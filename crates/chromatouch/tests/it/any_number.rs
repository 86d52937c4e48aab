//! Whatever the numbers: a finite answer or a named error.

use nalgebra::Vector3;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, DiscMotion, Discs, FoldStrain, Layout, Lens,
    MarkerArray, MarkerMotion, Optics, Pattern, Seams,
};
use proptest::prelude::*;

/// Any double, those of everyday size as often as all the others.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => any::<u64>().prop_map(f64::from_bits),
        3 => 0.0..1.0,
        1 => (-9.0..9.0).prop_map(|power: f64| libm::pow(10f64, power)),
    ]
}

fn lens() -> impl Strategy<Value = Lens> {
    prop_oneof![Just(Lens::Fisheye), Just(Lens::Pinhole)]
}

fn layout() -> impl Strategy<Value = Layout> {
    let rows = prop::collection::vec(0..5_u32, 0..4);
    prop_oneof![
        (0..6_u32, rows, any_number()).prop_map(|(gores, rows, spacing)| Layout::Gores {
            gores,
            rows,
            row_spacing_deg: 30.0 * spacing,
        }),
        // Pitches so wide that the test is quick.
        (any_number(), any_number()).prop_map(|(pitch, cap)| Layout::Lattice {
            pitch: pitch + 0.1,
            cap_deg: 180.0 * cap,
        }),
        (0..50_u32, any_number()).prop_map(|(markers, length)| Layout::Line { markers, length }),
        (0..50_u32, any_number()).prop_map(|(markers, length)| Layout::Radius { markers, length }),
    ]
}

#[test]
fn the_way_around_the_sphere_is_a_number() {
    for radius in [1e301, f64::MAX] {
        assert_eq!(
            Layout::published().places(radius).unwrap_err().setting(),
            Some("radius")
        );
    }
    let places = Layout::published().places(1e300).unwrap();
    assert!(
        places
            .iter()
            .flatten()
            .all(|coordinate| coordinate.is_finite())
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_layout_and_its_pattern(
        layout in layout(),
        radius in any_number(),
        (gores, samples) in (2..12_u32, 0..20_u32),
        disc in any_number(),
        place in prop::array::uniform2(any_number()),
        unit in any_number(),
    ) {
        if let Ok(places) = layout.places(radius) {
            prop_assert!(places.iter().flatten().all(|coordinate| coordinate.is_finite()));
        }
        if let Ok(strain) = FoldStrain::of(gores) {
            prop_assert!(strain.at(place[0], place[1]).is_ok_and(f64::is_finite) || strain.at(place[0], place[1]).is_err());
        }
        let Ok(pattern) = Pattern::new(gores, samples, radius) else { return Ok(()) };
        prop_assert!(pattern.gore().iter().flatten().all(|coordinate| coordinate.is_finite()));
        if let Ok(flat) = pattern.flatten(place) {
            let [x, y] = flat.assembled;
            prop_assert!([flat.across, flat.from_apex, x, y].iter().all(|one| one.is_finite()), "{flat:?}");
        }
        let discs = Discs { magenta: disc * radius, yellow: 0.5 * disc * radius };
        if let Ok(sheet) = pattern.sheet(&layout, discs) {
            prop_assert!(sheet.centres().iter().flatten().all(|coordinate| coordinate.is_finite()));
            if let Ok(svg) = sheet.svg(unit) {
                prop_assert!(!svg.contains("NaN") && !svg.contains("inf"));
            }
        }
    }

    #[test]
    fn any_camera(
        lens in lens(),
        size in 0..10_000_u32,
        field in any_number(),
        direction in prop::array::uniform3(any_number()),
        [width, polar] in prop::array::uniform2(any_number()),
    ) {
        let Ok(camera) = Camera::new(lens, size, 90.0 * field) else { return Ok(()) };
        let image = camera.image(&Vector3::from(direction));
        prop_assert!(image.iter().flatten().all(|one| one.is_finite()), "{image:?}");
        let [column, row, _] = direction;
        if let Some(direction) = camera.direction([column * f64::from(size), row * f64::from(size)]) {
            prop_assert!((direction.norm() - 1.0).abs() < 1e-12, "{direction:?}");
        }
        prop_assert!(camera.disc_area(width, polar).is_none_or(|area| area.is_finite()));
    }

    #[test]
    fn any_markers(
        lens in lens(),
        radius in any_number(),
        places in prop::collection::vec(prop::array::uniform2(any_number()), 0..4),
        numbers in prop::array::uniform4(any_number()),
        moves in prop::array::uniform6(any_number()),
        blemishes in prop::array::uniform4(any_number()),
    ) {
        let places: Vec<[f64; 2]> = places.into_iter().map(|place| place.map(|share| share * radius)).collect();
        let [magenta, yellow, deep, most] = numbers;
        let discs = Discs { magenta: magenta * radius, yellow: yellow * radius };
        let depths = DiscDepths { magenta: deep * radius, yellow: 0.5 * deep * radius };
        let array = MarkerArray::new(radius, &places, discs, depths).and_then(|array| array.misaligned(most, 1));
        let (Ok(array), Ok(camera)) = (array, Camera::new(lens, 24, 70.0)) else { return Ok(()) };
        let [light_at_rim, blur_px, width, pixel_std] = blemishes;
        let blemishes = Blemishes { light_at_rim, blur_px, pixel_std, seams: Some(Seams { gores: 3, width }) };
        let Ok(optics) = Optics::new(array, camera, Colours::default(), blemishes) else { return Ok(()) };
        let disc = |at: usize| DiscMotion {
            normal: moves[at] * radius,
            tangential: [moves[at + 1] * radius, moves[at + 2] * radius],
        };
        let motion = Some(MarkerMotion { magenta: disc(0), yellow: disc(3) });
        let motions = vec![motion; places.len()];
        if let Ok(seen) = optics.projected(&motions) {
            for seen in seen.into_iter().flatten() {
                let [x, y] = seen.centroid_px;
                prop_assert!((x + y + seen.size_px2).is_finite() && seen.size_px2 > 0.0, "{seen:?}");
                prop_assert!((0.0..1.0).contains(&seen.hue_turns), "{seen:?}");
            }
        }
        if let Ok(frame) = optics.rendered(&motions, None) {
            prop_assert_eq!(frame.dimensions(), (24, 24));
        }
    }
}
