//! How the pelvis moves about the point that carries it: heights, leans and harmonics of the step, for each manner of moving.
//!
//! `φ` counts steps: it is a whole number where a heel strikes, even for the left foot. About the carried point, in axes that turn with
//! the body (x forward, y left, z up), the pelvis moves by
//!
//! ```text
//! x =         a₁ cos 2πφ + b₁ sin 2πφ + a₂ cos 4πφ + b₂ sin 4πφ − 2.5 r + u cos πφ  surge
//! y =         s₁ sin πφ + s₃ sin 3πφ + (3 w + 0.8) r + 0.6 u sin 2πφ              hip sway, towards the standing foot
//! z = H +     c₁ cos 2πφ + d₁ sin 2πφ + c₂ cos 4πφ + d₂ sin 4πφ + (0.3 + w/4) r + u cos πφ + 0.5 u sin 3πφ
//! yaw =      −Y cos πφ + 20 w r                                                      the hip of the leading leg goes ahead
//! roll =      R sin(πφ + 0.9) + 20 w r                                               the swinging side drops, most in early stance
//! pitch = L + P cos(2πφ − 0.6) + 14 r                                                lean, and nodding
//! ```
//!
//! `r` is the heel strike: a pulse of amplitude `k` that rings twice in a third of a step; `w` is 1 on the left foot, −1 on the right; `u`
//! is what two legs differ by (angles take 1/m).
//!
//! **Walking.** The bounce is that of an inverted pendulum of leg length `l` (Zijlstra & Hof, *Gait & Posture* 6, 1997: step = 2 √(2 l h − h²),
//! and a step 1.25 times as long as that): `h = (step/1.25)² / 8l` peak to peak, lowest 0.08 of a step after the heel strike, where the
//! speed is highest (energies exchange). `l` is 0.53 of body height (Winter, *Biomechanics*, 4th ed. 2009, fig. 4.1).
//! Pelvic rotation and list of about 4° either way are those of Saunders, Inman & Eberhart (*J. Bone Joint Surg.* 35-A, 1953); sway of 2 cm
//! either way and the rest are chosen so that a tag on the lower back reads as recorded ones do ([`crate::people`]). From memory but for
//! the recordings. **Running** is lowest in mid-stance; **crawling** is on hands and knees with the trunk almost level.
//!
//! m, rad.

use crate::blend::Window;
use crate::jet::{Jet, JetVector};
use core::f64::consts::{PI, TAU};

/// The heel strike rings in this part of a step.
const STRIKE: Window = Window::new(0.0, 0.36);
const STRIKE_CYCLES: f64 = 2.0;
/// Share of a step by which list precedes sway and nodding follows the heel strike, rad.
const LIST_LEAD_RAD: f64 = 0.9;
const NOD_LAG_RAD: f64 = 0.6;

/// A manner of moving or staying.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Manner {
    /// Nothing moves.
    Still,
    Stand,
    Work,
    Walk,
    Run,
    Crawl,
    Sit,
    /// Face down on the floor, breathing.
    Lie,
}

/// Amplitudes of a manner: numbers, or functions of time while one manner goes over into another.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Posture<T> {
    pub height: T,
    pub lean: T,
    pub bounce: [T; 4],
    pub surge: [T; 4],
    pub sway: [T; 2],
    pub yaw: T,
    pub list: T,
    pub nod: T,
    pub strike: T,
    pub uneven: T,
    /// Strength of the slow sway of standing, 0 to 1.
    pub standing: T,
    /// Strength of the trunk motion of work, 0 to 1.
    pub working: T,
}

impl Posture<f64> {
    /// Of a body of this height taking steps of this length.
    pub fn of(manner: Manner, body_m: f64, step_m: f64) -> Self {
        let leg_m = 0.53 * body_m;
        let upright = Self { height: 0.57 * body_m, ..Self::default() };
        match manner {
            Manner::Still => upright,
            Manner::Stand => Self { standing: 1.0, ..upright },
            Manner::Work => Self { lean: 0.15, working: 1.0, ..upright },
            // The chest rises by a millimetre or two: a fiftieth of the sway of standing.
            Manner::Lie => Self { height: 0.15, lean: 1.5, standing: 0.02, ..Self::default() },
            Manner::Sit => Self { height: 0.12, lean: -0.1, ..Self::default() },
            Manner::Walk => {
                let pendulum_m = step_m / 1.25;
                let bounce = 0.5 * pendulum_m * pendulum_m / (8.0 * leg_m);
                let effort = step_m / 0.65;
                Self {
                    height: upright.height - bounce,
                    bounce: [harmonic(-bounce, 0.08), harmonic(-0.0008 * effort * effort, 0.02)].concat4(),
                    surge: [harmonic(0.009 * effort, 0.34), harmonic(0.0008 * effort * effort, 0.15)]
                        .concat4(),
                    sway: [0.018, 0.0012 * effort],
                    yaw: 0.065 * effort,
                    list: 0.05 * effort,
                    nod: 0.016 * effort,
                    strike: 0.00045 * effort * effort,
                    uneven: 0.0028 * effort,
                    ..upright
                }
            }
            Manner::Run => {
                let effort = step_m / 0.9;
                Self {
                    height: upright.height - 0.03,
                    lean: 0.12,
                    bounce: [harmonic(-0.033 * effort, 0.32), harmonic(0.002 * effort, 0.1)].concat4(),
                    surge: [harmonic(0.008 * effort, 0.55), harmonic(0.001 * effort, 0.2)].concat4(),
                    sway: [0.012, 0.001],
                    yaw: 0.09 * effort,
                    list: 0.06 * effort,
                    nod: 0.03 * effort,
                    strike: 0.0007 * effort * effort,
                    uneven: 0.002 * effort,
                    ..upright
                }
            }
            Manner::Crawl => Self {
                height: 0.29 * body_m,
                lean: 1.35,
                bounce: [harmonic(-0.006, 0.1), [0.0; 2]].concat4(),
                surge: [harmonic(0.012, 0.3), [0.0; 2]].concat4(),
                sway: [0.022, 0.0],
                yaw: 0.08,
                list: 0.10,
                nod: 0.02,
                strike: 0.0001,
                ..Self::default()
            },
        }
    }

