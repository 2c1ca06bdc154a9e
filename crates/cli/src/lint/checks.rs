//! The checks of `segue lint`: what is measured, and from which value on it is a finding.

use segue_motion::clean::FaultKind;
use segue_session::metrics::{MetricId, Unit};

/// The source of a check's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// A metric of the View lab; above the limit it is a finding.
    Metric(MetricId),
    /// Faults that the Clean lab finds; the limit is their least confidence, per cent.
    Fault(FaultKind),
    /// An oddity in the file that the reader tells.
    Oddity,
}

/// A row of the table of checks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Check {
    /// The word on the command line and in reports.
    pub(super) word: &'static str,
    /// The source of its values.
    pub(super) source: Source,
    /// The value above which it is a finding, in the unit of the source.
    pub(super) limit: f64,
    /// A sentence about it.
    pub(super) help: &'static str,
}

const fn metric(word: &'static str, id: MetricId, limit: f64, help: &'static str) -> Check {
    Check { word, source: Source::Metric(id), limit, help }
}

const fn fault(word: &'static str, kind: FaultKind, help: &'static str) -> Check {
    // Above the 50 % from which on the Clean lab mends: a list in CI has to be right.
    Check { word, source: Source::Fault(kind), limit: 75.0, help }
}

/// Every check, in the order of reports. Nine in ten captured takes stay below the limits of
/// metrics.
pub(super) static CHECKS: &[Check] = &[
    fault("spike", FaultKind::Spike, "A joint leaves its way for a few frames, or turns over."),
    fault("gap", FaultKind::Gap, "A limb or the body holds still between moving frames."),
    fault("swap", FaultKind::Swap, "Left and right are swapped."),
    fault("jitter", FaultKind::Jitter, "A joint trembles."),
    fault("drift", FaultKind::Drift, "The body drifts or turns over planted feet."),
    fault("ground", FaultKind::Ground, "Planted feet are above or below the ground."),
    fault("sliding", FaultKind::Skating, "A planted foot slides in a stance."),
    fault("ends", FaultKind::Ends, "A T-pose before the motion, or standing still at its ends."),
    fault("rate", FaultKind::Rate, "The motion plays at a wrong speed."),
    metric("pose-jump", MetricId::PoseJump, 20.0, "A joint turns too far in one frame."),
    metric("velocity-jump", MetricId::VelocityJump, 1_000.0, "A joint jolts."),
    metric("spin", MetricId::Spin, 90.0, "The character turns round too fast."),
    metric("skating", MetricId::Skating, 15.0, "The feet move over the ground on average."),
    metric("foot-slide", MetricId::FootSlide, 10.0, "A planted foot slides in the worst stance."),
    metric("penetration", MetricId::ClipPenetration, 5.0, "The body is below the ground."),
    metric("position-jump", MetricId::ClipPositionJump, 5.0, "The body jumps over the ground."),
    Check {
        word: "oddity",
        source: Source::Oddity,
        limit: 0.0,
        help: "Something in the file is odd, and was read nevertheless.",
    },
];

/// The checks that fail unless others are asked for: faults that nobody wants, and jumps.
const USUAL: &str = "spike,gap,swap,rate,pose-jump,spin,position-jump";

/// A check with its limit, and whether its findings fail.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rule {
    pub(super) check: &'static Check,
    pub(super) limit: f64,
    pub(super) fails: bool,
}

/// Returns the rules of a list such as `spin,skating>3cm/s`: every check, of which those that are
/// listed fail. `None` is the usual list.
///
/// # Errors
/// A sentence that says what cannot be read.
pub(super) fn rules(list: Option<&str>) -> Result<Vec<Rule>, String> {
    let rule = |check| Rule { check, limit: check.limit, fails: false };
    let mut rules: Vec<Rule> = CHECKS.iter().map(rule).collect();
    for entry in list.unwrap_or(USUAL).split(',').map(str::trim).filter(|entry| !entry.is_empty()) {
        let (word, limit) = match entry.split_once('>') {
            Some((word, limit)) => (word.trim(), Some(limit.trim())),
            None => (entry, None),
        };
        match word {
            "all" | "none" if limit.is_none() => {
                for rule in &mut rules {
                    rule.fails = word == "all";
                }
                continue;
            }
            _ => {}
        }
        let word = word.replace('_', "-");
        let Some(rule) = rules.iter_mut().find(|rule| rule.check.word == word) else {
            let known: Vec<&str> = CHECKS.iter().map(|check| check.word).collect();
            return Err(format!(
                "found `{word}`, expected all, none, or a check: {}",
                known.join(", ")
            ));
        };
        rule.fails = true;
        if let Some(limit) = limit {
            rule.limit = parse_limit(rule.check, limit)?;
        }
    }
    Ok(rules)
}

