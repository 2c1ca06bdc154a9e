//! The graphics backends of the page: the choice at the start, and the replacement of a lost
//! device.
//!
//! The page has two modules of the app. The one with the feature `webgl2` draws with WebGPU or
//! WebGL 2; the other draws with WebGPU alone, and is a fifth smaller. `web/js/first.js` chooses.

use super::{SegueHandle, show_outline};
use crate::app::View;
use crate::platform::{location_query, now_ms, replace_query, requested_backend};
use eframe::WebOptions;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use eframe::wgpu::Backends;
use std::rc::Rc;
use wasm_bindgen::JsValue;
use web_sys::HtmlCanvasElement;

/// The shortest life of a WebGPU device that replaced a lost one, milliseconds from its first
/// frame. After a shorter one, the app draws with WebGL 2. The start does not count, because its
/// duration depends on the machine.
const MIN_DEVICE_LIFE_MS: f64 = 10_000.0;

/// A request of the page's address.
enum Requested {
    Webgpu,
    Webgl2,
    /// WebGL 2, because WebGPU has failed in the page's last life.
    Fallback,
    Any,
}

fn requested() -> Requested {
    match requested_backend().as_deref() {
        Some("webgl2") => Requested::Webgl2,
        Some("webgpu") => Requested::Webgpu,
        Some("fallback") => Requested::Fallback,
        None | Some("auto") => Requested::Any,
        Some(other) => {
            log::warn!("backend: found `{other}`, expected webgpu or webgl2");
            Requested::Any
        }
    }
}

impl SegueHandle {
    /// Runs the app on a canvas, with the graphics backend that the address selects.
    pub(super) async fn run(&self, canvas: HtmlCanvasElement) -> Result<(), JsValue> {
        if !cfg!(feature = "webgl2") {
            return self.run_on(canvas, Backends::BROWSER_WEBGPU).await;
        }
        match requested() {
            Requested::Webgl2 => self.run_on(canvas, Backends::GL).await,
            Requested::Webgpu => self.run_on(canvas, Backends::BROWSER_WEBGPU).await,
            Requested::Fallback => {
                self.run_on(canvas, Backends::GL).await?;
                // Of this start alone: the address forgets it.
                replace_query(&location_query());
                self.tell_of_fallback()
            }
            Requested::Any => self.run_on_any(canvas).await,
        }
    }

    /// Runs the app on a new canvas after its device was lost; false without having tried where
    /// only WebGL 2 is left, and this module lacks it.
    pub(super) async fn continue_on(&self, canvas: HtmlCanvasElement) -> Result<bool, JsValue> {
        let backend = {
            let mut segue = self.borrow_mut()?;
            segue.detach();
            segue.backend()
        };
        if backend == "webgl2" {
            self.run_on(canvas, Backends::GL).await?;
            return Ok(true);
        }
        // The time is taken out, so that the attempt after a failure of WebGL 2 is like the first.
        let lived_shortly = self
            .replaced_ms
            .take()
            .is_some_and(|since_ms| now_ms() - since_ms < MIN_DEVICE_LIFE_MS);
        if !lived_shortly || matches!(requested(), Requested::Webgpu) {
            self.run(canvas).await?;
            self.replaced_ms.set(Some(now_ms()));
            return Ok(true);
        }
        if !cfg!(feature = "webgl2") {
            return Ok(false);
        }
        self.run_on(canvas, Backends::GL).await?;
        self.tell_of_fallback()?;
        Ok(true)
    }

    fn tell_of_fallback(&self) -> Result<(), JsValue> {
        self.change(|segue| {
            segue.show_error("WebGPU has failed, so Segue draws with WebGL 2 now. Reload the page to try WebGPU again.");
            Ok(())
        })
    }

