//! Defines the arguments of `palpate sensor`.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use palpate_recorded::NormalFrom;

use super::estimate_args::FormArgs;
use super::estimate_args::{SensorArgs, tables};
use super::settings::{not_negative, positive};

#[derive(Debug, Subcommand)]
pub(crate) enum SensorCommand {
    /// Draw the flat pattern for cutting a sensor's skin: writes pattern.svg, pattern.dxf and the strain of folding.
    #[command(
        after_help = "The config must describe a press or a fingertip whose layout has gores (the flat pieces from which the skin is
made) and whose probe has discs. pattern.svg and pattern.dxf are in millimetres, with the outlines of the
gores (CUT), fold and seam marks (FOLD) and the discs of both layers (MAGENTA, YELLOW). strain.csv has the
strain of folding at points of half a gore. strain-by-gores.csv has the largest strain and the rms strain for
3 to 12 gores.

Example:
  palpate sensor pattern examples/press-with-a-camera.toml --out out/pattern"
    )]
    Pattern(PatternArgs),
    /// Calibrate hue, size and centroid of markers against known displacements.
    #[command(after_help = CALIBRATE_HELP)]
    Calibrate(CalibrateArgs),
    /// Match the markers of a pressed frame with those of a frame at rest, and estimate the curvature of the pressed
    /// object.
    #[command(after_help = TRACK_HELP)]
    Track(TrackArgs),
}

