//! A shift, drawn: in by a portal, to places of work on foot or by vehicle, work with small moves and stops, a break, and out again.

use super::errands::{Pace, Planner};
use super::ground::{BODY_HALF_WIDTH_M, Ground, Stand};
use super::itinerary::Itinerary;
use super::posture::Manner;
use super::stretches::{Stretches, near};
use super::vibration::between;
use crate::error::{SimulationError, check_within};
use adit_mine::Mine;
use adit_mine::network::{Spot, Travel};
use adit_mine::plan::ZoneKind;
use serde::{Deserialize, Serialize};

/// Shares of the time at a place of work; only their ratios count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Shares {
    /// Work.
    pub work: f64,
    /// Stand.
    pub stand: f64,
    /// Walk about.
    pub walk: f64,
    /// Run.
    pub run: f64,
    /// Crawl.
    pub crawl: f64,
}

impl Default for Shares {
    fn default() -> Self {
        Self { work: 0.55, stand: 0.2, walk: 0.22, run: 0.01, crawl: 0.02 }
    }
}

/// What a shift is like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ShiftSpec {
    /// How long it lasts, s.
    pub duration_s: f64,
    /// Id of the portal zone where it begins and ends; drawn for each person when absent.
    pub portal: Option<String>,
    /// Ids of the levels with places of work; empty: all but those with a portal, if there are others.
    pub levels: Vec<String>,
    /// Places of work for each person.
    pub workplaces: u32,
    /// People come in over this time, s.
    pub spread_s: f64,
    /// Break in the middle, s.
    pub break_s: f64,
    /// Share of the ways that is ridden where that is shorter on foot.
    pub ride_share: f64,
    /// How far from their place of work they move about, m.
    pub reach_m: f64,
    /// Shortest and longest stretch of one activity, s.
    pub stretch_s: [f64; 2],
    /// What they do at work.
    pub shares: Shares,
}

impl Default for ShiftSpec {
    fn default() -> Self {
        Self {
            duration_s: 8.0 * 3600.0,
            portal: None,
            levels: Vec::new(),
            workplaces: 2,
            spread_s: 900.0,
            break_s: 1200.0,
            ride_share: 0.5,
            reach_m: 20.0,
            stretch_s: [15.0, 180.0],
            shares: Shares::default(),
        }
    }
}

impl ShiftSpec {
    /// The numbers are those of a shift.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("duration_s", self.duration_s, 1.0, 1e6, "1 to 1e6 s")?;
        check_within("workplaces", f64::from(self.workplaces), 1.0, 1000.0, "1 to 1000")?;
        check_within("spread_s", self.spread_s, 0.0, 1e6, "0 to 1e6 s")?;
        check_within("break_s", self.break_s, 0.0, 1e6, "0 to 1e6 s")?;
        check_within("ride_share", self.ride_share, 0.0, 1.0, "0 to 1")?;
        check_within("reach_m", self.reach_m, 1.0, 1000.0, "1 to 1000 m")?;
        check_within("stretch_s", self.stretch_s[0], 1.0, 1e5, "1 to 1e5 s")?;
        check_within(
            "stretch_s",
            self.stretch_s[1],
            self.stretch_s[0],
            1e5,
            "no less than the shortest, to 1e5 s",
        )?;
        let Shares { work, stand, walk, run, crawl } = self.shares;
        for (name, share) in
            [("work", work), ("stand", stand), ("walk", walk), ("run", run), ("crawl", crawl)]
        {
            check_within(name, share, 0.0, 1e6, "0 to 1e6")?;
        }
        check_within("shares", work + stand + walk + run + crawl, 1e-9, 1e7, "something above 0 in sum")
    }
}

/// Where shifts begin and where people work: found once for a mine.
#[derive(Debug, Clone)]
pub(super) struct Workings {
    portals: Vec<Spot>,
    /// Where places of work are.
    faces: Stretches,
}

impl Workings {
    pub fn new(mine: &Mine, ground: &Ground, spec: &ShiftSpec) -> Result<Self, SimulationError> {
        let plan = mine.plan();
        let zones = plan.zones.iter().filter(|zone| {
            spec.portal.as_ref().map_or(zone.kind == ZoneKind::Portal, |portal| *portal == zone.id)
        });
        let zones: Vec<_> = zones.collect();
        let wanted = |level: &str| {
            if spec.levels.is_empty() {
                let entry = zones.iter().any(|zone| zone.level == level);
                !entry || plan.levels.len() < 2
            } else {
                spec.levels.iter().any(|wanted| wanted == level)
            }
        };
        ground.check_levels(&spec.levels)?;
        let faces = Stretches::new(ground, wanted);
        let portals: Vec<Spot> = zones.iter().filter_map(|zone| ground.zone(&zone.id)).flatten().collect();
        // A portal counts from which some place of work can be walked to.
        let reached = |spot: &Spot| {
            faces.edges().any(|edge| {
                ground.network.route(spot, &Spot { edge, along_m: 0.0 }, Travel::OnFoot).is_some()
            })
        };
        let portals: Vec<Spot> = portals.into_iter().filter(reached).collect();
        if portals.is_empty() {
            let found = spec.portal.clone().unwrap_or_default();
            let expected = "a portal zone from which places of work can be walked to";
            return Err(SimulationError::Unknown { name: "portal", found, expected });
        }
        Ok(Self { portals, faces })
    }

