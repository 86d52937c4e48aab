//! Cameras that look at markers: frames from one pixel to thousands wide, discs from points to half the sky.

use std::f64::consts::PI;

use nalgebra::Vector3;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, DiscMotion, Discs, Lens, MarkerArray, MarkerMotion,
    Optics, OpticsError, Seams, SeenMarker,
};
use palpate_sensing::{Channel, Stream};
use palpate_verdict::{Answer, Precise, rows};

const CAMERA: &str = "chromatouch::Camera::new";
const DIRECTION: &str = "chromatouch::Camera::direction";
const IMAGE: &str = "chromatouch::Camera::image";
const AREA: &str = "chromatouch::Camera::disc_area";
const ARRAY: &str = "chromatouch::MarkerArray::new";
const OPTICS: &str = "chromatouch::Optics::new";
const PROJECTED: &str = "chromatouch::Optics::projected";
const RENDERED: &str = "chromatouch::Optics::rendered";
const BAD: &str = "bad-setting";
const LENSES: [Lens; 2] = [Lens::Fisheye, Lens::Pinhole];
const LEAST: f64 = f64::from_bits(1);
const TOO_FAR: [f64; 3] = [f64::NAN, f64::INFINITY, -f64::MAX];
const ABOUT_0: [f64; 3] = [LEAST, -0.0, 0.0];
const NO_FIELDS: [f64; 6] = [f64::NAN, f64::INFINITY, 0.0, -1.0, LEAST, 181.0];
const NO_SHARES: [f64; 4] = [f64::NAN, f64::INFINITY, -1e-300, 300.0];
const APEX: [f64; 2] = [0.0; 2];

rows! {
    DIRECTION, "{lens:?}, {size_px} px of {field_deg:e}°: there and back" => there_and_back(lens, size_px, field_deg),
        for lens in LENSES, for size_px in [1, 2, 4096, 8192], for field_deg in [1e-6, 1.0, 60.0, 89.0];
    DIRECTION, "{lens:?}, place ({x:e}, 49.5) of 100 px, and back" =>
        seen(&camera(lens), [x, 49.5]).map(|pairs| Answer::all_at_scale(pairs, 1.0).within(1e-13)),
        for lens in LENSES, for x in ABOUT_0;
    DIRECTION, "{lens:?}, place ({far:e}, 49.5) of 100 px", "none" => camera(lens).direction([far, 49.5]),
        for lens in LENSES, for far in TOO_FAR;
    IMAGE, "{lens:?}, direction ({x:e}, 0, 1)" => on_axis(lens, x), for lens in LENSES, for x in ABOUT_0;
    IMAGE, "{lens:?}, direction ({far:e}, 0, 1)", "none" => on_axis(lens, far), for lens in LENSES, for far in TOO_FAR;
    IMAGE, "{lens:?}, direction (0, {y:e}, 0)", "none" => camera(lens).image(&Vector3::new(0.0, y, 0.0)),
        for lens in LENSES, for y in TOO_FAR.into_iter().chain(ABOUT_0);
    AREA, "{lens:?}, {width:e} rad wide, {polar:e} rad from the axis" => area(lens, polar, width),
        for lens in LENSES, for polar in [LEAST, -0.0, 0.0, 1e-9, 0.5, 1.0], for width in [LEAST, 1e-9, 1e-3, 0.3];
    AREA, "{lens:?}, {width:e} rad wide", "none" => area(lens, 0.1, width),
        for lens in LENSES, for width in [f64::NAN, f64::INFINITY, -f64::MAX, 0.0, -0.0];
    AREA, "{lens:?}, {far:e} rad from the axis", "none" => area(lens, far, 0.1), for lens in LENSES, for far in TOO_FAR;
    CAMERA, "{lens:?}, {size_px} px of 60°", BAD => Camera::new(lens, size_px, 60.0),
        for lens in LENSES, for size_px in [0, 8193, u32::MAX];
    CAMERA, "{lens:?}, 100 px of {field_deg:e}°", BAD => Camera::new(lens, 100, field_deg),
        for lens in LENSES, for field_deg in NO_FIELDS;
    PROJECTED, "markers at rest on a sensor of radius {radius:e}: places" => at_rest(radius),
        for radius in [1e-45, 1e-9, 1.0, 1e9, 1e45];
    PROJECTED, "motion inward by {inward:e} of the way to the camera: the solid angle's growth" => grown(inward),
        for inward in [1e-300, 1e-9, 0.1, 0.5, 0.9];
    PROJECTED, "motion number {place} is {bad:e}", "impossible-motion" => moved(Vector3::ith(place, bad)),
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1.0, -1.0, 1e300], for place in 0..3;
    RENDERED, "{size_px} px, {markers} markers, all blemishes: pixels" => rendered(size_px, markers, 255.0),
        for size_px in [1, 2, 15, 64], for markers in [0, 1, 40];
    RENDERED, "512 px, one marker: pixels" => rendered(512, 1, 0.0);
    ARRAY, "radius {bad:e}", BAD => array(bad, &[APEX], 0.1, 0.1), for bad in [f64::NAN, 0.0, 1e60];
    ARRAY, "place {far:e} rad from the apex", "off-the-skin" => array(1.0, &[[far, 0.0]], 0.1, 0.1),
        for far in [f64::NAN, PI];
    ARRAY, "disc of width {bad:e}", BAD => array(1.0, &[APEX], bad, 0.1), for bad in [0.0, LEAST, f64::NAN, 3.0];
    ARRAY, "disc at depth {bad:e}", "bad-depth" => array(1.0, &[APEX], 0.1, bad), for bad in [1.0, -0.1, f64::NAN];
    ARRAY, "{count} markers in one place", "discs-overlap" => array(1.0, &vec![[0.1, 0.0]; count], 0.01, 0.1),
        for count in [2, 1000];
    ARRAY, "100,001 markers", "too-many-markers" => array(1.0, &[[0.1, 0.0]; 100_001], 0.01, 0.1);
    "chromatouch::MarkerArray::misaligned", "by {most:e}", BAD =>
        array(1.0, &[APEX], 0.1, 0.1).unwrap().misaligned(most, 1), for most in [f64::NAN, f64::INFINITY, -1e-300, 1.1];
    OPTICS, "light_at_rim {bad:e}", BAD =>
        with(Colours::default(), Blemishes { light_at_rim: bad, ..Blemishes::default() }), for bad in NO_SHARES;
    OPTICS, "blur_px {bad:e}", BAD => with(Colours::default(), Blemishes { blur_px: bad, ..Blemishes::default() }),
        for bad in NO_SHARES;
    OPTICS, "pixel_std {bad:e}", BAD => with(Colours::default(), Blemishes { pixel_std: bad, ..Blemishes::default() }),
        for bad in NO_SHARES;
    OPTICS, "a share of light of {bad:e}", BAD =>
        with(Colours { yellow: [1.0, bad, 0.0], ..Colours::default() }, Blemishes::default()), for bad in NO_SHARES;
}

