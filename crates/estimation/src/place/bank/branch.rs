//! Where a hypothesis can be instead.

use super::hypothesis::carried_on;
use super::mixture::OFF_SHARE;
use super::{Bank, DEFORMED, Hypothesis, Place, RECENT_M};
use crate::place::roadways::Roadways;
use crate::place::state::State;
use adit_core::nalgebra::Vector2;

/// Most pieces that one search visits.
const VISITED: usize = 48;
/// A piece shorter than this does not stop a search: two turns may lie within the metres by which a turn is told, m.
const SHORT_M: f64 = 4.0;
/// Angle between way and roadway from which somebody may be elsewhere: 10° and two standard deviations, rad.
const AWAY_RAD: f64 = 0.175;
/// That angle's bounds, rad.
const AWAY_BOUNDS_RAD: (f64, f64) = (0.35, 0.7);
/// By how much better a branch has to fit, rad.
const BETTER_RAD: f64 = 0.175;
/// A branch makes no larger angle with the way than this, rad.
const ALONG_RAD: f64 = 0.8;
/// Standard deviation of a direction that is known well enough to be on a map: 20°, rad. Where it is known worse a straight way must have been walked: it leads along the roadway, one
/// way or the other, but for this, rad.
const KNOWN_RAD: f64 = 0.35;
const ALONG_SIGMA_RAD: f64 = 0.25;
/// Logarithms of the share that a branch takes: the way points there; both ways fit; in or out of a chamber.
const TURNED: f64 = -2.0;
const FORKED: f64 = -0.7;
const STEPPED: f64 = -2.0;
/// Weight, as a logarithm, from which a hypothesis branches.
const BRANCHES: f64 = -7.0;
/// Looks from one search of somebody off the map for a roadway to the next.
const SEARCH_EVERY: u32 = 5;
/// Probability of being on a piece, of all along its line, that is not worth a hypothesis.
const SHARE: f64 = 1e-4;
/// Logarithms of weights: half; a hundredth.
const MOST_LIKELY: f64 = -0.693;
const UNLIKELY: f64 = -4.6;
/// Names given within a search are nearer than this.
const NEW: u32 = 1 << 16;
/// Onto at most this many pieces at once.
const SEEDS: usize = 64;

/// Pieces to which a search came.
struct Search {
    found: [Found; VISITED],
    count: usize,
}

#[derive(Clone, Copy, Default)]
struct Found {
    piece: u32,
    /// The end by which it is left.
    leaves_by: u8,
    /// Way to that end, m.
    way_m: f64,
    turned: bool,
}

impl Search {
    /// What can be reached from a place on a piece within `reach_m`: along the roadway, and from every joint on it one turn further.
    fn new(roadways: &Roadways, start: u32, along_m: f64, reach_m: f64) -> Self {
        let mut search = Self { found: [Found::default(); VISITED], count: 0 };
        let Some(piece) = roadways.piece(start) else { return search };
        for (leaves_by, way_m) in [(0, along_m), (1, piece.length_m - along_m)] {
            search.push(Found { piece: start, leaves_by, way_m: way_m.max(0.0), turned: false });
        }
        let mut next = 0;
        while next < search.count {
            let here = search.found[next];
            next += 1;
            if here.way_m > reach_m {
                continue;
            }
            let end = usize::from(here.leaves_by);
            let Some(piece) = roadways.piece(here.piece) else { continue };
            let straight = carried_on(roadways, here.piece, end);
            let joint = piece.joints[end];
            for index in roadways.at(joint).iter().filter(|index| **index != here.piece) {
                let Some(other) = roadways.piece(*index) else { continue };
                let turns = straight != Some(*index) && piece.length_m > SHORT_M;
                if here.turned && turns {
                    continue;
                }
                let leaves_by = u8::from(other.end_at(joint) == 0);
                let way_m = here.way_m + other.length_m;
                search.push(Found { piece: *index, leaves_by, way_m, turned: here.turned || turns });
            }
        }
        search
    }

    fn push(&mut self, found: Found) {
        let known = self.found[..self.count]
            .iter()
            .any(|known| known.piece == found.piece && known.leaves_by == found.leaves_by);
        if !known && let Some(slot) = self.found.get_mut(self.count) {
            *slot = found;
            self.count += 1;
        }
    }

    fn pieces(&self) -> impl Iterator<Item = u32> + '_ {
        self.found[..self.count].iter().map(|found| found.piece)
    }
}

