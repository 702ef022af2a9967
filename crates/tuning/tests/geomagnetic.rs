//! The World Magnetic Model against the values published with it.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::time::Time;
use adit_tuning::geomagnetic::{Day, Site, field};

const EPOCH: Day = Day { year: 2025, month: 1, day: 1 };
/// 2027.5 is noon of 2 July.
const MIDDLE: Day = Day { year: 2027, month: 7, day: 2 };

/// WMM2025 technical report, table 6: day, height (km), latitude, longitude (deg), total field (nT), inclination, declination (deg).
const PUBLISHED: [(Day, f64, f64, f64, f64, f64, f64); 12] = [
    (EPOCH, 0.0, 80.0, 0.0, 55178.5, 83.21, 1.28),
    (EPOCH, 0.0, 0.0, 120.0, 41064.3, -14.93, -0.16),
    (EPOCH, 0.0, -80.0, 240.0, 54698.2, -72.00, 68.78),
    (EPOCH, 100.0, 80.0, 0.0, 52964.9, 83.26, 0.85),
    (EPOCH, 100.0, 0.0, 120.0, 39032.1, -15.08, -0.15),
    (EPOCH, 100.0, -80.0, 240.0, 52035.0, -72.19, 68.21),
    (MIDDLE, 0.0, 80.0, 0.0, 55253.9, 83.24, 2.59),
    (MIDDLE, 0.0, 0.0, 120.0, 41036.9, -14.65, -0.24),
    (MIDDLE, 0.0, -80.0, 240.0, 54474.2, -71.92, 68.49),
    (MIDDLE, 100.0, 80.0, 0.0, 53034.3, 83.29, 2.16),
    (MIDDLE, 100.0, 0.0, 120.0, 39007.4, -14.81, -0.23),
    (MIDDLE, 100.0, -80.0, 240.0, 51825.7, -72.10, 67.93),
];

#[test]
fn the_published_values_come_out() {
    for (day, height_km, latitude_deg, longitude_deg, norm_nt, dip, declination) in PUBLISHED {
        let site = Site { latitude_deg, longitude_deg, height_m: 1000.0 * height_km };
        let found = field(&site, &day).unwrap();
        // Printed to 0.1 nT and 0.01°; half a day of change is 0.12 nT at most, single precision 0.01 nT.
        assert!((1000.0 * found.norm_ut - norm_nt).abs() < 0.05 + 0.12 + 0.03, "{site:?} {found:?}");
        assert!((found.dip_deg - dip).abs() < 0.0051, "{site:?} {found:?}");
        assert!((found.declination_deg - declination).abs() < 0.0057, "{site:?} {found:?}");
    }
}

#[test]
fn a_deep_mine_has_an_answer() {
    let at = |height_m| field(&Site { latitude_deg: -26.4, longitude_deg: 27.4, height_m }, &EPOCH).unwrap();
    let (deep, lowest) = (at(-2300.0), at(-1000.0));
    assert_eq!(deep, lowest);
    // The next kilometre down would add what the last one did: 0.05 %.
    assert!((at(0.0).norm_ut / lowest.norm_ut - 1.0).abs() < 7e-4);
}

#[test]
fn days_and_places_that_do_not_exist_are_refused() {
    let here = Site { latitude_deg: 50.0, longitude_deg: 13.0, height_m: 0.0 };
    let day = |year, month, day| field(&here, &Day { year, month, day }).map_err(|e| e.to_string());
    assert!(day(2026, 2, 30).unwrap_err().contains("day"), "{:?}", day(2026, 2, 30));
    assert!(day(2026, 13, 1).unwrap_err().contains("month"), "{:?}", day(2026, 13, 1));
    assert!(day(2031, 1, 1).unwrap_err().contains("no magnetic model"), "{:?}", day(2031, 1, 1));
    assert!(day(2019, 12, 31).is_err());
    let nowhere = Site { latitude_deg: f64::NAN, ..here };
    assert!(field(&nowhere, &EPOCH).is_err());
}

#[test]
fn the_day_of_a_log_is_told_from_unix_time_only() {
    // 2026-11-22 12:00 UTC.
    let noon = Time::from_nanos(1_795_348_800_000_000_000);
    assert_eq!(Day::of_unix(noon), Some(Day { year: 2026, month: 11, day: 22 }));
    assert_eq!(Day::of_unix(Time::from_nanos(12_000_000_000)), None);
    assert_eq!(Day::of_unix(Time::from_nanos(i64::MAX)), None);
}
