//! The largest value of a quantity, with its frame.

/// The largest value that a quantity has in any frame, and that frame: where a viewer looks for the
/// fault.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Extreme {
    /// The value, in the unit of the quantity.
    pub value: f64,
    /// The frame.
    pub frame: usize,
}

impl Extreme {
    /// Returns the largest of some values with their frames, the first of equal ones.
    #[must_use]
    pub fn largest(values: impl IntoIterator<Item = (usize, f64)>) -> Option<Self> {
        let values = values.into_iter().map(|(frame, value)| Self { value, frame });
        values.reduce(|most, other| if other.value > most.value { other } else { most })
    }

    /// Returns the frame where the fault is; `None` for a value of 0, which is none.
    #[must_use]
    pub fn place(&self) -> Option<usize> {
        (self.value > 0.0).then_some(self.frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_of_equal_values_is_the_first() {
        let most = Extreme::largest([(3, 1.0), (4, 2.5), (5, 2.5), (6, 0.0)]);
        assert_eq!(most, Some(Extreme { value: 2.5, frame: 4 }));
        assert_eq!(Extreme::largest([]), None);
        assert_eq!(most.and_then(|most| most.place()), Some(4));
        assert_eq!(Extreme { value: 0.0, frame: 4 }.place(), None);
    }
}
