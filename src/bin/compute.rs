//! The worker that computes for the page. It contains the algorithms of segue-motion and the labs
//! whose results of long clips it makes, and nothing of the app. `web/js/compute.js` calls it.

#[cfg(target_arch = "wasm32")]
mod worker {
    use js_sys::{Array, Float32Array, Uint8Array};
    use segue_session::jobs::{Parcel, Worker};
    use wasm_bindgen::JsValue;
    use wasm_bindgen::prelude::wasm_bindgen;

    /// The number of floats of an answer in one message: the page copies them in about 2 ms. A
    /// multiple of 4, so that no rotation is divided.
    const ANSWER_PIECE_FLOATS: usize = 1 << 19;

    /// Copies an array into JavaScript arrays of at most [`ANSWER_PIECE_FLOATS`].
    fn pieces_of(array: &[f32]) -> Array {
        array.chunks(ANSWER_PIECE_FLOATS).map(Float32Array::from).collect()
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
        pub fn run(&mut self, message: &str) -> Result<Array, JsValue> {
            let answer = self.0.run_message(message).map_err(|error| error.to_string())?;
            let rotations = answer.rotations.iter().map(|all| bytemuck::cast_slice(all));
            let arrays = std::iter::once(&answer.floats[..]).chain(rotations).map(pieces_of);
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
