//! The plan view of a mine as SVG: a panel for each level, all to one scale, grid north up.
//!
//! The visual language is that of adit's other figures: white ground, the colours of Okabe & Ito (2008), legend above the map. The
//! rest of the mine lies under each level in pale grey.

mod svg;

use crate::mine::Mine;
use crate::plan::{RoadwayKind, Zone, ZoneKind};
use adit_core::frames::{MineGrid, Position};
use svg::{FAINT_INK, INK, Mark, Stroke, Svg, text_width};

/// Size of the map in a panel at most, px.
const MAP_PX: [f64; 2] = [1120.0, 700.0];
/// Room round the map, px.
const MARGIN_PX: f64 = 40.0;
const TITLE_PX: f64 = 44.0;
const HEADING_PX: f64 = 30.0;
const LEGEND_ROW_PX: f64 = 22.0;
/// Devices of a level that are still named one by one.
const NAMED: usize = 30;

const WALL: &str = "#8A9199";
const FLOOR: &str = "#E3E7EA";
const PALE: &str = "#F1F3F4";
const ANCHOR: &str = "#0072B2";
const ACCESS_POINT: &str = "#E69F00";
const RFID: &str = "#009E73";
const PILLAR: &str = "#5B636B";
const DOOR: &str = "#D55E00";

/// Draws the plan view.
pub fn draw(mine: &Mine) -> String {
    let map = Map::new(mine);
    let levels = shown_levels(mine);
    let legend = legend(mine);
    let rows = legend_rows(&legend, map.size[0]);
    let top = TITLE_PX + LEGEND_ROW_PX * rows.len() as f64;
    let panel = map.size[1] + HEADING_PX + 0.5 * MARGIN_PX;
    let size = [map.size[0] + 2.0 * MARGIN_PX, top + panel * levels.len() as f64 + MARGIN_PX];
    let mut svg = Svg::new(size[0], size[1]);
    svg.label(&mine.plan().name, [MARGIN_PX, 28.0], 17.0, INK, "start", true);
    for (number, row) in rows.iter().enumerate() {
        draw_legend(&mut svg, row, TITLE_PX + LEGEND_ROW_PX * (number as f64 + 0.3));
    }
    for (number, level) in levels.iter().enumerate() {
        let origin = [MARGIN_PX, top + panel * number as f64 + HEADING_PX];
        let heading = level.map_or(String::new(), |index| {
            let level = &mine.plan().levels[index];
            let sign = if level.elevation_m < 0.0 { "−" } else { "" };
            format!("{}, {sign}{} m", level.name.as_deref().unwrap_or(&level.id), level.elevation_m.abs())
        });
        svg.label(&heading, [MARGIN_PX, origin[1] - 8.0], 14.0, INK, "start", true);
        Panel { mine, map: &map, level: *level, origin }.draw(&mut svg);
    }
    scale_bar(&mut svg, &map, size);
    svg.finish()
}

/// Grid coordinates to px.
struct Map {
    low: [f64; 2],
    px_per_m: f64,
    size: [f64; 2],
}

impl Map {
    fn new(mine: &Mine) -> Self {
        let plan = mine.plan();
        let spatial = plan
            .roadways
            .iter()
            .flat_map(|r| &r.points_m)
            .chain(plan.anchors.iter().map(|a| &a.position_m))
            .chain(plan.access_points.iter().map(|a| &a.position_m))
            .chain(plan.rfid_portals.iter().map(|a| &a.position_m))
            .map(|p| [p.raw().x, p.raw().y]);
        let flat = plan
            .chambers
            .iter()
            .flat_map(|c| &c.outline_m)
            .chain(plan.zones.iter().flat_map(|z| &z.outline_m))
            .copied();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in spatial.chain(flat) {
            for axis in 0..2 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
            }
        }
        let widest = plan.roadways.iter().map(|r| 0.5 * r.width_m).fold(1.0, f64::max);
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [1.0; 2]);
        }
        for axis in 0..2 {
            low[axis] -= widest;
            high[axis] += widest;
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let px_per_m = (MAP_PX[0] / extent[0]).min(MAP_PX[1] / extent[1]);
        Self { low, px_per_m, size: extent.map(|e| e * px_per_m) }
    }
}

