//! Draws what the adaptive stance detector sees of a simulated walk that turns into a run: `stance_figure OUT.svg`.
//!
//! Called by `ci/results.sh` for the page of `foot-ins`.

use adit_estimation::pedestrian::stance::{StanceDetector, StanceParams};
use adit_evaluation::plot::{TimeCurve, time_figure};
use adit_simulation::{FootWalkScenario, Gait, ImuErrorModel, Leg, STANDARD_GRAVITY_M_S2, generate};
use anyhow::{Context, Result};

/// What is drawn, s.
const SHOWN: std::ops::Range<f64> = 5.0..14.0;

fn main() -> Result<()> {
    let out = std::env::args().nth(1).context("usage: stance_figure OUT.svg")?;
    let straight = |length_m| Leg::Straight { length_m };
    let legs = vec![
        Leg::Stand { seconds: 3.0 },
        straight(9.0),
        Leg::Gait(Gait::run()),
        straight(14.0),
        Leg::Stand { seconds: 3.0 },
    ];
    let scenario = FootWalkScenario::new(Gait::restless_walk(), 0.0, legs);
    let mut detector = StanceDetector::new(StanceParams::default(), STANDARD_GRAVITY_M_S2);
    for (sample, _) in generate(&scenario, &ImuErrorModel::adis16448(), 1)? {
        detector.push(sample);
    }
    let (mut statistic, mut threshold, mut still) = (Vec::new(), Vec::new(), Vec::new());
    while let Some((sample, stance)) = detector.drain() {
        let time = sample.time.seconds();
        if SHOWN.contains(&time) {
            statistic.push((time, stance.statistic.log10()));
            threshold.push((time, stance.threshold.log10()));
            still.push((time, if stance.is_still() { -1.5 } else { -2.0 }));
        }
    }
    let curves = [
        TimeCurve { label: "statistic T".into(), points: statistic },
        TimeCurve { label: "threshold".into(), points: threshold },
        TimeCurve { label: "called still (raised)".into(), points: still },
    ];
    let figure = time_figure(&curves, "A walk turns into a run: the threshold follows", "log10 T")?;
    std::fs::write(&out, figure).with_context(|| out.clone())
}
