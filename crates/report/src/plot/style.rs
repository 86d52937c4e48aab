//! Colours and markers of series. The colours are those of Okabe and Ito, which colour-blind readers can distinguish.
//! Each series also has its own marker.

pub(crate) use plotters::style::RGBColor as Colour;

pub(crate) const INK: Colour = Colour(34, 34, 34);
pub(crate) const QUIET: Colour = Colour(90, 90, 90);
pub(crate) const FRAME: Colour = Colour(120, 120, 120);
pub(crate) const GRID: Colour = Colour(210, 210, 210);
pub(crate) const FAINT: Colour = Colour(238, 238, 238);
pub(crate) const WHITE: Colour = Colour(255, 255, 255);

pub(crate) const FLOOR: Colour = Colour(248, 248, 246);

/// Colour of boundaries between coloured areas. It is dark on white pages and on dark pages.
pub(crate) const OUTLINE: Colour = Colour(33, 33, 33);

pub(crate) const DARK: Colour = Colour(27, 29, 31);

/// Colours that are replaced if the reader's screen shows a dark page. Each entry contains a colour and its
/// replacement. All other colours are visible on white and on dark pages.
pub(crate) fn on_dark() -> Vec<(Colour, Colour)> {
    let light = Colour(232, 232, 230);
    let neutral = [
        (INK, light),
        (QUIET, Colour(168, 171, 175)),
        (FRAME, Colour(138, 141, 145)),
        (GRID, Colour(66, 69, 73)),
        (FAINT, Colour(44, 47, 50)),
        (FLOOR, Colour(34, 36, 39)),
        (WHITE, DARK),
        (NEUTRAL, Colour(196, 198, 200)),
    ];
    let on_dark = |series: Colour| match series {
        Colour(0, 0, 0) => light,
        Colour(0, 114, 178) => Colour(64, 158, 217),
        other => other,
    };
    let series = COLOURS.into_iter().flat_map(|colour| {
        let dark = on_dark(colour);
        [(colour, dark), (pale(colour), mixed(dark, DARK, 0.5))]
    });
    neutral
        .into_iter()
        .chain(series)
        .filter(|(white, dark)| white != dark)
        .collect()
}

/// Okabe and Ito's colours, without their yellow, because yellow lines are invisible on white.
const COLOURS: [Colour; 7] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(230, 159, 0),
    Colour(86, 180, 233),
    Colour(0, 0, 0),
];

/// Largest number of lines in a plot whose lines differ only in colour.
pub(crate) const PLAIN: usize = COLOURS.len();

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Up,
    Diamond,
    Down,
    Ring,
    Plus,
    Cross,
    /// Small disc for points that are close together, where larger markers would cover each other. It is always filled.
    Dot,
    /// Horizontal bar. It is longer than a dot, so it is visible even behind a dot. It is always filled.
    Dash,
}

const MARKERS: [Marker; 8] = [
    Marker::Circle,
    Marker::Square,
    Marker::Up,
    Marker::Diamond,
    Marker::Down,
    Marker::Ring,
    Marker::Plus,
    Marker::Cross,
];

/// Marker shapes that can be distinguished even when they are drawn open, that is, white inside.
const OPEN: [Marker; 5] = [
    Marker::Diamond,
    Marker::Square,
    Marker::Up,
    Marker::Circle,
    Marker::Down,
];

/// Colour of markers that belong to no series or to several series.
const NEUTRAL: Colour = Colour(60, 60, 60);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Style {
    pub(crate) colour: Colour,
    pub(crate) marker: Marker,
}

impl Style {
    pub(crate) const fn new(colour: Colour, marker: Marker) -> Self {
        Self { colour, marker }
    }

    /// Style of the value with the index `index` among the values of a swept field. The first 56 values have different
    /// styles.
    pub(crate) fn of(index: usize) -> Self {
        Self {
            colour: COLOURS[index % COLOURS.len()],
            marker: MARKERS[index % MARKERS.len()],
        }
    }

    pub(crate) fn open(index: usize) -> Self {
        Self {
            colour: NEUTRAL,
            marker: OPEN[index % OPEN.len()],
        }
    }
}

/// Paler version of a colour: a mixture of equal parts of the colour and of white.
pub(crate) fn pale(colour: Colour) -> Colour {
    mixed(colour, WHITE, 0.5)
}

/// Mixture of two colours. `share` is the share of `other`, from 0 to 1.
pub(crate) fn mixed(one: Colour, other: Colour, share: f64) -> Colour {
    let mix = |one: u8, other: u8| {
        let (one, other) = (f64::from(one), f64::from(other));
        (one + (other - one) * share.clamp(0.0, 1.0)) as u8
    };
    Colour(
        mix(one.0, other.0),
        mix(one.1, other.1),
        mix(one.2, other.2),
    )
}

/// The hexadecimal code of a colour for SVG and CSS.
pub(crate) fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// The eight shape classes with their names in files and their colours. They are sorted by the sign of the mean
/// curvature H: H > 0, then H = 0, then H < 0. For the same sign of H, they are sorted by the sign of the Gaussian
/// curvature K: K > 0, K = 0, K < 0.
///
/// From convex to concave, the colours change from red to blue, which colour-blind readers can distinguish. All colours
/// have different lightness, so they can be distinguished in a grey print. No series has one of these colours.
pub(crate) const CLASSES: [(&str, Colour); 8] = [
    ("peak", Colour(122, 31, 18)),
    ("ridge", Colour(210, 79, 31)),
    ("saddle-ridge", Colour(247, 166, 74)),
    ("flat", Colour(211, 211, 211)),
    ("minimal", Colour(255, 243, 191)),
    ("pit", Colour(23, 42, 107)),
    ("valley", Colour(47, 99, 173)),
    ("saddle-valley", Colour(95, 168, 220)),
];
