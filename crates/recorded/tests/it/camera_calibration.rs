//! Calibrations of cameras from one frame at rest.

use image::{Rgb, RgbImage};
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, Discs, Layout, Lens, MarkerArray, MarkerMotion,
    OddTerms, Optics, Pose,
};
use palpate_recorded::{CameraEstimate, Frame, calibrate_camera};
use palpate_study::config::{Study, parse};

const SIZE: u32 = 500;

fn study(radius: f64) -> Study {
    misaligned(radius, 0.25)
}

fn misaligned(radius: f64, misalignment: f64) -> Study {
    parse("sensor.toml", &text(radius, misalignment)).expect("a study")
}

fn text(radius: f64, misalignment: f64) -> String {
    format!(
        r#"
        name = "sensor"
        length_unit = "mm"
        scene.kind = "press"
        scene.object = {{ kind = "plane" }}
        scene.motion = {{ indentation = 1.0 }}
        scene.sensor = {{ kind = "rendered", size_px = {SIZE} }}
        [scene.probe]
        kind = "marker-sphere"
        radius = {radius}
        marker_depth = 2.0
        discs = {{ magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0, misalignment = {misalignment} }}
        "#
    )
}

/// True parameters of a sensor and its frame.
struct Truth {
    place: [f64; 3],
    turn_deg: [f64; 3],
    /// Relative error of the nominal scale of the camera (pixels per radian).
    scale: f64,
    /// Diameter of the yellow discs (length).
    yellow: f64,
    lost: usize,
    misalignment: f64,
    terms: OddTerms,
    light_at_rim: f64,
}

impl Default for Truth {
    fn default() -> Self {
        Self {
            place: [0.4, -0.3, -0.5],
            turn_deg: [0.5, -1.0, 3.0],
            scale: 0.02,
            yellow: 2.0,
            lost: 0,
            misalignment: 0.25,
            terms: OddTerms::default(),
            light_at_rim: 1.0,
        }
    }
}

impl Truth {
    /// The nominal camera, but with the true coefficients k3 and k5 of its lens.
    fn lens(&self) -> Camera {
        Camera::new(Lens::from(self.terms), SIZE, 65.0).expect("a camera")
    }

    fn frame(&self, seed: u64) -> RgbImage {
        let places = Layout::published().places(20.0).expect("places");
        let (magenta, yellow) = (2.0, self.yellow);
        let depths = DiscDepths {
            magenta: 3.0,
            yellow: 1.0,
        };
        let array = MarkerArray::new(20.0, &places, Discs { magenta, yellow }, depths);
        let array = array.and_then(|array| array.misaligned(self.misalignment, seed, 0));
        let camera = self.lens();
        let camera = camera.adjusted([0.0; 2], camera.px_per_rad() * (1.0 + self.scale));
        let blemishes = Blemishes {
            pixel_std: 2.0,
            light_at_rim: self.light_at_rim,
            ..Blemishes::default()
        };
        let colours = Colours {
            white: [0.96; 3],
            ..Colours::default()
        };
        let optics = Optics::new(
            array.expect("markers"),
            camera.expect("a camera"),
            colours,
            blemishes,
        );
        let pose = Pose::new(self.place, self.turn_deg.map(f64::to_radians));
        let optics = optics
            .and_then(|optics| optics.seen_from(pose))
            .expect("optics");
        let mut motions = vec![Some(MarkerMotion::default()); places.len()];
        motions[..self.lost].fill(None);
        optics.render(&motions, Some((seed, 0))).expect("a frame")
    }
}

fn frame(image: RgbImage) -> Frame {
    Frame {
        file: "rest.png".to_owned(),
        image,
        compression: None,
    }
}

fn refused(image: RgbImage, study: &Study) -> String {
    calibrate_camera(&frame(image), &study.config)
        .expect_err("refused")
        .to_string()
}

/// For each camera parameter: difference between the estimate and the true value, divided by the standard error.
fn pulls(estimate: &CameraEstimate, truth: &Truth) -> Vec<f64> {
    let scale = truth.lens().px_per_rad() * (1.0 + truth.scale);
    let of = |axis: usize| {
        [
            (estimate.place[axis] - truth.place[axis]) / estimate.place_std[axis],
            (estimate.turn_deg[axis] - truth.turn_deg[axis]) / estimate.turn_std_deg[axis],
        ]
    };
    let mut pulls: Vec<f64> = (0..3).flat_map(of).collect();
    pulls.push((estimate.px_per_rad - scale) / estimate.px_per_rad_std);
    pulls
}

