//! Walks to places that are drawn, one after another: routes that no two seeds have in common.

use super::errands::{Pace, Planner};
use super::ground::Stand;
use super::posture::Manner;
use super::stretches::{Stretches, near};
use super::vibration::between;
use crate::error::{SimulationError, check_within};
use adit_mine::network::Travel;
use serde::{Deserialize, Serialize};

/// Places drawn before the nearest of them is taken, though it is out of reach.
const DRAWS: u32 = 50;

/// Walks about: to a place, perhaps a stop there, to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Roam {
    /// No way and no stop begins after this time of the simulation, s.
    pub until_s: f64,
    /// Ids of the levels on which places are drawn; empty: all. The way from one to the other leads where it is shortest.
    #[serde(default)]
    pub levels: Vec<String>,
    /// The next place is no farther than this by the way, m, if a few draws find one.
    #[serde(default = "anywhere")]
    pub reach_m: f64,
    /// Slowest and fastest way, as a share of the person's own speed; drawn for each.
    #[serde(default = "own_speed")]
    pub speed_share: [f64; 2],
    /// Share of the places at which they stop.
    #[serde(default = "half")]
    pub stop_share: f64,
    /// Shortest and longest stop, s.
    #[serde(default = "short_stops")]
    pub stop_s: [f64; 2],
    /// Share of the stops that is work; they stand at the others.
    #[serde(default = "half")]
    pub work_share: f64,
}

fn anywhere() -> f64 {
    f64::INFINITY
}

fn own_speed() -> [f64; 2] {
    [0.9, 1.1]
}

fn half() -> f64 {
    0.5
}

fn short_stops() -> [f64; 2] {
    [5.0, 45.0]
}

impl Roam {
    fn check(&self, body_m_s: f64) -> Result<(), SimulationError> {
        let Self { until_s, levels: _, reach_m, speed_share, stop_share, stop_s, work_share } = self;
        check_within("until_s", *until_s, 0.0, 1e6, "0 to 1e6 s")?;
        check_within("reach_m", *reach_m, 1.0, f64::INFINITY, "1 m or more")?;
        check_within("speed_share", speed_share[0], 0.3, 2.0, "0.3 to 2")?;
        check_within("speed_share", speed_share[1], speed_share[0], 2.0, "no less than the slowest, to 2")?;
        check_within("stop_share", *stop_share, 0.0, 1.0, "0 to 1")?;
        check_within("stop_s", stop_s[0], 1.0, 1e5, "1 to 1e5 s")?;
        check_within("stop_s", stop_s[1], stop_s[0], 1e5, "no less than the shortest, to 1e5 s")?;
        check_within("work_share", *work_share, 0.0, 1.0, "0 to 1")?;
        for share in speed_share {
            check_within("speed_share", share * body_m_s, 0.3, 3.2, "a walk of 0.3 to 3.2 m/s")?;
        }
        Ok(())
    }
}

/// Plans the walk of a person who stands somewhere.
pub(super) fn plan(planner: &mut Planner<'_>, roam: &Roam) -> Result<(), SimulationError> {
    let own_m_s = planner.body().walk_m_s;
    roam.check(own_m_s)?;
    let ground = planner.ground();
    ground.check_levels(&roam.levels)?;
    let wanted = |level: &str| roam.levels.is_empty() || roam.levels.iter().any(|wanted| wanted == level);
    let stretches = Stretches::new(ground, wanted);
    let nowhere = || {
        let expected = "levels with places that can be walked to";
        SimulationError::Unknown { name: "levels", found: roam.levels.join(", "), expected }
    };
    if stretches.edges().next().is_none() {
        return Err(nowhere());
    }
    while planner.now_s < roam.until_s {
        let before_s = planner.now_s;
        let goal = next(planner, &stretches, roam.reach_m).ok_or_else(nowhere)?;
        let share = between(planner.rng, roam.speed_share[0], roam.speed_share[1]);
        let body = planner.body().at_speed(Pace::Walk, share * own_m_s);
        planner.go_as(&body, &goal, Pace::Walk);
        let stops = between(planner.rng, 0.0, 1.0) < roam.stop_share;
        // A way of no length takes no time.
        if planner.now_s < roam.until_s && (stops || planner.now_s <= before_s) {
            let works = between(planner.rng, 0.0, 1.0) < roam.work_share;
            let manner = if works { Manner::Work } else { Manner::Stand };
            let stop_s = between(planner.rng, roam.stop_s[0], roam.stop_s[1]);
            planner.stay(stop_s, manner);
        }
    }
    Ok(())
}

/// The first place drawn that is within reach, else the nearest of those drawn; `None` when none can be walked to.
fn next(planner: &mut Planner<'_>, stretches: &Stretches, reach_m: f64) -> Option<Stand> {
    let ground = planner.ground();
    let mut nearest: Option<(f64, Stand)> = None;
    for _ in 0..DRAWS {
        let spot = stretches.draw(planner.rng)?;
        let stand = near(ground, &spot, 0.0, planner.rng);
        let Some(route) = ground.network.route(&planner.stand.spot, &stand.spot, Travel::OnFoot) else {
            continue;
        };
        if nearest.is_none_or(|(way_m, _)| route.length_m < way_m) {
            nearest = Some((route.length_m, stand));
        }
        if route.length_m <= reach_m {
            return Some(stand);
        }
    }
    nearest.map(|(_, stand)| stand)
}