/// Reads a limit in the unit of a check, or in one that can be converted to it.
fn parse_limit(check: &Check, text: &str) -> Result<f64, String> {
    let unit = unit_of(check);
    let expected = || {
        format!(
            "{word}: found `{text}`, expected a number, as in {word}>3{unit}",
            word = check.word
        )
    };
    let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let (number, found) = text.split_at(end);
    let number: f64 = number.parse().map_err(|_| expected())?;
    let found = found.trim().replace("deg", "°");
    let factor = match (found.as_str(), unit) {
        ("", _) => 1.0,
        (found, unit) if found == unit => 1.0,
        ("m", "cm") | ("m/s", "cm/s") => 100.0,
        ("mm", "cm") | ("mm/s", "cm/s") => 0.1,
        _ => return Err(expected()),
    };
    Ok(number * factor)
}

/// Returns the unit of a check's limit.
pub(super) fn unit_of(check: &Check) -> &'static str {
    match check.source {
        Source::Metric(id) => id.row().unit.text(),
        Source::Fault(_) => Unit::Percent.text(),
        Source::Oddity => "",
    }
}

/// Returns the table of checks, for the help.
pub(super) fn help() -> String {
    let mut text = format!("Checks (fail unless --fail-on says otherwise: {USUAL}):\n");
    for check in CHECKS {
        let limit = match check.source {
            Source::Oddity => String::new(),
            Source::Metric(_) => format!("> {}{}", check.limit, unit_of(check)),
            Source::Fault(_) => format!("≥ {}{} sure", check.limit, unit_of(check)),
        };
        let (word, help) = (check.word, check.help);
        // Writing to a string cannot fail.
        std::fmt::Write::write_fmt(&mut text, format_args!("  {word:<14} {limit:<12} {help}\n"))
            .ok();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failing(list: Option<&str>) -> Vec<(&'static str, f64)> {
        let rules = rules(list).unwrap();
        let failing = rules.iter().filter(|rule| rule.fails);
        failing.map(|rule| (rule.check.word, rule.limit)).collect()
    }

    #[test]
    fn rules_follow_the_list() {
        assert_eq!(failing(Some("spin,skating>3cm/s")), [("spin", 90.0), ("skating", 3.0)]);
        assert_eq!(
            failing(Some("foot_slide > 0.02m, spike>80%")),
            [("spike", 80.0), ("foot-slide", 2.0)]
        );
        assert_eq!(failing(Some("pose-jump>3deg")), [("pose-jump", 3.0)]);
        assert_eq!(failing(Some("velocity-jump>90deg/s")), [("velocity-jump", 90.0)]);
        assert_eq!(failing(Some("none")), []);
        assert_eq!(failing(Some("all")).len(), CHECKS.len());
        assert_eq!(failing(Some("all,none,oddity")), [("oddity", 0.0)]);
        assert_eq!(failing(None).len(), USUAL.split(',').count());
    }

    #[test]
    fn invalid_rule_is_named() {
        for (list, reason) in [
            ("spni", "found `spni`, expected all, none, or a check: spike, gap"),
            ("spin>3kg", "spin: found `3kg`, expected a number, as in spin>3°"),
            ("skating>fast", "skating: found `fast`, expected a number, as in skating>3cm/s"),
            ("skating>", "skating: found ``"),
            ("skating>1.2.3", "skating: found `1.2.3`"),
        ] {
            let error = rules(Some(list)).unwrap_err();
            assert!(error.starts_with(reason), "{error}");
        }
    }
}
