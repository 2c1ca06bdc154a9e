//! The Segue app: a desktop window natively, the whole page on the web.

mod ui;
mod render;

/// A placeholder window until the app lands on top of the core.
#[derive(Default)]
struct Hello;

impl eframe::App for Hello {
    fn ui(&mut self, ui: &mut eframe::egui::Ui, _frame: &mut eframe::Frame) {
        ui.label("Segue");
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn main() -> eframe::Result {
    eframe::run_native("Segue", eframe::NativeOptions::default(), Box::new(|_| Ok(Box::<Hello>::default())))
}

#[cfg(target_arch = "wasm32")]
fn main() {
    use eframe::wasm_bindgen::JsCast as _;
    wasm_bindgen_futures::spawn_local(async {
        let canvas = eframe::web_sys::window()
            .and_then(|w| w.document())
            .and_then(|d| d.get_element_by_id("segue"))
            .and_then(|e| e.dyn_into::<eframe::web_sys::HtmlCanvasElement>().ok())
            .expect("the page has a canvas with the id `segue`");
        eframe::WebRunner::new()
            .start(canvas, eframe::WebOptions::default(), Box::new(|_| Ok(Box::<Hello>::default())))
            .await
            .expect("eframe starts");
    });
}
