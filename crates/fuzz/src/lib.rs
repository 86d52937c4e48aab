//! Fuzz targets for the readers of files: configs, formulas, readings, frames and calibrations.
//!
//! Each target reads arbitrary bytes as the content of a file, and panics if a reader violates one of the following
//! rules. A reader must return a result, or an error with a message. A result must not contain NaN or infinity. If the
//! result is written to a file and read again, it must be the same. `corpus/` contains inputs that reach different
//! parts of the code. The name of an input contains its expected outcome: `read-…` or `refused-…`. The tests replay the
//! inputs, check their outcomes, and replay variations of the inputs.

use std::collections::BTreeMap;
use std::fmt::{Debug, Display};

use palpate_geometry::Formula;
use palpate_recorded::{
    CalibrateOptions, GlideOptions, PressOptions, RecordedError, RecordedFile, RollOptions,
};
use palpate_study::config::{self, GlideEstimatorConfig, PressEstimatorConfig, StatedNoise};
use palpate_tracking::Finder;

/// A fuzz target: a function that reads one kind of file.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of the target, which is also the name of its folder in `corpus/`.
    pub name: &'static str,
    /// Reads the bytes as the content of a file. Panics if the reader violates one of the rules at the top of this
    /// module.
    pub run: fn(&[u8]) -> Outcome,
}

/// Outcome of a reader: the input was read, or it was rejected with this message.
pub type Outcome = Result<(), String>;

/// All fuzz targets, one for each kind of file.
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

/// Estimates of glides and presses are computed only from inputs with at most this number of lines. This limits the run
/// time of a target.
const MAX_ROWS: usize = 60;
/// Markers are detected only in frames with at most this number of pixels. This limits the run time of a target.
const MAX_PIXELS: u32 = 200 * 200;

/// Reads a study's config.
///
/// # Errors
/// Message of the reader if it rejects the input.
///
/// # Panics
/// If a config with all its defaults changes when it is written and read again, or an error has no message.
pub fn config(bytes: &[u8]) -> Outcome {
    let study = with_message(config::parse("fuzz.toml", text(bytes)?))?;
    let written = config::to_toml(&study.config);
    let again = config::parse("run.toml", &written);
    let again = again.unwrap_or_else(|error| panic!("{error}\nof\n{written}"));
    assert_eq!(config::to_toml(&again.config), written);
    assert_eq!(again.cell_count(), study.cell_count());
    assert!(again.cells().next() == study.cells().next(), "{written}");
    Ok(())
}

