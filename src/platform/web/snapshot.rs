//! Pictures of the page.

use super::page::{document, is_hidden, next_frame};
use eframe::egui::Rect;
use js_sys::{Error, Promise};
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, CanvasRenderingContext2d, HtmlCanvasElement};

/// A rectangle of the canvas in its own pixels: left, top, width, height.
pub(crate) type Area = [f64; 4];

/// Returns the area of the canvas for a rectangle of the page in points.
pub(crate) fn area_of(rect: Rect, pixels_per_point: f32) -> Area {
    [rect.left(), rect.top(), rect.width(), rect.height()]
        .map(|points| f64::from(points * pixels_per_point).round())
}

/// The greatest number of frames to wait for one in which the app draws.
const MAX_AWAITED_FRAMES: usize = 120;

/// The greatest width of a picture that is embedded in a text, pixels.
const MAX_TEXT_PICTURE_WIDTH: f64 = 960.0;
/// The JPEG quality of a picture that is embedded in a text. A dark stage with a few bodies then
/// has about 30 KB.
const TEXT_PICTURE_QUALITY: f64 = 0.85;

/// Returns a part of the canvas as a PNG. The arguments are those of [`capture`].
pub(crate) async fn snapshot(
    canvas: &HtmlCanvasElement,
    frames: impl Fn() -> u64,
    wake: impl Fn(),
    is_complete: impl Fn() -> bool,
    area: impl Fn() -> Option<Area>,
) -> Result<Blob, JsValue> {
    encode(&capture(canvas, frames, wake, is_complete, area, f64::INFINITY).await?).await
}

/// Returns a part of the canvas as a `data:` URL (`data:image/jpeg;base64,…`). The arguments are
/// those of [`capture`].
pub(crate) async fn inline_picture(
    canvas: &HtmlCanvasElement,
    frames: impl Fn() -> u64,
    wake: impl Fn(),
    is_complete: impl Fn() -> bool,
    area: impl Fn() -> Option<Area>,
) -> Result<String, JsValue> {
    let picture = capture(canvas, frames, wake, is_complete, area, MAX_TEXT_PICTURE_WIDTH).await?;
    picture.to_data_url_with_type_and_encoder_options("image/jpeg", &TEXT_PICTURE_QUALITY.into())
}

/// Copies a part of the canvas, at most `max_width` pixels wide.
///
/// The pictures of WebGPU and WebGL can be read only until the frame ends. The function therefore
/// waits for a frame in which the app draws, and copies the picture within it. `frames` counts
/// frames, `wake` requests one that is drawn finely, and `is_complete` says whether nothing is
/// missing in it, such as a texture that is being decoded.
async fn capture(
    canvas: &HtmlCanvasElement,
    frames: impl Fn() -> u64,
    wake: impl Fn(),
    is_complete: impl Fn() -> bool,
    area: impl Fn() -> Option<Area>,
    max_width: f64,
) -> Result<HtmlCanvasElement, JsValue> {
    for awaited in 1..=MAX_AWAITED_FRAMES {
        if is_hidden() {
            return Err(Error::new(
                "snapshot: the page is hidden, so nothing is drawn; bring it to the front",
            )
            .into());
        }
        let before = frames();
        wake();
        next_frame().await;
        if frames() != before && (is_complete() || awaited == MAX_AWAITED_FRAMES) {
            return copy(canvas, area(), max_width);
        }
    }
    Err(Error::new("snapshot: nothing was drawn").into())
}

/// Copies an area of the canvas, or all of it, at most `max_width` pixels wide.
fn copy(
    canvas: &HtmlCanvasElement,
    area: Option<Area>,
    max_width: f64,
) -> Result<HtmlCanvasElement, JsValue> {
    let whole = [0.0, 0.0, f64::from(canvas.width()), f64::from(canvas.height())];
    let [x, y, width, height] = area.unwrap_or(whole);
    let copy: HtmlCanvasElement =
        document().ok_or("no document")?.create_element("canvas")?.dyn_into()?;
    let scale = (max_width / width.max(1.0)).min(1.0);
    let [wide, high] = [width, height].map(|side| (side * scale).round().max(1.0));
    copy.set_width(wide as u32);
    copy.set_height(high as u32);
    let context: CanvasRenderingContext2d = copy
        .get_context("2d")?
        .ok_or_else(|| Error::new("snapshot: this browser cannot copy pictures"))?
        .dyn_into()?;
    context.draw_image_with_html_canvas_element_and_sw_and_sh_and_dx_and_dy_and_dw_and_dh(
        canvas, x, y, width, height, 0.0, 0.0, wide, high,
    )?;
    Ok(copy)
}

/// Encodes a canvas as a PNG.
async fn encode(canvas: &HtmlCanvasElement) -> Result<Blob, JsValue> {
    let mut failed = None;
    let promise = Promise::new(&mut |resolve, reject| {
        let done = Closure::once_into_js(move |blob: JsValue| {
            if blob.is_null() {
                reject
                    .call1(&JsValue::NULL, &Error::new("snapshot: the picture could not be packed"))
                    .ok();
            } else {
                resolve.call1(&JsValue::NULL, &blob).ok();
            }
        });
        failed = canvas.to_blob_with_type(done.unchecked_ref(), "image/png").err();
    });
    if let Some(error) = failed {
        return Err(error);
    }
    JsFuture::from(promise).await?.dyn_into()
}
