//! Numbers as text, without loss: times to the nanosecond, values to the last bit.
//!
//! A Unix stamp with nine decimals has 19 digits and an `f64` holds 15 to 17, so times never pass through one.

use adit_core::time::Time;
use std::fmt;

/// Why a field is not a finite number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NotANumber;

/// Decimal text to nanoseconds, exactly; `nanos_exponent` is 9 for seconds, 6 for ms, 3 for µs, 0 for ns.
///
/// Accepts a sign, a point and an exponent (`1.5e9`). Digits below the nanosecond are rounded to nearest, halves away
/// from zero. `None` when the text is not a decimal number or the time lies past ±292 years.
///
/// ```
/// use adit_observation::files::decimal::parse_time;
/// let stamp = parse_time(b"1511374923.123456789", 9).map(|t| t.nanos());
/// assert_eq!(stamp, Some(1_511_374_923_123_456_789));
/// ```
pub fn parse_time(text: &[u8], nanos_exponent: i32) -> Option<Time> {
    let (negative, digits) = match text.split_first()? {
        (b'-', rest) => (true, rest),
        (b'+', rest) => (false, rest),
        _ => (false, text),
    };
    let mut mantissa: u64 = 0;
    // Power of ten of the mantissa's last digit.
    let mut exponent = nanos_exponent;
    let mut any_digit = false;
    let mut after_point = false;
    let mut rest = digits;
    while let Some((&byte, tail)) = rest.split_first() {
        match byte {
            b'0'..=b'9' => {
                any_digit = true;
                let digit = u64::from(byte - b'0');
                match mantissa.checked_mul(10).and_then(|m| m.checked_add(digit)) {
                    Some(next) => {
                        mantissa = next;
                        exponent -= i32::from(after_point);
                    }
                    // The mantissa is full, 19 digits at least: a digit after the point is below the nanosecond unless
                    // an exponent lifts it, and then the whole is out of range or needs the slow way.
                    None => return parse_long_time(text, nanos_exponent),
                }
            }
            b'.' if !after_point => after_point = true,
            b'e' | b'E' if any_digit => {
                exponent = exponent.checked_add(parse_exponent(tail)?)?;
                break;
            }
            _ => return None,
        }
        rest = tail;
    }
    if !any_digit {
        return None;
    }
    scale(u128::from(mantissa), exponent, negative)
}

/// The same for mantissas of more than 19 digits: 38 digits are kept, the rest cannot change the nanosecond.
fn parse_long_time(text: &[u8], nanos_exponent: i32) -> Option<Time> {
    const KEPT: u128 = 10_u128.pow(37);
    let negative = text.first() == Some(&b'-');
    let mut mantissa: u128 = 0;
    let mut exponent = nanos_exponent;
    let mut after_point = false;
    let mut rest = text;
    if matches!(text.first(), Some(b'-' | b'+')) {
        rest = &text[1..];
    }
    while let Some((&byte, tail)) = rest.split_first() {
        match byte {
            b'0'..=b'9' if mantissa < KEPT => {
                mantissa = mantissa * 10 + u128::from(byte - b'0');
                exponent -= i32::from(after_point);
            }
            b'0'..=b'9' => exponent = exponent.checked_add(i32::from(!after_point))?,
            b'.' if !after_point => after_point = true,
            b'e' | b'E' => {
                exponent = exponent.checked_add(parse_exponent(tail)?)?;
                break;
            }
            _ => return None,
        }
        rest = tail;
    }
    scale(mantissa, exponent, negative)
}

fn parse_exponent(text: &[u8]) -> Option<i32> {
    // Past ±9999 every number is zero or out of range; the limit keeps the sums in range.
    let exponent: i32 = std::str::from_utf8(text).ok()?.parse().ok()?;
    (-9999..=9999).contains(&exponent).then_some(exponent)
}

fn scale(mantissa: u128, exponent: i32, negative: bool) -> Option<Time> {
    let magnitude = if mantissa == 0 {
        0
    } else if exponent >= 0 {
        10_u128.checked_pow(exponent.unsigned_abs()).and_then(|p| mantissa.checked_mul(p))?
    } else {
        match (u64::try_from(mantissa), 10_u64.checked_pow(exponent.unsigned_abs())) {
            (Ok(short), Some(divisor)) => {
                u128::from(short / divisor + u64::from(short % divisor >= divisor.div_ceil(2)))
            }
            _ => match 10_u128.checked_pow(exponent.unsigned_abs()) {
                Some(divisor) => mantissa / divisor + u128::from(mantissa % divisor >= divisor / 2),
                None => 0,
            },
        }
    };
    let signed = i128::try_from(magnitude).ok()?;
    i64::try_from(if negative { -signed } else { signed }).ok().map(Time::from_nanos)
}

