//! Walks along the roadways of a mine, and what a tag makes of them: dead reckoning that errs as a foot's or a belt's does.
//!
//! A walker goes from node to node at random, turns back now and then, keeps to one side and wanders across, and cuts corners: the centre line, moved to the side, averaged over
//! two metres. Nothing of the bank is used.
#![allow(dead_code, reason = "every program uses its own part")]
#![expect(clippy::cast_possible_truncation, reason = "small counts")]
#![expect(clippy::cast_sign_loss, reason = "counts")]

use adit_core::nalgebra::{Vector2, Vector3};
use adit_estimation::place::state::{
    BAROMETER, COMMON, DRIFT, EAST, FACTOR, HEADING, HeadingError, NORTH, State, Stretch, TURN, UP, Vector,
};
use adit_mine::Mine;
use adit_mine::network::{EdgeId, NodeId};
use adit_mine::plan::RoadwayKind;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// Places of a way are this far apart, m.
const GRAIN_M: f64 = 0.1;
/// Half of the length over which corners are rounded, m.
const ROUND_M: f64 = 1.0;

/// How a walker walks.
#[derive(Clone, Copy)]
pub struct Walker {
    pub speed_m_s: f64,
    pub keep_right_m: f64,
    pub wander_m: f64,
    /// Chance to turn back in a roadway instead of going on.
    pub turns_back: f64,
    /// Chance to go straight on at a junction whatever else there is.
    pub goes_on: f64,
    /// Seconds between two places.
    pub interval_s: f64,
}

impl Default for Walker {
    fn default() -> Self {
        Self {
            speed_m_s: 1.3,
            keep_right_m: 0.8,
            wander_m: 0.3,
            turns_back: 0.05,
            goes_on: 0.0,
            interval_s: 0.5,
        }
    }
}

/// How a carrier errs: standard deviations over walkers, and what goes on along the way.
#[derive(Clone, Copy)]
pub struct Carrier {
    pub drift_rad_s: f64,
    pub heading_walk_rad_sqrt_s: f64,
    pub factor: f64,
    pub factor_walk_sqrt_m: f64,
    /// White, of the length of each place's way, for √m.
    pub along_sqrt_m: f64,
    pub across_sqrt_m: f64,
    pub up_sqrt_m: f64,
    /// The way has a height.
    pub climbs: bool,
    pub start_m: f64,
    pub start_heading_rad: f64,
    pub tag_height_m: f64,
}

pub const DEGREE: f64 = core::f64::consts::PI / 180.0;

impl Carrier {
    /// A strapdown on a foot.
    pub fn foot() -> Self {
        Self {
            drift_rad_s: 0.3 * DEGREE / 60.0,
            heading_walk_rad_sqrt_s: 0.5 * DEGREE / 60.0_f64.sqrt(),
            factor: 0.01,
            factor_walk_sqrt_m: 0.0001,
            along_sqrt_m: 0.01,
            across_sqrt_m: 0.01,
            up_sqrt_m: 0.02,
            climbs: true,
            start_m: 0.5,
            start_heading_rad: 2.0 * DEGREE,
            tag_height_m: 0.1,
        }
    }

    /// One that drifts and has a scale error.
    pub fn poor_foot() -> Self {
        Self {
            drift_rad_s: DEGREE / 60.0,
            heading_walk_rad_sqrt_s: DEGREE / 60.0_f64.sqrt(),
            factor: 0.03,
            ..Self::foot()
        }
    }

    /// Somebody of unknown step length with a poor gyro.
    pub fn poor_waist() -> Self {
        Self {
            drift_rad_s: 2.0 * DEGREE / 60.0,
            heading_walk_rad_sqrt_s: 4.0 * DEGREE / 60.0_f64.sqrt(),
            factor: 0.10,
            factor_walk_sqrt_m: 0.003,
            ..Self::waist()
        }
    }

    /// Steps at a belt.
    pub fn waist() -> Self {
        Self {
            drift_rad_s: DEGREE / 60.0,
            heading_walk_rad_sqrt_s: 2.0 * DEGREE / 60.0_f64.sqrt(),
            factor: 0.07,
            factor_walk_sqrt_m: 0.001,
            along_sqrt_m: 0.05,
            across_sqrt_m: 0.05,
            up_sqrt_m: 0.05,
            climbs: false,
            start_m: 1.0,
            start_heading_rad: 4.0 * DEGREE,
            tag_height_m: 1.0,
        }
    }
}

