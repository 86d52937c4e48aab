//! Readings of pad arrays.

use nalgebra::{Vector2, Vector3};
use palpate_sensing::{Channel, PadLayout, PadOffset, Pads, Stream, displacement_between};
use proptest::prelude::*;

const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;

fn pads(pitch: f64, layout: PadLayout, offset: PadOffset) -> Pads {
    Pads::new(10.0, pitch, layout, offset, HALF_PI).unwrap()
}

fn read(pads: &Pads, trial: u64, displacement: Vector2<f64>) -> Vector2<f64> {
    let placement = pads.place(|| Stream::new(1, trial, Channel::PadOffset));
    pads.read(&placement, &displacement).unwrap()
}

#[test]
fn the_papers_reading_of_a_fifty_millimetre_sphere() {
    // R₁ = 10 mm, R₂ = 50 mm, 0.1 rad: 0.833 mm, of which both pads make 1 mm.
    let moved = 0.1 / (1.0 / 10.0 + 1.0 / 50.0);
    for pitch in [0.5, 1.0] {
        let pads = pads(pitch, PadLayout::Square, PadOffset::Centred);
        assert_eq!(
            read(&pads, 0, Vector2::new(moved, 0.0)),
            Vector2::new(1.0, 0.0)
        );
        assert_eq!(
            read(&pads, 0, Vector2::new(0.0, -moved)),
            Vector2::new(0.0, -1.0)
        );
    }
}

#[test]
fn beyond_the_cap_is_an_error() {
    for layout in [PadLayout::Square, PadLayout::Uniform] {
        let pads = Pads::new(10.0, 0.5, layout, PadOffset::Centred, 0.5).unwrap();
        let placement = pads.place(|| Stream::new(1, 0, Channel::PadOffset));
        assert!(pads.read(&placement, &Vector2::new(4.9, 0.0)).is_ok());
        let error = pads.read(&placement, &Vector2::new(4.0, 4.0)).unwrap_err();
        assert_eq!(error.name(), "beyond-pads");
        assert!((error.angle_rad - 0.32_f64.sqrt()).abs() < 1e-12);
    }
}

#[test]
fn centred_pads_draw_nothing() {
    for layout in [PadLayout::Square, PadLayout::Uniform] {
        let pads = pads(0.5, layout, PadOffset::Centred);
        pads.place(|| panic!("drew"));
        assert!(!pads.is_random());
    }
}

#[test]
fn quantisation_error_has_the_stated_size() {
    for layout in [PadLayout::Square, PadLayout::Uniform] {
        let pads = pads(0.5, layout, PadOffset::Random);
        let count = 20_000_u64;
        let displacement = Vector2::new(2.3, 1.1);
        let mean_square = (0..count)
            .map(|trial| (read(&pads, trial, displacement) - displacement).norm_squared())
            .sum::<f64>()
            / (2.0 * count as f64);
        // Ends are quantised independently only on the irregular lattice; on the square grid the
        // two ends share the grid, which makes the error anything up to that.
        let ratio = mean_square.sqrt() / pads.shift_std();
        assert!((0.7..1.15).contains(&ratio), "{layout:?}: {ratio}");
    }
}

#[test]
fn a_refusal_says_what_is_allowed() {
    let made = Pads::new(10.0, 11.0, PadLayout::Uniform, PadOffset::Centred, 1.0);
    assert_eq!(
        made.unwrap_err().to_string(),
        "pitch is 11; it must be > 0 and at most the probe's radius, 10"
    );
}

#[test]
fn directions_are_sensed_as_those_of_pads() {
    let poles = [
        Vector3::z(),
        -Vector3::z(),
        Vector3::new(0.36, -0.48, 0.8),
        Vector3::new(0.6, 0.0, -0.8),
    ];
    for (layout, offset) in [
        (PadLayout::Square, PadOffset::Centred),
        (PadLayout::Square, PadOffset::Random),
        (PadLayout::Uniform, PadOffset::Centred),
        (PadLayout::Uniform, PadOffset::Random),
    ] {
        let pads = pads(0.5, layout, offset);
        for (trial, pole) in poles.iter().enumerate() {
            let placement = pads.place(|| Stream::new(1, trial as u64, Channel::PadOffset));
            let sense = |direction: &Vector3<f64>| {
                pads.sensed_direction(&placement, pole, direction).unwrap()
            };
            let aside = pole.cross(&Vector3::y()).normalize();
            for turn in [0.0, 0.01, 0.02, 0.2, -0.7, 1.3_f64] {
                for lean in [0.0, 0.3, 0.8_f64] {
                    let along = aside * libm::cos(lean) + pole.cross(&aside) * libm::sin(lean);
                    let direction = pole * libm::cos(turn) + along * libm::sin(turn);
                    let once = sense(&direction);
                    assert!((once.norm() - 1.0).abs() < 1e-14);
                    // A pad senses its own centre, and it is near.
                    assert!(
                        (sense(&once) - once).norm() < 1e-13,
                        "{layout:?} {offset:?}"
                    );
                    let off = once.angle(&direction) * 10.0;
                    assert!(off < 1.05 * 0.5, "{layout:?} {offset:?}: {off}");
                }
            }
            // Directions from the same pad are not told apart, and the pole is on a centre if so
            // asked; shifts between pads are those that `read` reports.
            let (first, last) = (sense(pole), sense(&(pole * 0.8 + aside * 0.6)));
            if offset == PadOffset::Centred {
                assert!((first - pole).norm() < 1e-14, "{layout:?}");
                assert!((sense(&(pole + aside * 0.01).normalize()) - first).norm() < 1e-14);
                let contact = displacement_between(pole, &(pole * 0.8 + aside * 0.6)) * 10.0;
                let read = pads.read(&placement, &contact).unwrap();
                let between = displacement_between(pole, &last) * 10.0;
                assert!(
                    (read - between).norm() < 1e-12,
                    "{layout:?}: {read} {between}"
                );
            }
        }
    }
    let small = Pads::new(10.0, 0.5, PadLayout::Square, PadOffset::Centred, 0.5).unwrap();
    let placement = small.place(|| Stream::new(1, 0, Channel::PadOffset));
    let beyond = small.sensed_direction(&placement, &Vector3::z(), &Vector3::x());
    assert_eq!(beyond.unwrap_err().name(), "beyond-pads");
    let nowhere = Vector3::repeat(f64::NAN);
    assert!(
        small
            .sensed_direction(&placement, &Vector3::z(), &nowhere)
            .is_err()
    );
}

proptest! {
    #[test]
    fn a_reading_is_within_a_pad_of_the_contact(
        pitch in 0.01..2.0_f64,
        u in -7.0..7.0_f64,
        v in -7.0..7.0_f64,
        trial in 0..1000_u64,
    ) {
        let displacement = Vector2::new(u, v);
        for layout in [PadLayout::Square, PadLayout::Uniform] {
            for offset in [PadOffset::Centred, PadOffset::Random] {
                let pads = pads(pitch, layout, offset);
                let off = (read(&pads, trial, displacement) - displacement).norm();
                // Two quantisations, each within a pitch, seen through the map of the sphere.
                prop_assert!(off < 3.5 * pitch, "{layout:?} {offset:?}: {}", off / pitch);
            }
        }
    }
}
