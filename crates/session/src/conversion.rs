//! Conversion of many files at once: each is read, written in another format, and added to one
//! archive with a table of what was odd. No file's fault ends the others.
//!
//! ```text
//! file → reading::read_and_convert (a worker) → compressed files → Conversion → zip
//! clip of the library → Conversion::add_clip ─────────────────────────────────────┤
//! long one → packed::write (a worker) → Conversion::add_converted ────────────────┘
//! ```
//!
//! Motions stay with the worker, one file at a time: what remains of each is its compressed output.
//! Where one file is made of all ([`Conversion::in_one_file`]), motions come back instead, and are
//! put on its body one by one.

use crate::convert::{ConvertOptions, ConvertedClip, convert_motion};
use crate::export::{Together, file_name};
use crate::reading::{ReadReport, without_motion};
use segue_formats::csv::cell;
use segue_formats::{ZipFull, ZipWriter};
use segue_motion::clip::Motion;
use segue_motion::skin::{Character, SkinnedMesh};
use segue_text::{Message, ToMessage as _, msg};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::sync::Arc;

/// The name of the table in the archive.
const TABLE: &str = "conversion.csv";
/// The stem of the name of one file for all clips.
const ONE_FILE: &str = "clips";
/// The name of the archive.
const ARCHIVE: &str = "converted.zip";
/// The size from which on an archive takes no further files, bytes: it is held in memory.
const MAX_ZIP_BYTES: usize = 1 << 30;
/// The characters of a file's name that are kept.
const MAX_STEM: usize = 80;
/// More files than an archive has room for.
const MAX_FILES: u32 = 1 << 17;

/// A line of the table of a conversion.
#[derive(Clone, Debug, PartialEq)]
pub struct ConversionRow {
    /// The file that was read, or the clip of the library.
    pub source: String,
    /// The clip's name, the number of its frames, frames per second, and the number of joints.
    pub clip: Option<(String, usize, f64, usize)>,
    /// The file in the archive, or the reason why there is none.
    pub output: Result<String, Message>,
    /// The oddities, one sentence each.
    pub odd: Vec<Message>,
}

/// A conversion under way.
#[derive(Clone, Debug, Default)]
pub struct Conversion {
    options: ConvertOptions,
    zip: ZipWriter,
    /// The paths in the archive in lower case, which some systems do not tell apart.
    paths: BTreeSet<String>,
    rows: Vec<ConversionRow>,
    /// One file for all clips, in place of one for each.
    together: Option<Together>,
    one_file: Option<Vec<u8>>,
}

/// The file that a conversion has made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConvertedFile {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub mime: &'static str,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

impl Conversion {
    /// Begins a conversion.
    #[must_use]
    pub fn new(options: ConvertOptions) -> Self {
        Self { options, ..Self::default() }
    }

    /// Begins a conversion that makes one file of all clips, each an animation; see [`Together`].
    /// Files must be read without being converted.
    #[must_use]
    pub fn in_one_file(options: ConvertOptions, character: Option<&Character>) -> Self {
        let together = Some(Together::new(options.export, character));
        Self { together, ..Self::new(options) }
    }

    /// Returns its options.
    #[must_use]
    pub fn options(&self) -> &ConvertOptions {
        &self.options
    }

    /// Returns the table so far.
    #[must_use]
    pub fn rows(&self) -> &[ConversionRow] {
        &self.rows
    }

    /// Adds what became of a file, or the reason why it could not be read.
    pub fn add_report(&mut self, source: &str, report: Result<ReadReport, Message>) {
        let report = match report {
            Ok(report) => report,
            Err(reason) => return self.fail(source, reason),
        };
        if report.files.is_empty() {
            self.fail(source, msg!("it has no motion"));
        }
        let mut notes = report.notes;
        for file in report.files {
            let mut odd = std::mem::take(&mut notes);
            match (file.result, file.converted) {
                (Err(error), _) => self.fail(&file.name, error.to_message()),
                (Ok(read), None) if self.together.is_some() => {
                    if read.clips.is_empty() {
                        self.fail(&file.name, without_motion(read.awaits_skeleton));
                    }
                    odd.extend(read.warnings);
                    for clip in read.clips {
                        let (motion, odd) = (Arc::new(clip.motion), std::mem::take(&mut odd));
                        let name = motion.clip().name().to_owned();
                        self.join(&file.name, &name, &motion, clip.mesh.as_ref(), odd);
                    }
                }
                (Ok(_), None) => self.fail(&file.name, msg!("it has no motion")),
                (Ok(read), Some(converted)) => {
                    odd.extend(read.warnings);
                    let converted = converted.map(|mut converted| {
                        converted.file.deflated = file.unpacked.unwrap_or_default();
                        converted
                    });
                    self.add(&file.name, converted, odd);
                }
            }
        }
    }

    /// Converts a motion of the library here and adds it. `mesh` is as in [`convert_motion`].
    pub fn add_clip(&mut self, name: &str, motion: &Motion, mesh: Option<&Arc<SkinnedMesh>>) {
        if self.together.is_some() {
            return self.join(name, name, &Arc::new(motion.clone()), mesh, Vec::new());
        }
        self.add(name, convert_motion(motion, mesh, &self.options), Vec::new());
    }

    /// Adds a motion of the library that was converted elsewhere.
    pub fn add_converted(&mut self, name: &str, made: Result<ConvertedClip, Message>) {
        self.add(name, made, Vec::new());
    }

