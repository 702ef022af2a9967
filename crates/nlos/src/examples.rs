//! Labelled ranges made ready to learn from or to be judged.

use crate::error::NlosError;
use crate::features;
use crate::window::{self, Window};
use adit_observation::csv_log::labelled::{LabelledRanges, LinkClass};
use std::path::PathBuf;

/// One range.
#[derive(Debug, Clone)]
pub struct Example {
    /// Index into [`Examples::groups`].
    pub group: usize,
    /// Index into [`Examples::classes`].
    pub class: usize,
    /// What can be measured of it ([`features::NAMES`]).
    pub features: [f32; features::COUNT],
    /// Its response around the first path, where it has one.
    pub window: Option<Box<Window>>,
}

/// Ranges of which one group after the other can be held out.
#[derive(Debug, Clone)]
pub struct Examples {
    /// Two or three.
    pub classes: Vec<LinkClass>,
    /// Which set and which geometry, place or room in it.
    pub groups: Vec<Group>,
    /// The ranges.
    pub rows: Vec<Example>,
}

/// Ranges that belong together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// The set that it is from.
    pub set: PathBuf,
    /// Its name there.
    pub name: String,
}

impl Examples {
    /// Of several sets; all of two classes, or all of three.
    pub fn of(sets: &[LabelledRanges]) -> Result<Self, NlosError> {
        let tells = sets.iter().all(|set| set.tells_ndp);
        if let (false, Some(three)) = (tells, sets.iter().find(|set| set.tells_ndp)) {
            let two = sets.iter().find(|set| !set.tells_ndp).unwrap_or(three);
            return Err(NlosError::MixedClasses { two: two.file.clone(), three: three.file.clone() });
        }
        let classes = LinkClass::ALL[..if tells { 3 } else { 2 }].to_vec();
        let mut examples = Self { classes, groups: Vec::new(), rows: Vec::new() };
        for set in sets {
            let before = examples.groups.len();
            let group = |name: &String| Group { set: set.file.clone(), name: name.clone() };
            examples.groups.extend(set.groups.iter().map(group));
            examples.rows.extend(set.ranges.iter().map(|range| Example {
                group: before + range.group,
                class: range.class as usize,
                features: features::of(&range.reception, range.range_m),
                window: window::of(&range.reception).map(Box::new),
            }));
        }
        Ok(examples)
    }

    /// Without the difference between no line of sight and no direct path.
    pub fn into_two_classes(mut self) -> Self {
        self.classes.truncate(2);
        for row in &mut self.rows {
            row.class = row.class.min(1);
        }
        self
    }

    /// Names of the classes.
    pub fn class_names(&self) -> Vec<&'static str> {
        self.classes.iter().map(|class| class.name()).collect()
    }

    /// Of each row of `rows` its weight: every class weighs the same, and within it every group.
    pub fn weights(&self, rows: &[usize]) -> Vec<f64> {
        let classes = self.classes.len();
        let mut counts = vec![0_usize; self.groups.len() * classes];
        let cell = |row: &usize| self.rows[*row].group * classes + self.rows[*row].class;
        for row in rows {
            counts[cell(row)] += 1;
        }
        let mut groups = vec![0_usize; classes];
        for (cell, count) in counts.iter().enumerate() {
            groups[cell % classes] += usize::from(*count > 0);
        }
        let weight = |row| 1.0 / (counts[cell(row)] * groups[self.rows[*row].class] * classes) as f64;
        rows.iter().map(weight).collect()
    }

    /// Groups that have one of `rows` in this class.
    pub fn groups_of(&self, class: usize, rows: &[usize]) -> Vec<usize> {
        let rows = rows.iter().map(|row| &self.rows[*row]);
        let mut found: Vec<usize> = rows.filter(|row| row.class == class).map(|row| row.group).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}