    pub fn portal(&self, planner: &mut rand_chacha::ChaCha8Rng, ground: &Ground) -> Stand {
        let spot = self.portals[pick(planner, self.portals.len())];
        let room_m = ground.half_width_m(spot.edge) - BODY_HALF_WIDTH_M;
        Stand { spot, left_m: between(planner, -room_m, room_m) }
    }

    /// A place of work; where they stand when there is none.
    fn face(&self, planner: &mut Planner<'_>) -> Stand {
        let Some(spot) = self.faces.draw(planner.rng) else { return planner.stand };
        near(planner.ground(), &spot, 0.0, planner.rng)
    }
}

/// One of so many.
fn pick(rng: &mut rand_chacha::ChaCha8Rng, count: usize) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the count")]
    let index = between(rng, 0.0, count as f64) as usize;
    index.min(count.saturating_sub(1))
}

/// Plans a shift with a planner that stands at a portal.
pub(super) fn plan(mut planner: Planner<'_>, workings: &Workings, spec: &ShiftSpec) -> Itinerary {
    let portal = planner.stand;
    let wait_s = between(planner.rng, 5.0, 5.0 + spec.spread_s.min(0.2 * spec.duration_s));
    planner.stay(wait_s, Manner::Stand);
    let mut over = false;
    for place in 0..spec.workplaces {
        if over {
            break;
        }
        let face = workings.face(&mut planner);
        travel(&mut planner, &face, spec.ride_share);
        if place == spec.workplaces / 2 && place > 0 {
            planner.stay(spec.break_s.min(0.1 * spec.duration_s), Manner::Stand);
        }
        // Out in time: on foot, and as long again for waiting and turning.
        let home_s = 1.3 * walk_s(&planner, &portal) + 60.0;
        let leave_s = spec.duration_s - home_s;
        let left = f64::from(spec.workplaces - place);
        let until_s = planner.now_s + (leave_s - planner.now_s).max(0.0) / left;
        work(&mut planner, &face, spec, until_s);
        over = planner.now_s >= leave_s;
    }
    travel(&mut planner, &portal, spec.ride_share);
    let rest_s = spec.duration_s - 2.0 - planner.now_s;
    planner.stay(rest_s, Manner::Stand);
    planner.finish()
}

/// How long the way takes on foot, s.
fn walk_s(planner: &Planner<'_>, to: &Stand) -> f64 {
    let route = planner.ground().network.route(&planner.stand.spot, &to.spot, Travel::OnFoot);
    route.map_or(0.0, |route| route.length_m) / planner.body().walk_m_s
}

/// To a place, by vehicle where one shortens the walk by more than a third and the dice say so.
fn travel(planner: &mut Planner<'_>, to: &Stand, ride_share: f64) {
    let (goal, _) = planner.ground().place(to);
    let (here, _) = planner.ground().place(&planner.stand);
    if !planner.vehicles().is_empty() && between(planner.rng, 0.0, 1.0) < ride_share {
        let vehicle = pick(planner.rng, planner.vehicles().len());
        let stops = planner.vehicles()[vehicle].as_ref();
        if let (Some(on), Some(off)) = (stops.nearest_stop(&here), stops.nearest_stop(&goal)) {
            let on_foot = (goal - here).norm();
            let left = (stops.stop_m(on) - here).norm() + (stops.stop_m(off) - goal).norm();
            if left < 0.67 * on_foot {
                planner.ride(vehicle, off);
            }
        }
    }
    planner.go(to, Pace::Walk);
}

/// Works about a place until a time: the activity that lags most behind its share comes next.
fn work(planner: &mut Planner<'_>, face: &Stand, spec: &ShiftSpec, until_s: f64) {
    let Shares { work, stand, walk, run, crawl } = spec.shares;
    let shares = [work, stand, walk, run, crawl];
    let whole: f64 = shares.iter().sum();
    let mut spent = [0.0; 5];
    let start_s = planner.now_s;
    while planner.now_s < until_s {
        let stretch_s =
            between(planner.rng, spec.stretch_s[0], spec.stretch_s[1]).min(until_s - planner.now_s + 1.0);
        let total = planner.now_s - start_s + stretch_s;
        let lag = |kind: usize| total * shares[kind] / whole - spent[kind];
        let most = (0..5).max_by(|a, b| lag(*a).total_cmp(&lag(*b))).unwrap_or(0);
        let before_s = planner.now_s;
        match most {
            0 => planner.stay(stretch_s, Manner::Work),
            1 => planner.stay(stretch_s, Manner::Stand),
            going => {
                let pace = [Pace::Walk, Pace::Run, Pace::Crawl][going - 2];
                let goal = near(planner.ground(), &face.spot, spec.reach_m, planner.rng);
                if !planner.go(&goal, pace) || planner.now_s <= before_s {
                    planner.stay(5.0, Manner::Stand);
                }
            }
        }
        spent[most] += planner.now_s - before_s;
    }
}
