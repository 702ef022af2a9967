//! Signals of a log become scans, and scans positions.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::frames::Position;
use adit_core::nalgebra::Vector2;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_estimation::methods::wifi::WifiParams;
use adit_estimation::methods::{MethodError, MethodReport, MethodSettings};
use adit_estimation::radio::locator::{LocatorMethod, LocatorParams};
use adit_estimation::radio::path_loss::mean_dbm;
use adit_estimation::radio::scan::ScanParams;
use adit_estimation::radio::{PathLoss, RadioSite};
use adit_mine::plan::{AccessPoint, Grid, MinePlan, Radio as SiteRadio, Roadway, RoadwayKind};
use adit_observation::{DeviceId, Observation, Radio, SignalStrength};
use std::sync::Arc;

const PLACES: [(f64, f64); 5] = [(0.0, 0.0), (40.0, 0.0), (0.0, 30.0), (40.0, 30.0), (20.0, 12.0)];
const LOSS: PathLoss =
    PathLoss { rssi_at_1m_dbm: -40.0, exponent: 2.3, breakpoint_m: None, exponent_beyond: None };
/// Of the tag, and of the antennas, m.
const HEIGHTS_M: (f64, f64) = (1.0, 2.5);

fn plan() -> MinePlan {
    let mut plan = MinePlan::new("hall", Grid::Local {});
    plan.access_points = PLACES
        .iter()
        .zip(0..)
        .map(|((x, y), k)| AccessPoint {
            id: format!("ap{k}"),
            radio: SiteRadio::Wifi,
            mac: Some(format!("02:AD:17:00:00:0{k}")),
            position_m: Position::new(*x, *y, HEIGHTS_M.1),
            tx_power_dbm: None,
            path_loss: Some(LOSS),
        })
        .collect();
    for (k, north) in (0_u32..).zip([0.0, 7.5, 15.0, 22.5, 30.0]) {
        plan.roadways.push(Roadway {
            id: format!("r{k}"),
            name: None,
            level: None,
            kind: RoadwayKind::Drift,
            width_m: 8.0,
            height_m: 3.0,
            max_slope_percent: None,
            walkable: true,
            points_m: vec![Position::new(0.0, north, 0.0), Position::new(40.0, north, 0.0)],
        });
    }
    plan
}

fn time(seconds: f64) -> Time {
    Time::from_seconds(seconds).unwrap()
}

fn signal(seconds: f64, name: &str, rssi_dbm: f64) -> Observation {
    let transmitter = DeviceId::new(name).unwrap();
    Observation::Signal(SignalStrength { time: time(seconds), transmitter, rssi_dbm, radio: Radio::Wifi })
}

/// What is heard at a place without any error.
fn heard(seconds: f64, place_m: Vector2<f64>, name: impl Fn(usize) -> String) -> Vec<Observation> {
    let one = |(k, (x, y)): (usize, &(f64, f64))| {
        let level = (place_m - Vector2::new(*x, *y)).norm();
        let rssi_dbm = mean_dbm(&LOSS, level.hypot(HEIGHTS_M.1 - HEIGHTS_M.0));
        signal(seconds + 0.01 * f64::from(u32::try_from(k).unwrap()), &name(k), rssi_dbm)
    };
    PLACES.iter().enumerate().map(one).collect()
}

fn params(method: LocatorMethod) -> WifiParams {
    // Readings of 1 dB: where people may be counts for little.
    let locator = LocatorParams { method, sigma_db: 1.0, offset_sigma_db: 1.0, ..LocatorParams::default() };
    WifiParams { locator, ..WifiParams::default() }.at_site(&Arc::new(RadioSite::of_plan(&plan())))
}

fn run(
    settings: WifiParams,
    log: &[Observation],
) -> Result<(Vec<Solution>, <WifiParams as MethodSettings>::Report), MethodError> {
    let mut method = settings.start()?;
    let mut solutions = Vec::new();
    for observation in log {
        let mut solution = method.observe(observation)?;
        while let Some(now) = solution {
            solutions.push(now);
            solution = method.next_due()?;
        }
    }
    while let Some(last) = method.finish_next()? {
        solutions.push(last);
    }
    Ok((solutions, method.report().clone()))
}

