//! Labelled ranges made ready to learn from or to be judged.

use crate::features;
use crate::task::Task;
use crate::window::{self, Window};
use adit_core::time::Time;
use adit_observation::DeviceId;
use adit_observation::csv_log::labelled::{LabelledRanges, LinkClass};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// One range.
#[derive(Debug, Clone)]
pub struct Example {
    /// Index into [`Examples::groups`].
    pub group: usize,
    /// Index of its class; the last that its set tells stands for the rest.
    pub class: usize,
    /// How many classes its set tells.
    pub told: usize,
    /// When and on which link, where the set tells: index into [`Examples::links`].
    pub at: Option<(Time, usize)>,
    /// What can be measured of it ([`features::NAMES`]).
    pub features: [f32; features::COUNT],
    /// Its response around the first path, where it has one.
    pub window: Option<Box<Window>>,
}

/// Ranges of which one group after the other can be held out.
#[derive(Debug, Clone)]
pub struct Examples {
    /// The classes.
    pub task: Task,
    /// Which set and which geometry, place or room in it.
    pub groups: Vec<Group>,
    /// The ranges.
    pub rows: Vec<Example>,
    /// How many links there are in sets that tell times.
    pub links: usize,
}

/// Ranges that belong together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// The set that it is from.
    pub set: PathBuf,
    /// Its name there.
    pub name: String,
}

impl Example {
    /// Its answer to a question, where it is asked and told; `false` is yes: of the class with the question's number.
    pub const fn answer(&self, question: usize) -> Option<bool> {
        if self.class >= question && self.told > question + 1 { Some(self.class > question) } else { None }
    }
}

impl Examples {
    /// Of several sets, with the classes that all of them tell.
    pub fn of(sets: &[LabelledRanges]) -> Self {
        Self::for_task(Task::of(sets), sets)
    }

    /// The same for these classes; sets that do not tell them tell line of sight.
    pub fn for_task(task: Task, sets: &[LabelledRanges]) -> Self {
        let mut examples = Self { task, groups: Vec::new(), rows: Vec::new(), links: 0 };
        for set in sets {
            let place = if set.ranges.iter().any(|range| range.time.is_some()) {
                // The logs of everybody in a mine.
                set.path.parent().unwrap_or(&set.path)
            } else {
                &set.file
            };
            let groups: Vec<usize> = set.groups.iter().map(|name| examples.group(place, name)).collect();
            let mut links: HashMap<Option<&DeviceId>, usize> = HashMap::new();
            for range in &set.ranges {
                let at = range.time.map(|time| {
                    let next = examples.links + links.len();
                    (time, *links.entry(range.anchor.as_ref()).or_insert(next))
                });
                let (class, told) = match (task, range.in_the_way) {
                    (Task::InTheWay, Some(way)) => (way as usize, task.classes().len()),
                    (Task::DirectPath, _) if set.tells_ndp => (range.class as usize, task.classes().len()),
                    _ => (usize::from(range.class != LinkClass::Los), 2),
                };
                examples.rows.push(Example {
                    group: groups[range.group],
                    class,
                    told,
                    at,
                    features: features::of(&range.reception, range.range_m),
                    window: window::of(&range.reception).map(Box::new),
                });
            }
            examples.links += links.len();
        }
        examples
    }

    fn group(&mut self, set: &Path, name: &str) -> usize {
        let same = |group: &Group| group.set == set && group.name == name;
        if let Some(known) = self.groups.iter().position(same) {
            return known;
        }
        self.groups.push(Group { set: set.to_path_buf(), name: name.to_owned() });
        self.groups.len() - 1
    }

    /// Of each row of `rows` its weight in a question: both answers weigh the same, and within each every group. Rows that the question is not asked of weigh nothing.
    pub fn weights(&self, rows: &[usize], question: usize) -> Vec<f64> {
        let cell = |row: &usize| {
            let answer = self.rows[*row].answer(question)?;
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
    pub fn odds(&self, rows: &[usize], question: usize) -> f64 {
        let of = |wanted| rows.iter().filter(|row| self.rows[**row].answer(question) == Some(wanted)).count();
        (of(false) as f64 + 1.0) / (of(true) as f64 + 1.0)
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
