//! Draws how a plain gate locks itself out, and how ours does not: `gate_figure OUT.svg`.
//!
//! A drift with two anchors on its southern wall, in view from the start, and two on its northern one, behind a vehicle for 20 s. Somebody walks along
//! the northern wall; the start is told on the wrong side of the southern one, where the first two have the same ranges. Called by `ci/results.sh`
//! for the page of the filters; the test `a_plain_gate_locks_itself_out_and_ours_does_not` of `adit-estimation` runs the same for every weighting.

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::Time;
use adit_estimation::ranging::filter::gate::{GateKind, GateParams};
use adit_estimation::ranging::filter::weighting::Weighting;
use adit_estimation::ranging::filter::{FilterParams, HeightParams, RangeFilter};
use adit_estimation::ranging::listener::Link;
use adit_estimation::ranging::{RangeModel, Ranged};
use adit_evaluation::plot::{TimeCurve, time_figure};
use anyhow::{Context, Result};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const DRIFT: [[f64; 3]; 4] = [[0.0, 0.0, 2.0], [30.0, 0.0, 2.0], [15.0, 8.0, 2.4], [45.0, 8.0, 2.4]];
const NOISE_M: f64 = 0.05;
const BEHIND_S: f64 = 20.0;

fn truth(time_s: f64) -> Vector3<f64> {
    Vector3::new(4.0 + 0.5 * time_s, 6.0, 1.1)
}

/// Error over time of a filter with this gate, m.
fn errors(kind: GateKind) -> Result<Vec<(f64, f64)>> {
    let params = FilterParams {
        height: HeightParams { height_m: Some(1.1), sigma_m: 0.1, ..HeightParams::default() },
        gate: GateParams { kind, ..GateParams::default() },
        ..FilterParams::default()
    };
    let mut filter = RangeFilter::new(params, Weighting::default()).ok().context("usable settings")?;
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let image = truth(0.0).component_mul(&Vector3::new(1.0, -1.0, 1.0));
    filter.start_at(Time::ZERO, image, &(Matrix3::identity() * 0.25));
    let mut errors = Vec::new();
    for tick in 0..2400_u32 {
        let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
        if anchor >= 2 && time_s < BEHIND_S {
            continue;
        }
        let position_m = Vector3::from(DRIFT[anchor]);
        let noise: f64 = StandardNormal.sample(&mut random);
        let range_m = (truth(time_s) - position_m).norm() + NOISE_M * noise;
        let model = RangeModel { offset_m: 0.0, scale: 1.0, sigma_m: 0.08 };
        let time = Time::from_seconds(time_s).context("time")?;
        let ranged = Ranged { position_m, model, range_m };
        filter.observe(&Link { time, anchor, ranged, line_of_sight: None }, 0);
        let found = filter.solution().context("a solution")?.position_m;
        errors.push((time_s, (found - truth(time_s)).xy().norm()));
    }
    Ok(errors)
}

fn main() -> Result<()> {
    let out = std::env::args().nth(1).context("usage: gate_figure OUT.svg")?;
    let curves = [
        TimeCurve { label: "plain gate".into(), points: errors(GateKind::Plain)? },
        TimeCurve { label: "gate that watches and recovers".into(), points: errors(GateKind::Recovering)? },
    ];
    let figure =
        time_figure(&curves, "Begun on the wrong side of two anchors; two more from 20 s on", "error, m")?;
    std::fs::write(&out, figure).with_context(|| out.clone())
}
