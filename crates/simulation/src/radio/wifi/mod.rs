//! Signal strengths: what a tag hears of access points and beacons.
//!
//! `rssi = mean(d) − bends − doors − bodies + shadowing(x) + fading(x, t) + noise`, told in whole steps, heard with a probability that grows
//! with the margin over the receiver's sensitivity.
//!
//! | term | model | source |
//! |---|---|---|
//! | mean | `P₁ − 10 n log₁₀ d`, from the breakpoint on with another n; P₁, n, breakpoint by the mine's file, else by [`RssiSpec`], with P₁ = power − free-space loss at 1 m | Hrovat, Kandus & Javornik 2014 (two slopes in tunnels) |
//! | bends | the less of diffraction at the corner (ITU-R P.526) and `L (1 − cos θ)` per bend | module `paths` |
//! | bodies, vehicles, pillars | knife edges | module `screen` |
//! | shadowing | normal in dB, exponential correlation in space, fixed per transmitter and seed | Gudmundson 1991 |
//! | fading | Rician in sight, Rayleigh round corners and behind obstacles; waves of one wavelength, slow drift | Clarke 1968; Boutin et al. 2008 (Rice and Rayleigh in mines) |
//! | noise | normal; near a running conveyor a Student t with 3 degrees of freedom on top, falling off with the distance from the belt | ours |
//! | heard | `(1 − missed) / (1 + exp(−(rssi − sensitivity)/spread))` | ours |

pub mod spec;

use super::keyed::{normal, uniform};
use super::scene::{Antenna, Surroundings, wearer};
use super::tag::Tag;
use super::world::{RadioWorld, TransmitterSite};
use adit_core::time::Time;
use adit_observation::{Radio, SignalStrength};
use rand_chacha::ChaCha8Rng;
use spec::RssiSpec;

/// Closer than this is as near, m: antennas are no points.
const NEAREST_M: f64 = 0.5;

impl Tag {
    /// Scans once, at `time_s` after the start; appends what it hears, transmitters in the order of the mine's file.
    pub fn scan(
        &mut self,
        world: &RadioWorld,
        time_s: f64,
        antenna: &Antenna,
        around: &Surroundings<'_>,
        out: &mut Vec<SignalStrength>,
    ) {
        let Some(time) = Time::from_seconds(time_s) else { return };
        self.look_around(antenna, around);
        let here = antenna.position_m;
        let trunk = wearer(antenna, &world.spec().body);
        let field = world.transmitter_field();
        let belt_m = world.belt_distance_m(&here, around);
        let paths = self.transmitter_paths.at(world, field, &here);
        for path in paths {
            let number = path.device as usize;
            let (Some(site), Some(place)) = (world.transmitters.get(number), field.places_m.get(number))
            else {
                continue;
            };
            if site.dead.dead_at(time_s) {
                continue;
            }
            let spec = if site.radio == Radio::Ble { &world.spec().ble } else { &world.spec().wifi };
            let length_m = path.length_m(place, &here);
            if length_m > spec.most_way_m {
                continue;
            }
            let wavelength_m = spec.wavelength_m();
            let in_the_way =
                world.in_the_way(&here, &path.last_m(place), trunk.as_ref(), &self.near, wavelength_m);
            let straight_m = (place - here).norm();
            let lost_db = path.bends_db(length_m - straight_m, wavelength_m, spec.corner_loss_db)
                + path.doors_db
                + in_the_way.detour.loss_db;
            let off = here - place;
            let in_sight = path.around.is_none() && !in_the_way.detour.blocked;
            let k = if in_sight { libm::pow(10.0, 0.1 * spec.rician_k_db) } else { 0.0 };
            let local_db = spec.shadowing_sigma_db * site.shadow.at(&off)
                + site.fading.gain_db(&off, time_s, k, spec.drift_hz);
            let rng = &mut self.scan_rng;
            let mean_dbm = site.mean_dbm(spec, length_m) - lost_db + local_db;
            let rssi_dbm = mean_dbm + spec.noise(belt_m, rng);
            if uniform(rng) < spec.heard(rssi_dbm) {
                let rssi_dbm = spec.told(rssi_dbm);
                out.push(SignalStrength { time, transmitter: site.id.clone(), rssi_dbm, radio: site.radio });
            }
        }
    }
}

