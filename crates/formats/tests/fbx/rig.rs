//! Characters and takes, and the FBX documents that hold them.

use crate::document::{Element, Value, branch, leaf, property};
use glam::DMat4;

/// Units of time in a second.
const TICKS: i64 = 46_186_158_000;

/// A node of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Node {
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) parent: Option<usize>,
    pub(crate) place: [f64; 3],
    pub(crate) turn: [f64; 3],
    pub(crate) scale: Option<[f64; 3]>,
    /// Further properties of its transform, such as `PreRotation`.
    pub(crate) more: Vec<(&'static str, [f64; 3])>,
    /// The way in which it inherits scale, 0 to 2; 1 where `None`.
    pub(crate) inherits: Option<i32>,
    /// 0 to 5: XYZ, XZY, YZX, YXZ, ZXY, ZYX.
    pub(crate) order: i32,
}

/// The keys of one property of a node: a value for each frame.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub(crate) node: usize,
    pub(crate) property: &'static str,
    pub(crate) values: Vec<[f64; 3]>,
    /// Whether its keys have all kinds of interpolation and tangents; otherwise they are linear.
    pub(crate) is_mixed: bool,
}

/// A take of several layers, of which the first is the base and others are added.
#[derive(Clone, Debug)]
pub(crate) struct Take {
    pub(crate) name: String,
    pub(crate) layers: Vec<Vec<Track>>,
}

/// A triangle or quad that follows nodes.
#[derive(Clone, Debug)]
pub(crate) struct Skin {
    pub(crate) vertices: Vec<[f64; 3]>,
    pub(crate) faces: Vec<Vec<i32>>,
    /// Node, its transform in the world when bound, and its vertices.
    pub(crate) clusters: Vec<(usize, DMat4, Vec<i32>)>,
    /// Without it, the skin is red.
    pub(crate) paint: Option<Paint>,
}

/// The materials of a skin.
#[derive(Clone, Debug, Default)]
pub(crate) struct Paint {
    /// Sets of texture coordinates by name, with a place for each corner of each face; v points up.
    pub(crate) sets: Vec<(&'static str, Vec<[f64; 2]>)>,
    pub(crate) materials: Vec<Material>,
    /// The material of each face.
    pub(crate) of_faces: Vec<i32>,
}

/// A material.
#[derive(Clone, Debug, Default)]
pub(crate) struct Material {
    pub(crate) color: [f64; 3],
    pub(crate) factor: f64,
    pub(crate) texture: Option<Texture>,
}

/// A texture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Texture {
    /// The path of its image on another machine, and the image where the file contains it.
    pub(crate) relative_path: &'static str,
    pub(crate) absolute_path: &'static str,
    pub(crate) content: Vec<u8>,
    /// Further properties.
    pub(crate) more: Vec<Element>,
    /// Whether it is that of the opacity, too.
    pub(crate) is_opacity: bool,
}

/// A file.
#[derive(Clone, Debug)]
pub(crate) struct File {
    pub(crate) nodes: Vec<Node>,
    pub(crate) takes: Vec<Take>,
    pub(crate) skin: Option<Skin>,
    pub(crate) fps: f64,
    /// Centimetres per unit.
    pub(crate) unit: f64,
    pub(crate) z_up: bool,
}

fn text(text: &str) -> Value {
    Value::Text(text.into())
}

fn link(child: i64, parent: i64, property: Option<&str>) -> Element {
    let kind = text(if property.is_some() { "OP" } else { "OO" });
    let mut values = vec![kind, Value::Long(child), Value::Long(parent)];
    values.extend(property.map(text));
    leaf("C", values)
}

fn object(class: &str, id: i64, name: &str, kind: &'static str, more: Vec<Element>) -> Element {
    let named = match class {
        "NodeAttribute" => "NodeAttribute",
        "AnimationStack" => "AnimStack",
        "AnimationLayer" => "AnimLayer",
        "AnimationCurveNode" => "AnimCurveNode",
        "AnimationCurve" => "AnimCurve",
        "Model" => "Model",
        "Geometry" => "Geometry",
        "Material" => "Material",
        "Texture" => "Texture",
        "Video" => "Video",
        _ => "SubDeformer",
    };
    branch(class, vec![Value::Long(id), Value::Object(name.into(), named), text(kind)], more)
}