/// Angle between a way and a line that has no sense, rad.
fn angle(way: &Vector2<f64>, line: &Vector2<f64>) -> f64 {
    libm::acos(way.dot(line).abs().min(1.0))
}

impl Bank {
    /// Each hypothesis branches into what it can be on instead.
    pub(super) fn branch(&mut self, roadways: &Roadways) {
        let mut index = 0;
        let before = self.hypotheses.len();
        let straight = self.is_straight();
        while index < before {
            let hypothesis = &mut self.hypotheses[index];
            hypothesis.elsewhere = false;
            if straight && hypothesis.log_weight > BRANCHES {
                match hypothesis.place {
                    Place::Piece(piece) => self.branch_off_piece(roadways, index, piece),
                    Place::Chamber(chamber) => self.leave_chamber(roadways, index, chamber),
                    Place::Off => {}
                }
            }
            index += 1;
        }
        if straight && self.looks.is_multiple_of(SEARCH_EVERY) {
            self.find_map(roadways);
        }
    }

    fn branch_off_piece(&mut self, roadways: &Roadways, from: usize, on: u32) {
        let hypothesis = &self.hypotheses[from];
        let Some(piece) = roadways.piece(on) else { return };
        let way = self.recent_direction(&hypothesis.state);
        let off_rad = angle(&way, &piece.direction);
        let sigma_rad = libm::sqrt(hypothesis.state.direction_rad2().max(0.0));
        let away_rad = (AWAY_RAD + 2.0 * sigma_rad).clamp(AWAY_BOUNDS_RAD.0, AWAY_BOUNDS_RAD.1);
        let along_m = piece.on(&hypothesis.state.position_m.xy()).along_m;
        let turned = off_rad > away_rad;
        // No error of the heading makes that.
        let across = off_rad > AWAY_RAD + DEFORMED * sigma_rad;
        // Where both ways fit they part at the joint itself.
        let reach_m = if turned {
            RECENT_M + 2.0 * piece.half_width_m + DEFORMED * hypothesis.sigma_m(&piece.direction)
        } else {
            piece.half_width_m
        };
        let near_joint = along_m.min(piece.length_m - along_m) <= reach_m;
        if !turned && !near_joint {
            return;
        }
        self.hypotheses[from].elsewhere = turned && across;
        let search = Search::new(roadways, on, along_m, reach_m);
        let limit_rad = if turned { ALONG_RAD.min(off_rad - BETTER_RAD) } else { ALONG_RAD };
        for index in search.pieces().filter(|index| *index != on) {
            let Some(other) = roadways.piece(index) else { continue };
            if angle(&way, &other.direction) > limit_rad {
                continue;
            }
            let Some(mut child) = self.hypotheses[from].on_piece(index, other, &self.params) else {
                continue;
            };
            child.log_weight += if turned { TURNED } else { FORKED };
            let on = other.on(&child.state.position_m.xy());
            let room_m = other.half_width_m + RECENT_M + child.sigma_m(&other.direction);
            if (-room_m..=other.length_m + room_m).contains(&on.along_m) {
                self.hypotheses[from].elsewhere |= turned;
                self.admit(roadways, child);
            }
        }
        if turned {
            for chamber in roadways.beside(on) {
                if let Some(mut child) = self.hypotheses[from].in_chamber(chamber, roadways, &self.params) {
                    child.log_weight += STEPPED;
                    self.hypotheses[from].elsewhere = true;
                    self.admit(roadways, child);
                }
            }
        }
    }

    fn leave_chamber(&mut self, roadways: &Roadways, from: usize, chamber: u32) {
        let Some(room) = roadways.chamber(chamber) else { return };
        for index in room.doors.iter().copied() {
            let Some(piece) = roadways.piece(index) else { continue };
            let hypothesis = &self.hypotheses[from];
            let here = hypothesis.state.position_m.xy();
            let sigma_m = hypothesis.sigma_m(&piece.left());
            if piece.distance_m(&here) > piece.half_width_m + 1.0 + 2.0 * sigma_m {
                continue;
            }
            if let Some(mut child) = hypothesis.on_piece(index, piece, &self.params) {
                child.log_weight += STEPPED;
                self.admit(roadways, child);
            }
        }
    }

