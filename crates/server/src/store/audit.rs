//! The audit log: who changed what, each row bound to all before it.
//!
//! `hash_n = SHA-256("adit audit 1\n" ‖ hash_{n-1} ‖ canonical(row_n))`, where `canonical` is the number and the time (ns) as 8 bytes
//! big endian each, then `who`, `what`, `source`, `outcome`, `detail`, each as its length in bytes (8 bytes big endian) and its UTF-8; `hash_0` is
//! 32 zero bytes. A row changed, taken out, put in or moved no longer fits the rows after it; a log cut at its end no longer fits the number
//! and hash kept in `audit_end`. Whoever can write the file can also make a new chain: only a head kept elsewhere shows that.

use crate::store::record::AuditRecord;
use crate::store::{Store, StoreError};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use serde_json::json;
use sha2::{Digest as _, Sha256};
use sqlx::{Row as _, SqliteConnection};
use std::fmt;
use std::str::FromStr;

/// Beginning of what is hashed: no other hash of adit is taken for one of the log.
const DOMAIN: &[u8] = b"adit audit 1\n";
/// Row of `audit_end` on which the first row left stands.
pub(crate) const ANCHOR: i64 = 1;
/// Row of `audit_end` of the newest row.
pub(crate) const HEAD: i64 = 2;
/// `what` of the row that retention writes before it takes rows away.
pub(crate) const CUT: &str = "audit.cut";

/// The end of a chain: number of a row, and the hash that holds it and everything before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct AuditHead {
    /// Number of the row, from 1; 0 before the first.
    pub number: u64,
    /// Its hash.
    pub hash: [u8; 32],
}

impl fmt::Display for AuditHead {
    /// `1234:9f86…`, to be written down elsewhere.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.number)?;
        self.hash.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl From<AuditHead> for String {
    fn from(head: AuditHead) -> Self {
        head.to_string()
    }
}

impl TryFrom<String> for AuditHead {
    type Error = StoreError;
    fn try_from(text: String) -> Result<Self, StoreError> {
        text.parse()
    }
}

impl FromStr for AuditHead {
    type Err = StoreError;
    fn from_str(text: &str) -> Result<Self, StoreError> {
        let unusable = || StoreError::Unusable {
            what: "head of the audit log",
            found: text.to_owned(),
            expected: "NUMBER:HASH, the hash of 64 hexadecimal digits".to_owned(),
        };
        let (number, digits) = text.trim().split_once(':').ok_or_else(unusable)?;
        let number = number.parse().map_err(|_| unusable())?;
        if digits.len() != 64 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return Err(unusable());
        }
        let mut hash = [0; 32];
        for (byte, at) in hash.iter_mut().zip((0..64).step_by(2)) {
            *byte =
                u8::from_str_radix(digits.get(at..at + 2).unwrap_or_default(), 16).map_err(|_| unusable())?;
        }
        Ok(Self { number, hash })
    }
}

/// A row of the log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AuditRow {
    /// Its number, from 1 without gaps.
    pub number: u64,
    /// What it says.
    #[serde(flatten)]
    pub record: AuditRecord,
}

/// The hash of a row on the one before; `detail` as it is stored.
pub(crate) fn hash_of(number: u64, row: &AuditRecord, detail: &str, before: &[u8; 32]) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update(DOMAIN);
    hash.update(before);
    hash.update(number.to_be_bytes());
    hash.update(row.time.nanos().to_be_bytes());
    for text in [row.who.as_str(), &row.what, &row.source, &row.outcome, detail] {
        hash.update((text.len() as u64).to_be_bytes());
        hash.update(text.as_bytes());
    }
    hash.finalize().into()
}

pub(crate) async fn end(which: i64, connection: &mut SqliteConnection) -> Result<AuditHead, sqlx::Error> {
    let (number, hash): (i64, Vec<u8>) = sqlx::query_as("SELECT number, hash FROM audit_end WHERE id = ?1")
        .bind(which)
        .fetch_one(connection)
        .await?;
    let hash = hash.try_into().map_err(|hash: Vec<u8>| {
        sqlx::Error::Decode(format!("audit_end {which}: a hash of {} bytes, expected 32", hash.len()).into())
    })?;
    Ok(AuditHead { number: number.cast_unsigned(), hash })
}

