//! The numbers by which the page knows the elements.

use eframe::egui::accesskit::NodeId;
use std::collections::HashMap;

/// The numbers of nodes, from 1; none is used twice.
#[derive(Default)]
pub(super) struct Numbers {
    of_node: HashMap<NodeId, u32>,
    nodes: HashMap<u32, NodeId>,
    last: u32,
}

impl Numbers {
    /// Returns the number of a node; a new one where it has none.
    pub(super) fn number_of(&mut self, id: NodeId) -> u32 {
        *self.of_node.entry(id).or_insert_with(|| {
            self.last += 1;
            self.nodes.insert(self.last, id);
            self.last
        })
    }

    /// Returns the number of a node, if it has one.
    pub(super) fn known(&self, id: NodeId) -> Option<u32> {
        self.of_node.get(&id).copied()
    }

    /// Returns the node of a number.
    pub(super) fn node(&self, number: u32) -> Option<NodeId> {
        self.nodes.get(&number).copied()
    }

    /// Removes the number of a node that is gone.
    pub(super) fn forget(&mut self, number: u32) {
        if let Some(id) = self.nodes.remove(&number) {
            self.of_node.remove(&id);
        }
    }
}