impl File {
    /// Returns the document of version 7: objects with numbers, and links between them.
    pub(crate) fn document(&self) -> Vec<Element> {
        let (mut objects, mut links, mut next) = (Vec::new(), Vec::new(), 1_000_000_i64);
        let mut id = || {
            next += 1;
            next
        };
        let nodes: Vec<i64> = self.nodes.iter().map(|_| id()).collect();
        for (node, &own) in self.nodes.iter().zip(&nodes) {
            let mut properties = vec![
                property("RotationActive", "bool", &[1.0]),
                property("InheritType", "enum", &[f64::from(node.inherits.unwrap_or(1))]),
                property("Lcl Translation", "Lcl Translation", &node.place),
                property("Lcl Rotation", "Lcl Rotation", &node.turn),
                property("Lcl Scaling", "Lcl Scaling", &node.scale.unwrap_or([1.0; 3])),
                property("RotationOrder", "enum", &[f64::from(node.order)]),
            ];
            properties
                .extend(node.more.iter().map(|(name, value)| property(name, "Vector3D", value)));
            let more = vec![
                leaf("Version", vec![Value::Int(232)]),
                branch("Properties70", Vec::new(), properties),
            ];
            objects.push(object("Model", own, &node.name, node.kind, more));
            links.push(link(own, node.parent.map_or(0, |parent| nodes[parent]), None));
            if node.kind == "LimbNode" {
                let attribute = id();
                let flags = leaf("TypeFlags", vec![text("Skeleton")]);
                objects.push(object(
                    "NodeAttribute",
                    attribute,
                    &node.name,
                    "LimbNode",
                    vec![flags],
                ));
                links.push(link(attribute, own, None));
            }
        }
        for take in &self.takes {
            let stack = id();
            let frames = take.layers.iter().flatten().map(|track| track.values.len()).max();
            let end = (frames.unwrap_or(1) - 1) as f64 / self.fps * TICKS as f64;
            let span = branch(
                "Properties70",
                Vec::new(),
                vec![
                    property("LocalStop", "KTime", &[end.round()]),
                    property("ReferenceStop", "KTime", &[end.round()]),
                ],
            );
            objects.push(object("AnimationStack", stack, &take.name, "", vec![span]));
            for (place, tracks) in take.layers.iter().enumerate() {
                let layer = id();
                // 0 adds to the layers below, 1 replaces them.
                let mode = property("BlendMode", "enum", &[if place == 0 { 1.0 } else { 0.0 }]);
                let mode = branch("Properties70", Vec::new(), vec![mode]);
                objects.push(object("AnimationLayer", layer, "BaseLayer", "", vec![mode]));
                links.push(link(layer, stack, None));
                for track in tracks {
                    let curves = id();
                    let first = track.values[0];
                    let axes = ["d|X", "d|Y", "d|Z"];
                    let numbers = axes.iter().zip(first);
                    let defaults =
                        numbers.map(|(axis, value)| property(axis, "Number", &[value])).collect();
                    let defaults = branch("Properties70", Vec::new(), defaults);
                    let name = match track.property {
                        "Lcl Translation" => "T",
                        "Lcl Rotation" => "R",
                        _ => "S",
                    };
                    objects.push(object("AnimationCurveNode", curves, name, "", vec![defaults]));
                    links.push(link(curves, layer, None));
                    links.push(link(curves, nodes[track.node], Some(track.property)));
                    for (axis, name) in axes.iter().enumerate() {
                        let curve = id();
                        objects.push(object(
                            "AnimationCurve",
                            curve,
                            "",
                            "",
                            self.keys(track, axis),
                        ));
                        links.push(link(curve, curves, Some(name)));
                    }
                }
            }
        }
        if let Some(skin) = &self.skin {
            Self::skin(skin, &nodes, &mut id, &mut objects, &mut links);
        }
        let up = if self.z_up { [2.0, 1.0, -1.0] } else { [1.0, 2.0, 1.0] };
        let settings = vec![
            property("UpAxis", "int", &[up[0]]),
            property("UpAxisSign", "int", &[1.0]),
            property("FrontAxis", "int", &[up[1]]),
            property("FrontAxisSign", "int", &[up[2]]),
            property("CoordAxis", "int", &[0.0]),
            property("CoordAxisSign", "int", &[1.0]),
            property("UnitScaleFactor", "double", &[self.unit]),
            property("TimeMode", "enum", &[14.0]),
            property("CustomFrameRate", "double", &[self.fps]),
        ];
        vec![
            branch(
                "FBXHeaderExtension",
                Vec::new(),
                vec![
                    leaf("FBXHeaderVersion", vec![Value::Int(1003)]),
                    leaf("FBXVersion", vec![Value::Int(7400)]),
                ],
            ),
            branch(
                "GlobalSettings",
                Vec::new(),
                vec![
                    leaf("Version", vec![Value::Int(1000)]),
                    branch("Properties70", Vec::new(), settings),
                ],
            ),
            branch("Objects", Vec::new(), objects),
            branch("Connections", Vec::new(), links),
        ]
    }

