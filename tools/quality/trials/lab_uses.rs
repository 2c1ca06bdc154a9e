//! The uses of the labs that are tried: each lab with each of its methods.

use super::folder::encoded;
use super::trial::Draw;
use segue_session::write_ids;

// The methods of each lab, as links name them.
const WEIGHT_LAWS: [&str; 3] = ["smooth", "linear", "smoother"];
const TRANSITIONS: [&str; 7] =
    ["inertialize", "cubic", "quintic", "dead", "smooth", "linear", "cut"];
const LOOPS: [&str; 6] = ["exact", "both", "start", "end", "linear", "cubic"];
const LAYERS: [&str; 2] = ["partial", "additive"];
const REGISTERED: [&str; 2] = ["blend", "join"];
const KEEPS: [&str; 3] = ["speed", "duration", "whole"];
const CONSTRUCTIONS: [&str; 2] = ["minima", "segments"];
const WALKS: [&str; 2] = ["dissolve", "inertialize"];
const SCENARIOS: [&str; 7] = ["straight", "left", "right", "spin", "start_stop", "run", "eight"];
const JUMPS: [&str; 2] = ["inertialize", "dead"];

/// A use of a lab with one method.
#[derive(Clone, Debug)]
pub(super) struct LabUse {
    pub(super) lab: &'static str,
    pub(super) method: String,
    /// The parameters of the link besides the takes.
    pub(super) query: String,
    /// The parameter of the foot lock.
    pub(super) lock: &'static str,
    pub(super) takes: LabTakes,
    /// Whether it jumps intentionally: it is measured without bounds.
    pub(super) jumps: bool,
}

/// The takes of a use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LabTakes {
    /// A and B.
    Both,
    /// A.
    First,
    /// All, in the list parameter of this name.
    All(&'static str),
}

impl LabUse {
    /// Returns the link that opens it on these takes, by their ids, with or without foot lock.
    pub(super) fn link(&self, ids: &[String], locked: bool) -> String {
        let takes = match self.takes {
            LabTakes::Both => format!("a={}&b={}", encoded(&ids[0]), encoded(&ids[1])),
            LabTakes::First => format!("a={}", encoded(&ids[0])),
            LabTakes::All(key) => format!("{key}={}", encoded(&write_ids(ids))),
        };
        let switch = if locked { "on" } else { "off" };
        format!("lab={}&{takes}&{}&{}={switch}", self.lab, self.query, self.lock)
    }
}

/// Returns the uses for a draw; `path_code` is the edited path of the Path lab.
pub(super) fn lab_uses(draw: Draw, path_code: Option<&str>) -> Vec<LabUse> {
    let mut lab_uses = Vec::new();
    let mut add =
        |lab: &'static str, takes: LabTakes, method: String, query: String, jumps: bool| {
            lab_uses.push(LabUse {
                lab,
                method,
                query,
                lock: if lab == "match" { "plant_feet" } else { "foot_lock" },
                takes,
                jumps,
            });
        };
    if draw == Draw::Set {
        for (scenario, jump) in
            SCENARIOS.into_iter().flat_map(|scenario| JUMPS.map(|jump| (scenario, jump)))
        {
            let query = format!("scenario={scenario}&jump_method={jump}");
            add("match", LabTakes::All("match_clips"), format!("{scenario}, {jump}"), query, false);
        }
        for (construction, walk) in CONSTRUCTIONS
            .into_iter()
            .flat_map(|construction| WALKS.map(|walk| (construction, walk)))
        {
            let query = format!("construction={construction}&walk_method={walk}");
            add("graph", LabTakes::All("clips"), format!("{construction}, {walk}"), query, false);
        }
        return lab_uses;
    }
    for law in WEIGHT_LAWS {
        add("blend", LabTakes::Both, law.to_owned(), format!("weight_law={law}"), false);
    }
    for method in TRANSITIONS {
        add(
            "transition",
            LabTakes::Both,
            method.to_owned(),
            format!("method={method}"),
            method == "cut",
        );
    }
    add("speed", LabTakes::Both, "halfway".to_owned(), "speed=auto".to_owned(), false);
    for method in LOOPS {
        add("loop", LabTakes::First, method.to_owned(), format!("loop_method={method}"), false);
    }
    // Without root motion feet slide by design: only the rebuilt motion is bound by its source.
    let (rebuilt, query) = ("put_back".to_owned(), "root_way=put_back".to_owned());
    add("in_place", LabTakes::First, rebuilt, query, false);
    add("clean", LabTakes::First, "mended".to_owned(), "clean_mend=on".to_owned(), false);
    let edits = "edit_from=0.2&reverse=on&mirror=on&scale=1.3&turn=40";
    add("edit", LabTakes::First, "reversed, mirrored".to_owned(), edits.to_owned(), false);
    for mode in LAYERS {
        add("layers", LabTakes::Both, mode.to_owned(), format!("layer_mode={mode}"), false);
    }
    for mode in REGISTERED {
        add("register", LabTakes::Both, mode.to_owned(), format!("warp_mode={mode}"), false);
    }
    for keep in KEEPS {
        let code = path_code.unwrap_or_default();
        add(
            "path",
            LabTakes::First,
            format!("bent, {keep}"),
            format!("keep={keep}&path={code}"),
            false,
        );
    }
    lab_uses
}
