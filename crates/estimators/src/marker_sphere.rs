//! Builds the parts of a marker sensor from its config: skin, layout and discs.

use palpate_chromatouch::{
    Camera, DiscDepths, Discs, Layout, LayoutError, Lens, MarkerArray, OpticsError,
};
use palpate_press::{Markers, Skin};
use palpate_statistics::Number;
use palpate_study::FieldError;
use palpate_study::config::{
    BareFingertipConfig, DiscColour, DiscsConfig, LayoutConfig, LayoutTable, LensName, NamedLayout,
    PressProbeConfig,
};

/// Path of the config field that describes the layout of the markers.
pub(crate) const LAYOUT: &str = "scene.probe.layout";

/// A soft sphere with markers under its skin. If the radius is infinite, the sensor is a flat pad.
#[derive(Clone, Debug)]
pub struct MarkerSphere<'a> {
    /// Radius of the skin (length).
    pub radius: f64,
    /// Depth of the markers under the skin (length); for markers with two discs, the mean of their depths.
    pub marker_depth: f64,
    /// Arrangement of the markers under the skin.
    pub layout: Layout,
    /// Number of straight segments along each side of a gore (a flat piece of the skin) in drawings of the pattern.
    pub outline_samples: u32,
    /// The two discs of each marker; `None` if the config has no discs.
    pub discs: Option<&'a DiscsConfig>,
}

/// The sensor that a config describes.
impl<'a> From<&'a PressProbeConfig> for MarkerSphere<'a> {
    fn from(config: &'a PressProbeConfig) -> Self {
        let PressProbeConfig::MarkerSphere {
            radius,
            marker_depth,
            layout,
            discs,
            outline_samples,
        } = config;
        Self {
            radius: *radius,
            marker_depth: *marker_depth,
            layout: layout_of(layout),
            outline_samples: *outline_samples,
            discs: discs.as_ref(),
        }
    }
}

impl<'a> MarkerSphere<'a> {
    /// Positions (x, y) of the markers on the skin (length). A marker lies in the direction (x, y) from the apex, at
    /// the distance √(x² + y²) along the skin.
    pub(crate) fn places(&self) -> Result<Vec<[f64; 2]>, FieldError> {
        self.layout
            .places(self.radius)
            .map_err(|error| layout_error(&error))
    }

    /// The markers under the skin, and the coordinates of their positions on the skin.
    pub fn markers(&self) -> Result<(Markers, Vec<[f64; 2]>), FieldError> {
        let (radius, depth) = (self.radius, self.marker_depth);
        let skin =
            Skin::new(radius).map_err(|error| FieldError::at("scene.probe.radius", error))?;
        if depth >= radius {
            let [radius, depth] = [radius, depth].map(Number);
            let message = format!("must be less than the sensor's radius {radius}, is {depth}");
            return Err(FieldError::at("scene.probe.marker_depth", message));
        }
        let places = self.places()?;
        let markers = Markers::new(skin, &places).map_err(|error| FieldError::at(LAYOUT, error))?;
        Ok((markers, places))
    }

    /// Image area (px²) of a marker whose place the config states: the area of the disc that is larger in the camera's
    /// view. `None` if this disc is not entirely in the camera's field of view.
    pub fn marker_area(&self, config: &BareFingertipConfig) -> Result<Option<f64>, FieldError> {
        let (diameters, depths) = (self.diameters()?, self.disc_depths()?);
        let lens = match config.sensor.lens {
            LensName::Fisheye => Lens::Fisheye,
            LensName::Pinhole => Lens::Pinhole,
        };
        let camera = Camera::new(lens, config.sensor.size_px, config.sensor.field_deg)
            .map_err(|error| optics_error(&error))?;
        // `array` returns an error if the skin cannot contain discs of these depths and diameters.
        self.array(&[[0.0; 2]], None)?;
        let angle = |diameter: f64, depth: f64| libm::atan2(0.5 * diameter, self.radius - depth);
        let larger = f64::max(
            angle(diameters.magenta, depths.magenta),
            angle(diameters.yellow, depths.yellow),
        );
        Ok(camera.disc_area(larger, config.view.polar_deg.to_radians()))
    }

