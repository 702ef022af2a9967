//! `adit load`: its flags.

use crate::output::Target;
use clap::{Args, ValueHint};
use std::path::PathBuf;

const LOAD_HELP: &str = "\
Walkers are simulated in the mine first (IMU at 100 Hz, ranges); each tag sends what one of them measures, a packet each second, in batches of a
gateway. A batch that is not acknowledged is sent again under its number until it is. A viewer listens to the live positions meanwhile.

Told are batches and packets acknowledged, the time until a batch is acknowledged and until a position of it reaches the viewer, and at the end,
by the numbers of the packets, what was acknowledged and did not come. Exit code 1 when anything is lost.

The token needs the role admin, or viewer and ingest: ADIT_TOKEN, or --token.

Examples:
  adit load --mine mines/two-level.toml --tags 1000 --seconds 60
  adit load http://10.0.0.5:8080 --mine mine.toml --tags 10000 --seconds 600 --json load.json
  adit load --mine mine.toml --mqtt localhost:1883 --site mine";

/// `adit load`.
#[derive(Debug, Args)]
#[command(after_help = LOAD_HELP)]
pub struct LoadArgs {
    /// The server
    #[arg(value_name = "URL", default_value = "http://127.0.0.1:8080", value_hint = ValueHint::Url)]
    pub url: String,

    /// The mine in which is walked, the server's own
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub mine: PathBuf,

    /// Tags
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=999_999))]
    pub tags: u32,

    /// For how long
    #[arg(long, value_name = "S", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub seconds: u32,

    /// Tags of a gateway: packets in a batch
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub per_gateway: u32,

    /// Epochs of ranges a second
    #[arg(long, value_name = "HZ", default_value_t = 1.0)]
    pub ranging_hz: f64,

    /// Different walks
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub walkers: u32,

    /// Seed of the walks
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,

    /// Token of the API
    #[arg(long, value_name = "TOKEN", env = "ADIT_TOKEN", hide_env_values = true)]
    pub token: String,

    /// Sends by this broker instead of HTTP
    #[arg(long, value_name = "HOST:PORT")]
    pub mqtt: Option<String>,

    /// Name of the site in the topics of the broker
    #[arg(long, value_name = "NAME", default_value = "mine")]
    pub site: String,

    /// The report as JSON; `-` for stdout
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub json: Option<Target>,
}
