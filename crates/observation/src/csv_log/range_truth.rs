//! The truth of the ranges of a log: `ranges_truth.csv` of a simulation, `NAME_ranges_truth.csv` of recorded sets.
//!
//! ```text
//! time_s,anchor_id,true_range_m,class
//! 0.026746,9,5.7146,los
//! ```
//!
//! `tag_id` where there are several tags; `class` (`los`, `nlos`, `ndp`) and `in_the_way` (`nothing`, `shallow`, `deep`, `rock`) where they are known. Other columns are left. Rows are those of the log, by time, anchor and
//! tag.

use super::finder::Finder;
use super::header::{Column, missing, name};
use super::labelled::LinkClass;
use super::table::Table;
use super::units::RANGE_UNITS;
use crate::device::DeviceId;
use crate::error::{LogError, shown};
use crate::files::Input;
use crate::radio::{InTheWay, RangeSample};
use adit_core::time::Time;
use std::collections::HashMap;
use std::path::Path;

/// The truth of one range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueRange {
    /// The distance, m.
    pub distance_m: f64,
    /// How the signal came, where it is told.
    pub class: Option<LinkClass>,
    /// What stood in the way, where it is told.
    pub in_the_way: Option<InTheWay>,
}

/// The truth of the ranges of a log.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RangeTruth {
    rows: HashMap<(Time, DeviceId, Option<DeviceId>), TrueRange>,
    tags: bool,
}

impl RangeTruth {
    /// That of a range of the log.
    pub fn of(&self, range: &RangeSample) -> Option<TrueRange> {
        let tag = range.tag.clone().filter(|_| self.tags);
        self.rows.get(&(range.time, range.anchor.clone(), tag)).copied()
    }
}

/// Whether a file is one: else a truth of positions.
pub fn is_range_truth(path: impl AsRef<Path>) -> Result<bool, LogError> {
    let (_, header) = Table::new(Input::open(path)?, "a header such as time_s,anchor_id,true_range_m")?;
    Ok(header.iter().any(|field| name(field).starts_with("true_range")))
}

/// Reads a file.
pub fn read(path: impl AsRef<Path>) -> Result<RangeTruth, LogError> {
    from_input(Input::open(path)?)
}

/// Reads the text of one.
pub fn from_input(input: Input) -> Result<RangeTruth, LogError> {
    let (mut table, header) = Table::new(input, "a header such as time_s,anchor_id,true_range_m")?;
    let names: Vec<String> = header.iter().map(name).collect();
    let (place, mut used) = (table.place(), vec![false; names.len()]);
    let mut finder = Finder { names: &names, used: &mut used, place: &place };
    let time = finder.needed(&["time_s"])?;
    let anchor = finder.needed(&["anchor_id", "anchor"])?;
    let tag = finder.one(&["tag_id", "tag"])?;
    let class = finder.one(&["class"])?;
    let in_the_way = finder.one(&["in_the_way"])?;
    let Some(Column { index: distance, gain }) = finder.measured("true_range", &RANGE_UNITS)? else {
        return Err(missing(vec!["true_range_m".to_owned()], &names, &place));
    };
    let mut truth = RangeTruth { rows: HashMap::new(), tags: tag.is_some() };
    while table.next()? {
        let device = |index: usize| {
            let text = std::str::from_utf8(table.field(index)).ok();
            text.and_then(DeviceId::new).ok_or_else(|| bad(&table, &names[index], index, "a name"))
        };
        let class = class.filter(|index| !table.field(*index).is_empty()).map(|index| {
            let text = std::str::from_utf8(table.field(index)).ok();
            text.and_then(LinkClass::from_name).ok_or_else(|| bad(&table, "class", index, "los, nlos or ndp"))
        });
        let in_the_way = in_the_way.filter(|index| !table.field(*index).is_empty()).map(|index| {
            let text = std::str::from_utf8(table.field(index)).ok();
            text.and_then(InTheWay::from_name)
                .ok_or_else(|| bad(&table, "in_the_way", index, "nothing, shallow, deep or rock"))
        });
        let distance_m = gain.apply(table.number(distance, &names)?);
        if !RangeSample::POSSIBLE_M.contains(&distance_m) {
            return Err(bad(&table, &names[distance], distance, "-1,000 to 1,000,000 m"));
        }
        let tag = tag.filter(|index| !table.field(*index).is_empty()).map(device).transpose()?;
        let key = (table.time(time, 9, &names)?, device(anchor)?, tag);
        truth.rows.insert(
            key,
            TrueRange { distance_m, class: class.transpose()?, in_the_way: in_the_way.transpose()? },
        );
    }
    Ok(truth)
}

fn bad(table: &Table, what: &str, index: usize, expected: &str) -> LogError {
    LogError::BadValue {
        place: table.place(),
        what: what.to_owned(),
        found: format!("\"{}\"", shown(table.field(index))),
        expected: expected.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::radio::Radio;

    fn truth(text: &str) -> Result<RangeTruth, LogError> {
        from_input(Input::from_bytes("r_truth.csv", text.as_bytes()).unwrap())
    }

    fn range(nanos: i64, anchor: &str, tag: Option<&str>) -> RangeSample {
        RangeSample {
            time: Time::from_nanos(nanos),
            anchor: DeviceId::new(anchor).unwrap(),
            tag: tag.and_then(DeviceId::new),
            range_m: 1.0,
            sigma_m: None,
            line_of_sight: None,
            in_the_way: None,
            radio: Radio::Uwb,
            reception: None,
        }
    }

    #[test]
    fn each_range_finds_its_own_truth() {
        let text =
            "time_s,tag_id,anchor_id,true_range_m,class\n0.5,1,9,5.5,los\n0.5,2,9,6.5,NDP\n1e0,1,9,7,\n";
        let found = truth(text).unwrap();
        let of = |nanos, anchor: &str, tag| found.of(&range(nanos, anchor, tag));
        let half = 500_000_000;
        assert_eq!(
            of(half, "9", Some("1")).unwrap(),
            TrueRange { distance_m: 5.5, class: Some(LinkClass::Los), in_the_way: None }
        );
        assert_eq!(of(half, "9", Some("2")).unwrap().class, Some(LinkClass::Ndp));
        assert_eq!(
            of(2 * half, "9", Some("1")).unwrap(),
            TrueRange { distance_m: 7.0, class: None, in_the_way: None }
        );
        assert_eq!((of(half, "8", Some("1")), of(half + 1, "9", Some("1"))), (None, None));
        // A log with tags, a truth without.
        let found = truth("time_s,anchor,true_range_cm\n0.5,9,550\n").unwrap();
        assert!((found.of(&range(half, "9", Some("1"))).unwrap().distance_m - 5.5).abs() < 1e-12);
    }

    #[test]
    fn faults_name_file_and_line() {
        for (text, expected) in [
            ("time_s,anchor_id\n", "r_truth.csv:1: missing column true_range_m; found time_s, anchor_id"),
            (
                "time_s,anchor_id,true_range_m,class\n0,a,1,perhaps\n",
                "r_truth.csv:2: class: found \"perhaps\", expected los, nlos or ndp",
            ),
            (
                "time_s,anchor_id,true_range_m\n0,a,1\n0,,1\n",
                "r_truth.csv:3: anchor_id: found \"\", expected a name",
            ),
        ] {
            assert_eq!(truth(text).unwrap_err().to_string(), expected);
        }
    }
}
