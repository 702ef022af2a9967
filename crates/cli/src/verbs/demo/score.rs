//! The truth of the shift against what the server says live.

use std::fmt;

/// One live position.
#[derive(Debug, Clone, Copy)]
struct Judged {
    error_m: f32,
    within: bool,
    level: bool,
}

/// All of them.
#[derive(Debug, Default)]
pub struct Score {
    all: Vec<Judged>,
}

/// What they come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Positions.
    pub count: usize,
    /// Horizontal errors, m.
    pub median_m: f64,
    /// 95 % of them are no larger, m.
    pub p95_m: f64,
    /// Share of them within the radius that was told to hold 95 %.
    pub within: f64,
    /// Share on the right level.
    pub right_level: f64,
}

impl Score {
    /// Adds a position: its horizontal error, the radius that was told, whether the level is right.
    pub fn add(&mut self, error_m: f64, radius_95_m: f64, right_level: bool) {
        #[expect(clippy::cast_possible_truncation, reason = "metres: seven digits are plenty")]
        self.all.push(Judged { error_m: error_m as f32, within: error_m <= radius_95_m, level: right_level });
    }

    /// What those from number `from` on come to; `None` without any.
    pub fn figures(&self, from: usize) -> Option<Figures> {
        let part = self.all.get(from..).filter(|part| !part.is_empty())?;
        let mut errors: Vec<f32> = part.iter().map(|judged| judged.error_m).collect();
        errors.sort_unstable_by(f32::total_cmp);
        let count = errors.len();
        let at = |percent: usize| f64::from(errors[(count * percent / 100).min(count - 1)]);
        let share =
            |of: fn(&Judged) -> bool| part.iter().filter(|judged| of(judged)).count() as f64 / count as f64;
        Some(Figures {
            count,
            median_m: at(50),
            p95_m: at(95),
            within: share(|judged| judged.within),
            right_level: share(|judged| judged.level),
        })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.all.len()
    }
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, median_m, p95_m, within, right_level } = self;
        write!(
            f,
            "{count} live positions against the truth: median {median_m:.2} m, 95 % {p95_m:.2} m, in the 95 % circle {:.1} %, on the \
             right level {:.2} %",
            100.0 * within,
            100.0 * right_level
        )
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, clippy::float_cmp, reason = "tests; these figures are exact")]
    use super::*;

    #[test]
    fn figures_are_those_of_the_positions_since() {
        let mut score = Score::default();
        assert_eq!(score.figures(0), None);
        for error in 0..=100 {
            score.add(f64::from(error), 89.5, error % 2 == 0);
        }
        let Figures { count, median_m, p95_m, within, right_level } = score.figures(0).unwrap();
        assert_eq!((count, median_m, p95_m), (101, 50.0, 95.0));
        assert!((within - 90.0 / 101.0).abs() < 1e-12 && (right_level - 51.0 / 101.0).abs() < 1e-12);
        assert_eq!(score.figures(100).unwrap().median_m, 100.0);
        assert_eq!(score.figures(101), None);
    }
}
