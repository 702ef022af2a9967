//! What a check found, and where in the plan.

use crate::problem::Problem;
use alloc::borrow::Cow;
use alloc::vec::Vec;
use core::fmt;
use serde::{Serialize, Serializer};

/// Does the mine stay unusable until it is put right?
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// It does.
    Error,
    /// It works, but is probably not what was meant.
    Warning,
}

/// One step down into a plan.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Step {
    /// A key of a table.
    Key(Cow<'static, str>),
    /// An entry of a list, from 0.
    Entry(usize),
}

/// Where in a plan, from the top; shown as `roadways[3].width_m`.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Place(pub Vec<Step>);

impl Place {
    /// The entry of a list at the top of the plan.
    pub fn entry(list: &'static str, index: usize) -> Self {
        Self([Step::Key(list.into()), Step::Entry(index)].into())
    }

    /// A key at the top of the plan.
    pub fn key(key: &'static str) -> Self {
        Self([Step::Key(key.into())].into())
    }

    /// One step further down, to a key.
    #[must_use]
    pub fn at(mut self, key: impl Into<Cow<'static, str>>) -> Self {
        self.0.push(Step::Key(key.into()));
        self
    }

    /// One step further down, to an entry.
    #[must_use]
    pub fn nth(mut self, index: usize) -> Self {
        self.0.push(Step::Entry(index));
        self
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (depth, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(key) if depth > 0 => write!(f, ".{key}")?,
                Step::Key(key) => write!(f, "{key}")?,
                Step::Entry(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

impl Serialize for Place {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One thing that is wrong with a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Where.
    pub place: Place,
    /// What.
    pub problem: Problem,
}

impl Finding {
    /// Is it an error or a warning?
    pub fn severity(&self) -> Severity {
        self.problem.severity()
    }
}

/// What is wrong and what to do about it, without the place.
impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.problem, self.problem.remedy())
    }
}
