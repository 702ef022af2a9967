//! A hall with a drift that turns away from it, drawn: pillars, machines, vehicles, people, anchors, radio.

use adit_core::frames::Position;
use adit_core::nalgebra::{Vector2, Vector3};
use adit_mine::Mine;
use adit_mine::plan::{Anchor, Chamber, Grid, Level, MinePlan, Pillar, Roadway, RoadwayKind};
use adit_simulation::radio::{Obstacle, RadioSpec, Shape};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Uniform};

/// Width of the drift, m.
const DRIFT_M: f64 = 4.0;

/// A room and all that is in it.
pub struct Room {
    pub mine: Mine,
    pub spec: RadioSpec,
    /// Length and width of the hall, m.
    hall_m: [f64; 2],
    /// Middles and half sizes of what stands in it.
    standing: Vec<[f64; 4]>,
    /// Corners of the drift's centre line.
    drift: [Vector2<f64>; 3],
    /// Height of the antenna over the floor, m.
    pub antenna_m: f64,
}

/// Draws.
pub struct Draw(pub ChaCha8Rng);

impl Draw {
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        Uniform::new(low, high).map_or(low, |u| u.sample(&mut self.0))
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }

    pub fn below(&mut self, count: u32) -> u32 {
        Uniform::new(0, count).map_or(0, |u| u.sample(&mut self.0))
    }
}

impl Room {
    pub fn draw(draw: &mut Draw) -> Self {
        let [length, width] = [draw.between(12.0, 36.0), draw.between(8.0, 22.0)];
        let roof = draw.between(2.8, 5.0);
        let mut plan = MinePlan::new("a room", Grid::Local {});
        plan.levels.push(Level { id: "l".into(), name: None, elevation_m: 0.0 });
        plan.chambers.push(Chamber {
            id: "hall".into(),
            name: None,
            floor_m: 0.0,
            height_m: roof,
            outline_m: vec![[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]],
        });
        let across = 0.5 * width;
        let (out, aside) = (length + draw.between(6.0, 15.0), draw.between(8.0, 18.0));
        let side = if draw.chance(0.5) { 1.0 } else { -1.0 };
        let drift = [
            Vector2::new(length - 2.0, across),
            Vector2::new(out, across),
            Vector2::new(out, across + side * aside),
        ];
        let roadway = |id: &str, points: &[Vector2<f64>]| Roadway {
            id: id.into(),
            name: None,
            level: Some("l".into()),
            kind: RoadwayKind::Drift,
            width_m: DRIFT_M,
            height_m: roof.min(3.5),
            max_slope_percent: None,
            walkable: true,
            points_m: points.iter().map(|p| Position::new(p.x, p.y, 0.0)).collect(),
        };
        plan.roadways.push(roadway("floor", &[Vector2::new(2.0, across), drift[0]]));
        plan.roadways.push(roadway("drift", &drift));
        let mut standing = Vec::new();
        for number in 0..draw.below(8) {
            let machine = draw.chance(0.5);
            let half = if machine {
                [draw.between(0.4, 2.0), draw.between(0.4, 1.5)]
            } else {
                [draw.between(0.4, 2.5), draw.between(0.4, 2.0)]
            };
            let middle = [draw.between(2.0, length - 4.0), draw.between(1.5, width - 1.5)];
            let height_m = machine.then(|| draw.between(1.2, 2.6));
            standing.push([middle[0], middle[1], half[0], half[1]]);
            let [[x, y], [a, b]] = [middle, half];
            plan.pillars.push(Pillar {
                id: format!("p{number}"),
                level: "l".into(),
                height_m,
                outline_m: vec![[x - a, y - b], [x + a, y - b], [x + a, y + b], [x - a, y + b]],
            });
        }
        let mut anchor = |x: f64, y: f64, z: f64| {
            let number = plan.anchors.len();
            plan.anchors.push(Anchor {
                id: format!("a{number}"),
                position_m: Position::new(x, y, z),
                range_offset_m: None,
                antenna_delay_ns: None,
                tx_power_dbm: None,
            });
        };
        for corner in 0..4_u32 {
            let along = draw.between(0.05, 0.45) * length;
            let x = if corner % 2 == 0 { along } else { length - along };
            let y = if corner < 2 { 0.2 } else { width - 0.2 };
            anchor(x, y, draw.between(1.8, roof.min(3.4)));
        }
        if draw.chance(0.5) {
            anchor(
                out + 0.5 * DRIFT_M - 0.2,
                across + side * draw.between(0.0, aside),
                draw.between(1.8, roof.min(3.4)),
            );
        }
        let mut spec = RadioSpec::default();
        spec.body.shades = draw.chance(0.8);
        spec.uwb.obstruction_excess_m = draw.between(0.0, 1.5);
        let echoes = &mut spec.uwb.multipath;
        echoes.echoes_db += draw.between(-1.5, 1.5);
        echoes.early_db += draw.between(-2.0, 2.0);
        echoes.early_ns *= draw.between(0.75, 1.33);
        echoes.ray_decay_ns *= draw.between(0.75, 1.33);
        echoes.blocked_echo_loss += draw.between(-0.1, 0.1);
        let antenna_m = draw.between(0.9, 1.4);
        Self { mine: Mine::unchecked(plan), spec, hall_m: [length, width], standing, drift, antenna_m }
    }

