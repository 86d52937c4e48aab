//! The tracker states standard errors of the markers. These tests compare the standard errors with the scatter of the
//! markers in frames that differ only in pixel noise.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, Discs, Layout, Lens, MarkerArray, MarkerMotion, Optics,
};
use palpate_tracking::{Finder, Found, Ground, Marker, Mask};

/// A sensor at rest. `Look` renders its frames and finds the markers in them.
struct Look {
    optics: Optics,
    motions: Vec<Option<MarkerMotion>>,
    finder: Finder,
}

impl Look {
    /// A sensor with the layout of the 2020 paper and with misaligned discs. The centre of the lens is `offset_px` away
    /// from the centre of the frame.
    fn new(size_px: u32, pixel_std: f64, misalignment: f64, offset_px: [f64; 2]) -> Self {
        let places = Layout::published().places(20.0).expect("places");
        let (magenta, yellow) = (2.0, 2.0);
        let depths = DiscDepths {
            magenta: 3.0,
            yellow: 1.0,
        };
        let array = MarkerArray::new(20.0, &places, Discs { magenta, yellow }, depths);
        let array = array.and_then(|array| array.misaligned(misalignment, 3, 0));
        let camera = Camera::new(Lens::Fisheye, size_px, 65.0).expect("a camera");
        let camera = camera
            .adjusted(offset_px, camera.px_per_rad())
            .expect("a camera");
        let blemishes = Blemishes {
            pixel_std,
            ..Blemishes::default()
        };
        let array = array.expect("markers");
        let mask = Mask {
            centre_px: camera.centre_px(),
            radius_px: 0.5 * f64::from(camera.size_px()),
        };
        Self {
            optics: Optics::new(array, camera, Colours::default(), blemishes).expect("optics"),
            motions: vec![Some(MarkerMotion::default()); places.len()],
            finder: Finder::new(Some(mask), Some(Ground::Bright)),
        }
    }

    fn found(&mut self, frame: u64) -> Found {
        let frame = self.optics.render(&self.motions, Some((5, frame)));
        let found = self.finder.find(&frame.expect("a frame"));
        found.expect("markers")
    }

    fn projected(&self) -> Vec<[f64; 4]> {
        let seen = self.optics.project(&self.motions).expect("a projection");
        let numbers = seen.into_iter().flatten().map(|seen| {
            let [x, y] = seen.centroid_px;
            [x, y, seen.hue_turns, libm::log(seen.size_px2)]
        });
        numbers.collect()
    }
}

/// Returns two results for a marker whose expected image is `at`. First, the differences between this image and the
/// nearest found marker: in x and y (px), in hue (turns), and in the logarithm of the size. Second, the index of the
/// nearest found marker.
fn beyond(found: &Found, at: &[f64; 4]) -> ([f64; 4], usize) {
    let away = |marker: &Marker| {
        let [x, y] = [0, 1].map(|axis| marker.centroid_px[axis] - at[axis]);
        libm::hypot(x, y)
    };
    let nearest = (0..found.markers.len())
        .min_by(|one, other| away(&found.markers[*one]).total_cmp(&away(&found.markers[*other])))
        .expect("markers");
    let marker = &found.markers[nearest];
    let [x, y] = marker.centroid_px;
    let turn = marker.hue_turns - at[2];
    let numbers = [
        x - at[0],
        y - at[1],
        turn - (turn + 0.5).floor(),
        libm::log(marker.size_px2) - at[3],
    ];
    (numbers, nearest)
}

/// Errors of the markers in several frames: mean error (bias), scatter about the mean, and standard deviation that the
/// tracker states. Each of these numbers is the root mean square over all markers. The frames differ only in pixel
/// noise.
#[derive(Debug, Default)]
struct Errors {
    bias: [f64; 4],
    scatter: [f64; 4],
    stated: [f64; 4],
}

fn errors(looks: &mut [Look], frames: u64) -> Errors {
    let mut errors = Errors::default();
    let mut markers = 0.0;
    for look in looks {
        let found: Vec<Found> = (0..frames).map(|frame| look.found(frame)).collect();
        for at in look.projected() {
            // The tracker does not find markers that touch another marker or the rim of the image. These markers are
            // left out.
            let is_there = |found: &Found| {
                let ([x, y, ..], _) = beyond(found, &at);
                libm::hypot(x, y) < 1.0
            };
            if !found.iter().all(is_there) {
                continue;
            }
            markers += 1.0;
            let mut sums = [[0.0; 2]; 4];
            for found in &found {
                let (numbers, nearest) = beyond(found, &at);
                let covariance = found.errors[nearest].covariance;
                for number in 0..4 {
                    sums[number][0] += numbers[number];
                    sums[number][1] += numbers[number] * numbers[number];
                    errors.stated[number] += covariance[number][number] / frames as f64;
                }
            }
            let count = frames as f64;
            for (number, [sum, square]) in sums.into_iter().enumerate() {
                let variance = (square - sum * sum / count) / (count - 1.0);
                errors.scatter[number] += variance;
                errors.bias[number] += (sum / count).powi(2) - variance / count;
            }
        }
    }
    for of in [&mut errors.bias, &mut errors.scatter, &mut errors.stated] {
        *of = of.map(|square: f64| (square.max(0.0) / markers).sqrt());
    }
    errors
}

