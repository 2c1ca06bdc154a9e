//! The texts on screen that are no parameter's own (those stand in the table of parameters).
//!
//! A text without arguments is a constant, one with arguments a function that returns a
//! [`Message`](segue_text::Message). Both are written out in the language of the interface where
//! they are drawn.

#![expect(
    clippy::needless_pass_by_value,
    reason = "a message takes over the parts that it is made of"
)]

mod bone_map;
mod clean;
mod convert;
mod edit;
mod graph;
mod lessons;
mod library;
mod loop_;
mod match_;
mod page;
mod path;
mod register;
mod retarget;
mod speed;
mod stage;
mod transition;

pub(crate) use bone_map::*;
pub(crate) use clean::*;
pub(crate) use convert::*;
pub(crate) use edit::*;
pub(crate) use graph::*;
pub(crate) use lessons::*;
pub(crate) use library::*;
pub(crate) use loop_::*;
pub(crate) use match_::*;
pub(crate) use page::*;
pub(crate) use path::*;
pub(crate) use register::*;
pub(crate) use retarget::*;
pub(crate) use speed::*;
pub(crate) use stage::*;
pub(crate) use transition::*;