#[test]
fn one_frame_locates_the_camera() {
    let study = study(20.0);
    let above = Truth {
        place: [0.4, -0.3, 0.5],
        turn_deg: [1.0, -2.0, 0.0],
        ..Truth::default()
    };
    let (mut square, mut count) = (0.0, 0.0);
    for (seed, truth) in (1..).zip([Truth::default(), Truth::default(), above]) {
        let estimate =
            calibrate_camera(&frame(truth.frame(seed)), &study.config).expect("a camera");
        for pull in pulls(&estimate, &truth) {
            assert!(pull.abs() < 4.0, "{pull}: {estimate:?}");
            square += pull * pull;
            count += 1.0;
        }
        // There must be no warning about missing markers, although the rim of the last frame cuts some of the 77
        // markers.
        assert!(estimate.warnings.is_empty(), "{:?}", estimate.warnings);
        let used = estimate.residuals_px.len();
        let expected = if seed < 3 { 75..=77 } else { 0..=76 };
        assert!(expected.contains(&used), "{used}");
        // The standard errors must be much smaller than the prior standard deviations, which are 2 mm, 5 degrees and 10
        // %.
        assert!(
            estimate.place_std.iter().all(|std| *std < 0.3),
            "{estimate:?}"
        );
        assert!(
            estimate.turn_std_deg.iter().all(|std| *std < 1.0),
            "{estimate:?}"
        );
        assert!(
            estimate.px_per_rad_std < 0.03 * estimate.px_per_rad,
            "{estimate:?}"
        );
        assert!(estimate.residual_px < 0.05, "{estimate:?}");
        let terms = [estimate.k3_std, estimate.k5_std]
            .into_iter()
            .flatten()
            .count();
        assert_eq!(estimate.covariance.len(), 9 + terms);
        let variance = estimate.covariance[3][3];
        assert!((variance.sqrt() / estimate.place_std[0] - 1.0).abs() < 1e-12);
    }
    // The limits of the rms ratio of error to standard error are wide for two reasons: only three frames are used, and
    // the errors of a frame's seven parameters are correlated.
    let spread = f64::sqrt(square / count);
    assert!((0.15..2.0).contains(&spread), "{spread}");
}

#[test]
fn one_frame_determines_the_odd_terms_of_the_lens() {
    let study = study(20.0);
    let (mut square, mut count) = (0.0, 0.0);
    let terms = [(0.04, -0.01), (-0.06, 0.01)];
    for (seed, (k3, k5)) in (1..).zip(terms) {
        let truth = Truth {
            terms: OddTerms { k3, k5 },
            ..Truth::default()
        };
        let estimate =
            calibrate_camera(&frame(truth.frame(seed)), &study.config).expect("a camera");
        let stds = [estimate.k3_std, estimate.k5_std].map(|std| std.expect("it is determined"));
        let of_terms = [(estimate.k3 - k3) / stds[0], (estimate.k5 - k5) / stds[1]];
        for pull in pulls(&estimate, &truth).into_iter().chain(of_terms) {
            assert!(pull.abs() < 4.0, "{pull}: {estimate:?}");
        }
        for pull in of_terms {
            square += pull * pull;
            count += 1.0;
        }
        assert!(estimate.residual_px < 0.05, "{estimate:?}");
        assert_eq!(estimate.covariance.len(), 11);
        for (at, std) in stds.into_iter().enumerate() {
            let variance: f64 = estimate.covariance[9 + at][9 + at];
            assert!((variance.sqrt() / std - 1.0).abs() < 1e-12);
        }
    }
    let spread = f64::sqrt(square / count);
    assert!((0.15..2.0).contains(&spread), "{spread}");
}

#[test]
fn one_frame_locates_a_camera_far_above_or_below_the_centre() {
    let study = misaligned(20.0, 0.0);
    for (seed, height) in (1..).zip([-3.0, -1.5, 2.0]) {
        let truth = Truth {
            place: [0.0, 0.0, height],
            turn_deg: [0.0; 3],
            scale: 0.0,
            misalignment: 0.0,
            ..Truth::default()
        };
        let estimate =
            calibrate_camera(&frame(truth.frame(seed)), &study.config).expect("a camera");
        for pull in pulls(&estimate, &truth) {
            assert!(pull.abs() < 4.0, "{height}, {pull}: {estimate:?}");
        }
    }
}

