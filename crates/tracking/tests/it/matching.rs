//! Tests the matching of markers between two frames. In these tests, the field `pixels` of a marker stores the number
//! of the true marker.

use palpate_tracking::{Marker, Status, Track, match_markers};

use crate::frames::Random;

const SPACING: f64 = 40.0;

fn marker(place: [f64; 2], number: u32) -> Marker {
    Marker {
        centroid_px: place,
        hue_turns: 0.05,
        mean_hue_turns: 0.1,
        size_px2: 300.0,
        pixels: number,
    }
}

fn lattice(random: &mut Random) -> Vec<Marker> {
    (0..90)
        .map(|number| {
            let (column, row) = (number % 10, number / 10);
            let x = SPACING * (f64::from(column) + 0.5 * f64::from(row % 2));
            let y = SPACING * 0.866 * f64::from(row);
            marker(
                [x, y].map(|at| at + random.uniform(-0.1, 0.1) * SPACING),
                number,
            )
        })
        .collect()
}

/// Moves the markers away from the point (190, 130), as a press moves the skin. The largest displacement is `most`
/// (px).
fn pressed(rest: &[Marker], most: f64) -> Vec<Marker> {
    let width = 2.5 * SPACING;
    rest.iter()
        .map(|marker| {
            let [x, y] = [marker.centroid_px[0] - 190.0, marker.centroid_px[1] - 130.0];
            // The displacement is largest at the distance `width` from the point (190, 130).
            let scale = most / width * libm::exp(0.5 - 0.5 * (x * x + y * y) / (width * width));
            Marker {
                centroid_px: [
                    marker.centroid_px[0] + scale * x,
                    marker.centroid_px[1] + scale * y,
                ],
                ..*marker
            }
        })
        .collect()
}

fn counts(tracks: &[Track]) -> [usize; 5] {
    [
        Status::Tracked,
        Status::Lost,
        Status::Merged,
        Status::Split,
        Status::New,
    ]
    .map(|status| tracks.iter().filter(|track| track.status == status).count())
}

fn assert_none_wrong(tracks: &[Track]) {
    for track in tracks {
        if let (Status::Tracked, Some(rest), Some(pressed)) =
            (track.status, track.rest, track.pressed)
        {
            assert_eq!(rest.pixels, pressed.pixels);
        }
    }
}

#[test]
fn moves_of_a_third_of_the_spacing_are_followed() {
    for seed in 0..50 {
        let rest = lattice(&mut Random(seed));
        let moved = pressed(&rest, SPACING / 3.0);
        for (a, b) in [(&rest, &moved), (&moved, &rest)] {
            let tracks = match_markers(a, b);
            assert_none_wrong(&tracks);
            assert_eq!(counts(&tracks), [90, 0, 0, 0, 0], "seed {seed}");
            let order: Vec<u32> = tracks
                .iter()
                .map(|track| track.rest.unwrap().pixels)
                .collect();
            assert!(order.into_iter().eq(0..90));
        }
    }
}

#[test]
fn a_tenth_removed_leads_to_no_wrong_match() {
    let (mut followed, mut both) = (0, 0);
    for seed in 0..200 {
        let mut random = Random(1000 + seed);
        let rest = lattice(&mut random);
        let moved = pressed(&rest, SPACING / 3.0);
        let mut thinned = |markers: &[Marker]| -> Vec<Marker> {
            markers
                .iter()
                .copied()
                .filter(|_| random.uniform(0.0, 1.0) > 0.1)
                .collect()
        };
        let (mut a, mut b) = (thinned(&rest), thinned(&moved));
        // Change the order of the markers in both frames, because the order must not change the result.
        a.reverse();
        b.sort_by_key(|marker| marker.pixels * 37 % 90);
        let tracks = match_markers(&a, &b);
        assert_none_wrong(&tracks);
        let [tracked, lost, merged, split, new] = counts(&tracks);
        assert_eq!((merged, split), (0, 0), "seed {seed}");
        assert_eq!((tracked + lost, tracked + new), (a.len(), b.len()));
        followed += tracked;
        both += a
            .iter()
            .filter(|a| b.iter().any(|b| a.pixels == b.pixels))
            .count();
    }
    assert!(followed as f64 > 0.99 * both as f64, "{followed} of {both}");
}

