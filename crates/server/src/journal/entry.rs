//! What an entry of the journal holds.

use adit_core::time::Time;
use prost::Message;
use prost::bytes::Bytes;

/// One thing that came in. On disk it is protobuf, so that later versions read what earlier ones wrote.
#[derive(Clone, PartialEq, Message)]
pub struct Entry {
    /// When it arrived, by the server's clock, ns since the Unix epoch.
    #[prost(sfixed64, tag = "1")]
    pub arrived_ns: i64,
    /// What it is; `None` when a later version wrote what this one does not know.
    #[prost(oneof = "What", tags = "2, 3, 4, 5, 6")]
    pub what: Option<What>,
}

/// What came in.
#[derive(Clone, PartialEq, prost::Oneof)]
pub enum What {
    /// A batch of a gateway, checked to be one.
    #[prost(message, tag = "2")]
    Batch(GatewayBatch),
    /// A position from outside.
    #[prost(message, tag = "3")]
    Position(OutsidePosition),
    /// A command of a user.
    #[prost(message, tag = "4")]
    Command(UserCommand),
    /// A gateway came or went.
    #[prost(message, tag = "5")]
    Gateway(GatewayStatus),
    /// A second has passed.
    #[prost(message, tag = "6")]
    Tick(()),
}

/// A batch as it came.
#[derive(Clone, PartialEq, Message)]
pub struct GatewayBatch {
    /// Which gateway.
    #[prost(string, tag = "1")]
    pub gateway: String,
    /// `adit.v1.ObservationBatch`.
    #[prost(bytes = "bytes", tag = "2")]
    pub batch: Bytes,
}

/// A position that somebody else has found.
#[derive(Clone, PartialEq, Message)]
pub struct OutsidePosition {
    /// The provider: known as a tag.
    #[prost(string, tag = "1")]
    pub tag: String,
    /// When it was valid, ns since the Unix epoch; when it arrived, where nobody says.
    #[prost(sfixed64, optional, tag = "2")]
    pub time_ns: Option<i64>,
    /// East, north, up in the mine's grid, m.
    #[prost(double, tag = "3")]
    pub x_m: f64,
    /// North.
    #[prost(double, tag = "4")]
    pub y_m: f64,
    /// Up.
    #[prost(double, tag = "5")]
    pub z_m: f64,
    /// Radius that holds the truth with 95 %, m.
    #[prost(double, tag = "6")]
    pub radius_95_m: f64,
}

/// A command, and who gave it.
#[derive(Clone, PartialEq, Message)]
pub struct UserCommand {
    /// Name of the user.
    #[prost(string, tag = "1")]
    pub actor: String,
    /// The command as JSON.
    #[prost(string, tag = "2")]
    pub command: String,
}

/// Whether a gateway is there.
#[derive(Clone, PartialEq, Message)]
pub struct GatewayStatus {
    /// Which gateway.
    #[prost(string, tag = "1")]
    pub gateway: String,
    /// Whether it is there.
    #[prost(bool, tag = "2")]
    pub up: bool,
}

impl Entry {
    /// What arrived when.
    pub fn new(arrived: Time, what: What) -> Self {
        Self { arrived_ns: arrived.nanos(), what: Some(what) }
    }

    /// When it arrived.
    pub fn arrived(&self) -> Time {
        Time::from_nanos(self.arrived_ns)
    }
}
