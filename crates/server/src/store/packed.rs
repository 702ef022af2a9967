//! A fix as it is stored: whole milliseconds and centimetres.

use crate::store::names::Names;
use crate::store::record::FixRecord;
use adit_core::solution::Quality;
use adit_core::time::Time;

const NANOS_PER_MILLI: i64 = 1_000_000;
const CENTIMETRES_PER_METRE: f64 = 100.0;
/// No grid of the Earth has coordinates past this.
const FARTHEST_CM: f64 = 2.0e9;
/// A radius past 1,000 km says nothing more.
const WIDEST_RADIUS_CM: f64 = 1.0e8;
/// Bits of a radius that are kept: 1 part in 32 at most is added.
const RADIUS_BITS: u32 = 6;

/// One fix in the units of the store; names as numbers, 0 for none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PackedFix {
    pub(crate) time_ms: i64,
    pub(crate) tag: i64,
    pub(crate) person: i64,
    pub(crate) position_cm: [i64; 3],
    pub(crate) radius_cm: i64,
    pub(crate) quality: i64,
    pub(crate) level: i64,
    pub(crate) zone: i64,
}

/// The measures of a fix, rounded; `None` where a number is none or has no room.
pub(crate) struct Measures {
    pub(crate) time_ms: i64,
    pub(crate) position_cm: [i64; 3],
    pub(crate) radius_cm: i64,
    pub(crate) quality: i64,
}

impl Measures {
    pub(crate) fn of(fix: &FixRecord) -> Option<Self> {
        let [x, y, z] = fix.position_m.map(centimetres);
        Some(Self {
            time_ms: milliseconds(fix.time),
            position_cm: [x?, y?, z?],
            radius_cm: radius_centimetres(fix.radius_95_m)?,
            quality: quality_number(fix.quality),
        })
    }
}

impl PackedFix {
    /// As a record again; `None` if its quality is none that there is.
    pub(crate) fn record(&self, names: &Names) -> Option<FixRecord> {
        let text = |number| names.name(number).map(|name| name.to_string());
        Some(FixRecord {
            person: text(self.person),
            tag: text(self.tag)?,
            time: time_of_milliseconds(self.time_ms),
            position_m: self.position_cm.map(|centimetres| centimetres as f64 / CENTIMETRES_PER_METRE),
            radius_95_m: self.radius_cm as f64 / CENTIMETRES_PER_METRE,
            quality: quality_of(self.quality)?,
            level: text(self.level),
            zone: text(self.zone),
        })
    }
}

/// To the nearest millisecond.
pub(crate) const fn milliseconds(time: Time) -> i64 {
    let nanos = time.nanos();
    let whole = nanos.div_euclid(NANOS_PER_MILLI);
    if nanos.rem_euclid(NANOS_PER_MILLI) >= NANOS_PER_MILLI / 2 { whole + 1 } else { whole }
}

pub(crate) const fn time_of_milliseconds(milliseconds: i64) -> Time {
    Time::from_nanos(milliseconds.saturating_mul(NANOS_PER_MILLI))
}

fn centimetres(metres: f64) -> Option<i64> {
    let centimetres = (metres * CENTIMETRES_PER_METRE).round();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "whole, and its range is checked in the same expression"
    )]
    (centimetres.abs() <= FARTHEST_CM).then_some(centimetres as i64)
}

/// Up to the next number of six significant bits.
fn radius_centimetres(metres: f64) -> Option<i64> {
    if metres.is_nan() || metres < 0.0 {
        return None;
    }
    // 1e-6 cm off, so that a radius that was read is stored as the same again.
    let centimetres = (metres.mul_add(CENTIMETRES_PER_METRE, -1e-6)).ceil().clamp(0.0, WIDEST_RADIUS_CM);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 0 to 1e8")]
    let whole = centimetres as u32;
    let dropped = (u32::BITS - whole.leading_zeros()).saturating_sub(RADIUS_BITS);
    Some(i64::from(whole.div_ceil(1 << dropped) << dropped))
}

const fn quality_number(quality: Quality) -> i64 {
    match quality {
        Quality::Fixed => 0,
        Quality::DeadReckoning => 1,
        Quality::Lost => 2,
    }
}

const fn quality_of(number: i64) -> Option<Quality> {
    match number {
        0 => Some(Quality::Fixed),
        1 => Some(Quality::DeadReckoning),
        2 => Some(Quality::Lost),
        _ => None,
    }
}
