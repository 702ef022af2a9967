//! Rounds of records in one transaction, with the position of the journal.

use crate::store::names::Naming;
use crate::store::packed::{Measures, PackedFix};
use crate::store::record::{AlarmRecord, Committed, EventRecord, FixRecord, Record, Round};
use crate::store::{Store, StoreError, audit};
use sqlx::{AssertSqlSafe, SqliteConnection};
use std::sync::{Arc, LazyLock};

/// Fixes written by one statement: many, some, one.
const AT_ONCE: [usize; 3] = [128, 16, 1];

const COLUMNS: usize = 10;

/// The statements for so many fixes; the same text each time, so that `SQLite` prepares each once.
static INSERT_FIXES: LazyLock<[Arc<str>; 3]> = LazyLock::new(|| {
    AT_ONCE.map(|rows| {
        let row = format!("({})", ["?"; COLUMNS].join(","));
        let rows = vec![row; rows].join(",");
        format!("INSERT INTO fix_recent (time_ms, tag, person, x_cm, y_cm, z_cm, radius_cm, quality, level, zone) VALUES {rows}").into()
    })
});

impl Store {
    /// Position of the journal up to which everything is stored.
    pub async fn applied(&self) -> Result<u64, StoreError> {
        let position: i64 = sqlx::query_scalar("SELECT position FROM applied")
            .fetch_one(self.readers())
            .await
            .map_err(|error| self.failed(&error))?;
        Ok(position.cast_unsigned())
    }

    /// The same for one round.
    pub async fn commit(&self, position: u64, records: Vec<Record>) -> Result<Committed, StoreError> {
        self.commit_rounds(&[Round { position, records }]).await
    }

    /// Writes all rounds and the position of the last in one transaction: all of it or nothing. Rounds at positions that were stored
    /// before are left out, so that a replayed journal writes nothing twice, however its rounds are grouped.
    ///
    /// # Errors
    /// [`StoreError::OutOfOrder`] unless positions rise; [`StoreError::Locked`] and [`StoreError::Full`] may be tried again.
    pub async fn commit_rounds(&self, rounds: &[Round]) -> Result<Committed, StoreError> {
        for pair in rounds.windows(2) {
            if let [before, after] = pair
                && after.position <= before.position
            {
                return Err(StoreError::OutOfOrder { found: after.position, after: before.position });
            }
        }
        let names = self.names();
        let mut naming = Naming::new(&names);
        let mut transaction = self.write().await?;
        let outcome = match write_rounds(rounds, &mut naming, &mut transaction).await {
            Ok(outcome) => outcome,
            Err(error) => return Err(self.failed(&error)),
        };
        transaction.commit().await?;
        let added = naming.added;
        self.learn(added);
        Ok(outcome)
    }
}

async fn write_rounds(
    rounds: &[Round],
    naming: &mut Naming<'_>,
    connection: &mut SqliteConnection,
) -> Result<Committed, sqlx::Error> {
    let position: i64 =
        sqlx::query_scalar("SELECT position FROM applied").fetch_one(&mut *connection).await?;
    let mut outcome = Committed { applied: position.cast_unsigned(), ..Committed::default() };
    let mut fixes = Vec::new();
    let mut chain = None;
    for round in rounds {
        if round.position <= outcome.applied {
            outcome.repeated += round.records.len() as u64;
            continue;
        }
        outcome.applied = round.position;
        for record in &round.records {
            match record {
                Record::Fix(fix) => {
                    let Some(fix) = packed(fix, naming, connection).await? else {
                        outcome.refused += 1;
                        continue;
                    };
                    fixes.push(fix);
                }
                Record::Event(event) => write_event(event, naming, connection).await?,
                Record::Alarm(alarm) => write_alarm(alarm, naming, connection).await?,
                Record::Audit(entry) => chain = Some(audit::append(entry, chain, connection).await?),
            }
            outcome.written += 1;
        }
    }
    write_fixes(&fixes, connection).await?;
    if let Some(head) = chain {
        audit::write_head(&head, connection).await?;
    }
    sqlx::query("UPDATE applied SET position = ?1")
        .bind(outcome.applied.cast_signed())
        .execute(connection)
        .await?;
    Ok(outcome)
}

