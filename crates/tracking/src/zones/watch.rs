//! The zones as they are asked for with every fix: by level, with their bounds.

use super::LiveZone;
use crate::view::Count;
use adit_mine::Mine;
use adit_mine::plan::ZoneKind;
use core::ops::Range;
use std::collections::BTreeMap;

/// Number of a level in the plan.
pub type LevelIndex = u16;

/// A level and the heights that belong to it.
#[derive(Debug, Clone)]
pub struct Band {
    pub id: String,
    pub height_m: Range<f64>,
}

/// The levels of a plan.
#[derive(Debug, Clone, Default)]
pub struct Levels(Vec<Band>);

impl Levels {
    pub fn new(mine: &Mine) -> Self {
        let band = |id: &str| mine.band_m(id).map(|(low, high)| Band { id: id.into(), height_m: low..high });
        Self(mine.plan().levels.iter().filter_map(|level| band(&level.id)).collect())
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|band| band.id.as_str())
    }

    pub fn index(&self, id: &str) -> Option<LevelIndex> {
        self.0.iter().position(|band| band.id == id).and_then(|index| LevelIndex::try_from(index).ok())
    }

    pub fn band(&self, index: LevelIndex) -> Option<&Band> {
        self.0.get(usize::from(index))
    }

    pub fn id(&self, index: LevelIndex) -> Option<&str> {
        self.band(index).map(|band| band.id.as_str())
    }

    /// The level of a height, for somebody who was on a level so far: it changes only this far beyond its border.
    pub fn of(&self, so_far: Option<LevelIndex>, z_m: f64, tolerance_m: f64) -> Option<LevelIndex> {
        let stays = so_far.and_then(|index| self.band(index)).is_some_and(|band| {
            (band.height_m.start - tolerance_m..=band.height_m.end + tolerance_m).contains(&z_m)
        });
        if stays {
            return so_far;
        }
        let index = self.0.iter().position(|band| band.height_m.contains(&z_m))?;
        LevelIndex::try_from(index).ok()
    }
}

/// A zone with what is asked of it with every fix.
#[derive(Debug, Clone)]
pub struct Shape {
    pub live: LiveZone,
    pub level: Option<LevelIndex>,
    low_m: [f64; 2],
    high_m: [f64; 2],
    /// Half of the diagonal of its bounds, m: fixes with a larger radius cannot tell whether they are inside.
    pub half_diagonal_m: f64,
}

impl Shape {
    fn new(live: &LiveZone, levels: &Levels) -> Self {
        let (mut low_m, mut high_m) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in &live.zone.outline_m {
            for axis in 0..2 {
                low_m[axis] = low_m[axis].min(corner[axis]);
                high_m[axis] = high_m[axis].max(corner[axis]);
            }
        }
        let half_diagonal_m = 0.5 * (high_m[0] - low_m[0]).hypot(high_m[1] - low_m[1]);
        Self { live: live.clone(), level: levels.index(&live.zone.level), low_m, high_m, half_diagonal_m }
    }

    pub fn id(&self) -> &str {
        &self.live.zone.id
    }

    pub fn kind(&self) -> ZoneKind {
        self.live.zone.kind
    }

    /// May the straight way between two places touch it?
    pub fn is_near(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        (0..2).all(|axis| {
            let (low, high) =
                if from[axis] < to[axis] { (from[axis], to[axis]) } else { (to[axis], from[axis]) };
            low <= self.high_m[axis] && high >= self.low_m[axis]
        })
    }

    /// Can a fix of this radius tell whether it is inside?
    pub fn is_told_by(&self, radius_m: f64) -> bool {
        radius_m <= self.half_diagonal_m
    }

    /// Is somebody on this level at this place still inside, who was?
    pub fn keeps(&self, level: Option<LevelIndex>, at: [f64; 2], radius_m: f64) -> bool {
        if level != self.level || level.is_none() {
            return false;
        }
        if self.is_told_by(radius_m) {
            self.live.zone.holds(true, at[0], at[1])
        } else {
            self.live.zone.distance_m(at[0], at[1]) <= self.live.zone.exit_tolerance_m + radius_m
        }
    }

    /// Has somebody on this level at this place come in?
    pub fn takes(&self, level: Option<LevelIndex>, at: [f64; 2], radius_m: f64) -> bool {
        level == self.level
            && self.level.is_some()
            && self.is_near(at, at)
            && self.is_told_by(radius_m)
            && self.live.zone.holds(false, at[0], at[1])
    }

    /// May somebody within this radius be inside, though nobody can tell?
    pub fn may_hold(&self, level: Option<LevelIndex>, at: [f64; 2], radius_m: f64) -> bool {
        level == self.level
            && self.level.is_some()
            && !self.is_told_by(radius_m)
            && self.live.zone.distance_m(at[0], at[1]) <= radius_m
    }
}

/// All zones, in the order of their ids, and how many are in each.
#[derive(Debug, Clone, Default)]
pub struct Watch {
    shapes: Vec<Shape>,
    of_level: Vec<Vec<usize>>,
}

impl Watch {
    pub fn new(zones: &BTreeMap<String, LiveZone>, levels: &Levels) -> Self {
        let shapes: Vec<Shape> = zones.values().map(|live| Shape::new(live, levels)).collect();
        let mut of_level = vec![Vec::new(); levels.len()];
        for (index, shape) in shapes.iter().enumerate() {
            if let Some(list) = shape.level.and_then(|level| of_level.get_mut(usize::from(level))) {
                list.push(index);
            }
        }
        Self { shapes, of_level }
    }

    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    pub fn index(&self, id: &str) -> Option<usize> {
        self.shapes.binary_search_by(|shape| shape.id().cmp(id)).ok()
    }

    pub fn get(&self, index: usize) -> Option<&Shape> {
        self.shapes.get(index)
    }

    pub fn find(&self, id: &str) -> Option<&Shape> {
        self.get(self.index(id)?)
    }

    /// The zones on a level.
    pub fn on_level(&self, level: LevelIndex) -> impl Iterator<Item = (usize, &Shape)> {
        let list = self.of_level.get(usize::from(level)).map_or(&[][..], Vec::as_slice);
        list.iter().filter_map(|&index| Some((index, self.get(index)?)))
    }
}

/// How many are where.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts {
    pub mine: Count,
    pub levels: Vec<Count>,
    pub zones: Vec<Count>,
}

impl Counts {
    pub fn new(levels: &Levels, watch: &Watch) -> Self {
        Self {
            mine: Count::default(),
            levels: vec![Count::default(); levels.len()],
            zones: vec![Count::default(); watch.shapes().len()],
        }
    }
}