/// Text to a finite `f64`, correctly rounded.
#[inline]
pub(crate) fn parse_number(text: &[u8]) -> Result<f64, NotANumber> {
    let text = std::str::from_utf8(text).map_err(|_| NotANumber)?;
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(NotANumber),
    }
}

/// A time as the shortest decimal number of seconds that means the same nanosecond: `0`, `0.0035`, `12.5`.
#[derive(Debug, Clone, Copy)]
pub struct ShortSeconds(pub Time);

impl fmt::Display for ShortSeconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let nanos = self.0.nanos();
        let magnitude = nanos.unsigned_abs();
        let (seconds, mut fraction) = (magnitude / 1_000_000_000, magnitude % 1_000_000_000);
        let sign = if nanos < 0 { "-" } else { "" };
        if fraction == 0 {
            return write!(f, "{sign}{seconds}");
        }
        let mut width = 9;
        while fraction % 10 == 0 {
            fraction /= 10;
            width -= 1;
        }
        write!(f, "{sign}{seconds}.{fraction:0width$}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(text: &str) -> Option<i64> {
        parse_time(text.as_bytes(), 9).map(Time::nanos)
    }

    #[test]
    fn unix_stamps_survive_to_the_nanosecond() {
        assert_eq!(seconds("1511374923.123456789"), Some(1_511_374_923_123_456_789));
        assert_eq!(seconds("1.511374923123456789e9"), Some(1_511_374_923_123_456_789));
        assert_eq!(seconds("1511374923123456789E-9"), Some(1_511_374_923_123_456_789));
        assert_eq!(parse_time(b"1511374923123456789", 0).map(Time::nanos), Some(1_511_374_923_123_456_789));
        assert_eq!(parse_time(b"1511374923123.456789", 6).map(Time::nanos), Some(1_511_374_923_123_456_789));
        assert_eq!(parse_time(b"1511374923123456.789", 3).map(Time::nanos), Some(1_511_374_923_123_456_789));
    }

    #[test]
    fn digits_below_the_nanosecond_round_to_nearest() {
        assert_eq!(seconds("1.4500000000000002"), Some(1_450_000_000));
        assert_eq!(seconds("0.0000000004999999999999999999999999999999999999999"), Some(0));
        assert_eq!(seconds("0.0000000005"), Some(1));
        assert_eq!(seconds("-0.0000000005"), Some(-1));
        assert_eq!(seconds("1511374923.1234567894999999999999"), Some(1_511_374_923_123_456_789));
        assert_eq!(seconds("1511374923.1234567895"), Some(1_511_374_923_123_456_790));
    }

    #[test]
    fn plain_forms_are_read() {
        assert_eq!(seconds("0"), Some(0));
        assert_eq!(seconds("-0.5"), Some(-500_000_000));
        assert_eq!(seconds("+5."), Some(5_000_000_000));
        assert_eq!(seconds(".5"), Some(500_000_000));
        assert_eq!(seconds("5e-3"), Some(5_000_000));
        assert_eq!(seconds("0e9999"), Some(0));
        assert_eq!(seconds("1e-9999"), Some(0));
        assert_eq!(seconds("00000000000000000000000000000000000000000000001"), Some(1_000_000_000));
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for text in
            ["", "-", ".", "e5", "1e", "1e+", "nan", "inf", "1..2", "1.2.3", "0x10", "1 2", "--1", "1e99999"]
        {
            assert_eq!(seconds(text), None, "{text}");
        }
        // i64 nanoseconds end at 9223372036.854775807 s.
        assert_eq!(seconds("9223372036.854775807"), Some(i64::MAX));
        assert_eq!(seconds("9223372036.854775808"), None);
        assert_eq!(seconds("-9223372036.854775808"), Some(i64::MIN));
        assert_eq!(seconds("1e30"), None);
        assert_eq!(seconds("99999999999999999999999999999999999999999999999999"), None);
    }

    #[test]
    fn written_times_read_back_the_same() {
        for nanos in
            [0, 1, -1, 5_000_000, 3_500_000, 1_511_374_923_123_456_789, i64::MAX, i64::MIN, -500_000_000]
        {
            let time = Time::from_nanos(nanos);
            assert_eq!(seconds(&ShortSeconds(time).to_string()), Some(nanos));
            assert_eq!(seconds(&time.to_string()), Some(nanos));
        }
        assert_eq!(ShortSeconds(Time::from_nanos(3_500_000)).to_string(), "0.0035");
    }
}
