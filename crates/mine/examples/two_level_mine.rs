//! The two-level mine of `mines/two-level.toml`, made from a seed: `cargo run -p adit-mine --example two_level_mine`.
//!
//! From the surface a decline winds down to two levels, 300 m and 360 m deep, which a ramp and two shafts join. Each level has a haulage
//! and a ventilation drift with crosscuts, panels of drives beyond them, refuges, doors and zones. The seed lets the
//! drifts wander by some metres, as drifts do.
#![expect(clippy::print_stdout, reason = "an example that prints")]

use adit_core::frames::{Enu, MineGrid, Position};
use adit_core::geodesy::Geodetic;
use adit_mine::plan::{
    AccessPoint, Anchor, Chamber, ControlPoint, Conveyor, Door, DoorKind, Fit, Grid, Junction, Level,
    MinePlan, Radio, RfidPortal, Roadway, RoadwayKind, VehicleRoute, Zone, ZoneKind,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Seed of the file that ships.
pub const SEED: u64 = 1;
/// Elevation of the surface, m.
const SURFACE_M: f64 = 412.0;
/// Name and depth of the levels, m.
const LEVELS: [(&str, f64); 2] = [("l300", 300.0), ("l360", 360.0)];
/// Corner of the mine on its grid, m.
const CORNER_M: [f64; 2] = [5000.0, 3000.0];
/// Length of the drifts, and the distance of the places where something leaves them, m.
const DRIFT_M: f64 = 950.0;
const STEP_M: f64 = 50.0;
/// From the haulage to the ventilation drift, and from there to the end of the panels, m.
const PILLAR_M: f64 = 70.0;
const PANEL_M: f64 = 125.0;
/// Slope of the drifts towards the shaft, and of the ramps.
const DRAINAGE: f64 = 0.003;
const RAMP: f64 = 0.125;

type Point = Position<MineGrid>;

fn main() -> Result<(), adit_mine::MineError> {
    print!(
        "# Made by: cargo run -p adit-mine --example two_level_mine\n{}",
        adit_mine::file::to_toml(&plan(SEED))?
    );
    Ok(())
}

/// The mine of a seed.
pub fn plan(seed: u64) -> MinePlan {
    let mut mine =
        Builder { plan: MinePlan::new("Two-level mine", grid()), random: ChaCha8Rng::seed_from_u64(seed) };
    let surface = Level { id: "surface".into(), name: Some("Surface".into()), elevation_m: SURFACE_M };
    mine.plan.levels.push(surface);
    for (id, depth_m) in LEVELS {
        let name = Some(format!("{depth_m:.0} m level"));
        mine.plan.levels.push(Level { id: id.into(), name, elevation_m: SURFACE_M - depth_m });
    }
    for (id, depth_m) in LEVELS {
        mine.level(id, SURFACE_M - depth_m);
    }
    mine.ramps();
    mine.shafts();
    mine.devices();
    mine.plan
}

struct Builder {
    plan: MinePlan,
    random: ChaCha8Rng,
}

/// To the centimetre, as surveys are written.
fn cm(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// A point from metres east and north of the mine's corner.
fn at(x: f64, y: f64, z: f64) -> Point {
    Position::new(cm(CORNER_M[0] + x), cm(CORNER_M[1] + y), cm(z))
}

fn rectangle(low: [f64; 2], high: [f64; 2]) -> Vec<[f64; 2]> {
    [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
        .map(|[x, y]| [cm(CORNER_M[0] + x), cm(CORNER_M[1] + y)])
        .to_vec()
}

impl Builder {
    fn roadway(
        &mut self,
        id: String,
        level: Option<&str>,
        kind: RoadwayKind,
        size: [f64; 2],
        points: Vec<Point>,
    ) {
        let max_slope_percent = match kind {
            RoadwayKind::Ramp => Some(13.0),
            RoadwayKind::Shaft => None,
            _ => Some(3.0),
        };
        self.plan.roadways.push(Roadway {
            id,
            name: None,
            level: level.map(Into::into),
            kind,
            width_m: size[0],
            height_m: size[1],
            max_slope_percent,
            walkable: true,
            points_m: points,
        });
    }

    /// A drift to the east that wanders a little, with a point every [`STEP_M`].
    fn drift(&mut self, y: f64, z: f64, length_m: f64, start_m: f64) -> Vec<Point> {
        let mut wander = 0.0;
        let mut points = Vec::new();
        let mut x = 0.0;
        while x <= length_m {
            points.push(at(start_m + x, y + wander, z + DRAINAGE * (start_m + x)));
            wander += self.random.random_range(-1.2..1.2) - 0.2 * wander;
            x += STEP_M;
        }
        points
    }

    fn level(&mut self, level: &str, z: f64) {
        let id = |what: &str| format!("{level}-{what}");
        let haulage = self.drift(0.0, z, DRIFT_M, 0.0);
        let ventilation = self.drift(PILLAR_M, z, DRIFT_M, 0.0);
        let back = self.drift(PILLAR_M + PANEL_M, z, 700.0, 150.0);
        let across = |from: Point, to: Point| vec![from, to];
        for n in 0..10 {
            let (from, to) = (haulage[2 * n], ventilation[2 * n]);
            self.roadway(
                id(&format!("crosscut-{n}")),
                Some(level),
                RoadwayKind::Crosscut,
                [4.5, 3.5],
                across(from, to),
            );
        }
        for n in 0..8 {
            let (from, to) = (ventilation[3 + 2 * n], back[2 * n]);
            self.roadway(
                id(&format!("panel-{n}")),
                Some(level),
                RoadwayKind::Drift,
                [4.0, 3.5],
                across(from, to),
            );
        }
        for n in [1, 3, 5] {
            let from = back[2 * n];
            let (x, y) = (from.raw().x - CORNER_M[0], from.raw().y - CORNER_M[1]);
            let to = at(x, y + 60.0, from.raw().z + 0.2);
            self.roadway(
                id(&format!("heading-{n}")),
                Some(level),
                RoadwayKind::Drift,
                [4.0, 3.5],
                across(from, to),
            );
        }
        self.rooms(level, &ventilation, &back);
        for n in [3, 6] {
            let middle = haulage[2 * n].raw().lerp(ventilation[2 * n].raw(), 0.3);
            self.plan.doors.push(Door {
                id: id(&format!("door-{n}")),
                kind: DoorKind::Ventilation,
                level: level.into(),
                closed: true,
                pressure_step_pa: Some(180.0),
                attenuation_db: Some(12.0),
                ends_m: [[cm(middle.x - 2.25), cm(middle.y)], [cm(middle.x + 2.25), cm(middle.y)]],
            });
        }
        let named = [("station", 9, "main station"), ("ramp-foot", 19, "ramp")];
        for (what, n, name) in named {
            let roadways = Vec::new();
            let junction = Junction {
                id: id(what),
                name: Some(format!("{name}, {level}")),
                position_m: haulage[n],
                roadways,
            };
            self.plan.junctions.push(junction);
        }
        let station = haulage[9];
        let (x, y) = (station.raw().x - CORNER_M[0], station.raw().y - CORNER_M[1]);
        let pit = at(x, -60.0, station.raw().z);
        let to_pit = vec![station, at(x, y - 30.0, station.raw().z), pit];
        self.roadway(id("pit-bottom"), Some(level), RoadwayKind::Haulage, [6.0, 5.0], to_pit);
        let top = back[5];
        let to_ladder = vec![top, at(400.0, 250.0, top.raw().z)];
        self.roadway(id("ladder-access"), Some(level), RoadwayKind::Ventilation, [4.0, 3.5], to_ladder);
        self.roadway(id("haulage"), Some(level), RoadwayKind::Haulage, [5.0, 4.0], haulage);
        self.roadway(id("ventilation"), Some(level), RoadwayKind::Ventilation, [4.5, 3.5], ventilation);
        self.roadway(id("back"), Some(level), RoadwayKind::Drift, [4.0, 3.5], back);
    }

    /// Refuges, workshop and magazine, and the zones of a level.
    fn rooms(&mut self, level: &str, ventilation: &[Point], back: &[Point]) {
        let z = ventilation[4].raw().z;
        let mut zone = |what: &str, name: &str, kind, capacity, outline_m| {
            self.plan.zones.push(Zone {
                id: format!("{level}-{what}"),
                name: Some(name.into()),
                kind,
                level: level.into(),
                capacity,
                exit_tolerance_m: 1.5,
                exit_delay_s: 5.0,
                outline_m,
            });
        };
        let mut chambers = Vec::new();
        let mut chamber = |what: &str, height_m, outline_m: &Vec<[f64; 2]>| {
            let (id, outline_m) = (format!("{level}-{what}-chamber"), outline_m.clone());
            chambers.push(Chamber { id, name: None, floor_m: cm(z), height_m, outline_m });
        };
        for (n, x) in [(1, 202.0), (2, 702.0)] {
            let outline = rectangle([x, 32.0], [x + 12.0, 39.0]);
            chamber(&format!("refuge-{n}"), 3.0, &outline);
            zone(&format!("refuge-{n}"), &format!("Refuge {n}"), ZoneKind::Refuge, Some(60), outline);
        }
        let workshop = rectangle([402.0, 20.0], [424.0, 34.0]);
        chamber("workshop", 5.0, &workshop);
        zone("workshop", "Workshop", ZoneKind::Key, Some(12), workshop);
        let magazine = rectangle([102.0, 48.0], [110.0, 56.0]);
        chamber("magazine", 3.0, &magazine);
        zone("magazine", "Explosives", ZoneKind::Restricted, Some(2), magazine);
        let east = back[13].raw() - corner();
        let blast = rectangle([cm(east.x) - 40.0, cm(east.y) - 30.0], [cm(east.x) + 60.0, cm(east.y) + 12.0]);
        zone("blasting", "Blasting", ZoneKind::Dangerous, None, blast);
        self.plan.chambers.append(&mut chambers);
    }

    /// A rectangular spiral down from a point: `turns` times round by `sides`, ending under where it began.
    fn spiral(from: Point, sides: [f64; 2], turns: usize) -> Vec<Point> {
        let p = from.raw() - corner();
        let corners = [[sides[0], 0.0], [sides[0], sides[1]], [0.0, sides[1]], [0.0, 0.0]];
        let mut points = vec![from];
        let (mut way, mut last) = (0.0, [0.0, 0.0]);
        for corner in (0..turns).flat_map(|_| corners) {
            let leg = f64::hypot(corner[0] - last[0], corner[1] - last[1]);
            way += leg;
            last = corner;
            points.push(at(p.x + corner[0], p.y + corner[1], p.z - RAMP * way));
        }
        points
    }

    fn ramps(&mut self) {
        let west = *self.start_of("l300-haulage").raw() - corner();
        let portal = at(west.x - 40.0, west.y - 30.0, SURFACE_M);
        // Four turns of 590 m come down 295 m; the last leg takes the rest.
        let mut decline = Self::spiral(portal, [-180.0, -115.0], 4);
        decline.push(self.start_of("l300-haulage"));
        self.roadway("decline".into(), None, RoadwayKind::Ramp, [5.5, 5.0], decline);
        let east = self.end_of("l300-haulage");
        let foot = self.end_of("l360-haulage");
        let mut ramp = Self::spiral(east, [140.0, -100.0], 1);
        ramp.pop();
        let p = foot.raw() - corner();
        ramp.push(at(p.x - 6.0, p.y - 40.0, p.z + 5.0));
        ramp.push(foot);
        self.roadway("ramp".into(), None, RoadwayKind::Ramp, [5.5, 5.0], ramp);
        let roadways = ["l300-haulage", "ramp", "l360-haulage"].map(Into::into).to_vec();
        self.plan.vehicle_routes.push(VehicleRoute {
            id: "ore".into(),
            name: Some("Ore from the 300 m level to the crusher".into()),
            speed_m_s: 4.0,
            roadways,
        });
        let outline_m =
            rectangle([portal_x(&portal) - 12.0, west.y - 36.0], [portal_x(&portal) + 4.0, west.y - 24.0]);
        self.plan.zones.push(way_out("portal", "Decline portal", outline_m));
        let beside = |p: Point| Position::new(p.raw().x, cm(p.raw().y - 1.6), cm(p.raw().z + 0.9));
        let points_m = (10..=18).map(|n| beside(self.point_of("l360-haulage", n))).collect();
        self.plan.conveyors.push(Conveyor { id: "belt-1".into(), points_m });
    }

    fn shafts(&mut self) {
        for (id, roadway, size, walkable) in [
            ("hoist", "l360-pit-bottom", [6.0, 5.0], false),
            ("ladderway", "l360-ladder-access", [3.0, 3.0], true),
        ] {
            let foot = self.end_of(roadway);
            let collar = Position::new(foot.raw().x, foot.raw().y, SURFACE_M);
            self.roadway(id.into(), None, RoadwayKind::Shaft, size, vec![collar, foot]);
            if let Some(shaft) = self.plan.roadways.last_mut() {
                shaft.walkable = walkable;
            }
            let p = collar.raw() - corner();
            let outline_m = rectangle([p.x - 5.0, p.y - 5.0], [p.x + 5.0, p.y + 5.0]);
            self.plan.zones.push(way_out(&format!("{id}-collar"), &format!("Collar of the {id}"), outline_m));
        }
    }

    /// Anchors every 45 m, on the left and the right wall in turn, access points every 80 m, readers where levels are entered.
    fn devices(&mut self) {
        let lines: Vec<(String, f64, Vec<Point>)> = self
            .plan
            .roadways
            .iter()
            .filter(|r| r.kind != RoadwayKind::Shaft)
            .map(|r| (r.id.clone(), r.width_m, r.points_m.clone()))
            .collect();
        for (id, width_m, points) in lines {
            let side = 0.5 * width_m - 0.2;
            let short = id.contains("crosscut")
                || id.contains("heading")
                || id.contains("access")
                || id.contains("pit");
            let anchor_step = if short { 70.0 } else { 45.0 };
            for (n, position_m) in along(&points, anchor_step, side, 2.6).into_iter().enumerate() {
                let id = format!("a-{id}-{n}");
                self.plan.anchors.push(Anchor {
                    id,
                    position_m,
                    range_offset_m: None,
                    antenna_delay_ns: Some(515.0),
                    tx_power_dbm: None,
                });
            }
            if short || id.contains("panel") {
                continue;
            }
            for (n, position_m) in along(&points, 80.0, -side, 2.8).into_iter().enumerate() {
                let number = self.plan.access_points.len();
                self.plan.access_points.push(AccessPoint {
                    id: format!("w-{id}-{n}"),
                    radio: Radio::Wifi,
                    mac: Some(format!("02:ad:17:00:{:02x}:{:02x}", number / 256, number % 256)),
                    position_m,
                    tx_power_dbm: Some(18.0),
                    path_loss: None,
                });
            }
        }
        for (id, roadway, n) in [
            ("r-portal", "decline", 0),
            ("r-l300-decline", "l300-haulage", 0),
            ("r-l300-ramp", "l300-haulage", 19),
            ("r-l360-ramp", "l360-haulage", 19),
            ("r-l300-pit", "l300-pit-bottom", 1),
            ("r-l360-pit", "l360-pit-bottom", 1),
            ("r-l300-ladder", "l300-ladder-access", 1),
            ("r-l360-ladder", "l360-ladder-access", 1),
        ] {
            let p = *self.point_of(roadway, n).raw();
            let position_m = Position::new(p.x, p.y, cm(p.z + 2.5));
            self.plan.rfid_portals.push(RfidPortal { id: id.into(), position_m, range_m: 8.0 });
        }
    }

    fn point_of(&self, roadway: &str, n: usize) -> Point {
        let found = self.plan.roadways.iter().find(|r| r.id == roadway);
        found.and_then(|r| r.points_m.get(n)).copied().unwrap_or(Position::ORIGIN)
    }

    fn start_of(&self, roadway: &str) -> Point {
        self.point_of(roadway, 0)
    }

    fn end_of(&self, roadway: &str) -> Point {
        let found = self.plan.roadways.iter().find(|r| r.id == roadway);
        found.and_then(|r| r.points_m.last()).copied().unwrap_or(Position::ORIGIN)
    }
}

fn portal_x(portal: &Point) -> f64 {
    portal.raw().x - CORNER_M[0]
}

fn corner() -> adit_core::nalgebra::Vector3<f64> {
    adit_core::nalgebra::Vector3::new(CORNER_M[0], CORNER_M[1], 0.0)
}

fn way_out(id: &str, name: &str, outline_m: Vec<[f64; 2]>) -> Zone {
    Zone {
        id: id.into(),
        name: Some(name.into()),
        kind: ZoneKind::Portal,
        level: "surface".into(),
        capacity: None,
        exit_tolerance_m: 2.0,
        exit_delay_s: 10.0,
        outline_m,
    }
}

/// Places along a line, from half a step on, on its two sides in turn, `height_m` above the floor.
fn along(points: &[Point], step_m: f64, side_m: f64, height_m: f64) -> Vec<Point> {
    let mut places = Vec::new();
    let (mut next, mut side) = (0.5 * step_m, side_m);
    let mut reached = 0.0;
    for pair in points.windows(2) {
        let (a, b) = (pair[0].raw(), pair[1].raw());
        let (run, length) = (b - a, (b - a).norm());
        while next <= reached + length {
            let p = a + run * ((next - reached) / length);
            let left = adit_core::nalgebra::Vector3::new(-run.y, run.x, 0.0).normalize() * side;
            places.push(Position::new(cm(p.x + left.x), cm(p.y + left.y), cm(p.z + height_m)));
            side = -side;
            next += step_m;
        }
        reached += length;
    }
    places
}

/// The grid of the mine: its north lies 0.8° east of true north, its metre is 40 ppm short, and four points are known on the
/// Earth, to the millimetre, with the centimetres that two surveys differ by.
fn grid() -> Grid {
    let origin = Geodetic {
        latitude_rad: 50.92_f64.to_radians(),
        longitude_rad: 13.34_f64.to_radians(),
        height_m: 455.0,
    };
    let to_ecef = origin.enu_frame().inverse();
    let (turn, scale) = (0.8_f64.to_radians(), 1.00004);
    let points = [
        ("k1", [4700.0, 2800.0, 415.2], [0.011, -0.006]),
        ("k2", [6150.0, 2750.0, 421.7], [-0.008, 0.012]),
        ("k3", [6100.0, 3480.0, 409.9], [0.004, 0.009]),
        ("k4", [4750.0, 3520.0, 418.4], [-0.007, -0.013]),
    ]
    .map(|(id, grid, error)| {
        let (x, y) = (grid[0] - 5450.0, grid[1] - 3120.0);
        let east = scale * (x * turn.cos() + y * turn.sin()) + error[0];
        let north = scale * (-x * turn.sin() + y * turn.cos()) + error[1];
        let place =
            Geodetic::from_ecef(&to_ecef.position(&Position::<Enu>::new(east, north, 0.0))).unwrap_or(origin);
        // Ten digits of a degree are a hundredth of a millimetre.
        let digits = |rad: f64| (rad.to_degrees() * 1e10).round() / 1e10;
        ControlPoint {
            id: id.into(),
            grid_m: Position::new(grid[0], grid[1], grid[2]),
            latitude_deg: digits(place.latitude_rad),
            longitude_deg: digits(place.longitude_rad),
            height_m: cm(grid[2] + 43.0),
        }
    });
    Grid::ControlPoints { fit: Fit::Similarity, tolerance_m: 0.05, points: points.to_vec() }
}
