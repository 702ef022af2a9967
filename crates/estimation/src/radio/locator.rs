//! From an averaged scan to a position: one of the methods of [`radio`](super), with what is known of the site.
//!
//! | method | needs of the site |
//! |---|---|
//! | `centroid`, `weighted-centroid`, `inner-points…`, `trilateration`, `fit` | places of transmitters |
//! | `map` | a surveyed map; or places of transmitters: over roadways, an area, or around them |
//! | `nearest` | fingerprints |
//! | `auto` | `map` where it can be, else `fit` |
//!
//! Where `map` and `auto` find both, a scan goes to the one that knows most of what was heard: surveyed Wi-Fi beside beacons of known place.
//!
//! A transmitter without a calibrated path loss has that of [`LocatorParams::path_loss`], with its own power where that is told. Floors: transmitters
//! on another floor than the strongest are left out of the circles; the map knows them.
//! Frame: east and north of the site. What transmitters hang above the tag is known by heights, or taken as [`LocatorParams::above_m`]: roadways slope.

use super::centroid::{CentroidWeight, centroid};
use super::circles::{CircleParams, InnerWeight, inner_points};
use super::line::row;
use super::map::{Hearing, Storeys};
use super::nearest::{Fingerprints, NearestParams};
use super::scan::{HeardMean, Scan};
use super::signal_fit::{SignalFitParams, signal_fit};
use super::site::{CentreLines, RadioSite, Surveyed, SurveyedMap, Transmitter};
use super::trilateration::linear_signals;
use super::{AreaPrior, Emitter, Heard, Lattice, MapParams, PathLoss, RadioFix, RadioMap, Reading};
use crate::settings::{first_unusable, not_negative, positive};
use adit_core::nalgebra::Vector2;
use adit_observation::DeviceId;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// How a position is made of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LocatorMethod {
    /// The map where the site allows one, else the robust fit.
    #[default]
    Auto,
    /// Mean of the places of the three strongest.
    Centroid,
    /// Mean of all places by one over their distance.
    WeightedCentroid,
    /// Mean of the inner points of the three strongest.
    InnerPoints,
    /// The same, weighted by one over the radii.
    InnerPointsWeighted,
    /// The same, with the improved weight of system S1.
    InnerPointsImproved,
    /// Linear least squares on the circles of the five strongest.
    Trilateration,
    /// Robust least squares on the strengths.
    Fit,
    /// Nearest fingerprints.
    Nearest,
    /// Likelihood over a lattice of places.
    Map,
}

/// Settings of a [`Locator`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LocatorParams {
    /// Which method.
    pub method: LocatorMethod,
    /// Only so many of the strongest transmitters; the method's own number where nothing is said.
    pub strongest: Option<usize>,
    /// Height of the tags, m, where the site is level and somebody knows it.
    pub height_m: Option<f64>,
    /// Transmitters hang so much above the tags, m, where no height is known.
    pub above_m: f64,
    /// Path loss where none was calibrated; its strength at 1 m where no transmit power is told either.
    pub path_loss: PathLoss,
    /// The same of Bluetooth beacons.
    pub beacon_path_loss: PathLoss,
    /// What a transmitter of known power loses on the first metre, dB.
    pub first_metre_db: f64,
    /// Standard deviation of a strength about the path loss where none was calibrated, dB.
    pub sigma_db: f64,
    /// Half the width of a roadway, for transmitters in a row, m.
    pub half_width_m: f64,
    /// Puts the fix of circles about transmitters in a row onto the nearest centre line: they tell where along a roadway, not where across it.
    pub to_roadway: bool,
    /// Degrees of freedom of the errors of `fit`.
    pub dof: f64,
    /// Standard deviation of the tag's own offset in `fit`, dB.
    pub offset_sigma_db: f64,
    /// For `nearest`.
    pub nearest: NearestParams,
    /// How far to believe a map, where that is not what its calibration found.
    pub belief: Option<MapParams>,
    /// From place to place of a map made of a path loss, m.
    pub step_m: f64,
    /// The floor where people are, for a map made of a path loss; that of most transmitters where nothing is said.
    pub floor: Option<i32>,
}