/// The levels with something on them, highest first; one panel of everything where there are no levels.
fn shown_levels(mine: &Mine) -> Vec<Option<usize>> {
    let plan = mine.plan();
    let mut levels: Vec<usize> = (0..plan.levels.len())
        .filter(|index| {
            let id = Some(plan.levels[*index].id.as_str());
            let here = |z: f64| mine.level_at(z).map(|l| l.id.as_str()) == id;
            plan.roadways.iter().flat_map(|r| &r.points_m).any(|p| here(p.raw().z))
                || plan.chambers.iter().any(|c| here(c.floor_m))
                || plan.anchors.iter().any(|a| here(a.position_m.raw().z))
        })
        .collect();
    levels.sort_by(|a, b| plan.levels[*b].elevation_m.total_cmp(&plan.levels[*a].elevation_m));
    if levels.is_empty() { vec![None] } else { levels.into_iter().map(Some).collect() }
}

struct Panel<'m> {
    mine: &'m Mine,
    map: &'m Map,
    level: Option<usize>,
    origin: [f64; 2],
}

impl Panel<'_> {
    fn px(&self, p: [f64; 2]) -> [f64; 2] {
        let scale = self.map.px_per_m;
        [
            self.origin[0] + (p[0] - self.map.low[0]) * scale,
            self.origin[1] + self.map.size[1] - (p[1] - self.map.low[1]) * scale,
        ]
    }

    fn outline(&self, outline: &[[f64; 2]]) -> Vec<[f64; 2]> {
        outline.iter().map(|p| self.px(*p)).collect()
    }

    fn here(&self, z: f64) -> bool {
        let id = |index: usize| self.mine.plan().levels[index].id.as_str();
        self.level.is_none() || self.mine.level_at(z).map(|l| l.id.as_str()) == self.level.map(id)
    }

    fn of_level(&self, level: &str) -> bool {
        self.level.is_none_or(|index| self.mine.plan().levels[index].id == level)
    }

    fn draw(&self, svg: &mut Svg) {
        self.openings(svg, PALE, 0.0, |_| true);
        self.openings(svg, WALL, 1.8, |z| self.here(z));
        self.openings(svg, FLOOR, 0.0, |z| self.here(z));
        let plan = self.mine.plan();
        for zone in plan.zones.iter().filter(|zone| self.of_level(&zone.level)) {
            let color = zone_color(zone.kind);
            svg.area(&self.outline(&zone.outline_m), color, 0.25, color, 1.2);
        }
        for pillar in plan.pillars.iter().filter(|p| self.of_level(&p.level)) {
            let opacity = if pillar.height_m.is_some() { 0.4 } else { 0.9 };
            svg.area(&self.outline(&pillar.outline_m), PILLAR, opacity, PILLAR, 1.0);
        }
        for conveyor in &plan.conveyors {
            let here: Vec<[f64; 2]> = conveyor
                .points_m
                .iter()
                .filter(|p| self.here(p.raw().z))
                .map(|p| self.px([p.raw().x, p.raw().y]))
                .collect();
            if here.len() > 1 {
                svg.line(&here, INK, 1.4, Stroke::Dashed);
            }
        }
        for door in plan.doors.iter().filter(|d| self.of_level(&d.level)) {
            svg.line(&self.outline(&door.ends_m), DOOR, 3.5, Stroke::Solid);
        }
        self.centre_lines(svg);
        self.nodes(svg);
        self.devices(svg);
        for zone in plan.zones.iter().filter(|zone| self.of_level(&zone.level)) {
            self.name_zone(svg, zone);
        }
    }

    /// Roadways as broad as they are, `wider` px more for their walls, and chambers.
    fn openings(&self, svg: &mut Svg, color: &str, wider: f64, shown: impl Fn(f64) -> bool) {
        let plan = self.mine.plan();
        for roadway in &plan.roadways {
            let width = (roadway.width_m * self.map.px_per_m).max(1.6) + wider;
            let points: Vec<(f64, [f64; 2])> =
                roadway.points_m.iter().map(|p| (p.raw().z, self.px([p.raw().x, p.raw().y]))).collect();
            let mut piece: Vec<[f64; 2]> = Vec::new();
            for pair in points.windows(2) {
                let steep = roadway.kind == RoadwayKind::Shaft;
                let middle = 0.5 * (pair[0].0 + pair[1].0);
                if shown(middle) || steep && (shown(pair[0].0) || shown(pair[1].0)) {
                    if piece.is_empty() {
                        piece.push(pair[0].1);
                    }
                    piece.push(pair[1].1);
                } else if !piece.is_empty() {
                    svg.line(&piece, color, width, Stroke::Solid);
                    piece.clear();
                }
            }
            if !piece.is_empty() {
                svg.line(&piece, color, width, Stroke::Solid);
            }
        }
        for chamber in plan.chambers.iter().filter(|c| shown(c.floor_m)) {
            svg.area(&self.outline(&chamber.outline_m), color, 1.0, color, wider.max(0.1));
        }
    }

    /// Only where roadways are broad enough to show them.
    fn centre_lines(&self, svg: &mut Svg) {
        let roadways = self.mine.plan().roadways.iter();
        for roadway in roadways.filter(|r| r.width_m * self.map.px_per_m > 12.0) {
            let here = roadway.points_m.iter().filter(|p| self.here(p.raw().z));
            let points: Vec<[f64; 2]> = here.map(|p| self.px([p.raw().x, p.raw().y])).collect();
            if points.len() > 1 {
                svg.line(&points, FAINT_INK, 1.6, Stroke::Dotted);
            }
        }
    }

    fn nodes(&self, svg: &mut Svg) {
        let network = self.mine.network();
        for (number, node) in (0_u32..).zip(network.nodes()) {
            let p = node.position_m.raw();
            if self.here(p.z) && network.edges_at(crate::network::NodeId(number)).len() > 2 {
                svg.mark(Mark::Dot, self.px([p.x, p.y]), FAINT_INK);
            }
        }
    }

    fn devices(&self, svg: &mut Svg) {
        let plan = self.mine.plan();
        let anchors = plan.anchors.iter().map(|d| (Mark::Triangle, ANCHOR, d.id.as_str(), d.position_m));
        let points =
            plan.access_points.iter().map(|d| (Mark::Circle, ACCESS_POINT, d.id.as_str(), d.position_m));
        let readers = plan.rfid_portals.iter().map(|d| (Mark::Square, RFID, d.id.as_str(), d.position_m));
        let here: Vec<(Mark, &str, &str, Position<MineGrid>)> =
            points.chain(anchors).chain(readers).filter(|(.., p)| self.here(p.raw().z)).collect();
        for (mark, color, id, position) in &here {
            let [x, y] = self.px([position.raw().x, position.raw().y]);
            svg.mark(*mark, [x, y], color);
            if here.len() <= NAMED {
                svg.label(id, [x, y - 8.0], 10.5, color, "middle", false);
            }
        }
    }

    /// Below the zone, in its colour.
    fn name_zone(&self, svg: &mut Svg, zone: &Zone) {
        let outline = self.outline(&zone.outline_m);
        let bottom = outline.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
        let left = outline.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
        let right = outline.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let name = zone.name.as_deref().unwrap_or(&zone.id);
        let half = 0.5 * text_width(name, 11.0);
        let end = self.origin[0] + self.map.size[0];
        let middle = (0.5 * (left + right)).min(end - half).max(self.origin[0] + half);
        svg.label(name, [middle, bottom + 12.0], 11.0, zone_color(zone.kind), "middle", false);
    }
}

