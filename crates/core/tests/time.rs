//! Time stamps: whole nanoseconds in, whole nanoseconds out.

#![expect(clippy::unwrap_used, reason = "a test may stop at the first wrong value")]

use adit_core::time::{Interval, Time};
use proptest::prelude::*;

#[test]
fn seconds_become_the_nearest_nanosecond() {
    for (seconds, nanos) in
        [(0.1, 100_000_000), (1.0 / 3.0, 333_333_333), (-2.5e-9, -3), (-0.25, -250_000_000)]
    {
        assert_eq!(Time::from_seconds(seconds), Some(Time::from_nanos(nanos)), "{seconds}");
        assert_eq!(Interval::from_seconds(seconds), Some(Interval::from_nanos(nanos)), "{seconds}");
    }
}

#[test]
fn seconds_that_no_stamp_can_hold_are_refused() {
    for seconds in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 9.3e9, -9.3e9, f64::MAX] {
        assert_eq!(Time::from_seconds(seconds), None, "{seconds}");
        assert_eq!(Interval::from_seconds(seconds), None, "{seconds}");
    }
    assert!(Time::from_seconds(9.223e9).is_some(), "292 years are inside");
}

#[test]
fn a_unix_stamp_of_this_century_is_good_to_a_microsecond_as_seconds() {
    let last = Time::from_nanos(4_102_444_799_999_999_999);
    let back = Time::from_seconds(last.seconds()).unwrap();
    assert!((back - last).nanos().abs() < 1_000);
}

#[test]
fn arithmetic_saturates_instead_of_wrapping() {
    let (first, last) = (Time::from_nanos(i64::MIN), Time::from_nanos(i64::MAX));
    assert_eq!((last - first).nanos(), i64::MAX);
    assert_eq!((first - last).nanos(), i64::MIN);
    assert_eq!(last + Interval::from_nanos(1), last);
    assert_eq!(first - Interval::from_nanos(1), first);
    assert_eq!(last - Interval::from_nanos(i64::MIN), last);
}

#[test]
fn a_stamp_prints_all_nine_decimals() {
    for (nanos, text) in [
        (0, "0.000000000"),
        (1, "0.000000001"),
        (-1, "-0.000000001"),
        (1_700_000_000_123_456_789, "1700000000.123456789"),
        (-1_500_000_000, "-1.500000000"),
        (i64::MIN, "-9223372036.854775808"),
    ] {
        assert_eq!(Time::from_nanos(nanos).to_string(), text);
        assert_eq!(Interval::from_nanos(nanos).to_string(), text);
    }
}

proptest! {
    /// 2⁵⁰ ns are 13 days: below that the two roundings of `n / 1e9 · 1e9` stay under half a nanosecond.
    #[test]
    fn a_stamp_of_a_recorded_set_survives_seconds(nanos in -(1_i64 << 50)..(1_i64 << 50)) {
        let time = Time::from_nanos(nanos);
        prop_assert_eq!(Time::from_seconds(time.seconds()), Some(time));
    }

    #[test]
    fn a_span_added_back_gives_the_later_time(a in -(1_i64 << 61)..(1_i64 << 61), b in -(1_i64 << 61)..(1_i64 << 61)) {
        let (a, b) = (Time::from_nanos(a), Time::from_nanos(b));
        prop_assert_eq!(a + (b - a), b);
        prop_assert_eq!(b - (b - a), a);
        prop_assert_eq!(b.since(a), b - a);
    }

    #[test]
    fn the_printed_stamp_reads_back_exactly(nanos in any::<i64>()) {
        let text = Time::from_nanos(nanos).to_string().replace('.', "");
        prop_assert_eq!(text.parse::<i64>(), Ok(nanos));
    }
}
