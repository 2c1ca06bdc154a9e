//! The browser's window: address, clock, events, and waiting.

use crate::platform::address::{backend_of, pool_of, state_of, with_page_keys_of};
use crate::platform::{Inbox, Incoming};
use eframe::egui;
use js_sys::{Function, Promise, Reflect};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{
    Document, EventTarget, HtmlCanvasElement, HtmlElement, MessageChannel, MessagePort, Window,
};

pub(super) fn window() -> Option<Window> {
    web_sys::window()
}

pub(super) fn document() -> Option<Document> {
    window()?.document()
}

/// Returns the app's canvas.
pub(super) fn canvas() -> Option<HtmlCanvasElement> {
    document()?.get_element_by_id("segue")?.dyn_into().ok()
}

/// Returns the milliseconds since a fixed moment, by a monotonic clock.
pub(crate) fn now_ms() -> f64 {
    window()
        .and_then(|window| window.performance())
        .map_or_else(js_sys::Date::now, |performance| performance.now())
}

fn search() -> String {
    window().and_then(|window| window.location().search().ok()).unwrap_or_default()
}

/// Returns the query of the page's address, without `?` and without the keys that belong to the
/// page.
pub(crate) fn location_query() -> String {
    state_of(&search())
}

/// Returns the tags of the user's languages, the preferred one first.
pub(crate) fn languages() -> Vec<String> {
    window().map_or_else(Vec::new, |window| {
        window.navigator().languages().iter().filter_map(|tag| tag.as_string()).collect()
    })
}

/// Sets the language of the page for the browser and for screen readers.
pub(crate) fn set_page_language(tag: &str) {
    let root = document().and_then(|document| document.document_element());
    if let Some(root) = root.and_then(|root| root.dyn_into::<HtmlElement>().ok()) {
        root.set_lang(tag);
    }
}

/// Returns the graphics backend that the page's address selects.
pub(crate) fn requested_backend() -> Option<String> {
    backend_of(&search())
}

/// Returns the number of workers that the page's address selects.
pub(super) fn requested_pool() -> Option<String> {
    pool_of(&search())
}

/// Puts the state into the page's address, without an entry in the history.
pub(crate) fn replace_query(query: &str) {
    let Some(window) = window() else { return };
    let query = with_page_keys_of(query, &search());
    let location = window.location();
    let result = location.pathname().and_then(|path| {
        let hash = location.hash().unwrap_or_default();
        let address = if query.is_empty() {
            format!("{path}{hash}")
        } else {
            format!("{path}?{query}{hash}")
        };
        window.history()?.replace_state_with_url(&JsValue::NULL, "", Some(&address))
    });
    if let Err(error) = result {
        // A frame without an origin has no address of its own, and browsers limit the number of
        // changes. The state is not lost by a failure.
        log::debug!("the address was not changed: {}", super::js_error_text(&error));
    }
}

/// Returns the whole link that restores a state.
pub(crate) fn full_link(query: &str) -> String {
    let base = window().and_then(|window| {
        let location = window.location();
        Some(format!("{}{}", location.origin().ok()?, location.pathname().ok()?))
    });
    format!("{}?{query}", base.unwrap_or_default())
}

/// Opens a web page in a new tab. It gets no handle to this page, which it could replace by a
/// forgery, and not its address.
pub(crate) fn open_page(address: &str, _ctx: &egui::Context) {
    let opened = window().map(|window| {
        window.open_with_url_and_target_and_features(address, "_blank", "noopener,noreferrer")
    });
    if let Some(Err(error)) = opened {
        log::warn!("{address} was not opened: {}", super::js_error_text(&error));
    }
}

/// Returns whether another page frames this one.
pub(crate) fn is_framed() -> bool {
    let window = window();
    let parent = window.as_ref().and_then(|window| window.parent().ok().flatten());
    // A page outside any frame is its own parent.
    parent.is_some() && parent != window
}

/// Reports to `inbox` when the user goes back or forward, or changes the address.
pub(crate) fn watch_navigation(inbox: &Inbox) {
    let inbox = inbox.clone();
    listen(window(), "popstate", move |_| inbox.push(Incoming::Navigated(location_query())));
}

/// Calls `on_hide` when the page is hidden or closed. A browser may end a page in the background
/// without another event.
pub(crate) fn watch_hiding(on_hide: impl Fn() + Clone + 'static) {
    let hidden = on_hide.clone();
    listen(document(), "visibilitychange", move |_| {
        if is_hidden() {
            hidden();
        }
    });
    listen(window(), "pagehide", move |_| on_hide());
}

/// Makes the browser ask for confirmation before it leaves the page, while `is_unsafe` is true.
pub(crate) fn confirm_leaving_while(is_unsafe: impl Fn() -> bool + 'static) {
    listen(window(), "beforeunload", move |event| {
        if is_unsafe() {
            event.prevent_default();
        }
    });
}

/// Returns whether the user has set their system to reduced motion.
pub(crate) fn prefers_reduced_motion() -> bool {
    matches_media("(prefers-reduced-motion: reduce)")
}

/// Returns whether the page is worked by fingers: whether a finger is the main pointer.
pub(crate) fn has_coarse_pointer() -> bool {
    matches_media("(pointer: coarse)")
}

fn matches_media(query: &str) -> bool {
    let query = window().and_then(|window| window.match_media(query).ok().flatten());
    query.is_some_and(|query| query.matches())
}