    fn keys(&self, track: &Track, axis: usize) -> Vec<Element> {
        let count = track.values.len();
        let time = |frame: usize| (frame as f64 / self.fps * TICKS as f64).round() as i64;
        let (flags, tangents, runs) = if track.is_mixed {
            mixed(count)
        } else {
            (vec![LINEAR], vec![0.0; 4], vec![count as i32])
        };
        vec![
            leaf("Default", vec![Value::Real(0.0)]),
            leaf("KeyVer", vec![Value::Int(4008)]),
            leaf("KeyTime", vec![Value::Longs((0..count).map(time).collect())]),
            leaf(
                "KeyValueFloat",
                vec![Value::Singles(track.values.iter().map(|v| v[axis] as f32).collect())],
            ),
            leaf("KeyAttrFlags", vec![Value::Ints(flags)]),
            leaf("KeyAttrDataFloat", vec![Value::Singles(tangents)]),
            leaf("KeyAttrRefCount", vec![Value::Ints(runs)]),
        ]
    }

    fn skin(
        skin: &Skin,
        nodes: &[i64],
        id: &mut dyn FnMut() -> i64,
        objects: &mut Vec<Element>,
        links: &mut Vec<Element>,
    ) {
        let [model, shape, deformer] = [id(), id(), id()];
        let corners = skin.faces.iter().flat_map(|face| {
            // The last corner of a face is written as its complement.
            let (last, others) = face.split_last().expect("a face has corners");
            others.iter().copied().chain([!last])
        });
        let mut shape_of = vec![
            leaf("Vertices", vec![Value::Reals(skin.vertices.as_flattened().to_vec())]),
            leaf("PolygonVertexIndex", vec![Value::Ints(corners.collect())]),
            leaf("GeometryVersion", vec![Value::Int(124)]),
        ];
        shape_of.extend(skin.paint.iter().flat_map(layers));
        objects.extend([
            object("Model", model, "Body", "Mesh", Vec::new()),
            object("Geometry", shape, "Body", "Mesh", shape_of),
            object("Deformer", deformer, "", "Skin", Vec::new()),
        ]);
        links.extend([link(model, 0, None), link(shape, model, None), link(deformer, shape, None)]);
        let red = Material { color: [1.0, 0.25, 0.0], factor: 1.0, texture: None };
        let materials = skin.paint.as_ref().map_or(vec![red], |paint| paint.materials.clone());
        for material in &materials {
            let own = id();
            let properties = vec![
                property("DiffuseColor", "Color", &material.color),
                property("DiffuseFactor", "Number", &[material.factor]),
            ];
            let more = vec![
                leaf("ShadingModel", vec![text("lambert")]),
                branch("Properties70", Vec::new(), properties),
            ];
            objects.push(object("Material", own, "Paint", "", more));
            links.push(link(own, model, None));
            if let Some(found) = &material.texture {
                texture(found, own, id, objects, links);
            }
        }
        for (node, bind, vertices) in &skin.clusters {
            let cluster = id();
            let more = vec![
                leaf("Indexes", vec![Value::Ints(vertices.clone())]),
                leaf("Weights", vec![Value::Reals(vec![1.0; vertices.len()])]),
                leaf("Transform", vec![Value::Reals(bind.inverse().to_cols_array().into())]),
                leaf("TransformLink", vec![Value::Reals(bind.to_cols_array().into())]),
            ];
            objects.push(object("Deformer", cluster, "", "Cluster", more));
            links.push(link(cluster, deformer, None));
            links.push(link(nodes[*node], cluster, None));
        }
    }
}

