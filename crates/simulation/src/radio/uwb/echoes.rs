//! The echoes of a place: which rays come to it from an anchor, and how they change as the tag moves.
//!
//! Over a patch of [`MultipathSpec::patch_m`] an anchor's echoes are plane waves with delay, power, direction and phase of their own.
//! A step towards a ray shortens its way and turns its phase, so that a small movement changes the response coherently and a tag
//! that stands keeps it. The four patches around the tag are blended with weights whose squares sum to one (power stays).
//! Patches are drawn from a key of seed, anchor and cell: a second visit finds the same echoes.
//!
//! **Powers** (Saleh & Valenzuela 1987, eq. 25; Molisch et al. 2006, §III-D). In sight, with clusters at `T_l` (Poisson, rate Λ, the first at 0):
//! `Ω(τ) ∝ Σ_l 10^(M_l/10) exp(−T_l/Γ) exp(−(τ−T_l)/γ)`, `M_l` normal. Blocked (802.15.4a CM4, CM8):
//! `Ω(τ) ∝ (1 − χ exp(−τ/γ_rise)) exp(−τ/γ_1)`. Rays are Poisson in delay, amplitudes Nakagami, phases uniform.

use super::spec::MultipathSpec;
use crate::radio::LIGHT_M_PER_NS;
use crate::radio::keyed::{Draws, Key};
use adit_core::nalgebra::Vector3;
use core::f64::consts::{FRAC_PI_2, TAU};

/// Echoes later than this are noise, ns.
const LAST_NS: f64 = 110.0;
/// Anchors whose echoes a tag remembers.
const REMEMBERED: usize = 24;

/// One ray: amplitudes against the square root of the power of all echoes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    /// After the direct path, at the middle of the patch, ns.
    pub delay_ns: f32,
    /// Amplitude in sight.
    pub clear: f32,
    /// Amplitude on a blocked link.
    pub blocked: f32,
    /// How the way lengthens per metre of movement.
    direction: [f32; 3],
    /// Phase at the middle of the patch, turns.
    phase: f32,
}

/// The rays of one cell.
#[derive(Debug, Clone, Default)]
struct Patch {
    rays: Vec<Ray>,
    /// How far the first arrival of a blocked link comes late, in means.
    lateness: f32,
}

/// The four patches around a place.
#[derive(Debug, Clone)]
struct Around {
    anchor: u32,
    cell: [i64; 3],
    patches: [Patch; 4],
    used: u64,
}

/// A ray as it arrives at the tag.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrival {
    /// After the direct path, ns.
    pub delay_ns: f32,
    /// Complex amplitude against the square root of the echoes' power.
    pub clear: [f32; 2],
    /// The same on a blocked link.
    pub blocked: [f32; 2],
}

/// What a tag remembers of its surroundings; bounded.
#[derive(Debug, Clone, Default)]
pub(crate) struct Echoes {
    remembered: Vec<Around>,
    clock: u64,
    arrivals: Vec<Arrival>,
}

/// What the wearer's place gives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heard<'a> {
    pub arrivals: &'a [Arrival],
    /// How far a blocked first arrival comes late, in means.
    pub lateness: f64,
}

impl Echoes {
    /// The arrivals at a place from an anchor.
    pub fn at(
        &mut self,
        key: Key,
        anchor: u32,
        place_m: &Vector3<f64>,
        spec: &MultipathSpec,
        wavelength_m: f64,
    ) -> Heard<'_> {
        // Levels are apart by more than a patch; heights within one belong together.
        let scaled = Vector3::new(place_m.x, place_m.y, 0.2 * place_m.z) / spec.patch_m;
        let floor = scaled.map(libm::floor);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "coordinates of a mine over a patch of 0.1 m or more"
        )]
        let cell = [floor.x as i64, floor.y as i64, libm::round(scaled.z) as i64];
        let slot = self.slot(key, anchor, cell, spec);
        let share = [scaled.x - floor.x, scaled.y - floor.y].map(|f| {
            let (sin, cos) = libm::sincos(FRAC_PI_2 * f);
            [cos, sin]
        });
        self.arrivals.clear();
        let mut lateness = 0.0;
        for (number, patch) in self.remembered[slot].patches.iter().enumerate() {
            let (i, j) = (number % 2, number / 2);
            let weight = share[0][i] * share[1][j];
            lateness += weight * weight * f64::from(patch.lateness);
            let middle =
                Vector3::new(cell[0] as f64 + i as f64, cell[1] as f64 + j as f64, 0.0) * spec.patch_m;
            #[expect(clippy::cast_possible_truncation, reason = "metres within a patch")]
            let off = [place_m.x - middle.x, place_m.y - middle.y, 0.0].map(|v| v as f32);
            #[expect(clippy::cast_possible_truncation, reason = "rays are single precision")]
            let (weight, per_wave, per_light) =
                (weight as f32, 1.0 / wavelength_m as f32, 1.0 / LIGHT_M_PER_NS as f32);
            if weight < 1e-3 {
                continue;
            }
            self.arrivals.extend(patch.rays.iter().map(|ray| {
                let way_m: f32 = ray.direction.iter().zip(off).map(|(d, o)| d * o).sum();
                let [cos, sin] = turned(ray.phase - way_m * per_wave);
                let (clear, blocked) = (ray.clear * weight, ray.blocked * weight);
                Arrival {
                    delay_ns: (ray.delay_ns + way_m * per_light).max(0.3),
                    clear: [clear * cos, clear * sin],
                    blocked: [blocked * cos, blocked * sin],
                }
            }));
        }
        Heard { arrivals: &self.arrivals, lateness }
    }

    /// Where the patches of an anchor around a cell are remembered; made where they are not.
    fn slot(&mut self, key: Key, anchor: u32, cell: [i64; 3], spec: &MultipathSpec) -> usize {
        self.clock += 1;
        let known = self.remembered.iter().position(|a| a.anchor == anchor);
        let slot = if let Some(slot) = known {
            if self.remembered[slot].cell == cell {
                self.remembered[slot].used = self.clock;
                return slot;
            }
            slot
        } else if self.remembered.len() < REMEMBERED {
            self.remembered.push(Around { anchor, cell, patches: Default::default(), used: 0 });
            self.remembered.len() - 1
        } else {
            let oldest = self.remembered.iter().enumerate().min_by_key(|(_, around)| around.used);
            oldest.map_or(0, |(slot, _)| slot)
        };
        let around = &mut self.remembered[slot];
        around.anchor = anchor;
        around.cell = cell;
        around.used = self.clock;
        for (number, patch) in (0_i64..).zip(&mut around.patches) {
            let corner = key
                .with(u64::from(anchor))
                .with_cell(cell[0] + number % 2)
                .with_cell(cell[1] + number / 2)
                .with_cell(cell[2]);
            patch.fill(corner.draws(), spec);
        }
        slot
    }
}

