//! The columns of a position fix: `fix_east_m, fix_north_m`, its spread, and what may stand beside.
//!
//! | columns | what |
//! |---|---|
//! | `fix_east_m`, `fix_north_m` | position |
//! | `fix_sigma_m`, or `fix_cov_e_e_m2`, `fix_cov_e_n_m2`, `fix_cov_n_n_m2` | its spread |
//! | `fix_up_m`, `fix_up_sigma_m` | height, both or none |
//! | `fix_source` | a name of [`FixSource`] |

use super::header::missing;
use super::table::Table;
use crate::error::{LogError, Place, shown};
use crate::fix::{FixSource, HeightFix, PositionFix};
use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::time::Time;

const PREFIX: &str = "fix_";
const POSITION: [&str; 2] = ["fix_east_m", "fix_north_m"];
const SIGMA: &str = "fix_sigma_m";
const COVARIANCE: [&str; 3] = ["fix_cov_e_e_m2", "fix_cov_e_n_m2", "fix_cov_n_n_m2"];
const HEIGHT: [&str; 2] = ["fix_up_m", "fix_up_sigma_m"];
const SOURCE: &str = "fix_source";

/// Where the parts of a fix stand in a row.
#[derive(Debug, Clone)]
pub struct FixColumns {
    position: [usize; 2],
    spread: Spread,
    height: Option<[usize; 2]>,
    source: Option<usize>,
}

#[derive(Debug, Clone, Copy)]
enum Spread {
    Sigma(usize),
    Covariance([usize; 3]),
}

impl FixColumns {
    /// Finds the columns and marks them as used; `None` where the log has no fixes.
    pub(super) fn find(names: &[String], used: &mut [bool], place: &Place) -> Result<Option<Self>, LogError> {
        let ours: Vec<usize> = (0..names.len()).filter(|index| names[*index].starts_with(PREFIX)).collect();
        if ours.is_empty() {
            return Ok(None);
        }
        for (nth, index) in ours.iter().enumerate() {
            let name = &names[*index];
            if let Some(first) = ours[..nth].iter().find(|first| names[**first] == *name) {
                let (first, second) = (names[*first].clone(), name.clone());
                return Err(LogError::DuplicateColumn { place: place.clone(), first, second });
            }
            if !all_names().any(|known| known == name) {
                let (column, expected) = (name.clone(), all_names().collect::<Vec<_>>().join(", "));
                return Err(LogError::UnknownUnit { place: place.clone(), column, expected });
            }
            used[*index] = true;
        }
        let index = |name: &str| ours.iter().copied().find(|index| names[*index] == name);
        let group = |group: &[&str]| -> Result<Vec<usize>, LogError> {
            let absent: Vec<String> =
                group.iter().filter(|name| index(name).is_none()).map(|name| (*name).to_owned()).collect();
            if absent.is_empty() {
                return Ok(group.iter().filter_map(|name| index(name)).collect());
            }
            Err(missing(absent, names, place))
        };
        let any = |group: &[&str]| group.iter().any(|name| index(name).is_some());
        let position = group(&POSITION)?;
        let spread = match (index(SIGMA), any(&COVARIANCE)) {
            (Some(_), true) => {
                let (first, second) = (SIGMA.to_owned(), COVARIANCE[0].to_owned());
                return Err(LogError::DuplicateColumn { place: place.clone(), first, second });
            }
            (Some(sigma), false) => Spread::Sigma(sigma),
            (None, true) => {
                let found = group(&COVARIANCE)?;
                Spread::Covariance([found[0], found[1], found[2]])
            }
            (None, false) => return Err(missing(vec![SIGMA.to_owned()], names, place)),
        };
        let height = if any(&HEIGHT) { Some(group(&HEIGHT)?) } else { None };
        Ok(Some(Self {
            position: [position[0], position[1]],
            spread,
            height: height.map(|found| [found[0], found[1]]),
            source: index(SOURCE),
        }))
    }

    /// The fix in the present row; `None` where its position fields are empty.
    pub(super) fn read(
        &self,
        table: &Table,
        names: &[String],
        time: Time,
    ) -> Result<Option<PositionFix>, LogError> {
        let empty = |index: usize| table.field(index).is_empty();
        if self.position.into_iter().all(empty) {
            return Ok(None);
        }
        let number = |index: usize| table.number(index, names);
        let covariance_m2 = match self.spread {
            Spread::Sigma(index) => {
                let sigma = number(index)?;
                Matrix2::identity() * (sigma * sigma)
            }
            Spread::Covariance([ee, en, nn]) => {
                let en = number(en)?;
                Matrix2::new(number(ee)?, en, en, number(nn)?)
            }
        };
        let height = match self.height {
            Some([up, sigma]) if !(empty(up) && empty(sigma)) => {
                Some(HeightFix { up_m: number(up)?, sigma_m: number(sigma)? })
            }
            _ => None,
        };
        let fix = PositionFix {
            time,
            level_m: Vector2::new(number(self.position[0])?, number(self.position[1])?),
            covariance_m2,
            height,
            source: self.source.map_or(Ok(FixSource::Unknown), |index| source(table, index))?,
        };
        Ok(Some(fix))
    }
}

fn all_names() -> impl Iterator<Item = &'static str> {
    POSITION.into_iter().chain([SIGMA]).chain(COVARIANCE).chain(HEIGHT).chain([SOURCE])
}

fn source(table: &Table, index: usize) -> Result<FixSource, LogError> {
    let field = table.field(index);
    let name = std::str::from_utf8(field).unwrap_or_default();
    if field.is_empty() {
        return Ok(FixSource::Unknown);
    }
    FixSource::from_name(name).ok_or_else(|| LogError::BadValue {
        place: table.place(),
        what: SOURCE.to_owned(),
        found: shown(field),
        expected: FixSource::ALL.map(FixSource::name).join(", "),
    })
}
