//! Doors across roadways: where they stand on the network, who passes them, and what that does to the pressure.

use super::ventilation::Ventilation;
use crate::people::Person;
use adit_core::nalgebra::{Vector2, Vector3};
use adit_mine::Mine;
use adit_mine::network::{EdgeId, Spot};

/// Time from one look at a person to the next, s: half a metre of walk.
const LOOK_S: f64 = 0.4;
/// A door begins to open before somebody passes, and is shut again after, s; each takes this long.
const BEFORE_S: f64 = 2.5;
const AFTER_S: f64 = 4.0;
const LEAF_S: f64 = 1.5;
/// Share of the step that an open door lets go, and the distance over which that is felt, m.
const RELIEF: f64 = 0.6;
const FELT_M: f64 = 60.0;

/// Somebody passes a door.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Index in [`MinePlan::doors`](adit_mine::plan::MinePlan::doors).
    pub door: usize,
    /// When, s.
    pub time_s: f64,
}

/// A closed door that holds pressure back.
#[derive(Debug, Clone, Copy)]
pub(super) struct Door {
    /// Index in the plan.
    pub number: usize,
    ends: [Vector2<f64>; 2],
    band_m: (f64, f64),
    /// Where it crosses the network; none when it misses every centre line.
    pub spot: Option<Spot>,
    middle: Vector3<f64>,
    /// Pressure beyond it, in the edge's direction, less that before it, Pa.
    pub step_pa: f64,
}

/// The doors of a mine and who opens them.
#[derive(Debug, Clone)]
pub(super) struct Doors {
    pub doors: Vec<Door>,
    passages: Vec<Passage>,
}

impl Doors {
    pub fn new(mine: &Mine) -> Self {
        let closed = mine.plan().doors.iter().enumerate().filter(|(_, door)| door.closed);
        let found = closed.filter_map(|(number, door)| {
            let step_pa = door.pressure_step_pa?;
            let band_m = mine.band_m(&door.level)?;
            let ends = door.ends_m.map(Vector2::from);
            let mut found = Door { number, ends, band_m, spot: None, middle: Vector3::zeros(), step_pa };
            for (edge, piece) in (0_u32..).map(EdgeId).zip(mine.network().edges()) {
                let mut along_m = 0.0;
                let points: Vec<Vector3<f64>> = piece.points_m().map(|p| *p.raw()).collect();
                for pair in points.windows(2) {
                    if let Some(share) = found.crossed(&pair[0], &pair[1]) {
                        let run = pair[1] - pair[0];
                        found.spot = Some(Spot { edge, along_m: along_m + share * run.norm() });
                        found.middle = pair[0] + run * share;
                        // Behind the door is left of the line from its first to its second end.
                        let leftwards = (ends[1] - ends[0]).perp(&run.xy()) > 0.0;
                        found.step_pa = if leftwards { step_pa } else { -step_pa };
                    }
                    along_m += (pair[1] - pair[0]).norm();
                }
            }
            Some(found)
        });
        Self { doors: found.collect(), passages: Vec::new() }
    }

    pub fn passages(&self, person: &Person) -> Vec<Passage> {
        let mut passages = Vec::new();
        let mut before = (0.0, person.floor_m(0.0));
        while before.0 < person.duration_s() {
            let time_s = before.0 + LOOK_S;
            let here = person.floor_m(time_s);
            for door in &self.doors {
                if let Some(share) = door.crossed(&before.1, &here) {
                    passages.push(Passage { door: door.number, time_s: before.0 + share * LOOK_S });
                }
            }
            before = (time_s, here);
        }
        passages
    }

    pub fn open(&mut self, passages: impl IntoIterator<Item = Passage>) {
        self.passages.extend(passages);
        self.passages.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }

    /// How much open doors change the pressure of the ventilation at a place, Pa.
    pub fn relief_pa(&self, place: &Vector3<f64>, here_pa: f64, air: &Ventilation, time_s: f64) -> f64 {
        let first = self.passages.partition_point(|passage| passage.time_s < time_s - AFTER_S);
        let near = self.passages[first..].iter().take_while(|passage| passage.time_s < time_s + BEFORE_S);
        // Two who pass one after the other hold it open once.
        let mut relief_pa = 0.0;
        for door in &self.doors {
            let open = near
                .clone()
                .filter(|passage| passage.door == door.number)
                .map(|passage| opening(time_s - passage.time_s))
                .fold(0.0, f64::max);
            if open > 0.0 && door.step_pa != 0.0 {
                let half_pa = 0.5 * door.step_pa.abs();
                let side = ((here_pa - air.at_door_pa(door)) / half_pa).clamp(-1.0, 1.0);
                let felt = libm::exp(-(place - door.middle).norm() / FELT_M);
                relief_pa -= side * half_pa * RELIEF * open * felt;
            }
        }
        relief_pa
    }
}

/// How far a door is open, 0 to 1, this long after somebody passes it.
fn opening(since_s: f64) -> f64 {
    let share = |x: f64| {
        let u = x.clamp(0.0, 1.0);
        u * u * u * (10.0 + u * (6.0 * u - 15.0))
    };
    share((since_s + BEFORE_S) / LEAF_S) * share((AFTER_S - since_s) / LEAF_S)
}

impl Door {
    /// Where on the straight way between two points the door is passed, as a share of it.
    fn crossed(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> Option<f64> {
        let [c, d] = self.ends;
        let (run, leaf, off) = ((to - from).xy(), d - c, c - from.xy());
        let area = run.perp(&leaf);
        if area.abs() < 1e-12 {
            return None;
        }
        let (along, across) = (off.perp(&leaf) / area, off.perp(&run) / area);
        let z = from.z + along * (to.z - from.z);
        // The near end counts, the far one is the near one of the next piece.
        let passed = (0.0..1.0).contains(&along) && (-0.05..=1.05).contains(&across);
        (passed && (self.band_m.0..self.band_m.1).contains(&z)).then_some(along)
    }
}
