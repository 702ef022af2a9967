//! `adit serve`: its flags.

use clap::{Args, ValueHint};
use std::net::SocketAddr;
use std::path::PathBuf;

const SERVE_HELP: &str = "\
Needs nothing beside it: what is kept stands in one folder (a journal, snapshots, an SQLite file). Gateways bring batches of observations by HTTP
(POST /api/v1/gateways/NAME/batches) or by an MQTT broker; the address of the API is printed. The first start makes a user `admin` and prints
its password, once. Ctrl-C ends it: what has come is stored first.

Settings, all with defaults but the mine; --mine, --data and --listen go before those of the file:
  [site]          name, mine, data, radio = [\"FILE\", …]
  [api]           listen, certificate, key, open_metrics, secure_cookies
  [mqtt]          host, port, client_id, user, password_file, certificate_authority
  [pipeline]      threads, snapshot_s
  [retention]     tracks_days, events_days, alarms_days, audit_days
  [auth] [feed] [rules]
  [[profiles]]    name, tags = [\"W-*\"], method, config = \"FILE\", sidecar = \"FILE\", location; the first that a tag fits is its own

Examples:
  adit serve --mine mines/two-level.toml
  adit serve --config /etc/adit/north.toml
  curl -s localhost:8080/health";

/// `adit serve`.
#[derive(Debug, Args)]
#[command(after_help = SERVE_HELP)]
pub struct ServeArgs {
    /// Settings
    #[arg(long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub config: Option<PathBuf>,

    /// The mine, in any form of adit mine
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, required_unless_present = "config")]
    pub mine: Option<PathBuf>,

    /// Folder of everything that is kept; adit-data when not given here or in the settings
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub data: Option<PathBuf>,

    /// Address of the API; 127.0.0.1:8080 when not given here or in the settings. Port 0: any that is free
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub listen: Option<SocketAddr>,

    /// End when stdin does: whoever started it is gone
    #[arg(long, hide = true)]
    pub while_stdin: bool,
}