/// Puts a row after `head` (`None`: the newest stored); the new head is to be stored by [`write_head`] in the same transaction.
pub(crate) async fn append(
    entry: &AuditRecord,
    head: Option<AuditHead>,
    connection: &mut SqliteConnection,
) -> Result<AuditHead, sqlx::Error> {
    let before = match head {
        Some(head) => head,
        None => end(HEAD, connection).await?,
    };
    let number = before.number + 1;
    let detail = entry.detail.to_string();
    let hash = hash_of(number, entry, &detail, &before.hash);
    sqlx::query("INSERT INTO audit (number, time_ns, who, what, source, outcome, detail, hash) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)")
        .bind(number.cast_signed())
        .bind(entry.time.nanos())
        .bind(&entry.who)
        .bind(&entry.what)
        .bind(&entry.source)
        .bind(&entry.outcome)
        .bind(detail)
        .bind(hash.as_slice())
        .execute(connection)
        .await?;
    Ok(AuditHead { number, hash })
}

/// Stores the newest head.
pub(crate) async fn write_head(
    head: &AuditHead,
    connection: &mut SqliteConnection,
) -> Result<(), sqlx::Error> {
    write_end(HEAD, head, connection).await
}

async fn write_end(which: i64, to: &AuditHead, connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
    sqlx::query("UPDATE audit_end SET number = ?2, hash = ?3 WHERE id = ?1")
        .bind(which)
        .bind(to.number.cast_signed())
        .bind(to.hash.as_slice())
        .execute(connection)
        .await?;
    Ok(())
}

impl Store {
    /// Writes what is not in the journal into the audit log: log-ins, refused calls. On the disk when it returns.
    pub async fn audit(&self, entry: &AuditRecord) -> Result<AuditHead, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut transaction = self.write().await?;
        let head = append(entry, None, &mut transaction).await.map_err(failed)?;
        write_head(&head, &mut transaction).await.map_err(failed)?;
        transaction.commit().await?;
        Ok(head)
    }
}

/// Takes away the oldest rows, those before the first that is not older than `limit`, and writes a row that says so: the chain stands on what that row
/// names. Counts them.
pub(crate) async fn cut(store: &Store, now: Time, limit: Time) -> Result<u64, StoreError> {
    let failed = |error: sqlx::Error| store.failed(&error);
    let mut transaction = store.write().await?;
    let anchor = end(ANCHOR, &mut transaction).await.map_err(failed)?;
    let newest = end(HEAD, &mut transaction).await.map_err(failed)?;
    let kept: Option<i64> = sqlx::query_scalar("SELECT min(number) FROM audit WHERE time_ns >= ?1")
        .bind(limit.nanos())
        .fetch_one(&mut *transaction)
        .await
        .map_err(failed)?;
    let through = kept.map_or(newest.number, |kept| kept.cast_unsigned().saturating_sub(1));
    if through <= anchor.number {
        return Ok(0);
    }
    let row = sqlx::query("SELECT hash FROM audit WHERE number = ?1")
        .bind(through.cast_signed())
        .fetch_optional(&mut *transaction)
        .await
        .map_err(failed)?;
    let hash: Option<[u8; 32]> =
        row.and_then(|row| row.try_get::<Vec<u8>, _>(0).ok()).and_then(|hash| hash.try_into().ok());
    let Some(hash) = hash else {
        return Err(store.corrupt(format!(
            "audit: no row {through} with a hash, expected rows {} to {}",
            anchor.number + 1,
            newest.number
        )));
    };
    let to = AuditHead { number: through, hash };
    let entry = AuditRecord {
        time: now,
        who: "adit".to_owned(),
        what: CUT.to_owned(),
        source: "retention".to_owned(),
        outcome: "done".to_owned(),
        detail: json!({ "through": to.to_string() }),
    };
    let head = append(&entry, Some(newest), &mut transaction).await.map_err(failed)?;
    write_head(&head, &mut transaction).await.map_err(failed)?;
    write_end(ANCHOR, &to, &mut transaction).await.map_err(failed)?;
    let gone = sqlx::query("DELETE FROM audit WHERE number <= ?1")
        .bind(through.cast_signed())
        .execute(&mut *transaction)
        .await
        .map_err(failed)?;
    transaction.commit().await?;
    Ok(gone.rows_affected())
}
