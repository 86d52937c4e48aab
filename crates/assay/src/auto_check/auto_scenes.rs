//! Configs of random scenes. Their shapes, sizes, motions and tolerances are drawn from wide ranges.

use palpate_sensing::{Channel, Stream};

use crate::intervals::random_scene::Draws;

const SEED: u64 = 6;

/// A kind of scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Rolls of a probe.
    Roll,
    /// Glides of fingers.
    Glide,
    /// Presses of a soft sphere.
    Press,
}

impl Kind {
    /// All kinds of scenes.
    pub const ALL: [Self; 3] = [Self::Roll, Self::Glide, Self::Press];

    /// Name of this kind in configs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Roll => "roll",
            Self::Glide => "glide",
            Self::Press => "press",
        }
    }
}

/// Config of the scene with this kind and number, as text.
pub fn config_text(kind: Kind, number: u64) -> String {
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

/// Config text of an object that a probe of radius `r` touches only at one point. The second result is the largest
/// distance from the object's middle at which a contact may lie.
fn object(draws: &mut Draws, kind: usize, r: f64) -> (String, f64) {
    let size = r * draws.log_between(0.5, 30.0);
    match kind {
        0 => (format!("{{ kind = \"sphere\", radius = {size:e} }}"), size),
        1 => {
            let radius = 2.0 * r + size;
            (
                format!("{{ kind = \"dish\", radius = {radius:e} }}"),
                radius,
            )
        }
        2 => ("{ kind = \"plane\" }".to_owned(), size),
        3 => {
            let direction = draws.between(0.0, 90.0);
            (
                format!(
                    "{{ kind = \"cylinder\", radius = {size:e}, direction_deg = {direction} }}"
                ),
                size,
            )
        }
        4 => {
            let [a, b, c] = std::array::from_fn(|_| size * draws.between(1.0, 2.0));
            (
                format!("{{ kind = \"ellipsoid\", semi_axes = [{a:e}, {b:e}, {c:e}] }}"),
                size,
            )
        }
        5 => (
            format!("{{ kind = \"paraboloid\", c = {:e} }}", 0.1 / size),
            size,
        ),
        6 => (
            format!("{{ kind = \"saddle\", a = {:e} }}", 0.1 / size),
            size,
        ),
        _ => (
            format!(
                "{{ kind = \"height-field\", formula = \"a*sin(x/l)*cos(y/l)\", parameters = {{ a = {:e}, l = {:e} }} }}",
                0.05 * size,
                2.0 * size
            ),
            size,
        ),
    }
}

/// Config text of a random roll. Few of the objects have a closed-form solution, so most rolls need an integrator. Some
/// rolls start beside the apex, have spin, or consist of several motions.
fn roll(mut draws: Draws) -> String {
    const KINDS: [usize; 12] = [0, 1, 2, 3, 4, 4, 4, 5, 6, 6, 6, 7];
    let radius = draws.log_between(1e-2, 1e2);
    let kind = KINDS[draws.index(KINDS.len())];
    let (object, reach) = object(&mut draws, kind, radius);
    let contact = match draws.index(4) {
        0 => String::new(),
        _ => {
            let [x, y] = std::array::from_fn(|_| 0.6 * reach * draws.between(-1.0, 1.0));
            format!("object_contact = [{x:e}, {y:e}]\n")
        }
    };
    let turn = draws.log_between(0.01, 2.0);
    let spin = match draws.index(3) {
        0 => format!(", spin_rad_per_s = {:e}", turn * draws.between(-1.0, 1.0)),
        _ => String::new(),
    };
    // The models are compared in rolls without noise. The config states noise only to divide a roll into several
    // motions, one for each instant at which noise is drawn.
    let noise = match draws.index(4) {
        0 => format!(
            "noise = {{ angular_velocity = {{ kind = \"gaussian\", fraction = 0.01, when = \"per-instant\", \
             instants = {} }} }}\n",
            2 + draws.index(4)
        ),
        _ => String::new(),
    };
    let tolerance = draws.log_between(1e-11, 1e-2);
    format!(
        "probe = {{ kind = \"sphere\", radius = {radius:e} }}\nobject = {object}\n{contact}\
         motion = {{ rate_rad_per_s = {turn:e}, duration_s = 1.0{spin} }}\n\
         model = {{ kind = \"auto\", tolerance = {tolerance:e} }}\n{noise}"
    )
}

fn glide(mut draws: Draws) -> String {
    let radius = draws.log_between(1e-2, 1e2);
    let kind = draws.index(8);
    let (object, _) = object(&mut draws, kind, radius);
    let half = 0.1 * radius * draws.between(1.0, 3.0);
    let tolerance = draws.log_between(1e-11, 1e-2);
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

/// Config text of a random press. In some presses, the layer is so thick that the cheapest model is accurate enough. In
/// others, it is so thin that the rigid base under the layer dominates the contact.
fn press(mut draws: Draws) -> String {
    let radius = draws.log_between(1.0, 1e2);
    let size = radius * draws.log_between(1.0, 30.0);
    let object = match draws.index(3) {
        0 => "{ kind = \"plane\" }".to_owned(),
        1 => format!("{{ kind = \"sphere\", radius = {size:e} }}"),
        _ => format!("{{ kind = \"dish\", radius = {:e} }}", 2.0 * radius + size),
    };
    let depth = radius * draws.log_between(1e-3, 0.05);
    let indentation = radius * draws.log_between(1e-4, 3e-2);
    let tolerance = match draws.index(4) {
        0 => draws.log_between(1e-6, 0.03),
        _ => draws.log_between(0.05, 0.5),
    };
    let layer = match draws.index(3) {
        0 => format!("poisson = {}, ", draws.between(0.3, 0.5)),
        _ => {
            // The layer must be thicker than the indentation and must contain the markers.
            let least = depth.max(2.0 * indentation).max(0.1 * radius);
            let thickness = draws.log_between(least, radius);
            format!("thickness = {thickness:e}, ")
        }
    };
    format!(
        "probe = {{ kind = \"marker-sphere\", radius = {radius:e}, marker_depth = {depth:e}, layout = \"published\" }}\n\
         object = {object}\nmotion = {{ indentation = {indentation:e} }}\n\
         model = {{ kind = \"auto\", {layer}tolerance = {tolerance:e} }}\n"
    )
}
