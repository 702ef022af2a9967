//! What happens in the shift: who is where, who falls, what fails, and when.
//!
//! People are closed-form functions of time, so that all of it is written before it begins; the server knows nothing of it but what tags
//! and gateways send. Times are seconds of the shift. A shift of less than [`WHOLE_S`] has the same story in less time.

use adit_mine::Mine;
use adit_mine::network::Travel;
use adit_simulation::people::{Body, Errand, Pace, PersonSpec, Place};
use adit_simulation::radio::{Dead, Outage};
use anyhow::{Context, Result};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// The story is told in so long, s.
pub const WHOLE_S: f64 = 2400.0;
/// After the story everybody stays where they are for so long at most, s.
pub const LONGEST_S: f64 = 4.0 * 3600.0;
/// Levels that are worked on.
const LEVELS: [&str; 2] = ["l300", "l360"];
/// Places of work: beginnings of the ids of roadways, and how much of them is out of the way of blasting, m.
const WORKINGS: [(&str, f64); 8] = [
    ("panel-0", 125.0),
    ("panel-1", 125.0),
    ("panel-2", 125.0),
    ("panel-3", 125.0),
    ("panel-4", 125.0),
    ("back", 480.0),
    ("haulage", 900.0),
    ("ventilation", 700.0),
];
/// The anchor that fails.
pub const ANCHOR: &str = "a-l300-haulage-8";
/// The gateway that fails.
pub const GATEWAY: &str = "gw-l360-east";
/// How fast people go who know where, for plans, m/s.
const WALK_M_S: f64 = 1.2;

const FIRST: [&str; 24] = [
    "Anna",
    "Li Wei",
    "Jan",
    "Maria",
    "Piotr",
    "Wang Fang",
    "Lukas",
    "Elena",
    "Tomasz",
    "Zhang Min",
    "Peter",
    "Sofia",
    "Chen Jie",
    "Marta",
    "Henrik",
    "Liu Yang",
    "Paul",
    "Ewa",
    "Zhao Lei",
    "Karin",
    "Milan",
    "Sun Tao",
    "Ingrid",
    "Josef",
];
const LAST: [&str; 17] = [
    "Adler", "Berg", "Czerny", "Dahl", "Engel", "Fuchs", "Gruber", "Horak", "Ilic", "Jung", "Kowal", "Lang",
    "Maier", "Novak", "Olsen", "Pohl", "Richter",
];
const TEAMS: [&str; 4] = ["North", "South", "Haulage", "Maintenance"];

/// When what happens, s of the shift.
#[derive(Debug, Clone, Copy)]
pub struct Times {
    /// Somebody sets out for a magazine.
    pub intruder: f64,
    /// Somebody falls.
    pub fall: f64,
    /// Somebody who saw it presses the button.
    pub button: f64,
    /// They are up again.
    pub helped: f64,
    /// A gateway says nothing: from, until; then it sends what it has kept.
    pub gateway: [f64; 2],
    /// An anchor has no power: from, until.
    pub anchor: [f64; 2],
    /// The server has no power from here on.
    pub power_cut: f64,
    /// A tag's battery is empty.
    pub battery: f64,
    /// Everybody out.
    pub evacuation: f64,
    /// The story is over.
    pub end: f64,
}

impl Times {
    /// Of a shift of so long.
    pub fn of(length_s: f64) -> Self {
        let share = (length_s / WHOLE_S).min(1.0);
        let at = |time: f64| (time * share).round();
        // What the server takes half a minute to believe cannot be shorter.
        let lasts = |seconds: f64| (seconds * share).max(45.0);
        Self {
            intruder: at(240.0),
            fall: at(480.0),
            button: at(480.0) + lasts(60.0),
            helped: at(480.0) + lasts(420.0),
            gateway: [at(660.0), at(660.0) + lasts(120.0)],
            anchor: [at(840.0), at(840.0) + lasts(300.0)],
            power_cut: at(1140.0),
            battery: at(1260.0),
            evacuation: at(1440.0),
            end: WHOLE_S.min(length_s),
        }
    }
}

/// What somebody is in the story.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Falls.
    Falls,
    /// Goes where they may not.
    Intrudes,
    /// Is not heard any more, and missing.
    Silent,
    /// Sees the fall and presses the button.
    Witness,
    /// Comes in by the decline, and turns round.
    Relief,
    /// Works.
    Works,
}

