//! A mine's worth of walkers at once: 1,000 of them, each with an IMU at 100 Hz and four UWB ranges ten times a second, as a server meets them: in order of
//! time, one observation of each after the other, so that no walker's state is still in the cache when its next one comes. One core.
//!
//! Then one walker with everything: IMU, magnetometer, barometer, signal strengths, ranges, portals.
//!
//! No criterion: what is timed are the seconds after a warm-up of every walker, and beside the time the memory of a walker is told: the growth
//! of the process's resident set (Linux) over all walkers, by their number. Sixteen logs are shared by all, so what is read is warmer than at a
//! server, what is written is not.
//!
//!     cargo bench -p adit-estimation --bench many_walkers [-- METHOD …]

#![expect(clippy::expect_used, reason = "a benchmark that cannot run should stop")]

use adit_core::nalgebra::Vector3;
use adit_estimation::methods::foot_ins::FootInsParams;
use adit_estimation::methods::fused::FusedParams;
use adit_estimation::methods::pdr::PdrParams;
use adit_estimation::methods::uwb_filter::UwbRkfParams;
use adit_estimation::methods::uwb_pdr::UwbPdrParams;
use adit_estimation::methods::{Known, Method, MethodReport, MethodSettings, Worn};
use adit_estimation::radio::RadioSite;
use adit_mine::Mine;
use adit_observation::{DeviceId, Observation, Radio, RangeSample};
use adit_simulation::people::{Belt, PersonSpec, Place, Roam};
use adit_simulation::pressure::BarometerModel;
use adit_simulation::radio::RangeDetail;
use adit_simulation::workforce::{Mount, Outfit, RadioRates, Workforce, WorkforceSpec};
use adit_simulation::{Emission, Foot, ImuErrorModel, MagneticWorld, MagnetometerModel};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

const WALKERS: usize = 1000;
/// Different logs; walkers share them.
const LOGS: usize = 16;
const WARM_S: f64 = 40.0;
const MEASURED_S: f64 = 5.0;
/// One walker with everything is timed over this much more.
const ALONE_S: f64 = 600.0;
const IMU_HZ: f64 = 100.0;
const RANGING_EVERY: u32 = 10;
const ANCHORS: usize = 4;
const RANGE_SIGMA_M: f64 = 0.1;

/// First argument of the process of one row.
const ROW: &str = "row";
/// Walkers that tell how much memory one takes, and memory for all of them, KiB.
const FEW: usize = 20;
const MOST_KIB: u64 = 1 << 20;

/// Name, and where the tag is worn.
const METHODS: [(&str, &[&str]); 5] = [
    (FusedParams::NAME, &["waist", "foot"]),
    (UwbRkfParams::NAME, &["waist", "foot"]),
    (UwbPdrParams::NAME, &["waist"]),
    (PdrParams::NAME, &["waist"]),
    (FootInsParams::NAME, &["foot"]),
];

/// What is observed, in order of time.
type Log = Vec<Observation>;
/// A method at work, and which observation is its next.
type Walker<R> = (Box<dyn Method<Report = R>>, usize);

fn main() {
    // Cargo passes `--bench`.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    if let [row, method, place] = words.as_slice()
        && row == ROW
    {
        return of_method(method, place);
    }
    // A process for each row: memory that one method gave back would hide what the next one takes.
    let program = std::env::current_exe().expect("this program");
    println!(
        "{WALKERS} walkers, IMU {IMU_HZ} Hz, {ANCHORS} ranges at {} Hz; and one with everything",
        IMU_HZ / f64::from(RANGING_EVERY)
    );
    for (method, places) in METHODS {
        for place in places.iter().filter(|_| words.is_empty() || words.iter().any(|word| word == method)) {
            let run = Command::new(&program).args([ROW, method, place]).status();
            assert!(run.is_ok_and(|status| status.success()), "{method} on the {place} failed");
        }
    }
}

/// One row of the table.
fn of_method(method: &str, place: &str) {
    match method {
        FusedParams::NAME => row::<FusedParams>(place),
        PdrParams::NAME => row::<PdrParams>(place),
        UwbPdrParams::NAME => row::<UwbPdrParams>(place),
        UwbRkfParams::NAME => row::<UwbRkfParams>(place),
        FootInsParams::NAME => row::<FootInsParams>(place),
        other => assert!(METHODS.iter().any(|(name, _)| *name == other), "no such row: {other}"),
    }
}

