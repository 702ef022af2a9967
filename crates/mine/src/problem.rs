//! Everything that can be wrong with a mine, each with what was found and what was expected.

use alloc::string::String;
use alloc::vec::Vec;
use serde::Serialize;

/// What is wrong. The message of [`Display`](core::fmt::Display) says what was found, [`Problem::remedy`] what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize)]
#[serde(tag = "rule", rename_all = "kebab-case")]
#[non_exhaustive]
#[expect(missing_docs, reason = "fields are named for what the message says of them; lengths in metres")]
pub enum Problem {
    // The file as text.
    /// Not the language that the file should be in.
    #[error("{what}")]
    Syntax { what: String },
    /// A name that the format does not have.
    #[error("unknown key `{key}`")]
    UnknownKey { key: String, expected: Vec<String> },
    /// The right quantity in the wrong unit, or in none.
    #[error("unknown key `{key}`: this quantity is given as `{expected}`")]
    WrongUnit { key: String, expected: String },
    /// The same name twice in one table.
    #[error("key `{key}` stands here twice")]
    RepeatedKey { key: String },
    /// Something that must be said is not.
    #[error("`{key}` is missing")]
    MissingKey { key: String },
    /// No word about what the coordinates mean.
    #[error("`grid` is missing: nothing says what the coordinates mean")]
    MissingGrid {},
    /// Text where a number should be, and the like.
    #[error("`{key}`: found {found}, expected {expected}")]
    WrongType { key: String, found: String, expected: String },
    /// Not one of the words the format knows.
    #[error("`{key}`: found \"{found}\", expected one of {}", expected.join(", "))]
    UnknownWord { key: String, found: String, expected: Vec<String> },
    /// NaN or infinity.
    #[error("`{key}`: found {found}, expected a finite number")]
    NotFinite { key: String, found: String },
    /// A file of a later program.
    #[error("format {found}, this program reads format {expected}")]
    UnknownFormat { found: u32, expected: u32 },
    /// A feature of a `GeoJSON` file that adit cannot place.
    #[error("feature: {what}")]
    BadFeature { what: String },

