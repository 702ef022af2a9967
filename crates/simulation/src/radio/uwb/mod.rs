//! UWB two-way ranging: which anchors answer, what their signals look like, what the ranges become.
//!
//! For each anchor in reach, strongest first: power budget → channel (direct path and echoes) → a DW1000's accumulator → its
//! leading-edge detection → range. The error of a range is that of the detection on its own channel:
//!
//! `range = way + c·lateness + offset + bias(power) + noise`, `way` = straight distance or the shortest way round,
//!
//! so that blocked links are long because their first path is late, weak or missed. Powers, dBm and dB:
//!
//! * free direct path `P_t + G − 20 log₁₀(4πd₀/λ) − 10 n log₁₀(d/d₀) + shadowing`, d₀ = 1 m;
//! * direct path: less by what blocks it (module `screen`) and by bends and doors (module `paths`);
//! * echoes: [`MultipathSpec::echoes_db`](spec::MultipathSpec::echoes_db) over the free direct path, less by bends and doors and by a share of
//!   what blocks ([`MultipathSpec::blocked_echo_loss`](spec::MultipathSpec::blocked_echo_loss)).
//!
//! Two-way ranging has a reception at either end; both see the same channel, so the error is that of one reception, the one
//! that is told. Its clocks' error is in [`UwbSpec::noise_m`](spec::UwbSpec::noise_m).

pub(crate) mod echoes;
pub(crate) mod pulse;
pub(crate) mod receiver;
pub mod spec;

use super::LIGHT_M_PER_NS;
use super::keyed::{exponential, normal, uniform};
use super::paths::Path;
use super::scene::{Antenna, Surroundings, wearer};
use super::tag::Tag;
use super::world::{AnchorSite, Purpose, RadioWorld, Standing};
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::{ImpulseResponse, InTheWay, Radio, RangeSample};
use receiver::{Channel, DIRECT_TAP, Receiver, TAPS};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How much a range tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RangeDetail {
    /// The range alone.
    #[default]
    Range,
    /// Powers, first path, noise.
    Diagnostics,
    /// All that and the channel impulse response.
    ImpulseResponse,
}

/// How the signal came.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LinkClass {
    /// Nothing in the way.
    Los,
    /// Something in the way; the direct path was found nevertheless.
    Nlos,
    /// No direct path: rock in the way, or what bent round the obstacle was too weak to be found.
    Ndp,
}

/// The truth of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeTruth {
    /// Straight distance, m.
    pub distance_m: f64,
    /// Length of the shortest way inside the openings, m.
    pub way_m: f64,
    /// How the signal came.
    pub class: LinkClass,
    /// Power as it arrives, dBm: what a receiver without limits would tell.
    pub power_dbm: f64,
    /// What obstacles, bends and doors take from the direct path, dB.
    pub loss_db: f64,
    /// What stood in the way.
    pub blockers: Blockers,
}

/// What stands in the way of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Blockers {
    /// Rock.
    pub rock: bool,
    /// The wearer.
    pub wearer: bool,
    /// Other people.
    pub people: u8,
    /// Vehicles.
    pub vehicles: u8,
    /// Pillars of the mine's file that reach the roof.
    pub pillars: u8,
    /// Those that do not: machines.
    pub machines: u8,
    /// Closed doors.
    pub doors: u8,
}

impl RangeTruth {
    /// What stood in the way, by its shadow.
    pub fn in_the_way(&self) -> InTheWay {
        match self.class {
            _ if self.blockers.rock => InTheWay::Rock,
            LinkClass::Los => InTheWay::Nothing,
            _ if self.loss_db < InTheWay::DEEP_DB => InTheWay::Shallow,
            _ => InTheWay::Deep,
        }
    }
}

/// A range and its truth.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeOutcome {
    /// What the tag tells.
    pub sample: RangeSample,
    /// How it was.
    pub truth: RangeTruth,
}

/// An anchor that could answer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heard {
    path: Path,
    way_m: f64,
    direct_dbm: f64,
    echoes_dbm: f64,
    loss_db: f64,
    in_the_way: Standing,
}

impl Heard {
    fn power_dbm(&self) -> f64 {
        10.0 * libm::log10(libm::pow(10.0, 0.1 * self.direct_dbm) + libm::pow(10.0, 0.1 * self.echoes_dbm))
    }
}