#[test]
fn merged_split_lost_and_new_markers_are_distinguished() {
    let rest = lattice(&mut Random(3));
    let mut moved = pressed(&rest, SPACING / 4.0);
    let both = |a: usize, b: usize, markers: &[Marker]| Marker {
        centroid_px: [0, 1]
            .map(|axis| 0.5 * (markers[a].centroid_px[axis] + markers[b].centroid_px[axis])),
        size_px2: 590.0,
        ..markers[a]
    };
    let blob = both(44, 45, &moved);
    moved[44] = blob;
    moved.remove(45);
    moved.retain(|marker| marker.pixels != 7);
    moved.push(marker([-60.0, 80.0], 500));

    let tracks = match_markers(&rest, &moved);
    assert_eq!(counts(&tracks), [87, 1, 2, 0, 1]);
    for at in [44, 45] {
        assert_eq!(
            (tracks[at].status, tracks[at].pressed),
            (Status::Merged, Some(blob))
        );
        assert_eq!(tracks[at].change(), None);
    }
    assert_eq!(tracks[7].status, Status::Lost);
    assert_eq!(tracks[90].pressed.unwrap().pixels, 500);

    let tracks = match_markers(&moved, &rest);
    assert_eq!(counts(&tracks), [87, 1, 0, 1, 1]);
    let split = tracks
        .iter()
        .find(|track| track.status == Status::Split)
        .unwrap();
    assert_eq!(split.rest, Some(blob));
    let together = split.pressed.unwrap();
    let middle = both(44, 45, &rest).centroid_px;
    assert!(
        libm::hypot(
            together.centroid_px[0] - middle[0],
            together.centroid_px[1] - middle[1]
        ) < 1e-9
    );
    assert_eq!(together.size_px2, 600.0);
}

#[test]
fn few_none_and_impossible_markers() {
    let one = [marker([5.0, 5.0], 1)];
    assert_eq!(match_markers(&[], &[]), []);
    assert_eq!(counts(&match_markers(&one, &[])), [0, 1, 0, 0, 0]);
    assert_eq!(counts(&match_markers(&[], &one)), [0, 0, 0, 0, 1]);
    assert_eq!(
        counts(&match_markers(&one, &[marker([9.0, 3.0], 1)])),
        [1, 0, 0, 0, 0]
    );
    let alike = [marker([5.0, 5.0], 1); 4];
    assert_eq!(
        match_markers(&alike, &alike)
            .iter()
            .filter(|track| track.rest.is_some())
            .count(),
        4
    );
    let broken = [
        marker([f64::NAN, 1.0], 1),
        marker([f64::INFINITY, 1.0], 2),
        Marker {
            size_px2: f64::NAN,
            ..marker([1e300, -1e300], 3)
        },
        marker([0.0, 0.0], 4),
    ];
    let tracks = match_markers(&broken, &broken);
    assert_eq!(tracks[0].status, Status::Lost);
    assert_eq!(tracks[3].status, Status::Tracked);
}

#[test]
fn lattices_of_any_size_are_followed() {
    for unit in [1e-150, 1e-9, 1e150] {
        let scaled = |markers: &[Marker]| -> Vec<Marker> {
            let scaled = markers.iter().map(|marker| Marker {
                centroid_px: marker.centroid_px.map(|at| at * unit),
                size_px2: marker.size_px2 * unit * unit,
                ..*marker
            });
            scaled.collect()
        };
        let rest = lattice(&mut Random(5));
        let moved = pressed(&rest, SPACING / 3.0);
        let tracks = match_markers(&scaled(&rest), &scaled(&moved));
        assert_none_wrong(&tracks);
        assert_eq!(counts(&tracks), [90, 0, 0, 0, 0], "{unit:e}");
    }
}
