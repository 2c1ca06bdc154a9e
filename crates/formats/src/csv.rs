//! Comma-separated values: a clip as a table for spreadsheets and scripts, one row per frame.
//!
//! The format is that of RFC 4180: a header row, lines that end with CR LF, quotation marks around
//! names that need them. Numbers have a decimal point and as many digits as are needed to read the
//! same number back. Columns name their unit: `Hips.x_m`.

use super::bvh::RotationOrder;
use glam::Quat;
use segue_motion::clip::{Clip, Contacts};
use segue_motion::math::quat;
use segue_motion::skeleton::WorldPose;
use std::collections::BTreeMap;
use std::fmt::{Display, Write as _};

/// The representation of local rotations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum CsvRotations {
    /// Four columns `.qx`, `.qy`, `.qz`, `.qw`: unit quaternions, each in the hemisphere of the one
    /// in the row before.
    #[default]
    Quaternions,
    /// Three columns in this order, such as `.rz_deg`, `.rx_deg`, `.ry_deg`: turns about the
    /// joint's own axes, degrees, the first one outermost, each nearest to the one in the row
    /// before.
    Euler(RotationOrder),
}

/// Options of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct CsvOptions {
    /// The representation of rotations.
    pub rotations: CsvRotations,
}

/// The content of the table.
#[derive(Clone, Copy, Debug)]
pub struct CsvInputs<'a> {
    /// The motion.
    pub clip: &'a Clip,
    /// The contacts of its feet; no columns where `None`.
    pub contacts: Option<&'a Contacts>,
    /// Further columns, by name: one value per frame. Missing values are empty cells.
    pub columns: &'a [(String, Vec<f32>)],
}

/// Writes a clip as a table: `time_s`; for each joint its position in the world (metres) and its
/// local rotation; `left_foot_contact` and `right_foot_contact` (0 or 1); the columns of `inputs`.
/// Values that are not finite are empty. Joints of the same name are numbered: `Hand (2)`.
#[must_use]
pub fn write_csv(inputs: &CsvInputs<'_>, options: &CsvOptions) -> String {
    let unfolded = inputs.clip.unfolded();
    let inputs = &CsvInputs { clip: unfolded.as_ref().unwrap_or(inputs.clip), ..*inputs };
    let clip = inputs.clip;
    let mut out = String::new();
    header(&mut out, inputs, options.rotations);
    let mut world = WorldPose::default();
    let mut turns: Vec<Quat> = vec![Quat::IDENTITY; clip.skeleton().len()];
    let mut angles = vec![[0.0; 3]; clip.skeleton().len()];
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
        let mut row = Row::start(&mut out, clip.time_of(frame));
        for (joint, position) in world.positions.iter().enumerate() {
            position.to_array().into_iter().for_each(|value| row.value(value));
            let turn = clip.rotations(frame)[joint];
            match options.rotations {
                CsvRotations::Quaternions => {
                    turns[joint] = quat::in_hemisphere_of(turn, turns[joint]);
                    turns[joint].to_array().into_iter().for_each(|value| row.value(value));
                }
                CsvRotations::Euler(order) => {
                    angles[joint] = order.angles(turn, angles[joint]);
                    angles[joint]
                        .into_iter()
                        .for_each(|angle| row.value(angle.to_degrees() as f32));
                }
            }
        }
        if let Some(contacts) = inputs.contacts {
            for &foot in contacts.feet() {
                row.cell(u8::from(contacts.planted(foot, frame)));
            }
        }
        for (_, values) in inputs.columns {
            row.value(values.get(frame).copied().unwrap_or(f32::NAN));
        }
        out.push_str("\r\n");
    }
    out
}