impl Tag {
    /// Ranges to the anchors in reach, at `time_s` after the start; appends them, the strongest first.
    pub fn ranges(
        &mut self,
        world: &RadioWorld,
        time_s: f64,
        antenna: &Antenna,
        around: &Surroundings<'_>,
        out: &mut Vec<RangeOutcome>,
    ) {
        let Some(time) = Time::from_seconds(time_s) else { return };
        self.look_around(antenna, around);
        self.listen(world, time_s, antenna);
        let spec = &world.spec().uwb;
        let asked = spec.most_anchors.min(self.heard.len());
        for index in 0..asked {
            let heard = self.heard[index];
            let rng = &mut self.exchange_rng;
            let margin = (heard.power_dbm() - spec.sensitivity_dbm) / 1.0;
            let answered = uniform(rng) < (1.0 - spec.missed) / (1.0 + libm::exp(-margin));
            if let Some(anchor) = world.anchors.get(heard.path.device as usize)
                && answered
            {
                let outcome = self.exchange(world, time, antenna, anchor, &heard);
                out.extend(outcome);
            }
        }
    }

    /// Finds the anchors that could answer, the strongest first.
    fn listen(&mut self, world: &RadioWorld, time_s: f64, antenna: &Antenna) {
        let spec = &world.spec().uwb;
        let field = world.anchor_field();
        let here = antenna.position_m;
        let wavelength_m = spec.wavelength_m();
        let trunk = wearer(antenna, &world.spec().body);
        let at_1m_db = 20.0 * libm::log10(4.0 * core::f64::consts::PI / wavelength_m);
        self.heard.clear();
        for path in self.anchor_paths.at(world, field, &here) {
            let number = path.device as usize;
            let (Some(anchor), Some(place)) = (world.anchors.get(number), field.places_m.get(number)) else {
                continue;
            };
            let way_m = path.length_m(place, &here);
            let mean_dbm = anchor.tx_power_dbm + spec.antenna_gain_db
                - at_1m_db
                - 10.0 * spec.exponent * libm::log10(way_m.max(0.3));
            let excess_m = way_m - (place - here).norm();
            let always_db = path.bends_db(excess_m, wavelength_m, spec.corner_loss_db) + path.doors_db;
            // Far below what can be heard, whatever shadowing does.
            let best_dbm =
                mean_dbm + spec.multipath.echoes_db.max(0.0) + 4.0 * spec.shadowing_sigma_db - always_db;
            if best_dbm < spec.sensitivity_dbm - 3.0 || anchor.dead.dead_at(time_s) {
                continue;
            }
            let free_dbm = mean_dbm + spec.shadowing_sigma_db * anchor.shadow.at(&(here - place));
            let in_the_way =
                world.in_the_way(&here, &path.last_m(place), trunk.as_ref(), &self.near, wavelength_m);
            let blocked_db = in_the_way.detour.loss_db;
            let echoes = &spec.multipath;
            self.heard.push(Heard {
                path: *path,
                way_m,
                direct_dbm: free_dbm - always_db - blocked_db,
                loss_db: always_db + blocked_db,
                echoes_dbm: free_dbm + echoes.echoes_db
                    - always_db
                    - echoes.blocked_echo_loss * blocked_db.max(0.0),
                in_the_way,
            });
        }
        self.heard
            .sort_by(|a, b| b.power_dbm().total_cmp(&a.power_dbm()).then(a.path.device.cmp(&b.path.device)));
    }