const CALIBRATE_HELP: &str = concat!("Tables have one row per known displacement. The columns for a marker that is displaced inward are
  normal_displacement_mm,hue_turns,growth
where hue_turns is the change of the marker's hue and growth the change of the logarithm of its diameter. One of
these two columns may be missing. The columns for a marker that is displaced along the skin are
  tangential_displacement_mm,centroid_shift_px
A table may have the columns of both kinds. The optional columns `series` and `marker` contain the index of
the series of presses and the index of the marker. Several tables are fitted together. If a row for a displacement along the
skin also has a normal displacement, the shift in px per length is fitted as a function of the normal displacement.

", tables!(), "Other columns are ignored. One of the tables may be -, standard input.

Frames are PNG, JPEG, BMP, TIFF or WebP images. The first frame is at rest. For each other frame, --normal and
--tangential state the displacement of the marker that changes most.

The command fits a line with an intercept to all points and to each series, as in the paper of Lin et al. (2020). It
also fits a line through the origin to all points, because the signal is 0 at rest. `track` computes displacements from
this line. For each line, the command prints the slope with its standard error, R^2 and the residual. It warns of large
residuals, of slopes that may be 0, and of series with different slopes. It cannot detect that all displacements are
wrong by a common factor.

With --rest and --layout, the camera is calibrated by one frame at rest with the markers of a study's sensor. The result
has place, turn, px per rad and odd terms of the lens, with standard deviations and covariance. The covariance is in the
order: image's centre (px), px per rad (share), place (length), turn (rad), odd terms. The result also has the distance
of each marker from its expected position. An odd term of the lens keeps the study's value unless the frame determines
the term to half of its prior standard deviation.

Examples:
  palpate sensor calibrate examples/chromatouch-2020/calibration-normal.csv \\
    examples/chromatouch-2020/calibration-tangential.csv --out calibration.toml
  palpate sensor calibrate rest.png pressed-1.png pressed-2.png --normal 0.5,1.0 \\
    --length-unit mm --from size --out calibration.toml
  palpate sensor calibrate --rest rest.png --layout examples/press-with-a-camera.toml \\
    --out camera.toml");

const TRACK_HELP: &str = "Frames are PNG, JPEG, BMP, TIFF or WebP images of the same size, with 8 or 16 bits, grey, palette or RGB. An alpha
channel is allowed if nothing is transparent. With --like, the central square of the frames is used. The command writes
to DIR
  markers.csv     marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status,mean_hue_turns,dmean_hue_turns
  overlay.png     the pressed frame with a circle around each marker: blue tracked, red lost, orange merged,
                  violet split, cyan new, grey cut by the rim at rest; arrows are 5 times the shifts
  difference.png  magenta where green light was lost, green where it was gained
and with a calibration also
  readings.csv    displacements of the tracked markers, a table that `palpate estimate press` accepts
  field.csv       the same displacements on a regular grid, by natural-neighbour interpolation
It then prints the estimate of `palpate estimate press` as JSON, with counts of the markers and the mean displacement
outward from the contact. A soft layer on a rigid core is not a half-space: use --method bonded-layer --thickness H. With
--like STUDY.toml, sensor and estimator come from a study of kind press; flags override them. The command warns as
`estimate press` does, and if --px-per-rad differs from the calibration. If there is no estimate, the tables are still
written, and the status is 1.

--method image --like STUDY.toml fits a press to centroid, hue and size of each marker, whose errors are estimated from
the frames. Layout, discs, body, camera and noise come from the study, which must be a press with a camera. With
--calibration, the camera is the one that `sensor calibrate --rest` wrote. The outputs are the same. readings.csv has the
displacement of each marker in the estimated press, corrected by the image of this marker. Without an estimate,
readings.csv is not written.

The other methods assume that the camera looks at the apex from the sensor's centre, through a fisheye lens with
r = f angle. The columns of the image run along x, the rows against y.

Examples:
  palpate sensor track rest.png pressed.png --out out/track
  palpate sensor track rest.png pressed.png --calibration calibration.toml --sensor-radius 20 \\
    --depth 2 --indentation 1.4 --indentation-std 0.02 --out out/track
  palpate sensor track rest.png pressed.png --like examples/press-with-a-camera.toml --cell 2 \\
    --method image --indentation 1 --indentation-std 0.02 --out out/track";

#[derive(Debug, Args)]
pub(crate) struct PatternArgs {
    /// The study's config, a TOML file; if the study has a sweep, its first cell is drawn.
    pub(crate) config: PathBuf,
    /// Where to write the files.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateArgs {
    /// Tables of known displacements (one of them may be -, standard input), or camera frames. The first frame shows
    /// the sensor at rest.
    #[arg(required_unless_present = "rest", value_name = "TABLE.csv|FRAME.png")]
    pub(crate) inputs: Vec<PathBuf>,
    /// Estimate the camera's position, rotation and scale from this frame at rest. Without this option, the command
    /// calibrates the displacements of markers instead.
    #[arg(long, value_name = "REST.png", requires = "layout", conflicts_with_all = ["inputs", "normal", "tangential", "per_marker", "px_per_rad"])]
    pub(crate) rest: Option<PathBuf>,
    /// The config of a study of a press with a camera. It states the positions and the discs of the markers, the frame
    /// size, the lens, and the nominal position and rotation of the camera.
    #[arg(long, value_name = "STUDY.toml", requires = "rest")]
    pub(crate) layout: Option<PathBuf>,
    /// Index of the cell in the study that --layout names, counted from 0.
    #[arg(long, value_name = "I", default_value_t = 0, requires = "layout")]
    pub(crate) cell: usize,
    /// The calibration to write, a TOML file; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Inward displacement of the marker under the contact, one number per pressed frame.
    #[arg(long, value_name = "D,D,...", value_delimiter = ',', value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) normal: Option<Vec<f64>>,
    /// Displacement (along the skin) of the marker under the contact, one number per pressed frame.
    #[arg(long, value_name = "D,D,...", value_delimiter = ',', value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) tangential: Option<Vec<f64>>,
    /// Property of a marker from which its normal displacement is computed.
    #[arg(long, default_value = <&str>::from(NormalFrom::default()), value_parser = normal_from())]
    pub(crate) from: NormalFrom,
    /// Fit a separate slope (signal per displacement) for each marker that was measured at 3 or more different
    /// displacements; the other markers share one slope.
    #[arg(long)]
    pub(crate) per_marker: bool,
    /// Focal length of the fisheye lens that took the frames, px per rad [default: the scale in the middle of each
    /// frame applies to the whole frame].
    #[arg(long, value_name = "F", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) px_per_rad: Option<f64>,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    /// The pixels are encoded by sRGB, as in images of most cameras [default: pixel values are proportional to the
    /// light].
    #[arg(long)]
    pub(crate) srgb: bool,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct TrackArgs {
    /// The frame at rest.
    pub(crate) rest: PathBuf,
    /// The pressed frame.
    pub(crate) pressed: PathBuf,
    /// Where to write the files.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// A calibration that `palpate sensor calibrate` wrote; for --method image, a calibration that was made with
    /// --rest. The lengths below are in the unit of this calibration.
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) sensor: SensorArgs,
    /// Focal length of the fisheye lens, px per rad [default: the calibration's scale (px per length), multiplied by
    /// the distance of the markers from the centre of the sphere].
    #[arg(long, value_name = "F", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) px_per_rad: Option<f64>,
    /// Number of points along each side of the grid of the interpolated displacement field [default: 30].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) grid: Option<u32>,
    /// Standard deviation of the Gaussian that smooths the displacement field, a length along the skin [default: 0, no
    /// smoothing].
    #[arg(long, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) filter: Option<f64>,
    /// The pixels are encoded by sRGB, as in images of most cameras [default: pixel values are proportional to the
    /// light].
    #[arg(long)]
    pub(crate) srgb: bool,
    /// Also overwrite files that palpate did not write, files that were edited after palpate wrote them, and input
    /// files of this command.
    #[arg(long)]
    pub(crate) force: bool,
}

fn normal_from() -> impl TypedValueParser<Value = NormalFrom> {
    let described = NormalFrom::ALL.map(|from| {
        PossibleValue::new(<&str>::from(from)).help(match from {
            NormalFrom::Hue => {
                "Its hue, which changes with the overlap of its two discs at different depths"
            }
            NormalFrom::Size => "Its size, which increases as it comes nearer to the camera",
            NormalFrom::Both => "Both, combined with weights that are fitted",
        })
    });
    PossibleValuesParser::new(described).try_map(|name| {
        let mut all = NormalFrom::ALL.into_iter();
        all.find(|from| name == <&str>::from(from))
            .ok_or("is not a property")
    })
}
