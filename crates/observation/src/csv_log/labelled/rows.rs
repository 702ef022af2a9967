//! The rows of a table of labelled ranges.

use super::{LabelledRange, LabelledRanges, LinkClass};
use crate::csv_log::finder::Finder;
use crate::csv_log::header::{Column, missing, name};
use crate::csv_log::radio_columns::fault_of;
use crate::csv_log::range_columns::ReceptionColumns;
use crate::csv_log::table::Table;
use crate::csv_log::units::RANGE_UNITS;
use crate::device::DeviceId;
use crate::error::{LogError, shown};
use crate::files::Input;
use crate::radio::RangeSample;
use crate::warning::{LogWarning, Warnings};
use std::collections::HashMap;
use std::sync::Arc;

const GROUPS: [&str; 4] = ["geometry_id", "tag_location_id", "room_id", "group_id"];
/// Columns of the sets we know that say nothing a receiver would tell, or nothing new.
const LEFT: [&str; 9] = [
    "anchor_x_m",
    "anchor_y_m",
    "anchor_z_m",
    "tag_x_m",
    "tag_y_m",
    "tag_z_m",
    "noise_threshold",
    "cir_power",
    "max_growth_cir",
];

/// Where everything stands in a row.
struct Columns {
    names: Vec<String>,
    /// One column, or those that tell a place together.
    group: Vec<usize>,
    anchor: Option<usize>,
    label: Label,
    range: Option<Column>,
    truth: Option<Column>,
    reception: ReceptionColumns,
}

/// How a table tells the classes.
enum Label {
    Name(usize),
    Nlos(usize),
}

/// Reads the table.
pub fn read(input: Input) -> Result<LabelledRanges, LogError> {
    let mut warnings = Warnings::default();
    let (mut table, header) = Table::new(input, "a header such as geometry_id,label,range_m,rx_power_dBm")?;
    let columns = Columns::find(header.iter().map(name).collect(), &table, &mut warnings)?;
    let mut known: HashMap<String, usize> = HashMap::new();
    let mut set = LabelledRanges {
        path: table.file().to_path_buf(),
        file: table.file().to_path_buf(),
        groups: Vec::new(),
        ranges: Vec::new(),
        tells_ndp: matches!(columns.label, Label::Name(_)),
        tells_in_the_way: false,
        warnings: Vec::new(),
    };
    while table.next()? {
        let parts: Vec<String> = columns.group.iter().map(|index| shown(table.field(*index))).collect();
        let group = parts.join("/");
        let group = *known.entry(group).or_insert_with_key(|name| {
            set.groups.push(name.clone());
            set.groups.len() - 1
        });
        set.ranges.push(columns.read(&table, group)?);
    }
    if set.ranges.is_empty() {
        return Err(LogError::NothingRecorded {
            place: super::whole(table.file()),
            expected: "labelled range",
        });
    }
    set.warnings = warnings.list().to_vec();
    Ok(set)
}

impl Columns {
    fn find(names: Vec<String>, table: &Table, warnings: &mut Warnings) -> Result<Self, LogError> {
        let place = table.place();
        let mut used = vec![false; names.len()];
        let mut finder = Finder { names: &names, used: &mut used, place: &place };
        let group = match finder.one(&GROUPS)? {
            Some(group) => vec![group],
            None => {
                match (finder.one(&["tag_height_m"])?, names.iter().position(|name| name == "true_range_m")) {
                    (Some(height), Some(distance)) => vec![height, distance],
                    _ => return Err(missing(vec![GROUPS.join(" or ")], &names, &place)),
                }
            }
        };
        let label = match (finder.one(&["label"])?, finder.one(&["nlos"])?) {
            (Some(label), _) => Label::Name(label),
            (None, Some(nlos)) => Label::Nlos(nlos),
            (None, None) => return Err(missing(vec!["label or nlos".to_owned()], &names, &place)),
        };
        let range = finder.measured("range", &RANGE_UNITS)?;
        let truth = finder.measured("true_range", &RANGE_UNITS)?;
        let reception = ReceptionColumns::find(&mut finder)?;
        for left in LEFT {
            finder.one(&[left])?;
        }
        let anchor = finder.one(&["anchor_id"])?;
        let ignored = || names.iter().zip(&used).filter(|(_, used)| !**used).map(|(name, _)| name.clone());
        if ignored().next().is_some() {
            let columns = ignored().collect();
            warnings.push(LogWarning::IgnoredColumns { place, columns });
        }
        Ok(Self { names, group, anchor, label, range, truth, reception })
    }

    fn read(&self, table: &Table, group: usize) -> Result<LabelledRange, LogError> {
        let class = match self.label {
            Label::Name(index) => std::str::from_utf8(table.field(index)).ok().and_then(LinkClass::from_name),
            Label::Nlos(index) => match table.field(index) {
                b"0" => Some(LinkClass::Los),
                b"1" => Some(LinkClass::Nlos),
                _ => None,
            },
        };
        let class = class.ok_or_else(|| match self.label {
            Label::Name(index) => bad(table, "label", index, "LOS, NLOS or NDP"),
            Label::Nlos(index) => bad(table, "nlos", index, "0 or 1"),
        })?;
        let (range_m, true_range_m) = (self.distance(table, self.range)?, self.distance(table, self.truth)?);
        let reception =
            self.reception.read(table, &self.names)?.map(Arc::unwrap_or_clone).unwrap_or_default();
        let anchor =
            self.anchor.and_then(|index| DeviceId::new(std::str::from_utf8(table.field(index)).ok()?));
        match reception.fault() {
            None => {
                let (in_the_way, time) = (None, None);
                Ok(LabelledRange { group, class, in_the_way, time, anchor, range_m, true_range_m, reception })
            }
            Some(fault) => Err(fault_of(fault, table)),
        }
    }

    fn distance(&self, table: &Table, column: Option<Column>) -> Result<Option<f64>, LogError> {
        let Some(column) = column.filter(|c| !table.field(c.index).is_empty()) else { return Ok(None) };
        let metres = column.gain.apply(table.number(column.index, &self.names)?);
        if RangeSample::POSSIBLE_M.contains(&metres) {
            return Ok(Some(metres));
        }
        Err(bad(table, &self.names[column.index], column.index, "-1,000 to 1,000,000 m"))
    }
}

fn bad(table: &Table, what: &str, index: usize, expected: &str) -> LogError {
    LogError::BadValue {
        place: table.place(),
        what: what.to_owned(),
        found: format!("\"{}\"", shown(table.field(index))),
        expected: expected.to_owned(),
    }
}
