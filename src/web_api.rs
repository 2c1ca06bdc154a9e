//! The object by which the page's JavaScript drives the app. `web/js/boot.js` lists the methods
//! that the page needs.

mod graphics;
mod rest;

use crate::app::api::{self, ApiError, ExportWords};
use crate::app::{BegunExport, Event, Segue, Shared, is_stage_complete};
use crate::outline::{Deed, Outline};
use crate::platform::{
    Area, FileBytes, Inbox, LargeFile, area_of, confirm_leaving_while, inline_picture,
    js_error_text, next_frame, next_turn, now_ms, set_computer_factory, set_corpora,
    set_worker_factory, sleep, snapshot, wasm_memory_bytes, watch_folders, watch_hiding,
};
use eframe::WebRunner;
use eframe::egui::Modifiers;
use js_sys::{Error, Function, Uint8Array};
use segue_session::Command;
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen_futures::spawn_local;
use web_sys::{Blob, HtmlCanvasElement};

/// The page's handle of the running app.
///
/// Every method borrows it shared. After a panic inside an exclusive one, wasm-bindgen would refuse
/// all others, including the one that returns the panic.
#[wasm_bindgen]
#[derive(Clone)]
pub struct SegueHandle {
    runner: WebRunner,
    segue: Shared,
    inbox: Inbox,
    canvas: Rc<RefCell<HtmlCanvasElement>>,
    listener: Rc<RefCell<Option<Function>>>,
    outline: Outline,
    /// The time at which a WebGPU device that replaced a lost one began to draw, milliseconds.
    replaced_ms: Rc<Cell<Option<f64>>>,
}

thread_local! {
    /// Takes the changes of the outline. The window's plugin may be on any thread, as far as its
    /// type says, and holds no JavaScript.
    static OUTLINE_LISTENER: RefCell<Option<Function>> = const { RefCell::new(None) };
}

fn show_outline(changes: &str) {
    let listener = OUTLINE_LISTENER.with_borrow(Clone::clone);
    if let Some(listener) = listener
        && let Err(error) = listener.call1(&JsValue::NULL, &JsValue::from_str(changes))
    {
        log::error!("the outline could not be shown: {}", js_error_text(&error));
    }
}

/// The longest wait for files to be stored before the page is loaded again, milliseconds.
const MAX_STORING_MS: f64 = 10_000.0;

fn error(text: impl std::fmt::Display) -> JsValue {
    Error::new(&text.to_string()).into()
}

fn to_js(value: &impl Serialize) -> Result<JsValue, JsValue> {
    value.serialize(&Serializer::json_compatible()).map_err(JsValue::from)
}

#[wasm_bindgen]
impl SegueHandle {
    /// Starts the app on a canvas. `new_reader` makes the worker that reads files, `new_computer`
    /// one of those that compute; `corpora` calls the modules that show corpora and read them.
    pub async fn start(
        canvas: HtmlCanvasElement,
        new_reader: Function,
        new_computer: Function,
        corpora: Function,
    ) -> Result<SegueHandle, JsValue> {
        set_worker_factory(new_reader);
        set_computer_factory(new_computer);
        set_corpora(corpora);
        let inbox = Inbox::default();
        let handle = Self {
            runner: WebRunner::new(),
            segue: Segue::start(inbox.clone()),
            inbox,
            canvas: Rc::new(RefCell::new(canvas.clone())),
            listener: Rc::default(),
            outline: Outline::default(),
            replaced_ms: Rc::default(),
        };
        handle.borrow_mut()?.hold_input();
        handle.run(canvas).await?;
        watch_folders(&handle.inbox);
        let weak = Rc::downgrade(&handle.segue);
        watch_hiding(move || {
            if let Some(segue) = weak.upgrade()
                && let Ok(mut segue) = segue.try_borrow_mut()
                // Before the first input, there is nothing to save.
                && !segue.is_holding_input()
            {
                segue.save_on_exit();
            }
        });
        let weak = Rc::downgrade(&handle.segue);
        confirm_leaving_while(move || {
            let segue = weak.upgrade();
            segue.is_some_and(|segue| {
                segue.try_borrow().is_ok_and(|segue| segue.has_unstored_files())
            })
        });
        Ok(handle)
    }

