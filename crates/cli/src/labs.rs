//! The commands that make a result by a lab: one for each lab, and `retarget`. Their options are
//! the rows of the table of parameters.

use segue_batch::Clips;
use segue_session::choices::{LabId, Selected as _};

/// A command that makes results.
#[derive(Debug)]
pub(crate) struct LabCommand {
    /// The name, of one word or two.
    pub(crate) name: &'static str,
    /// The word of its lab in links.
    pub(crate) lab: &'static str,
    /// Whether it puts clips on the body of a file.
    pub(crate) takes_body: bool,
    /// A sentence about it.
    pub(crate) about: &'static str,
    /// Examples, a line each.
    pub(crate) examples: &'static str,
}

/// Every command, in the order of the help.
pub(crate) static LAB_COMMANDS: &[LabCommand] = &[
    LabCommand {
        name: "clean",
        lab: "clean",
        takes_body: false,
        about: "Mends spikes, gaps, flips, jitter, drift, ground and foot skating",
        examples: "\
  segue clean take.bvh -o clean.bvh
  segue clean takes -o mended --to bvh --clean-sure 80   only what is at least 80 % sure
  segue clean take.bvh --clean-mend off                  lists the faults and leaves them",
    },
    LabCommand {
        name: "blend",
        lab: "blend",
        takes_body: false,
        about: "Dissolves one clip into another at their best match",
        examples: "\
  segue blend walk.bvh run.bvh -o blend.bvh --blend-window 20
  segue blend walk run --print-link                      two built-in clips, and the link of the result
  segue blend walk run --set compare=blend_window:30,15,10",
    },
    LabCommand {
        name: "transition",
        lab: "transition",
        takes_body: false,
        about: "Inertializes, dead-blends or cuts from one clip to another",
        examples: "\
  segue transition walk.fbx run.fbx -o out.fbx --method inertialize --half-life 0.2
  segue transition walk run --mix-frame-a 90 --mix-frame-b 12 --method cubic",
    },
    LabCommand {
        name: "speed",
        lab: "speed",
        takes_body: false,
        about: "Makes a gait of any speed from a walk and a run",
        examples: "\
  segue speed walk.bvh run.bvh -o jog.bvh --speed 2.2",
    },
    LabCommand {
        name: "loop",
        lab: "loop",
        takes_body: false,
        about: "Makes a part of a clip a cycle without a seam",
        examples: "\
  segue loop walk.bvh -o cycle.bvh
  segue loop gaits -o cycles --to glb --loop-method both",
    },
    LabCommand {
        name: "layers",
        lab: "layers",
        takes_body: false,
        about: "Puts a part of one body over another, or adds a difference",
        examples: "\
  segue layers walk.bvh wave.bvh -o waving.bvh --mask right_arm",
    },
    LabCommand {
        name: "register",
        lab: "register",
        takes_body: false,
        about: "Time-warps clips onto each other and blends two to eight",
        examples: "\
  segue register walk.bvh run.bvh -o between.bvh --warp-weight 0.3
  segue register walk run fast_walk -o mean.bvh          three clips of equal weight",
    },
    LabCommand {
        name: "retarget",
        lab: "edit",
        takes_body: true,
        about: "Puts clips on another body, with feet and hands where they belong",
        examples: "\
  segue retarget walk.bvh --body hero.glb -o walk-hero.glb
  segue retarget takes --body hero.fbx -o retargeted --to fbx --foot-lock on",
    },
    LabCommand {
        name: "path",
        lab: "path",
        takes_body: false,
        about: "Moves a clip along an edited path",
        examples: "\
  segue path walk.bvh -o straight.bvh --path-smoothing 1",
    },
    LabCommand {
        name: "graph walk",
        lab: "graph",
        takes_body: false,
        about: "Builds a motion graph of clips and walks through it",
        examples: "\
  segue graph walk takes -o walk.bvh --walk-seconds 60 --seed 7
  segue graph walk walk run start stop --edge-threshold 8",
    },
    LabCommand {
        name: "match bench",
        lab: "match",
        takes_body: false,
        about: "Drives a character by motion matching through recorded input, and measures it",
        examples: "\
  segue match bench takes                                every scenario, as a table
  segue match bench --scenario spin -o spin.bvh          with the synthesised clips",
    },
    LabCommand {
        name: "in-place",
        lab: "in_place",
        takes_body: false,
        about: "Removes the root motion of a clip, or rebuilds it from planted feet",
        examples: "\
  segue in-place walk.bvh -o on-the-spot.bvh
  segue in-place game/*.fbx -o moving --to fbx --root-way put_back",
    },
    LabCommand {
        name: "edit",
        lab: "edit",
        takes_body: false,
        about: "Trims, mirrors, reverses, resamples, scales, turns and moves clips",
        examples: "\
  segue edit walk.bvh -o left.bvh --edit-from 0.5 --edit-to 2 --mirror on",
    },
    LabCommand {
        name: "view",
        lab: "view",
        takes_body: false,
        about: "Locks the feet of a clip, or puts it elsewhere on the ground",
        examples: "\
  segue view walk.bvh -o locked.bvh --foot-lock on",
    },
    LabCommand {
        name: "make",
        lab: "make",
        takes_body: false,
        about: "Synthesises a walk, run, start, stop, turn or jump",
        examples: "\
  segue make -o walk.bvh --gait walk --gait-speed 1.2 --turn-rate 20 --make-seconds 6",
    },
];

/// Returns the first command of a lab, by the lab's word in links.
pub(crate) fn command_of(lab: &str) -> Option<&'static LabCommand> {
    LAB_COMMANDS.iter().find(|command| command.lab == lab && !command.takes_body)
}

impl LabCommand {
    /// Returns its lab.
    pub(crate) fn lab_id(&self) -> Option<LabId> {
        LabId::from_word(self.lab)
    }

    /// Returns the clips that it takes.
    pub(crate) fn clips(&self) -> Clips {
        self.lab_id().map_or(Clips::None, Clips::of)
    }

    /// Returns its examples for the help.
    pub(crate) fn examples_help(&self) -> String {
        let lines = self.examples.lines().map(|line| format!("  {}", line.trim_start()));
        format!("Examples:\n{}", lines.collect::<Vec<_>>().join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lab_has_a_command() {
        for lab in LabId::ALL {
            assert!(command_of(lab.word()).is_some(), "{}", lab.word());
        }
        assert!(LAB_COMMANDS.iter().all(|command| command.lab_id().is_some()));
        // The examples call their command.
        for command in LAB_COMMANDS {
            let calls = command.examples.matches(&format!("segue {} ", command.name)).count();
            assert_eq!(calls, command.examples.lines().count(), "{}", command.name);
        }
    }
}
