//! Tests of humanoid files, whose bone maps say which joint is which.

use crate::reading::{Parcel, ReadReport, ReadSetup, Unpacker, read};
use segue_formats::FileKind;
use segue_motion::skeleton::{Role, RoleSource};

const BODY: &[u8] = include_bytes!("../../../formats/tests/cases/vrm/zero.vrm");
const MOTION: &[u8] = include_bytes!("../../../formats/tests/cases/vrm/motion.vrma");

fn report(name: &str, bytes: &[u8], setup: &ReadSetup) -> ReadReport {
    read(name, bytes, setup, &mut |_| true).unwrap()
}

#[test]
fn bone_map_of_a_file_arrives_from_the_worker() {
    for (name, bytes, kind) in
        [("body.vrm", BODY, FileKind::Vrm), ("sway.vrma", MOTION, FileKind::Vrma)]
    {
        let report = report(name, bytes, &ReadSetup::default());
        let parcel = Parcel::new(report.clone()).unwrap();
        let mut unpacker = Unpacker::new(parcel.head(), u64::MAX).unwrap();
        parcel.pieces(|piece| unpacker.push(piece));
        let received = unpacker.finish().unwrap();
        assert_eq!(
            (received.files[0].kind, received.files[0].kind.name()),
            (kind, &name[name.len() - kind.name().len()..])
        );
        let clips = &received.files[0].result.as_ref().unwrap().clips;
        let roles = clips[0].motion.roles();
        for role in Role::ALL {
            assert_eq!(roles.source(role), Some(RoleSource::ByFile), "{name}: {role:?}");
        }
        assert_eq!(received, report);
    }
}

#[test]
fn roles_set_by_hand_come_before_those_of_the_file() {
    let read = report("body.vrm", BODY, &ReadSetup::default());
    let clips = &read.files[0].result.as_ref().unwrap().clips;
    let mut roles = clips[0].motion.roles().clone();
    roles.set(Role::Head, None);
    let setup = ReadSetup { roles: [(0, roles.clone())].into(), ..ReadSetup::default() };
    let again = report("body.vrm", BODY, &setup);
    assert_eq!(*again.files[0].result.as_ref().unwrap().clips[0].motion.roles(), roles);
}
