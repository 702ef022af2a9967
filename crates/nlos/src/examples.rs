//! Labelled ranges made ready to learn from or to be judged.

use crate::features;
use crate::window::{self, Window};
use adit_observation::csv_log::labelled::{LabelledRanges, LinkClass};
use std::path::PathBuf;

/// What is asked of a reception.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Did it come straight?
    LineOfSight,
    /// If not: did a direct path arrive at all?
    DirectPath,
}

impl Question {
    /// Both, in order.
    pub const ALL: [Self; 2] = [Self::LineOfSight, Self::DirectPath];

    /// The truth, where it is asked and told; `false` is yes (the first class).
    pub const fn answer(self, row: &Example) -> Option<bool> {
        match self {
            Self::LineOfSight => Some(row.class > 0),
            Self::DirectPath if row.tells_ndp && row.class > 0 => Some(row.class > 1),
            Self::DirectPath => None,
        }
    }
}

/// One range.
#[derive(Debug, Clone)]
pub struct Example {
    /// Index into [`Examples::groups`].
    pub group: usize,
    /// Index into [`Examples::classes`]; of a set that tells line of sight alone, 1 stands for the rest.
    pub class: usize,
    /// Whether its set tells no direct path from no line of sight.
    pub tells_ndp: bool,
    /// What can be measured of it ([`features::NAMES`]).
    pub features: [f32; features::COUNT],
    /// Its response around the first path, where it has one.
    pub window: Option<Box<Window>>,
}

/// Ranges of which one group after the other can be held out.
#[derive(Debug, Clone)]
pub struct Examples {
    /// Three where a set tells no direct path, else two.
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
    /// Of several sets.
    pub fn of(sets: &[LabelledRanges]) -> Self {
        let three = sets.iter().any(|set| set.tells_ndp);
        let classes = LinkClass::ALL[..if three { 3 } else { 2 }].to_vec();
        let mut examples = Self { classes, groups: Vec::new(), rows: Vec::new() };
        for set in sets {
            let before = examples.groups.len();
            let group = |name: &String| Group { set: set.file.clone(), name: name.clone() };
            examples.groups.extend(set.groups.iter().map(group));
            examples.rows.extend(set.ranges.iter().map(|range| Example {
                group: before + range.group,
                class: range.class as usize,
                tells_ndp: set.tells_ndp,
                features: features::of(&range.reception, range.range_m),
                window: window::of(&range.reception).map(Box::new),
            }));
        }
        examples
    }

    /// Names of the classes.
    pub fn class_names(&self) -> Vec<&'static str> {
        self.classes.iter().map(|class| class.name()).collect()
    }

    /// Of each row of `rows` its weight in a question: both answers weigh the same, and within each every group. Rows that the question is not asked of weigh nothing.
    pub fn weights(&self, rows: &[usize], question: Question) -> Vec<f64> {
        let cell = |row: &usize| {
            let answer = question.answer(&self.rows[*row])?;
            Some(2 * self.rows[*row].group + usize::from(answer))
        };
        let mut ranges = vec![0_usize; 2 * self.groups.len()];
        for cell in rows.iter().filter_map(cell) {
            ranges[cell] += 1;
        }
        let groups: [usize; 2] =
            std::array::from_fn(|answer| ranges[answer..].iter().step_by(2).filter(|n| **n > 0).count());
        let weight = |cell: usize| 0.5 / (ranges[cell] * groups[cell % 2]) as f64;
        rows.iter().map(|row| cell(row).map_or(0.0, weight)).collect()
    }

    /// Of a question the odds of yes among these rows, every range counted once.
    pub fn odds(&self, rows: &[usize], question: Question) -> f64 {
        let of =
            |wanted| rows.iter().filter(|row| question.answer(&self.rows[**row]) == Some(wanted)).count();
        (of(false) as f64 + 1.0) / (of(true) as f64 + 1.0)
    }

    /// The questions that these sets teach.
    pub fn questions(&self) -> &'static [Question] {
        if self.classes.len() > 2 { &Question::ALL } else { &Question::ALL[..1] }
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
