//! Errors that the tracker states of markers, against frames of one sensor that differ by their pixels' noise.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, Discs, Layout, Lens, MarkerArray, MarkerMotion, Optics,
};
use palpate_sensing::{Channel, Stream};
use palpate_tracking::{Finder, FinderSettings, Ground, Mask};

/// Ratios of the scatter over frames to the stated standard deviations of centroid, hue and size, in the mean over
/// markers.
fn ratios(size_px: u32, pixel_std: f64) -> [f64; 4] {
    const FRAMES: u64 = 12;
    let places = Layout::published().places(20.0).expect("places");
    let (magenta, yellow) = (2.0, 2.0);
    let depths = DiscDepths {
        magenta: 3.0,
        yellow: 1.0,
    };
    let array = MarkerArray::new(20.0, &places, Discs { magenta, yellow }, depths);
    let array = array.and_then(|array| array.misaligned(0.2, 3));
    let camera = Camera::new(Lens::Fisheye, size_px, 65.0).expect("a camera");
    let blemishes = Blemishes {
        pixel_std,
        ..Blemishes::default()
    };
    let optics = Optics::new(
        array.expect("markers"),
        camera,
        Colours::default(),
        blemishes,
    );
    let optics = optics.expect("optics");
    let mask = Mask {
        centre_px: camera.centre_px(),
        radius_px: camera.rim_px(),
    };
    let mut finder = Finder::new(FinderSettings {
        mask: Some(mask),
        ground: Some(Ground::Bright),
        ..FinderSettings::default()
    })
    .expect("a finder");
    let motions = vec![Some(MarkerMotion::default()); places.len()];
    let frames: Vec<_> = (0..FRAMES)
        .map(|frame| {
            let mut noise = Stream::new(5, frame, Channel::Pixel);
            let frame = optics
                .rendered(&motions, Some(&mut noise))
                .expect("a frame");
            finder.find(&frame).expect("markers")
        })
        .collect();
    let (mut scatter, mut stated) = ([0.0; 4], [0.0; 4]);
    let [first, ..] = &frames[..] else {
        return [0.0; 4];
    };
    for marker in &first.markers {
        let mut sums = [[0.0; 2]; 4];
        for frame in &frames {
            let away = |other: &palpate_tracking::Marker| {
                let [x, y] = [0, 1].map(|axis| other.centroid_px[axis] - marker.centroid_px[axis]);
                libm::hypot(x, y)
            };
            let nearest = (0..frame.markers.len())
                .min_by(|one, other| {
                    away(&frame.markers[*one]).total_cmp(&away(&frame.markers[*other]))
                })
                .expect("markers");
            let found = &frame.markers[nearest];
            let turn = found.hue_turns - marker.hue_turns;
            let numbers = [
                found.centroid_px[0] - marker.centroid_px[0],
                found.centroid_px[1] - marker.centroid_px[1],
                turn - (turn + 0.5).floor(),
                libm::log(found.size_px2 / marker.size_px2),
            ];
            for (number, sums) in numbers.into_iter().zip(&mut sums) {
                sums[0] += number;
                sums[1] += number * number;
            }
            let covariance = frame.errors[nearest].covariance;
            for (number, stated) in stated.iter_mut().enumerate() {
                *stated += covariance[number][number] / FRAMES as f64;
            }
        }
        let count = FRAMES as f64;
        for (scatter, [sum, square]) in scatter.iter_mut().zip(sums) {
            *scatter += (square - sum * sum / count) / (count - 1.0);
        }
    }
    [0, 1, 2, 3].map(|number| (scatter[number] / stated[number]).sqrt())
}

#[test]
fn markers_scatter_over_frames_as_is_stated() {
    for (size_px, pixel_std) in [(480, 5.0), (640, 3.0)] {
        let ratios = ratios(size_px, pixel_std);
        // Eleven degrees of freedom of each of 77 markers tell a ratio to 2.5 %.
        for ratio in ratios {
            assert!((0.6..1.12).contains(&ratio), "{size_px} px: {ratios:?}");
        }
    }
}
