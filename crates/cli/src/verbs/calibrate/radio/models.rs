//! Everything that a path loss gives: its fits, its maps, and the methods that stand on them.

use super::contest::{Contestant, Follower, Uses};
use super::data::RadioData;
use super::walks;
use adit_core::nalgebra::Vector2;
use adit_estimation::radio::centroid::{CentroidWeight, centroid};
use adit_estimation::radio::circles::{CircleParams, InnerWeight, inner_points};
use adit_estimation::radio::range_fit::{RangeFitParams, RangeModel, Ranged, range_fit};
use adit_estimation::radio::signal_fit::{SignalFitParams, signal_fit};
use adit_estimation::radio::trilateration::{linear_ranges, linear_signals};
use adit_estimation::radio::{
    AreaPrior, Emitter, Heard, Lattice, MapParams, PlaceFix, RadioFix, RadioMap, Reading,
};
use adit_tuning::fingerprint::lattice_around;
use adit_tuning::radio::path_loss::{self, PathLossFit, PathLossParams};
use adit_tuning::radio::ranges::{self, RangesFit};
use adit_tuning::radio::{Site, belief};
use anyhow::{Context, Result};

/// People may be this far from where the survey was, m.
const MARGIN_M: f64 = 1.0;
/// From place to place over the extent of walks, m.
const WALK_STEP_M: f64 = 0.5;

/// The fits of one set of data.
pub struct SiteModels {
    /// Path loss.
    pub fit: PathLossFit,
    /// Ranges, where the data has some.
    pub ranges: Option<RangesFit>,
    /// Where people are.
    pub area: AreaPrior,
    /// Places of the transmitters.
    pub sites: Vec<Option<Site>>,
    /// Mean height of the tag, m.
    pub height_m: f64,
    map: RadioMap,
    /// How far to believe the map.
    pub belief: MapParams,
    range_map: Option<(RadioMap, MapParams)>,
}

impl SiteModels {
    /// Fits everything.
    pub fn new(data: &RadioData, sites: &[Option<Site>]) -> Result<Self> {
        let (scans, ranged) = (data.strengths(), data.ranges());
        let fit = path_loss::fit(&scans, sites, &PathLossParams::default())?;
        let ranges = if ranged.is_empty() { None } else { Some(ranges::fit(&ranged, sites)?) };
        let places: Vec<Vector2<f64>> = data.spots().iter().map(|(place, _)| *place).collect();
        let area = AreaPrior::of(&places, MARGIN_M).context("no spots")?;
        let height_m = data.height_m();
        let lattice = lattice(data, sites)?;
        let map_of =
            |fit: &PathLossFit| map_of(lattice.clone(), fit, sites, height_m).context("no transmitters");
        let range_map_of = |fit: &RangesFit| {
            range_map_of(lattice.clone(), fit, sites, height_m).context("no devices with ranges")
        };
        // How far to believe them is learnt from spots that the fits have not seen.
        let cell_m = PathLossParams::default().cell_m;
        let judged = belief::folds(&scans, cell_m).into_iter().map(|(kept, judged)| {
            let fit = path_loss::fit(&kept, sites, &PathLossParams::default())?;
            Ok((map_of(&fit)?, judged))
        });
        let judged = judged.collect::<Result<Vec<_>>>()?;
        let belief = if judged.is_empty() {
            MapParams { heard_weight: 0.0, ..MapParams::SCAN }
        } else {
            belief::learn(&judged, false)
        };
        let judged = belief::folds(&ranged, cell_m)
            .into_iter()
            .map(|(kept, judged)| Ok((range_map_of(&ranges::fit(&kept, sites)?)?, judged)));
        let judged = judged.collect::<Result<Vec<_>>>()?;
        let range_map = match &ranges {
            Some(fit) => Some((range_map_of(fit)?, belief::learn(&judged, true))),
            None => None,
        };
        let map = map_of(&fit)?;
        Ok(Self { fit, ranges, area, sites: sites.to_vec(), height_m, map, belief, range_map })
    }

