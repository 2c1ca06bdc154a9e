//! Tests of databases and controllers.

use super::*;
use crate::clip::{Clip, Motion};
use crate::math::Planar;
use crate::skeleton::Roles;
use crate::synth::{Action, Params, synthesize};
use glam::{DVec2, Vec3};
use std::sync::{Arc, OnceLock};

mod controller;
mod cycles;
mod database;
mod hysteresis;
mod oracle;

/// Returns a small database of synthesised motions, built once.
fn small_database() -> &'static Arc<Database> {
    static DATABASE: OnceLock<Arc<Database>> = OnceLock::new();
    DATABASE.get_or_init(|| {
        Arc::new(Database::new(made_clips(1.75).unwrap(), &DatabaseOptions::default()).unwrap())
    })
}

fn options() -> ControllerOptions {
    ControllerOptions::default()
}

fn cycle_options(cycles: bool) -> DatabaseOptions {
    DatabaseOptions { cycles, ..DatabaseOptions::default() }
}