/// Seeded draws.
pub struct Draw(ChaCha8Rng);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// 0 to 1.
    pub fn share(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn below(&mut self, count: usize) -> usize {
        ((self.share() * count as f64) as usize).min(count - 1)
    }
}

fn walkable(mine: &Mine, edge: EdgeId) -> bool {
    mine.network()
        .edge(edge)
        .is_some_and(|edge| edge.walkable && mine.plan().roadways[edge.roadway].kind != RoadwayKind::Shaft)
}

/// Centre line and half width of a random way of at least `length_m`, from one of the nodes at `starts`.
pub fn random_route(
    mine: &Mine,
    draw: &mut Draw,
    walker: &Walker,
    start: NodeId,
    length_m: f64,
) -> Vec<(Vector3<f64>, f64)> {
    let network = mine.network();
    let mut node = start;
    let mut route: Vec<(Vector3<f64>, f64)> = Vec::new();
    let (mut walked_m, mut last) = (0.0, None);
    while walked_m < length_m {
        let ways: Vec<EdgeId> = network.edges_at(node).into_iter().filter(|e| walkable(mine, *e)).collect();
        let onward: Vec<EdgeId> = ways.iter().copied().filter(|e| Some(*e) != last).collect();
        let choice = if onward.is_empty() { &ways } else { &onward };
        let mut id = choice[draw.below(choice.len())];
        if draw.share() < walker.goes_on
            && let Some(last) = last
            && let Some(ahead) = straightest(mine, node, last, &onward)
        {
            id = ahead;
        }
        let edge = network.edge(id).unwrap();
        let half_m = 0.5 * mine.plan().roadways[edge.roadway].width_m;
        let mut points: Vec<Vector3<f64>> = edge.points_m().map(|p| *p.raw()).collect();
        let forwards = edge.from == node;
        if !forwards {
            points.reverse();
        }
        let far = if forwards { edge.to } else { edge.from };
        // At a face nobody walks into the rock.
        let face = network.edges_at(far).into_iter().filter(|e| walkable(mine, *e)).count() == 1;
        let back = draw.share() < walker.turns_back;
        let mut end_m = edge.length_m() - if face { 1.5 } else { 0.0 };
        if back {
            end_m *= 0.2 + 0.6 * draw.share();
        }
        let there = cut(&points, end_m);
        walked_m += end_m;
        let (mut leg, turned) = (there.clone(), back);
        if turned {
            leg.extend(there.iter().rev().skip(1));
            walked_m += end_m;
        } else {
            node = far;
        }
        last = Some(id);
        route.extend(leg.into_iter().map(|p| (p, half_m)));
    }
    route
}

/// The way that leads on most nearly straight, where one does within 35°.
fn straightest(mine: &Mine, node: NodeId, last: EdgeId, ways: &[EdgeId]) -> Option<EdgeId> {
    let network = mine.network();
    let away = |id: EdgeId| {
        let edge = network.edge(id).unwrap();
        let forwards = edge.from == node;
        let run =
            if forwards { *edge.direction_at(0.0).raw() } else { -*edge.direction_at(edge.length_m()).raw() };
        run.xy().normalize()
    };
    let ahead = -away(last);
    let best = ways.iter().max_by(|a, b| ahead.dot(&away(**a)).total_cmp(&ahead.dot(&away(**b))))?;
    (ahead.dot(&away(*best)) > 0.82).then_some(*best)
}

fn cut(points: &[Vector3<f64>], end_m: f64) -> Vec<Vector3<f64>> {
    let mut kept = vec![points[0]];
    let mut left_m = end_m;
    for pair in points.windows(2) {
        let length_m = (pair[1] - pair[0]).norm();
        let share = (left_m / length_m).min(1.0);
        if share > 0.0 {
            kept.push(pair[0] + (pair[1] - pair[0]) * share);
        }
        left_m -= length_m;
        if left_m <= 0.0 {
            break;
        }
    }
    kept
}

