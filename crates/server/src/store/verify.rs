//! Whether the audit log is what was written, and reading it.

use crate::store::audit::{ANCHOR, AuditHead, AuditRow, CUT, HEAD, end, hash_of};
use crate::store::record::AuditRecord;
use crate::store::{Store, StoreError};
use adit_core::time::Time;
use futures_util::TryStreamExt as _;
use serde::{Deserialize, Serialize};
use sqlx::sqlite::SqliteRow;
use sqlx::{QueryBuilder, Row as _};

/// Most rows of one page.
const MOST: u32 = 10_000;

/// What the log looks like.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AuditVerdict {
    /// Rows that fit, from the first.
    pub rows: u64,
    /// What the first row stands on: number 0, or the last row that retention took away.
    pub anchor: AuditHead,
    /// The end of the chain. Written down elsewhere it shows, later, a log that was made anew.
    pub head: AuditHead,
    /// Heads written down earlier whose rows retention took away: nothing can be said of them.
    pub too_old: Vec<AuditHead>,
    /// The first thing that does not fit; `None`: all is as it was written.
    pub broken: Option<AuditBreak>,
}

/// What does not fit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum AuditBreak {
    /// A row is missing, or one was put in.
    #[error("after row {after} comes row {found}: rows were taken out or put in")]
    Gap {
        /// Row before.
        after: u64,
        /// Row found, expected the next.
        found: u64,
    },
    /// The row is not what was written after the row before it.
    #[error("row {number} was changed, or put in, or does not belong after the row before it")]
    Changed {
        /// Which row.
        number: u64,
    },
    /// The log ends elsewhere than it was written to.
    #[error(
        "the log ends with row {found}, written were rows to {expected}: its end was cut off or replaced"
    )]
    End {
        /// Last row found.
        found: u64,
        /// Last row written.
        expected: u64,
    },
    /// The beginning of the log was taken away by somebody else than retention.
    #[error("the log begins after row {anchor}, and no row tells that retention took away the rows to it")]
    Beginning {
        /// The row on which the first one stands.
        anchor: u64,
    },
    /// A head that was written down elsewhere is not in the log.
    #[error("row {number} is not the one whose head was written down: the log was made anew")]
    OtherHead {
        /// Number of that head.
        number: u64,
    },
}

/// Which rows of the log.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct AuditQuery {
    /// From this time on.
    pub from: Option<Time>,
    /// Before this time.
    pub until: Option<Time>,
    /// Of this user.
    pub who: Option<String>,
    /// Of this kind.
    pub what: Option<String>,
    /// Newest first.
    pub newest_first: bool,
    /// After the row with this number.
    pub after: Option<u64>,
    /// At most so many, 1 to 10,000; 0: 10,000.
    pub limit: u32,
}

impl Store {
    /// Goes through the whole log. `written_down`: heads that were kept elsewhere.
    pub async fn verify_audit(&self, written_down: &[AuditHead]) -> Result<AuditVerdict, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut transaction = self.readers().begin().await.map_err(failed)?;
        let anchor = end(ANCHOR, &mut transaction).await.map_err(failed)?;
        let newest = end(HEAD, &mut transaction).await.map_err(failed)?;
        let mut chain = Chain::new(anchor, written_down);
        {
            let mut rows = sqlx::query("SELECT * FROM audit ORDER BY number").fetch(&mut *transaction);
            while let Some(row) = rows.try_next().await.map_err(failed)? {
                if chain.add(&row).map_err(failed)?.is_some() {
                    break;
                }
            }
        }
        transaction.commit().await.map_err(failed)?;
        Ok(chain.finish(newest))
    }

    /// The newest row's number and hash.
    pub async fn audit_head(&self) -> Result<AuditHead, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut connection = self.readers().acquire().await.map_err(failed)?;
        end(HEAD, &mut connection).await.map_err(failed)
    }

    /// Rows of the log, in order of their number.
    pub async fn audit_rows(&self, query: &AuditQuery) -> Result<Vec<AuditRow>, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut sql = QueryBuilder::new("SELECT * FROM audit WHERE true");
        if let Some(from) = query.from {
            sql.push(" AND time_ns >= ").push_bind(from.nanos());
        }
        if let Some(until) = query.until {
            sql.push(" AND time_ns < ").push_bind(until.nanos());
        }
        if let Some(who) = &query.who {
            sql.push(" AND who = ").push_bind(who.clone());
        }
        if let Some(what) = &query.what {
            sql.push(" AND what = ").push_bind(what.clone());
        }
        let (beyond, order) = if query.newest_first { ("<", "DESC") } else { (">", "ASC") };
        if let Some(after) = query.after {
            sql.push(format!(" AND number {beyond} ")).push_bind(after.cast_signed());
        }
        sql.push(format!(" ORDER BY number {order} LIMIT "));
        sql.push_bind(if query.limit == 0 { MOST } else { query.limit.min(MOST) });
        let rows = sql.build().fetch_all(self.readers()).await.map_err(failed)?;
        rows.iter().map(|row| read(row).map(|(row, ..)| row)).collect::<Result<_, _>>().map_err(failed)
    }
}

