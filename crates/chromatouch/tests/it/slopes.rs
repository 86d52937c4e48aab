//! Compares the derivatives of the markers' features with central differences.

use nalgebra::Vector4;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, Departure, DiscMotion, Layout, Lens, MarkerArray, MarkerMotion,
    OddTerms, Optics, Pose, SeenMarker,
};
use palpate_sensing::{Channel, Stream};

use crate::optics::{depths, discs};

const RADIUS: f64 = 20.0;
const MARKERS: usize = 77;
const STEP: f64 = 1e-5;

/// A sensor with moved markers and with parameters that differ from their nominal values.
struct Scene {
    known: Optics,
    departure: [f64; Departure::NUMBERS],
    misalignments: Vec<[f64; 2]>,
    motions: Vec<[[f64; 3]; 2]>,
}

impl Scene {
    fn new(lens: Lens, pose: Option<Pose>, aside: f64) -> Self {
        let places = Layout::published().places(RADIUS).unwrap();
        let discs = discs(2.0, 2.2);
        let array = MarkerArray::new(RADIUS, &places, discs, depths(3.0, 1.0)).unwrap();
        let camera = Camera::new(lens, 640, 75.0).unwrap();
        let known = Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap();
        let mut stream = Stream::new(5, 5, Channel::Sensor);
        let mut draw = |size: f64| size * stream.symmetric_uniform();
        let mut departure: [f64; Departure::NUMBERS] = std::array::from_fn(|_| draw(0.01));
        if !matches!(lens, Lens::Odd(_)) {
            departure[19..].fill(0.0);
        }
        // With these misalignments, some pairs of discs overlap partly and others do not overlap.
        let misalignments = (0..MARKERS).map(|_| [aside + draw(0.03), 0.02 + draw(0.02)]);
        let misalignments = misalignments.collect();
        let mut motion = || [draw(0.5), draw(0.5), draw(0.5)];
        Self {
            known: match pose {
                Some(pose) => known.seen_from(pose).unwrap(),
                None => known,
            },
            departure,
            misalignments,
            motions: (0..MARKERS).map(|_| [motion(), motion()]).collect(),
        }
    }

    fn motions(&self) -> Vec<Option<MarkerMotion>> {
        let disc = |[normal, x, y]: [f64; 3]| DiscMotion {
            normal,
            tangential: [x, y],
            stretch: 0.01,
            skin_stretch: 0.02,
        };
        let marker = |[magenta, yellow]: &[[f64; 3]; 2]| {
            Some(MarkerMotion {
                magenta: disc(*magenta),
                yellow: disc(*yellow),
            })
        };
        self.motions.iter().map(marker).collect()
    }

    fn known(&self) -> Optics {
        self.known.misaligned(&self.misalignments).unwrap()
    }

    fn seen(&self) -> Vec<Option<SeenMarker>> {
        let departed = self
            .known()
            .departed(&Departure::from(self.departure))
            .unwrap();
        departed.project(&self.motions()).unwrap()
    }

    /// Central differences of the features of the visible markers with respect to the parameter that `change` changes.
    fn differences(&mut self, change: impl Fn(&mut Self, f64)) -> Vec<Option<Vector4<f64>>> {
        change(self, STEP);
        let more = self.seen();
        change(self, -2.0 * STEP);
        let less = self.seen();
        change(self, STEP);
        let pairs = more.iter().zip(&less);
        let slope = |(more, less): (&Option<SeenMarker>, &Option<SeenMarker>)| {
            let (more, less) = (more.as_ref()?, less.as_ref()?);
            let turn = more.hue_turns - less.hue_turns;
            let difference = Vector4::new(
                more.centroid_px[0] - less.centroid_px[0],
                more.centroid_px[1] - less.centroid_px[1],
                turn - turn.round(),
                libm::log(more.size_px2 / less.size_px2),
            );
            Some(difference / (2.0 * STEP))
        };
        pairs.map(slope).collect()
    }

    /// Compares computed derivatives of the features with central differences, for all markers that are visible after a
    /// step in either direction.
    fn compare(
        &mut self,
        what: &str,
        column: impl Fn(usize) -> Option<Vector4<f64>>,
        change: impl Fn(&mut Self, f64),
    ) {
        let differences = self.differences(change);
        let mut compared = 0;
        for (marker, difference) in differences.iter().enumerate() {
            let (Some(difference), Some(column)) = (difference, column(marker)) else {
                continue;
            };
            for row in 0..4 {
                let scale = [300.0, 300.0, 1.0, 1.0][row];
                let error = (column[row] - difference[row]).abs();
                let bound = 5e-5 * scale + 2e-5 * difference[row].abs();
                assert!(error < bound, "{what}, {marker}: {column} {difference}");
            }
            compared += 1;
        }
        assert!(compared > 60, "{what}: {compared}");
    }
}

