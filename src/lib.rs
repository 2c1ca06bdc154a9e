//! What the app draws, as plain data: [`scene`] makes a list of limbs, lines and rings from the
//! document of `segue-session`, and knows neither a GPU nor a page. The app itself is
//! `src/main.rs`.

pub mod scene;