    /// Continues on a new canvas after the graphics device was lost. The document is unchanged.
    /// After a failure, it can be called again with another canvas.
    ///
    /// Returns false without having tried where only WebGL 2 is left, and this module lacks it.
    pub async fn restart(&self, canvas: HtmlCanvasElement) -> Result<bool, JsValue> {
        self.continue_on(canvas).await
    }

    /// Waits until all files are stored, at most 10 seconds, and returns whether they are. Without
    /// a storage, they are not.
    pub async fn stored(&self) -> Result<bool, JsValue> {
        self.borrow_mut()?.save_on_exit();
        let until_ms = now_ms() + MAX_STORING_MS;
        loop {
            match self.borrow()?.is_stored() {
                Some(false) if now_ms() < until_ms => {}
                outcome => return Ok(outcome == Some(true)),
            }
            sleep(20).await;
        }
    }

    /// Waits until the first frame is on screen.
    #[wasm_bindgen(js_name = firstFrame)]
    pub async fn first_frame(&self) {
        while self.segue.try_borrow().is_ok_and(|segue| segue.frames_drawn() == 0)
            && !self.runner.has_panicked()
        {
            next_frame().await;
        }
    }

    /// Returns the version of Segue.
    #[expect(clippy::unused_self, reason = "a method in JavaScript")]
    pub fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    /// Sets the function that receives events, `listener(event, detail)`.
    #[wasm_bindgen(js_name = setListener)]
    pub fn set_listener(&self, listener: Function) {
        self.listener.replace(Some(listener));
    }

    /// Calls `listener(changes)` after each frame with the changes that bring the page's elements
    /// up to date with the widgets; see `web/js/outline.js`.
    #[wasm_bindgen(js_name = setOutline)]
    pub fn set_outline(&self, listener: Function) {
        OUTLINE_LISTENER.replace(Some(listener));
        self.outline.enable();
        self.inbox.wake();
    }

    /// Sets whether an element of the outline has the keyboard focus.
    #[wasm_bindgen(js_name = setOutlineFocus)]
    pub fn set_outline_focus(&self, has_keyboard: bool) {
        self.outline.set_has_keyboard(has_keyboard);
    }

    /// Performs an action on an element of the outline: `click`, `focus`, or `value` with a number.
    pub fn act(&self, number: u32, action: &str, value: Option<f64>) {
        let deed = match (action, value) {
            ("click", _) => Deed::Click,
            ("focus", _) => Deed::Focus,
            ("value", Some(value)) => Deed::SetValue(value),
            _ => return,
        };
        self.outline.request(number, deed);
        self.inbox.wake();
    }

    /// Forwards a key press or release on an element of the outline. `modifiers` is the sum of 1
    /// for Shift, 2 for Control, 4 for Alt and 8 for Command.
    pub fn press(&self, key: &str, code: &str, pressed: bool, modifiers: u8) {
        let [shift, ctrl, alt, mac_cmd] = [1, 2, 4, 8].map(|bit| modifiers & bit != 0);
        let modifiers = Modifiers { alt, ctrl, shift, mac_cmd, command: ctrl || mac_cmd };
        self.outline.press(key, code, pressed, modifiers);
        self.inbox.wake();
    }

    /// Returns whether the link says that the page is embedded. An embedded page answers its parent
    /// page, and stores nothing.
    #[wasm_bindgen(js_name = isEmbedded)]
    pub fn is_embedded(&self) -> bool {
        self.segue.try_borrow().is_ok_and(|segue| segue.is_embedded())
    }

    /// Returns whether the app has panicked. Then only [`Self::panic_summary`] can be called.
    #[wasm_bindgen(js_name = hasPanicked)]
    pub fn has_panicked(&self) -> bool {
        self.runner.has_panicked()
    }

    /// Returns the message and the call stack of the panic; `None` where there was none.
    #[wasm_bindgen(js_name = panicSummary)]
    pub fn panic_summary(&self) -> Option<String> {
        self.runner
            .panic_summary()
            .map(|summary| format!("{}\n{}", summary.message(), summary.callstack()))
    }

