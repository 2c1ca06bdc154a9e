//! The Graph lab, by commands.

use super::*;

fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    session
}

#[test]
fn looks() {
    for link in ["lab=graph", "lab=graph&edge_threshold=5", "lab=graph&edge_threshold=12", "lab=graph&construction=segments", "lab=graph&construction=segments&blend_window=20&segment_size=30","lab=graph&blend_window=15"] {
        let session = opened(link);
        println!("{link}: {:?}", session.panes()[0].problem);
        let Some(walk) = session.graph_walk() else { continue };
        let built = &walk.built;
        println!("frames {} nodes {} jumps {} of {} rings {:?} dead {} run {:?}", built.cast().set().frames(), built.graph().graph().node_count(), built.graph().jumps().len(), built.whole().jumps().len(), built.rings(), built.dead_ends(), walk.run_secs);
        for m in &walk.metrics { print!("{} {:?}{} · ", m.label, m.value, m.unit); }
        println!();
        let names: Vec<&str> = walk.passed.iter().map(|p| built.cast().names()[p.stay.clip].as_str()).collect();
        println!("{names:?}");
    }
}
