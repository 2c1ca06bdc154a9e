//! What is seen and touched: the theme, the kit of widgets, and the panels built from them.

#![expect(dead_code, unused_imports, reason = "the kit stands before the panels that use it")]

pub(crate) mod kit;
pub(crate) mod theme;