impl Default for LocatorParams {
    fn default() -> Self {
        Self {
            method: LocatorMethod::Auto,
            strongest: None,
            height_m: None,
            // From a belt to under the roof.
            above_m: 1.5,
            // Two slopes of a roadway: Hrovat, Kandus & Javornik 2014; 18 dBm less the first metre.
            path_loss: PathLoss {
                rssi_at_1m_dbm: -22.2,
                exponent: 2.2,
                breakpoint_m: Some(30.0),
                exponent_beyond: Some(1.7),
            },
            // 0 dBm less the first metre and what a small antenna, a case and a hand take.
            beacon_path_loss: PathLoss {
                rssi_at_1m_dbm: -50.0,
                exponent: 2.5,
                breakpoint_m: None,
                exponent_beyond: None,
            },
            // Free space at 2.44 GHz: 20 log₁₀(4π · 1 m / λ).
            first_metre_db: 40.2,
            // Shadowing, fading, and the trunk of the wearer in the way of half of them.
            sigma_db: 8.0,
            half_width_m: 2.5,
            to_roadway: true,
            dof: 4.0,
            offset_sigma_db: 6.0,
            nearest: NearestParams::default(),
            belief: None,
            step_m: 1.0,
            floor: None,
        }
    }
}

impl LocatorParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        let share = |value: f64| value > 0.0 && value <= 1.0;
        let belief = self.belief.unwrap_or(MapParams::SCAN);
        first_unusable(&[
            ("locator.strongest", self.strongest != Some(0)),
            ("locator.height_m", self.height_m.is_none_or(f64::is_finite)),
            ("locator.above_m", self.above_m.is_finite()),
            ("locator.path_loss", is_usable(&self.path_loss)),
            ("locator.beacon_path_loss", is_usable(&self.beacon_path_loss)),
            ("locator.first_metre_db", self.first_metre_db.is_finite()),
            ("locator.sigma_db", positive(self.sigma_db)),
            ("locator.half_width_m", not_negative(self.half_width_m)),
            ("locator.dof", positive(self.dof)),
            ("locator.offset_sigma_db", not_negative(self.offset_sigma_db)),
            ("locator.nearest.unheard_dbm", self.nearest.unheard_dbm.is_finite()),
            ("locator.belief.dof", positive(belief.dof)),
            ("locator.belief.offset_sigma", not_negative(belief.offset_sigma)),
            ("locator.belief.heard_weight", not_negative(belief.heard_weight)),
            ("locator.belief.share", share(belief.share)),
            ("locator.step_m", positive(self.step_m)),
        ])
    }
}

fn is_usable(loss: &PathLoss) -> bool {
    loss.rssi_at_1m_dbm.is_finite()
        && positive(loss.exponent)
        && loss.breakpoint_m.is_none_or(positive)
        && loss.exponent_beyond.is_none_or(positive)
}

/// A map of a path loss has no more places than this, or its step grows: 1 ms for each position.
const MOST_PLACES: f64 = 4000.0;
/// An area reaches this many standard deviations far.
const AREA_SIGMAS: f64 = 2.5;

/// People whose area is not told are this far from the transmitters, standard deviation, m.
const AROUND_M: f64 = 10.0;

/// Makes positions of scans.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Locator {
    params: LocatorParams,
    /// A scan goes to the one that knows most of what was heard, the first of equals.
    models: Vec<Named>,
}

/// A model and the names of its transmitters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Named {
    /// Names in logs with the number of the transmitter, by name.
    names: Vec<(DeviceId, usize)>,
    /// MAC addresses in whatever form.
    transmitters: Vec<Transmitter>,
    model: Model,
}