    /// The methods that stand on a path loss.
    pub fn contestants(&self) -> Vec<Contestant<'_>> {
        let plain = |name, method: fn(&Self, &[Heard<'_>]) -> Option<RadioFix>| {
            self.in_plane(name, Uses::Strengths, move |readings| method(self, &self.heard(readings)))
        };
        let mut all = vec![
            plain("centroid of 3", |_, heard| centroid(&strongest(heard, 3), CentroidWeight::Equal)),
            plain("weighted centroid", |_, heard| centroid(heard, CentroidWeight::InverseRange)),
            plain("inner points", |site, heard| site.inner(heard, InnerWeight::Equal)),
            plain("inner points, 1/r", |site, heard| site.inner(heard, InnerWeight::InverseRange)),
            plain("inner points, S1", |site, heard| site.inner(heard, InnerWeight::RangeOverStrength)),
            plain("trilateration, linear", |site, heard| linear_signals(&strongest(heard, 5), site.height_m)),
            plain("robust fit, no area", |site, heard| site.robust(heard, None)),
            plain("robust fit", |site, heard| site.robust(heard, Some(&site.area))),
            Contestant {
                name: "path-loss map",
                uses: Uses::Strengths,
                fix: Box::new(|readings| self.map.fix(readings, &self.belief)),
            },
        ];
        if let (Some(ranges), Some((map, belief))) = (&self.ranges, &self.range_map) {
            let ranged = move |readings: &[Reading], raw: bool| -> Vec<Ranged> {
                let one = |reading: &Reading| {
                    let position_m = self.sites.get(reading.transmitter)?.as_ref()?.position_m;
                    let model = ranges.models.get(reading.transmitter).copied().flatten()?;
                    let model = if raw { RangeModel { offset_m: 0.0, scale: 1.0, ..model } } else { model };
                    Some(Ranged { position_m, model, range_m: reading.value })
                };
                readings.iter().filter_map(one).collect()
            };
            let fit = move |readings: &[Reading], area: Option<&AreaPrior>| {
                let params = RangeFitParams { height_m: self.height_m, ..RangeFitParams::default() };
                range_fit(&ranged(readings, false), area, &params)
            };
            all.push(self.in_plane("ranges, linear, as read", Uses::Ranges, move |readings| {
                linear_ranges(&ranged(readings, true), self.height_m)
            }));
            all.push(
                self.in_plane("ranges, robust fit, no area", Uses::Ranges, move |readings| {
                    fit(readings, None)
                }),
            );
            all.push(self.in_plane("ranges, robust fit", Uses::Ranges, move |readings| {
                fit(readings, Some(&self.area))
            }));
            all.push(Contestant {
                name: "ranges, map",
                uses: Uses::Ranges,
                fix: Box::new(|readings| map.fix(readings, belief)),
            });
        }
        all
    }

    /// The methods that follow a walk.
    pub fn followers(&self, data: &RadioData) -> Vec<Follower<'_>> {
        if !walks(data) {
            return Vec::new();
        }
        vec![
            Follower { name: "path-loss walk", map: &self.map, smoothed: false },
            Follower { name: "path-loss walk, smoothed", map: &self.map, smoothed: true },
        ]
    }

    /// The transmitters on the floor of the strongest: what comes through a floor is no circle in the plane.
    fn heard(&self, readings: &[Reading]) -> Vec<Heard<'_>> {
        let floor = self.nearest_floor(readings, Uses::Strengths);
        let one = |reading: &Reading| {
            let emitter = self.fit.emitters.get(reading.transmitter)?.as_ref()?;
            let on = self.sites.get(reading.transmitter)?.as_ref()?.floor;
            (on == floor).then_some(Heard { emitter, rssi_dbm: reading.value })
        };
        readings.iter().filter_map(one).collect()
    }

    /// Floor of the strongest, or of the nearest, transmitter.
    fn nearest_floor(&self, readings: &[Reading], uses: Uses) -> Option<i32> {
        let sign = if uses == Uses::Strengths { 1.0 } else { -1.0 };
        let known = readings.iter().filter_map(|reading| {
            Some((sign * reading.value, self.sites.get(reading.transmitter)?.as_ref()?.floor))
        });
        known.max_by(|a, b| a.0.total_cmp(&b.0))?.1
    }

    fn inner(&self, heard: &[Heard<'_>], weight: InnerWeight) -> Option<RadioFix> {
        inner_points(heard, &CircleParams { weight, height_m: self.height_m, ..CircleParams::default() })
    }

    fn robust(&self, heard: &[Heard<'_>], area: Option<&AreaPrior>) -> Option<RadioFix> {
        signal_fit(heard, area, &SignalFitParams { height_m: self.height_m, ..SignalFitParams::default() })
    }

    /// A method in the plane.
    fn in_plane<'a>(
        &'a self,
        name: &'static str,
        uses: Uses,
        method: impl Fn(&[Reading]) -> Option<RadioFix> + Send + Sync + 'a,
    ) -> Contestant<'a> {
        let fix = move |readings: &[Reading]| {
            let floor = self.nearest_floor(readings, uses).unwrap_or_default();
            Some(PlaceFix { fix: method(readings)?, floor, floor_share: 1.0 })
        };
        Contestant { name, uses, fix: Box::new(fix) }
    }
}

