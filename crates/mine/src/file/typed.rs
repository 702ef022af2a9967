//! Tree to plan. Entries with something wrong in them are left out, so that the rest can be checked.

use super::Found;
use super::syntax::syntax;
use super::tree::{Node, Value};
use crate::check::Unread;
use crate::finding::{Place, Step};
use crate::plan::{FORMAT, Grid, MinePlan, SNAP_M};
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};

/// A plan of what could be read.
pub struct Typed {
    pub plan: MinePlan,
    pub unread: Unread,
    pub kept: Kept,
}

/// Which entries of each list were read, by their number in the file.
#[derive(Default)]
pub struct Kept(BTreeMap<&'static str, Vec<usize>>);

impl Kept {
    /// The place in the file of a place in the plan.
    pub fn original(&self, mut place: Place) -> Place {
        if let [Step::Key(list), Step::Entry(index), ..] = place.0.as_mut_slice()
            && let Some(original) = self.0.get(list.as_ref()).and_then(|kept| kept.get(*index))
        {
            *index = *original;
        }
        place
    }
}

/// Reads what has nothing wrong in it.
pub fn read(tree: &Node, found: &mut Vec<Found>) -> Typed {
    let bad: BTreeSet<(String, Option<usize>)> = found.iter().filter_map(|f| top(&f.finding.place)).collect();
    let sound = |key: &str| !bad.contains(&(key.to_owned(), None));
    let mut reading = Reading {
        tree,
        found,
        bad: &bad,
        unread: Unread::default(),
        kept: Kept::default(),
        anything_lost: false,
    };

    let name = tree.get("name").and_then(Node::text).unwrap_or_default();
    let grid = tree.get("grid").filter(|_| sound("grid"));
    let grid: Option<Grid> = grid.and_then(|node| reading.one(node));
    reading.unread.grid = grid.is_none();
    let mut plan = MinePlan::new(name, grid.unwrap_or(Grid::Local {}));
    plan.format =
        tree.get("format").filter(|_| sound("format")).and_then(|n| reading.one(n)).unwrap_or(FORMAT);
    plan.snap_m =
        tree.get("snap_m").filter(|_| sound("snap_m")).and_then(|n| reading.one(n)).unwrap_or(SNAP_M);
    plan.levels = reading.list("levels");
    plan.roadways = reading.list("roadways");
    plan.chambers = reading.list("chambers");
    reading.unread.openings = reading.anything_lost;
    plan.junctions = reading.list("junctions");
    plan.zones = reading.list("zones");
    plan.anchors = reading.list("anchors");
    plan.access_points = reading.list("access_points");
    plan.rfid_portals = reading.list("rfid_portals");
    plan.pillars = reading.list("pillars");
    plan.doors = reading.list("doors");
    plan.conveyors = reading.list("conveyors");
    plan.vehicle_routes = reading.list("vehicle_routes");
    Typed { plan, unread: reading.unread, kept: reading.kept }
}

/// The top key of a place and, in a list, the entry.
fn top(place: &Place) -> Option<(String, Option<usize>)> {
    match place.0.as_slice() {
        [Step::Key(list), Step::Entry(index), ..] => Some((list.to_string(), Some(*index))),
        [Step::Key(key), ..] => Some((key.to_string(), None)),
        _ => None,
    }
}

struct Reading<'r> {
    tree: &'r Node,
    found: &'r mut Vec<Found>,
    bad: &'r BTreeSet<(String, Option<usize>)>,
    unread: Unread,
    kept: Kept,
    anything_lost: bool,
}

impl Reading<'_> {
    fn one<T: DeserializeOwned>(&mut self, node: &Node) -> Option<T> {
        match serde_json::from_value(node.to_json()) {
            Ok(value) => Some(value),
            Err(error) => {
                self.found.push(syntax(node.at, error.to_string()));
                None
            }
        }
    }

    fn list<T: DeserializeOwned>(&mut self, list: &'static str) -> Vec<T> {
        let mut read = Vec::new();
        let Some(node) = self.tree.get(list) else { return read };
        if !matches!(node.value, Value::List(_)) {
            self.anything_lost = true;
        }
        for (index, element) in node.elements().iter().enumerate() {
            let sound = !self.bad.contains(&(list.to_owned(), Some(index)));
            let value = if sound { self.one(element) } else { None };
            if let Some(value) = value {
                read.push(value);
                self.kept.0.entry(list).or_default().push(index);
            } else {
                self.anything_lost = true;
                self.unread.ids.extend(element.get("id").and_then(Node::text).map(str::to_owned));
            }
        }
        read
    }
}
