//! A walker with every sensor in the mine of two levels.

use adit_estimation::methods::fused::FusedParams;
use adit_estimation::methods::{Known, MethodSettings, Worn};
use adit_estimation::radio::RadioSite;
use adit_mine::Mine;
use adit_observation::Observation;
use adit_simulation::people::{Belt, PersonSpec, Place, Roam};
use adit_simulation::pressure::BarometerModel;
use adit_simulation::radio::delivery::LinkSpec;
use adit_simulation::workforce::{Mount, Outfit, Workforce, WorkforceSpec};
use adit_simulation::{Foot, ImuErrorModel, MagneticWorld, MagnetometerModel};
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
    let roam = Roam::on_level("l300", LENGTH_S, 300.0, 0.3, [5.0, 10.0]);
    let start = Place::Roadway { id: "l300-haulage".to_owned(), along_m: 320.0, left_m: 0.0 };
    let outfit = Outfit {
        magnetic: Some((MagneticWorld::default(), MagnetometerModel::ak8963())),
        barometer: Some(BarometerModel::bmp388()),
        ..Outfit::plain(mount, ranging_hz)
    };
    let link = LinkSpec {
        least_delay_s: 0.01,
        extra_delay_s: 0.1,
        most_delay_s: 0.6,
        duplicated: 0.1,
        ..LinkSpec::perfect()
    };
    let person = PersonSpec::roaming(start, 5.0, roam);
    let spec = WorkforceSpec { link, ..WorkforceSpec::undisturbed(LENGTH_S, vec![person], outfit) };
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