/// What positions are made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Model {
    /// Transmitters by number, with their floor; heights above the tag.
    Emitters { emitters: Vec<(Emitter, Option<i32>)>, area: Option<AreaPrior>, centre_lines: CentreLines },
    /// A map by number.
    Map { map: RadioMap, belief: MapParams },
    /// Fingerprints by number.
    Fingerprints { fingerprints: Fingerprints },
}

impl Locator {
    /// A locator for a site; else what its method needs of one that the site does not have.
    pub fn new(site: &RadioSite, params: LocatorParams) -> Result<Self, &'static str> {
        let surveyed = site.surveyed.as_ref();
        let mut models = Vec::new();
        match (params.method, surveyed) {
            (LocatorMethod::Nearest, None) => {
                return Err("fingerprints (--radio, of adit calibrate fingerprint)");
            }
            (LocatorMethod::Nearest, Some(surveyed)) => {
                let fingerprints = surveyed.fingerprints.clone();
                models.push(Named::of_survey(surveyed, Model::Fingerprints { fingerprints }));
            }
            (LocatorMethod::Map | LocatorMethod::Auto, Some(surveyed)) => {
                if let Some(SurveyedMap { map, belief }) = &surveyed.map {
                    let (map, belief) = (map.clone(), params.belief.unwrap_or(*belief));
                    models.push(Named::of_survey(surveyed, Model::Map { map, belief }));
                }
            }
            _ => {}
        }
        if params.method != LocatorMethod::Nearest && !site.transmitters.is_empty() {
            let emitters = emitters(site, &params);
            let on_map = matches!(params.method, LocatorMethod::Map | LocatorMethod::Auto);
            let map = if on_map { map_of(site, &params, &emitters) } else { None };
            let centre_lines =
                if params.to_roadway { site.centre_lines.clone() } else { CentreLines::default() };
            let model = map.unwrap_or(Model::Emitters { emitters, area: site.area, centre_lines });
            models.push(Named::of_transmitters(&site.transmitters, model));
        }
        if models.is_empty() {
            return Err("places of transmitters (--mine, or --radio of adit calibrate pathloss)");
        }
        Ok(Self { params, models })
    }

    /// Whether the site knows a transmitter of this name.
    pub fn knows(&self, name: &DeviceId) -> bool {
        self.models.iter().any(|one| one.number(name).is_some())
    }

    /// The position by a scan; `None` where too little of what is known was heard.
    pub fn locate(&self, scan: &Scan) -> Option<RadioFix> {
        let mut chosen: Option<(&Named, Vec<Reading>)> = None;
        for named in &self.models {
            let readings = named.readings(scan);
            if readings.len() > chosen.as_ref().map_or(0, |(_, known)| known.len()) {
                chosen = Some((named, readings));
            }
        }
        let (named, mut readings) = chosen?;
        if let Some(most) = self.params.strongest {
            strongest(&mut readings, most, |reading| reading.value);
        }
        match &named.model {
            Model::Emitters { emitters, area, centre_lines } => {
                self.circles(&readings, emitters, area.as_ref(), centre_lines)
            }
            Model::Map { map, belief } => map.fix(&readings, belief).map(|place| place.fix),
            Model::Fingerprints { fingerprints } => {
                fingerprints.nearest(&readings, &self.params.nearest).map(|place| place.fix)
            }
        }
    }

    fn circles(
        &self,
        readings: &[Reading],
        emitters: &[(Emitter, Option<i32>)],
        area: Option<&AreaPrior>,
        centre_lines: &CentreLines,
    ) -> Option<RadioFix> {
        let known = || readings.iter().filter_map(|one| Some((emitters.get(one.transmitter)?, one.value)));
        let ((_, floor), _) = known().max_by(|a, b| a.1.total_cmp(&b.1))?;
        // What comes through a floor is no circle in the plane.
        let on_floor = known().filter(|((_, on), _)| on == floor);
        let mut heard: Vec<Heard<'_>> =
            on_floor.map(|((emitter, _), rssi_dbm)| Heard { emitter, rssi_dbm }).collect();
        let params = &self.params;
        let inner = |heard: &[Heard<'_>], weight| {
            inner_points(heard, &CircleParams { weight, height_m: 0.0, half_width_m: params.half_width_m })
        };
        let in_row = row(heard.iter().map(|one| one.emitter.position_m.xy())).is_some();
        let fix = match params.method {
            LocatorMethod::Centroid => {
                strongest(&mut heard, params.strongest.unwrap_or(3), |one| one.rssi_dbm);
                centroid(&heard, CentroidWeight::Equal)
            }
            LocatorMethod::WeightedCentroid => centroid(&heard, CentroidWeight::InverseRange),
            LocatorMethod::InnerPoints => inner(&heard, InnerWeight::Equal),
            LocatorMethod::InnerPointsWeighted => inner(&heard, InnerWeight::InverseRange),
            LocatorMethod::InnerPointsImproved => inner(&heard, InnerWeight::RangeOverStrength),
            LocatorMethod::Trilateration => {
                strongest(&mut heard, params.strongest.unwrap_or(5), |one| one.rssi_dbm);
                linear_signals(&heard, 0.0)
            }
            LocatorMethod::Auto | LocatorMethod::Fit | LocatorMethod::Nearest | LocatorMethod::Map => {
                let (dof, offset_sigma_db) = (params.dof, params.offset_sigma_db);
                signal_fit(
                    &heard,
                    area,
                    &SignalFitParams { dof, offset_sigma_db, ..SignalFitParams::default() },
                )
            }
        }?;
        // Along the row the circles tell; across it the roadway.
        let nearest = if in_row { centre_lines.nearest(&fix.position_m) } else { None };
        Some(RadioFix { position_m: nearest.unwrap_or(fix.position_m), ..fix })
    }
}

