//! The values that a comparison begins with, and one more value on request.

use crate::params::{Choice, Compare, Key, Kind, MAX_PANES, Value};

impl Compare {
    /// Returns the experiment of the course: the full value, half of it and a third. If the range
    /// (the parameter's own, or a narrower one) does not keep the three apart, returns both its
    /// ends and its middle. `None` for a parameter that is not a number or cannot be compared.
    #[must_use]
    pub fn full_half_third(key: Key, full: f64, range: Option<(f64, f64)>) -> Option<Self> {
        let Kind::Number { min, max, .. } = key.param().kind else {
            return None;
        };
        let (min, max) = range.unwrap_or((min, max));
        let checked = |number: f64| key.param().check(Value::Number(number.clamp(min, max))).ok();
        let of =
            |numbers: [f64; 3]| numbers.into_iter().map(checked).collect::<Option<Vec<Value>>>();
        let mut values = of([full, full / 2.0, full / 3.0])?;
        if values[0] == values[1] || values[1] == values[2] {
            values = of([max, f64::midpoint(min, max), min])?;
        }
        key.param().is_comparable().then_some(Self { key, values })
    }

    /// Returns a choice and the alternatives to it, as many as fit. `None` for a parameter that is
    /// not a choice or cannot be compared.
    #[must_use]
    pub fn choices(key: Key, chosen: &Value) -> Option<Self> {
        let Kind::Choice(choices) = key.param().kind else {
            return None;
        };
        let (first, others): (Vec<&Choice>, Vec<&Choice>) =
            choices.iter().partition(|choice| *chosen == Value::Choice(choice.key));
        let values = first.into_iter().chain(others).take(MAX_PANES);
        key.param()
            .is_comparable()
            .then(|| Self { key, values: values.map(|choice| Value::Choice(choice.key)).collect() })
    }

    /// Returns the comparison with one more value, if there is room: the next choice that is not in
    /// it, or the next share of its first number, a quarter after a third. If the range (the
    /// parameter's own, or a narrower one) ends before that, the middle of the widest gap between
    /// its values.
    #[must_use]
    pub fn with_one_more(&self, range: Option<(f64, f64)>) -> Self {
        let mut more = self.clone();
        let (min, max) = match self.key.param().kind {
            Kind::Number { min, max, .. } => range.unwrap_or((min, max)),
            Kind::Choice(choices) => {
                let others = choices.iter().map(|choice| Value::Choice(choice.key));
                more.values.extend(others.filter(|choice| !self.values.contains(choice)).take(1));
                more.values.truncate(MAX_PANES);
                return more;
            }
            _ => return more,
        };
        let number = |value: &Value| match value {
            Value::Number(number) => Some(*number),
            _ => None,
        };
        let mut numbers: Vec<f64> = self.values.iter().filter_map(number).collect();
        let Some(share) = numbers.first().map(|first| first / (self.values.len() + 1) as f64)
        else {
            return more;
        };
        numbers.sort_by(f64::total_cmp);
        let gaps =
            numbers.windows(2).map(|pair| (pair[1] - pair[0], f64::midpoint(pair[0], pair[1])));
        let widest = gaps.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(min, |(_, middle)| middle);
        let next = Value::Number(if (min..=max).contains(&share) { share } else { widest });
        if let Ok(next) = self.key.param().check(next) {
            more.values.push(next);
            more.values.truncate(MAX_PANES);
        }
        more
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparison_reads_back_as_written() {
        let compare = Compare::parse("blend_window: 30, 15,10").unwrap();
        assert_eq!(compare.to_string(), "blend_window:30,15,10");
        assert_eq!(Compare::full_half_third(Key::BlendWindow, 30.0, None), Some(compare.clone()));
        let four = compare.with_one_more(None);
        assert_eq!(four.to_string(), "blend_window:30,15,10,8");
        assert_eq!(four.with_one_more(None), four);
        // The id of a kept clip contains commas, and so may the name of a file.
        let clips = Compare::parse("a:walk,blend(a:walk,b:run),my%2C walk.bvh~0a1b2c3d").unwrap();
        assert_eq!(clips.values[2], Value::Text("my, walk.bvh~0a1b2c3d".into()));
        assert_eq!(Compare::parse(&clips.to_string()), Ok(clips));
        let methods = Compare::parse("method:inertialize, smooth,dead").unwrap();
        assert_eq!(methods.to_string(), "method:inertialize,smooth,dead");
    }

    #[test]
    fn comparison_of_a_number_has_distinct_values_in_range() {
        let of = |key, full, range| Compare::full_half_third(key, full, range).unwrap().to_string();
        // No run is as slow as a third of its speed.
        assert_eq!(of(Key::GaitSpeed, 3.5, Some((1.8, 6.5))), "gait_speed:6.5,4.15,1.8");
        let runs = Compare::parse("gait_speed:6.5,4.15,1.8").unwrap();
        assert_eq!(runs.with_one_more(Some((1.8, 6.5))).to_string(), "gait_speed:6.5,4.15,1.8,3");
        assert_eq!(of(Key::GaitSpeed, 1.4, Some((0.4, 2.2))), "gait_speed:1.4,0.7,0.45");
        assert_eq!(of(Key::BlendWindow, 1.0, None), "blend_window:240,121,1");
        assert_eq!(Compare::full_half_third(Key::Method, 1.0, None), None);
        let methods = Compare::choices(Key::Method, &Value::Choice("dead")).unwrap();
        assert!(methods.to_string().starts_with("method:dead,inertialize,"), "{methods}");
        assert_eq!(methods.values.len(), MAX_PANES);
        assert_eq!(methods.with_one_more(None), methods);
        let two = Compare::parse("method:dead,cut").unwrap().with_one_more(None);
        assert_eq!(two.to_string(), "method:dead,cut,inertialize");
    }

    #[test]
    fn invalid_comparison_is_refused_with_a_reason() {
        for (text, part) in [
            ("blend_window", "key:value"),
            ("align:1,2", "not `align`"),
            ("rate:1,2", "not `rate`"),
            ("method:cut,leap", "expected inertialize"),
            ("a:walk", "not 1"),
            ("a:walk,blend(a:walk", "brackets close"),
            ("blend_window:30", "2 to 4 values, not 1"),
            ("blend_window:1,2,3,4,5", "not 5"),
            ("leave_a:auto,1", "not `auto`"),
            ("blend_window:0,3", "1 to 240 frames"),
        ] {
            let message = Compare::parse(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