    /// Is there room for somebody on the way from here to there?
    fn free(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> bool {
        (0..=40_u32).all(|k| {
            let p = from + (to - from) * (f64::from(k) / 40.0);
            self.standing.iter().all(|[x, y, a, b]| (p.x - x).abs() > a + 0.35 || (p.y - y).abs() > b + 0.35)
        })
    }

    /// A place on the floor of the hall that one can go to.
    fn spot(&self, from: Option<&Vector2<f64>>, draw: &mut Draw) -> Option<Vector2<f64>> {
        (0..60).find_map(|_| {
            let [length, width] = self.hall_m;
            let to = Vector2::new(draw.between(0.8, length - 0.8), draw.between(0.8, width - 0.8));
            self.free(from.unwrap_or(&to), &to).then_some(to)
        })
    }

    /// Somebody's way: corners.
    fn way(&self, draw: &mut Draw) -> Vec<Vector2<f64>> {
        let Some(start) = self.spot(None, draw) else { return vec![self.drift[1]] };
        let mut way = vec![start];
        for _ in 0..30 {
            let here = way[way.len() - 1];
            if draw.chance(0.25) && self.free(&here, &self.drift[0]) {
                let bend = draw.between(0.3, 0.95);
                let end = self.drift[1] + (self.drift[2] - self.drift[1]) * bend;
                way.extend([self.drift[0], self.drift[1], end, self.drift[1], self.drift[0]]);
            } else if let Some(next) = self.spot(Some(&here), draw) {
                way.push(next);
            }
        }
        way
    }
}

/// Somebody who walks, stops and turns.
pub struct Walker {
    way: Vec<Vector2<f64>>,
    next: usize,
    at: Vector2<f64>,
    pub heading_rad: f64,
    speed_m_s: f64,
    rest_s: f64,
    turn_rad_s: f64,
}

impl Walker {
    pub fn draw(room: &Room, draw: &mut Draw) -> Self {
        let way = room.way(draw);
        let at = way[0];
        let speed_m_s = draw.between(0.6, 1.5);
        Self {
            way,
            next: 1,
            at,
            heading_rad: draw.between(-3.1, 3.1),
            speed_m_s,
            rest_s: 0.0,
            turn_rad_s: 0.0,
        }
    }

    pub fn place(&self) -> Vector2<f64> {
        self.at
    }

    pub fn step(&mut self, dt_s: f64, draw: &mut Draw) {
        if self.rest_s > 0.0 {
            self.rest_s -= dt_s;
            self.heading_rad += self.turn_rad_s * dt_s;
            return;
        }
        let Some(goal) = self.way.get(self.next) else {
            self.next = 0;
            return;
        };
        let run = goal - self.at;
        let step = self.speed_m_s * dt_s;
        if run.norm() <= step {
            self.at = *goal;
            self.next += 1;
            if draw.chance(0.4) {
                self.rest_s = draw.between(1.0, 8.0);
                self.turn_rad_s = if draw.chance(0.5) { draw.between(-1.5, 1.5) } else { 0.0 };
            }
            return;
        }
        self.heading_rad = run.x.atan2(run.y);
        self.at += run / run.norm() * step;
    }
}

/// A vehicle that stands or creeps about.
pub struct Vehicle {
    pub obstacle: Obstacle,
    walker: Option<Walker>,
}

impl Vehicle {
    pub fn draw(room: &Room, draw: &mut Draw) -> Option<Self> {
        let spot = room.spot(None, draw)?;
        let heading_rad = draw.between(-3.1, 3.1);
        let shape = Shape::Box {
            half_length_m: draw.between(1.0, 3.0),
            half_width_m: draw.between(0.6, 1.1),
            heading_rad,
        };
        let obstacle =
            Obstacle { foot_m: Vector3::new(spot.x, spot.y, 0.0), height_m: draw.between(1.5, 2.6), shape };
        let walker = draw.chance(0.5).then(|| Walker::draw(room, draw));
        Some(Self { obstacle, walker })
    }

    pub fn step(&mut self, dt_s: f64, draw: &mut Draw) {
        let Some(walker) = &mut self.walker else { return };
        walker.step(dt_s, draw);
        let at = walker.place();
        self.obstacle.foot_m = Vector3::new(at.x, at.y, 0.0);
        if let Shape::Box { heading_rad, .. } = &mut self.obstacle.shape {
            *heading_rad = walker.heading_rad;
        }
    }
}