/// Several sensors whose markers have different positions relative to the pixels.
fn looks(size_px: u32, pixel_std: f64, misalignment: f64) -> Vec<Look> {
    let offsets = [[0.0, 0.0], [0.31, -0.44], [-0.17, 0.23], [0.48, 0.12]];
    offsets
        .map(|offset| Look::new(size_px, pixel_std, misalignment, offset))
        .into()
}

/// Tests the bias of markers in frames: if the pixel noise is 3 levels (of 255), the bias is less than half of the
/// scatter. This is true for all positions of the markers relative to the pixels.
#[test]
fn markers_are_where_they_are_projected() {
    for (size_px, misalignment) in [(400, 0.0), (400, 0.3), (1024, 0.0)] {
        let Errors { bias, scatter, .. } = errors(&mut looks(size_px, 3.0, misalignment), 6);
        for number in 0..4 {
            assert!(
                bias[number] < 0.5 * scatter[number],
                "{size_px} px, {misalignment}: {bias:?} {scatter:?}"
            );
        }
    }
}

#[test]
fn the_stated_errors_of_markers_equal_their_scatter() {
    for (size_px, pixel_std) in [(480, 5.0), (640, 3.0), (700, 1.0)] {
        let mut look = [Look::new(size_px, pixel_std, 0.2, [0.0; 2])];
        let Errors {
            scatter, stated, ..
        } = errors(&mut look, 12);
        let ratios = [0, 1, 2, 3].map(|number| scatter[number] / stated[number]);
        // The scatter is computed from 12 frames, so each of the 77 markers has 11 degrees of freedom. Therefore the
        // relative standard error of the ratio (scatter to stated error) is 1/√(2 · 77 · 11), about 2.5 %.
        for ratio in ratios {
            assert!((0.75..1.08).contains(&ratio), "{size_px} px: {ratios:?}");
        }
    }
}

/// Tests the bias of the mean hue in frames, which arises because pixels at the edges of discs mix two colours. The
/// bias is smaller if the pixels are smaller.
#[test]
fn mean_hues_of_frames_have_the_bias_of_their_edges() {
    for (size_px, bias, scatter) in [(265, 0.0..0.006, 0.010), (1060, 0.0..0.003, 0.002)] {
        let mut differences = Vec::new();
        for offset in [0.2, 0.4, 0.8] {
            let mut look = Look::new(size_px, 0.0, 0.0, [0.31, -0.44]);
            look.optics = offset_discs(&look.optics, offset);
            let found = look.found(0);
            let seen = look.optics.project(&look.motions).expect("a projection");
            for seen in seen.into_iter().flatten() {
                let [x, y] = seen.centroid_px;
                let (_, nearest) = beyond(&found, &[x, y, 0.0, 0.0]);
                let measured = found.markers[nearest].mean_hue_turns;
                differences.push(measured - seen.mean_hue_turns);
            }
        }
        let count = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / count;
        let squares = differences.iter().map(|one| (one - mean).powi(2));
        let std = (squares.sum::<f64>() / count).sqrt();
        // In each of the three frames, the rim of the image cuts a few of the 77 markers. These markers are left out.
        assert!(count > 220.0, "{count}");
        assert!(bias.contains(&mean), "{size_px}: {mean} {std}");
        assert!(std < scatter, "{size_px}: {mean} {std}");
    }
}

/// A sensor whose discs are all at the same depth. The yellow discs are displaced sideways by the length `offset`, in
/// another direction for each marker.
fn offset_discs(optics: &Optics, offset: f64) -> Optics {
    let (magenta, yellow) = (2.0, 2.0);
    let depths = DiscDepths { magenta, yellow };
    let places = optics.array().places();
    let array = MarkerArray::new(20.0, places, Discs { magenta, yellow }, depths);
    let (array, colours) = (array.expect("markers"), Colours::default());
    let optics = Optics::new(array, *optics.camera(), colours, Blemishes::default());
    let angle = offset / (20.0 - yellow);
    let directions = (0..77).map(|marker| libm::sincos(2.4 * f64::from(marker)));
    let offsets: Vec<[f64; 2]> = directions.map(|(y, x)| [angle * x, angle * y]).collect();
    optics
        .and_then(|optics| optics.misaligned(&offsets))
        .expect("optics")
}
