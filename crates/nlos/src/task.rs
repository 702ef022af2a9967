//! Which classes a model tells apart, and the questions that it asks for it.
//!
//! Classes are in an order, and question k is asked of what is none of the first k: "is it class k, or one after it?". So sets that tell fewer classes teach the first questions and leave
//! the others alone.

use adit_observation::InTheWay;
use adit_observation::csv_log::labelled::{LabelledRanges, LinkClass};

/// Most classes there are.
pub const MOST_CLASSES: usize = 4;
/// Most questions.
pub const MOST_QUESTIONS: usize = MOST_CLASSES - 1;

/// Classes to tell apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// Line of sight or not.
    LineOfSight,
    /// Line of sight, none, no direct path ([`LinkClass`]).
    DirectPath,
    /// What is in the way ([`InTheWay`]).
    InTheWay,
}

impl Task {
    /// What these sets have labels for, all of them.
    pub fn of(sets: &[LabelledRanges]) -> Self {
        match () {
            () if sets.iter().all(|set| set.tells_in_the_way) => Self::InTheWay,
            () if sets.iter().any(|set| set.tells_ndp) => Self::DirectPath,
            () => Self::LineOfSight,
        }
    }

    /// By the names of its classes.
    pub fn by_classes(names: &[String]) -> Option<Self> {
        [Self::LineOfSight, Self::DirectPath, Self::InTheWay].into_iter().find(|task| task.classes() == names)
    }

    /// Names of the classes, the first of line of sight.
    pub fn classes(self) -> &'static [&'static str] {
        const LINK: [&str; 3] = [LinkClass::Los.name(), LinkClass::Nlos.name(), LinkClass::Ndp.name()];
        const WAY: [&str; InTheWay::COUNT] = [
            InTheWay::Nothing.name(),
            InTheWay::Shallow.name(),
            InTheWay::Deep.name(),
            InTheWay::Rock.name(),
        ];
        match self {
            Self::LineOfSight => &LINK[..2],
            Self::DirectPath => &LINK,
            Self::InTheWay => &WAY,
        }
    }

    /// How many questions there are: one less than classes.
    pub fn questions(self) -> usize {
        self.classes().len() - 1
    }

    /// How many classes both have in common from the first on; all later ones are one with the last of them.
    pub fn common(self, other: Self) -> usize {
        match (self, other) {
            _ if self == other => self.classes().len(),
            // Three classes by the direct path and four by the shadow part what is not in sight differently.
            _ => 2,
        }
    }
}
