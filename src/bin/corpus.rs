//! A corpus in the page: its table, and the search for moments. It contains the reading half of
//! segue-corpus, and nothing of the app. The scripts of `web/js/corpus/` call it.

#[cfg(target_arch = "wasm32")]
mod page {
    use js_sys::{Object, Reflect};
    use segue_corpus::{CorpusPage, PageError, Slot};
    use wasm_bindgen::JsValue;
    use wasm_bindgen::prelude::wasm_bindgen;

    /// A corpus.
    #[wasm_bindgen]
    #[derive(Debug)]
    pub struct Corpus(CorpusPage);

    #[wasm_bindgen]
    impl Corpus {
        /// Returns the corpus of a `corpus.json` and its `columns.bin`.
        #[wasm_bindgen(constructor)]
        pub fn new(manifest: &str, columns: &[u8]) -> Result<Self, JsValue> {
            CorpusPage::new(manifest, columns).map(Self).map_err(thrown)
        }

        /// Returns the number of rows.
        pub fn rows(&self) -> u32 {
            self.0.table().rows() as u32
        }

        /// Returns the counts in `corpus.json`, as JSON.
        pub fn counts(&self) -> Result<String, JsValue> {
            self.0.counts().map_err(thrown)
        }

        /// Returns the columns of the table, as JSON.
        pub fn columns(&self) -> Result<String, JsValue> {
            self.0.columns().map_err(thrown)
        }

        /// Returns the rows of a filter, which is JSON, in its order.
        pub fn select(&self, filter: &str) -> Result<Vec<u32>, JsValue> {
            self.0.select(filter).map_err(thrown)
        }

        /// Returns how many of the rows of a filter have which value of a column.
        pub fn histogram(
            &self,
            column: &str,
            filter: &str,
            bins: u32,
        ) -> Result<Vec<u32>, JsValue> {
            self.0.histogram(column, filter, bins as usize).map_err(thrown)
        }

        /// Returns what the table shows of some rows, as JSON.
        pub fn cells(&self, rows: &[u32]) -> Result<String, JsValue> {
            self.0.cells(rows).map_err(thrown)
        }

        /// Returns the row of an id, or of a beginning of one that no other row has.
        pub fn find(&self, id: &str) -> Option<u32> {
            self.0.table().find(id)
        }

        /// Returns the rows of the same motion, without the row itself.
        #[wasm_bindgen(js_name = copiesOf)]
        pub fn copies_of(&self, row: u32) -> Vec<u32> {
            self.0.table().copies_of(row)
        }

        /// Returns the place of each row on the map, x and y from -1 to 1.
        pub fn map(&self) -> Vec<f32> {
            self.0.table().map()
        }

        /// Returns the place of a row's poses: shard, first byte, number of bytes.
        pub fn poses(&self, row: u32) -> Option<Vec<f64>> {
            self.0.table().poses(row).map(place)
        }

        /// Returns the place of a row's thumbnail: shard, first byte, number of bytes.
        pub fn thumbnail(&self, row: u32) -> Option<Vec<f64>> {
            self.0.table().thumbnail(row).map(place)
        }

        /// Takes in `index/centroids.bin`.
        #[wasm_bindgen(js_name = setIndex)]
        pub fn set_index(&mut self, centroids: &[u8]) -> Result<(), JsValue> {
            self.0.set_index(centroids).map_err(thrown)
        }

        /// Returns the query of a moment of a clip of the corpus.
        #[wasm_bindgen(js_name = queryOfPoses)]
        pub fn query_of_poses(&self, poses: &[u8], seconds: f64) -> Result<Vec<f32>, JsValue> {
            self.0.query_of_poses(poses, seconds).map_err(thrown)
        }

        /// Returns the query of a moment of an NPZ file.
        #[wasm_bindgen(js_name = queryOfFile)]
        pub fn query_of_file(
            &self,
            name: &str,
            bytes: &[u8],
            seconds: f64,
        ) -> Result<Vec<f32>, JsValue> {
            self.0.query_of_file(name, bytes, seconds).map_err(thrown)
        }

        /// Returns the lists that a search reads, the nearest first: list, file, first byte, number
        /// of bytes of each.
        #[wasm_bindgen(js_name = nearestLists)]
        pub fn nearest_lists(&self, query: &[f32], probes: u32) -> Result<Vec<f64>, JsValue> {
            let lists = self.0.nearest_lists(query, probes as usize).map_err(thrown)?;
            let flat = |(list, place): (usize, segue_corpus::ListPlace)| {
                [list, place.file, place.offset, place.length].map(|number| number as f64)
            };
            Ok(lists.into_iter().flat_map(flat).collect())
        }

        /// Takes in the bytes of a list.
        #[wasm_bindgen(js_name = takeList)]
        pub fn take_list(&mut self, list: u32, bytes: Vec<u8>) -> Result<(), JsValue> {
            self.0.take_list(list as usize, bytes).map_err(thrown)
        }

        /// Returns the nearest moment of each clip in some lists, as JSON.
        pub fn search(&self, query: &[f32], lists: &[u32], count: u32) -> Result<String, JsValue> {
            let lists: Vec<usize> = lists.iter().map(|list| *list as usize).collect();
            self.0.search(query, &lists, count as usize).map_err(thrown)
        }

        /// Returns a clip of the corpus, or a part of it, as an NPZ file.
        pub fn npz(
            &self,
            name: &str,
            poses: &[u8],
            from: Option<f64>,
            to: Option<f64>,
        ) -> Result<Vec<u8>, JsValue> {
            self.0.npz(name, poses, from, to).map_err(thrown)
        }
    }

    fn place(slot: Slot) -> Vec<f64> {
        [slot.shard, slot.offset, slot.length].map(|number| number as f64).to_vec()
    }

    /// Returns what is thrown: an object with the `word` of a sentence, or a text.
    #[expect(clippy::needless_pass_by_value, reason = "passed to map_err")]
    fn thrown(error: PageError) -> JsValue {
        let Some(word) = error.word() else {
            return error.to_string().into();
        };
        let object = Object::new();
        // A new object takes any property.
        Reflect::set(&object, &"word".into(), &word.into()).ok();
        object.into()
    }
}

/// Natively, the Python package reads corpora.
fn main() {}