/// The chain as far as it was gone through.
struct Chain<'a> {
    anchor: AuditHead,
    head: AuditHead,
    rows: u64,
    /// The newest row of retention says that it cut here.
    told_cut: Option<String>,
    written_down: &'a [AuditHead],
    broken: Option<AuditBreak>,
}

impl<'a> Chain<'a> {
    const fn new(anchor: AuditHead, written_down: &'a [AuditHead]) -> Self {
        Self { anchor, head: anchor, rows: 0, told_cut: None, written_down, broken: None }
    }

    /// The next row; what is wrong with it.
    fn add(&mut self, row: &SqliteRow) -> Result<Option<&AuditBreak>, sqlx::Error> {
        let (row, detail, hash) = read(row)?;
        let expected = hash_of(row.number, &row.record, &detail, &self.head.hash);
        if row.number != self.head.number + 1 {
            self.broken = Some(AuditBreak::Gap { after: self.head.number, found: row.number });
        } else if hash != expected {
            self.broken = Some(AuditBreak::Changed { number: row.number });
        } else if self.written_down.iter().any(|head| head.number == row.number && head.hash != expected) {
            self.broken = Some(AuditBreak::OtherHead { number: row.number });
        } else {
            self.head = AuditHead { number: row.number, hash: expected };
            self.rows += 1;
            if row.record.what == CUT {
                self.told_cut =
                    row.record.detail.get("through").and_then(|through| through.as_str()).map(str::to_owned);
            }
        }
        Ok(self.broken.as_ref())
    }

    fn finish(self, newest: AuditHead) -> AuditVerdict {
        let mut broken = self.broken;
        if broken.is_none() && self.head != newest {
            broken = Some(AuditBreak::End { found: self.head.number, expected: newest.number });
        }
        if broken.is_none() && self.anchor.number > 0 && self.told_cut != Some(self.anchor.to_string()) {
            broken = Some(AuditBreak::Beginning { anchor: self.anchor.number });
        }
        let mut too_old = Vec::new();
        for head in self.written_down {
            if head.number < self.anchor.number {
                too_old.push(*head);
            } else if broken.is_none()
                && ((head.number == self.anchor.number && *head != self.anchor)
                    || head.number > newest.number)
            {
                broken = Some(AuditBreak::OtherHead { number: head.number });
            }
        }
        AuditVerdict { rows: self.rows, anchor: self.anchor, head: newest, too_old, broken }
    }
}

/// A row, its particulars as they are stored, and its hash.
fn read(row: &SqliteRow) -> Result<(AuditRow, String, Vec<u8>), sqlx::Error> {
    let number: i64 = row.try_get("number")?;
    let detail: String = row.try_get("detail")?;
    let record = AuditRecord {
        time: Time::from_nanos(row.try_get("time_ns")?),
        who: row.try_get("who")?,
        what: row.try_get("what")?,
        source: row.try_get("source")?,
        outcome: row.try_get("outcome")?,
        // Particulars that somebody made unreadable are no reason not to look at the chain.
        detail: serde_json::from_str(&detail).unwrap_or_else(|_| detail.clone().into()),
    };
    Ok((AuditRow { number: number.cast_unsigned(), record }, detail, row.try_get("hash")?))
}
