//! Sensors with random parameters. If the parameters are possible, the markers, the pattern and the images of the
//! sensor can be computed. For any other parameters, each result is finite or an expected error.

use nalgebra::Vector3;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, DiscMotion, Discs, FoldStrain, Layout, Lens,
    MarkerArray, MarkerMotion, Optics, Pattern, Seams, SeenMarker,
};
use proptest::prelude::*;

/// Any floating-point number, including infinities and NaN. Numbers of ordinary size are drawn most frequently.
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
        // The pitch is at least 0.1, so that there are few markers and the test is fast.
        (any_number(), any_number()).prop_map(|(pitch, cap)| Layout::Lattice {
            pitch: pitch + 0.1,
            cap_deg: 180.0 * cap,
        }),
        (0..50_u32, any_number()).prop_map(|(markers, length)| Layout::Line { markers, length }),
        (0..50_u32, any_number()).prop_map(|(markers, length)| Layout::Radius { markers, length }),
    ]
}

fn motion(moves: &[f64; 6], radius: f64) -> MarkerMotion {
    let disc = |at: usize| DiscMotion {
        normal: moves[at] * radius,
        tangential: [moves[at + 1] * radius, moves[at + 2] * radius],
        skin_stretch: moves[at + 1],
        ..DiscMotion::default()
    };
    MarkerMotion {
        magenta: disc(0),
        yellow: disc(3),
    }
}

