//! Slopes of pictures, on skins of all sizes, against closed forms.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, Departure, DiscDepths, DiscMotion, Discs, Lens, MarkerArray,
    MarkerMotion, MarkerSlopes, Optics, OpticsError,
};
use palpate_verdict::{Answer, NOT_FINITE, rows};

const SLOPES: &str = "chromatouch::Optics::slopes";
/// Radii of the skin, length.
const RADII: [f64; 5] = [1e-45, 1e-9, 1.0, 1e9, 1e45];
/// Distance of the discs from the centre, in radii of the skin, and their radii, in that distance.
const DISTANCE: f64 = 0.9;
const WIDTHS: [f64; 2] = [1e-3, 1.1e-3];
/// Error that the documentation of `Optics::slopes` allows, as a share of the largest slope.
const BOUND: f64 = 5e-5;
const APEX: [[f64; 2]; 1] = [[0.0; 2]];
/// Number of a departure, and the row of the size.
const PX_PER_RAD: usize = 6;
const SIZE: usize = 3;
/// Numbers of a departure: depths, then all others.
const DEPTHS: std::ops::Range<usize> = 0..2;
const OTHERS: std::ops::Range<usize> = 2..Departure::NUMBERS;
const NO_STEPS: [f64; 4] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e300];

rows! {
    SLOPES, "pixels per radian, {more:e} more of them, radii 1e-45 to 1e45" => by_pixels(more),
        for more in [-0.55, -1e-12, 0.0, 1e-300, 0.3];
    SLOPES, "image's centre: all pictures move alike, radius {radius:e}" => by_centre(radius), for radius in RADII;
    SLOPES, "motion inward, after {inward:e} of the way to the camera, radii 1e-45 to 1e45" => by_inward(inward),
        for inward in [0.0, 1e-300, 1e-9, 0.5, 0.9, 0.99];
    SLOPES, "depth, width and nearness of the camera, radius {radius:e}: the size's" => by_width(radius),
        for radius in RADII;
    SLOPES, "motion along the skin and of the camera, radius {radius:e}: the centroid's" => by_way(radius),
        for radius in RADII;
    SLOPES, "no markers: 1 where there are no slopes" => sensor(1.0, &[]).slopes(&Departure::default(), &[], &all())
        .map(|slopes| Answer::holds(slopes.is_empty()));
    SLOPES, "marker without motion, and one outside the image: 1 where neither is seen" => unseen();
    SLOPES, "motion number {place} is {bad:e}", "impossible-motion" => moved(place, bad),
        for bad in NOT_FINITE.into_iter().chain([1.0, -1.0, 1e300]), for place in 0..3;
    SLOPES, "asked for number {number}", "bad-setting" => of_one(1.0, [0.0; 3], &[number]),
        for number in [Departure::NUMBERS, usize::MAX];
    SLOPES, "motions of {motions} markers of 1", "wrong-count" =>
        sensor(1.0, &APEX).slopes(&Departure::default(), &vec![None; motions], &all()), for motions in [0, 2];
    SLOPES, "number {number} of the departure is {bad:e}", "bad-depth" => departed(number, bad),
        for number in DEPTHS, for bad in NO_STEPS;
    SLOPES, "number {number} of the departure is {bad:e}", "bad-setting" => departed(number, bad),
        for number in OTHERS, for bad in NO_STEPS;
}

/// Markers on a skin of this radius, at places in radii, before a fisheye of 2048 px. The edges of their discs do not touch.
fn sensor(radius: f64, places: &[[f64; 2]]) -> Optics {
    let [magenta, yellow] = WIDTHS.map(|width| 2.0 * width * DISTANCE * radius);
    let depth = (1.0 - DISTANCE) * radius;
    let depths = DiscDepths {
        magenta: depth,
        yellow: depth,
    };
    let places: Vec<_> = (places.iter())
        .map(|place| place.map(|along| along * radius))
        .collect();
    let discs = Discs { magenta, yellow };
    let array = MarkerArray::new(radius, &places, discs, depths).unwrap();
    let camera = Camera::new(Lens::Fisheye, 2048, 80.0).unwrap();
    Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap()
}

fn all() -> Vec<usize> {
    (0..Departure::NUMBERS).collect()
}

/// Both discs moved alike, inward and sideways, length.
fn both([normal, x, y]: [f64; 3]) -> MarkerMotion {
    let disc = DiscMotion {
        normal,
        tangential: [x, y],
        ..DiscMotion::default()
    };
    MarkerMotion {
        magenta: disc,
        yellow: disc,
    }
}

/// Slopes of one marker, at the apex, after a motion.
fn of_one(radius: f64, motion: [f64; 3], asked: &[usize]) -> Result<MarkerSlopes, OpticsError> {
    let motions = [Some(both(motion))];
    let slopes = sensor(radius, &APEX).slopes(&Departure::default(), &motions, asked)?;
    Ok(slopes[0].clone().unwrap())
}