/// The flag of keys that are linear up to the next one.
const LINEAR: i32 = 4;

/// Returns the flags and tangents of keys, and the numbers of keys that share them: all kinds, in
/// runs of different lengths.
fn mixed(count: usize) -> (Vec<i32>, Vec<f32>, Vec<i32>) {
    const CUBIC: i32 = 8;
    /// Constant, also that of the next key; splines with automatic tangents, clamped ones, given
    /// ones, broken ones, weighted ones, and with tension, continuity and bias.
    const KINDS: [i32; 10] = [
        2,
        2 | 0x100,
        LINEAR,
        CUBIC | 0x100,
        CUBIC | 0x1000 | 0x100,
        CUBIC | 0x400,
        CUBIC | 0x400 | 0x800,
        CUBIC | 0x400 | 0x0100_0000 | 0x0200_0000,
        CUBIC | 0x200,
        CUBIC,
    ];
    let (mut flags, mut tangents, mut runs) = (Vec::new(), Vec::new(), Vec::new());
    let mut left = count;
    for run in 0.. {
        if left == 0 {
            break;
        }
        let length = (1 + run % 4).min(left);
        flags.push(KINDS[run % KINDS.len()]);
        let slope = (run % 5) as f32 - 2.0;
        // Weights of 0.3 and 0.4, in ten-thousandths.
        tangents.extend([slope, 0.5 - slope, f32::from_bits(0x0FA0_0BB8), 0.0]);
        runs.push(length as i32);
        left -= length;
    }
    (flags, tangents, runs)
}

/// Returns the layers of a mesh: texture coordinates, and the materials of its faces.
fn layers(paint: &Paint) -> Vec<Element> {
    let layer = |kind: &str, index: usize, name: &str, mapping: &str, more: Element| {
        let words = [
            ("Name", name),
            ("MappingInformationType", mapping),
            ("ReferenceInformationType", "IndexToDirect"),
        ];
        let mut inner = vec![leaf("Version", vec![Value::Int(101)])];
        inner.extend(words.map(|(own, value)| leaf(own, vec![text(value)])));
        inner.push(more);
        branch(kind, vec![Value::Int(index as i32)], inner)
    };
    let mut all = Vec::new();
    for (index, (name, places)) in paint.sets.iter().enumerate() {
        let values = leaf("UV", vec![Value::Reals(places.as_flattened().to_vec())]);
        let mut set = layer("LayerElementUV", index, name, "ByPolygonVertex", values);
        set.push(leaf("UVIndex", vec![Value::Ints((0..places.len() as i32).collect())]));
        all.push(set);
    }
    let of_faces = leaf("Materials", vec![Value::Ints(paint.of_faces.clone())]);
    all.push(layer("LayerElementMaterial", 0, "", "ByPolygon", of_faces));
    all
}

/// Adds a texture to a material.
fn texture(
    texture: &Texture,
    material: i64,
    id: &mut dyn FnMut() -> i64,
    objects: &mut Vec<Element>,
    links: &mut Vec<Element>,
) {
    let [own, video] = [id(), id()];
    let paths = |file: &str| {
        vec![
            leaf(file, vec![text(texture.absolute_path)]),
            leaf("RelativeFilename", vec![text(texture.relative_path)]),
        ]
    };
    let mut more = paths("FileName");
    more.push(leaf("Type", vec![text("TextureVideoClip")]));
    more.push(branch("Properties70", Vec::new(), texture.more.clone()));
    objects.push(object("Texture", own, "Image", "", more));
    let mut more = paths("Filename");
    more.push(leaf("Type", vec![text("Clip")]));
    if !texture.content.is_empty() {
        more.push(leaf("Content", vec![Value::Raw(texture.content.clone())]));
    }
    objects.push(object("Video", video, "Image", "Clip", more));
    links.extend([link(own, material, Some("DiffuseColor")), link(video, own, None)]);
    if texture.is_opacity {
        links.push(link(own, material, Some("TransparentColor")));
    }
}
