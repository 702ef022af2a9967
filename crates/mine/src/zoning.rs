//! What lies in a zone.

use crate::check::Survey;
use crate::geometry::plane::{Point, along, minus};
use crate::geometry::polygon::{self, Outline, chords, contains, distance_m, segments_meet, sides};
use crate::geometry::polyline::Polyline;
use crate::levels::Levels;
use crate::network::{EdgeId, Network, Spot};
use crate::plan::{MinePlan, Zone};
use adit_core::frames::Position;
use alloc::vec::Vec;

/// Places on the network inside a zone on a level: the middle of each stretch of centre line in it; where there is none, as in a niche
/// beside a roadway, the nearest place on a roadway that touches it.
pub fn spots_in(plan: &MinePlan, network: &Network, levels: &Levels, zone: &Zone, level: usize) -> Vec<Spot> {
    let mut spots = Vec::new();
    for (id, edge) in (0_u32..).map(EdgeId).zip(network.edges()) {
        let points: Vec<_> = edge.points_m().map(|p| *p.raw()).collect();
        let mut reached_m = 0.0;
        for pair in points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let length_m = (b - a).norm();
            for chord in chords(&zone.outline_m, [a.x, a.y], [b.x, b.y], Outline::Inside) {
                let middle = 0.5 * (chord.from + chord.to);
                if levels.of(a.z + middle * (b.z - a.z)) == Some(level) {
                    spots.push(Spot { edge: id, along_m: reached_m + middle * length_m });
                }
            }
            reached_m += length_m;
        }
    }
    if spots.is_empty() {
        let centre = polygon::centroid(&zone.outline_m);
        let z = plan.levels[level].elevation_m;
        let reach_m = 100.0;
        let beside =
            network.within(&Position::new(centre[0], centre[1], z), reach_m).into_iter().find(|foot| {
                let p = foot.position_m.raw();
                let half_m =
                    network.edge(foot.spot.edge).map_or(0.0, |e| 0.5 * plan.roadways[e.roadway].width_m);
                levels.of(p.z) == Some(level) && distance_m(&zone.outline_m, [p.x, p.y]) <= half_m
            });
        spots.extend(beside.map(|foot| foot.spot));
    }
    spots
}

/// Is any opening of the level inside the zone, if only in part?
pub fn holds_opening(plan: &MinePlan, survey: &Survey, zone: &Zone, level: usize) -> bool {
    let outline = &zone.outline_m;
    let of_level = |z: f64| survey.levels.of(z) == Some(level);
    let roadway = survey.built.lines.iter().zip(&plan.roadways).any(|(line, roadway)| {
        line.iter().flat_map(Polyline::segments).any(|(a, b)| {
            (of_level(a.z) || of_level(b.z))
                && reaches(outline, [a.x, a.y], [b.x, b.y], 0.5 * roadway.width_m)
        })
    });
    roadway
        || plan.chambers.iter().any(|chamber| {
            of_level(chamber.floor_m)
                && (chamber.outline_m.iter().any(|p| contains(outline, *p))
                    || outline.iter().any(|p| contains(&chamber.outline_m, *p))
                    || sides(outline)
                        .any(|(a, b)| sides(&chamber.outline_m).any(|(c, d)| segments_meet(a, b, c, d))))
        })
}

/// Does a corridor about a segment come into the outline?
fn reaches(outline: &[Point], a: Point, b: Point, half_width_m: f64) -> bool {
    let near_end = [a, b].iter().any(|p| distance_m(outline, *p) <= half_width_m);
    let near_corner = || {
        outline.iter().any(|corner| {
            let share = crate::geometry::plane::nearest_on_segment(a, b, *corner);
            let foot = along(a, minus(b, a), share);
            crate::geometry::plane::length(minus(*corner, foot)) <= half_width_m
        })
    };
    near_end || near_corner() || sides(outline).any(|(c, d)| segments_meet(a, b, c, d))
}
