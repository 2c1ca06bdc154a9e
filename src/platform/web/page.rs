//! The window, its address and its clock.

use crate::platform::address::{backend_of, state_of, with_backend_of};
use crate::platform::{Inbox, Incoming};
use eframe::egui;
use js_sys::{Function, Promise};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
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

/// The canvas that the app is drawn on.
pub(super) fn canvas() -> Option<HtmlCanvasElement> {
    document()?.get_element_by_id("segue")?.dyn_into().ok()
}

/// Milliseconds since some fixed moment; never goes back.
pub(crate) fn now_ms() -> f64 {
    window()
        .and_then(|window| window.performance())
        .map_or_else(js_sys::Date::now, |performance| performance.now())
}

fn search() -> String {
    window().and_then(|window| window.location().search().ok()).unwrap_or_default()
}

/// The state that the page's address describes: its query, without `?` and without what belongs to
/// the page.
pub(crate) fn location_query() -> String {
    state_of(&search())
}

/// The user's languages, best first, as their tags.
pub(crate) fn languages() -> Vec<String> {
    window().map_or_else(Vec::new, |window| {
        window.navigator().languages().iter().filter_map(|tag| tag.as_string()).collect()
    })
}

/// Tells the browser and screen readers which language the page is in.
pub(crate) fn tell_language(tag: &str) {
    let root = document().and_then(|document| document.document_element());
    if let Some(root) = root.and_then(|root| root.dyn_into::<HtmlElement>().ok()) {
        root.set_lang(tag);
    }
}

/// The graphics that the page's address asks for.
pub(crate) fn wanted_backend() -> Option<String> {
    backend_of(&search())
}

/// Puts the state into the page's address. The history gets no entry.
pub(crate) fn replace_query(query: &str) {
    let Some(window) = window() else { return };
    let query = with_backend_of(query, &search());
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
        // A frame without an origin has no address of its own, and browsers limit how often it may
        // change. The state is not lost by it.
        log::debug!("the address was not changed: {}", super::words_of(&error));
    }
}

/// The whole link that restores a state.
pub(crate) fn full_link(query: &str) -> String {
    let base = window().and_then(|window| {
        let location = window.location();
        Some(format!("{}{}", location.origin().ok()?, location.pathname().ok()?))
    });
    format!("{}?{query}", base.unwrap_or_default())
}

/// Opens a page of the web in a new tab. That page gets neither a handle to this one, which it
/// could put a forgery in the place of, nor its address.
pub(crate) fn open_page(address: &str, _ctx: &egui::Context) {
    let opened = window().map(|window| {
        window.open_with_url_and_target_and_features(address, "_blank", "noopener,noreferrer")
    });
    if let Some(Err(error)) = opened {
        log::warn!("{address} was not opened: {}", super::words_of(&error));
    }
}

/// Whether this page stands in a frame of another one.
pub(crate) fn is_framed() -> bool {
    let window = window();
    let parent = window.as_ref().and_then(|window| window.parent().ok().flatten());
    // A page that stands alone is its own parent.
    parent.is_some() && parent != window
}

/// Tells the app when the user goes back or forward, or changes the address.
pub(crate) fn watch_navigation(inbox: &Inbox) {
    let inbox = inbox.clone();
    listen(window(), "popstate", move |_| inbox.push(Incoming::Navigated(location_query())));
}

/// Calls back when the page may be about to go: in the background a browser may end it without a
/// word.
pub(crate) fn watch_hiding(on_hide: impl Fn() + Clone + 'static) {
    let hidden = on_hide.clone();
    listen(document(), "visibilitychange", move |_| {
        if is_hidden() {
            hidden();
        }
    });
    listen(window(), "pagehide", move |_| on_hide());
}

/// Has the browser ask whether to leave the page, while there is something to lose.
pub(crate) fn ask_before_leaving_while(is_unsafe: impl Fn() -> bool + 'static) {
    listen(window(), "beforeunload", move |event| {
        if is_unsafe() {
            event.prevent_default();
        }
    });
}

/// Whether the user has asked their system for little motion.
pub(crate) fn prefers_stillness() -> bool {
    let asked = window()
        .and_then(|window| window.match_media("(prefers-reduced-motion: reduce)").ok().flatten());
    asked.is_some_and(|query| query.matches())
}

/// Whether nothing is drawn because nobody could see it.
pub(super) fn is_hidden() -> bool {
    document().is_some_and(|document| document.hidden())
}

/// Listens for as long as the page lives.
pub(crate) fn listen(
    target: Option<impl AsRef<EventTarget>>,
    event: &str,
    listener: impl FnMut(web_sys::Event) + 'static,
) {
    listen_in(target, event, false, listener);
}

/// The same, before whatever the event is meant for hears of it.
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
        log::error!("no `{event}` events: {}", super::words_of(&error));
    }
    closure.forget();
}

/// Waits.
pub(crate) async fn sleep(millis: i32) {
    resolved(|resolve| {
        window().is_some_and(|window| {
            window.set_timeout_with_callback_and_timeout_and_arguments_0(resolve, millis).is_ok()
        })
    })
    .await;
}

/// Waits until the browser has had its turn: input and frames that are due come first. Unlike
/// [`sleep`], which takes 4 ms at the least once it was called a few times in a row.
pub(crate) async fn turn() {
    resolved(|resolve| TURNS.with(|turns| turns.as_ref().is_some_and(|turns| turns.wait(resolve))))
        .await;
}

thread_local! {
    static TURNS: Option<Turns> = Turns::open();
}

/// One channel of the page to itself for all who wait for their turn. One for every wait would stay
/// in memory: a browser keeps a port that has a listener for as long as its other end could still
/// speak.
struct Turns {
    sender: MessagePort,
    waiting: Rc<RefCell<VecDeque<Function>>>,
}

impl Turns {
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

    /// Has a function called at the next turn; `false` when the browser takes no message.
    fn wait(&self, resolve: &Function) -> bool {
        let is_sent = self.sender.post_message(&JsValue::NULL).is_ok();
        if is_sent {
            self.waiting.borrow_mut().push_back(resolve.clone());
        }
        is_sent
    }
}

/// Whether [`between_frames`] does anything.
pub(crate) const WORKS_BETWEEN_FRAMES: bool = true;

/// All files are read by a worker, which has the code for it.
pub(crate) const READS_ELSEWHERE: bool = true;

/// Calls `work` again and again, between the browser's frames and whether there are any or not,
/// until it says that nothing is left.
pub(crate) fn between_frames(mut work: impl FnMut() -> bool + 'static) {
    spawn_local(async move {
        loop {
            turn().await;
            if !work() {
                return;
            }
        }
    });
}

/// Waits for the next frame of the page: what runs then runs after the app's own drawing, before
/// the picture is shown.
pub(crate) async fn next_frame() {
    resolved(|resolve| {
        window().is_some_and(|window| window.request_animation_frame(resolve).is_ok())
    })
    .await;
}

/// Waits for a function to be called that `ask` hands on; not at all when `ask` says that it could
/// not.
async fn resolved(mut ask: impl FnMut(&Function) -> bool) {
    let promise = Promise::new(&mut |resolve, _| {
        if !ask(&resolve) {
            resolve.call0(&JsValue::NULL).ok();
        }
    });
    JsFuture::from(promise).await.ok();
}