impl TransmitterSite {
    /// Mean over a way without anything in between, dBm.
    fn mean_dbm(&self, spec: &RssiSpec, way_m: f64) -> f64 {
        let Some(loss) = self.path_loss else {
            let free_db = 20.0 * libm::log10(4.0 * core::f64::consts::PI / spec.wavelength_m());
            let at_1m_dbm = self.tx_power_dbm - free_db;
            return two_slopes_dbm(at_1m_dbm, spec.exponent, spec.breakpoint_m, spec.exponent_beyond, way_m);
        };
        let breakpoint_m = loss.breakpoint_m.unwrap_or(f64::INFINITY);
        let beyond = loss.exponent_beyond.unwrap_or(loss.exponent);
        two_slopes_dbm(loss.rssi_at_1m_dbm, loss.exponent, breakpoint_m, beyond, way_m)
    }
}

/// Mean signal strength over a distance with two slopes, dBm.
pub(crate) fn two_slopes_dbm(at_1m_dbm: f64, near: f64, breakpoint_m: f64, beyond: f64, way_m: f64) -> f64 {
    let way_m = way_m.max(NEAREST_M);
    let first = way_m.min(breakpoint_m);
    at_1m_dbm - 10.0 * near * libm::log10(first) - 10.0 * beyond * libm::log10(way_m / first)
}

impl RssiSpec {
    fn noise(&self, belt_m: Option<f64>, rng: &mut ChaCha8Rng) -> f64 {
        let white = self.noise_db * normal(rng);
        let Some(belt_m) = belt_m else { return white };
        // Student t of 3 degrees of freedom: normal over the root of a mean of three squares.
        let squares: f64 = (0..3).map(|_| libm::pow(normal(rng), 2.0)).sum();
        let heavy = normal(rng) / libm::sqrt((squares / 3.0).max(1e-6));
        white + self.conveyor_noise_db * libm::exp(-belt_m / self.conveyor_reach_m) * heavy
    }

    /// Probability that a beacon of this strength is heard.
    fn heard(&self, rssi_dbm: f64) -> f64 {
        let margin = (rssi_dbm - self.sensitivity_dbm) / self.sensitivity_spread_db;
        (1.0 - self.missed) / (1.0 + libm::exp(-margin))
    }

    fn told(&self, rssi_dbm: f64) -> f64 {
        if self.step_db > 0.0 { libm::round(rssi_dbm / self.step_db) * self.step_db } else { rssi_dbm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radio::keyed::Key;

    #[test]
    fn the_two_slopes_meet_at_the_breakpoint() {
        let at = |d| two_slopes_dbm(-40.0, 2.0, 30.0, 1.5, d);
        assert!((at(10.0) + 60.0).abs() < 1e-12);
        assert!((at(30.0) - (-40.0 - 20.0 * 30.0_f64.log10())).abs() < 1e-12);
        assert!((at(300.0) - at(30.0) + 15.0).abs() < 1e-12);
        assert!((at(0.0) - at(NEAREST_M)).abs() < 1e-12);
    }

    #[test]
    fn a_running_belt_makes_noise_with_heavy_tails_near_it_only() {
        let spec = RssiSpec::wifi();
        let mut rng = Key::new(1, 1).stream();
        let mut share_beyond = |belt_m: Option<f64>| {
            let far = (0..20_000).filter(|_| spec.noise(belt_m, &mut rng).abs() > 5.0).count();
            far as f64 / 20_000.0
        };
        // |normal| of σ = 1 dB beyond 5 dB: 6e-7; t₃ scaled by 2.5 beyond 2 scales: 0.139, widened a little by the white part.
        assert!(share_beyond(None) < 1e-3);
        assert!(share_beyond(Some(100.0)) < 1e-3);
        let near = share_beyond(Some(0.0));
        assert!((near - 0.155).abs() < 0.03, "{near}");
    }

    #[test]
    fn half_of_the_beacons_at_the_sensitivity_are_heard() {
        let spec = RssiSpec { missed: 0.1, ..RssiSpec::wifi() };
        assert!((spec.heard(spec.sensitivity_dbm) - 0.45).abs() < 1e-12);
        assert!((spec.heard(0.0) - 0.9).abs() < 1e-9);
        assert!(spec.heard(-130.0) < 1e-9);
        assert!((spec.told(-61.6) + 62.0).abs() < 1e-12);
    }
}
