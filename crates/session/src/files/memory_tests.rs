//! Tests of files for which there is no memory, and of motions that are no longer needed.

use crate::fixtures::*;
use crate::memory::PageMemory;
use crate::reading::{LARGE_BYTES, ReadSetup, read};
use segue_formats::bvh;
use segue_motion::synth::{Action, Params as SynthParams, synthesize};

const LIMIT: u64 = 3_000_000_000;

fn page(bytes: u64) -> PageMemory {
    PageMemory { bytes, limit: LIMIT, coming: 0 }
}

fn walk() -> Arc<[u8]> {
    let made = synthesize(&SynthParams::new(Action::Walk)).unwrap();
    bvh::write(&made.clip, &bvh::WriteOptions::default()).into_bytes().into()
}

#[test]
fn file_beyond_memory_is_refused_with_its_name_and_size() {
    let mut session = Session::new();
    let task = session.begin_reading("long.bvh", Content::Outside("file 1".into()), 480_000_000);
    let Some(Request::Read(read)) = session.take_requests().pop() else {
        panic!("it is not asked for");
    };
    assert_eq!(session.memory_lacking_for(&read), None, "the memory is unlimited");
    session.note_memory(page(LIMIT - 360_000_000));
    assert_eq!(session.memory_lacking_for(&read), None, "it just fits");
    session.note_memory(page(LIMIT - 359_000_000));
    assert_eq!(session.memory_lacking_for(&read), Some(360_000_000));
    let refused = session.refuse_for_memory(task, 360_000_000).unwrap().unwrap_err();
    assert!(
        refused.to_string().starts_with("There is no memory for long.bvh (480 MB): its clips need 360 MB, and 359 of 3000 MB are left."),
        "{refused}"
    );
    let notice = session.notices().list().last().unwrap();
    assert_eq!((notice.text.to_string(), notice.about.as_str()), (refused.to_string(), "long.bvh"));
    assert!(!session.is_reading(task) && session.refuse_for_memory(task, 1).is_none());
}

#[test]
fn removed_motion_is_dropped_when_memory_is_scarce_and_read_again_after_undo() {
    for (bytes, is_kept) in [(LIMIT / 2, true), (LIMIT / 2 + 1, false)] {
        let mut session = Session::new();
        let id = session.load("walk.bvh", walk()).unwrap().ids.remove(0);
        settle(&mut session);
        let motion = session.library().get(&id).unwrap().motion.clone().unwrap();
        session.apply(Command::Remove(id.clone())).unwrap();
        // The clip that is shown instead needs none of it.
        session.apply(Command::OpenLink("lab=view&a=idle".into())).unwrap();
        settle(&mut session);
        let held = Arc::strong_count(&motion);
        session.note_memory(page(bytes));
        assert_eq!(Arc::strong_count(&motion) == held, is_kept, "{bytes} of {LIMIT}");
        for _ in 0..2 {
            session.apply(Command::Undo).unwrap();
        }
        let back = session.library().get(&id).unwrap().motion.clone().unwrap();
        assert_eq!(Arc::ptr_eq(&back, &motion), is_kept);
        assert_eq!(back, motion);
    }
}

#[test]
fn motion_of_the_library_stays_when_memory_is_scarce() {
    let mut session = Session::new();
    let id = session.load("walk.bvh", walk()).unwrap().ids.remove(0);
    session.apply(Command::Rename(id.clone(), "other".into())).unwrap();
    session.note_memory(page(LIMIT));
    session.apply(Command::Undo).unwrap();
    assert!(session.library().get(&id).unwrap().motion.is_some());
    let reads = |request: &Request| matches!(request, Request::Read(_));
    assert!(!session.take_requests().iter().any(reads));
}

#[test]
fn large_fetched_file_joins_the_library_like_a_small_one() {
    let mut session = Session::with_external_reader();
    session.apply(Command::OpenLink("lab=blend&a=idle&b=run".into())).unwrap();
    let came = |session: &mut Session, fetched: bool| {
        let content = Content::Outside("file 1".into());
        let (name, size) = ("walk.bvh", LARGE_BYTES + 1);
        let task = if fetched {
            session.begin_reading_fetched(name, content, size)
        } else {
            session.begin_reading(name, content, size)
        };
        let report = read(name, &walk(), &ReadSetup::default(), &mut |_| true).unwrap();
        let id = session.finish_reading(task, Ok(report)).unwrap().unwrap().ids.remove(0);
        [Slot::A, Slot::B].map(|slot| session.slot(slot).is_some_and(|entry| entry.id == id))
    };
    assert_eq!(came(&mut session, true), [false; 2], "the link names both clips");
    assert_eq!(came(&mut session, false), [true, false]);
}