    /// Adds a clip to the one file.
    fn join(
        &mut self,
        source: &str,
        name: &str,
        motion: &Arc<Motion>,
        mesh: Option<&Arc<SkinnedMesh>>,
        mut odd: Vec<Message>,
    ) {
        let own = motion.clip();
        let clip = Some((own.name().to_owned(), own.frames(), own.fps(), own.skeleton().len()));
        let put_on = self.options.rig.as_ref().map(|rig| rig.put_on(motion)).transpose();
        let added = put_on.and_then(|put_on| {
            let mesh = mesh.filter(|_| put_on.is_none());
            let motion = put_on.map_or_else(|| Arc::clone(motion), Arc::new);
            self.together.as_mut().map_or(Ok(None), |together| together.add(name, &motion, mesh))
        });
        let output = added.map(|note| {
            odd.extend(note);
            file_name(ONE_FILE, self.options.export.format.ending())
        });
        self.rows.push(ConversionRow { source: source.to_owned(), clip, output, odd });
    }

    /// Writes the one file of all clips, if there is one and no clip is added any more. Lines of
    /// the table say where that failed.
    pub fn write_one_file(&mut self) {
        let Some(together) = self.together.take().filter(|together| !together.is_empty()) else {
            return;
        };
        match together.write() {
            Ok(bytes) => self.one_file = Some(bytes),
            Err(reason) => {
                for row in self.rows.iter_mut().filter(|row| row.output.is_ok()) {
                    row.output = Err(reason.clone());
                }
            }
        }
    }

    /// Adds a line for a file without result.
    pub fn fail(&mut self, source: &str, reason: Message) {
        let (source, odd) = (source.to_owned(), Vec::new());
        self.rows.push(ConversionRow { source, clip: None, output: Err(reason), odd });
    }

    fn add(&mut self, source: &str, made: Result<ConvertedClip, Message>, odd: Vec<Message>) {
        let clip =
            made.as_ref().ok().map(|made| (made.clip.clone(), made.frames, made.fps, made.joints));
        let output = made.and_then(|made| {
            let path = self.free_path(source, &made.clip);
            if self.zip.len() + made.file.deflated.len() > MAX_ZIP_BYTES {
                return Err(ZipFull.to_message());
            }
            self.zip.add_packed(&path, &made.file).map_err(|full| full.to_message())?;
            self.paths.insert(path.to_lowercase());
            Ok(path)
        });
        self.rows.push(ConversionRow { source: source.to_owned(), clip, output, odd });
    }

    /// Returns a path in the archive that no other file has: that of the source with the ending of
    /// the format, and with the clip's name where the source has several.
    fn free_path(&self, source: &str, clip: &str) -> String {
        let ending = self.options.export.format.ending();
        let mut parts: Vec<&str> =
            source.split(['/', '\\']).filter(|part| !part.is_empty()).collect();
        let name = parts.pop().unwrap_or_default();
        let name = name.strip_suffix(".gz").unwrap_or(name);
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let folders = parts.into_iter().fold(String::new(), |path, part| {
            // `..` would lead out of the folder in which the archive is unpacked.
            path + &file_name(part, "").trim_matches(['.', ' ']).replace("..", "_") + "/"
        });
        // With room for a number: long names are cut.
        let stem: String = stem.chars().take(MAX_STEM).collect();
        let names = [stem.clone(), format!("{stem} {clip}")].into_iter();
        let numbered = (2..=MAX_FILES).map(|number| format!("{stem} {number}"));
        names
            .chain(numbered)
            .map(|name| folders.clone() + &file_name(&name, ending))
            .find(|path| path != TABLE && !self.paths.contains(&path.to_lowercase()))
            .unwrap_or_default()
    }

    /// Returns what is to be saved: the one file of all clips, or the archive.
    #[must_use]
    pub fn into_file(mut self) -> ConvertedFile {
        self.write_one_file();
        let format = self.options.export.format;
        if let Some(bytes) = self.one_file.take() {
            let name = file_name(ONE_FILE, format.ending());
            ConvertedFile { name, mime: format.mime(), bytes }
        } else {
            let (name, bytes) = (ARCHIVE.to_owned(), self.finish());
            ConvertedFile { name, mime: "application/zip", bytes }
        }
    }

    /// Returns the archive with its table.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.write_one_file();
        if let Some(bytes) = self.one_file.take() {
            let name = file_name(ONE_FILE, self.options.export.format.ending());
            if let Err(full) = self.zip.store(&name, &bytes) {
                self.fail(&name, full.to_message());
            }
        }
        let table = self.table();
        // A table that has no room is shown on screen still.
        self.zip.store(TABLE, table.as_bytes()).ok();
        self.zip.finish()
    }

    /// Returns the table as CSV, in English.
    #[must_use]
    pub fn table(&self) -> String {
        let mut out = "source,clip,frames,fps,joints,file,odd,error\r\n".to_owned();
        for row in &self.rows {
            let (name, [frames, fps, joints]) = match &row.clip {
                None => ("", [const { String::new() }; 3]),
                Some((name, frames, fps, joints)) => {
                    (name.as_str(), [frames.to_string(), fps.to_string(), joints.to_string()])
                }
            };
            let odd: Vec<String> = row.odd.iter().map(ToString::to_string).collect();
            let (file, error) = match &row.output {
                Ok(path) => (path.clone(), String::new()),
                Err(reason) => (String::new(), reason.to_string()),
            };
            let cells = [&row.source, name, &frames, &fps, &joints, &file, &odd.join("; "), &error]
                .map(|text: &str| cell(text));
            // Writing to a string cannot fail.
            write!(out, "{}\r\n", cells.join(",")).ok();
        }
        out
    }
}

#[cfg(test)]
mod tests;
