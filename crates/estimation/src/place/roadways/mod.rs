//! The roadways of a mine as a bank of hypotheses wants them: straight pieces, the joints between them, chambers beside them.
//!
//! Made once of an [`adit_mine::Mine`], shared by all walkers. Corners of centre lines are joints like junctions: for a walker who does not know how far he has come, both
//! are places where the way turns. Shafts, what nobody may walk and what is steeper than 45° have no pieces.
//!
//! Frame: mine grid, z the floor; m.

mod cells;
mod piece;

pub use piece::{OnPiece, Piece};

use adit_core::nalgebra::{Vector2, Vector3};
use adit_mine::Mine;
use adit_mine::plan::RoadwayKind;
use alloc::vec;
use alloc::vec::Vec;
use cells::Cells;

/// Rise over run from which nobody walks.
const TOO_STEEP: f64 = 1.0;
/// A piece shorter than this has no direction, m.
const SHORTEST_M: f64 = 1e-3;
/// A wall as thick as this still has an opening into a chamber that is drawn a bit too small, m.
const SILL_M: f64 = 0.5;

/// Straight pieces of roadways, joints and chambers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Roadways {
    pieces: Vec<Piece>,
    /// Pieces that meet at each joint, ascending: `meeting[starts[joint]..starts[joint + 1]]`.
    starts: Vec<u32>,
    meeting: Vec<u32>,
    chambers: Vec<Room>,
    cells: Cells,
}

/// A chamber.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    outline_m: Vec<Vector2<f64>>,
    /// Height of its floor, m.
    pub floor_m: f64,
    /// Height of its roof above that, m.
    pub height_m: f64,
    /// Pieces of roadways that open into it.
    pub doors: Vec<u32>,
}

impl Roadways {
    /// What a walker can be on in a mine.
    pub fn new(mine: &Mine) -> Self {
        let (plan, network) = (mine.plan(), mine.network());
        let mut pieces: Vec<Piece> = Vec::new();
        let mut joints = network.nodes().len();
        for edge in network.edges() {
            let roadway = &plan.roadways[edge.roadway];
            if !edge.walkable || roadway.kind == RoadwayKind::Shaft {
                continue;
            }
            let points: Vec<Vector3<f64>> = edge.points_m().map(|point| *point.raw()).collect();
            let mut from = edge.from.0 as usize;
            for (index, pair) in points.windows(2).enumerate() {
                let last = index + 2 == points.len();
                let to = if last { edge.to.0 as usize } else { joints };
                joints += usize::from(!last);
                let size_m = (0.5 * roadway.width_m, roadway.height_m);
                pieces.extend(Piece::new([pair[0], pair[1]], [from, to], size_m));
                from = to;
            }
        }
        pieces.retain(|piece| piece.length_m > SHORTEST_M && piece.rise.abs() <= TOO_STEEP);
        let (starts, meeting) = meetings(&pieces, joints);
        let chambers = plan.chambers.iter().filter(|chamber| chamber.outline_m.len() >= 3).map(|chamber| {
            let outline_m = chamber.outline_m.iter().map(|corner| Vector2::from(*corner)).collect();
            let mut room =
                Room { outline_m, floor_m: chamber.floor_m, height_m: chamber.height_m, doors: Vec::new() };
            let near = |(index, piece): (usize, &Piece)| {
                let opens = room.opens_to(piece);
                opens.then(|| u32::try_from(index).unwrap_or(u32::MAX))
            };
            room.doors = pieces.iter().enumerate().filter_map(near).collect();
            room
        });
        let chambers = chambers.collect();
        let cells = Cells::new(&pieces);
        Self { pieces, starts, meeting, chambers, cells }
    }

    /// A piece; `None` for a number of other roadways.
    pub fn piece(&self, index: u32) -> Option<&Piece> {
        self.pieces.get(index as usize)
    }

    /// How many pieces there are.
    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// The pieces that meet at a joint.
    pub fn at(&self, joint: u32) -> &[u32] {
        let bound = |index: usize| self.starts.get(index).map(|start| *start as usize);
        let range = bound(joint as usize).zip(bound(joint as usize + 1));
        range.and_then(|(from, to)| self.meeting.get(from..to)).unwrap_or_default()
    }