fn is_sound(seen: &SeenMarker) -> bool {
    let [x, y] = seen.centroid_px;
    (x + y + seen.size_px2).is_finite()
        && seen.size_px2 > 0.0
        && (0.0..1.0).contains(&seen.hue_turns)
        && (-1e-9..1.0).contains(&seen.mean_hue_turns)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_layout_and_its_pattern_give_numbers_or_the_error_that_is_due(
        layout in layout(),
        radius in any_number(),
        (gores, samples) in (2..12_u32, 0..20_u32),
        disc in any_number(),
        place in prop::array::uniform2(any_number()),
        unit in any_number(),
    ) {
        let places = layout.places(radius);
        prop_assert!(places.is_err() || radius > 0.0 && radius <= 1e300, "{places:?}");
        prop_assert!(places.iter().flatten().flatten().all(|coordinate| coordinate.is_finite()));
        prop_assert_eq!(FoldStrain::of(gores).err().map(<&str>::from), (gores < 3).then_some("too-few-gores"));
        if let Ok(strain) = FoldStrain::of(gores) {
            let [longitude, latitude] = place;
            let is_on_gore = longitude.abs() <= std::f64::consts::PI / f64::from(gores)
                && (0.0..=std::f64::consts::FRAC_PI_2).contains(&latitude);
            prop_assert_eq!(strain.at(longitude, latitude).is_ok_and(f64::is_finite), is_on_gore);
        }
        let pattern = Pattern::new(gores, samples, radius);
        let due = match radius {
            _ if gores < 3 => Some("too-few-gores"),
            radius if samples == 0 || !(1e-100..=1e100).contains(&radius) => Some("bad-setting"),
            _ => None,
        };
        prop_assert_eq!(pattern.as_ref().err().map(<&str>::from), due);
        let Ok(pattern) = pattern else { return Ok(()) };
        let discs = Discs { magenta: disc * radius, yellow: 0.5 * disc * radius };
        if let Ok(sheet) = pattern.sheet(&layout, discs) {
            match sheet.svg(unit) {
                Ok(svg) => prop_assert!(!svg.contains("NaN") && !svg.contains("inf")),
                Err(error) => prop_assert_eq!(<&str>::from(&error), "not-drawable"),
            }
        }
    }

    #[test]
    fn any_camera_gives_numbers_or_names_the_setting(
        lens in lens(),
        size in 0..10_000_u32,
        field in any_number(),
        direction in prop::array::uniform3(any_number()),
        [width, polar] in prop::array::uniform2(any_number()),
    ) {
        let field_deg = 90.0 * field;
        let widest = if lens == Lens::Fisheye { 180.0 } else { 89.9999 };
        let due = if !(1..=8192).contains(&size) {
            Some("size_px")
        } else {
            (!(1e-6..=widest).contains(&field_deg)).then_some("field_deg")
        };
        let camera = Camera::new(lens, size, field_deg);
        prop_assert_eq!(camera.as_ref().err().and_then(|error| error.setting()), due);
        let Ok(camera) = camera else { return Ok(()) };
        prop_assert!(camera.image(&Vector3::z()).is_some());
        let image = camera.image(&Vector3::from(direction));
        prop_assert!(image.iter().flatten().all(|one| one.is_finite()), "{image:?}");
        prop_assert!(camera.disc_area(width, polar).is_none_or(|area| area.is_finite()));
    }

    /// All markers remain visible if each component of their discs' motions is at most a hundredth of the skin's
    /// radius. The sensor has four markers that are a third of a radian apart.
    #[test]
    fn markers_that_move_little_are_all_seen(
        lens in lens(),
        power in -9.0..9.0_f64,
        (magenta, yellow, deep, most) in (0.02..0.1, 0.02..0.1, 0.0..0.2, 0.0..0.5),
        moves in prop::array::uniform6(-0.01..0.01),
        (light_at_rim, blur_px, width, pixel_std) in (0.0..1.0, 0.0..2.0, 0.0..0.1, 0.0..20.0),
    ) {
        let radius = libm::pow(10.0, power);
        let places = [[0.0, 0.0], [0.33, 0.0], [0.0, 0.33], [-0.33, 0.0]].map(|place| place.map(|share| share * radius));
        let discs = Discs { magenta: magenta * radius, yellow: yellow * radius };
        let depths = DiscDepths { magenta: deep * radius, yellow: 0.5 * deep * radius };
        let array = MarkerArray::new(radius, &places, discs, depths).unwrap().misaligned(most, 1, 0).unwrap();
        let blemishes = Blemishes { light_at_rim, blur_px, pixel_std, seams: Some(Seams { gores: 3, width }) };
        let camera = Camera::new(lens, 24, 70.0).unwrap();
        let optics = Optics::new(array, camera, Colours::default(), blemishes).unwrap();
        let motions = vec![Some(motion(&moves, radius)); places.len()];
        let seen = optics.project(&motions).unwrap();
        prop_assert_eq!(seen.iter().flatten().count(), places.len());
        prop_assert!(seen.iter().flatten().all(is_sound), "{seen:?}");
        prop_assert_eq!(optics.render(&motions, None).unwrap().dimensions(), (24, 24));
    }

    #[test]
    fn any_markers_give_numbers_or_the_error_that_is_due(
        lens in lens(),
        radius in any_number(),
        places in prop::collection::vec(prop::array::uniform2(any_number()), 0..4),
        numbers in prop::array::uniform4(any_number()),
        moves in prop::array::uniform6(any_number()),
        blemishes in prop::array::uniform4(any_number()),
        (size, wide) in (1..40_u32, 1e-6..89.9999),
    ) {
        let places: Vec<[f64; 2]> = places.into_iter().map(|place| place.map(|share| share * radius)).collect();
        let [magenta, yellow, deep, most] = numbers;
        let discs = Discs { magenta: magenta * radius, yellow: yellow * radius };
        let depths = DiscDepths { magenta: deep * radius, yellow: 0.5 * deep * radius };
        let array = MarkerArray::new(radius, &places, discs, depths);
        if !(1e-50..=1e50).contains(&radius) {
            prop_assert_eq!(array.as_ref().unwrap_err().setting(), Some("radius"));
        } else if !(0.0..1.0).contains(&deep) {
            prop_assert_eq!(<&str>::from(array.as_ref().unwrap_err()), "bad-depth");
        }
        let Ok(array) = array else { return Ok(()) };
        let array = array.misaligned(most, 1, 0);
        prop_assert_eq!(array.is_ok(), (0.0..=1.0).contains(&most));
        let (Ok(array), Ok(camera)) = (array, Camera::new(lens, size, wide)) else { return Ok(()) };
        let [light_at_rim, blur_px, width, pixel_std] = blemishes;
        let due = [
            ("light_at_rim", (0.0..=1.0).contains(&light_at_rim)),
            ("blur_px", (0.0..=16.0).contains(&blur_px)),
            ("pixel_std", (0.0..=255.0).contains(&pixel_std)),
            ("seam_width", width >= 0.0 && width.is_finite()),
        ];
        let due = due.iter().find(|(_, is_good)| !is_good).map(|(setting, _)| *setting);
        let blemishes = Blemishes { light_at_rim, blur_px, pixel_std, seams: Some(Seams { gores: 3, width }) };
        let optics = Optics::new(array, camera, Colours::default(), blemishes);
        prop_assert_eq!(optics.as_ref().err().and_then(|error| error.setting()), due);
        let Ok(optics) = optics else { return Ok(()) };
        let motions = vec![Some(motion(&moves, radius)); places.len()];
        match optics.project(&motions) {
            Ok(seen) => prop_assert!(seen.iter().flatten().all(is_sound), "{seen:?}"),
            Err(error) => prop_assert_eq!(<&str>::from(&error), "impossible-motion"),
        }
        match optics.render(&motions, None) {
            Ok(frame) => prop_assert_eq!(frame.dimensions(), (size, size)),
            Err(error) => prop_assert_eq!(<&str>::from(&error), "impossible-motion"),
        }
    }
}