#[test]
fn missing_markers_cause_a_warning_or_an_error() {
    let (study, mut truth) = (study(20.0), Truth::default());
    truth.lost = 6;
    let estimate = calibrate_camera(&frame(truth.frame(1)), &study.config).expect("a camera");
    assert!(
        (69..=71).contains(&estimate.residuals_px.len()),
        "{estimate:?}"
    );
    assert!(
        estimate.warnings[0]
            .text
            .contains("6 of the layout's 77 markers are missing")
    );
    truth.lost = 30;
    let said = refused(truth.frame(1), &study);
    assert!(said.contains("shows 47 of the 77 markers"), "{said}");
}

/// Uneven light shifts the images of markers near the rim by almost one pixel. If the study states the uneven light,
/// there must be no warning that the frame is from another camera.
#[test]
fn stated_uneven_light_does_not_count_as_another_camera() {
    let truth = Truth {
        place: [0.0; 3],
        turn_deg: [0.0; 3],
        scale: 0.0,
        misalignment: 0.0,
        light_at_rim: 0.7,
        ..Truth::default()
    };
    let even = text(20.0, 0.0) + "\n[scene.noise]\npixel = { kind = \"gaussian\", std = 2.0 }\n";
    let uneven = even.replace("size_px", "light_at_rim = 0.7, size_px");
    let scatter = |text: &str| {
        let study = parse("sensor.toml", text).expect("a study");
        let estimate = calibrate_camera(&frame(truth.frame(1)), &study.config).expect("a camera");
        estimate.reduced_chi_squared
    };
    let [even, uneven] = [&even, &uneven].map(|text| scatter(text));
    assert!(even > 1.8 && uneven < 1.3, "{even} {uneven}");
}

#[test]
fn an_error_names_the_blur_that_hides_all_markers() {
    let blurred = text(20.0, 0.25).replace("size_px", "blur_px = 16, size_px");
    let study = parse("sensor.toml", &blurred).expect("a study");
    let said = refused(Truth::default().frame(1), &study);
    assert!(
        said.contains("shows no markers by `light_at_rim` 1, `blur_px` 16"),
        "{said}"
    );
}

#[test]
fn errors_name_unusable_frames() {
    let here = study(20.0);
    let truth = Truth::default();
    // The frame must be rejected, because the study states another layout: its markers are 1.5 times as far apart (in
    // angle) as those in the frame.
    let said = refused(truth.frame(1), &study(30.0));
    assert!(
        said.contains("another layout") || said.contains("contradicts"),
        "{said}"
    );
    let narrow = Truth {
        yellow: 1.4,
        ..Truth::default()
    };
    let said = refused(narrow.frame(1), &here);
    assert!(said.contains("contradicts the layout: "), "{said}");
    let mut bright = truth.frame(1);
    for pixel in bright.pixels_mut() {
        *pixel = Rgb(pixel.0.map(|level| level.saturating_add(20)));
    }
    assert!(refused(bright, &here).contains("is saturated: "));
    let mut swapped = truth.frame(1);
    for pixel in swapped.pixels_mut() {
        let [red, green, blue] = pixel.0;
        *pixel = Rgb([red, blue, green]);
    }
    let said = refused(swapped, &here);
    assert!(said.contains("are colours swapped?"), "{said}");
    let small = RgbImage::new(300, 300);
    assert!(refused(small, &here).contains("has 300 x 300 px"));
    let mut dim = truth.frame(1);
    for pixel in dim.pixels_mut() {
        *pixel = Rgb(pixel.0.map(|level| level / 8));
    }
    assert!(refused(dim, &here).contains("is under-exposed"));
    let direct = parse(
        "direct.toml",
        "name = \"d\"\nscene.kind = \"press\"\nscene.object = { kind = \"plane\" }\nscene.motion = { indentation = 1.0 }\nscene.probe = { kind = \"marker-sphere\", radius = 20.0, marker_depth = 2.0 }",
    );
    let said = refused(truth.frame(1), &direct.expect("a study"));
    assert!(said.contains("must have a camera"), "{said}");
}