fn array(
    radius: f64,
    places: &[[f64; 2]],
    diameter: f64,
    depth: f64,
) -> Result<MarkerArray, OpticsError> {
    let [magenta, yellow] = [diameter; 2];
    let discs = Discs { magenta, yellow };
    let [magenta, yellow] = [depth; 2];
    MarkerArray::new(radius, places, discs, DiscDepths { magenta, yellow })
}

fn camera(lens: Lens) -> Camera {
    Camera::new(lens, 100, 80.0).unwrap()
}

/// Coordinates of the image of the direction seen at a place, with those of the place; in radii of the picture.
fn seen(camera: &Camera, at: [f64; 2]) -> Option<[(f64, f64); 2]> {
    let image = camera.image(camera.direction(at)?.as_ref())?;
    Some([0, 1].map(|axis| (image[axis] / camera.rim_px(), at[axis] / camera.rim_px())))
}

fn there_and_back(lens: Lens, size_px: u32, field_deg: f64) -> Option<Answer> {
    let camera = Camera::new(lens, size_px, field_deg).unwrap();
    let centre = camera.centre_px();
    let mut pairs = Vec::new();
    for reach in [0.0, 1e-12, 0.3, 0.999_999].map(|share| share * camera.rim_px()) {
        for (sine, cosine) in [0.1_f64, 2.0, -3.0].map(libm::sincos) {
            let at = [centre[0] + reach * cosine, centre[1] + reach * sine];
            pairs.extend(seen(&camera, at)?);
        }
    }
    Some(Answer::all_at_scale(pairs, 1.0).within(1e-12))
}

/// A point that is on the axis but for the least number is seen in the middle of the picture.
fn on_axis(lens: Lens, x: f64) -> Option<Answer> {
    let camera = camera(lens);
    let image = camera.image(&Vector3::new(x, 0.0, 1.0))?;
    let pairs = image.into_iter().zip(camera.centre_px());
    Some(Answer::all_at_scale(pairs, camera.rim_px()).within(1e-15))
}