fn row<S: MethodSettings>(place: &str) {
    let mine = two_level();
    let site = Arc::new(RadioSite::of_mine(&mine));
    let (mount, worn) = match place {
        "foot" => (Mount::RightFoot(Foot::instep()), Worn::Foot),
        _ => (Mount::Belt(Belt::front()), Worn::Body),
    };
    let logs: Vec<Log> = (0..LOGS as u64).map(|seed| imu_and_ranges(&mine, mount, 1 + seed)).collect();
    let crowd = Crowd { logs: &logs, site: &site, worn };
    print!("  {:<8} {place:<5}  ", S::NAME);
    crowd.time::<S>();
    drop(logs);
    let logs = [everything(&mine, mount, 1)];
    Crowd { logs: &logs, site: &site, worn }.time_alone::<S>();
}

struct Crowd<'a> {
    logs: &'a [Log],
    site: &'a Arc<RadioSite>,
    worn: Worn,
}

impl Crowd<'_> {
    fn settings<S: MethodSettings>(&self) -> S {
        let specification = Some(ImuErrorModel::mpu6050().specification());
        let known = Known { specification, worn: Some(self.worn), ..Known::default() };
        S::default().knowing(&known).at_site(self.site)
    }

    /// All walkers, interleaved; fewer, and the speed in proportion, where they would not fit into memory.
    fn time<S: MethodSettings>(&self) {
        let settings = self.settings::<S>();
        let start = || (settings.clone().start().expect("the defaults are usable"), 0_usize);
        let before_kib = resident_kib();
        let mut walkers: Vec<_> = (0..FEW).map(|_| start()).collect();
        self.advance::<S>(&mut walkers, 0.0, WARM_S);
        let each_kib = (resident_kib().saturating_sub(before_kib) / FEW as u64).max(1);
        let room = usize::try_from(MOST_KIB / each_kib).unwrap_or(WALKERS);
        let count = room.clamp(FEW, WALKERS);
        let mut more: Vec<_> = (FEW..count).map(|_| start()).collect();
        self.advance::<S>(&mut more, 0.0, WARM_S);
        walkers.append(&mut more);
        let clock = Instant::now();
        let fed = self.advance::<S>(&mut walkers, WARM_S, WARM_S + MEASURED_S);
        let took_s = clock.elapsed().as_secs_f64();
        let kib = resident_kib().saturating_sub(before_kib);
        print!(
            "{:6.1} × real time  {:6.0} ns an observation  {:7.1} KiB a walker",
            MEASURED_S / took_s * count as f64 / WALKERS as f64,
            1e9 * took_s / fed as f64,
            kib as f64 / count as f64,
        );
        if count < WALKERS {
            print!(" (of {count} walkers)");
        }
    }

    /// Everybody from one time to another; how many observations that took.
    fn advance<S: MethodSettings>(
        &self,
        walkers: &mut [Walker<S::Report>],
        from_s: f64,
        until_s: f64,
    ) -> u64 {
        let mut fed = 0;
        let mut now_s = from_s;
        while now_s < until_s {
            now_s += 1.0 / IMU_HZ;
            for (index, (method, next)) in walkers.iter_mut().enumerate() {
                let log = &self.logs[index % self.logs.len()];
                while let Some(observation) = log.get(*next).filter(|o| o.time().seconds() < now_s) {
                    feed(method.as_mut(), observation);
                    *next += 1;
                    fed += 1;
                }
            }
        }
        fed
    }

    /// One walker, the whole log after the warm-up.
    fn time_alone<S: MethodSettings>(&self) {
        let mut method = self.settings::<S>().start().expect("the defaults are usable");
        let log = &self.logs[0];
        let warm = log.iter().take_while(|o| o.time().seconds() < WARM_S).count();
        for observation in &log[..warm] {
            feed(method.as_mut(), observation);
        }
        let clock = Instant::now();
        for observation in &log[warm..] {
            feed(method.as_mut(), observation);
        }
        let per_s = (log.len() - warm) as f64 / clock.elapsed().as_secs_f64();
        println!("; alone {per_s:8.0} observations a second");
    }
}