    /// Whoever is most likely off the map is looked for on it: what is found shares the weight, and little is left off the map.
    fn find_map(&mut self, roadways: &Roadways) {
        let off = |known: &&Hypothesis| known.place == Place::Off && known.log_weight > MOST_LIKELY;
        let Some(Hypothesis { state, log_weight, id, lineage, .. }) =
            self.hypotheses.iter().find(off).cloned()
        else {
            return;
        };
        let reported = self.reported.map(|reported| reported.id);
        self.hypotheses
            .retain(|known| known.id == id || known.log_weight > UNLIKELY || Some(known.id) == reported);
        let before = self.next_id;
        self.seed(roadways, &state, log_weight, lineage);
        let is_new = |known: &Hypothesis| known.id.wrapping_sub(before).wrapping_sub(1) < NEW;
        let sum: f64 = self.hypotheses.iter().filter(|known| is_new(known)).map(Hypothesis::weight).sum();
        if sum <= 0.0 {
            return;
        }
        for known in &mut self.hypotheses {
            if is_new(known) {
                known.log_weight += log_weight - libm::log(sum);
            } else if known.id == id {
                known.log_weight += OFF_SHARE;
            }
        }
    }

    /// Puts a state onto every roadway and into every chamber that it can be in; tells the best fit, mean square over what is to be expected.
    pub(super) fn seed(
        &mut self,
        roadways: &Roadways,
        state: &State,
        log_weight: f64,
        lineage: Option<u32>,
    ) -> Option<f64> {
        let straight = self.is_straight();
        let known = state.direction_rad2() <= KNOWN_RAD * KNOWN_RAD;
        if !known && !straight {
            return None;
        }
        let along_rad = ALONG_RAD + 2.0 * libm::sqrt(state.direction_rad2().max(0.0));
        let parent = Hypothesis {
            id: 0,
            place: Place::Off,
            log_weight,
            strain: 1.0,
            surprise: 1.0,
            elsewhere: false,
            walls: 0.0,
            lineage,
            state: state.clone(),
        };
        let here = state.position_m.xy();
        let widest_m =
            libm::sqrt(state.covariance.fixed_view::<2, 2>(0, 0).symmetric_eigenvalues().max().max(0.0));
        let reach_m = DEFORMED * widest_m + 10.0;
        let mut best: Option<f64> = None;
        let mut near = roadways.within(&here, reach_m);
        let distance = |index: &u32| roadways.piece(*index).map_or(f64::INFINITY, |p| p.distance_m(&here));
        near.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        for index in near.into_iter().take(SEEDS) {
            let Some(piece) = roadways.piece(index) else { continue };
            // Whoever has walked straight has walked along a roadway.
            if known && straight && angle(&self.recent_direction(state), &piece.direction) > along_rad {
                continue;
            }
            let senses = if known { [None, None] } else { [Some(piece.direction), Some(-piece.direction)] };
            for sense in senses.into_iter().take(if known { 1 } else { 2 }) {
                let facing = sense.map(|direction| self.facing(&parent, &direction));
                let facing = facing.as_ref().unwrap_or(&parent);
                let Some(mut child) = facing.on_piece(index, piece, &self.params) else { continue };
                // The share of what it does not know along the line that lies on this piece.
                let along_m = piece.on(&child.state.position_m.xy()).along_m;
                let sigma_m = child.sigma_m(&piece.direction).max(1.0);
                let below = |m: f64| libm::erf(m / (sigma_m * core::f64::consts::SQRT_2));
                let share = 0.5 * (below(piece.length_m - along_m) + below(along_m));
                if share < SHARE {
                    continue;
                }
                child.log_weight += libm::log(share);
                best = Some(best.map_or(child.strain, |known| known.min(child.strain)));
                self.admit(roadways, child);
            }
        }
        for chamber in (0_u32..).take_while(|index| roadways.chamber(*index).is_some()) {
            if let Some(child) = parent.in_chamber(chamber, roadways, &self.params) {
                best = Some(best.map_or(child.strain, |known| known.min(child.strain)));
                self.admit(roadways, child);
            }
        }
        best
    }

    /// The same hypothesis with the way of the last metres in this direction, as probable as that is.
    fn facing(&self, parent: &Hypothesis, direction: &Vector2<f64>) -> Hypothesis {
        let way = self.recent_direction(&parent.state);
        // Clockwise, as turns are.
        let turn_rad = libm::atan2(-way.perp(direction), way.dot(direction));
        let mut child = parent.clone();
        child.log_weight -= 0.5 * turn_rad * turn_rad / parent.state.direction_rad2();
        child.state.face(turn_rad, ALONG_SIGMA_RAD);
        child
    }
}
