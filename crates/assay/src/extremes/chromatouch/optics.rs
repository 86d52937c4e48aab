//! Cases of a camera that looks at markers: frames from one pixel to thousands wide, discs from points to half the sky.

use std::f64::consts::PI;

use nalgebra::Vector3;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, DiscMotion, Discs, Lens, MarkerArray, MarkerMotion,
    Optics, OpticsError, Seams,
};
use palpate_sensing::{Channel, Stream};

use crate::extremes::{Answer, Case, Outcome, Precise, answer::NONE};

const LENSES: [Lens; 2] = [Lens::Fisheye, Lens::Pinhole];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for lens in LENSES {
        for size_px in [1, 2, 4096, 8192] {
            for field_deg in [1e-6, 1.0, 60.0, 89.0] {
                cases.push(Case::value(
                    "chromatouch::Camera::direction",
                    format!("{lens:?}, {size_px} px of {field_deg:e}°: there and back"),
                    move || there_and_back(lens, size_px, field_deg),
                ));
            }
        }
        for polar in [0.0, 1e-9, 0.5, 1.0] {
            for width in [1e-9, 1e-3, 0.3] {
                cases.push(Case::value(
                    "chromatouch::Camera::disc_area",
                    format!("{lens:?}, {width:e} rad wide, {polar:e} rad from the axis"),
                    move || area(lens, polar, width),
                ));
            }
        }
        for (size_px, field_deg) in [
            (0, 60.0),
            (8193, 60.0),
            (u32::MAX, 60.0),
            (100, f64::NAN),
            (100, f64::INFINITY),
            (100, 0.0),
            (100, -1.0),
            (100, f64::from_bits(1)),
            (100, 181.0),
        ] {
            cases.push(Case::refusal(
                "chromatouch::Camera::new",
                format!("{lens:?}, {size_px} px of {field_deg:e}°"),
                move || Camera::new(lens, size_px, field_deg),
            ));
        }
        for number in [
            f64::NAN,
            f64::INFINITY,
            -f64::MAX,
            f64::from_bits(1),
            -0.0,
            0.0,
        ] {
            cases.push(Case::new(
                "chromatouch::Camera::image",
                format!(
                    "{lens:?}, direction ({number:e}, 0, 1) and (0, {number:e}, 0), place and disc"
                ),
                move || anywhere(lens, number),
            ));
        }
    }
    for radius in [1e-45, 1e-9, 1.0, 1e9, 1e45] {
        cases.push(Case::value(
            "chromatouch::Optics::projected",
            format!("a marker at rest on a sensor of radius {radius:e}: place, and size by an inward motion"),
            move || at_rest(radius),
        ));
    }
    for inward in [1e-300, 1e-9, 0.1, 0.5, 0.9] {
        cases.push(Case::value(
            "chromatouch::Optics::projected",
            format!(
                "motion inward by {inward:e} of the way to the camera: the solid angle's growth"
            ),
            move || grown(inward),
        ));
    }
    for number in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1.0, -1.0, 1e300] {
        for place in 0..3 {
            cases.push(Case::refusal(
                "chromatouch::Optics::projected",
                format!("motion number {place} is {number:e}"),
                move || moved(place, number),
            ));
        }
    }
    for size_px in [1, 2, 15, 64] {
        for markers in [0, 1, 40] {
            cases.push(Case::value(
                "chromatouch::Optics::rendered",
                format!("{size_px} px, {markers} markers, all blemishes: pixels"),
                move || rendered(size_px, markers),
            ));
        }
    }
    // Without optimisation the larger one takes longer than what counts as hanging.
    let large = if cfg!(debug_assertions) { 512 } else { 4096 };
    cases.push(Case::value(
        "chromatouch::Optics::rendered",
        format!("{large} px, one marker: pixels"),
        move || rendered(large, 1),
    ));
    arrays(&mut cases);
    blemishes(&mut cases);
    cases
}