/// Parses the formula of a height field, and evaluates it at three points. The formula is parsed twice: with values of
/// two parameters, and without parameters.
///
/// # Errors
/// Message of the parser if both attempts fail.
///
/// # Panics
/// If `Formula::value` and `Formula::jet` return different heights at the same point, or an error has no message.
pub fn formula(bytes: &[u8]) -> Outcome {
    let text = text(bytes)?;
    let parameters = BTreeMap::from([("A".to_owned(), 0.15), ("k".to_owned(), 0.7)]);
    let parsed = |parameters| {
        let formula = Formula::parse(text, parameters).map_err(|error| {
            if let Some(span) = &error.span {
                assert!(text.get(span.clone()).is_some(), "{span:?} of {text:?}");
            }
            error.message
        });
        let formula = with_message(formula)?;
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

/// Reads recorded readings of rolls, of glides and of presses, and computes estimates from them.
///
/// # Errors
/// Message of the last reader if all readers reject the input.
///
/// # Panics
/// If an estimate is not finite, or an error has no message.
pub fn readings(bytes: &[u8]) -> Outcome {
    let file = || RecordedFile::new("fuzz.csv", bytes.to_vec());
    let is_short = bytes.iter().filter(|&&byte| byte == b'\n').count() <= MAX_ROWS;
    let roll = finite(palpate_recorded::RollRecording::try_from(file())).map(|readings| {
        let estimate = palpate_recorded::estimate_roll(readings, &RollOptions::new(1.0));
        let _ = finite(estimate).map(|estimate| {
            check_finite(&estimate);
        });
    });
    let glide = finite(palpate_recorded::GlideRecording::try_from(file())).map(|readings| {
        let options = GlideOptions {
            estimator: GlideEstimatorConfig::Quadric(StatedNoise::default()),
            grid: 3,
            ..GlideOptions::default()
        };
        if is_short {
            let _ = finite(palpate_recorded::estimate_glide(&readings, &options));
        }
    });
    let press = finite(palpate_recorded::PressRecording::try_from(file())).map(|readings| {
        let mut options = PressOptions {
            marker_depth: Some(2.0),
            indentation: Some(1.0),
            normal_std: Some(0.05),
            tangential_std: Some(0.02),
            ..PressOptions::new(20.0)
        };
        if let PressEstimatorConfig::HalfSpace { prior, .. } = &mut options.estimator {
            prior.indentation_std = 0.02;
        }
        if is_short {
            let _ = finite(palpate_recorded::estimate_press(&readings, &options));
        }
    });
    first_read([roll, glide, press])
}

/// Reads a frame of a camera and finds the markers in it.
///
/// # Errors
/// Message of the reader if it rejects the input, or of the marker finder if it finds no markers.
///
/// # Panics
/// If a marker is not finite, or an error has no message.
pub fn frame(bytes: &[u8]) -> Outcome {
    let file = RecordedFile::new("fuzz.png", bytes.to_vec());
    let frame = with_message(palpate_recorded::Frame::try_from(&file))?;
    if frame.image.width().saturating_mul(frame.image.height()) > MAX_PIXELS {
        return Ok(());
    }
    check_finite(&with_message(Finder::default().find(&frame.image))?);
    Ok(())
}

/// Reads the input as a calibration, as the points of a calibration, and as a camera.
///
/// # Errors
/// Message of the last reader if all readers reject the input.
///
/// # Panics
/// If a calibration or a camera is not finite or changes when it is written and read again, or if an error has no
/// message.
pub fn calibration(bytes: &[u8]) -> Outcome {
    let file = || RecordedFile::new("fuzz", bytes.to_vec());
    let points = finite(palpate_recorded::CalibrationPoints::try_from(&file())).map(|points| {
        let _ = finite(palpate_recorded::calibrate(
            &[points],
            &CalibrateOptions::default(),
        ));
    });
    let calibration =
        finite(palpate_recorded::parse_calibration(&file())).map(|(calibration, unit)| {
            let written = palpate_recorded::calibration_toml(&calibration, unit);
            let again = RecordedFile::new("again.toml", written.clone().into_bytes());
            let (again, unit) = palpate_recorded::parse_calibration(&again)
                .unwrap_or_else(|error| panic!("{error}\nof\n{written}"));
            assert_eq!(palpate_recorded::calibration_toml(&again, unit), written);
        });
    let camera = finite(palpate_recorded::CameraEstimate::try_from(&file())).map(|camera| {
        let again = RecordedFile::new("again.toml", camera.to_toml().into_bytes());
        let again = palpate_recorded::CameraEstimate::try_from(&again)
            .unwrap_or_else(|error| panic!("{error}\nof\n{}", camera.to_toml()));
        assert_eq!(again, camera);
    });
    first_read([points, calibration, camera])
}

fn text(bytes: &[u8]) -> Result<&str, String> {
    with_message(std::str::from_utf8(bytes))
}

/// Returns the first outcome of a reader that could read the input. If no reader could read it, returns the last
/// outcome.
fn first_read<const N: usize>(outcomes: [Outcome; N]) -> Outcome {
    outcomes.into_iter().reduce(Outcome::or).unwrap_or(Ok(()))
}

/// Returns the value that was read, or the error message. Panics if the message is empty.
fn with_message<T>(read: Result<T, impl Display>) -> Result<T, String> {
    read.map_err(|error| {
        let message = error.to_string();
        assert!(message.trim().len() > 10, "{message:?}");
        message
    })
}

/// Returns the value that was read, or the error message. Panics if the value contains a number that is not finite.
fn finite<T: Debug>(read: Result<T, RecordedError>) -> Result<T, String> {
    with_message(read).inspect(|value| check_finite(value))
}

fn check_finite(what: &impl Debug) {
    let text = format!("{what:?}");
    let words = |c: char| !c.is_alphanumeric();
    let odd = text
        .split(words)
        .find(|&word| word == "NaN" || word == "inf");
    assert!(odd.is_none(), "{odd:?} in {text}");
}
