//! How grave a problem is, and what to do about it.

use crate::finding::Severity;
use crate::problem::Problem;
use alloc::borrow::Cow;
use alloc::format;

impl Problem {
    /// Error or warning?
    pub const fn severity(&self) -> Severity {
        match self {
            Self::NothingSpare { .. }
            | Self::TooSteep { .. }
            | Self::OffLevel { .. }
            | Self::JunctionOfOne { .. }
            | Self::EmptyZone { .. }
            | Self::SamePlace { .. }
            | Self::WorksInRock { .. }
            | Self::DoorTooNarrow { .. }
            | Self::NoCapacity {}
            | Self::NoPortal {}
            | Self::NothingExcavated {} => Severity::Warning,
            _ => Severity::Error,
        }
    }

    /// What to do about it, as half a sentence.
    pub fn remedy(&self) -> Cow<'static, str> {
        Cow::Borrowed(match self {
            Self::Syntax { .. } => "correct the text here or just before",
            Self::UnknownKey { expected, .. } => match expected.as_slice() {
                [] => "remove it",
                [nearest] => return format!("did you mean `{nearest}`?").into(),
                several => return format!("expected one of {}", several.join(", ")).into(),
            },
            Self::WrongUnit { expected, .. } => {
                return format!("convert the value and rename it to `{expected}`").into();
            }
            Self::RepeatedKey { .. } | Self::ZeroLengthSegment { .. } | Self::DuplicateLine { .. } => {
                "remove one of them"
            }
            Self::MissingKey { key } => return format!("add `{key} = …`").into(),
            Self::MissingGrid {} => {
                "add `[grid]` with `kind = \"local\"`, `kind = \"epsg\"` and its code, or `kind = \"control-points\"`"
            }
            Self::WrongType { .. } | Self::UnknownWord { .. } | Self::OutOfRange { .. } => {
                "correct the value"
            }
            Self::NotFinite { .. } => "write the number, or leave an optional key out",
            Self::UnknownFormat { .. } => "use a newer adit",
            Self::BadFeature { .. } => "see docs/mine.md for the features of a mine",
            Self::FarCoordinate { .. } => "give coordinates in metres, not millimetres, degrees or feet",
            Self::BadId { .. } => "choose a short printable id",
            Self::DuplicateId { .. } => "give each entry an id of its own",
            Self::UnknownReference { nearest: Some(nearest), .. } => {
                return format!("did you mean \"{nearest}\"?").into();
            }
            Self::UnknownReference { kind, .. } => {
                return format!("add this {kind} or correct the id").into();
            }
            Self::BadMac { .. } => "write twelve hexadecimal digits, with or without colons",
            Self::DuplicateMac { .. } => "correct one of them",
            Self::HalfPathLoss {} => "add the other or remove this one",
            Self::NotProjected { .. } => {
                "project to a system in metres (a UTM zone, the national grid) and give its code"
            }
            Self::NoProjection { .. } => "correct the code, or tie the grid by `kind = \"control-points\"`",
            Self::OffProjection { .. } => {
                "check the code, that easting comes before northing, and that no zone number stands before the easting"
            }
            Self::NoTie { .. } => {
                "add control points that spread in both directions, or use `fit = \"similarity\"`"
            }
            Self::LargeResidual { .. } => {
                "check its coordinates (exchanged easting and northing?), or leave it out"
            }
            Self::OddScale { .. } => {
                "check that grid coordinates are in metres and belong to these control points"
            }
            Self::NothingSpare { .. } => "add a control point",
            Self::TooFewPoints { .. } => "add points",
            Self::TooManyPoints { .. } => "leave out points that hardly change it",
            Self::SteeperThanGiven { .. } => "correct a height, or raise `max_slope_percent`",
            Self::TooSteep { .. } => "correct a height, or give `kind = \"shaft\"` or a `max_slope_percent`",
            Self::OffLevel { .. } => {
                "correct the height, name the other level, or leave `level` out of ramps"
            }
            Self::Overlap { .. } => "end it where it meets the other",
            Self::CrossesWithoutJunction { .. } => {
                "add a junction there, or correct a height if one runs above the other"
            }
            Self::NearMiss { snap_m, .. } => {
                return format!("move its end onto that line, or raise `snap_m` ({snap_m})").into();
            }
            Self::Disconnected { .. } => "extend it to meet the other, or add the ramp or shaft between them",
            Self::JunctionOff { .. } => "move the junction onto the line, or take the roadway from its list",
            Self::JunctionOfOne { .. } => "move it to where they meet, or remove it",
            Self::SelfCrossing { .. } => "put its corners in order around it",
            Self::NoArea { .. } => "give corners that are not on one line",
            Self::EmptyZone { .. } => "check its corners and its level",
            Self::InRock { .. } => "correct its position, or the width of the opening",
            Self::AboveRoof { .. } | Self::BelowFloor { .. } => {
                "correct its height (of the grid, not above the floor), or the opening's"
            }
            Self::SamePlace { .. } => "correct the position of one of them",
            Self::InPillar { .. } => "move it to the pillar's face",
            Self::WorksInRock { .. } => "check its points and its level",
            Self::DoorTooNarrow { .. } => "put its ends on the walls",
            Self::BrokenRoute { .. } => "name the roadways in between",
            Self::RefugeUnreachable { .. } => {
                "connect it by a roadway, or check `walkable` of the roadways that lead here"
            }
            Self::NoCapacity {} => "add how many people it keeps alive",
            Self::NoPortal {} => "add one at each way out",
            Self::NothingExcavated {} => "add roadways or chambers",
        })
    }
}