const fn zone_color(kind: ZoneKind) -> &'static str {
    match kind {
        ZoneKind::Restricted => "#B37800",
        ZoneKind::Dangerous => "#D55E00",
        ZoneKind::Key => "#B0568A",
        ZoneKind::Refuge => "#007A59",
        ZoneKind::Portal => "#0072B2",
    }
}

enum Swatch {
    Mark(Mark, &'static str),
    Line(&'static str, f64, Stroke),
    Area(&'static str),
}

type Entry = (Swatch, &'static str);

/// Only what the mine has.
fn legend(mine: &Mine) -> Vec<Entry> {
    let plan = mine.plan();
    let has_zone = |kind| plan.zones.iter().any(|z| z.kind == kind);
    let entries = [
        (!plan.anchors.is_empty(), (Swatch::Mark(Mark::Triangle, ANCHOR), "UWB anchor")),
        (!plan.access_points.is_empty(), (Swatch::Mark(Mark::Circle, ACCESS_POINT), "access point")),
        (!plan.rfid_portals.is_empty(), (Swatch::Mark(Mark::Square, RFID), "RFID portal")),
        (!plan.pillars.is_empty(), (Swatch::Area(PILLAR), "pillar; pale: not to the roof")),
        (!plan.doors.is_empty(), (Swatch::Line(DOOR, 3.5, Stroke::Solid), "door")),
        (!plan.conveyors.is_empty(), (Swatch::Line(INK, 1.4, Stroke::Dashed), "conveyor")),
        (has_zone(ZoneKind::Refuge), (Swatch::Area(zone_color(ZoneKind::Refuge)), "refuge")),
        (has_zone(ZoneKind::Portal), (Swatch::Area(zone_color(ZoneKind::Portal)), "way out")),
        (has_zone(ZoneKind::Key), (Swatch::Area(zone_color(ZoneKind::Key)), "key place")),
        (has_zone(ZoneKind::Restricted), (Swatch::Area(zone_color(ZoneKind::Restricted)), "restricted")),
        (has_zone(ZoneKind::Dangerous), (Swatch::Area(zone_color(ZoneKind::Dangerous)), "dangerous")),
    ];
    entries.into_iter().filter_map(|(there, entry)| there.then_some(entry)).collect()
}

fn entry_width((_, name): &Entry) -> f64 {
    28.0 + text_width(name, 12.5) + 12.0
}

fn legend_rows(legend: &[Entry], width: f64) -> Vec<Vec<&Entry>> {
    let mut rows: Vec<Vec<&Entry>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in legend {
        if used + entry_width(entry) > width {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += entry_width(entry);
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

fn draw_legend(svg: &mut Svg, row: &[&Entry], y: f64) {
    let mut x = MARGIN_PX;
    for entry in row {
        match entry.0 {
            Swatch::Mark(mark, color) => svg.mark(mark, [x + 11.0, y], color),
            Swatch::Line(color, width, stroke) => svg.line(&[[x, y], [x + 22.0, y]], color, width, stroke),
            Swatch::Area(color) => {
                let box_ = [[x + 2.0, y - 5.0], [x + 20.0, y - 5.0], [x + 20.0, y + 5.0], [x + 2.0, y + 5.0]];
                svg.area(&box_, color, 0.3, color, 1.2);
            }
        }
        svg.label(entry.1, [x + 28.0, y + 4.2], 12.5, INK, "start", false);
        x += entry_width(entry);
    }
}

/// A round length below the map on the right.
fn scale_bar(svg: &mut Svg, map: &Map, size: [f64; 2]) {
    let least = 60.0 / map.px_per_m;
    let power = 10_f64.powf(least.log10().floor());
    let length_m =
        [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|l| *l >= least).unwrap_or(least);
    let (right, y) = (size[0] - MARGIN_PX, size[1] - 16.0);
    let left = right - length_m * map.px_per_m;
    svg.line(&[[left, y - 4.0], [left, y], [right, y], [right, y - 4.0]], INK, 1.5, Stroke::Solid);
    svg.label(&format!("{length_m} m"), [left - 8.0, y + 2.0], 11.5, FAINT_INK, "end", false);
}
