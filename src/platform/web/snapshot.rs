//! A picture of the page.

use super::page::{document, is_hidden, next_frame};
use eframe::egui::Rect;
use js_sys::{Error, Promise};
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, CanvasRenderingContext2d, HtmlCanvasElement};

/// A rectangle of the canvas in its own pixels: left, top, width, height.
pub(crate) type Area = [f64; 4];

/// A rectangle of the page, points, as an area of the canvas.
pub(crate) fn area_of(rect: Rect, pixels_per_point: f32) -> Area {
    [rect.left(), rect.top(), rect.width(), rect.height()]
        .map(|points| f64::from(points * pixels_per_point).round())
}

/// How many frames to wait for one in which the app draws.
const MOST_FRAMES: usize = 120;

/// A picture for a text is at most this wide, pixels: it travels within the text.
const TEXT_PICTURE_WIDTH: f64 = 960.0;
/// And packed like this: a dark stage with a few bodies takes some 30 KB.
const TEXT_PICTURE_QUALITY: f64 = 0.85;

/// A part of the canvas as a PNG. For the rest see [`take`].
pub(crate) async fn snapshot(
    canvas: &HtmlCanvasElement,
    frames: impl Fn() -> u64,
    wake: impl Fn(),
    area: impl Fn() -> Option<Area>,
) -> Result<Blob, JsValue> {
    pack(&take(canvas, frames, wake, area, f64::INFINITY).await?).await
}

/// A part of the canvas as an address that is the picture itself (`data:image/jpeg;base64,…`).
pub(crate) async fn inline_picture(
    canvas: &HtmlCanvasElement,
    frames: impl Fn() -> u64,
    wake: impl Fn(),
    area: impl Fn() -> Option<Area>,
) -> Result<String, JsValue> {
    let picture = take(canvas, frames, wake, area, TEXT_PICTURE_WIDTH).await?;
    picture.to_data_url_with_type_and_encoder_options("image/jpeg", &TEXT_PICTURE_QUALITY.into())
}

/// A copy of a part of the canvas, at most so wide.
///
/// What WebGPU and WebGL draw can be read only until the frame ends. So this waits for a frame in
/// which the app draws (`frames` counts them, `wake` asks for one), copies the picture within it,
/// and packs the copy.
async fn take(
    canvas: &HtmlCanvasElement,
    frames: impl Fn() -> u64,
    wake: impl Fn(),
    area: impl Fn() -> Option<Area>,
    widest: f64,
) -> Result<HtmlCanvasElement, JsValue> {
    for _ in 0..MOST_FRAMES {
        if is_hidden() {
            return Err(Error::new(
                "snapshot: the page is hidden, so nothing is drawn; bring it to the front",
            )
            .into());
        }
        let before = frames();
        wake();
        next_frame().await;
        if frames() != before {
            return copy(canvas, area(), widest);
        }
    }
    Err(Error::new("snapshot: nothing was drawn").into())
}

fn copy(
    canvas: &HtmlCanvasElement,
    area: Option<Area>,
    widest: f64,
) -> Result<HtmlCanvasElement, JsValue> {
    let whole = [0.0, 0.0, f64::from(canvas.width()), f64::from(canvas.height())];
    let [x, y, width, height] = area.unwrap_or(whole);
    let copy: HtmlCanvasElement =
        document().ok_or("no document")?.create_element("canvas")?.dyn_into()?;
    let scale = (widest / width.max(1.0)).min(1.0);
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

async fn pack(canvas: &HtmlCanvasElement) -> Result<Blob, JsValue> {
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
