//! What is known of the radio of a site: places and path loss of its transmitters, maps, fingerprints.
//!
//! From a mine ([`RadioSite::of_plan`]), from a calibration ([`RadioSite::with_path_loss`], [`RadioSite::with_fingerprints`]), or from both: what was
//! calibrated goes before what the mine's file says. A [`Locator`](super::locator::Locator) takes of it what its method needs.

use super::map::{Hearing, Storeys};
use super::model::{FingerprintModel, PathLossModel};
use super::nearest::Fingerprints;
use super::{AreaPrior, MapParams, PathLoss, RadioMap};
use crate::place::roadways::Roadways;
use crate::ranging::correction::RangeCorrection;
use adit_core::nalgebra::{Vector2, Vector3};
use adit_mine::Mine;
use adit_mine::plan::{AccessPoint, MinePlan, Radio};
use adit_observation::DeviceId;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// People are found this far from a centre line where a roadway is narrower, m.
const MARGIN_M: f64 = 1.0;
/// Places along centre lines this far apart tell where people are, m.
const SPOT_M: f64 = 1.0;

/// A transmitter of the site.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Transmitter {
    /// Its id; logs may name it so, or by its MAC address.
    pub id: String,
    /// MAC address.
    pub mac: Option<String>,
    /// East, north, height of its antenna, m.
    pub position_m: Vector3<f64>,
    /// Floor, where that is told.
    pub floor: Option<i32>,
    /// A Bluetooth beacon.
    pub beacon: bool,
    /// Transmit power, dBm.
    pub tx_power_dbm: Option<f64>,
    /// How its signal falls off, where that was calibrated.
    pub path_loss: Option<PathLoss>,
}

/// An anchor of the site, for ranges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SiteAnchor {
    /// Its id, as in the logs.
    pub id: String,
    /// East, north, height of its antenna, m.
    pub position_m: Vector3<f64>,
    /// What it adds to every range, m.
    pub range_offset_m: f64,
}

/// A reader of a portal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reader {
    /// Its id, as in the logs.
    pub id: String,
    /// East, north, height of its antenna, m.
    pub position_m: Vector3<f64>,
    /// How far it sees, m.
    pub range_m: f64,
}

/// What of a calibration is the same for all transmitters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Calibrated {
    /// Standard deviation of one reading, dB.
    pub sigma_db: f64,
    /// Height of the tag in the survey, m.
    pub height_m: f64,
    /// How weak a signal is heard.
    pub hearing: Hearing,
    /// What a floor between takes.
    pub storeys: Storeys,
    /// How far to believe a map of it.
    pub belief: MapParams,
}

/// Fingerprints and, where one was made, the map of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Surveyed {
    /// Names of the transmitters by their number.
    pub transmitters: Vec<DeviceId>,
    /// The spots as surveyed.
    pub fingerprints: Fingerprints,
    /// What strengths to expect where.
    pub map: Option<SurveyedMap>,
}

/// A map made of a survey.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurveyedMap {
    /// What strengths to expect where.
    pub map: RadioMap,
    /// How far to believe it.
    pub belief: MapParams,
}

/// Centre lines of roadways, seen from above.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CentreLines {
    /// Straight parts, from and to, m.
    pub legs_m: Vec<[Vector2<f64>; 2]>,
}

impl CentreLines {
    /// The nearest point of any, m; `None` where there are none.
    pub fn nearest(&self, point_m: &Vector2<f64>) -> Option<Vector2<f64>> {
        let feet = self.legs_m.iter().map(|[from, to]| {
            let along = to - from;
            let share = (point_m - from).dot(&along) / along.norm_squared();
            // NaN, of a leg without length, becomes its beginning.
            from + along * if share > 0.0 { share.min(1.0) } else { 0.0 }
        });
        feet.min_by(|a, b| (a - point_m).norm_squared().total_cmp(&(b - point_m).norm_squared()))
    }
}

/// All that is known of the radio of a site.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RadioSite {
    /// Transmitters whose place is known.
    pub transmitters: Vec<Transmitter>,
    /// Anchors.
    pub anchors: Vec<SiteAnchor>,
    /// Readers of portals.
    pub readers: Vec<Reader>,
    /// Roadways as map matching wants them, where the whole mine is known.
    #[serde(skip)]
    pub roadways: Option<Arc<Roadways>>,
    /// Places where people are, east, north, m: along the centre lines of roadways.
    pub spots_m: Vec<Vector2<f64>>,
    /// Those centre lines.
    pub centre_lines: CentreLines,
    /// How far from them, m.
    pub reach_m: f64,
    /// Mean and spread of where people are.
    pub area: Option<AreaPrior>,
    /// Of a calibrated path loss.
    pub calibrated: Option<Calibrated>,
    /// Of surveyed fingerprints.
    pub surveyed: Option<Surveyed>,
    /// How ranges to the anchors err; where it is told, the anchors' own [`range_offset_m`](SiteAnchor::range_offset_m) are zero.
    pub ranges: Option<RangeCorrection>,
}

impl RadioSite {
    /// The same of a whole mine, with its roadways to match a walker to.
    pub fn of_mine(mine: &Mine) -> Self {
        let roadways = Roadways::new(mine);
        let roadways = (roadways.pieces() > 0).then(|| Arc::new(roadways));
        Self { roadways, ..Self::of_plan(mine.plan()) }
    }

