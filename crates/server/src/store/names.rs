//! Ids as numbers: tags, people, kinds and places come in every row, so that each is a number of the table `name`.

use sqlx::{SqliteConnection, SqliteExecutor};
use std::collections::HashMap;
use std::sync::Arc;

/// Names by number and numbers by name, as far as known. Names are never taken away and never change their number.
#[derive(Debug, Default, Clone)]
pub(crate) struct Names {
    numbers: HashMap<Arc<str>, i64>,
    names: HashMap<i64, Arc<str>>,
}

impl Names {
    /// Number of a name.
    pub(crate) fn number(&self, name: &str) -> Option<i64> {
        self.numbers.get(name).copied()
    }

    /// Name of a number; `None` for 0, which is nobody and nothing.
    pub(crate) fn name(&self, number: i64) -> Option<Arc<str>> {
        self.names.get(&number).cloned()
    }

    /// Whether the number stands for something that is not known here.
    pub(crate) fn lacks(&self, number: i64) -> bool {
        number != 0 && !self.names.contains_key(&number)
    }

    fn add(&mut self, name: Arc<str>, number: i64) {
        self.names.insert(number, Arc::clone(&name));
        self.numbers.insert(name, number);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Takes over what another knows.
    pub(crate) fn extend(&mut self, other: Self) {
        self.numbers.extend(other.numbers);
        self.names.extend(other.names);
    }

    /// All of the table.
    pub(crate) async fn read(from: impl SqliteExecutor<'_>) -> Result<Self, sqlx::Error> {
        let rows: Vec<(i64, String)> = sqlx::query_as("SELECT id, name FROM name").fetch_all(from).await?;
        let mut names = Self::default();
        for (number, name) in rows {
            names.add(name.into(), number);
        }
        Ok(names)
    }
}

/// Names met in one transaction: those known before and those that it adds, which count for others once it is committed.
pub(crate) struct Naming<'a> {
    known: &'a Names,
    pub(crate) added: Names,
}

impl<'a> Naming<'a> {
    pub(crate) fn new(known: &'a Names) -> Self {
        Self { known, added: Names::default() }
    }

    /// The number of a name, given to it now if it has none.
    pub(crate) async fn number(
        &mut self,
        name: &str,
        connection: &mut SqliteConnection,
    ) -> Result<i64, sqlx::Error> {
        if let Some(number) = self.known.number(name).or_else(|| self.added.number(name)) {
            return Ok(number);
        }
        sqlx::query("INSERT INTO name (name) VALUES (?1) ON CONFLICT DO NOTHING")
            .bind(name)
            .execute(&mut *connection)
            .await?;
        let (number,): (i64,) =
            sqlx::query_as("SELECT id FROM name WHERE name = ?1").bind(name).fetch_one(connection).await?;
        self.added.add(name.into(), number);
        Ok(number)
    }

    /// The same, 0 for none.
    pub(crate) async fn number_or_none(
        &mut self,
        name: Option<&str>,
        connection: &mut SqliteConnection,
    ) -> Result<i64, sqlx::Error> {
        match name {
            Some(name) => self.number(name, connection).await,
            None => Ok(0),
        }
    }
}