#[test]
fn slopes_are_those_of_the_pictures() {
    let odd = Lens::Odd(OddTerms {
        k3: 0.05,
        k5: -0.01,
    });
    let pose = Pose::new([0.3, -0.5, 0.8], [0.02, -0.01, 0.03]);
    for (lens, pose, aside) in [
        (Lens::Fisheye, None, 0.0),
        (Lens::Fisheye, Some(pose), 0.05),
        (odd, Some(pose), 0.0),
        (Lens::Pinhole, Some(pose), 0.2),
    ] {
        let mut scene = Scene::new(lens, pose, aside);
        let known = if matches!(lens, Lens::Odd(_)) { 21 } else { 19 };
        let asked: Vec<usize> = (0..known).collect();
        let departure = Departure::from(scene.departure);
        let slopes = scene
            .known()
            .slopes(&departure, &scene.motions(), &asked)
            .unwrap();
        let seen = slopes.iter().map(|one| one.as_ref().map(|one| one.seen));
        assert_eq!(seen.collect::<Vec<_>>(), scene.seen());
        for &number in &asked {
            let column = |marker: usize| {
                let slopes = slopes[marker].as_ref()?;
                Some(slopes.by_departure.column(number).into())
            };
            scene.compare(&format!("departure {number}"), column, |scene, step| {
                scene.departure[number] += step;
            });
        }
        for axis in 0..2 {
            let column =
                |marker: usize| Some(slopes[marker].as_ref()?.by_misalignment.column(axis).into());
            scene.compare(&format!("misalignment {axis}"), column, |scene, step| {
                for misalignment in &mut scene.misalignments {
                    misalignment[axis] += step;
                }
            });
        }
        for disc in 0..2 {
            for component in 0..3 {
                let column = |marker: usize| {
                    let slopes = slopes[marker].as_ref()?;
                    Some(slopes.by_motion[disc].column(component).into())
                };
                let what = format!("motion {component} of disc {disc}");
                scene.compare(&what, column, |scene, step| {
                    for motion in &mut scene.motions {
                        motion[disc][component] += step;
                    }
                });
            }
        }
    }
}

/// Optics of markers at `places` on a skin with the radius `radius`. The discs are small and do not touch each other.
fn small(radius: f64, places: &[[f64; 2]]) -> Optics {
    let discs = discs(1.8e-3 * radius, 1.98e-3 * radius);
    let depths = depths(0.1 * radius, 0.1 * radius);
    let places: Vec<_> = (places.iter())
        .map(|place| place.map(|along| along * radius))
        .collect();
    let array = MarkerArray::new(radius, &places, discs, depths).unwrap();
    let camera = Camera::new(Lens::Fisheye, 2048, 80.0).unwrap();
    Optics::new(array, camera, Colours::default(), Blemishes::default()).unwrap()
}

/// A motion of a marker in which both discs have the same displacement. `normal` and `x` are displacements in units of
/// the skin's radius.
fn alike(radius: f64, normal: f64, x: f64) -> Option<MarkerMotion> {
    let disc = DiscMotion {
        normal: normal * radius,
        tangential: [x * radius, 0.0],
        ..DiscMotion::default()
    };
    Some(MarkerMotion {
        magenta: disc,
        yellow: disc,
    })
}

/// The image area of a small disc is proportional to (width / d)², where d is the disc's distance from the camera. If
/// the skin displaces the disc sideways by s, the disc's image shifts by the angle s / d₀, where d₀ is the distance at
/// rest. If the camera is displaced sideways by s, the image shifts by the angle s / d.
#[test]
fn slopes_on_skins_of_any_size_have_closed_forms() {
    let all: Vec<usize> = (0..Departure::NUMBERS).collect();
    for radius in [1e-45, 1.0, 1e45] {
        for inward in [0.0, 1e-300, 0.81] {
            let optics = small(radius, &[[0.0; 2]]);
            let motions = [alike(radius, inward, 0.0)];
            let slopes = optics.slopes(&Departure::default(), &motions, &all);
            let slopes = slopes.unwrap()[0].clone().unwrap();
            let distance = (0.9 - inward) * radius;
            let by_motion = slopes.by_motion[0] + slopes.by_motion[1];
            let size = slopes.by_departure.row(3);
            let px = optics.camera().px_per_rad() / (0.9 * radius);
            for (slope, due) in [
                (by_motion[(3, 0)] * distance, 2.0),
                ((size[0] + size[1]) * distance, 2.0),
                (size[2] + size[3], 2.0),
                (size[9] * distance, 2.0),
                (by_motion[(0, 1)] / px, 1.0),
                (by_motion[(1, 2)] / px, -1.0),
                (
                    slopes.by_departure[(0, 7)] * distance / (0.9 * radius * px),
                    -1.0,
                ),
            ] {
                // The closed-form derivatives are valid for small discs. Their error is of second order in the angular
                // size of the disc.
                assert!((slope - due).abs() < 3e-4, "{radius:e}: {slope}, not {due}");
            }
        }
    }
}

#[test]
fn impossible_slopes_have_named_errors() {
    let optics = small(1.0, &[[0.0, 0.0], [2.0, 0.0]]);
    let slopes = |motions: &[Option<MarkerMotion>], departure: Departure, asked: usize| {
        let found = optics.slopes(&departure, motions, &[asked]);
        found.map_err(<&str>::from)
    };
    let (rest, known) = (alike(1.0, 0.0, 0.0), Departure::default());
    // The first marker is missing, because its motion is `None`; the second marker lies outside the image.
    assert_eq!(slopes(&[None, rest], known, 0), Ok(vec![None, None]));
    assert_eq!(slopes(&[rest], known, 0), Err("wrong-count"));
    let beyond = slopes(&[rest; 2], known, Departure::NUMBERS);
    assert_eq!(beyond, Err("bad-setting"));
    for motion in [alike(1.0, 1.0, 0.0), alike(1.0, 0.0, f64::NAN)] {
        assert_eq!(slopes(&[motion, rest], known, 0), Err("impossible-motion"));
    }
    for number in 0..Departure::NUMBERS {
        let mut departure = [0.0; Departure::NUMBERS];
        departure[number] = f64::NAN;
        let due = if number < 2 {
            "bad-depth"
        } else {
            "bad-setting"
        };
        assert_eq!(slopes(&[rest; 2], Departure::from(departure), 0), Err(due));
    }
}