    /// From this to `to`, `blend` from 0 to 1.
    pub fn towards(&self, to: &Self, blend: Jet) -> Posture<Jet> {
        let mix = |a: f64, b: f64| blend * (b - a) + Jet::constant(a);
        let mix4 = |a: [f64; 4], b: [f64; 4]| core::array::from_fn(|i| mix(a[i], b[i]));
        Posture {
            height: mix(self.height, to.height),
            lean: mix(self.lean, to.lean),
            bounce: mix4(self.bounce, to.bounce),
            surge: mix4(self.surge, to.surge),
            sway: core::array::from_fn(|i| mix(self.sway[i], to.sway[i])),
            yaw: mix(self.yaw, to.yaw),
            list: mix(self.list, to.list),
            nod: mix(self.nod, to.nod),
            strike: mix(self.strike, to.strike),
            uneven: mix(self.uneven, to.uneven),
            standing: mix(self.standing, to.standing),
            working: mix(self.working, to.working),
        }
    }

    /// As it is for a step of another vigour.
    #[must_use]
    pub fn scaled(&self, effort: f64) -> Self {
        let square = effort * effort;
        Self {
            bounce: self.bounce.map(|v| v * square),
            surge: self.surge.map(|v| v * effort),
            yaw: self.yaw * effort,
            list: self.list * effort,
            nod: self.nod * effort,
            strike: self.strike * square,
            uneven: self.uneven * effort,
            sway: self.sway.map(|v| v * effort.min(1.0)),
            ..*self
        }
    }
}

/// Coefficients of cosine and sine of an oscillation of this amplitude that peaks at a share of its **step**.
fn harmonic(amplitude: f64, peak: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(TAU * peak);
    [amplitude * cos, amplitude * sin]
}

trait Concat4 {
    fn concat4(self) -> [f64; 4];
}

impl Concat4 for [[f64; 2]; 2] {
    fn concat4(self) -> [f64; 4] {
        let [[a, b], [c, d]] = self;
        [a, b, c, d]
    }
}

/// Where the pelvis is about the carried point (body axes), and its angles beside the heading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stance {
    pub shift: JetVector,
    pub yaw: Jet,
    pub pitch: Jet,
    pub roll: Jet,
}

impl Posture<Jet> {
    /// At step count `phase`.
    pub fn at(&self, phase: Jet) -> Stance {
        // Only the part within two steps matters; large counts would cost digits.
        let turns = phase - Jet::constant(2.0 * libm::floor(0.5 * phase.value));
        let (sin, cos) = (turns * PI).sin_cos();
        let (sin2, cos2) = (sin * cos * 2.0, cos * cos * 2.0 - Jet::constant(1.0));
        let (sin4, cos4) = (sin2 * cos2 * 2.0, cos2 * cos2 * 2.0 - Jet::constant(1.0));
        let sin3 = sin2 * cos + cos2 * sin;
        let wave = |c: &[Jet; 4]| cos2 * c[0] + sin2 * c[1] + cos4 * c[2] + sin4 * c[3];
        let step = libm::floor(turns.value);
        let strike = STRIKE.ring(turns - Jet::constant(step), STRIKE_CYCLES) * self.strike;
        let struck = if step > 0.5 { -strike } else { strike };
        let (lead_sin, lead_cos) = libm::sincos(LIST_LEAD_RAD);
        let (lag_sin, lag_cos) = libm::sincos(NOD_LAG_RAD);
        Stance {
            shift: JetVector([
                wave(&self.surge) - strike * 2.5 + cos * self.uneven,
                sin * self.sway[0]
                    + sin3 * self.sway[1]
                    + struck * 3.0
                    + strike * 0.8
                    + sin2 * self.uneven * 0.6,
                self.height
                    + wave(&self.bounce)
                    + strike * 0.3
                    + struck * 0.25
                    + (cos + sin3 * 0.5) * self.uneven,
            ]),
            yaw: struck * 20.0 - cos * self.yaw,
            roll: (sin * lead_cos + cos * lead_sin) * self.list + struck * 20.0,
            pitch: self.lean + (cos2 * lag_cos + sin2 * lag_sin) * self.nod + strike * 14.0,
        }
    }
}
