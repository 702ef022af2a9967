//! Ranges by group and link, and which groups are held out together.

use super::KnownRange;
use std::collections::BTreeMap;

/// Up to so many groups each is held out alone; of more, [`FOLDS`] parts of them.
const ALONE: usize = 30;
const FOLDS: usize = 10;
/// Ranges of a link used in fits, evenly taken: more are copies.
const OF_LINK: usize = 16;

/// Groups held out together, for all groups of these ranges: in turn, so that neighbours come into different parts.
pub fn of_groups(known: &[KnownRange]) -> Vec<Vec<usize>> {
    let mut groups: Vec<usize> = known.iter().map(|one| one.group).collect();
    groups.sort_unstable();
    groups.dedup();
    let count = if groups.len() > ALONE { FOLDS } else { groups.len() };
    let mut folds = vec![Vec::new(); count];
    for (k, group) in groups.into_iter().enumerate() {
        folds[k % count].push(group);
    }
    folds
}

/// A range and what it weighs: all links the same, 1 in the mean.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    pub known: &'a KnownRange,
    pub weight: f64,
    /// Which link, by group and anchor.
    pub link: usize,
}

/// Ranges to learn from.
#[derive(Debug, Clone)]
pub struct Rows<'a> {
    pub rows: Vec<Row<'a>>,
    /// Links by group, in order.
    pub links: Vec<usize>,
}

impl<'a> Rows<'a> {
    /// Those of `known` that are `wanted`, [`OF_LINK`] of each link at most.
    pub fn of(known: &'a [KnownRange], wanted: impl Fn(&KnownRange) -> bool) -> Self {
        let mut by_link: BTreeMap<(usize, &str), Vec<&KnownRange>> = BTreeMap::new();
        for one in known.iter().filter(|one| wanted(one)) {
            by_link.entry((one.group, one.range.anchor.as_str())).or_default().push(one);
        }
        let mut taken = Self { rows: Vec::new(), links: Vec::new() };
        for (link, ((group, _), ranges)) in by_link.into_iter().enumerate() {
            taken.links.push(group);
            let count = ranges.len().min(OF_LINK);
            let spread = (0..count).map(|k| ranges[k * ranges.len() / count]);
            taken.rows.extend(spread.map(|known| Row { known, weight: 1.0 / count as f64, link }));
        }
        let mean = taken.links.len() as f64 / taken.rows.len().max(1) as f64;
        for row in &mut taken.rows {
            row.weight /= mean;
        }
        taken
    }

    /// How many groups there are.
    pub fn groups(&self) -> usize {
        let mut groups = self.links.clone();
        groups.dedup();
        groups.len()
    }

    /// Each part of the groups as (the others, this part).
    pub fn folds(&self) -> Vec<(Self, Self)> {
        let known = self.rows.iter().map(|row| row.known.group);
        let mut groups: Vec<usize> = known.collect();
        groups.dedup();
        let count = if groups.len() > ALONE { FOLDS } else { groups.len() };
        let of = |fold: usize, inside: bool| {
            let held = |group: &usize| groups.binary_search(group).is_ok_and(|k| k % count == fold);
            let rows = self.rows.iter().filter(|row| held(&row.known.group) == inside).copied().collect();
            Self { rows, links: self.links.clone() }
        };
        (0..count).map(|fold| (of(fold, false), of(fold, true))).collect()
    }

    /// Of values of the rows their weighted mean in each group that has some.
    pub fn group_means(&self, values: &[f64]) -> Vec<f64> {
        let mut sums: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        for (row, value) in self.rows.iter().zip(values) {
            let sum = sums.entry(row.known.group).or_default();
            sum[0] += row.weight * value;
            sum[1] += row.weight;
        }
        sums.into_values().map(|[sum, weight]| sum / weight).collect()
    }
}
