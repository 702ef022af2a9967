//! `adit audit` and `adit store`: what can be done with the store of a mine beside the server.

use crate::args::{AuditArgs, AuditVerb, AuditVerifyArgs, Exported, StoreArgs, StoreExportArgs, StoreVerb};
use crate::output;
use adit_core::time::Time;
use adit_server::export::{Export, Format, TracksQuery};
use adit_server::store::{LogQuery, Store, TrackOf};
use anyhow::{Context, Result, anyhow, bail};
use std::path::Path;

/// Verifies an audit log.
pub fn audit(args: &AuditArgs) -> Result<()> {
    let AuditVerb::Verify(args) = &args.verb;
    within(verify(args))
}

/// Copies, checks or exports.
pub fn store(args: &StoreArgs) -> Result<()> {
    within(async {
        match &args.verb {
            StoreVerb::Backup(args) => Ok(open(&args.store).await?.backup(&args.out).await?),
            StoreVerb::Check(args) => {
                let wrong = open(&args.store).await?.check().await?;
                for line in &wrong {
                    output::tell(&format!("{line}\n"));
                }
                match wrong.len() {
                    0 => output::print("no damage\n"),
                    count => bail!("{}: {count} findings", args.store.display()),
                }
            }
            StoreVerb::Export(args) => export(args).await,
        }
    })
}

fn within(work: impl Future<Output = Result<()>>) -> Result<()> {
    tokio::runtime::Builder::new_current_thread().enable_all().build().context("no runtime")?.block_on(work)
}

/// A store that is there: none is made.
async fn open(path: &Path) -> Result<Store> {
    if !path.is_file() {
        bail!("{}: no such file", path.display());
    }
    Ok(Store::open(path).await?)
}

async fn verify(args: &AuditVerifyArgs) -> Result<()> {
    let verdict = open(&args.store).await?.verify_audit(&args.heads).await?;
    if args.json {
        output::print(&(serde_json::to_string_pretty(&verdict)? + "\n"))?;
    } else {
        for head in &verdict.too_old {
            output::tell(&format!(
                "head {head}: retention has taken that row away, nothing can be said of it\n"
            ));
        }
        if verdict.broken.is_none() {
            output::print(&format!(
                "{} rows, all as they were written\nhead {}\n",
                verdict.rows, verdict.head
            ))?;
        }
    }
    match verdict.broken {
        Some(broken) => bail!("{}: {broken}", args.store.display()),
        None => Ok(()),
    }
}

async fn export(args: &StoreExportArgs) -> Result<()> {
    let end = args.out.extension().and_then(|end| end.to_str()).unwrap_or_default();
    let format = Format::named(end).ok_or_else(|| {
        anyhow!("{}: unknown format, expected .csv, .geojson or .parquet", args.out.display())
    })?;
    let georeference = match &args.mine {
        Some(path) => adit_mine::file::open(path)?.0.georeference(),
        None => None,
    };
    let time = |stamp: &jiff::Timestamp| i64::try_from(stamp.as_nanosecond()).map(Time::from_nanos);
    let (from, until) =
        (args.from.as_ref().map(time).transpose()?, args.until.as_ref().map(time).transpose()?);
    let store = open(&args.store).await?;
    let subject = args.person.clone().or_else(|| args.tag.clone());
    let log = LogQuery { from, until, subject, ..LogQuery::default() };
    match args.what {
        Exported::Tracks => {
            let of = args.person.clone().map(TrackOf::Person).or_else(|| args.tag.clone().map(TrackOf::Tag));
            let (from, until) =
                (from.unwrap_or(Time::from_nanos(i64::MIN)), until.unwrap_or(Time::from_nanos(i64::MAX)));
            let query = TracksQuery { of, from, until };
            Export::tracks(store, query, format, georeference)?.write_file(&args.out).await?;
        }
        Exported::Events => {
            Export::events(store, log, format, georeference)?.write_file(&args.out).await?;
        }
        Exported::Alarms => {
            Export::alarms(store, log, format, georeference)?.write_file(&args.out).await?;
        }
    }
    Ok(())
}