/// Places of somebody who walks a route, one every `interval_s`; on the floor.
pub fn places(route: &[(Vector3<f64>, f64)], walker: &Walker, draw: &mut Draw) -> Vec<Vector3<f64>> {
    let phases = [draw.share(), draw.share()].map(|share| share * core::f64::consts::TAU);
    let mut line: Vec<Vector3<f64>> = Vec::new();
    let mut along_m = 0.0;
    for pair in route.windows(2) {
        let ((a, _), (b, half_m)) = (pair[0], pair[1]);
        let run = (b - a).xy().norm();
        if run < 1e-6 {
            continue;
        }
        let d = (b - a) / run;
        let right = Vector3::new(d.y, -d.x, 0.0);
        let count = (run / GRAIN_M).ceil();
        for i in 0..count as usize {
            let off = run * i as f64 / count;
            let s = along_m + off;
            let wander = 0.5
                * walker.wander_m
                * ((s / 19.0 * core::f64::consts::TAU + phases[0]).sin()
                    + (s / 47.0 * core::f64::consts::TAU + phases[1]).sin());
            let aside = (walker.keep_right_m + wander).clamp(0.4 - half_m, half_m - 0.4);
            line.push(a + d * off + right * aside);
        }
        along_m += run;
    }
    let half = (ROUND_M / GRAIN_M) as usize;
    let smooth: Vec<Vector3<f64>> = (0..line.len())
        .map(|i| {
            let room = half.min(i).min(line.len() - 1 - i);
            let part = &line[i - room..=i + room];
            let mean = part.iter().sum::<Vector3<f64>>() / part.len() as f64;
            Vector3::new(mean.x, mean.y, mean.z)
        })
        .collect();
    let step_m = walker.speed_m_s * walker.interval_s;
    let mut out = vec![smooth[0]];
    let mut here = smooth[0];
    for p in smooth {
        if (p - here).norm() >= step_m {
            out.push(p);
            here = p;
        }
    }
    out
}

/// What a carrier says of a way, and the state that it starts with.
pub struct Reckoned {
    pub start: State,
    pub stretches: Vec<Stretch>,
}

pub fn reckon(places: &[Vector3<f64>], walker: &Walker, carrier: &Carrier, draw: &mut Draw) -> Reckoned {
    let dt = walker.interval_s;
    let mut sigmas = Vector::zeros();
    (sigmas[EAST], sigmas[NORTH], sigmas[UP]) = (carrier.start_m, carrier.start_m, carrier.start_m);
    sigmas[TURN] = carrier.start_heading_rad;
    sigmas[DRIFT] = carrier.drift_rad_s;
    sigmas[FACTOR] = carrier.factor;
    (sigmas[BAROMETER], sigmas[COMMON], sigmas[HEADING]) = (1.0, 1.0, 0.0);
    let mut start = State::new(&sigmas.component_mul(&sigmas));
    start.position_m = places[0] + Vector3::new(0.0, 0.0, carrier.tag_height_m);
    for axis in 0..3 {
        start.position_m[axis] += draw.normal() * carrier.start_m;
    }
    // The truth: the carrier's frame is turned by this, its heading errs by a drift and a walk, its lengths by a factor.
    let mut turn = draw.normal() * carrier.start_heading_rad;
    let drift = draw.normal() * carrier.drift_rad_s;
    let mut factor = 1.0 + draw.normal() * carrier.factor;
    let mut stretches = Vec::new();
    for pair in places.windows(2) {
        let moved = pair[1] - pair[0];
        let length = moved.xy().norm();
        let root = length.sqrt();
        let (sin, cos) = turn.sin_cos();
        let along = moved.xy() / length.max(1e-9);
        let noisy = moved.xy()
            + along * (draw.normal() * carrier.along_sqrt_m * root)
            + Vector2::new(-along.y, along.x) * (draw.normal() * carrier.across_sqrt_m * root);
        // The inverse of what the state does.
        let level = Vector2::new(cos * noisy.x - sin * noisy.y, sin * noisy.x + cos * noisy.y) / factor;
        let up = if carrier.climbs { moved.z + draw.normal() * carrier.up_sqrt_m * root } else { 0.0 };
        stretches.push(Stretch {
            way_m: level.push(up),
            drifting: dt,
            along_m2: (carrier.along_sqrt_m * root).powi(2),
            across_m2: (carrier.across_sqrt_m * root).powi(2),
            up_m2: (carrier.up_sqrt_m * root).powi(2),
            about_m2: 0.0,
            heading: HeadingError::Gyro { walk_rad2: carrier.heading_walk_rad_sqrt_s.powi(2) * dt },
            turn_rad2: 0.0,
            factor2: carrier.factor_walk_sqrt_m.powi(2) * length,
            turned_rad: 0.0,
            drift2: 0.0,
            iron_rad2: 0.0,
            barometer_m2: 0.0,
        });
        turn += drift * dt + draw.normal() * carrier.heading_walk_rad_sqrt_s * dt.sqrt();
        factor += draw.normal() * carrier.factor_walk_sqrt_m * root;
    }
    Reckoned { start, stretches }
}
