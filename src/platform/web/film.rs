//! Pictures of the stage and films of the page, as files for the user.

use super::files::hand_over;
use super::page::{canvas, listen, now_ms, window};
use super::snapshot::{area_of, inline_picture, snapshot};
use super::words_of;
use crate::platform::{Inbox, Incoming};
use eframe::egui::Rect;
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

/// What films are packed as: the first of these that the browser can.
const KINDS: [&str; 4] =
    ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
/// Thin lines before a smooth ground need more than browsers give by themselves.
const BITS_PER_SECOND: u32 = 12_000_000;
/// What is filmed is handed over every so many milliseconds: a long film does not wait in the
/// encoder.
const PART_MS: i32 = 1000;

/// Whether pictures of the stage can be saved.
pub(crate) fn can_take_pictures() -> bool {
    true
}

/// Saves the stage, at that place on the page (points), as a picture.
pub(crate) fn save_picture(file_name: &str, stage: Rect, inbox: &Inbox) {
    let (Some(canvas), Some(ctx)) = (canvas(), inbox.ctx()) else {
        return;
    };
    let (file_name, inbox) = (file_name.to_owned(), inbox.clone());
    spawn_local(async move {
        let area = area_of(stage, ctx.pixels_per_point());
        let taken =
            snapshot(&canvas, || ctx.cumulative_frame_nr(), || inbox.wake(), || Some(area)).await;
        tell_failure(&file_name, taken.and_then(|blob| hand_over(&file_name, &blob)), &inbox);
    });
}

/// Takes a picture of the stage, at that place on the page (points), for a text:
/// [`Incoming::Picture`] brings it.
pub(crate) fn take_picture(stage: Rect, inbox: &Inbox) {
    let (Some(canvas), Some(ctx)) = (canvas(), inbox.ctx()) else {
        return inbox.push(Incoming::Picture(None));
    };
    let inbox = inbox.clone();
    spawn_local(async move {
        let area = area_of(stage, ctx.pixels_per_point());
        let taken =
            inline_picture(&canvas, || ctx.cumulative_frame_nr(), || inbox.wake(), || Some(area))
                .await;
        if let Err(error) = &taken {
            log::warn!("no picture: {}", words_of(error));
        }
        inbox.push(Incoming::Picture(taken.ok()));
    });
}

fn tell_failure(file_name: &str, done: Result<(), JsValue>, inbox: &Inbox) {
    if let Err(error) = done {
        inbox.push(Incoming::Failed {
            reason: msg!(
                "{file} could not be saved: {error}.",
                file = file_name.to_owned(),
                error = words_of(&error)
            ),
        });
    }
}

/// Whether films can be made.
pub(crate) fn can_film() -> bool {
    thread_local! {
        static CAN_FILM: OnceCell<bool> = const { OnceCell::new() };
    }
    let has = |object: &JsValue, key: &str| Reflect::has(object, &key.into()).unwrap_or(false);
    let look = || {
        window().is_some_and(|window| has(&window, "MediaRecorder"))
            && canvas().is_some_and(|canvas| has(&canvas, "captureStream"))
    };
    CAN_FILM.with(|known| *known.get_or_init(look))
}

/// A film under way.
#[derive(Debug)]
pub(crate) struct Film {
    recorder: MediaRecorder,
    parts: Array,
    /// Resolves when the last part is there.
    ended: Promise,
    began_ms: f64,
}

impl Film {
    /// Begins to film the canvas.
    pub(crate) fn begin() -> Result<Self, Message> {
        if !can_film() {
            return Err("this browser cannot record what a page shows".into());
        }
        Self::of_canvas().map_err(|error| Message::data(words_of(&error)))
    }

    fn of_canvas() -> Result<Self, JsValue> {
        let stream = canvas().ok_or("no canvas")?.capture_stream()?;
        let options = MediaRecorderOptions::new();
        options.set_video_bits_per_second(BITS_PER_SECOND);
        if let Some(kind) = KINDS.into_iter().find(|kind| MediaRecorder::is_type_supported(kind)) {
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

    /// How long it is, seconds.
    pub(crate) fn secs(&self) -> f64 {
        (now_ms() - self.began_ms) / 1e3
    }

    /// Ends it and hands it to the user.
    pub(crate) fn save(self, stem: &str, inbox: &Inbox) {
        let ending =
            if self.recorder.mime_type().starts_with("video/mp4") { "mp4" } else { "webm" };
        let (name, inbox) = (file_name(stem, ending), inbox.clone());
        spawn_local(async move {
            let film = self.end().await;
            tell_failure(&name, film.and_then(|blob| hand_over(&name, &blob)), &inbox);
        });
    }

    /// Ends it; all of it in one piece.
    pub(crate) async fn end(self) -> Result<Blob, JsValue> {
        // It has ended by itself where the canvas is gone.
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
