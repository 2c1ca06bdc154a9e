//! Changes of the graph's clips.

use crate::ui::out::Out;
use segue_session::{Command, Session, graph_of};

/// Adds a clip to the graph, unless the graph has it already.
pub(super) fn add_clip(id: String, session: &Session, out: &mut Out) {
    let mut ids = session.graph_clip_ids();
    if !ids.contains(&id) {
        ids.push(id);
        set_clips(&ids, out);
    }
}

/// Sets the clips of the graph.
pub(super) fn set_clips(ids: &[String], out: &mut Out) {
    out.commands.push(Command::Set(graph_of(ids)));
    out.commands.push(Command::Settle);
}
