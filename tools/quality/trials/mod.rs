//! Trials of takes from a folder or from the synthesiser in every lab, with measurements. Shared
//! with the test of the same name.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "a module of a program and of a test, each of which uses a part of it"
)]

pub mod folder;
pub mod guard;
mod lab_uses;
mod measured;
pub mod session;
pub mod table;
pub mod trial;