    /// One exchange with an anchor that answers; `None` when no first path is found.
    fn exchange(
        &mut self,
        world: &RadioWorld,
        time: Time,
        antenna: &Antenna,
        anchor: &AnchorSite,
        heard: &Heard,
    ) -> Option<RangeOutcome> {
        let spec = &world.spec().uwb;
        let here = antenna.position_m;
        let obstructed =
            heard.path.around.is_some() || heard.in_the_way.detour.blocked || heard.path.doors > 0;
        let key = world.key(Purpose::Echoes);
        let around = self.echoes.at(key, heard.path.device, &here, &spec.multipath, spec.wavelength_m());
        let late_m = if obstructed { spec.obstruction_excess_m * around.lateness } else { 0.0 };
        let rng = &mut self.receiver_rng;
        // 2¹² words: some 700 normal draws need 1400 and a few for refusals.
        rng.set_word_pos(u128::from(self.receptions) << 12);
        self.receptions += 1;
        let fraction = uniform(rng);
        let mut channel: Channel = [[0.0; 2]; TAPS];
        fill(&mut channel, around.arrivals, heard, obstructed, [fraction, uniform(rng)]);
        let found = world.receiver.detect(&mut channel, rng)?;
        let late_taps = world.receiver.lateness_taps(&found, fraction);
        let reception = (self.detail != RangeDetail::Range).then(|| {
            let with_response = self.detail == RangeDetail::ImpulseResponse;
            Arc::new(world.receiver.reception(&found, &mut channel, rng, with_response))
        });
        let rng = &mut self.exchange_rng;
        let drawn = [normal(rng), uniform(rng), exponential(rng)];
        let outlier_m = if drawn[1] < spec.outliers { spec.outlier_mean_m * drawn[2] } else { 0.0 };
        let range_m = heard.way_m
            + heard.in_the_way.detour.excess_m
            + late_m
            + late_taps * ImpulseResponse::TAP_NS * LIGHT_M_PER_NS
            + anchor.offset_m
            + spec.power_bias * power_bias_m(found.power_dbm)
            + spec.noise_m * drawn[0]
            + outlier_m;
        let (rock, detour) = (heard.path.around.is_some(), heard.in_the_way.detour);
        Some(RangeOutcome {
            sample: RangeSample {
                time,
                anchor: anchor.id.clone(),
                tag: None,
                range_m,
                sigma_m: None,
                line_of_sight: None,
                in_the_way: None,
                radio: Radio::Uwb,
                reception,
            },
            truth: RangeTruth {
                distance_m: distance_m(world, heard, &here),
                way_m: heard.way_m + detour.excess_m,
                class: class(late_taps, rock, obstructed),
                power_dbm: found.power_dbm,
                loss_db: heard.loss_db,
                blockers: Blockers {
                    rock,
                    wearer: heard.in_the_way.wearer,
                    people: heard.in_the_way.people,
                    vehicles: heard.in_the_way.vehicles,
                    pillars: heard.in_the_way.pillars,
                    machines: heard.in_the_way.machines,
                    doors: heard.path.doors,
                },
            },
        })
    }
}

fn distance_m(world: &RadioWorld, heard: &Heard, here: &Vector3<f64>) -> f64 {
    let place = world.anchor_field().places_m.get(heard.path.device as usize).copied();
    place.map_or(heard.way_m, |place| (place - here).norm())
}

/// Direct path and echoes as amplitudes of one symbol.
fn fill(
    channel: &mut Channel,
    arrivals: &[echoes::Arrival],
    heard: &Heard,
    obstructed: bool,
    [fraction, phase]: [f64; 2],
) {
    let amplitude = |power_dbm: f64| libm::sqrt(Receiver::energy(power_dbm) / *pulse::ENERGY);
    #[expect(clippy::cast_possible_truncation, reason = "taps are single precision")]
    let (start, direct, echoes, [cos, sin]) = (
        (DIRECT_TAP as f64 + fraction) as f32,
        amplitude(heard.direct_dbm) as f32,
        amplitude(heard.echoes_dbm) as f32,
        echoes::turned(phase as f32),
    );
    pulse::add(channel, start, [direct * cos, direct * sin]);
    #[expect(clippy::cast_possible_truncation, reason = "taps are single precision")]
    let taps_per_ns = (1.0 / ImpulseResponse::TAP_NS) as f32;
    for arrival in arrivals {
        let [re, im] = if obstructed { arrival.blocked } else { arrival.clear };
        // The carrier's phase at the start of the exchange turns them all.
        let turned = [re * cos - im * sin, re * sin + im * cos].map(|v| echoes * v);
        pulse::add(channel, start + arrival.delay_ns * taps_per_ns, turned);
    }
}

/// A direct path that is found is found before its peak has passed.
fn class(late_taps: f64, rock: bool, obstructed: bool) -> LinkClass {
    match (rock, obstructed) {
        (true, _) => LinkClass::Ndp,
        (_, false) => LinkClass::Los,
        (_, true) if late_taps < MISSED_TAPS => LinkClass::Nlos,
        (_, true) => LinkClass::Ndp,
    }
}

/// From a clean path's crossing to a little past its peak, taps: a first path found later than this is another.
const MISSED_TAPS: f64 = 2.0;

/// By how much a DW1000 tells too much, m, by the power that arrives, dBm: Decawave APS011, table 2, 500 MHz, 64 MHz, −61 to −95 dBm in steps
/// of −2; straight lines in between.
fn power_bias_m(power_dbm: f64) -> f64 {
    const CM: [f64; 18] =
        [-11.0, -10.5, -10.0, -9.3, -8.2, -6.9, -5.1, -2.7, 0.0, 2.1, 3.5, 4.2, 4.9, 6.2, 7.1, 7.6, 8.1, 8.6];
    let step = ((-61.0 - power_dbm) / 2.0).clamp(0.0, 16.999);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the table")]
    let index = step as usize;
    let share = step - index as f64;
    0.01 * (CM[index] + share * (CM[index + 1] - CM[index]))
}

#[cfg(test)]
mod tests;
