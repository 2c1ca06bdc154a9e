//! Pictures of the stage and films of the page, as files for the user.

use super::files::save_blob;
use super::js_error_text;
use super::page::{canvas, listen, now_ms, window};
use super::snapshot::{area_of, inline_picture, snapshot};
use crate::platform::{Inbox, Incoming};
use eframe::egui::{Context, Rect};
use js_sys::{Array, Error, Promise, Reflect};
use segue_session::export::file_name;
use segue_text::{Message, msg};
use std::cell::OnceCell;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{
    Blob, BlobEvent, BlobPropertyBag, MediaRecorder, MediaRecorderOptions, MediaStreamTrack,
    RecordingState,
};

/// The media types of films, in order of preference.
const MEDIA_TYPES: [&str; 4] =
    ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
/// The bit rate of films. The default of browsers is too low for thin lines on a smooth ground.
const BITS_PER_SECOND: u32 = 12_000_000;
/// The length of the parts in which the encoder delivers a film, milliseconds. Without parts, it
/// would keep a long film in memory.
const PART_MS: i32 = 1000;

/// Returns whether pictures of the stage can be saved.
pub(crate) fn can_take_pictures() -> bool {
    true
}

/// Saves a picture of the stage, a rectangle of the page in points, of a frame in which it is
/// complete.
pub(crate) fn save_picture(
    file_name: &str,
    stage: Rect,
    is_complete: fn(&Context) -> bool,
    inbox: &Inbox,
) {
    let (Some(canvas), Some(ctx)) = (canvas(), inbox.ctx()) else {
        return;
    };
    let (file_name, inbox) = (file_name.to_owned(), inbox.clone());
    spawn_local(async move {
        let area = area_of(stage, ctx.pixels_per_point());
        let taken = snapshot(
            &canvas,
            || ctx.cumulative_frame_nr(),
            || inbox.wake_for_picture(),
            || is_complete(&ctx),
            || Some(area),
        )
        .await;
        report_failure(&file_name, taken.and_then(|blob| save_blob(&file_name, &blob)), &inbox);
    });
}

/// Takes a picture of the stage, a rectangle of the page in points, for a text. The answer is
/// [`Incoming::Picture`].
pub(crate) fn take_picture(stage: Rect, is_complete: fn(&Context) -> bool, inbox: &Inbox) {
    let (Some(canvas), Some(ctx)) = (canvas(), inbox.ctx()) else {
        return inbox.push(Incoming::Picture(None));
    };
    let inbox = inbox.clone();
    spawn_local(async move {
        let area = area_of(stage, ctx.pixels_per_point());
        let taken = inline_picture(
            &canvas,
            || ctx.cumulative_frame_nr(),
            || inbox.wake_for_picture(),
            || is_complete(&ctx),
            || Some(area),
        )
        .await;
        if let Err(error) = &taken {
            log::warn!("no picture: {}", js_error_text(error));
        }
        inbox.push(Incoming::Picture(taken.ok()));
    });
}

/// Reports a file that could not be saved.
fn report_failure(file_name: &str, done: Result<(), JsValue>, inbox: &Inbox) {
    if let Err(error) = done {
        inbox.push(Incoming::Failed {
            reason: msg!(
                "{file} could not be saved: {error}.",
                file = file_name.to_owned(),
                error = js_error_text(&error)
            ),
        });
    }
}

/// Returns whether films can be made.
pub(crate) fn can_film() -> bool {
    thread_local! {
        static CAN_FILM: OnceCell<bool> = const { OnceCell::new() };
    }
    let has = |object: &JsValue, key: &str| Reflect::has(object, &key.into()).unwrap_or(false);
    let check = || {
        window().is_some_and(|window| has(&window, "MediaRecorder"))
            && canvas().is_some_and(|canvas| has(&canvas, "captureStream"))
    };
    CAN_FILM.with(|known| *known.get_or_init(check))
}

/// A film under way.
#[derive(Debug)]
pub(crate) struct Film {
    recorder: MediaRecorder,
    parts: Array,
    /// Resolves when the last part has arrived.
    ended: Promise,
    began_ms: f64,
}

impl Film {
    /// Begins to film the canvas.
    pub(crate) fn begin() -> Result<Self, Message> {
        if !can_film() {
            return Err("this browser cannot record what a page shows".into());
        }
        Self::of_canvas().map_err(|error| Message::data(js_error_text(&error)))
    }

    fn of_canvas() -> Result<Self, JsValue> {
        let stream = canvas().ok_or("no canvas")?.capture_stream()?;
        let options = MediaRecorderOptions::new();
        options.set_video_bits_per_second(BITS_PER_SECOND);
        if let Some(kind) =
            MEDIA_TYPES.into_iter().find(|kind| MediaRecorder::is_type_supported(kind))
        {
            options.set_mime_type(kind);
        }
        let recorder =
            MediaRecorder::new_with_media_stream_and_media_recorder_options(&stream, &options)?;
        let parts = Array::new();
        let collected = parts.clone();
        listen(Some(&recorder), "dataavailable", move |event| {
            if let Some(part) = event.unchecked_into::<BlobEvent>().data() {
                collected.push(&part);
            }
        });
        let ended = Promise::new(&mut |resolve, reject| {
            if let Err(error) = recorder.add_event_listener_with_callback("stop", &resolve) {
                reject.call1(&JsValue::NULL, &error).ok();
            }
        });
        recorder.start_with_time_slice(PART_MS)?;
        Ok(Self { recorder, parts, ended, began_ms: now_ms() })
    }

    /// Returns its duration, seconds.
    pub(crate) fn secs(&self) -> f64 {
        (now_ms() - self.began_ms) / 1e3
    }

    /// Ends it, and saves it for the user.
    pub(crate) fn save(self, stem: &str, inbox: &Inbox) {
        let ending =
            if self.recorder.mime_type().starts_with("video/mp4") { "mp4" } else { "webm" };
        let (name, inbox) = (file_name(stem, ending), inbox.clone());
        spawn_local(async move {
            let film = self.end().await;
            report_failure(&name, film.and_then(|blob| save_blob(&name, &blob)), &inbox);
        });
    }

    /// Ends it. Returns the whole film.
    pub(crate) async fn end(self) -> Result<Blob, JsValue> {
        // The recorder is inactive already where the canvas was removed.
        if self.recorder.state() != RecordingState::Inactive {
            self.recorder.stop()?;
        }
        JsFuture::from(self.ended).await?;
        for track in self.recorder.stream().get_tracks() {
            track.unchecked_into::<MediaStreamTrack>().stop();
        }
        let options = BlobPropertyBag::new();
        options.set_type(&self.recorder.mime_type());
        let film = Blob::new_with_blob_sequence_and_options(&self.parts, &options)?;
        if film.size() == 0.0 {
            return Err(Error::new("nothing was drawn meanwhile").into());
        }
        Ok(film)
    }
}
