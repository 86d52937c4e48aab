//! Fuzz targets for the readers of files: configs, formulas, readings, frames and calibrations.
//!
//! Each target takes arbitrary bytes as the contents of a file and panics where a reader breaks its promise. A reader
//! must return a result or an error with a message. A result must hold no number that is NaN or infinite, and what is
//! written from it must read back the same. `corpus/` holds inputs that reach different parts of the code, found by
//! coverage and named by what their reader says to them: `read-…` or `refused-…`. The tests replay them, hold the reader
//! to that name, and replay variations of them.

use std::collections::BTreeMap;
use std::fmt::{Debug, Display};

use palpate_geometry::formula::Formula;
use palpate_recorded::{
    CalibrateOptions, GlideOptions, PressOptions, RecordedError, RecordedFile, RollOptions,
};
use palpate_study::config::{self, GlideEstimatorConfig, PressEstimatorConfig};
use palpate_tracking::{Finder, FinderSettings};

/// A reader under test.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of the reader, also of the folder of its corpus.
    pub name: &'static str,
    /// Function that feeds bytes to the reader; it panics where the reader breaks its promise.
    pub run: fn(&[u8]) -> Verdict,
}

/// Verdict of a reader on its input: read, or refused with a message.
pub type Verdict = Result<(), String>;

/// All readers.
pub const TARGETS: [Target; 5] = [
    Target {
        name: "config",
        run: config,
    },
    Target {
        name: "formula",
        run: formula,
    },
    Target {
        name: "readings",
        run: readings,
    },
    Target {
        name: "frame",
        run: frame,
    },
    Target {
        name: "calibration",
        run: calibration,
    },
];

/// Lines of a file beyond which no estimate of a glide or press is made, to keep a target quick.
const MOST_ROWS: usize = 60;
/// Pixels of a frame beyond which no markers are sought in it.
const MOST_PIXELS: u32 = 200 * 200;

/// Reads a study's config.
///
/// # Errors
/// Message of the reader that refuses it.
///
/// # Panics
/// If a resolved config is not read back the same, or an error says nothing.
pub fn config(bytes: &[u8]) -> Verdict {
    let study = spoken(config::parse("fuzz.toml", text(bytes)?))?;
    let written = config::to_toml(&study.config);
    let again = config::parse("run.toml", &written);
    let again = again.unwrap_or_else(|error| panic!("{error}\nof\n{written}"));
    assert_eq!(config::to_toml(&again.config), written);
    assert_eq!(again.cell_count(), study.cell_count());
    assert!(again.cells().next() == study.cells().next(), "{written}");
    Ok(())
}

/// Parses and evaluates the formula of a height field, with two parameters and without any.
///
/// # Errors
/// Message of the parser, where neither is a formula.
///
/// # Panics
/// If value and jet differ, or an error says nothing.
pub fn formula(bytes: &[u8]) -> Verdict {
    let text = text(bytes)?;
    let parameters = BTreeMap::from([("A".to_owned(), 0.15), ("k".to_owned(), 0.7)]);
    let parsed = |parameters| {
        let formula = Formula::parse(text, parameters).map_err(|error| {
            if let Some(span) = error.span {
                assert!(text.get(span.clone()).is_some(), "{span:?} of {text:?}");
            }
            error.kind
        });
        let formula = spoken(formula)?;
        for [x, y] in [[0.0, 0.0], [0.3, -0.7], [-1e9, 1e-9]] {
            let (value, jet) = (formula.value(x, y), formula.jet(x, y));
            let same =
                value.to_bits() == jet.value.to_bits() || value.is_nan() && jet.value.is_nan();
            assert!(same, "{value} is not {} at {x}, {y}", jet.value);
        }
        Ok(())
    };
    first_read([parsed(&parameters), parsed(&BTreeMap::new())])
}