    fn discs(&self) -> Result<&'a DiscsConfig, FieldError> {
        if self.radius == f64::INFINITY {
            let message = "is inf, but a camera is in the centre of the sensor's sphere: for a flat \
                 pad, leave out `scene.sensor`, which then reads the displacements directly";
            return Err(FieldError::at("scene.probe.radius", message));
        }
        self.discs.ok_or_else(|| {
            FieldError::at(
                "scene.probe",
                "`discs` is missing: a camera needs markers that have two discs",
            )
        })
    }

    /// Diameters of each marker's two discs (length).
    pub(crate) fn diameters(&self) -> Result<Discs, FieldError> {
        let discs = self.discs()?;
        Ok(Discs {
            magenta: discs.magenta_diameter,
            yellow: discs.yellow_diameter,
        })
    }

    /// Depth of each marker's two discs under the skin (length).
    pub fn disc_depths(&self) -> Result<DiscDepths, FieldError> {
        let discs = self.discs()?;
        let half = 0.5 * discs.separation;
        if half > self.marker_depth {
            let message = format!(
                "the outer discs would lie {} above the skin; the separation must be at most twice `scene.probe.marker_depth`, {}",
                half - self.marker_depth,
                2.0 * self.marker_depth
            );
            return Err(FieldError::at("scene.probe.discs.separation", message));
        }
        let (inner, outer) = (self.marker_depth + half, self.marker_depth - half);
        let (magenta, yellow) = match discs.inner {
            DiscColour::Magenta => (inner, outer),
            DiscColour::Yellow => (outer, inner),
        };
        Ok(DiscDepths { magenta, yellow })
    }

    /// Standard deviation of each coordinate of the misalignment between a marker's two discs, as an angle (rad) at the
    /// centre of the sensor.
    pub fn misalignment_std(&self) -> Result<f64, FieldError> {
        let (diameters, depths) = (self.diameters()?, self.disc_depths()?);
        // For a point that is uniformly distributed in a circle, each coordinate has a standard deviation of half the
        // circle's radius.
        let most = self.discs()?.misalignment * diameters.yellow;
        Ok(0.5 * most / (self.radius - depths.yellow))
    }

    /// Markers with both discs at the positions `places`. If `seed` is given, the discs have random misalignments, as
    /// they result from manufacture. `seed` is the seed of the random numbers.
    pub fn array(&self, places: &[[f64; 2]], seed: Option<u64>) -> Result<MarkerArray, FieldError> {
        let (diameters, depths) = (self.diameters()?, self.disc_depths()?);
        let array = MarkerArray::new(self.radius, places, diameters, depths);
        let array = array.map_err(|error| optics_error(&error))?;
        match (seed, self.discs()?.misalignment) {
            (None, _) | (_, 0.0) => Ok(array),
            (Some(seed), most) => array
                .misaligned(most, seed, 0)
                .map_err(|error| optics_error(&error)),
        }
    }
}

fn layout_of(config: &LayoutConfig) -> Layout {
    match config {
        LayoutConfig::Named(NamedLayout::Published) => Layout::published(),
        LayoutConfig::Table(LayoutTable::Gores {
            gores,
            rows,
            row_spacing_deg,
        }) => Layout::Gores {
            gores: *gores,
            rows: rows.clone(),
            row_spacing_deg: *row_spacing_deg,
        },
        LayoutConfig::Table(LayoutTable::Lattice { pitch, cap_deg }) => Layout::Lattice {
            pitch: *pitch,
            cap_deg: *cap_deg,
        },
        LayoutConfig::Table(LayoutTable::Grid {
            pitch,
            width,
            height,
        }) => Layout::Grid {
            pitch: *pitch,
            size: [*width, *height],
        },
        LayoutConfig::Table(LayoutTable::Line(row)) => Layout::Line {
            markers: row.markers,
            length: row.length,
        },
        LayoutConfig::Table(LayoutTable::Radius(row)) => Layout::Radius {
            markers: row.markers,
            length: row.length,
        },
    }
}

fn layout_error(error: &LayoutError) -> FieldError {
    match error.setting() {
        Some(setting) => FieldError::at(format!("{LAYOUT}.{setting}"), error),
        None => FieldError::at(LAYOUT, error),
    }
}

/// Converts an error of the markers or the camera to an error that names the invalid field of the config.
pub fn optics_error(error: &OpticsError) -> FieldError {
    if let OpticsError::BadSetting(bad) = error
        && bad.setting == "turn_rad"
    {
        let [turn, most] = [bad.value, 1.0].map(|angle| Number::rounded(angle.to_degrees()));
        let message = format!(
            "is {turn} deg about an axis; it must be from -{most} to {most} deg about each"
        );
        return FieldError::at("scene.sensor.turn_deg", message);
    }
    let path = match error.setting() {
        Some(
            setting @ ("magenta_diameter" | "yellow_diameter" | "separation" | "misalignment"),
        ) => {
            format!("scene.probe.discs.{setting}")
        }
        Some("pixel_std") => "scene.noise.pixel.std".to_owned(),
        Some(setting) => format!("scene.sensor.{setting}"),
        None => "scene.probe.discs".to_owned(),
    };
    FieldError::at(path, error)
}
