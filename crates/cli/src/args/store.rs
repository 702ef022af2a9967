//! `adit audit` and `adit store`: names, flags and their help.

use adit_server::store::AuditHead;
use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

const VERIFY_EXAMPLES: &str = "\
Goes through the whole audit log of a store, which may be in use, and prints its head, NUMBER:HASH. Keep heads elsewhere, on paper or on
another machine: a log that somebody made anew shows only against one of them (docs/live/store.md). Exit code 1 when something does not fit.

Examples:
  adit audit verify adit-data/adit.sqlite
  adit audit verify adit-data/adit.sqlite --head 1234:9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08";

const BACKUP_EXAMPLES: &str = "\
The store may be in use; the copy appears whole or not at all, and a file that is there is not replaced. To restore it, stop adit, put it
in the place of adit.sqlite, remove adit.sqlite-wal and adit.sqlite-shm, and start.

Examples:
  adit store backup adit-data/adit.sqlite -o /mnt/backup/adit-2026-11-22.sqlite";

const EXPORT_EXAMPLES: &str = "\
The store may be in use. GeoJSON has longitudes and latitudes when --mine is a mine whose grid is tied to the Earth, else coordinates of the
grid. Columns and units: docs/live/store.md.

Examples:
  adit store export adit-data/adit.sqlite tracks --from 2026-11-22T06:00:00Z --until 2026-11-22T14:00:00Z -o shift.parquet
  adit store export adit-data/adit.sqlite tracks --person p017 --mine mine.toml -o p017.geojson
  adit store export adit-data/adit.sqlite alarms -o alarms.csv";

/// `adit audit`.
#[derive(Debug, Args)]
pub struct AuditArgs {
    /// What to do with it
    #[command(subcommand)]
    pub verb: AuditVerb,
}

/// What can be done with an audit log.
#[derive(Debug, Subcommand)]
pub enum AuditVerb {
    /// Find out whether the audit log is what was written
    Verify(AuditVerifyArgs),
}

/// `adit audit verify`.
#[derive(Debug, Args)]
#[command(after_help = VERIFY_EXAMPLES)]
pub struct AuditVerifyArgs {
    /// The store
    #[arg(value_name = "STORE", value_hint = ValueHint::FilePath)]
    pub store: PathBuf,

    /// A head that was kept elsewhere; may be given several times
    #[arg(long = "head", value_name = "NUMBER:HASH")]
    pub heads: Vec<AuditHead>,

    /// Print the findings as JSON
    #[arg(long)]
    pub json: bool,
}

/// `adit store`.
#[derive(Debug, Args)]
pub struct StoreArgs {
    /// What to do with it
    #[command(subcommand)]
    pub verb: StoreVerb,
}

/// What can be done with a store.
#[derive(Debug, Subcommand)]
pub enum StoreVerb {
    /// Copy a store, also while it is in use
    Backup(StoreBackupArgs),
    /// Read a whole store and name what is damaged
    Check(StoreCheckArgs),
    /// Write tracks, events or alarms for other programs
    Export(StoreExportArgs),
}

/// `adit store backup`.
#[derive(Debug, Args)]
#[command(after_help = BACKUP_EXAMPLES)]
pub struct StoreBackupArgs {
    /// The store
    #[arg(value_name = "STORE", value_hint = ValueHint::FilePath)]
    pub store: PathBuf,

    /// The copy
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
}

/// `adit store check`.
#[derive(Debug, Args)]
pub struct StoreCheckArgs {
    /// The store
    #[arg(value_name = "STORE", value_hint = ValueHint::FilePath)]
    pub store: PathBuf,
}

/// What is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Exported {
    /// Fixes, one tag after the other
    Tracks,
    /// What happened
    Events,
    /// Alarms as they stand
    Alarms,
}

/// `adit store export`.
#[derive(Debug, Args)]
#[command(after_help = EXPORT_EXAMPLES)]
pub struct StoreExportArgs {
    /// The store
    #[arg(value_name = "STORE", value_hint = ValueHint::FilePath)]
    pub store: PathBuf,

    /// What of it
    #[arg(value_enum)]
    pub what: Exported,

    /// From this time on (RFC 3339); of an alarm: when it was raised
    #[arg(long, value_name = "TIME")]
    pub from: Option<jiff::Timestamp>,

    /// Before this time
    #[arg(long, value_name = "TIME")]
    pub until: Option<jiff::Timestamp>,

    /// Only of this tag
    #[arg(long, value_name = "ID", conflicts_with = "person")]
    pub tag: Option<String>,

    /// Only of this person
    #[arg(long, value_name = "ID")]
    pub person: Option<String>,

    /// The mine, for longitudes and latitudes
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub mine: Option<PathBuf>,

    /// The file; its name ends in .csv, .geojson or .parquet
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
}