fn arrays(cases: &mut Vec<Case>) {
    for (input, radius, place, diameter, depth) in [
        ("radius NaN", f64::NAN, 0.0, 0.1, 0.1),
        ("radius 0", 0.0, 0.0, 0.1, 0.1),
        ("radius 1e60", 1e60, 0.0, 0.1, 0.1),
        ("place NaN", 1.0, f64::NAN, 0.1, 0.1),
        ("place half a turn away", 1.0, PI, 0.1, 0.1),
        ("disc of no width", 1.0, 0.0, 0.0, 0.1),
        ("disc of subnormal width", 1.0, 0.0, f64::from_bits(1), 0.1),
        ("disc of width NaN", 1.0, 0.0, f64::NAN, 0.1),
        ("disc wider than the sensor", 1.0, 0.0, 3.0, 0.1),
        ("disc at the centre", 1.0, 0.0, 0.1, 1.0),
        ("disc outside", 1.0, 0.0, 0.1, -0.1),
        ("disc at depth NaN", 1.0, 0.0, 0.1, f64::NAN),
    ] {
        cases.push(Case::refusal(
            "chromatouch::MarkerArray::new",
            input,
            move || array(radius, &[[place, 0.0]], diameter, depth),
        ));
    }
    for (input, places) in [
        ("two markers in one place", vec![[0.1, 0.0]; 2]),
        ("100,001 markers", vec![[0.1, 0.0]; 100_001]),
        ("1000 markers in one place", vec![[0.1, 0.0]; 1000]),
    ] {
        cases.push(Case::refusal(
            "chromatouch::MarkerArray::new",
            input,
            move || array(1.0, &places, 0.01, 0.1),
        ));
    }
    for most in [f64::NAN, f64::INFINITY, -1e-300, 1.1] {
        cases.push(Case::refusal(
            "chromatouch::MarkerArray::misaligned",
            format!("by {most:e}"),
            move || array(1.0, &[[0.0, 0.0]], 0.1, 0.1)?.misaligned(most, 1),
        ));
    }
}

fn blemishes(cases: &mut Vec<Case>) {
    for number in [f64::NAN, f64::INFINITY, -1e-300, 300.0] {
        let kinds = [
            (
                "light_at_rim",
                Blemishes {
                    light_at_rim: number,
                    ..Blemishes::default()
                },
            ),
            (
                "blur_px",
                Blemishes {
                    blur_px: number,
                    ..Blemishes::default()
                },
            ),
            (
                "pixel_std",
                Blemishes {
                    pixel_std: number,
                    ..Blemishes::default()
                },
            ),
        ];
        for (setting, blemishes) in kinds {
            cases.push(Case::refusal(
                "chromatouch::Optics::new",
                format!("{setting} {number:e}"),
                move || {
                    let camera = Camera::new(Lens::Fisheye, 32, 60.0)?;
                    Optics::new(
                        array(1.0, &[], 0.1, 0.1)?,
                        camera,
                        Colours::default(),
                        blemishes,
                    )
                },
            ));
        }
        cases.push(Case::refusal(
            "chromatouch::Optics::new",
            format!("a share of light of {number:e}"),
            move || {
                let camera = Camera::new(Lens::Fisheye, 32, 60.0)?;
                let colours = Colours {
                    yellow: [1.0, number, 0.0],
                    ..Colours::default()
                };
                Optics::new(
                    array(1.0, &[], 0.1, 0.1)?,
                    camera,
                    colours,
                    Blemishes::default(),
                )
            },
        ));
    }
}

fn array(
    radius: f64,
    places: &[[f64; 2]],
    diameter: f64,
    depth: f64,
) -> Result<MarkerArray, OpticsError> {
    let discs = Discs {
        magenta: diameter,
        yellow: diameter,
    };
    MarkerArray::new(
        radius,
        places,
        discs,
        DiscDepths {
            magenta: depth,
            yellow: depth,
        },
    )
}

