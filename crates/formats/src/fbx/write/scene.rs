//! The objects of a file as records.

use super::records::{CREATION_TIME, FILE_ID, Property, RecordWriter, VERSION};
use super::{AXES, CM_PER_M, Channel, FIRST_ID, Scene, TRANSLATION, Take};
use Property::{Bool, Double, Floats, Int, Ints, Long, Longs, Raw, Text};
use segue_motion::clip::UpAxis;

/// The numbers of the frame rates that the format lists.
const TIME_MODES: [(f64, i32); 12] = [
    (120.0, 1),
    (100.0, 2),
    (60.0, 3),
    (50.0, 4),
    (48.0, 5),
    (30.0, 6),
    (25.0, 10),
    (24.0, 11),
    (1000.0, 12),
    (96.0, 15),
    (72.0, 16),
    (119.88, 18),
];
/// The number of a rate that is not in the list.
const CUSTOM_TIME_MODE: i32 = 14;
/// Two rates are the same within this, frames per second.
const SAME_RATE: f64 = 1e-6;
/// The flag of keys between which values change linearly.
const LINEAR: i32 = 4;
/// The version of the records of curves.
const CURVE_VERSION: i32 = 4008;
/// The file's name for the program that made it.
const CREATOR: &str = concat!("Segue ", env!("CARGO_PKG_VERSION"));

/// The number of the document.
const DOCUMENT_ID: i64 = FIRST_ID - 1;

/// The numbers of a take's stack and layer, and of what follows them.
#[derive(Clone, Copy)]
struct TakeIds {
    stack: i64,
    layer: i64,
    /// The number of the first channel; its three curves follow, then the next channel.
    channels: i64,
}

impl TakeIds {
    fn channel(self, index: usize) -> i64 {
        self.channels + 4 * index as i64
    }

    fn curve(self, channel: usize, axis: usize) -> i64 {
        self.channel(channel) + 1 + axis as i64
    }
}

impl Scene {
    /// Returns the file; `None` when it is too large.
    pub(super) fn write(&self) -> Option<Vec<u8>> {
        let keys = self.takes.iter().flat_map(|take| &take.channels);
        let keys: usize = keys.flat_map(|channel| &channel.values).map(Vec::len).sum();
        let mut out = RecordWriter::new(12 * keys + 1024 * (self.models.len() + 8));
        header(&mut out);
        self.settings(&mut out);
        self.document(&mut out);
        out.record("References", &[], |_| {});
        self.definitions(&mut out);
        out.record("Objects", &[], |out| self.objects(out));
        out.record("Connections", &[], |out| self.connections(out));
        self.take_list(&mut out);
        out.finish()
    }

    fn model_id(index: usize) -> i64 {
        FIRST_ID + 2 * index as i64
    }

    fn attribute_id(index: usize) -> i64 {
        Self::model_id(index) + 1
    }

    fn take_ids(&self) -> Vec<TakeIds> {
        let mut next = Self::model_id(self.models.len());
        let take = |take: &Take| {
            let ids = TakeIds { stack: next, layer: next + 1, channels: next + 2 };
            next = ids.channel(take.channels.len());
            ids
        };
        self.takes.iter().map(take).collect()
    }

    fn settings(&self, out: &mut RecordWriter) {
        let centimetres = CM_PER_M / self.axes.units_per_metre;
        let [up, front, front_sign] = match self.axes.up {
            UpAxis::Y => [1, 2, 1],
            UpAxis::Z => [2, 1, -1],
        };
        let mode = TIME_MODES.iter().find(|(fps, _)| (fps - self.fps).abs() < SAME_RATE);
        let end = self.takes.iter().map(Take::end).max().unwrap_or(0);
        out.record("GlobalSettings", &[], |out| {
            out.leaf("Version", &[Int(1000)]);
            properties(out, |out| {
                for (name, value) in [
                    ("UpAxis", up),
                    ("UpAxisSign", 1),
                    ("FrontAxis", front),
                    ("FrontAxisSign", front_sign),
                    ("CoordAxis", 0),
                    ("CoordAxisSign", 1),
                    ("OriginalUpAxis", up),
                    ("OriginalUpAxisSign", 1),
                ] {
                    property(out, name, ["int", "Integer", ""], &[Int(value)]);
                }
                for name in ["UnitScaleFactor", "OriginalUnitScaleFactor"] {
                    property(out, name, ["double", "Number", ""], &[Double(centimetres)]);
                }
                let mode = mode.map_or(CUSTOM_TIME_MODE, |(_, mode)| *mode);
                property(out, "TimeMode", ["enum", "", ""], &[Int(mode)]);
                property(out, "TimeSpanStart", ["KTime", "Time", ""], &[Long(0)]);
                property(out, "TimeSpanStop", ["KTime", "Time", ""], &[Long(end)]);
                property(out, "CustomFrameRate", ["double", "Number", ""], &[Double(self.fps)]);
            });
        });
    }

