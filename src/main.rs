//! The Segue app: a desktop window natively, the whole page on the web.

#[cfg_attr(
    not(target_arch = "wasm32"),
    expect(dead_code, reason = "the page's API needs more of it than the window does")
)]
mod app;
#[cfg_attr(
    not(any(test, target_arch = "wasm32")),
    expect(dead_code, reason = "a window's widgets are told to the system by eframe")
)]
mod outline;
mod platform;
mod render;
mod ui;
#[cfg(target_arch = "wasm32")]
mod web_api;

/// Opens the window. The command line names files to load, or a link's query:
/// `segue walk.bvh "lab=view"`.
#[cfg(not(target_arch = "wasm32"))]
fn main() -> eframe::Result {
    use eframe::egui::ViewportBuilder;

    env_logger::init();
    let inbox = platform::Inbox::default();
    let segue = app::Segue::start(inbox.clone());
    platform::read_arguments(&inbox);
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("Segue")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([390.0, 600.0]),
        ..Default::default()
    };
    eframe::run_native(
        "segue",
        options,
        Box::new(move |cc| Ok(Box::new(app::View::new(segue, cc, |_| {})))),
    )
}

/// Sets up logging. The page's modules start the app, through the `SegueHandle` of [`web_api`].
#[cfg(target_arch = "wasm32")]
fn main() {
    eframe::WebLogger::init(log::LevelFilter::Warn).ok();
}