#[test]
fn what_is_heard_without_error_is_found_by_every_method_that_can() {
    let place = Vector2::new(16.0, 9.0);
    let log: Vec<_> = (0..3).flat_map(|k| heard(f64::from(k), place, |k| format!("ap{k}"))).collect();
    // The circles of trilateration and of the inner points meet in the place; the fit is drawn to the middle of the area by its share of the
    // information, the map by half a step of 1 m. A centroid is the mean of what is around.
    for (method, within_m) in [
        (LocatorMethod::Trilateration, 0.01),
        (LocatorMethod::InnerPointsImproved, 0.01),
        (LocatorMethod::Fit, 0.1),
        (LocatorMethod::Map, 0.5),
        (LocatorMethod::Auto, 0.5),
        (LocatorMethod::WeightedCentroid, 6.0),
    ] {
        let (solutions, report) = run(params(method), &log).unwrap();
        assert_eq!((solutions.len(), report.heard.fixes, report.heard.signals), (1, 1, 15), "{method:?}");
        let off = (solutions[0].position_m.xy() - place).norm();
        assert!(off < within_m, "{method:?}: {off}");
        assert!(solutions[0].radius_95_m() > off, "{method:?}");
    }
}

#[test]
fn three_scans_are_averaged_and_their_time_is_the_mean() {
    let names = |k: usize| format!("ap{k}");
    let (here, there) = (Vector2::new(10.0, 5.0), Vector2::new(11.0, 5.0));
    let mut log = Vec::new();
    for (k, place) in [here, here, here, there, there, there, there].into_iter().enumerate() {
        log.extend(heard(f64::from(u32::try_from(k).unwrap()), place, names));
    }
    let (solutions, report) = run(params(LocatorMethod::Trilateration), &log).unwrap();
    // Scans 0 to 2, 3 to 5, and what is left at the end; the five readings of each are 0.02 s later in the mean.
    let times: Vec<f64> = solutions.iter().map(|s| s.time.seconds()).collect();
    assert_eq!(report.heard.scans, 3);
    for (found, expected) in times.iter().zip([1.02, 4.02, 6.02]) {
        assert!((found - expected).abs() < 1e-9, "{times:?}");
    }
    // What the mean strength is, exactly: a scan 6 dB weaker and one 6 dB stronger are the scan itself.
    let shifted = |observation: &Observation, by: f64, later: f64| match observation {
        Observation::Signal(signal) => {
            let (time, rssi_dbm) = (time(signal.time.seconds() + later), signal.rssi_dbm + by);
            Observation::Signal(SignalStrength { time, rssi_dbm, ..signal.clone() })
        }
        other => other.clone(),
    };
    let scan = heard(0.0, here, names);
    let levels = [(-6.0, 0.0), (6.0, 1.0), (0.0, 2.0)];
    let log: Vec<_> =
        levels.iter().flat_map(|(by, later)| scan.iter().map(|one| shifted(one, *by, *later))).collect();
    let (solutions, _) = run(params(LocatorMethod::Trilateration), &log).unwrap();
    assert!((solutions[0].position_m.xy() - here).norm() < 1e-6, "{solutions:?}");
}

#[test]
fn a_report_every_five_seconds_is_of_the_last_three_scans() {
    let names = |k: usize| format!("ap{k}");
    let log: Vec<_> = (0..21).flat_map(|k| heard(f64::from(k), Vector2::new(10.0, 5.0), names)).collect();
    let scan = ScanParams { every_s: 5.0, ..ScanParams::default() };
    let (solutions, report) = run(WifiParams { scan, ..params(LocatorMethod::Fit) }, &log).unwrap();
    let times: Vec<f64> = solutions.iter().map(|s| (s.time.seconds() - 0.02).round()).collect();
    // Scans 0 to 2, 5 to 7, 10 to 12, 15 to 17, and at the end 18 to 20.
    assert_eq!(times, [1.0, 6.0, 11.0, 16.0, 19.0]);
    assert_eq!(report.heard.late_signals, 0);
}

