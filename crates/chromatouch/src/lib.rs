//! The spherical colour-marker sensor, forward: where its markers lie.
