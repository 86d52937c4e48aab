//! Contacts that are too wide for small-strain theory.

use palpate_press::{LARGE_CONTACT, sneddon_indentation};
use palpate_study::Warning;

/// Warns if the contact is too wide for small-strain theory, relative to the sensor or to the object.
pub fn large_contact_warning(
    relative_curvature: f64,
    contact_radius: f64,
    sensor_radius: f64,
    is_layer: bool,
) -> Option<Warning> {
    let of_sensor = contact_radius / sensor_radius;
    let of_object = contact_radius * (relative_curvature - sensor_radius.recip());
    let (share, whose) = match of_object > of_sensor {
        true => (of_object, "object"),
        false => (of_sensor, "sensor"),
    };
    if share < LARGE_CONTACT {
        return None;
    }
    let reason = match sneddon_indentation(1.0, share) {
        _ if is_layer => "strains are not small".to_owned(),
        Ok(sneddon) => format!(
            "by Sneddon's relation it takes an indentation {:.1} % larger than by Hertz's",
            100.0 * (sneddon / (share * share) - 1.0)
        ),
        Err(_) => format!("it is wider than the {whose}"),
    };
    let text = format!(
        "the contact's radius is {share:.2} of the {whose}'s, past {LARGE_CONTACT}: {reason}"
    );
    Some(Warning::new("large-contact", text, [("share", share)]))
}