    fn document(&self, out: &mut RecordWriter) {
        let active = self.takes.first().map_or("", |take| &take.name);
        out.record("Documents", &[], |out| {
            out.leaf("Count", &[Int(1)]);
            out.record("Document", &[Long(DOCUMENT_ID), Text("Scene"), Text("Scene")], |out| {
                properties(out, |out| {
                    property(out, "SourceObject", ["object", "", ""], &[]);
                    property(out, "ActiveAnimStackName", ["KString", "", ""], &[Text(active)]);
                });
                out.leaf("RootNode", &[Long(0)]);
            });
        });
    }

    /// Writes how many objects of each kind there are.
    fn definitions(&self, out: &mut RecordWriter) {
        let (takes, models) = (self.takes.len(), self.models.len());
        let channels: usize = self.takes.iter().map(|take| take.channels.len()).sum();
        let counts = [
            ("GlobalSettings", 1),
            ("NodeAttribute", models),
            ("Model", models),
            ("AnimationStack", takes),
            ("AnimationLayer", takes),
            ("AnimationCurveNode", channels),
            ("AnimationCurve", 3 * channels),
        ];
        let total: usize = counts.iter().map(|(_, count)| count).sum();
        out.record("Definitions", &[], |out| {
            out.leaf("Version", &[Int(100)]);
            out.leaf("Count", &[Int(total as i32)]);
            for (kind, count) in counts {
                out.record("ObjectType", &[Text(kind)], |out| {
                    out.leaf("Count", &[Int(count as i32)]);
                });
            }
        });
    }

    fn objects(&self, out: &mut RecordWriter) {
        for (index, model) in self.models.iter().enumerate() {
            let attribute = named(&model.name, "NodeAttribute");
            let head = [Long(Self::attribute_id(index)), Text(&attribute), Text("LimbNode")];
            out.record("NodeAttribute", &head, |out| {
                out.leaf("TypeFlags", &[Text("Skeleton")]);
            });
            let name = named(&model.name, "Model");
            let head = [Long(Self::model_id(index)), Text(&name), Text("LimbNode")];
            out.record("Model", &head, |out| {
                out.leaf("Version", &[Int(232)]);
                properties(out, |out| {
                    property(out, "RotationActive", ["bool", "", ""], &[Int(1)]);
                    property(out, "InheritType", ["enum", "", ""], &[Int(1)]);
                    property(out, "DefaultAttributeIndex", ["int", "Integer", ""], &[Int(0)]);
                    let place = model.place.map(Double);
                    property(out, TRANSLATION, [TRANSLATION, "", "A"], &place);
                });
                out.leaf("Shading", &[Bool(true)]);
                out.leaf("Culling", &[Text("CullingOff")]);
            });
        }
        for (take, ids) in self.takes.iter().zip(self.take_ids()) {
            take.write(ids, out);
        }
    }

    fn connections(&self, out: &mut RecordWriter) {
        let mut connect = |child: i64, parent: i64, to: Option<&str>| {
            let ids = [Long(child), Long(parent)];
            match to {
                None => out.leaf("C", &[Text("OO"), ids[0], ids[1]]),
                Some(property) => out.leaf("C", &[Text("OP"), ids[0], ids[1], Text(property)]),
            }
        };
        for (index, model) in self.models.iter().enumerate() {
            // 0 is the scene itself.
            connect(Self::model_id(index), model.parent.map_or(0, Self::model_id), None);
            connect(Self::attribute_id(index), Self::model_id(index), None);
        }
        for (take, ids) in self.takes.iter().zip(self.take_ids()) {
            connect(ids.layer, ids.stack, None);
            for (index, channel) in take.channels.iter().enumerate() {
                connect(ids.channel(index), ids.layer, None);
                let model = Self::model_id(channel.model);
                connect(ids.channel(index), model, Some(channel.property));
                for (axis, name) in AXES.into_iter().enumerate() {
                    connect(ids.curve(index, axis), ids.channel(index), Some(name));
                }
            }
        }
    }