    /// A chamber; `None` for a number of other roadways.
    pub fn chamber(&self, index: u32) -> Option<&Room> {
        self.chambers.get(index as usize)
    }

    /// The chambers into which a piece opens.
    pub fn beside(&self, piece: u32) -> impl Iterator<Item = u32> + '_ {
        let opens = move |(index, room): (usize, &Room)| {
            room.doors.contains(&piece).then(|| u32::try_from(index).unwrap_or(u32::MAX))
        };
        self.chambers.iter().enumerate().filter_map(opens)
    }

    /// All pieces that may come within reach of a place on the map, each once, ascending; heights do not matter.
    pub fn within(&self, place_m: &Vector2<f64>, reach_m: f64) -> Vec<u32> {
        let mut near = self.cells.within(place_m, reach_m);
        near.retain(|index| self.piece(*index).is_some_and(|piece| piece.distance_m(place_m) <= reach_m));
        near
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        let rooms: usize = self
            .chambers
            .iter()
            .map(|room| size_of::<Room>() + room.outline_m.len() * 16 + room.doors.len() * 4)
            .sum();
        size_of::<Self>()
            + self.pieces.len() * size_of::<Piece>()
            + 4 * (self.starts.len() + self.meeting.len())
            + rooms
            + self.cells.bytes()
    }
}

impl Room {
    /// Inside its walls, on the map.
    pub fn contains(&self, place_m: &Vector2<f64>) -> bool {
        let mut inside = false;
        for (a, b) in self.sides() {
            if (a.y > place_m.y) != (b.y > place_m.y) {
                let x = a.x + (place_m.y - a.y) / (b.y - a.y) * (b.x - a.x);
                inside ^= place_m.x < x;
            }
        }
        inside
    }

    /// The nearest place on its walls.
    pub fn wall(&self, place_m: &Vector2<f64>) -> Vector2<f64> {
        let feet = self.sides().map(|(a, b)| {
            let run = b - a;
            let share = ((place_m - a).dot(&run) / run.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            a + run * share
        });
        let far = |foot: &Vector2<f64>| (foot - place_m).norm_squared();
        feet.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(*place_m)
    }

    fn sides(&self) -> impl Iterator<Item = (Vector2<f64>, Vector2<f64>)> + '_ {
        let next = self.outline_m.iter().cycle().skip(1);
        self.outline_m.iter().zip(next).map(|(a, b)| (*a, *b))
    }

    /// A roadway that runs through it or along it, on its floor.
    fn opens_to(&self, piece: &Piece) -> bool {
        let reach_m = piece.half_width_m + SILL_M;
        let touches = |place: Vector2<f64>| {
            let (floor_m, low) = (piece.floor_m(piece.on(&place).along_m), self.floor_m);
            floor_m < low + self.height_m && floor_m > low - self.height_m
        };
        let ends = [0.0, piece.length_m].map(|along| piece.at(along).xy());
        let through = ends.iter().find(|end| self.contains(end)).copied();
        let corner = self.outline_m.iter().find(|corner| piece.distance_m(corner) <= reach_m).copied();
        let wall = ends.iter().map(|end| self.wall(end)).find(|wall| piece.distance_m(wall) <= reach_m);
        let crossed = self.sides().find_map(|(a, b)| piece.crossed(&a, &b));
        [through, corner, wall, crossed].into_iter().flatten().any(touches)
    }
}

/// For each joint the pieces that meet there, one list after another.
fn meetings(pieces: &[Piece], joints: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; joints + 1];
    for joint in pieces.iter().flat_map(|piece| piece.joints) {
        starts[joint as usize + 1] += 1;
    }
    for joint in 0..joints {
        starts[joint + 1] += starts[joint];
    }
    let mut filled = starts.clone();
    let mut meeting = vec![0; 2 * pieces.len()];
    for (index, piece) in (0_u32..).zip(pieces) {
        for joint in piece.joints {
            meeting[filled[joint as usize] as usize] = index;
            filled[joint as usize] += 1;
        }
    }
    (starts, meeting)
}