fn feed<R: MethodReport>(method: &mut dyn Method<Report = R>, observation: &Observation) {
    let mut solution = method.observe(observation).expect("the log can be tracked");
    while let Some(now) = solution {
        black_box(now);
        solution = method.next_due().expect("the log can be tracked");
    }
}

/// What of the process is in memory; 0 where the system does not tell.
fn resident_kib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|rest| rest.trim().trim_end_matches("kB").trim().parse().ok()).unwrap_or(0)
}

fn two_level() -> Arc<Mine> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    Arc::new(adit_mine::file::open(Path::new(file)).expect("the mine that ships").0)
}

/// Somebody who walks about on one level.
fn workforce(mine: &Arc<Mine>, outfit: Outfit, duration_s: f64, seed: u64) -> Arc<Workforce> {
    let roam = Roam::on_level("l300", duration_s, 300.0, 0.3, [5.0, 10.0]);
    let start =
        Place::Roadway { id: "l300-haulage".to_owned(), along_m: 300.0 + 20.0 * seed as f64, left_m: 0.0 };
    let person = PersonSpec::roaming(start, 5.0, roam);
    let spec = WorkforceSpec::undisturbed(duration_s, vec![person], outfit);
    Workforce::new(Arc::clone(mine), spec, seed).expect("a workforce")
}

fn outfit(mount: Mount) -> Outfit {
    let radio = RadioRates { scan_hz: 0.0, ranging_hz: 0.0, portal_hz: 0.0, detail: RangeDetail::Range };
    Outfit { imu_hz: IMU_HZ, radio, ..Outfit::plain(mount, 0.0) }
}

/// IMU and, at every tenth sample, ranges to the nearest anchors.
fn imu_and_ranges(mine: &Arc<Mine>, mount: Mount, seed: u64) -> Log {
    let workforce = workforce(mine, outfit(mount), WARM_S + MEASURED_S, seed);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let site = RadioSite::of_plan(mine.plan());
    let mut log = Log::new();
    let stream = workforce.stream(0).expect("a person").expect("a log");
    for (number, emission) in (0_u32..).zip(stream) {
        let place = if let Emission::Imu(_, truth) = &emission { Some(truth.position_m) } else { None };
        let observation = emission.observation();
        let time = observation.time();
        log.push(observation);
        let Some(place) = place.filter(|_| number.is_multiple_of(RANGING_EVERY)) else { continue };
        for (anchor, distance_m) in nearest(&site, &place) {
            let noise: f64 = StandardNormal.sample(&mut rng);
            log.push(Observation::Range(RangeSample {
                time,
                anchor,
                tag: None,
                range_m: distance_m + RANGE_SIGMA_M * noise,
                sigma_m: Some(RANGE_SIGMA_M),
                line_of_sight: None,
                in_the_way: None,
                radio: Radio::Uwb,
                reception: None,
            }));
        }
    }
    log
}

/// The nearest anchors, with what a range to them reads without noise, m.
fn nearest(site: &RadioSite, place: &Vector3<f64>) -> Vec<(DeviceId, f64)> {
    let mut anchors: Vec<_> = site
        .anchors
        .iter()
        .map(|anchor| {
            let distance_m = (anchor.position_m - place).norm();
            (anchor, distance_m, distance_m + anchor.range_offset_m)
        })
        .collect();
    anchors.sort_by(|a, b| a.1.total_cmp(&b.1));
    let id = |id: &str| DeviceId::new(id).expect("the name of an anchor");
    anchors.into_iter().take(ANCHORS).map(|(anchor, _, reads_m)| (id(&anchor.id), reads_m)).collect()
}

/// Every sensor there is.
fn everything(mine: &Arc<Mine>, mount: Mount, seed: u64) -> Log {
    let radio = RadioRates { detail: RangeDetail::Range, ..RadioRates::default() };
    let world = MagneticWorld::default();
    let outfit = Outfit {
        magnetic: Some((world, MagnetometerModel::ak8963())),
        barometer: Some(BarometerModel::bmp388()),
        radio,
        ..outfit(mount)
    };
    let workforce = workforce(mine, outfit, WARM_S + ALONE_S, seed);
    let stream = workforce.stream(0).expect("a person").expect("a log");
    stream.map(|emission| emission.observation()).collect()
}
