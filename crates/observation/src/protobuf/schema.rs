//! The schemas that MCAP files carry so that any tool can decode them, and the types made of them.

use crate::observation::ObservationKind;

/// Types made by prost from `proto/adit/v1/*.proto`.
#[cfg_attr(
    not(test),
    allow(dead_code, reason = "a batch is read by its envelope; tests hold it against the type made here")
)]
#[expect(clippy::doc_markdown, clippy::trivially_copy_pass_by_ref, reason = "as prost writes enums")]
mod generated {
    include!(concat!(env!("OUT_DIR"), "/schemas.rs"));
}

pub(crate) use generated::adit::v1 as message;
pub(crate) use generated::google::protobuf::Timestamp;

/// `FileDescriptorSet` of all schemas with their imports: the schema data of every channel.
pub(crate) const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/adit_v1.descriptors"));
/// Name of encoding and of schema encoding in MCAP.
pub(crate) const PROTOBUF: &str = "protobuf";

/// Full name of the protobuf message of a kind.
pub(crate) const fn schema_name(kind: ObservationKind) -> &'static str {
    match kind {
        ObservationKind::Imu => "adit.v1.ImuSample",
        ObservationKind::Acceleration => "adit.v1.AccelerationSample",
        ObservationKind::Magnetic => "adit.v1.MagneticSample",
        ObservationKind::Pressure => "adit.v1.PressureSample",
        ObservationKind::Fix => "adit.v1.PositionFix",
        ObservationKind::Signal => "adit.v1.SignalStrength",
        ObservationKind::Range => "adit.v1.RangeSample",
        ObservationKind::Sighting => "adit.v1.Sighting",
    }
}

/// Topic written; any is read.
pub(crate) const fn topic(kind: ObservationKind) -> &'static str {
    match kind {
        ObservationKind::Imu => "/imu",
        ObservationKind::Acceleration => "/acceleration",
        ObservationKind::Magnetic => "/magnetic",
        ObservationKind::Pressure => "/pressure",
        ObservationKind::Fix => "/fix",
        ObservationKind::Signal => "/signal",
        ObservationKind::Range => "/range",
        ObservationKind::Sighting => "/sighting",
    }
}