/// Somebody of the shift.
#[derive(Debug, Clone)]
pub struct Member {
    /// Id of the person.
    pub id: String,
    /// Their name.
    pub name: String,
    /// Their team.
    pub team: &'static str,
    /// Id of their tag.
    pub tag: String,
    /// What they are in the story.
    pub part: Part,
    /// The lamp is taken from the rack: from here on the tag sends, s.
    pub comes_s: f64,
}

/// Everybody, and what happens.
pub struct Story {
    /// When.
    pub times: Times,
    /// Who.
    pub members: Vec<Member>,
    /// What they do, in the same order.
    pub persons: Vec<PersonSpec>,
    /// What fails.
    pub outages: Vec<Outage>,
}

impl Story {
    /// The story of so many people in a mine.
    pub fn new(mine: &Mine, people: usize, length_s: f64, seed: u64) -> Result<Self> {
        let times = Times::of(length_s);
        let mut writer = Writer { mine, times, random: ChaCha8Rng::seed_from_u64(seed) };
        let (mut members, mut persons) = (Vec::new(), Vec::new());
        for number in 0..people {
            let part = match number {
                0 => Part::Falls,
                1 => Part::Intrudes,
                2 => Part::Silent,
                3 => Part::Witness,
                _ if number % 16 == 11 => Part::Relief,
                _ => Part::Works,
            };
            let (comes_s, person) = writer.person(number, part)?;
            members.push(Member {
                id: format!("p{:03}", number + 1),
                name: format!("{} {}", FIRST[number % FIRST.len()], LAST[number % LAST.len()]),
                team: TEAMS[number % TEAMS.len()],
                tag: format!("T{:03}", number + 1),
                part,
                comes_s,
            });
            persons.push(person);
        }
        let [from_s, until_s] = times.anchor;
        let outages = vec![Outage { from_s, until_s: Some(until_s), dead: Dead::Device(ANCHOR.to_owned()) }];
        Ok(Self { times, members, persons, outages })
    }
}

struct Writer<'a> {
    mine: &'a Mine,
    times: Times,
    random: ChaCha8Rng,
}

fn place(id: &str, along_m: f64, left_m: f64) -> Place {
    Place::Roadway { id: id.to_owned(), along_m, left_m }
}

fn go(to: Place) -> Errand {
    Errand::Go { to, pace: Pace::Walk, speed_m_s: None }
}

