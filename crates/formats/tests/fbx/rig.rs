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
    /// 0 to 5: XYZ, XZY, YZX, YXZ, ZXY, ZYX.
    pub(crate) order: i32,
}

/// The keys of one property of a node: a value for each frame.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub(crate) node: usize,
    pub(crate) property: &'static str,
    pub(crate) values: Vec<[f64; 3]>,
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
                property("InheritType", "enum", &[1.0]),
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
        vec![
            leaf("Default", vec![Value::Real(0.0)]),
            leaf("KeyVer", vec![Value::Int(4008)]),
            leaf("KeyTime", vec![Value::Longs((0..count).map(time).collect())]),
            leaf(
                "KeyValueFloat",
                vec![Value::Singles(track.values.iter().map(|v| v[axis] as f32).collect())],
            ),
            // Linear.
            leaf("KeyAttrFlags", vec![Value::Ints(vec![4])]),
            leaf("KeyAttrDataFloat", vec![Value::Singles(vec![0.0; 4])]),
            leaf("KeyAttrRefCount", vec![Value::Ints(vec![count as i32])]),
        ]
    }

    fn skin(
        skin: &Skin,
        nodes: &[i64],
        id: &mut dyn FnMut() -> i64,
        objects: &mut Vec<Element>,
        links: &mut Vec<Element>,
    ) {
        let [model, shape, deformer, material] = [id(), id(), id(), id()];
        let corners = skin.faces.iter().flat_map(|face| {
            // The last corner of a face is written as its complement.
            let (last, others) = face.split_last().expect("a face has corners");
            others.iter().copied().chain([!last])
        });
        let shape_of = vec![
            leaf("Vertices", vec![Value::Reals(skin.vertices.as_flattened().to_vec())]),
            leaf("PolygonVertexIndex", vec![Value::Ints(corners.collect())]),
            leaf("GeometryVersion", vec![Value::Int(124)]),
        ];
        let color = property("DiffuseColor", "Color", &[1.0, 0.25, 0.0]);
        objects.extend([
            object("Model", model, "Body", "Mesh", Vec::new()),
            object("Geometry", shape, "Body", "Mesh", shape_of),
            object(
                "Material",
                material,
                "Red",
                "",
                vec![
                    leaf("ShadingModel", vec![text("lambert")]),
                    branch("Properties70", Vec::new(), vec![color]),
                ],
            ),
            object("Deformer", deformer, "", "Skin", Vec::new()),
        ]);
        links.extend([
            link(model, 0, None),
            link(shape, model, None),
            link(material, model, None),
            link(deformer, shape, None),
        ]);
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
