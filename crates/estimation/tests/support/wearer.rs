//! A walker with every sensor in the mine of two levels.

use adit_estimation::methods::fused::FusedParams;
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
pub const SILENT_S: (f64, f64) = (50.0, 62.0);

/// The mine.
pub fn two_level() -> Arc<Mine> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    Arc::new(adit_mine::file::open(Path::new(file)).unwrap().0)
}

/// Somebody who walks about with every sensor; what comes by radio is late and overtakes itself.
pub fn log(mine: &Arc<Mine>, mount: Mount, ranging_hz: f64) -> Vec<Observation> {
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
            radio: RadioRates { detail: RangeDetail::Range, ranging_hz, ..RadioRates::default() },
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

/// The defaults at the site.
pub fn settings(mine: &Mine, worn: Worn) -> FusedParams {
    let known = Known {
        specification: Some(ImuErrorModel::mpu6050().specification()),
        worn: Some(worn),
        ..Known::default()
    };
    FusedParams::default().knowing(&known).at_site(&Arc::new(RadioSite::of_mine(mine)))
}

/// How a tag is worn.
pub fn wearers() -> [(Mount, Worn); 2] {
    [(Mount::RightFoot(Foot::instep()), Worn::Foot), (Mount::Belt(Belt::front()), Worn::Body)]
}