impl Writer<'_> {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = (self.random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + share * (high - low)
    }

    /// When they come, and what they do.
    fn person(&mut self, number: usize, part: Part) -> Result<(f64, PersonSpec)> {
        let level = LEVELS[number % LEVELS.len()];
        let of_level = |what: &str| format!("{level}-{what}");
        let times = self.times;
        let (comes_s, start, mut errands) = match part {
            Part::Falls | Part::Witness => {
                // Both on the first level, in one panel, some metres apart.
                let panel = "l300-panel-2";
                let at_m = if part == Part::Falls { 70.0 } else { 78.0 };
                let mut errands = self.work((panel, 125.0, at_m), 0.0, times.fall);
                errands.push(Errand::Until { until_s: times.fall, work: true });
                if part == Part::Falls {
                    errands.push(Errand::Fall { seconds: times.helped - times.fall });
                }
                (0.0, place(panel, at_m, 0.0), errands)
            }
            Part::Intrudes => {
                let (haulage, crosscut) = (of_level("haulage"), of_level("crosscut-1"));
                let mut errands = self.work((&haulage, 900.0, 112.0), 0.0, times.intruder);
                errands.push(Errand::Until { until_s: times.intruder, work: true });
                errands.push(go(place(&of_level("magazine-way"), 6.0, 0.0)));
                errands.push(Errand::Stand { seconds: 60.0 });
                errands.push(go(place(&crosscut, 25.0, 0.0)));
                (0.0, place(&haulage, 112.0, 0.0), errands)
            }
            Part::Relief => {
                let comes_s = times.evacuation - (450.0 * times.end / WHOLE_S) + self.between(0.0, 40.0);
                let errands = vec![
                    Errand::Until { until_s: comes_s, work: false },
                    go(place("decline", 330.0 + self.between(0.0, 30.0), 0.0)),
                ];
                (comes_s, place("decline", 4.0 + self.between(0.0, 6.0), self.between(-1.5, 1.5)), errands)
            }
            Part::Silent | Part::Works => self.worker(number, level)?,
        };
        // An alarm is heard, a tool laid down.
        let hears_s = times.evacuation + self.between(2.0, 45.0);
        errands.push(Errand::Until { until_s: hears_s, work: part != Part::Relief });
        errands.push(go(if part == Part::Relief {
            place("decline", self.between(1.0, 8.0), self.between(-1.5, 1.5))
        } else {
            // The first part of the way lies before the door.
            let refuge = of_level(if self.between(0.0, 1.0) < 0.5 { "refuge-1-way" } else { "refuge-2-way" });
            place(&refuge, self.between(4.0, 11.0), self.between(-1.4, 1.4))
        }));
        // Whoever waits shifts from foot to foot.
        let mut waited_s = times.evacuation;
        while waited_s < LONGEST_S {
            let seconds = self.between(40.0, 150.0);
            errands.extend([Errand::Stand { seconds }, Errand::Turn { turn_rad: self.between(-2.0, 2.0) }]);
            waited_s += seconds;
        }
        Ok((comes_s, PersonSpec { body: Body::default(), drawn: true, start, errands }))
    }

    /// Somebody who works: the first are there already, the others come by the cage.
    fn worker(&mut self, number: usize, level: &str) -> Result<(f64, Place, Vec<Errand>)> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below eight")]
        let (what, length_m) = WORKINGS[self.between(0.0, WORKINGS.len() as f64) as usize % WORKINGS.len()];
        let working = format!("{level}-{what}");
        let at_m = self.between(12.0, length_m - 12.0);
        let until_s = self.times.evacuation;
        // A cage brings sixteen people every minute and a half.
        if number % 5 < 2 {
            let load = f64::from(u32::try_from(number / 40).unwrap_or(0));
            let comes_s = ((20.0 + 90.0 * load) * self.times.end / WHOLE_S).round();
            let station = format!("{level}-pit-bottom");
            let start = place(&station, self.between(30.0, 55.0), self.between(-2.0, 2.0));
            let way_m =
                self.way_m(&station, &working, at_m).context("a place of work that cannot be walked to")?;
            let mut errands = vec![
                Errand::Until { until_s: comes_s + self.between(1.0, 25.0), work: false },
                go(place(&working, at_m, 0.0)),
            ];
            errands.extend(self.work((&working, length_m, at_m), comes_s + 25.0 + way_m / WALK_M_S, until_s));
            return Ok((comes_s, start, errands));
        }
        let errands = self.work((&working, length_m, at_m), 0.0, until_s);
        Ok((0.0, place(&working, at_m, 0.0), errands))
    }

    /// Work about a place of a roadway of this length, that is over some time before `until_s`.
    fn work(&mut self, (id, length_m, at_m): (&str, f64, f64), from_s: f64, until_s: f64) -> Vec<Errand> {
        let (mut errands, mut now_s, mut here_m) = (Vec::new(), from_s, at_m);
        loop {
            // Nobody stays on one spot for long.
            let goes = errands.len() % 3 == 0;
            let share = if goes { 1.0 } else { self.between(0.0, 1.0) };
            let (errand, lasts_s) = if share < 0.4 {
                let seconds = self.between(20.0, 70.0);
                (Errand::Work { seconds }, seconds)
            } else if share < 0.55 {
                let seconds = self.between(5.0, 20.0);
                (Errand::Stand { seconds }, seconds)
            } else {
                let to_m = (at_m + self.between(-10.0, 10.0)).clamp(1.0, length_m - 1.0);
                let lasts_s = (to_m - here_m).abs() + 6.0;
                here_m = to_m;
                (go(place(id, to_m, self.between(-1.0, 1.0))), lasts_s)
            };
            now_s += lasts_s;
            if now_s > until_s - 30.0 {
                return errands;
            }
            errands.push(errand);
        }
    }

    /// The way from the end of a roadway to a place on another.
    fn way_m(&self, from: &str, to: &str, along_m: f64) -> Option<f64> {
        let roadways = &self.mine.plan().roadways;
        let line = |id: &str| roadways.iter().find(|r| r.id == id).map(|r| r.points_m.as_slice());
        let mut left_m = along_m;
        let mut place = *line(to)?.first()?;
        for pair in line(to)?.windows(2) {
            let length_m = (pair[1] - pair[0]).norm();
            place = pair[0] + (pair[1] - pair[0]) * (left_m / length_m).clamp(0.0, 1.0);
            left_m -= length_m;
            if left_m <= 0.0 {
                break;
            }
        }
        let network = self.mine.network();
        let (from, to) = (network.nearest(line(from)?.last()?)?, network.nearest(&place)?);
        Some(network.route(&from.spot, &to.spot, Travel::OnFoot)?.length_m)
    }
}
