//! The document.
pub mod compare;
pub mod link;
pub mod params;
pub mod transport;