fn header(out: &mut String, inputs: &CsvInputs<'_>, rotations: CsvRotations) {
    let rotations: Vec<&str> = match rotations {
        CsvRotations::Quaternions => vec!["qx", "qy", "qz", "qw"],
        CsvRotations::Euler(order) => {
            order.axes().into_iter().map(|axis| ["rx_deg", "ry_deg", "rz_deg"][axis]).collect()
        }
    };
    out.push_str("time_s");
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for joint in inputs.clip.skeleton().joints() {
        let times = seen.entry(&joint.name).or_default();
        *times += 1;
        let name =
            if *times == 1 { joint.name.clone() } else { format!("{} ({times})", joint.name) };
        for column in ["x_m", "y_m", "z_m"].iter().chain(&rotations) {
            out.push(',');
            out.push_str(&cell(&format!("{name}.{column}")));
        }
    }
    if let Some(contacts) = inputs.contacts {
        let columns = [
            "left_foot_contact",
            "right_foot_contact",
            "left_forefoot_contact",
            "right_forefoot_contact",
        ];
        for (column, _) in columns.iter().zip(contacts.feet()) {
            out.push(',');
            out.push_str(column);
        }
    }
    for (name, _) in inputs.columns {
        out.push(',');
        out.push_str(&cell(name));
    }
    out.push_str("\r\n");
}

/// Returns a name as a cell: in quotation marks where it contains a delimiter, and after an
/// apostrophe where a spreadsheet would read it as a formula (OWASP, CSV injection).
#[must_use]
pub fn cell(name: &str) -> String {
    let apostrophe = if name.starts_with(['=', '+', '-', '@', '\t', '\r']) { "'" } else { "" };
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{apostrophe}{}\"", name.replace('"', "\"\""))
    } else {
        format!("{apostrophe}{name}")
    }
}

struct Row<'a> {
    out: &'a mut String,
}

impl<'a> Row<'a> {
    fn start(out: &'a mut String, time_secs: f64) -> Self {
        let row = Self { out };
        // Writing to a string cannot fail.
        write!(row.out, "{time_secs}").unwrap_or_default();
        row
    }

    fn value(&mut self, value: f32) {
        if value.is_finite() {
            // Avoids -0.
            self.cell(value + 0.0);
        } else {
            self.out.push(',');
        }
    }

    fn cell(&mut self, value: impl Display) {
        write!(self.out, ",{value}").unwrap_or_default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use segue_motion::clip::{ContactOptions, JointTranslations};
    use segue_motion::skeleton::{Joint, Roles, Side, Skeleton};
    use segue_motion::synth::{Action, Params, synthesize};
    use std::sync::Arc;

    /// Returns lines and cells; a comma in quotation marks is not a delimiter.
    fn table(text: &str) -> Vec<Vec<String>> {
        let lines = text.strip_suffix("\r\n").unwrap().split("\r\n");
        let cells = |line: &str| {
            let (mut cells, mut inside) = (vec![String::new()], false);
            for c in line.chars() {
                match c {
                    '"' => inside = !inside,
                    ',' if !inside => cells.push(String::new()),
                    c => cells.last_mut().unwrap().push(c),
                }
            }
            cells
        };
        lines.map(cells).collect()
    }

    fn inputs(clip: &Clip) -> CsvInputs<'_> {
        CsvInputs { clip, contacts: None, columns: &[] }
    }

    #[test]
    fn write_csv_keeps_every_number() {
        let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let values = (0..clip.frames()).map(|frame| Vec3::splat(0.01 * frame as f32)).collect();
        let clip = clip.with_translations(vec![JointTranslations { joint: 3, values }]).unwrap();
        let contacts =
            Contacts::detect(&clip, &Roles::detect(clip.skeleton()), &ContactOptions::default());
        let columns = [("speed, \"fast\"".to_owned(), vec![1.5, f32::NAN])];
        let text = write_csv(
            &CsvInputs { contacts: Some(&contacts), columns: &columns, ..inputs(&clip) },
            &CsvOptions::default(),
        );
        let rows = table(&text);
        let joints = clip.skeleton().len();
        assert_eq!(rows.len(), clip.frames() + 1);
        assert!(rows.iter().all(|row| row.len() == 1 + 7 * joints + 2 + 1));
        assert_eq!(
            rows[0][..3],
            [
                "time_s".to_owned(),
                format!("{}.x_m", clip.skeleton().joints()[0].name),
                format!("{}.y_m", clip.skeleton().joints()[0].name)
            ]
        );
        assert!(text.contains(",\"speed, \"\"fast\"\"\"\r\n"));
        for frame in 0..clip.frames() {
            let row = &rows[frame + 1];
            let number = |at: usize| row[at].parse::<f32>().unwrap();
            let world = clip.world_pose(frame);
            assert_eq!(row[0].parse::<f64>().unwrap(), clip.time_of(frame));
            for joint in 0..joints {
                let at = 1 + 7 * joint;
                assert_eq!(
                    Vec3::new(number(at), number(at + 1), number(at + 2)),
                    world.positions[joint]
                );
                let turn =
                    Quat::from_xyzw(number(at + 3), number(at + 4), number(at + 5), number(at + 6));
                let own = clip.rotations(frame)[joint];
                assert!(turn == own || turn == -own);
            }
            for side in Side::BOTH {
                assert_eq!(
                    row[1 + 7 * joints + side.index()] == "1",
                    contacts.planted(side, frame)
                );
            }
            assert_eq!(row.last().unwrap(), if frame == 0 { "1.5" } else { "" });
        }
    }