impl Patch {
    fn fill(&mut self, mut draws: Draws, spec: &MultipathSpec) {
        self.rays.clear();
        #[expect(clippy::cast_possible_truncation, reason = "rays are single precision")]
        {
            self.lateness = draws.exponential() as f32;
        }
        let mut clusters = [(0.0, 1.0); 12];
        let mut count = 1;
        let spread = |draws: &mut Draws| libm::pow(10.0, 0.1 * spec.cluster_sigma_db * draws.normal());
        clusters[0].1 = spread(&mut draws);
        let mut start = 0.0;
        while spec.clusters_per_ns > 0.0 && count < clusters.len() {
            start += draws.exponential() / spec.clusters_per_ns;
            if start > LAST_NS {
                break;
            }
            clusters[count] = (start, libm::exp(-start / spec.cluster_decay_ns) * spread(&mut draws));
            count += 1;
        }
        let clear_power = |delay: f64| -> f64 {
            let heard = clusters[..count].iter().filter(|(start, _)| delay >= *start);
            heard.map(|(start, power)| power * libm::exp(-(delay - start) / spec.ray_decay_ns)).sum()
        };
        let blocked_power = |delay: f64| {
            (1.0 - spec.blocked_share * libm::exp(-delay / spec.blocked_rise_ns))
                * libm::exp(-delay / spec.blocked_decay_ns)
        };
        // One fall and rise of the whole patch, and the means, so that all rays together have power 1 on average.
        let shadow = libm::pow(10.0, 0.05 * spec.echoes_sigma_db * draws.normal());
        let (mut clear_sum, mut blocked_sum) = (0.0, 0.0);
        let mut delay = 0.0;
        loop {
            delay += draws.exponential() / spec.rays_per_ns;
            if delay > LAST_NS {
                break;
            }
            let (clear, blocked) = (clear_power(delay), blocked_power(delay));
            clear_sum += clear;
            blocked_sum += blocked;
            let fading = nakagami_power(&mut draws, spec.nakagami_m);
            self.rays.push(ray(&mut draws, delay, [clear * fading, blocked * fading]));
        }
        #[expect(clippy::cast_possible_truncation, reason = "rays are single precision")]
        let (clear, blocked) = (
            (shadow / libm::sqrt(clear_sum.max(1e-12))) as f32,
            (shadow / libm::sqrt(blocked_sum.max(1e-12))) as f32,
        );
        for ray in &mut self.rays {
            ray.clear *= clear;
            ray.blocked *= blocked;
        }
        let early = libm::pow(10.0, 0.1 * (spec.early_db - spec.echoes_db));
        let delay = 0.7 + spec.early_ns * draws.exponential();
        self.rays.push(ray(&mut draws, delay, [early, early]));
    }
}

fn ray(draws: &mut Draws, delay_ns: f64, [clear, blocked]: [f64; 2]) -> Ray {
    let (sin, cos) = libm::sincos(TAU * draws.uniform());
    #[expect(clippy::cast_possible_truncation, reason = "rays are single precision")]
    Ray {
        delay_ns: delay_ns as f32,
        clear: libm::sqrt(clear) as f32,
        blocked: libm::sqrt(blocked) as f32,
        direction: [cos as f32, sin as f32, 0.0],
        phase: draws.uniform() as f32,
    }
}