    /// Reads a file, as if it were dropped on the page.
    pub async fn load(&self, name: String, bytes: Uint8Array) -> Result<JsValue, JsValue> {
        self.opened().await?;
        // The browser holds it, so that the app's memory has no copy.
        let large = LargeFile::of_bytes(&bytes)
            .ok_or_else(|| error(format!("{name}: this browser has no room for the file")))?;
        let file = FileBytes::Large(large);
        let task = self.borrow_mut()?.load_in_background(&name, file);
        self.changed();
        while self.borrow()?.is_reading(task) {
            sleep(10).await;
            // Frames do not run on a hidden page, so poll here.
            self.borrow_mut()?.poll();
        }
        self.settled().await?;
        let result = self.borrow_mut()?.read_result(task);
        match result {
            Some(Ok(loaded)) => {
                // The caller may leave the page once the file is loaded, so it has to be stored.
                let files = loaded.files();
                while self.borrow()?.is_storing(&files) {
                    sleep(5).await;
                }
                to_js(&loaded)
            }
            Some(Err(reason)) => Err(error(reason)),
            None => Err(error(format!("{name}: reading it was stopped"))),
        }
    }

    /// Returns every clip of the library.
    pub fn clips(&self) -> Result<JsValue, JsValue> {
        to_js(&self.borrow_mut()?.clips())
    }

    /// Waits until the stored work is restored, and all files are fetched and read. Returns every
    /// clip of the library.
    pub async fn loaded(&self) -> Result<JsValue, JsValue> {
        self.opened().await?;
        // Frames do not run on a hidden page, so poll here.
        while {
            let mut segue = self.borrow_mut()?;
            segue.poll();
            segue.check_storage().map_err(error)?;
            segue.is_loading()
        } {
            sleep(10).await;
        }
        self.clips()
    }

    /// Returns every parameter's value by its key.
    pub fn params(&self) -> Result<JsValue, JsValue> {
        to_js(&self.borrow()?.params())
    }

    /// Sets parameters, all or none. Waits until everything that depends on them is computed.
    pub async fn set(&self, values: JsValue) -> Result<(), JsValue> {
        let values = serde_wasm_bindgen::from_value(values).map_err(|_| {
            error("set: expected an object of keys and values, as in { blend_window: 24 }")
        })?;
        self.opened().await?;
        let set = self.borrow_mut()?.set(&values);
        self.changed();
        set.map_err(error)?;
        self.settled().await
    }

    /// Returns the table of parameters.
    #[expect(clippy::unused_self, reason = "a method in JavaScript")]
    pub fn keys(&self) -> Result<JsValue, JsValue> {
        to_js(&api::keys())
    }

    /// Returns the link that restores this state.
    pub fn url(&self) -> Result<String, JsValue> {
        Ok(self.borrow()?.url())
    }

    /// Starts playback.
    pub fn play(&self) -> Result<(), JsValue> {
        self.change(|segue| segue.play(true))
    }

    /// Stops playback.
    pub fn pause(&self) -> Result<(), JsValue> {
        self.change(|segue| segue.play(false))
    }

    /// Moves the playhead to a time, seconds.
    pub fn seek(&self, seconds: f64) -> Result<(), JsValue> {
        self.change(|segue| segue.seek(seconds))
    }

    /// Returns the position of the playhead, seconds.
    pub fn time(&self) -> Result<f64, JsValue> {
        Ok(self.borrow()?.time())
    }

    /// Returns a pose in the world; `which` is a clip's id, `result`, or `result:1` for the second
    /// pane. A clip whose motion is not in memory is read first.
    pub async fn pose(&self, which: String, seconds: f64) -> Result<JsValue, JsValue> {
        self.read(&which).await?;
        to_js(&self.borrow()?.pose(&which, seconds).map_err(error)?)
    }

    /// Returns the metrics of the results by their names, once the clips are read that they need.
    pub async fn metrics(&self) -> Result<JsValue, JsValue> {
        self.results_read().await?;
        to_js(&self.borrow()?.metrics().map_err(error)?)
    }

    /// Takes a clip out of the library that was only looked at: without a notice, and without a
    /// step of undo.
    pub fn discard(&self, id: String) -> Result<(), JsValue> {
        self.change(|segue| Ok(segue.apply(Command::Discard(id))?))
    }