    /// Access points, anchors and roadways of a plan; where it has no access points, its anchors stand for them (a bare list of places).
    pub fn of_plan(plan: &MinePlan) -> Self {
        let mut transmitters: Vec<Transmitter> = plan.access_points.iter().map(Transmitter::of).collect();
        if transmitters.is_empty() {
            transmitters.extend(plan.anchors.iter().map(|anchor| Transmitter {
                id: anchor.id.clone(),
                mac: None,
                position_m: *anchor.position_m.raw(),
                floor: None,
                beacon: false,
                tx_power_dbm: anchor.tx_power_dbm,
                path_loss: None,
            }));
        }
        let anchors = plan.anchors.iter().map(|anchor| SiteAnchor {
            id: anchor.id.clone(),
            position_m: *anchor.position_m.raw(),
            range_offset_m: anchor.range_offset_m.unwrap_or(0.0),
        });
        let anchors = anchors.collect();
        let (mut spots_m, mut centre_lines) = (Vec::new(), CentreLines::default());
        for roadway in &plan.roadways {
            for leg in roadway.points_m.windows(2) {
                let (from, to) = (leg[0].raw().xy(), leg[1].raw().xy());
                centre_lines.legs_m.push([from, to]);
                let parts = libm::ceil((to - from).norm() / SPOT_M).max(1.0);
                let mut part = 0.0;
                while part <= parts {
                    spots_m.push(from + (to - from) * (part / parts));
                    part += 1.0;
                }
            }
        }
        let widest_m = plan.roadways.iter().map(|roadway| roadway.width_m).fold(0.0, f64::max);
        let area = AreaPrior::of(&spots_m, MARGIN_M);
        let reach_m = MARGIN_M.max(0.5 * widest_m);
        let readers = plan.rfid_portals.iter().map(|portal| Reader {
            id: portal.id.clone(),
            position_m: *portal.position_m.raw(),
            range_m: portal.range_m,
        });
        Self {
            transmitters,
            anchors,
            readers: readers.collect(),
            roadways: None,
            spots_m,
            centre_lines,
            reach_m,
            area,
            calibrated: None,
            surveyed: None,
            ranges: None,
        }
    }

    /// Whether signal strengths tell anything here: transmitters other than the anchors, or a survey.
    pub fn has_signals(&self) -> bool {
        self.surveyed.is_some() || !self.transmitters.is_empty()
    }

    /// The same with what `adit calibrate pathloss` found.
    #[must_use]
    pub fn with_path_loss(mut self, model: &PathLossModel) -> Self {
        for access_point in &model.access_points {
            let floor = model.floors.get(&access_point.id).copied();
            let calibrated = Transmitter { floor, ..Transmitter::of(access_point) };
            match self.transmitters.iter_mut().find(|known| known.is_called(&calibrated.id)) {
                Some(known) => {
                    // A file of a mine names it by its id and its MAC address, a survey by one of them.
                    let (id, mac) = (known.id.clone(), known.mac.clone());
                    *known = Transmitter { id, mac, ..calibrated };
                }
                None => self.transmitters.push(calibrated),
            }
        }
        self.area = Some(model.area);
        self.calibrated = Some(Calibrated {
            sigma_db: model.signal.sigma_db,
            height_m: model.signal.height_m,
            hearing: model.hearing,
            storeys: model.storeys,
            belief: model.belief,
        });
        self
    }

    /// The same with what `adit calibrate fingerprint` found.
    #[must_use]
    pub fn with_fingerprints(mut self, model: FingerprintModel) -> Self {
        let FingerprintModel { transmitters, strengths, belief, fingerprints, .. } = model;
        let map = Some(SurveyedMap { map: strengths, belief });
        self.surveyed = Some(Surveyed { transmitters, fingerprints, map });
        self
    }

    /// The same with what `adit calibrate range` found, in place of the offsets of the anchors.
    #[must_use]
    pub fn with_ranges(mut self, correction: RangeCorrection) -> Self {
        for anchor in &mut self.anchors {
            anchor.range_offset_m = 0.0;
        }
        self.ranges = Some(correction);
        self
    }
}

impl Transmitter {
    fn of(access_point: &AccessPoint) -> Self {
        Self {
            id: access_point.id.clone(),
            mac: access_point.mac.clone(),
            position_m: *access_point.position_m.raw(),
            floor: None,
            beacon: access_point.radio == Radio::Ble,
            tx_power_dbm: access_point.tx_power_dbm,
            path_loss: access_point.path_loss,
        }
    }

    /// Whether a log means it by this name.
    pub fn is_called(&self, name: &str) -> bool {
        self.id == name || self.mac.as_deref().is_some_and(|mac| is_same_mac(mac, name))
    }
}

/// MAC addresses with or without colons, in either case.
fn is_same_mac(one: &str, other: &str) -> bool {
    digits(one).eq(digits(other))
}

fn digits(mac: &str) -> impl Iterator<Item = u8> {
    mac.bytes().filter(|byte| !matches!(byte, b':' | b'-')).map(|byte| byte.to_ascii_lowercase())
}
