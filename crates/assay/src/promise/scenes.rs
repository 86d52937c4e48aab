//! Random scenes, as configs: shapes, sizes, motions and tolerances over wide ranges.

use palpate_sensing::{Channel, Stream};

const SEED: u64 = 6;

/// A kind of scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A probe rolls.
    Roll,
    /// Fingers slide.
    Glide,
    /// A soft sphere is pressed.
    Press,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Roll, Self::Glide, Self::Press];

    /// As configs call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Roll => "roll",
            Self::Glide => "glide",
            Self::Press => "press",
        }
    }
}

impl Kind {
    /// Many of them.
    pub(super) const fn plural(self) -> &'static str {
        match self {
            Self::Roll => "rolls",
            Self::Glide => "glides",
            Self::Press => "presses",
        }
    }
}

/// The draws of a scene.
struct Draws(Stream);

impl Draws {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (0.5 + 0.5 * self.0.symmetric_uniform())
    }

    /// Log-uniform.
    fn of_magnitude(&mut self, from: f64, to: f64) -> f64 {
        10_f64.powf(self.between(from.log10(), to.log10()))
    }

    fn index(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }
}

/// The config of a scene.
pub fn text(kind: Kind, number: u64) -> String {
    let draws = Draws(Stream::new(SEED + kind as u64, number, Channel::Position));
    let scene = match kind {
        Kind::Roll => roll(draws),
        Kind::Glide => glide(draws),
        Kind::Press => press(draws),
    };
    format!(
        "name = \"{}-{number}\"\n[scene]\nkind = \"{0}\"\n{scene}",
        kind.name()
    )
}

/// An object against which a probe of radius `r` neither conforms nor is lost.
fn object(draws: &mut Draws, r: f64) -> String {
    let size = r * draws.of_magnitude(0.5, 30.0);
    match draws.index(8) {
        0 => format!("{{ kind = \"sphere\", radius = {size:e} }}"),
        1 => format!("{{ kind = \"dish\", radius = {:e} }}", 2.0 * r + size),
        2 => "{ kind = \"plane\" }".to_owned(),
        3 => format!(
            "{{ kind = \"cylinder\", radius = {size:e}, direction_deg = {} }}",
            draws.between(0.0, 90.0)
        ),
        4 => {
            let [a, b, c] = std::array::from_fn(|_| size * draws.between(1.0, 2.0));
            format!("{{ kind = \"ellipsoid\", semi_axes = [{a:e}, {b:e}, {c:e}] }}")
        }
        5 => format!("{{ kind = \"paraboloid\", c = {:e} }}", 0.1 / size),
        6 => format!("{{ kind = \"saddle\", a = {:e} }}", 0.1 / size),
        _ => format!(
            "{{ kind = \"height-field\", formula = \"a*sin(x/l)*cos(y/l)\", parameters = {{ a = {:e}, l = {:e} }} }}",
            0.05 * size,
            2.0 * size
        ),
    }
}

fn roll(mut draws: Draws) -> String {
    let radius = draws.of_magnitude(1e-2, 1e2);
    let object = object(&mut draws, radius);
    let turn = draws.of_magnitude(0.01, 2.0);
    let tolerance = draws.of_magnitude(1e-11, 1e-2);
    format!(
        "probe = {{ kind = \"sphere\", radius = {radius:e} }}\nobject = {object}\n\
         motion = {{ rate_rad_per_s = {turn:e}, duration_s = 1.0 }}\n\
         model = {{ kind = \"auto\", tolerance = {tolerance:e} }}\n"
    )
}

fn glide(mut draws: Draws) -> String {
    let radius = draws.of_magnitude(1e-2, 1e2);
    let object = object(&mut draws, radius);
    let half = 0.1 * radius * draws.between(1.0, 3.0);
    let tolerance = draws.of_magnitude(1e-11, 1e-2);
    format!(
        "probe = {{ kind = \"sphere\", radius = {radius:e} }}\nobject = {object}\n\
         motion = {{ finger_positions = [{:e}, 0.0, {half:e}], inter_finger_distance = {half:e}, patch_length = {:e}, \
         contacts_per_finger = 8 }}\n\
         model = {{ kind = \"auto\", tolerance = {tolerance:e} }}\nestimator = {{ kind = \"quadric\" }}\n\
         evaluate = {{ grid = 2, half_width = {:e}, gaussian_threshold = {:e}, mean_threshold = {:e} }}\n",
        -half,
        2.0 * half,
        0.5 * half,
        1e-2 / (radius * radius),
        1e-2 / radius
    )
}

fn press(mut draws: Draws) -> String {
    let radius = draws.of_magnitude(1.0, 1e2);
    let size = radius * draws.of_magnitude(1.0, 30.0);
    let object = match draws.index(3) {
        0 => "{ kind = \"plane\" }".to_owned(),
        1 => format!("{{ kind = \"sphere\", radius = {size:e} }}"),
        _ => format!("{{ kind = \"dish\", radius = {:e} }}", 2.0 * radius + size),
    };
    let depth = radius * draws.of_magnitude(1e-3, 0.1);
    let indentation = radius * draws.of_magnitude(1e-4, 3e-2);
    let tolerance = draws.of_magnitude(1e-6, 0.3);
    let layer = match draws.index(2) {
        0 => String::new(),
        _ => {
            // A press deeper than its layer is none.
            let least = depth.max(2.0 * indentation);
            let thickness = (least * draws.of_magnitude(1.0, 30.0)).min(radius);
            format!("thickness = {thickness:e}, ")
        }
    };
    format!(
        "probe = {{ kind = \"marker-sphere\", radius = {radius:e}, marker_depth = {depth:e}, layout = \"published\" }}\n\
         object = {object}\nmotion = {{ indentation = {indentation:e} }}\n\
         model = {{ kind = \"auto\", {layer}tolerance = {tolerance:e} }}\n"
    )
}
