//! Tests of the choices of `auto`, of reference contacts, and of the computational work that scenes cause.
#![allow(clippy::unwrap_used)]

mod auto_check;
mod families;
mod paraboloid_reference;
mod required_work;