/// Solid angle 2π(1 − cos α) times the lens's areas: θ/sin θ and 1/cos³ θ, to second order in α.
fn area(lens: Lens, polar: f64, width: f64) -> Option<Answer> {
    let camera = camera(lens);
    let found = camera.disc_area(width, polar)?;
    let (theta, alpha) = (Precise::new(polar), Precise::new(width));
    let solid = (&alpha * 0.5).sin().squared() * 4.0 * Precise::pi();
    let on_picture = match lens {
        Lens::Fisheye | Lens::Odd(_) if polar > 0.0 => solid * &theta / theta.sin(),
        Lens::Fisheye | Lens::Odd(_) => solid,
        // The image of a cone is an ellipse: π sin² α cos α/(cos² θ − sin² α)^{3/2}.
        Lens::Pinhole => {
            let below = theta.cos().squared() - alpha.sin().squared();
            Precise::pi() * alpha.sin().squared() * alpha.cos() / (&below * below.sqrt())
        }
    };
    let truth = on_picture * Precise::new(camera.px_per_rad()).squared();
    let bound = match lens {
        // The magnification's mean over the disc is off by the order of α².
        Lens::Fisheye | Lens::Odd(_) => 1e-12 + width * width,
        Lens::Pinhole => 1e-12,
    };
    Some(Answer::near(found, truth.to_f64()).within(bound))
}

/// Markers on a skin, before a fisheye of 2048 px.
fn optics(radius: f64, places: &[[f64; 2]]) -> Optics {
    let camera = Camera::new(Lens::Fisheye, 2048, 80.0).unwrap();
    let array = array(radius, places, 0.02 * radius, 0.1 * radius).unwrap();
    Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap()
}

fn with(colours: Colours, blemishes: Blemishes) -> Result<Optics, OpticsError> {
    let optics = optics(1.0, &[]);
    Optics::new(optics.array().clone(), *optics.camera(), colours, blemishes)
}

/// A fisheye shows a place at its angle from the apex.
fn at_rest(radius: f64) -> Result<Answer, OpticsError> {
    let optics = optics(radius, &[APEX, [0.5 * radius, 0.0], [0.0, radius]]);
    let [x, y] = optics.camera().centre_px();
    let f = optics.camera().px_per_rad();
    let seen = optics.projected(&[Some(MarkerMotion::default()); 3])?;
    let seen = seen.into_iter().map(Option::unwrap);
    let truths = [[x, y], [x + 0.5 * f, y], [x, y - f]];
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for (seen, truth) in seen.zip(truths) {
        pairs.extend(seen.centroid_px.into_iter().zip(truth));
        numbers.extend([seen.hue_turns, seen.size_px2]);
    }
    // Away from the axis the image of a disc leans inward, by the square of its angle.
    let answer = Answer::all_at_scale(pairs, 1.0).within(f * 0.012 * 0.012);
    Ok(answer.also(numbers))
}

/// A marker at the apex of a skin of radius 1, both discs of which have moved inward and sideways.
fn moved(motion: Vector3<f64>) -> Result<SeenMarker, OpticsError> {
    let disc = DiscMotion {
        normal: motion.x,
        tangential: [motion.y, motion.z],
        ..DiscMotion::default()
    };
    let motion = MarkerMotion {
        magenta: disc,
        yellow: disc,
    };
    Ok(optics(1.0, &[APEX]).projected(&[Some(motion)])?[0].unwrap())
}

/// A disc of half-width w at the distance d fills 2π(1 − 1/√(1 + (w/d)²)).
fn grown(inward: f64) -> Result<Answer, OpticsError> {
    let seen = moved(Vector3::x() * (0.9 * inward))?;
    let rest = moved(Vector3::zeros())?;
    let solid = |distance: Precise| 1.0 - 1.0 / ((0.01 / distance).squared() + 1.0).sqrt();
    let distance = 0.9 * (1.0 - Precise::new(inward));
    let truth = (solid(distance) / solid(Precise::new(0.9))).to_f64();
    // The equidistant picture enlarges areas by a sixth of the disc's angle squared.
    let width = 0.01 / (0.9 * (1.0 - inward));
    let answer = Answer::near(seen.size_px2 / rest.size_px2, truth);
    Ok(answer.within(1e-12 + width * width / 6.0))
}

/// Frame with all blemishes, without blur where pixels have no noise.
fn rendered(size_px: u32, markers: u32, pixel_std: f64) -> Result<Answer, OpticsError> {
    let places: Vec<_> = (0..markers)
        .map(|marker| [0.03 * f64::from(marker), 0.0])
        .collect();
    let (gores, width) = (4, 1e300);
    let blemishes = Blemishes {
        light_at_rim: 0.5,
        blur_px: if pixel_std > 0.0 { 16.0 } else { 0.0 },
        seams: Some(Seams { gores, width }),
        pixel_std,
    };
    let camera = Camera::new(Lens::Fisheye, size_px, 90.0)?;
    let array = array(1.0, &places, 0.02, 0.1)?.misaligned(1.0, 3)?;
    let optics = Optics::new(array, camera, Colours::default(), blemishes)?;
    let mut stream = Stream::new(1, 2, Channel::Misalignment);
    let motions = vec![Some(MarkerMotion::default()); places.len()];
    let frame = optics.rendered(&motions, Some(&mut stream))?;
    Ok(Answer::holds(frame.dimensions() == (size_px, size_px)))
}
