//! The worker that computes for the page. It contains the algorithms of segue-motion and the labs
//! whose results of long clips it makes, and nothing of the app. `web/js/compute.js` calls it.

#[cfg(target_arch = "wasm32")]
mod worker {
    use js_sys::{Array, ArrayBuffer, Float32Array, Uint8Array};
    use segue_session::jobs::{ANSWER_PIECE_BYTES, ANSWER_PIECE_FLOATS, Parcel, Worker};
    use wasm_bindgen::prelude::wasm_bindgen;
    use wasm_bindgen::{JsCast as _, JsValue};

    /// The least number of floats that are copied into a buffer of full size, which the page gives
    /// back. A shorter array gets memory of its own length.
    const MIN_BUFFER_FLOATS: usize = ANSWER_PIECE_FLOATS / 8;

    /// Copies an array into JavaScript arrays of at most [`ANSWER_PIECE_FLOATS`], in buffers taken
    /// from `spares` as long as there are any: providing new memory takes the system as long as the
    /// copy.
    fn pieces_of(array: &[f32], spares: &Array) -> Array {
        let piece = |floats: &[f32]| {
            if floats.len() < MIN_BUFFER_FLOATS {
                return Float32Array::from(floats);
            }
            let spare = spares.pop().dyn_into();
            let buffer = spare.unwrap_or_else(|_| ArrayBuffer::new(ANSWER_PIECE_BYTES as u32));
            let length = floats.len() as u32;
            let piece = Float32Array::new_with_byte_offset_and_length(&buffer, 0, length);
            piece.copy_from(floats);
            piece
        };
        array.chunks(ANSWER_PIECE_FLOATS).map(piece).collect()
    }

    /// A worker with its clips and its memory.
    #[wasm_bindgen]
    #[derive(Debug)]
    pub struct Computer(Worker);

    #[wasm_bindgen]
    impl Computer {
        /// Returns a worker that keeps about `max_bytes` of intermediate results.
        #[wasm_bindgen(constructor)]
        pub fn new(max_bytes: f64) -> Self {
            Self(Worker::new(max_bytes as usize))
        }

        /// Takes in a clip under a number.
        #[wasm_bindgen(js_name = takeClip)]
        pub fn take_clip(
            &mut self,
            number: u32,
            head: String,
            floats: Vec<f32>,
            bytes: Vec<u8>,
        ) -> Result<(), JsValue> {
            let parcel = Parcel { head, floats, bytes, ..Parcel::default() };
            self.0.take_clip(number, &parcel).map_err(|error| error.to_string().into())
        }

        /// Drops a clip.
        #[wasm_bindgen(js_name = dropClip)]
        pub fn drop_clip(&mut self, number: u32) {
            self.0.drop_clip(number);
        }

        /// Runs a job and returns its answer: head, bytes, and the long arrays, each as a list of
        /// pieces in their order: first that of the floats, then one for each clip's rotations.
        /// Buffers of earlier answers are taken from `spares`.
        pub fn run(&mut self, message: &str, spares: &Array) -> Result<Array, JsValue> {
            let answer = self.0.run_message(message).map_err(|error| error.to_string())?;
            let rotations = answer.rotations.iter().map(|all| bytemuck::cast_slice(all));
            let arrays = std::iter::once(&answer.floats[..]).chain(rotations);
            let arrays = arrays.map(|array| pieces_of(array, spares));
            Ok(Array::of3(
                &JsValue::from(answer.head),
                &Uint8Array::from(&answer.bytes[..]),
                &arrays.collect::<Array>(),
            ))
        }
    }
}

/// Natively, the app's own threads compute.
fn main() {}