async fn packed(
    fix: &FixRecord,
    naming: &mut Naming<'_>,
    connection: &mut SqliteConnection,
) -> Result<Option<PackedFix>, sqlx::Error> {
    let Some(measures) = Measures::of(fix) else { return Ok(None) };
    Ok(Some(PackedFix {
        time_ms: measures.time_ms,
        tag: naming.number(&fix.tag, connection).await?,
        person: naming.number_or_none(fix.person.as_deref(), connection).await?,
        position_cm: measures.position_cm,
        radius_cm: measures.radius_cm,
        quality: measures.quality,
        level: naming.number_or_none(fix.level.as_deref(), connection).await?,
        zone: naming.number_or_none(fix.zone.as_deref(), connection).await?,
    }))
}

async fn write_fixes(fixes: &[PackedFix], connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
    let mut left = fixes;
    for (rows, statement) in AT_ONCE.into_iter().zip(INSERT_FIXES.iter()) {
        while left.len() >= rows {
            let (now, later) = left.split_at(rows);
            left = later;
            let mut query = sqlx::query(AssertSqlSafe(Arc::clone(statement)));
            for fix in now {
                let [x, y, z] = fix.position_cm;
                for number in [
                    fix.time_ms,
                    fix.tag,
                    fix.person,
                    x,
                    y,
                    z,
                    fix.radius_cm,
                    fix.quality,
                    fix.level,
                    fix.zone,
                ] {
                    query = query.bind(number);
                }
            }
            query.execute(&mut *connection).await?;
        }
    }
    Ok(())
}

async fn write_event(
    event: &EventRecord,
    naming: &mut Naming<'_>,
    connection: &mut SqliteConnection,
) -> Result<(), sqlx::Error> {
    let kind = naming.number(&event.kind, connection).await?;
    let id: i64 =
        sqlx::query_scalar("INSERT INTO event (time_ns, kind, body) VALUES (?1, ?2, ?3) RETURNING id")
            .bind(event.time.nanos())
            .bind(kind)
            .bind(event.body.to_string())
            .fetch_one(&mut *connection)
            .await?;
    for (place, subject) in (0_i64..).zip(&event.subjects) {
        let subject = naming.number(subject, connection).await?;
        sqlx::query(
            "INSERT OR IGNORE INTO event_subject (subject, time_ns, event, place) VALUES (?1, ?2, ?3, ?4)",
        )
        .bind(subject)
        .bind(event.time.nanos())
        .bind(id)
        .bind(place)
        .execute(&mut *connection)
        .await?;
    }
    Ok(())
}

async fn write_alarm(
    alarm: &AlarmRecord,
    naming: &mut Naming<'_>,
    connection: &mut SqliteConnection,
) -> Result<(), sqlx::Error> {
    let kind = naming.number(&alarm.kind, connection).await?;
    let state = naming.number(&alarm.state, connection).await?;
    let id: i64 = sqlx::query_scalar(
        "INSERT INTO alarm (alarm, kind, state, raised_ns, changed_ns, cleared_ns, body) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)
         ON CONFLICT (alarm) DO UPDATE SET kind = excluded.kind, state = excluded.state, raised_ns = excluded.raised_ns,
             changed_ns = excluded.changed_ns, cleared_ns = excluded.cleared_ns, body = excluded.body
         RETURNING id",
    )
    .bind(&alarm.id)
    .bind(kind)
    .bind(state)
    .bind(alarm.raised.nanos())
    .bind(alarm.changed.nanos())
    .bind(alarm.cleared.map(adit_core::time::Time::nanos))
    .bind(alarm.body.to_string())
    .fetch_one(&mut *connection)
    .await?;
    sqlx::query("DELETE FROM alarm_subject WHERE alarm = ?1").bind(id).execute(&mut *connection).await?;
    for (place, subject) in (0_i64..).zip(&alarm.subjects) {
        let subject = naming.number(subject, connection).await?;
        sqlx::query("INSERT OR IGNORE INTO alarm_subject (subject, alarm, place) VALUES (?1, ?2, ?3)")
            .bind(subject)
            .bind(id)
            .bind(place)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}
