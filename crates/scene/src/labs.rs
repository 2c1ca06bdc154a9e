//! Elements that single labs draw beside a result.

pub(crate) mod graph;
pub(crate) mod layers;
pub(crate) mod match_;
pub(crate) mod path;
pub(crate) mod register;