/// Power with mean 1 of an amplitude after Nakagami: gamma of shape m (Marsaglia & Tsang 2000; boosted below 1).
fn nakagami_power(draws: &mut Draws, m: f64) -> f64 {
    let shape = if m < 1.0 { m + 1.0 } else { m };
    let d = shape - 1.0 / 3.0;
    let c = 1.0 / libm::sqrt(9.0 * d);
    let mut value = d;
    // Refused in less than one of 20 draws: 16 refusals do not happen.
    for _ in 0..16 {
        let x = draws.normal();
        let v = 1.0 + c * x;
        let cube = v * v * v;
        if v > 0.0 && libm::log(1.0 - draws.uniform()) < 0.5 * x * x + d - d * cube + d * libm::log(cube) {
            value = d * cube;
            break;
        }
    }
    if m < 1.0 {
        value *= libm::pow(1.0 - draws.uniform(), 1.0 / m);
    }
    value / m
}

/// `(cos, sin)` of an angle in turns, to 2e-4: enough for a phase that is random anyway, and eight at a time.
pub(crate) fn turned(turns: f32) -> [f32; 2] {
    let wave = |turns: f32| {
        // Parabola through zeros and crests, bent once to the sine.
        let x = turns - (turns + 0.5).floor();
        let y = 8.0 * x - 16.0 * x * x.abs();
        y * 0.775 + 0.225 * y * y.abs()
    };
    [wave(turns + 0.25), wave(turns)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_sine_is_one() {
        for i in -500..500_i16 {
            let turns = f32::from(i) * 0.013;
            let (sin, cos) = f64::from(turns * core::f32::consts::TAU).sin_cos();
            let [c, s] = turned(turns).map(f64::from);
            assert!((c - cos).abs() < 1.2e-3 && (s - sin).abs() < 1.2e-3, "{turns}");
        }
    }

    #[test]
    fn nakagami_power_has_mean_one_and_variance_one_over_m() {
        for m in [0.5, 1.0, 3.0] {
            let mut draws = Key::new(4, 2).draws();
            let values: Vec<f64> = (0..40_000).map(|_| nakagami_power(&mut draws, m)).collect();
            let mean = values.iter().sum::<f64>() / 40_000.0;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 40_000.0;
            // Four standard errors of the mean: 4/√(40000 m); of the variance, from the fourth moment: below 0.1/m.
            assert!((mean - 1.0).abs() < 0.02 / m.sqrt(), "{m}: {mean}");
            assert!((variance * m - 1.0).abs() < 0.1, "{m}: {variance}");
        }
    }

    #[test]
    fn echoes_have_the_power_they_are_given_everywhere() {
        let spec = MultipathSpec { echoes_sigma_db: 0.0, early_db: -100.0, ..MultipathSpec::default() };
        let mut echoes = Echoes::default();
        let (mut clear, mut blocked) = (0.0, 0.0);
        let places = 4_000;
        for i in 0..places {
            let place = Vector3::new(f64::from(i) * 0.37, f64::from(i % 7) * 1.9, -3.0);
            let heard = echoes.at(Key::new(1, 1), 3, &place, &spec, 0.05);
            let power = |a: [f32; 2]| f64::from(a[0] * a[0] + a[1] * a[1]);
            clear += heard.arrivals.iter().map(|a| power(a.clear)).sum::<f64>();
            blocked += heard.arrivals.iter().map(|a| power(a.blocked)).sum::<f64>();
        }
        // Some 2000 independent patches of some ten rays that count, each with variance 1: 4 · √(1/20000) = 0.03; the quick sine
        // has no bias in power above 0.1 %.
        assert!((clear / f64::from(places) - 1.0).abs() < 0.04, "{}", clear / f64::from(places));
        assert!((blocked / f64::from(places) - 1.0).abs() < 0.04, "{}", blocked / f64::from(places));
    }

    #[test]
    fn a_second_visit_finds_the_same_echoes_and_a_small_step_nearly_the_same() {
        let spec = MultipathSpec::default();
        let response = |echoes: &mut Echoes, x: f64| {
            let heard = echoes.at(Key::new(1, 1), 3, &Vector3::new(x, 4.0, 0.0), &spec, 0.05);
            heard
                .arrivals
                .iter()
                .fold([0.0, 0.0], |sum: [f32; 2], a| [sum[0] + a.clear[0], sum[1] + a.clear[1]])
        };
        let apart = |a: [f32; 2], b: [f32; 2]| ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt();
        let mut echoes = Echoes::default();
        let first = response(&mut echoes, 10.0);
        for away in 0..100 {
            let _ = echoes.at(Key::new(1, 1), away, &Vector3::new(50.0, 4.0, 0.0), &spec, 0.05);
        }
        assert!(echoes.remembered.len() <= REMEMBERED);
        assert!(apart(first, response(&mut echoes, 10.0)) < 1e-9);
        // 1 mm is 1/50 of a wavelength: phases turn by 7° at most.
        assert!(apart(first, response(&mut echoes, 10.001)) < 0.15 * apart(first, [0.0, 0.0]).max(0.5));
        assert!(apart(first, response(&mut Echoes::default(), 10.0)) < 1e-9);
    }
}