fn there_and_back(lens: Lens, size_px: u32, field_deg: f64) -> Result<Answer, OpticsError> {
    let camera = Camera::new(lens, size_px, field_deg)?;
    let centre = camera.centre_px();
    let mut pairs = Vec::new();
    for share in [0.0, 1e-12, 0.3, 0.999_999] {
        for (sine, cosine) in [0.1_f64, 2.0, -3.0].map(libm::sincos) {
            let reach = share * camera.rim_px();
            let at = [centre[0] + reach * cosine, centre[1] + reach * sine];
            let seen = camera
                .direction(at)
                .and_then(|direction| camera.image(&direction));
            for (found, at) in seen.unwrap_or([f64::NAN; 2]).into_iter().zip(at) {
                pairs.push((found / camera.rim_px(), at / camera.rim_px()));
            }
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-12))
}

/// Solid angle 2π(1 − cos α) times the lens's areas: θ/sin θ and 1/cos³ θ, to second order in α.
fn area(lens: Lens, polar: f64, width: f64) -> Result<Answer, OpticsError> {
    let camera = Camera::new(lens, 1000, 80.0)?;
    let found = camera.disc_area(width, polar).unwrap_or(f64::NAN);
    let (theta, alpha) = (Precise::new(polar), Precise::new(width));
    let solid = (&alpha * 0.5).sin().squared() * 4.0 * Precise::pi();
    let magnified = match lens {
        Lens::Fisheye if polar > 0.0 => &theta / &theta.sin(),
        Lens::Fisheye => Precise::new(1.0),
        // The image of a cone is an ellipse: π sin² α cos α/(cos² θ − sin² α)^{3/2}.
        Lens::Pinhole => {
            let below = theta.cos().squared() - alpha.sin().squared();
            Precise::pi() * alpha.sin().squared() * alpha.cos() / (&below * below.sqrt()) / &solid
        }
    };
    let f = Precise::new(camera.px_per_rad());
    let truth = (solid * magnified * f.squared()).to_f64();
    let bound = match lens {
        // The magnification's mean over the disc is off by the order of α².
        Lens::Fisheye => 1e-12 + width * width,
        Lens::Pinhole => 1e-12,
    };
    Ok(Answer::near(found, truth).within(bound))
}

/// A camera with `number` as a coordinate, angle or size: a point on the axis must have its image in the middle of the
/// picture, and all other results must be finite.
fn anywhere(lens: Lens, number: f64) -> Outcome {
    let camera = Camera::new(lens, 100, 80.0).expect("a camera");
    let aside = camera.image(&Vector3::new(0.0, number, 0.0));
    let towards = camera.direction([number, 3.0]);
    let others: Vec<f64> = (aside.into_iter().flatten())
        .chain(towards.iter().flat_map(|one| [one.x, one.y, one.z]))
        .chain(camera.disc_area(number, 0.1))
        .chain(camera.disc_area(0.1, number))
        .collect();
    match camera.image(&Vector3::new(number, 0.0, 1.0)) {
        Some(image) => {
            let pairs = image.into_iter().zip(camera.centre_px());
            let answer = Answer::all_at_scale(pairs, camera.rim_px());
            answer.within(1e-15).also(others).into()
        }
        None => Outcome::of_all([Err(NONE), Ok(others)]),
    }
}

fn optics(radius: f64, places: &[[f64; 2]]) -> Result<Optics, OpticsError> {
    let camera = Camera::new(Lens::Fisheye, 2048, 80.0)?;
    let array = array(radius, places, 0.02 * radius, 0.1 * radius)?;
    Optics::new(array, camera, Colours::default(), Blemishes::default())
}

