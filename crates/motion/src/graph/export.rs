//! Export of graphs as JSON and for Graphviz.

use super::{Choices, MotionGraph};
use petgraph::dot::{Config, Dot};
use petgraph::visit::EdgeRef;
use serde_json::{Value, json};

impl MotionGraph {
    /// Returns the graph as JSON: `clips` (name, frames), `fps`, `options`, `nodes` (clip, start,
    /// end, component: 0 is the largest) and `edges` (from, to, probability; transitions also
    /// leave, enter, window, `distance_cm`, and their alignment: yaw in radians, x and z in
    /// metres).
    #[must_use]
    pub fn to_json(&self, choices: &Choices) -> Value {
        let clips = self.set.clips().iter().map(|source| {
            let clip = source.clip();
            json!({ "name": clip.name(), "frames": clip.frames() })
        });
        let mut component = vec![0; self.graph.node_count()];
        for (index, nodes) in self.components().iter().enumerate() {
            for node in nodes {
                component[node.index()] = index;
            }
        }
        let nodes = self.graph.node_weights().zip(&component).map(|(stretch, component)| {
            json!({
                "clip": stretch.clip, "start": stretch.start, "end": stretch.end,
                "component": component
            })
        });
        let edges =
            self.graph.node_indices().flat_map(|node| choices.probabilities(node)).filter_map(
                |(edge, probability)| {
                    let (from, to) = self.graph.edge_endpoints(edge)?;
                    let (from, to) = (from.index(), to.index());
                    Some(match self.jump(edge) {
                        None => json!({ "from": from, "to": to, "probability": probability }),
                        Some(jump) => json!({
                            "from": from, "to": to, "probability": probability,
                            "leave": jump.leave, "enter": jump.enter, "window": jump.window,
                            "distance_cm": jump.distance_cm, "yaw": jump.alignment.yaw,
                            "x": jump.alignment.shift.x, "z": jump.alignment.shift.y,
                        }),
                    })
                },
            );
        json!({
            "fps": self.set.fps(),
            "options": self.options,
            "clips": clips.collect::<Vec<_>>(),
            "nodes": nodes.collect::<Vec<_>>(),
            "edges": edges.collect::<Vec<_>>(),
        })
    }

    /// Returns the graph in the DOT language of Graphviz: nodes by clip and frames, transitions
    /// dashed, widths by probability.
    #[must_use]
    pub fn to_dot(&self, choices: &Choices) -> String {
        let mut probability = vec![0.0; self.graph.edge_count()];
        for (edge, p) in self.graph.node_indices().flat_map(|node| choices.probabilities(node)) {
            if let Some(slot) = probability.get_mut(edge.index()) {
                *slot = p;
            }
        }
        let of_edge = |_: &_, edge: petgraph::graph::EdgeReference<'_, super::Way>| {
            let width = 0.2 + 2.8 * probability.get(edge.id().index()).copied().unwrap_or(0.0);
            match self.jump(edge.id()) {
                None => format!("penwidth = {width:.3}"),
                Some(jump) => format!(
                    "penwidth = {width:.3}, style = dashed, label = \"{:.2} cm\"",
                    jump.distance_cm
                ),
            }
        };
        let of_node = |_: &_, (_, stretch): (_, &super::Stretch)| {
            let name = self.set.clip(stretch.clip).map_or("", |source| source.clip().name());
            let name = name.replace('\\', "\\\\").replace('"', "\\\"");
            format!("label = \"{name} {}–{}\"", stretch.start, stretch.end)
        };
        let plain = [Config::EdgeNoLabel, Config::NodeNoLabel];
        format!("{:?}", Dot::with_attr_getters(&self.graph, &plain, &of_edge, &of_node))
    }
}