/// Shows the page on the whole screen, or in its window again. A browser may refuse, as inside the
/// frame of another page; the page then stays as it is.
pub(crate) fn set_fullscreen(whole: bool, ctx: &egui::Context) {
    let Some(document) = document() else { return };
    let root = document.document_element();
    if !whole && is_fullscreen(ctx) {
        attempt(&document, "exitFullscreen");
    } else if let (true, Some(root)) = (whole, root) {
        attempt(&root, "requestFullscreen");
    }
}

/// Calls a method that answers by a promise, and may be refused.
fn attempt(target: &JsValue, method: &'static str) {
    let call = Reflect::get(target, &method.into()).and_then(JsCast::dyn_into::<Function>);
    let answer = call.and_then(|call| call.call0(target)).and_then(JsCast::dyn_into::<Promise>);
    match answer {
        Ok(promise) => spawn_local(async move {
            if let Err(error) = JsFuture::from(promise).await {
                log::info!("{method}: {}", super::js_error_text(&error));
            }
        }),
        Err(error) => log::info!("{method}: {}", super::js_error_text(&error)),
    }
}

/// Returns whether the page is shown on the whole screen.
pub(crate) fn is_fullscreen(_ctx: &egui::Context) -> bool {
    document().is_some_and(|document| document.fullscreen_element().is_some())
}

/// Returns whether the page is hidden, so that nothing is drawn.
pub(super) fn is_hidden() -> bool {
    document().is_some_and(|document| document.hidden())
}

/// Adds a listener for the life of the page.
pub(crate) fn listen(
    target: Option<impl AsRef<EventTarget>>,
    event: &str,
    listener: impl FnMut(web_sys::Event) + 'static,
) {
    listen_in(target, event, false, listener);
}

/// Adds a listener in the capture phase, before the event's target receives it.
pub(super) fn listen_first(
    target: Option<impl AsRef<EventTarget>>,
    event: &str,
    listener: impl FnMut(web_sys::Event) + 'static,
) {
    listen_in(target, event, true, listener);
}

fn listen_in(
    target: Option<impl AsRef<EventTarget>>,
    event: &str,
    capture: bool,
    listener: impl FnMut(web_sys::Event) + 'static,
) {
    let Some(target) = target else { return };
    let closure = Closure::<dyn FnMut(web_sys::Event)>::new(listener);
    if let Err(error) = target.as_ref().add_event_listener_with_callback_and_bool(
        event,
        closure.as_ref().unchecked_ref(),
        capture,
    ) {
        log::error!("no `{event}` events: {}", super::js_error_text(&error));
    }
    closure.forget();
}

/// Waits for a time, milliseconds.
pub(crate) async fn sleep(millis: i32) {
    resolved(|resolve| {
        window().is_some_and(|window| {
            window.set_timeout_with_callback_and_timeout_and_arguments_0(resolve, millis).is_ok()
        })
    })
    .await;
}

/// Waits until the browser has handled input and frames that are due. It is shorter than
/// [`sleep`], which takes at least 4 ms after a few calls in a row.
pub(crate) async fn next_turn() {
    resolved(|resolve| {
        TURN_CHANNEL.with(|channel| channel.as_ref().is_some_and(|channel| channel.wait(resolve)))
    })
    .await;
}

thread_local! {
    static TURN_CHANNEL: Option<TurnChannel> = TurnChannel::open();
}

/// A message channel of the page to itself, shared by all calls of [`next_turn`]. A channel for
/// each call would stay in memory, because a browser keeps a port with a listener while its other
/// end exists.
struct TurnChannel {
    sender: MessagePort,
    waiting: Rc<RefCell<VecDeque<Function>>>,
}

impl TurnChannel {
    fn open() -> Option<Self> {
        let channel = MessageChannel::new().ok()?;
        let waiting = Rc::new(RefCell::new(VecDeque::<Function>::new()));
        let queue = Rc::clone(&waiting);
        let on_message = Closure::<dyn FnMut()>::new(move || {
            let first = queue.borrow_mut().pop_front();
            if let Some(first) = first {
                first.call0(&JsValue::NULL).ok();
            }
        });
        channel.port1().set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        on_message.forget();
        Some(Self { sender: channel.port2(), waiting })
    }

    /// Calls a function at the next turn. Returns `false` when the browser takes no message.
    fn wait(&self, resolve: &Function) -> bool {
        let is_sent = self.sender.post_message(&JsValue::NULL).is_ok();
        if is_sent {
            self.waiting.borrow_mut().push_back(resolve.clone());
        }
        is_sent
    }
}

/// Whether [`between_frames`] runs work.
pub(crate) const WORKS_BETWEEN_FRAMES: bool = true;

/// Whether all files are read in the background. The page's WebAssembly has no code to read files;
/// the worker's has.
pub(crate) const READS_IN_BACKGROUND: bool = true;

/// Calls `work` repeatedly between the browser's frames until it returns `false`, even while the
/// page draws no frames.
pub(crate) fn between_frames(mut work: impl FnMut() -> bool + 'static) {
    spawn_local(async move {
        loop {
            next_turn().await;
            if !work() {
                return;
            }
        }
    });
}

/// Waits for the next frame of the page. The code after it runs after the app's own drawing, before
/// the picture is shown.
pub(crate) async fn next_frame() {
    resolved(|resolve| {
        window().is_some_and(|window| window.request_animation_frame(resolve).is_ok())
    })
    .await;
}

/// Waits until the function is called that `register` gets; returns at once when `register` returns
/// `false`.
async fn resolved(mut register: impl FnMut(&Function) -> bool) {
    let promise = Promise::new(&mut |resolve, _| {
        if !register(&resolve) {
            resolve.call0(&JsValue::NULL).ok();
        }
    });
    JsFuture::from(promise).await.ok();
}
