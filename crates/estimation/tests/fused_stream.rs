//! `fused` as a stream: what was kept in between, and what comes twice, changes nothing.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::solution::Solution;
use adit_estimation::methods::fused::{Fused, FusedParams};
use adit_estimation::methods::{Known, MethodSettings, Worn};
use adit_estimation::radio::RadioSite;
use adit_mine::Mine;
use adit_observation::Observation;
use adit_simulation::people::{Belt, Body, Errand, PersonSpec, Place, PopulationSpec, Roam};
use adit_simulation::pressure::{AirSpec, BarometerModel};
use adit_simulation::radio::delivery::{ClockSpec, LinkSpec};
use adit_simulation::radio::{RadioSpec, RangeDetail};
use adit_simulation::workforce::{Mount, Outfit, RadioRates, Workforce, WorkforceSpec};
use adit_simulation::{Foot, IdealImu, ImuErrorModel, MagneticWorld, MagnetometerModel};
use std::path::Path;
use std::sync::Arc;

const LENGTH_S: f64 = 90.0;
/// The tag is silent for so long, s: nothing wired comes.
const SILENT_S: (f64, f64) = (50.0, 62.0);

fn two_level() -> Arc<Mine> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    Arc::new(adit_mine::file::open(Path::new(file)).unwrap().0)
}

/// Somebody who walks about with every sensor; what comes by radio is late and overtakes itself.
fn log(mine: &Arc<Mine>, mount: Mount) -> Vec<Observation> {
    let roam = Roam {
        until_s: LENGTH_S,
        levels: vec!["l300".to_owned()],
        reach_m: 300.0,
        speed_share: [0.9, 1.1],
        stop_share: 0.3,
        stop_s: [5.0, 10.0],
        work_share: 0.5,
    };
    let start = Place::Roadway { id: "l300-haulage".to_owned(), along_m: 320.0, left_m: 0.0 };
    let errands = vec![Errand::Stand { seconds: 5.0 }, Errand::Roam(roam)];
    let person = PersonSpec { body: Body::default(), drawn: true, start, errands };
    let spec = WorkforceSpec {
        duration_s: LENGTH_S,
        population: PopulationSpec { persons: vec![person], ..PopulationSpec::default() },
        outfit: Outfit {
            mount,
            ideal: IdealImu::default(),
            imu: ImuErrorModel::mpu6050(),
            imu_hz: 100.0,
            magnetic: Some((MagneticWorld::default(), MagnetometerModel::ak8963())),
            barometer: Some(BarometerModel::bmp388()),
            silent_s: Vec::new(),
            radio: RadioRates { detail: RangeDetail::Range, ..RadioRates::default() },
        },
        air: AirSpec::default(),
        radio: RadioSpec::default(),
        outages: Vec::new(),
        conveyors_s: Vec::new(),
        clock: ClockSpec::perfect(),
        link: LinkSpec {
            least_delay_s: 0.01,
            extra_delay_s: 0.1,
            most_delay_s: 0.6,
            duplicated: 0.1,
            ..LinkSpec::perfect()
        },
    };
    let workforce = Workforce::new(Arc::clone(mine), spec, 7).unwrap();
    let stream = workforce.stream(0).unwrap().unwrap().map(|emission| emission.observation());
    let silent = |observation: &Observation| {
        let time_s = observation.time().seconds();
        observation.kind().is_wired() && time_s > SILENT_S.0 && time_s < SILENT_S.1
    };
    stream.filter(|observation| !silent(observation)).collect()
}

fn settings(mine: &Mine, worn: Worn) -> FusedParams {
    let known = Known {
        specification: Some(ImuErrorModel::mpu6050().specification()),
        worn: Some(worn),
        ..Known::default()
    };
    FusedParams::default().knowing(&known).at_site(&Arc::new(RadioSite::of_mine(mine)))
}

fn feed(method: &mut Fused, log: &[Observation], solutions: &mut Vec<Solution>) {
    for observation in log {
        let mut due = method.observe(observation).unwrap();
        while let Some(solution) = due {
            solutions.push(solution);
            due = method.next_due().unwrap();
        }
    }
}

fn end(mut method: Fused, mut solutions: Vec<Solution>) -> Vec<String> {
    while let Some(solution) = method.finish_next().unwrap() {
        solutions.push(solution);
    }
    // Numbers in JSON are the shortest that read back to the same bits.
    solutions.iter().map(|solution| serde_json::to_string(solution).unwrap()).collect()
}

fn whole(settings: &FusedParams, log: &[Observation]) -> Vec<String> {
    let (mut method, mut solutions) = (Fused::new(settings.clone()).unwrap(), Vec::new());
    feed(&mut method, log, &mut solutions);
    end(method, solutions)
}

/// Kept as JSON and read back this often.
fn split(settings: &FusedParams, log: &[Observation], parts: usize) -> Vec<String> {
    let (mut method, mut solutions) = (Fused::new(settings.clone()).unwrap(), Vec::new());
    for part in log.chunks(log.len() / parts) {
        feed(&mut method, part, &mut solutions);
        let kept = serde_json::to_string(&method).unwrap();
        method = serde_json::from_str(&kept).unwrap();
        method.attach(settings).unwrap();
    }
    end(method, solutions)
}

fn wearers() -> [(Mount, Worn); 2] {
    [(Mount::RightFoot(Foot::instep()), Worn::Foot), (Mount::Belt(Belt::front()), Worn::Body)]
}

#[test]
fn a_run_that_was_kept_in_between_is_the_whole_run() {
    let mine = two_level();
    for (mount, worn) in wearers() {
        let log = log(&mine, mount);
        let settings = settings(&mine, worn);
        let whole = whole(&settings, &log);
        assert!(whole.len() > 60, "{} solutions", whole.len());
        assert!(whole == split(&settings, &log, 13), "{worn:?}");
        // One kept within the half second that it looks at.
        let mut first = log.clone();
        first.truncate(30);
        assert!(self::whole(&settings, &first) == split(&settings, &first, 3), "{worn:?}");
    }
}

#[test]
fn what_comes_twice_counts_once() {
    let mine = two_level();
    for (mount, worn) in wearers() {
        let log = log(&mine, mount);
        let settings = settings(&mine, worn);
        let mut twice = Vec::new();
        for (index, observation) in log.iter().enumerate() {
            twice.push(observation.clone());
            // At once; and what came by radio once more when ten others have come.
            twice.push(observation.clone());
            let before = index.checked_sub(10).map(|index| &log[index]);
            twice.extend(before.filter(|before| !before.kind().is_wired()).cloned());
        }
        assert!(whole(&settings, &log) == whole(&settings, &twice), "{worn:?}");
        // The copies would tell otherwise: other ones of a range do.
        let moved = log.iter().cloned().map(|mut observation| {
            if let Observation::Range(range) = &mut observation {
                range.range_m += 1e-6;
            }
            observation
        });
        assert!(whole(&settings, &log) != whole(&settings, &moved.collect::<Vec<_>>()), "{worn:?}");
    }
}
