//! Corpora: thousands of motion files as a few static files, which can be searched by range
//! requests.
//!
//! # The idea
//!
//! Each file is processed by itself, so any number of workers can process them, in any order:
//! [`process_file`] is a pure function from bytes to a [`FileRecord`]. What depends on all files
//! (scales of features, lists of similar moments, copies) is made of the records by a [`Gatherer`],
//! which sorts them by the hash of their content: the same files give the same bytes, however and
//! wherever they were read.
//!
//! ```text
//! bytes → clips → artefacts, size, rate, rig → (cleaned) → standard body → contacts, features
//!       → poses, thumbnail, signature                                        = FileRecord
//! all records, by hash → shards of poses · copies · scales → map, centroids → lists = Gathered
//! its rows, with paths and labels → columns                                     = columns.bin
//! ```
//!
//! - *Standard body*: the synthesiser's, 22 joints, 1.75 m tall. Motions are put on it by
//!   [`segue_motion::retarget`], so that clips can be compared, and all poses have one size.
//! - *Poses* ([`encode_poses`]): rotations in 48 bits (smallest three), roots in single precision,
//!   contacts in one byte: 145 bytes a frame, 30 frames a second.
//! - *Features*: those of motion matching ([`segue_motion::matching`]), ten rows a second.
//! - *Index* ([`Index`]): an inverted file. Moments are sorted into lists by their nearest
//!   centroid; a search reads the centroids and a few lists.
//! - *Copies* ([`Signature`]): hands, feet and head at eight moments, compared in centimetres.
//! - *Columns* ([`write_columns`], [`Table`]): what a page shows of all rows, in a few bytes each:
//!   texts by what they share with their neighbours, numbers in one byte.
//! - *Map*: two principal components of the mean features of clips.
//! - *Page* ([`CorpusPage`]): a corpus whose bytes come by ranges.
//!
//! The files and their bytes are described in `docs/corpus.md`.
//!
//! # Example
//!
//! ```
//! use segue_corpus::{Gatherer, Index, Options, process_file, work_key};
//! use segue_formats::bvh;
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let mut gatherer = Gatherer::new(Options::default())?;
//! for action in [Action::Walk, Action::Run] {
//!     let clip = synthesize(&Params::new(action))?.clip;
//!     let file = bvh::write(&clip, &bvh::WriteOptions::default()).into_bytes();
//!     let key = work_key("a.bvh", &file, &[], &Options::default());
//!     gatherer.add(&key, &process_file("a.bvh", &file, &[], &Options::default()))?;
//! }
//! let corpus = gatherer.finish()?;
//! assert_eq!(corpus.rows.len(), 2);
//!
//! // A search reads byte ranges of the files.
//! let index = Index::read(&corpus.centroids)?;
//! let query = vec![0.0; index.dims()];
//! let mut lists = Vec::new();
//! for list in index.nearest_lists(&query, 8)? {
//!     let place = index.place(list).ok_or("no such list")?;
//!     lists.push((list, &corpus.lists[place.file][place.bytes()]));
//! }
//! assert_eq!(index.search(&query, &lists, 5)?.len(), 5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! Rotations are kept to 0.01°. Distances in the index are those of the features to a few
//! thousandths. With the probes that `corpus.json` states, which are measured on the corpus, a
//! search finds more than 95 % of the ten nearest moments of synthesised motion. In the columns,
//! metrics are kept to 2 %. Reading is most of the time; gathering is O(moments × √lists).
//!
//! # What it does not do
//!
//! Fingers, faces and props are not on the standard body. Copies are those of whole clips: one that
//! was cut is not found. It reads no files and starts no threads: the Python package does.
//!
//! # Sources
//!
//! Jégou, Douze, Schmid, "Product quantization for nearest neighbor search", 2011, section IV (the
//! inverted file with residuals). Clavet, "Motion Matching and The Road to Next-Gen Animation", GDC
//! 2016 (features). Lloyd, "Least squares quantization in PCM", 1982. Witten, Moffat, Bell,
//! "Managing Gigabytes", 1999, section 4.1 (front coding). Pearson, "On lines and planes of closest
//! fit to systems of points in space", 1901 (principal components).

mod bytes;
mod columns;
mod error;
mod gather;
mod index;
mod manifest;
mod map;
mod pack;
mod packed;
mod page;
mod pose;
mod process;
mod record;
mod rotation;
mod scaling;
mod signature;
mod standard;
mod table;
mod thumbnail;

pub use columns::{RowTexts, write_columns};
pub use error::{CorpusError, PlaceError};
pub use gather::{CorpusRow, Gathered, Gatherer};
pub use index::{Hit, Index, ListPlace};
pub use manifest::{COLUMNS, FORMAT, column_rows};
pub use pack::{Piece, SHARD_BYTES, Slot};
pub use page::{CorpusPage, PageError};
pub use pose::{PoseClip, decode_poses, encode_poses};
pub use process::{Options, process_file, work_key};
pub use record::{ClipRecord, ClipRow, FileRecord, Status};
pub use rotation::{decode_rotation, encode_rotation};
pub use scaling::Scaling;
pub use signature::{MAX_DISTANCE_CM, Signature};
pub use standard::{FEATURE_STEP, POSE_FPS, PlacedClip, StandardBody};
pub use table::{Cells, Column, ColumnKind, Copies, Filter, Sort, Table};
pub use thumbnail::{THUMBNAIL_POSES, THUMBNAIL_SIZE, thumbnail};