fn moved(place: usize, bad: f64) -> Result<MarkerSlopes, OpticsError> {
    let mut motion = [0.0; 3];
    motion[place] = bad;
    of_one(1.0, motion, &all())
}

fn departed(number: usize, bad: f64) -> Result<Vec<Option<MarkerSlopes>>, OpticsError> {
    let mut departure = [0.0; Departure::NUMBERS];
    departure[number] = bad;
    sensor(1.0, &APEX).slopes(&Departure::of(departure), &[Some(both([0.0; 3]))], &all())
}

/// All lengths in the image are proportional to the pixels per radian, in which a fisheye shows angles from the apex.
fn by_pixels(more: f64) -> Result<Answer, OpticsError> {
    let departure = Departure {
        px_per_rad: more,
        ..Departure::default()
    };
    let places = [[0.0, 0.0], [0.5, 0.0], [0.0, 1.0]];
    let mut pairs = Vec::new();
    for radius in RADII {
        let sensor = sensor(radius, &places);
        let slopes = sensor.slopes(&departure, &[Some(both([0.0; 3])); 3], &[PX_PER_RAD])?;
        for (slopes, [x, y]) in slopes.into_iter().map(Option::unwrap).zip(places) {
            let slope = slopes.by_departure.column(PX_PER_RAD);
            let per_px = sensor.camera().px_per_rad().recip();
            pairs.extend([(slope[0] * per_px, x), (slope[1] * per_px, -y)]);
            pairs.push((slope[SIZE] * (1.0 + more), 2.0));
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(BOUND))
}

fn by_centre(radius: f64) -> Result<Answer, OpticsError> {
    let by = of_one(radius, [0.0; 3], &[4, 5])?.by_departure;
    let slopes = by.iter().copied();
    let truth = |at: usize| f64::from(u8::from([(0, 4), (1, 5)].contains(&(at % 4, at / 4))));
    let pairs = slopes.enumerate().map(|(at, slope)| (slope, truth(at)));
    Ok(Answer::all_at_scale(pairs, 1.0))
}

/// Areas of small discs fall with the square of their distance; those of wider ones less, by the square of their angle.
fn by_inward(inward: f64) -> Result<Answer, OpticsError> {
    let mut pairs = Vec::new();
    for radius in RADII {
        let distance = DISTANCE * radius;
        let slopes = of_one(radius, [inward * distance, 0.0, 0.0], &[])?;
        let [magenta, yellow] = slopes.by_motion;
        let slope = (magenta + yellow)[(SIZE, 0)];
        pairs.push((slope * distance * (1.0 - inward), 2.0));
    }
    let angle = WIDTHS[1] / (1.0 - inward);
    Ok(Answer::all_near(pairs).within(BOUND + angle * angle))
}

/// The size grows with the square of the angle that a disc is wide.
fn by_width(radius: f64) -> Result<Answer, OpticsError> {
    let by = of_one(radius, [0.0; 3], &all())?.by_departure;
    let size = by.row(SIZE);
    let distance = DISTANCE * radius;
    let slopes = [
        (size[0] + size[1]) * distance,
        size[2] + size[3],
        size[9] * distance,
    ];
    Ok(Answer::all_near(slopes.map(|slope| (slope, 2.0))).within(BOUND))
}

/// Ways over the distance are angles, by which a fisheye shows the apex away from the image's centre, rows down.
fn by_way(radius: f64) -> Result<Answer, OpticsError> {
    let MarkerSlopes {
        by_departure,
        by_motion: [magenta, yellow],
        ..
    } = of_one(radius, [0.0; 3], &all())?;
    let along = magenta + yellow;
    let mut pairs = Vec::new();
    for axis in 0..2 {
        let [mut by_skin, mut by_camera] = [[0.0; 2]; 2];
        let one = [1.0, -1.0][axis];
        (by_skin[axis], by_camera[axis]) = (one, -one);
        for row in 0..2 {
            pairs.push((along[(row, 1 + axis)], by_skin[row]));
            pairs.push((by_departure[(row, 7 + axis)], by_camera[row]));
        }
    }
    let px = sensor(radius, &[]).camera().px_per_rad() / (DISTANCE * radius);
    let pairs = pairs.into_iter().map(|(slope, truth)| (slope / px, truth));
    Ok(Answer::all_at_scale(pairs, 1.0).within(BOUND))
}

fn unseen() -> Result<Answer, OpticsError> {
    let sensor = sensor(1.0, &[[0.0, 0.0], [2.0, 0.0]]);
    let motions = [None, Some(both([0.0; 3]))];
    let slopes = sensor.slopes(&Departure::default(), &motions, &all())?;
    Ok(Answer::holds(slopes.iter().all(Option::is_none)))
}