/// Reads recorded readings of rolls, glides and presses, and estimates from them.
///
/// # Errors
/// Message of the reader, where it is a reading of neither.
///
/// # Panics
/// If an estimate is not finite, or an error says nothing.
pub fn readings(bytes: &[u8]) -> Verdict {
    let file = || RecordedFile::new("fuzz.csv", bytes.to_vec());
    let is_short = bytes.iter().filter(|&&byte| byte == b'\n').count() <= MOST_ROWS;
    let roll = whole(palpate_recorded::parse_roll(file())).map(|readings| {
        let _ = whole(palpate_recorded::estimate_roll(
            &readings,
            &RollOptions::new(1.0),
        ));
    });
    let glide = whole(palpate_recorded::parse_glide(file())).map(|readings| {
        let options = GlideOptions {
            estimator: GlideEstimatorConfig::Quadric {
                position_std: None,
                position_fraction_of_ifd: None,
                normal_std_deg: None,
            },
            grid: 3,
            ..GlideOptions::default()
        };
        if is_short {
            let _ = whole(palpate_recorded::estimate_glide(&readings, &options));
        }
    });
    let press = whole(palpate_recorded::parse_press(file())).map(|readings| {
        let mut options = PressOptions {
            marker_depth: Some(2.0),
            indentation: Some(1.0),
            normal_std: Some(0.05),
            tangential_std: Some(0.02),
            ..PressOptions::new(20.0)
        };
        if let PressEstimatorConfig::HalfSpace {
            indentation_std, ..
        } = &mut options.estimator
        {
            *indentation_std = 0.02;
        }
        if is_short {
            let _ = whole(palpate_recorded::estimate_press(&readings, &options));
        }
    });
    first_read([roll, glide, press])
}

/// Reads a frame of a camera and finds the markers in it.
///
/// # Errors
/// Message of the reader that refuses it, or of the finder that sees no markers.
///
/// # Panics
/// If a marker is not finite, or an error says nothing.
pub fn frame(bytes: &[u8]) -> Verdict {
    let file = RecordedFile::new("fuzz.png", bytes.to_vec());
    let frame = spoken(palpate_recorded::parse_frame(&file))?;
    if frame.image.width().saturating_mul(frame.image.height()) > MOST_PIXELS {
        return Ok(());
    }
    let finder = Finder::new(FinderSettings::default());
    let mut finder = finder.expect("the default settings are good");
    is_finite(&spoken(finder.find(&frame.image))?);
    Ok(())
}

/// Reads a calibration, points to make one from, and a camera.
///
/// # Errors
/// Message of the reader, where it is none of these.
///
/// # Panics
/// If a calibration or a camera is not read back the same, is not finite, or an error says nothing.
pub fn calibration(bytes: &[u8]) -> Verdict {
    let file = || RecordedFile::new("fuzz", bytes.to_vec());
    let points = whole(palpate_recorded::parse_calibration_points(&file())).map(|points| {
        let _ = whole(palpate_recorded::calibrate(
            &[points],
            &CalibrateOptions::default(),
        ));
    });
    let calibration =
        whole(palpate_recorded::parse_calibration(&file())).map(|(calibration, unit)| {
            let written = palpate_recorded::calibration_toml(&calibration, unit);
            let again = RecordedFile::new("again.toml", written.clone().into_bytes());
            let (again, unit) = palpate_recorded::parse_calibration(&again)
                .unwrap_or_else(|error| panic!("{error}\nof\n{written}"));
            assert_eq!(palpate_recorded::calibration_toml(&again, unit), written);
        });
    let camera = whole(palpate_recorded::parse_camera(&file())).map(|camera| {
        let again = RecordedFile::new("again.toml", camera.to_toml().into_bytes());
        let again = palpate_recorded::parse_camera(&again)
            .unwrap_or_else(|error| panic!("{error}\nof\n{}", camera.to_toml()));
        assert_eq!(again, camera);
    });
    first_read([points, calibration, camera])
}

fn text(bytes: &[u8]) -> Result<&str, String> {
    spoken(std::str::from_utf8(bytes))
}

/// Verdict of the first reader that read the input; of the last one, where none did.
fn first_read<const N: usize>(verdicts: [Verdict; N]) -> Verdict {
    verdicts.into_iter().reduce(Verdict::or).unwrap_or(Ok(()))
}

/// Value that was read, or the message, which says something.
fn spoken<T>(read: Result<T, impl Display>) -> Result<T, String> {
    read.map_err(|error| {
        let message = error.to_string();
        assert!(message.trim().len() > 10, "{message:?}");
        message
    })
}

/// Value that was read, all of whose numbers are finite.
fn whole<T: Debug>(read: Result<T, RecordedError>) -> Result<T, String> {
    spoken(read).inspect(|whole| is_finite(whole))
}

fn is_finite(what: &impl Debug) {
    let text = format!("{what:?}");
    let words = |c: char| !c.is_alphanumeric();
    let odd = text
        .split(words)
        .find(|&word| word == "NaN" || word == "inf");
    assert!(odd.is_none(), "{odd:?} in {text}");
}