    async fn run_on(&self, canvas: HtmlCanvasElement, backends: Backends) -> Result<(), JsValue> {
        #[cfg(feature = "webgl2")]
        if backends == Backends::GL && webgl2::is_lost(&canvas) {
            return Err(super::error("the browser provides no working WebGL context"));
        }
        let mut setup = WgpuSetupCreateNew::without_display_handle();
        setup.instance_descriptor.backends = backends;
        let options = WebOptions {
            wgpu_options: WgpuConfiguration {
                wgpu_setup: WgpuSetup::CreateNew(setup),
                ..WgpuConfiguration::default()
            },
            // The panels have no gradients, and the stage must be copied unchanged.
            dithering: false,
            ..WebOptions::default()
        };
        let (segue, listener) = (Rc::clone(&self.segue), Rc::clone(&self.listener));
        let outline = self.outline.clone();
        let create: eframe::AppCreator<'static> = Box::new(move |cc| {
            outline.install(&cc.egui_ctx, show_outline);
            let report = move |events| super::report_events(&listener, events);
            Ok(Box::new(View::new(segue, cc, report)))
        });
        self.canvas.replace(canvas.clone());
        self.runner.start(canvas, options, create).await
    }

    #[cfg(not(feature = "webgl2"))]
    async fn run_on_any(&self, canvas: HtmlCanvasElement) -> Result<(), JsValue> {
        self.run_on(canvas, Backends::BROWSER_WEBGPU).await
    }
}

#[cfg(feature = "webgl2")]
mod webgl2 {
    //! WebGL 2 where WebGPU has an adapter and no device.

    use crate::app::Event;
    use crate::platform::{js_error_text, listen};
    use crate::web_api::{SegueHandle, error, report_events};
    use eframe::wgpu::Backends;
    use js_sys::{Object, Reflect};
    use std::rc::Rc;
    use wasm_bindgen::{JsCast as _, JsValue};
    use web_sys::{HtmlCanvasElement, WebGl2RenderingContext};

    impl SegueHandle {
        /// Runs the app with WebGPU or, where that fails, with WebGL 2.
        pub(super) async fn run_on_any(&self, canvas: HtmlCanvasElement) -> Result<(), JsValue> {
            let both = Backends::BROWSER_WEBGPU | Backends::GL;
            let Err(reason) = self.run_on(canvas.clone(), both).await else {
                return Ok(());
            };
            // An adapter may give no device, and WebGL 2 may still work. A canvas keeps the kind of
            // its first context, so WebGL 2 needs a new one.
            log::warn!(
                "the graphics could not be set up, trying WebGL 2 alone: {}",
                js_error_text(&reason)
            );
            let fresh: HtmlCanvasElement =
                canvas.clone_node()?.dyn_into().map_err(|_| reason.clone())?;
            canvas.replace_with_with_node_1(&fresh)?;
            let listener = Rc::clone(&self.listener);
            // The page listens only to its own canvas, so the loss of this one is reported here.
            listen(Some(&fresh), "webglcontextlost", move |event| {
                event.prevent_default();
                let message = "the WebGL context was lost".to_owned();
                report_events(&listener, vec![Event::Lost { message }]);
            });
            let both_reasons = |second: JsValue| {
                error(format!(
                    "WebGPU: {}. WebGL 2: {}",
                    js_error_text(&reason),
                    js_error_text(&second)
                ))
            };
            self.run_on(fresh, Backends::GL).await.map_err(both_reasons)
        }
    }

    /// Returns whether the canvas has a lost WebGL context. wgpu panics on one, because it has no
    /// version.
    pub(super) fn is_lost(canvas: &HtmlCanvasElement) -> bool {
        let options = Object::new();
        // The same options as wgpu's, which then gets this context.
        let asked = Reflect::set(&options, &"antialias".into(), &JsValue::FALSE)
            .and_then(|_| canvas.get_context_with_context_options("webgl2", &options));
        let context = asked
            .ok()
            .flatten()
            .and_then(|context| context.dyn_into::<WebGl2RenderingContext>().ok());
        context.is_some_and(|context| context.is_context_lost())
    }
}