/// The strongest of those heard.
fn strongest<'a>(heard: &[Heard<'a>], count: usize) -> Vec<Heard<'a>> {
    let mut sorted = heard.to_vec();
    sorted.sort_by(|a, b| b.rssi_dbm.total_cmp(&a.rssi_dbm));
    sorted.truncate(count);
    sorted
}

/// A transmitter whose place is not known is expected everywhere alike: it tells nothing.
fn map_of(lattice: Lattice, fit: &PathLossFit, sites: &[Option<Site>], height_m: f64) -> Option<RadioMap> {
    let emitters: Vec<(Emitter, Option<i32>)> = fit
        .emitters
        .iter()
        .zip(sites)
        .map(|(emitter, site)| (emitter.unwrap_or(NOWHERE), site.and_then(|site| site.floor)))
        .collect();
    RadioMap::of_emitters(lattice, &emitters, height_m, &fit.storeys, &fit.hearing)
}

fn range_map_of(
    lattice: Lattice,
    fit: &RangesFit,
    sites: &[Option<Site>],
    height_m: f64,
) -> Option<RadioMap> {
    let unknown = RangeModel { offset_m: 0.0, scale: 1.0, sigma_m: 1e6 };
    let device = |(model, site): (&Option<RangeModel>, &Option<Site>)| {
        (site.map_or(NOWHERE.position_m, |site| site.position_m), model.unwrap_or(unknown))
    };
    let devices: Vec<_> = fit.models.iter().zip(sites).map(device).collect();
    RadioMap::of_ranges(lattice, &devices, height_m)
}

/// So far away that it is the same from everywhere.
const NOWHERE: Emitter = Emitter {
    position_m: adit_core::nalgebra::Vector3::new(0.0, 0.0, 1e6),
    path_loss: adit_estimation::radio::PathLoss {
        rssi_at_1m_dbm: 0.0,
        exponent: 2.0,
        breakpoint_m: None,
        exponent_beyond: None,
    },
    sigma_db: 100.0,
};

/// Where people may be: around the spots of surveys; over all the extent of walks and transmitters, since a walk shows
/// where one person went.
pub fn lattice(data: &RadioData, sites: &[Option<Site>]) -> Result<Lattice> {
    let spots = data.spots();
    if !walks(data) {
        return lattice_around(&spots).context("the spots of the survey are too far apart for a map");
    }
    let devices = sites.iter().flatten().map(|site| site.position_m.xy());
    let all: Vec<Vector2<f64>> = spots.iter().map(|(place, _)| *place).chain(devices).collect();
    let first = all.first().copied().unwrap_or_default();
    let low = all.iter().fold(first, |low, place| low.inf(place)).add_scalar(-MARGIN_M);
    let high = all.iter().fold(first, |high, place| high.sup(place)).add_scalar(MARGIN_M);
    Lattice::within(&low, &high, WALK_STEP_M).with_context(|| {
        format!("the walks and transmitters extend over {:.0} by {:.0} m", high.x - low.x, high.y - low.y)
    })
}