    // Single values.
    /// A number outside what it can be.
    #[error("`{key}`: found {found}, expected {expected}")]
    OutOfRange { key: &'static str, found: f64, expected: &'static str },
    /// A coordinate no mine grid has.
    #[error("coordinate {found} m is more than {limit} m from the origin of the grid")]
    FarCoordinate { found: f64, limit: f64 },
    /// An id that cannot be told apart or typed.
    #[error(
        "id \"{id}\" is empty, longer than {limit} characters, or has blanks around it or control characters in it"
    )]
    BadId { id: String, limit: usize },
    /// An id that another entry has.
    #[error("id \"{id}\" is also that of {other}")]
    DuplicateId { id: String, other: String },
    /// An id that no entry of the right kind has.
    #[error("no {kind} \"{id}\"")]
    UnknownReference { kind: &'static str, id: String, nearest: Option<String> },
    /// A MAC address that is none.
    #[error("\"{mac}\" is no MAC address")]
    BadMac { mac: String },
    /// A MAC address of two access points.
    #[error("MAC address {mac} is also that of access point {other}")]
    DuplicateMac { mac: String, other: String },
    /// A second slope without its breakpoint or the other way round.
    #[error("a path loss has `breakpoint_m` and `exponent_beyond`, or neither")]
    HalfPathLoss {},

    // The grid.
    /// A geographic system: degrees.
    #[error("EPSG:{code} is not a projected system in metres")]
    NotProjected { code: u32 },
    /// A code that is no grid of a mine, or one that cannot be computed.
    #[error("{what}")]
    NoProjection { what: String },
    /// Coordinates where the projection is not made for.
    #[error("east {east_m} m, north {north_m} m is no place of EPSG:{code}")]
    OffProjection { code: u32, east_m: f64, north_m: f64 },
    /// Control points from which no fit can be made.
    #[error("{what}")]
    NoTie { what: String },
    /// A control point that the others contradict.
    #[error(
        "control point {id} lies {residual_m:.3} m from where the fit puts it, expected {tolerance_m} m or less"
    )]
    LargeResidual { id: String, residual_m: f64, tolerance_m: f64 },
    /// A grid whose metre is none.
    #[error("the fitted grid is {scale:.6} times the ground, expected 1 to within 0.1 %")]
    OddScale { scale: f64 },
    /// A fit that would hide any mistake.
    #[error("{found} control points fix the fit exactly: a mistake in one would not show")]
    NothingSpare { found: usize },

    // Roadways.
    /// Too few points for a line or an outline.
    #[error("found {found} points, expected {expected} or more")]
    TooFewPoints { found: usize, expected: usize },
    /// More points than any outline needs.
    #[error("found {found} points, expected {limit} or less")]
    TooManyPoints { found: usize, limit: usize },
    /// Two points in one place.
    #[error("points {} and {} are in the same place", index + 1, index + 2)]
    ZeroLengthSegment { index: usize },
    /// Steeper than its own figure.
    #[error("points {} to {} slope {found_percent:.1} %, expected {limit_percent} % or less", index + 1, index + 2)]
    SteeperThanGiven { index: usize, found_percent: f64, limit_percent: f64 },
    /// Too steep to walk, unless it is a shaft.
    #[error("points {} to {} slope {found_percent:.0} %: too steep for a roadway", index + 1, index + 2)]
    TooSteep { index: usize, found_percent: f64 },
    /// A roadway far from the level it names.
    #[error("height {z_m} m is nearer to level {nearest} than to level {level}")]
    OffLevel { z_m: f64, level: String, nearest: String },
    /// The same line twice.
    #[error("has the same centre line as roadway {other}")]
    DuplicateLine { other: String },
    /// Two roadways in the same place.
    #[error("runs for {length_m:.1} m inside roadway {other}")]
    Overlap { other: String, length_m: f64 },
    /// Two roadways that cut each other without a junction.
    #[error("crosses roadway {other} at ({x_m:.2}, {y_m:.2}) without a junction")]
    CrossesWithoutJunction { other: String, x_m: f64, y_m: f64 },
    /// An end inside another roadway that does not meet it.
    #[error("ends {distance_m:.2} m from the centre line of roadway {other} and does not meet it")]
    NearMiss { other: String, distance_m: f64, snap_m: f64 },
    /// A part of the mine on its own.
    #[error(
        "is not connected to the rest of the mine ({length_m:.0} m of roadway); nearest: {nearest}, {distance_m:.1} m away"
    )]
    Disconnected { length_m: f64, nearest: String, distance_m: f64 },

    // Junctions.
    /// A junction away from a roadway that it names.
    #[error("is {distance_m:.2} m from the centre line of roadway {roadway}, expected {snap_m} m or less")]
    JunctionOff { roadway: String, distance_m: f64, snap_m: f64 },
    /// A junction where fewer than two roadways meet.
    #[error("roadways that meet here: {found}, expected 2 or more")]
    JunctionOfOne { found: usize },

    // Outlines.
    /// An outline that crosses itself.
    #[error("sides {} and {} of the outline meet", first + 1, second + 1)]
    SelfCrossing { first: usize, second: usize },
    /// An outline around nothing.
    #[error("the outline encloses {area_m2:.3} m²")]
    NoArea { area_m2: f64 },
    /// A zone in solid rock.
    #[error("no roadway or chamber of level {level} is inside")]
    EmptyZone { level: String },

    // Devices.
    /// A device in rock.
    #[error("is in rock, {distance_m:.2} m beyond the wall of {opening}")]
    InRock { opening: String, distance_m: f64 },
    /// A device above the roof.
    #[error("is {distance_m:.2} m above the roof of {opening}")]
    AboveRoof { opening: String, distance_m: f64 },
    /// A device below the floor.
    #[error("is {distance_m:.2} m below the floor of {opening}")]
    BelowFloor { opening: String, distance_m: f64 },
    /// Two devices of a kind in one place.
    #[error("is in the same place as {other}")]
    SamePlace { other: String },
    /// A device inside a pillar.
    #[error("is inside pillar {pillar}")]
    InPillar { pillar: String },

    // Works.
    /// A pillar, door or conveyor in solid rock.
    #[error("{what} stands in rock")]
    WorksInRock { what: &'static str },
    /// A door that leaves a gap.
    #[error("spans {width_m:.2} m of roadway {roadway}, which is {expected_m} m wide")]
    DoorTooNarrow { width_m: f64, roadway: String, expected_m: f64 },
    /// A route that jumps.
    #[error("roadway {first} does not meet roadway {second}")]
    BrokenRoute { first: String, second: String },

    // People.
    /// A refuge that nobody can walk to.
    #[error("no roadway that can be walked leads here from {from}")]
    RefugeUnreachable { from: String },
    /// A refuge of unknown size.
    #[error("a refuge has no `capacity`")]
    NoCapacity {},
    /// No way out.
    #[error("no zone of kind \"portal\": nobody ever counts as out")]
    NoPortal {},
    /// Nothing excavated.
    #[error("no roadway and no chamber: places cannot be checked")]
    NothingExcavated {},
}