/// A fisheye shows a place at its angle from the apex.
fn at_rest(radius: f64) -> Result<Answer, OpticsError> {
    let places = [[0.0, 0.0], [0.5 * radius, 0.0], [0.0, 1.0 * radius]];
    let optics = optics(radius, &places)?;
    let camera = optics.camera();
    let [x, y] = camera.centre_px();
    let seen = optics.projected(&[Some(MarkerMotion::default()); 3])?;
    let f = camera.px_per_rad();
    let truths = [[x, y], [x + 0.5 * f, y], [x, y - f]];
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for (seen, truth) in seen.iter().zip(truths) {
        let centroid = seen.map_or([f64::NAN; 2], |seen| seen.centroid_px);
        pairs.extend((0..2).map(|axis| (centroid[axis], truth[axis])));
        numbers.extend(seen.iter().flat_map(|seen| [seen.hue_turns, seen.size_px2]));
    }
    // Away from the axis the image of a disc leans inward, by the square of its angle.
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(f * 0.012 * 0.012)
        .also(numbers))
}

/// A disc of half-width w at the distance d fills 2π(1 − 1/√(1 + (w/d)²)).
fn grown(inward: f64) -> Result<Answer, OpticsError> {
    let optics = optics(1.0, &[[0.0, 0.0]])?;
    let disc = DiscMotion {
        normal: 0.9 * inward,
        tangential: [0.0; 2],
    };
    let seen = optics.projected(&[Some(MarkerMotion {
        magenta: disc,
        yellow: disc,
    })])?;
    let rest = optics.projected(&[Some(MarkerMotion::default())])?;
    let solid = |distance: Precise| {
        let slope = Precise::new(0.01) / distance;
        Precise::new(1.0) - Precise::new(1.0) / (slope.squared() + 1.0).sqrt()
    };
    let distance = Precise::new(0.9) * (Precise::new(1.0) - Precise::new(inward));
    let truth = (solid(distance) / solid(Precise::new(0.9))).to_f64();
    let size = |seen: &[Option<palpate_chromatouch::SeenMarker>]| {
        seen[0].map_or(f64::NAN, |seen| seen.size_px2)
    };
    // The equidistant picture enlarges areas by a sixth of the disc's angle squared.
    let width = 0.01 / (0.9 * (1.0 - inward));
    Ok(Answer::near(size(&seen) / size(&rest), truth).within(1e-12 + width * width / 6.0))
}

fn moved(
    place: usize,
    number: f64,
) -> Result<Vec<Option<palpate_chromatouch::SeenMarker>>, OpticsError> {
    let mut numbers = [0.0; 3];
    numbers[place] = number;
    let [normal, x, y] = numbers;
    let disc = DiscMotion {
        normal,
        tangential: [x, y],
    };
    optics(1.0, &[[0.0, 0.0]])?.projected(&[Some(MarkerMotion {
        magenta: disc,
        yellow: disc,
    })])
}

fn rendered(size_px: u32, markers: usize) -> Result<Answer, OpticsError> {
    let places: Vec<[f64; 2]> = (0..markers)
        .map(|marker| [0.03 * marker as f64, 0.0])
        .collect();
    let blemishes = Blemishes {
        light_at_rim: 0.5,
        blur_px: if size_px < 100 { 16.0 } else { 0.0 },
        seams: Some(Seams {
            gores: 4,
            width: 1e300,
        }),
        pixel_std: if size_px < 100 { 255.0 } else { 0.0 },
    };
    let camera = Camera::new(Lens::Fisheye, size_px, 90.0)?;
    let array = array(1.0, &places, 0.02, 0.1)?.misaligned(1.0, 3)?;
    let optics = Optics::new(array, camera, Colours::default(), blemishes)?;
    let mut stream = Stream::new(1, 2, Channel::Misalignment);
    let frame = optics.rendered(
        &vec![Some(MarkerMotion::default()); markers],
        Some(&mut stream),
    )?;
    Ok(Answer::near(
        f64::from(frame.width()) * f64::from(frame.height()),
        f64::from(size_px).powi(2),
    ))
}