impl Named {
    fn of_survey(surveyed: &Surveyed, model: Model) -> Self {
        let mut names: Vec<_> = surveyed.transmitters.iter().cloned().zip(0..).collect();
        names.sort_unstable();
        Self { names, transmitters: Vec::new(), model }
    }

    fn of_transmitters(transmitters: &[Transmitter], model: Model) -> Self {
        let mut names = names(transmitters);
        names.sort_unstable();
        Self { names, transmitters: transmitters.to_vec(), model }
    }

    /// Number of the transmitter of this name; `None` where it is not known.
    fn number(&self, name: &DeviceId) -> Option<usize> {
        match self.names.binary_search_by(|(known, _)| known.cmp(name)) {
            Ok(index) => self.names.get(index).map(|(_, number)| *number),
            Err(_) => self.transmitters.iter().position(|one| one.is_called(name.as_str())),
        }
    }

    /// What of a scan it knows.
    fn readings(&self, scan: &Scan) -> Vec<Reading> {
        let reading = |one: &HeardMean| {
            Some(Reading { transmitter: self.number(&one.transmitter)?, value: one.rssi_dbm })
        };
        scan.heard.iter().filter_map(reading).collect()
    }
}

pub(crate) fn names(transmitters: &[Transmitter]) -> Vec<(DeviceId, usize)> {
    let both = |(one, number): (&Transmitter, usize)| {
        [Some(&one.id), one.mac.as_ref()].map(|name| Some((DeviceId::new(name?)?, number)))
    };
    transmitters.iter().zip(0..).flat_map(both).flatten().collect()
}

/// Keeps the `count` with the largest values.
fn strongest<T>(all: &mut Vec<T>, count: usize, value: impl Fn(&T) -> f64) {
    all.sort_by(|a, b| value(b).total_cmp(&value(a)));
    all.truncate(count);
}