    #[test]
    fn write_csv_angles_are_continuous() {
        let run = synthesize(&Params::new(Action::Run)).unwrap().clip;
        // The body spins as it runs: angles continue beyond half a turn.
        let poses = (0..run.frames()).map(|frame| {
            let mut pose = run.pose(frame);
            pose.rotations[0] = Quat::from_rotation_y(0.2 * frame as f32) * pose.rotations[0];
            pose
        });
        let clip = Clip::from_poses("spin", Arc::clone(run.skeleton()), run.fps(), poses).unwrap();
        let options = CsvOptions { rotations: CsvRotations::Euler(RotationOrder::Zxy) };
        let rows = table(&write_csv(&inputs(&clip), &options));
        assert!(
            rows[0][4].ends_with(".rz_deg")
                && rows[0][5].ends_with(".rx_deg")
                && rows[0][6].ends_with(".ry_deg")
        );
        let angle =
            |frame: usize, at: usize| rows[frame + 1][at].parse::<f32>().unwrap().to_radians();
        for frame in 0..clip.frames() {
            for joint in 0..clip.skeleton().len() {
                let at = 4 + 6 * joint;
                let turn = Quat::from_rotation_z(angle(frame, at))
                    * Quat::from_rotation_x(angle(frame, at + 1))
                    * Quat::from_rotation_y(angle(frame, at + 2));
                assert!(quat::angle_between(turn, clip.rotations(frame)[joint]) < 1e-5);
                if frame > 0 {
                    assert!(
                        (0..3)
                            .all(|i| (angle(frame, at + i) - angle(frame - 1, at + i)).abs() < 3.0)
                    );
                }
            }
        }
    }

    #[test]
    fn cell_of_a_formula_is_escaped() {
        for (name, written) in [
            ("=HYPERLINK(\"x\",\"y\")", "\"'=HYPERLINK(\"\"x\"\",\"\"y\"\")\""),
            ("+1", "'+1"),
            ("-10 frames", "'-10 frames"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("\t=1", "'\t=1"),
            ("a=b", "a=b"),
            ("a,b", "\"a,b\""),
        ] {
            assert_eq!(cell(name), written);
        }
    }

    #[test]
    fn write_csv_numbers_equal_names() {
        let joint = |name: &str, parent| Joint {
            name: name.into(),
            parent,
            offset: Vec3::Y,
            end_site: None,
            channels: vec![],
        };
        let joints = vec![joint("a,b", None), joint("hand", Some(0)), joint("hand", Some(0))];
        let clip =
            Clip::new("c", Arc::new(Skeleton::new(joints).unwrap()), 30.0, vec![], vec![]).unwrap();
        let text = write_csv(&inputs(&clip), &CsvOptions::default());
        assert!(
            text.starts_with("time_s,\"a,b.x_m\",\"a,b.y_m\"")
                && text.contains(",hand.x_m,")
                && text.ends_with(",hand (2).qw\r\n"),
            "{text}"
        );
    }
}