    /// Begins or ends several changes that are one step of undo, also if time passes between them.
    #[wasm_bindgen(js_name = joinSteps)]
    pub fn join_steps(&self, begins: bool) -> Result<(), JsValue> {
        self.borrow_mut()?.join_steps(begins);
        Ok(())
    }

    /// Stops reading or fetching a file.
    pub fn stop(&self, name: &str) -> Result<(), JsValue> {
        self.change(|segue| segue.stop(name))
    }

    /// Returns a motion as the bytes of a file. A GLB file has the body that `body` names; `root`
    /// names the joint with the motion over the ground; `fps` is the frame rate. A clip whose
    /// motion is not in memory is read first.
    #[wasm_bindgen(js_name = exportClip)]
    pub async fn export_clip(
        &self,
        which: String,
        format: String,
        body: Option<String>,
        root: Option<String>,
        fps: Option<f64>,
    ) -> Result<Uint8Array, JsValue> {
        self.read(&which).await?;
        let refused = |reason: String| error(format!("export: {reason}"));
        let words = ExportWords { body, root, fps };
        let how = words.options(&format).map_err(|reason| refused(reason.to_string()))?;
        let begun = self.borrow_mut()?.begin_export(&which, &how, true);
        let task = match begun.map_err(|reason| refused(reason.to_string()))? {
            BegunExport::Done(file) => return Ok(Uint8Array::from(&file.bytes[..])),
            BegunExport::UnderWay(task) => task,
        };
        loop {
            sleep(5).await;
            let mut segue = self.borrow_mut()?;
            // A hidden page has no frames that would poll.
            segue.poll();
            match segue.take_export(task) {
                None => {}
                Some(Ok(file)) => {
                    return file.array().ok_or_else(|| refused("the file is gone".into()));
                }
                Some(Err(reason)) => return Err(refused(reason.to_string())),
            }
        }
    }

    /// Returns the bone map of a motion as the JSON of its file. A clip whose motion is not in
    /// memory is read first.
    #[wasm_bindgen(js_name = boneMap)]
    pub async fn bone_map(&self, which: String) -> Result<String, JsValue> {
        self.read(&which).await?;
        self.borrow()?.bone_map(&which).map_err(|reason| error(format!("boneMap: {reason}")))
    }

    /// Applies a bone map, the JSON of its file, to all clips that it fits.
    #[wasm_bindgen(js_name = setBoneMap)]
    pub fn set_bone_map(&self, json: &str) -> Result<(), JsValue> {
        self.change(|segue| segue.set_bone_map(json))
    }

    /// Puts a result into the library. Returns the id of the new clip.
    pub fn keep(&self, which: &str) -> Result<String, JsValue> {
        let kept =
            self.borrow_mut()?.keep(which).map_err(|reason| error(format!("keep: {reason}")));
        self.changed();
        kept
    }

    /// Returns the stage as a PNG.
    pub async fn snapshot(&self) -> Result<Blob, JsValue> {
        let canvas = self.canvas.borrow().clone();
        snapshot(
            &canvas,
            || self.frames(),
            || self.inbox.wake_for_picture(),
            || self.is_stage_complete(),
            || self.stage_area(),
        )
        .await
    }

    /// Returns a report of the results in Markdown, with a picture of the stage in it.
    pub async fn report(&self) -> Result<String, JsValue> {
        let canvas = self.canvas.borrow().clone();
        let picture = inline_picture(
            &canvas,
            || self.frames(),
            || self.inbox.wake_for_picture(),
            || self.is_stage_complete(),
            || self.stage_area(),
        )
        .await?;
        self.borrow()?.report(Some(&picture)).map_err(|reason| error(format!("report: {reason}")))
    }

    /// Begins to record the page.
    pub fn record(&self) -> Result<(), JsValue> {
        self.change(|segue| segue.begin_film().map_err(ApiError::Recording))
    }

    /// Ends the recording. Returns it as a Blob.
    #[wasm_bindgen(js_name = stopRecording)]
    pub async fn stop_recording(&self) -> Result<Blob, JsValue> {
        let film = self.borrow_mut()?.end_film();
        self.changed();
        film.map_err(|reason| error(format!("stopRecording: {reason}")))?.end().await
    }

    /// Returns statistics of the app.
    pub fn stats(&self) -> Result<JsValue, JsValue> {
        to_js(&self.borrow()?.stats(wasm_memory_bytes()))
    }