#[test]
fn what_comes_out_of_order_is_put_right_and_what_comes_too_late_is_counted() {
    let names = |k: usize| format!("ap{k}");
    let place = Vector2::new(10.0, 5.0);
    let log: Vec<_> = (0..6).flat_map(|k| heard(f64::from(k), place, names)).collect();
    let (plain, _) = run(params(LocatorMethod::Fit), &log).unwrap();
    let mut shuffled = log.clone();
    // Within a scan, and the last of a scan after the first of the next.
    shuffled.swap(0, 4);
    shuffled.swap(9, 10);
    shuffled.swap(16, 18);
    let (solutions, report) = run(params(LocatorMethod::Fit), &shuffled).unwrap();
    assert_eq!(report.heard.late_signals, 0);
    for (one, other) in plain.iter().zip(&solutions) {
        assert_eq!(one.time, other.time);
        assert!((one.position_m - other.position_m).norm() < 1e-9);
    }
    // The first scan comes again when it has been reported.
    let mut late = log;
    late.extend(heard(0.3, place, names));
    let (_, report) = run(params(LocatorMethod::Fit), &late).unwrap();
    assert_eq!(report.heard.late_signals, 5);
}

#[test]
fn addresses_in_any_form_are_known_and_strangers_are_told() {
    let place = Vector2::new(16.0, 9.0);
    for name in [|k| format!("02:ad:17:00:00:0{k}"), |k| format!("02AD1700000{k}"), |k| format!("ap{k}")] {
        let mut log = heard(0.0, place, name);
        log.push(signal(0.2, "phone of somebody", -30.0));
        let (solutions, report) = run(params(LocatorMethod::Fit), &log).unwrap();
        assert!((solutions[0].position_m.xy() - place).norm() < 0.5);
        assert_eq!((report.heard.signals, report.heard.unknown_signals), (6, 1));
        let told = report.warnings()[0].text();
        assert!(told.contains("1 unknown transmitter") && told.contains("phone of somebody"), "{told}");
    }
    let strangers: Vec<_> = (0..9).map(|k| signal(f64::from(k), "phone of somebody", -30.0)).collect();
    let error = run(params(LocatorMethod::Fit), &strangers).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no position: of 9 signal strengths in the log, 9 are of transmitters that are not known (phone of somebody)"
    );
}

#[test]
fn a_method_says_what_it_needs_to_know() {
    let nothing = WifiParams::default().start().err().unwrap();
    assert!(nothing.to_string().contains("wifi needs the radio of the site"), "{nothing}");
    let nearest = params(LocatorMethod::Nearest).start().err().unwrap();
    assert!(nearest.to_string().contains("fingerprints"), "{nearest}");
    let empty = WifiParams::default().at_site(&Arc::new(RadioSite::default())).start().err().unwrap();
    assert!(empty.to_string().contains("places of transmitters"), "{empty}");
    let scan = ScanParams { scan_s: f64::NAN, ..ScanParams::default() };
    let unusable = WifiParams { scan, ..params(LocatorMethod::Fit) }.start().err().unwrap();
    assert_eq!(unusable, MethodError::Setting { method: "wifi", name: "scan.scan_s" });
}

#[test]
fn memory_is_bounded_by_what_a_scan_holds() {
    let mut log = Vec::new();
    for k in 0..400 {
        log.push(signal(0.001 * f64::from(k), &format!("x{k}"), -60.0));
    }
    let mut plan = plan();
    plan.access_points = (0..400)
        .map(|k| AccessPoint { id: format!("x{k}"), mac: None, ..plan.access_points[0].clone() })
        .collect();
    let site = Arc::new(RadioSite::of_plan(&plan));
    let settings = params(LocatorMethod::WeightedCentroid).at_site(&site);
    let (solutions, report) = run(settings, &log).unwrap();
    assert_eq!((solutions.len(), report.heard.signals, report.heard.left_out_signals), (1, 400, 144));
}