    fn take_list(&self, out: &mut RecordWriter) {
        out.record("Takes", &[], |out| {
            let current = self.takes.first().map_or("", |take| &take.name);
            out.leaf("Current", &[Text(current)]);
            for take in &self.takes {
                out.record("Take", &[Text(&take.name)], |out| {
                    for span in ["LocalTime", "ReferenceTime"] {
                        out.leaf(span, &[Long(0), Long(take.end())]);
                    }
                });
            }
        });
    }
}

impl Take {
    fn write(&self, ids: TakeIds, out: &mut RecordWriter) {
        let name = named(&self.name, "AnimStack");
        out.record("AnimationStack", &[Long(ids.stack), Text(&name), Text("")], |out| {
            properties(out, |out| {
                for (name, time) in [
                    ("LocalStart", 0),
                    ("LocalStop", self.end()),
                    ("ReferenceStart", 0),
                    ("ReferenceStop", self.end()),
                ] {
                    property(out, name, ["KTime", "Time", ""], &[Long(time)]);
                }
            });
        });
        let name = named("BaseLayer", "AnimLayer");
        out.record("AnimationLayer", &[Long(ids.layer), Text(&name), Text("")], |_| {});
        for (index, channel) in self.channels.iter().enumerate() {
            channel.write(ids.channel(index), out);
            for (axis, values) in channel.values.iter().enumerate() {
                curve(ids.curve(index, axis), &self.times, values, out);
            }
        }
    }
}

impl Channel {
    fn write(&self, id: i64, out: &mut RecordWriter) {
        let name = named(if self.property == TRANSLATION { "T" } else { "R" }, "AnimCurveNode");
        out.record("AnimationCurveNode", &[Long(id), Text(&name), Text("")], |out| {
            properties(out, |out| {
                for (axis, values) in AXES.into_iter().zip(&self.values) {
                    let first = f64::from(values.first().copied().unwrap_or(0.0));
                    property(out, axis, ["Number", "", "A"], &[Double(first)]);
                }
            });
        });
    }
}

/// Writes a curve with a key for each value, at the first times.
fn curve(id: i64, times: &[i64], values: &[f32], out: &mut RecordWriter) {
    let keys = values.len().min(times.len());
    let name = named("", "AnimCurve");
    out.record("AnimationCurve", &[Long(id), Text(&name), Text("")], |out| {
        let first = f64::from(values.first().copied().unwrap_or(0.0));
        out.leaf("Default", &[Double(first)]);
        out.leaf("KeyVer", &[Int(CURVE_VERSION)]);
        out.leaf("KeyTime", &[Longs(&times[..keys])]);
        out.leaf("KeyValueFloat", &[Floats(&values[..keys])]);
        // One set of attributes for all keys.
        out.leaf("KeyAttrFlags", &[Ints(&[LINEAR])]);
        out.leaf("KeyAttrDataFloat", &[Floats(&[0.0; 4])]);
        out.leaf("KeyAttrRefCount", &[Ints(&[keys as i32])]);
    });
}

fn header(out: &mut RecordWriter) {
    out.record("FBXHeaderExtension", &[], |out| {
        out.leaf("FBXHeaderVersion", &[Int(1003)]);
        out.leaf("FBXVersion", &[Int(VERSION as i32)]);
        out.leaf("EncryptionType", &[Int(0)]);
        out.leaf("Creator", &[Text(CREATOR)]);
    });
    out.leaf("FileId", &[Raw(&FILE_ID)]);
    out.leaf("CreationTime", &[Text(CREATION_TIME)]);
    out.leaf("Creator", &[Text(CREATOR)]);
}

/// Returns a name with its class, as objects have them.
fn named(name: &str, class: &str) -> String {
    format!("{name}\0\u{1}{class}")
}

fn properties(out: &mut RecordWriter, inner: impl FnOnce(&mut RecordWriter)) {
    out.record("Properties70", &[], inner);
}

/// Writes a property: its name; type, label and flags; its values.
fn property(out: &mut RecordWriter, name: &str, kind: [&str; 3], values: &[Property<'_>]) {
    let head = [name, kind[0], kind[1], kind[2]].map(Text);
    out.leaf("P", &[head.as_slice(), values].concat());
}