    /// Ends the app, and stores the work.
    pub fn destroy(&self) -> Result<(), JsValue> {
        {
            let mut segue = self.borrow_mut()?;
            segue.detach();
            segue.save_on_exit();
        }
        self.runner.destroy();
        Ok(())
    }
}

impl SegueHandle {
    fn frames(&self) -> u64 {
        self.segue.try_borrow().map_or(0, |segue| segue.frames_drawn())
    }

    /// Returns whether nothing is missing in the stage as it is drawn.
    fn is_stage_complete(&self) -> bool {
        self.inbox.ctx().is_none_or(|ctx| is_stage_complete(&ctx))
    }

    /// Returns the area of the stage on the canvas.
    fn stage_area(&self) -> Option<Area> {
        let place = self.segue.try_borrow().ok()?.stage_rect()?;
        Some(area_of(place, self.inbox.ctx()?.pixels_per_point()))
    }

    fn borrow(&self) -> Result<std::cell::Ref<'_, Segue>, JsValue> {
        self.segue
            .try_borrow()
            .map_err(|_| error("Segue is in the middle of something; ask again in a moment"))
    }

    fn borrow_mut(&self) -> Result<std::cell::RefMut<'_, Segue>, JsValue> {
        self.segue
            .try_borrow_mut()
            .map_err(|_| error("Segue is in the middle of something; ask again in a moment"))
    }

    fn change(
        &self,
        change: impl FnOnce(&mut Segue) -> Result<(), ApiError>,
    ) -> Result<(), JsValue> {
        let done = change(&mut *self.borrow_mut()?);
        self.changed();
        done.map_err(error)
    }

    /// Requests a frame, and reports events, after a change.
    fn changed(&self) {
        self.inbox.wake();
        if let Ok(mut segue) = self.segue.try_borrow_mut() {
            report_events(&self.listener, segue.take_events());
        }
    }

    /// Reads the motion of a clip if it is not in memory, and waits for it; a result waits for the
    /// clips that it is made of.
    async fn read(&self, which: &str) -> Result<(), JsValue> {
        let is_asked = self.borrow_mut()?.read_clip(which);
        if !is_asked {
            return self.results_read().await;
        }
        while self.borrow()?.is_reading_clip(which) {
            sleep(5).await;
            // A hidden page has no frames that would poll.
            self.borrow_mut()?.poll();
        }
        Ok(())
    }

    /// Waits until results that wait for clips to be read again are computed.
    async fn results_read(&self) -> Result<(), JsValue> {
        if !self.borrow()?.awaits_clips() {
            return Ok(());
        }
        while self.borrow()?.awaits_clips() {
            sleep(5).await;
            // A hidden page has no frames that would poll.
            self.borrow_mut()?.poll();
        }
        self.settled().await
    }

    /// Waits until the stored work is restored, or no longer expected.
    async fn opened(&self) -> Result<(), JsValue> {
        while self.borrow_mut()?.is_restoring() {
            sleep(5).await;
        }
        Ok(())
    }

    /// Waits until everything that depends on the last change is computed.
    async fn settled(&self) -> Result<(), JsValue> {
        // The change itself may have used up this turn.
        next_turn().await;
        loop {
            // Frames do not run on a hidden page, so poll here.
            let (more, is_busy) = {
                let mut segue = self.borrow_mut()?;
                (segue.poll(), segue.is_busy())
            };
            if more {
                next_turn().await;
            } else if is_busy {
                // Workers compute, or a file comes.
                sleep(2).await;
            } else {
                self.changed();
                return Ok(());
            }
        }
    }
}

/// Reports events to the page's listener after the current call, because the listener may call the
/// API.
fn report_events(listener: &Rc<RefCell<Option<Function>>>, events: Vec<Event>) {
    if events.is_empty() {
        return;
    }
    let Some(listener) = listener.borrow().clone() else {
        return;
    };
    spawn_local(async move {
        for event in events {
            let told = to_js(&event).and_then(|detail| {
                listener.call2(&JsValue::NULL, &JsValue::from(event.name()), &detail)
            });
            if let Err(error) = told {
                log::error!("a listener failed: {}", js_error_text(&error));
            }
        }
    });
}