/// The transmitters with their path loss, heights above the tag.
pub(crate) fn emitters(site: &RadioSite, params: &LocatorParams) -> Vec<(Emitter, Option<i32>)> {
    let height_m = params.height_m.or(site.calibrated.map(|calibrated| calibrated.height_m));
    let sigma_db = site.calibrated.map_or(params.sigma_db, |calibrated| calibrated.sigma_db);
    let emitter = |transmitter: &Transmitter| {
        let mut position_m = transmitter.position_m;
        position_m.z = height_m.map_or(params.above_m, |height_m| position_m.z - height_m);
        let path_loss = transmitter.path_loss.unwrap_or_else(|| {
            let usual = if transmitter.beacon { params.beacon_path_loss } else { params.path_loss };
            let told = transmitter.tx_power_dbm.map(|power| power - params.first_metre_db);
            PathLoss { rssi_at_1m_dbm: told.unwrap_or(usual.rssi_at_1m_dbm), ..usual }
        });
        (Emitter { position_m, path_loss, sigma_db }, transmitter.floor)
    };
    site.transmitters.iter().map(emitter).collect()
}

/// The map of a path loss over the roadways, or over an area, or around the transmitters; `None` where these are too far apart.
fn map_of(site: &RadioSite, params: &LocatorParams, emitters: &[(Emitter, Option<i32>)]) -> Option<Model> {
    let lattice =
        if site.spots_m.is_empty() { over_area(site, params)? } else { along_roadways(site, params)? };
    let (storeys, hearing, belief) = match site.calibrated {
        Some(calibrated) => (calibrated.storeys, calibrated.hearing, calibrated.belief),
        // Nothing is known of what is not heard: it tells nothing.
        None => (
            Storeys { height_m: 0.0, loss_db: 0.0 },
            Hearing { half_dbm: -90.0, width_db: 3.0, unsure: 0.05 },
            MapParams {
                dof: params.dof,
                offset_sigma: params.offset_sigma_db,
                heard_weight: 0.0,
                share: 1.0,
            },
        ),
    };
    let belief = params.belief.unwrap_or(belief);
    // The lattice has one floor, number 0.
    let here = params.floor.or_else(|| most_common(emitters));
    let apart = |floor: Option<i32>| Some(floor?.saturating_sub(here?));
    let emitters: Vec<_> = emitters.iter().map(|(emitter, floor)| (*emitter, apart(*floor))).collect();
    let map = RadioMap::of_emitters(lattice, &emitters, 0.0, &storeys, &hearing)?;
    Some(Model::Map { map, belief })
}

/// The floor of most.
fn most_common(emitters: &[(Emitter, Option<i32>)]) -> Option<i32> {
    let floors = || emitters.iter().filter_map(|(_, floor)| *floor);
    floors().max_by_key(|floor| floors().filter(|other| other == floor).count())
}

fn along_roadways(site: &RadioSite, params: &LocatorParams) -> Option<Lattice> {
    let spots: Vec<(Vector2<f64>, i32)> = site.spots_m.iter().map(|spot| (*spot, 0)).collect();
    let places = spots.len() as f64 * 2.0 * site.reach_m / (params.step_m * params.step_m);
    let coarser = libm::sqrt((places / MOST_PLACES).max(1.0));
    Lattice::around(&spots, params.step_m * coarser, site.reach_m)
}

fn over_area(site: &RadioSite, params: &LocatorParams) -> Option<Lattice> {
    let around = || {
        AreaPrior::of(&site.transmitters.iter().map(|one| one.position_m.xy()).collect::<Vec<_>>(), AROUND_M)
    };
    let area = site.area.or_else(around)?;
    let reach = area.covariance_m2.diagonal().map(|variance| AREA_SIGMAS * libm::sqrt(variance));
    let places = 4.0 * reach.x * reach.y / (params.step_m * params.step_m);
    let coarser = libm::sqrt((places / MOST_PLACES).max(1.0));
    Lattice::within(&(area.mean_m - reach), &(area.mean_m + reach), params.step_m * coarser)
}
